//! Settings laid over a campaign: what they change, what they leave alone, and what is said of those that cannot be.

use crate::common::{repository, settings};
use proptest::prelude::*;
use urts_mc::campaign::{Campaign, CampaignError, Setting};

fn smoke() -> String {
    std::fs::read_to_string(repository("campaigns/smoke.toml")).unwrap()
}

fn parsed(text: &str, overlay: &[&str]) -> Result<Campaign, CampaignError> {
    Campaign::parse_with(text, "c.toml".as_ref(), &settings(overlay))
}

/// All of a campaign but where it is from.
fn content(campaign: Campaign) -> String {
    let campaign = campaign.with(|own| (own.text, own.overlay) = (String::new(), Vec::new()));
    format!("{campaign:?}")
}

/// The smoke campaign with a part of its text replaced.
fn edited(old: &str, new: &str) -> String {
    assert!(smoke().contains(old), "{old:?}");
    smoke().replace(old, new)
}

#[test]
fn a_setting_does_what_an_editor_would_do_to_the_file() {
    for (overlay, old, new) in [
        (&["agent.team=1", "reference.agents="][..], "", ""),
        (&["seed=7"], "seed = 2026", "seed = 7"),
        // A word needs no quotes.
        (&["name=trial"], "\"smoke\"", "\"trial\""),
        (&["name=\"trial\""], "\"smoke\"", "\"trial\""),
        (
            &["controllers.1=pid-tuned", "controllers.2="],
            ", \"pid\"",
            "",
        ),
        (
            &["controllers=[\"pid\"]"],
            "\"ftc\", \"pid\", \"pid-tuned\"",
            "\"pid\"",
        ),
        // A list's entry, with a dot or in brackets.
        (
            &["fault.1.smoothing=0.2"],
            "smoothing = 0.1",
            "smoothing = 0.2",
        ),
        (
            &["fault[1].smoothing = 0.2"],
            "smoothing = 0.1",
            "smoothing = 0.2",
        ),
        (
            &["reference.amplitude[2]=3.0"],
            "1.5, 1.0, 0.1",
            "1.5, 3.0, 0.1",
        ),
        (
            &["agent.mass_scale.uniform.1=1.4"],
            "mass_scale = { uniform = [0.8, 1.2]",
            "mass_scale = { uniform = [0.8, 1.4]",
        ),
        (
            &["agent.mass_scale={ choice = [1, 2] }"],
            "mass_scale = { uniform = [0.8, 1.2] }",
            "mass_scale = { choice = [1, 2] }",
        ),
        // What is not there is added, with the tables and lists around it.
        (
            &["agent.mass_kg=3"],
            "actuation = \"full\"",
            "actuation = \"full\"\nmass_kg = 3",
        ),
        (
            &["sampling.design=sobol", "sampling.replicates=4"],
            "[verdict]",
            "[sampling]\ndesign = \"sobol\"\nreplicates = 4\n[verdict]",
        ),
        (
            &["require.+={ controller = \"ftc\", failure_rate_upper_95 = 0.5 }"],
            "[verdict]",
            "[[require]]\ncontroller = \"ftc\"\nfailure_rate_upper_95 = 0.5\n[verdict]",
        ),
        (
            &["fault.2={ target = \"sensor\", kind = \"bias\", magnitude = 0.1 }"],
            "[verdict]",
            "[[fault]]\ntarget = \"sensor\"\nkind = \"bias\"\nmagnitude = 0.1\n[verdict]",
        ),
        (
            &[
                "fault.+.target=sensor",
                "fault.2.kind=bias",
                "fault.2.magnitude=0.1",
            ],
            "[verdict]",
            "[[fault]]\ntarget = \"sensor\"\nkind = \"bias\"\nmagnitude = 0.1\n[verdict]",
        ),
        // Without a value it is removed.
        (&["time.settle_s="], "settle_s = 2.0 ", "# "),
        (
            &["coupling="],
            "[coupling]\nkappa = { choice = [0.0, 1.0] }\n",
            "",
        ),
        (&["fault.0.channels="], "channels = \"one\"\n", ""),
        // One after the other.
        (&["seed=1", "seed=", "seed=3"], "seed = 2026", "seed = 3"),
        (&[], "smoke", "smoke"),
    ] {
        let expected = match old {
            "" => {
                let text = smoke().replace("team = 3", "team = 1");
                let (head, rest) = text.split_once("[[reference.agents]]").unwrap();
                format!(
                    "{head}[synthesis]{}",
                    rest.split_once("[synthesis]").unwrap().1
                )
            }
            old => edited(old, new),
        };
        let expected = content(parsed(&expected, &[]).unwrap());
        let found =
            parsed(&smoke(), overlay).unwrap_or_else(|error| panic!("{overlay:?}: {error}"));
        assert!(content(found) == expected, "{overlay:?}");
    }
    let plain = content(parsed(&smoke(), &[]).unwrap());
    assert!(content(parsed(&smoke(), &["seed=2027"]).unwrap()) != plain);
    // A list without its first entry begins with the second.
    let second = parsed(&smoke(), &["fault.0="]).unwrap();
    assert_eq!(second.first_group().faults.len(), 1);
    assert_eq!(
        &*second.first_group().faults[0].name,
        "sensor smoothed-square"
    );
}

#[test]
fn what_is_wrong_with_a_setting_is_said_with_the_setting_as_its_place() {
    for (overlay, words) in [
        // Unknown keys and values, with the nearest known one.
        (
            "agent.teem=3",
            "c.toml: --set agent.teem=3: unknown key `teem` ~ did you mean `team`?",
        ),
        (
            "sed=3",
            "c.toml: --set sed=3: unknown key `sed` ~ did you mean `seed`?",
        ),
        (
            "sampling.desing=sobol",
            "--set sampling.desing=sobol: unknown key ~ did you mean `design`?",
        ),
        (
            "disturbance.0.kind=sinus",
            "--set disturbance.0.kind=sinus: unknown value `sinus` ~ did you mean `sine`?",
        ),
        (
            "agent.mass_scale={ unifrom = [0, 1] }",
            "--set agent.mass_scale={ unifrom = [0, 1] }: unknown key ~ `uniform`?",
        ),
        // Wrong types.
        (
            "episodes=many",
            "--set episodes=many: ~ string \"many\", expected a whole number from 0 to 4294967295",
        ),
        (
            "episodes=1e3",
            "--set episodes=1e3: ~ expected a whole number",
        ),
        ("coupling=3", "--set coupling=3: ~ expected a table"),
        (
            "fault={ target = \"sensor\" }",
            "--set fault={ target = \"sensor\" }: ~ a list of tables",
        ),
        // What is missing in what was brought in.
        (
            "fault.+={ target = \"sensor\" }",
            "--set fault.+={ target = \"sensor\" }: missing key or table `kind`; add it",
        ),
        (
            "stop.every=6",
            "--set stop.every=6: missing key or table `controller`; add it",
        ),
        // Values beyond their limits.
        (
            "fault.0.magnitude=4",
            "c.toml: fault[0].magnitude (--set fault.0.magnitude=4) = 4.0: must lie within [0, 1]; give values within the limit",
        ),
        (
            "agent.mass_scale.uniform.0=-1",
            "agent.mass_scale (line 16) = { uniform = [-1.0, 1.2] }: must be positive",
        ),
        (
            "fault.+={ target = \"sensor\", kind = \"bias\" }",
            "fault[2].magnitude (--set fault.+={ target = \"sensor\", kind = \"bias\" }) = absent",
        ),
        (
            "controllers.2=pid_tuned",
            "controllers[2] (--set controllers.2=pid_tuned) = \"pid_tuned\" ~ did you mean \"pid-tuned\"?",
        ),
        // Ways that lead nowhere.
        (
            "name.first=a",
            "c.toml: --set name.first=a: name is of type string, which has no keys; set name itself, to a table or a list",
        ),
        (
            "fault.0.probability.uniform=[0, 1]",
            "fault.0.probability is of type float, which has no keys; set fault.0.probability itself",
        ),
        (
            "fault.3.onset_s=1",
            "--set fault.3.onset_s=1: the list fault has no entry 3; its entries are fault.0 to fault.1; fault.+ appends one",
        ),
        (
            "fault.magnitude=1",
            "the list fault has no entry magnitude; its entries are fault.0 to fault.1",
        ),
        (
            "disturbance.5=",
            "the list disturbance has no entry 5; its only entry is disturbance.0",
        ),
        ("fault.2=", "the list fault has no entry 2"),
        ("fault.+=", "the list fault has no entry +"),
        (
            "agent.+=3",
            "agent is a table, and + appends to a list; name a key of it",
        ),
        (
            "fault.0.onset=",
            "there is no fault.0.onset to be removed; did you mean \"onset_s\"?",
        ),
        ("stop=", "there is no stop to be removed"),
        ("stop.every=", "there is no stop to be removed"),
    ] {
        let Err(error) = parsed(&smoke(), &[overlay]) else {
            panic!("{overlay}: accepted");
        };
        let said = error.to_string();
        assert!(
            said.starts_with("c.toml: ") && !said.contains('\n'),
            "{said}"
        );
        for word in words.split(" ~ ") {
            assert!(
                said.contains(word),
                "{overlay}: {word:?} is missing from: {said}"
            );
        }
    }
}

#[test]
fn what_a_setting_does_not_touch_keeps_its_place_in_the_file() {
    let overlay = [
        "agent.team=1",
        "reference.agents=",
        "seed=3",
        "time.settle_s=",
    ];
    for (old, new) in [
        ("kind = \"sine\"", "kind = \"sinus\""),
        ("episodes = 32", "episodes = 3.5"),
        ("[initial]", "[inital]"),
        ("[0.1, 0.5]", "[0.1, 1.5]"),
        ("smoothing = 0.1", "smoothing = 0"),
        ("name = \"smoke\"", "name = \"smoke"),
    ] {
        let text = edited(old, new);
        let said = |overlay: &[&str]| parsed(&text, overlay).unwrap_err().to_string();
        assert!(said(&[]).contains("line "), "{}", said(&[]));
        assert_eq!(said(&overlay), said(&[]));
    }
    // A whole that a setting leaves incomplete is where the file has it.
    let said = parsed(&smoke(), &["time.step_s="]).unwrap_err().to_string();
    assert!(
        said.contains("line 7, column 1") && said.contains("missing key or table `step_s`"),
        "{said}"
    );
    let said = parsed(&smoke(), &["seed="]).unwrap_err().to_string();
    assert_eq!(said, "c.toml: missing key or table `seed`; add it");
}

#[test]
fn a_text_that_is_no_setting_is_refused_with_what_would_be_one() {
    for (text, words) in [
        (
            "agent.team",
            "a setting is a key and its value; write key=value, or key= to remove the key",
        ),
        ("", "write key=value"),
        (
            "=3",
            "\"\" is not a key; write names and numbers with dots between",
        ),
        ("agent..team=3", "\"agent..team\" is not a key"),
        ("agent.=3", "is not a key"),
        (".agent=3", "is not a key"),
        ("agent team=3", "is not a key"),
        ("fault[0=3", "is not a key"),
        ("fault[a]=3", "is not a key"),
        ("fault]0[=3", "is not a key"),
        ("fault[]=3", "is not a key"),
        ("agent.mass_kg=2 kg", "\"2 kg\" is not a TOML value"),
        ("agent.mass_kg=2kg", "\"2kg\" is not a TOML value"),
        ("agent.mass_kg=.5", "\".5\" is not a TOML value"),
        ("controllers=[ftc]", "\"[ftc]\" is not a TOML value"),
        ("name=\"a", "is not a TOML value"),
        (
            "name=two words",
            "write a number, true, [1, 2], [\"a\", \"b\"], { a = \"table\" } or \"text\" in double quotes",
        ),
        ("seed=1\nname=2", "is not a TOML value"),
        ("seed=1 # one", "is not a TOML value"),
    ] {
        let said = text.parse::<Setting>().unwrap_err().to_string();
        assert!(said.contains(words), "{text:?}: {said}");
    }
}

proptest! {
    /// Whatever is typed: it is refused or laid over the campaign, and it is shown as it was typed.
    #[test]
    fn no_setting_makes_a_campaign_panic(
        first in "(agent|fault|time|name|reference|[a-z+]?)",
        more in "([.\\[](team|agents|step_s|uniform|[0-9]|\\+)\\]?){0,3}",
        value in "(|1|0\\.5|full|\\[1, 2\\]|\\{ a = 1 \\}|[ -~]{0,6})",
    ) {
        let written = format!("{first}{more}={value}");
        if let Ok(setting) = written.parse::<Setting>() {
            prop_assert_eq!(setting.to_string(), written);
            let path = "c.toml".as_ref();
            let _ = Campaign::parse_with(&smoke(), path, std::slice::from_ref(&setting));
            // Over nothing, all on the way to it is made.
            let nothing = Campaign::parse_with("", path, &[setting.clone(), setting]);
            prop_assert!(nothing.is_err());
        }
    }
}
