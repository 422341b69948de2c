//! What a browser makes of a report: nothing is cut, nothing overlaps, nothing is asked for from elsewhere.

use super::{Run, address, all_failed, program};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Widths of a screen and of a phone, px.
const WIDTHS: [u32; 2] = [1280, 390];

/// What measuring a page found.
#[derive(Debug)]
struct Found {
    width: u64,
    panels: u64,
    stumbles: Vec<String>,
    requests: Vec<String>,
}

/// A browser; without one the tests are skipped, or fail where one is required.
fn browser() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let path = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&path)
        .flat_map(|dir| names.map(|name| dir.join(name)))
        .find(|file| file.is_file());
    if found.is_none() {
        let required = std::env::var_os("URTS_REQUIRE_BROWSER").is_some();
        assert!(!required, "no browser: install chromium");
        println!("SKIPPED: no browser");
    }
    found
}

/// Opens a page in a frame of a width and measures it; `extra` is markup added to it. (A window is never narrower than
/// 500 px.)
fn open(browser: &Path, page: &Path, width: u32, dark: bool, extra: &str) -> Found {
    let place = TempDir::new().unwrap();
    let copy = place.path().join("page.html");
    let html = fs::read_to_string(page).unwrap();
    let script = include_str!("measure.js");
    let measured = html.replace(
        "</body>",
        &format!("{extra}<script>addEventListener('load', () => {{ {script} }})</script></body>"),
    );
    assert_ne!(measured, html);
    fs::write(&copy, measured).unwrap();
    let window = place.path().join("window.html");
    let listen =
        "addEventListener('message', (told) => { document.body.dataset.found = told.data; })";
    let frame = format!(
        "<!DOCTYPE html><body><script>{listen}</script>\
         <iframe src=\"page.html\" style=\"width:{width}px;height:2000px;border:0\"></iframe></body>"
    );
    fs::write(&window, frame).unwrap();
    let scheme = if dark { 0 } else { 1 };
    let output = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--disable-extensions",
            "--enable-logging=stderr",
        ])
        .args([
            "--disable-background-networking",
            "--disable-component-update",
            "--no-first-run",
        ])
        .arg(format!(
            "--user-data-dir={}",
            place.path().join("profile").display()
        ))
        .arg(format!("--blink-settings=preferredColorScheme={scheme}"))
        .arg("--window-size=1400,2100")
        .args(["--virtual-time-budget=4000", "--dump-dom"])
        .arg(address(&window))
        .output()
        .unwrap();
    let dom = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    let answer = dom.split("data-found=\"").nth(1);
    let answer = answer.unwrap_or_else(|| panic!("the page was not measured: {errors}"));
    let answer = answer
        .split('"')
        .next()
        .unwrap()
        .replace("&quot;", "\"")
        .replace("&amp;", "&");
    let answer: serde_json::Value = serde_json::from_str(&answer).unwrap();
    let stumbles = answer["found"].as_array().unwrap().iter();
    let stumbles = stumbles.map(|text| text.as_str().unwrap().to_string());
    let consoled = errors.lines().filter(|line| line.contains("CONSOLE"));
    let requests = answer["requests"].as_array().unwrap().iter();
    let requests = requests.map(|url| url.as_str().unwrap().to_string());
    Found {
        width: answer["width"].as_u64().unwrap(),
        panels: answer["panels"].as_u64().unwrap(),
        stumbles: stumbles.chain(consoled.map(String::from)).collect(),
        requests: requests.collect(),
    }
}

fn judge(browser: &Path, page: &Path, least_panels: u64) {
    for width in WIDTHS {
        for dark in [false, true] {
            let found = open(browser, page, width, dark, "");
            assert_eq!(found.width, u64::from(width));
            assert!(found.panels >= least_panels, "{found:?}");
            assert!(found.stumbles.is_empty(), "{width} px: {found:#?}");
            assert!(found.requests.is_empty(), "{width} px: {found:#?}");
        }
    }
}

#[test]
fn a_browser_shows_the_reports_of_uavs_whole_and_asks_for_nothing() {
    let Some(browser) = browser() else { return };
    let run = Run::of("uav-paper", 64, &[]);
    judge(&browser, &run.path("report.html"), 10);
}

#[test]
fn a_browser_shows_the_reports_of_robots_and_of_strata_whole() {
    let Some(browser) = browser() else { return };
    let run = Run::of("biped-paper", 4, &[]);
    judge(&browser, &run.path("report.html"), 14);
    let run = Run::of("uav-faults", 40, &[]);
    judge(&browser, &run.path("report.html"), 9);
}

#[test]
fn a_browser_shows_the_report_of_a_run_in_which_all_fails() {
    let Some(browser) = browser() else { return };
    judge(&browser, &all_failed().path("report.html"), 9);
}

#[test]
fn a_browser_shows_the_pages_of_replays_whole_and_asks_for_nothing() {
    let Some(browser) = browser() else { return };
    // Faults of every kind shaded; robots that walk, and that fall under the PIDs.
    for (name, controller, least_panels) in [("uav-faults", "pid", 90), ("biped-paper", "ftc", 95)]
    {
        // As many as it takes to go round the strata once.
        let run = Run::of(name, 40, &[]);
        let dir = run.path("");
        let asked = [
            "replay",
            dir.to_str().unwrap(),
            "--episode",
            "1",
            "--controller",
            controller,
            "--quiet",
        ];
        let (code, said) = program(&asked);
        assert_eq!(code, 0, "{said}");
        judge(
            &browser,
            &run.path(&format!("replay-1-{controller}.html")),
            least_panels,
        );
    }
}

#[test]
fn cut_labels_overlaps_and_requests_are_noticed() {
    let Some(browser) = browser() else { return };
    let run = Run::of("smoke", 2, &[]);
    let page = run.path("report.html");
    let panel = |texts: &str| {
        format!("<figure><svg viewBox=\"0 0 100 50\" width=\"100\">{texts}</svg></figure>")
    };
    let text = |x: u32, y: u32| format!("<text x=\"{x}\" y=\"{y}\" font-size=\"10\">label</text>");
    let good = panel(&format!("{}{}{}", text(5, 12), text(5, 26), text(5, 40)));
    let cut = panel(&format!("{}{}{}", text(90, 12), text(5, 26), text(5, 40)));
    let crossing = panel(&format!("{}{}{}", text(5, 12), text(8, 14), text(5, 40)));
    let bare = panel(&text(5, 12));
    let wide = "<p style=\"width:3000px;max-width:none\">wide</p>".to_string();
    let asking = "<img src=\"http://127.0.0.1:9/pixel.png\" alt=\"\">".to_string();
    for (extra, stumble) in [
        (good, None),
        (cut, Some("is cut")),
        (crossing, Some("overlaps")),
        (bare, Some("labels only")),
        (wide, Some("px wide")),
    ] {
        let found = open(&browser, &page, 390, false, &extra);
        match stumble {
            None => assert!(found.stumbles.is_empty(), "{found:#?}"),
            Some(stumble) => {
                let told = found.stumbles.iter().any(|told| told.contains(stumble));
                assert!(told, "{stumble}: {found:#?}");
            }
        }
    }
    let failing = "<script>console.error('lost')</script>";
    let found = open(&browser, &page, 390, false, failing);
    assert!(
        found.stumbles.iter().any(|told| told.contains("lost")),
        "{found:#?}"
    );
    let found = open(&browser, &page, 390, false, &asking);
    assert!(!found.requests.is_empty(), "{found:#?}");
}
