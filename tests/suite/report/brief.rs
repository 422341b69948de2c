//! A report in Markdown fits into a comment on a pull request, however many controllers are compared.

use super::Run;

#[test]
fn the_brief_report_of_many_controllers_fits_into_a_comment() {
    // 24 controllers are 276 pairs and 24 cards of numbers, under every fault that there is.
    let gains = crate::common::repository("tests/golden/gains-uav-paper.json");
    let named = (0..18).map(|k| {
        format!(
            "synthesis.named.copy{k}={{ gains = {:?}, controller = \"ftc\" }}",
            gains.display().to_string()
        )
    });
    let named: Vec<String> = named.collect();
    let names = (0..18).map(|k| format!("\"copy{k}\""));
    let names: Vec<String> = names.collect();
    let controllers = format!(
        "controllers=[\"ftc\", \"ftc-tuned\", \"pid\", \"pid-placed\", \"pid-tuned\", \"pid-robust-observer\", {}]",
        names.join(", ")
    );
    let mut changes: Vec<&str> = named.iter().map(String::as_str).collect();
    changes.push(&controllers);
    let run = Run::of("uav-faults", 80, &changes);
    let brief = run.read("report.md");
    // GitHub counts characters; bytes are at least as many.
    assert!(brief.len() < 65_536, "{}", brief.len());
    assert!(brief.contains("more rows are in the HTML report."));
    urts_mc::report::report(&run.dir, urts_mc::report::Length::Full).unwrap();
    assert!(run.read("report.md").len() > 65_536);
}
