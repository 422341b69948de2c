//! A loop that swings between its limits follows well, and nobody wants to fly it: it has to be said.

use super::Place;
use serde_json::Value;

/// A small quadrotor, 1.6 kg, whose torques are limited to 1.5 N m, on gains for torques of 60 N m: with a command that
/// comes 8 ms late the loop is beyond its delay margin, and the limits make a limit cycle of it.
const SMALL: &str = r#"
name = "small"
seed = 1
episodes = 12
controllers = ["ftc", "pid"]
[time]
duration_s = 6.0
step_s = 0.002
settle_s = 2.0
[agent]
kind = "uav"
actuation = "thrust"
mass_kg = 1.6
inertia_kg_m2 = [0.029, 0.029, 0.055]
mass_scale = { uniform = [0.9, 1.1] }
drag_n_s_m = 0.3
max_thrust_n = 32.0
max_torque_n_m = 1.5
max_tilt_rad = 0.6
[control]
rate_hz = 250
delay_s = 0.008
[reference]
kind = "sinusoid"
amplitude = [1.0, 0.5, 0.5, 0.0, 0.0, 0.0]
frequency_rad_s = [0.5, 0.5, 0.3, 0.0, 0.0, 0.0]
[synthesis]
preset = "uav-physical"
[[disturbance]]
kind = "sine"
amplitude = [{ uniform = [0.5, 1.5] }, 0.0, 0.0, 0.0, 0.0, 0.0]
frequency_rad_s = 1.0
[verdict]
max_error = 1.0
max_rmse = 0.5
"#;

#[test]
fn a_bang_bang_limit_cycle_is_said_before_its_small_errors_are_praised() {
    let place = Place::with(SMALL);
    let ended = place.program(&["run", "c.toml", "--out", "out", "--json"]);
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    let found: Value = serde_json::from_str(&ended.stdout).unwrap();
    let verdict: Vec<&str> = found["verdict"]
        .as_array()
        .unwrap()
        .iter()
        .map(|own| own.as_str().unwrap())
        .collect();
    assert!(
        verdict[0].starts_with("ftc chatters in attitude: its command is at a limit for "),
        "{verdict:?}"
    );
    assert!(!verdict[1].contains("ftc does better"), "{verdict:?}");
    // The numbers are there for programs, too.
    let terms = |controller: &str| {
        let all = found["fairness"].as_array().unwrap();
        let own = |own: &&Value| own["controller"] == controller && own["group"] == "attitude";
        let own = all.iter().find(own).unwrap();
        [&own["saturated_share"], &own["reversals_per_s"]].map(|own| own.as_f64().unwrap())
    };
    let [share, reversals] = terms("ftc");
    assert!(share > 0.2 && reversals > 15.0, "{share} {reversals}");
    let [share, reversals] = terms("pid");
    assert!(share < 0.01 && reversals < 10.0, "{share} {reversals}");
    assert!(
        place
            .read("out/report.md")
            .contains("ftc chatters in attitude")
    );
    // With its command on time, and torques as the gains need them, the same loop does not.
    let calm = SMALL
        .replace("delay_s = 0.008", "delay_s = 0.0")
        .replace("= 1.5\nmax", "= 60.0\nmax");
    assert_ne!(calm, SMALL);
    let place = Place::with(&calm);
    let said = place.program(&["run", "c.toml", "--out", "out"]).stdout;
    assert!(!said.contains("chatters"), "{said}");
}
