//! Campaigns in which nothing is left to chance: their episodes are one, and are not counted as many.

use crate::common::{altered, campaign, gains_of_groups, tables};
use urts_mc::backend::cpu::Precision;
use urts_mc::campaign::lints::cautions;
use urts_mc::results::Results;

#[test]
fn what_is_drawn_or_changes_by_chance_makes_a_campaign_random_and_nothing_else_does() {
    assert!(!campaign("scenario-a").is_random());
    for random in [
        "agent.mass_scale={ uniform = [0.9, 1.1] }",
        "agent.inertia_scale={ choice = [0.9, 1.1] }",
        "coupling.kappa={ choice = [0.0, 1.0] }",
        "initial.error={ normal = { mean = 0.0, std = 0.1 } }",
        "initial.error_rate=[0.0, 0.0, { uniform = [0.0, 0.1] }, 0.0, 0.0, 0.0]",
        "initial.error_integral={ uniform = [0.0, 0.1] }",
        "control.delay_s={ uniform = [0.001, 0.003] }",
        "disturbance.0.amplitude={ uniform = [1.0, 2.0] }",
        "disturbance.+={ kind = \"dryden\", wind_m_s = 5.0, altitude_m = 10.0, airspeed_m_s = 5.0, gain_n_s_m = 0.5 }",
        "fault.0.probability=0.5",
        "fault.0.channels=one",
        "fault.0.onset_s={ uniform = [1.0, 2.0] }",
        "fault.0.duration_s={ uniform = [1.0, 2.0] }",
        "fault.0.amplitude={ uniform = [0.1, 0.2] }",
        "fault.+={ target = \"sensor\", kind = \"noise\", std = 0.01 }",
        "fault.+={ target = \"sensor\", kind = \"dropout\", burst_s = 0.1, share = 0.5 }",
        "fault.+={ target = \"sensor\", kind = \"outlier\", amplitude = 0.1, share = 0.5 }",
    ] {
        assert!(altered("scenario-a", &[random]).is_random(), "{random}");
    }
    for fixed in [
        "agent.mass_scale=1.1",
        "agent.mass_scale={ uniform = [1.1, 1.1] }",
        "fault.0.probability=1.0",
        "fault.0.onset_s=1.0",
        "fault.+={ target = \"sensor\", kind = \"noise\", std = 0.0 }",
        "fault.+={ target = \"sensor\", kind = \"dropout\", burst_s = 0.1, share = 0.5, probability = 0.0 }",
        "disturbance.+={ kind = \"dryden\", wind_m_s = 0.0, altitude_m = 10.0, airspeed_m_s = 5.0, gain_n_s_m = 0.5 }",
    ] {
        assert!(!altered("scenario-a", &[fixed]).is_random(), "{fixed}");
    }
    // One random group is enough.
    let mixed = campaign("mixed-teams");
    assert!(mixed.is_random());
}

#[test]
fn copies_of_one_episode_are_no_evidence() {
    let changes = ["episodes=64", "time.duration_s=3.0"];
    let once = altered("scenario-a", &changes);
    let said = &cautions(&once)[0];
    assert!(
        said.starts_with(
            "nothing is random: the 64 episodes are one and the same; 1 would say as much"
        ),
        "{said}"
    );
    assert!(cautions(&altered("scenario-a", &["time.duration_s=3.0"])).is_empty());
    let results = |changes: &[&str]| {
        let campaign = altered("scenario-a", changes);
        let tables = tables(&campaign, Precision::F32);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .unwrap();
        Results::of(
            &campaign,
            gains_of_groups(&campaign),
            &tables.scores,
            &[],
            &pool,
        )
    };
    let repeated = results(&changes);
    let random = "initial.error={ uniform = [0.09, 0.11] }";
    let drawn = results(&[changes[0], changes[1], random]);
    assert_eq!(repeated.failures.len(), drawn.failures.len());
    for (own, other) in repeated.failures.iter().zip(&drawn.failures) {
        assert_eq!((own.interval, own.upper_95), (None, None));
        assert!(other.interval.is_some() && other.upper_95.is_some());
    }
    for (own, other) in repeated.comparisons.iter().zip(&drawn.comparisons) {
        assert!(own.mid_p.is_none() && own.p_holm.is_none() && other.mid_p.is_some());
        assert!(own.difference.unwrap().interval.is_none());
        for (own, other) in own.ratios.iter().zip(&other.ratios) {
            assert!(own.log_ratio.unwrap().interval.is_none() && own.sign_p.is_none());
            assert!(other.log_ratio.unwrap().interval.is_some());
            // The numbers themselves are there.
            assert!(own.log_ratio.unwrap().value.is_finite());
        }
    }
    for row in &repeated.summary {
        // Nobody recovers from a fault that nobody has.
        let applies = row.metric != "recovery_s";
        assert!(
            row.quantiles
                .iter()
                .all(|own| own.interval.is_none() && own.value.is_some() == applies)
        );
    }
    let sure = |results: &Results| {
        results
            .verdict
            .iter()
            .any(|own| own.contains("does better"))
    };
    assert!(!sure(&repeated) && sure(&drawn), "{:?}", repeated.verdict);
}

#[test]
fn a_rate_of_episodes_that_are_all_the_same_is_not_to_be_proved() {
    let text = campaign("scenario-a").text.clone();
    let parsed = |more: &str| {
        let text = format!("{text}\n{more}");
        urts_mc::campaign::Campaign::parse(&text, "c.toml".as_ref())
    };
    for (table, key) in [
        (
            "[[require]]\ncontroller = \"ftc\"\nfailure_rate_upper_95 = 0.5\n",
            "require[0] ",
        ),
        (
            "[stop]\ncontroller = \"ftc\"\nfailure_rate_below = 0.5\n",
            "stop ",
        ),
    ] {
        let refused = parsed(table).unwrap_err().to_string();
        assert!(refused.contains(key), "{refused}");
        assert!(
            refused.contains("nothing in the campaign is random: its episodes are all the same, and prove no rate; draw something"),
            "{refused}"
        );
        let noise = "[[fault]]\ntarget = \"sensor\"\nkind = \"noise\"\nstd = 0.01\n";
        assert!(parsed(&format!("{noise}{table}")).is_ok());
    }
}
