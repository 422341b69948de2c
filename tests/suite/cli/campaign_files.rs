//! Campaign files that cannot be run: what is said about each.
//!
//! A table has a case a line: `old => new :: word ~ word` replaces a part of the smoke campaign and expects the words;
//! ` && ` separates changes, and `\n` stands for a line break.

use super::{Place, smoke};
use serde_json::Value;
use std::collections::BTreeSet;
use urts_mc::campaign::Campaign;

/// Each case is refused with 2, the file's name and the words, in one paragraph, and nothing is written.
pub(super) fn all_refused(table: &str) {
    all_refused_of(smoke, table);
}

/// The same with another campaign than the smoke one.
pub(super) fn all_refused_of(text: impl Fn(&[(&str, &str)]) -> String, table: &str) {
    let plain = |text: &str| text.trim().replace("\\n", "\n");
    for case in table.lines().filter(|line| !line.trim().is_empty()) {
        let (changes, words) = case.split_once(" :: ").unwrap();
        let changes: Vec<(String, String)> = changes
            .split(" && ")
            .map(|change| change.split_once(" => ").unwrap())
            .map(|(old, new)| (plain(old), plain(new)))
            .collect();
        let changes: Vec<(&str, &str)> = changes
            .iter()
            .map(|(old, new)| (old.as_str(), new.as_str()))
            .collect();
        let words: Vec<String> = words.split(" ~ ").map(plain).collect();
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let said =
            Place::with(&text(&changes)).refuses(&["run", "c.toml", "--out", "out"], 2, &words);
        assert!(said.starts_with("error: c.toml: "), "{said}");
        assert!(!said.trim().contains("\n\n"), "two paragraphs: {said}");
    }
}

#[test]
fn the_campaign_that_the_cases_alter_is_good() {
    Place::smoke(&[]).succeeds(&["check", "c.toml"]);
}

#[test]
fn an_unknown_key_or_value_is_named_with_the_nearest_known_one() {
    all_refused(
        r#"
seed = 2026       => sed = 2026          :: line 3, column 1 ~ \n3 | sed = 2026\n  | ^^^\n ~ unknown key `sed` ~ did you mean `seed`?
[initial]         => [inital]            :: [inital] ~ unknown key `inital` ~ did you mean `initial`?
settle_s          => setle_s             :: unknown key `setle_s` ~ did you mean `settle_s`?
mass_scale = { uniform => mass_scale = { unifrom :: column 16 ~ ^^^^^^^ ~ unknown key `unifrom` ~ did you mean `uniform`?
period_s =        => periods =           :: unknown key `periods` ~ did you mean `period_s`?
std = 0.1         => sd = 0.1            :: unknown key `sd` ~ did you mean `std`?
kind = "sine"     => kind = "sinus"      :: unknown value `sinus` ~ did you mean `sine`?
"actuator"        => "actuators"         :: unknown value `actuators` ~ did you mean `actuator`?
mass_scale = { uniform => mass_scale = { gaussian :: unknown key `gaussian` ~ `normal` ~ remove it or take one of these
kind = "uav"      => kind = "rocket"     :: unknown value `rocket` ~ expected `uav`
preset = "uav-paper" => preset = "uav_paper" :: synthesis.preset (line 35) = "uav_paper" ~ "uav-physical" ~ did you mean "uav-paper"?
"pid-tuned"]      => "pid_tuned"]        :: controllers[2] (line 5) = "pid_tuned" ~ did you mean "pid-tuned"?
"pid-tuned"]      => "lqr"]              :: controllers[2] (line 5) = "lqr" ~ ftc, ftc-tuned, pid, pid-placed, pid-tuned, pid-robust-observer ~ take one of them
"#,
    );
}

#[test]
fn a_wrong_type_is_shown_where_it_stands() {
    all_refused(
        r#"
duration_s = 6.0  => duration_s = "6 s"  :: line 8, column 14 ~ \n8 | duration_s = "6 s"\n  |              ^^^^^\n ~ expected a number without quotes or unit
episodes = 3      => episodes = 3.5      :: line 4, column 12 ~ 3.5 ~ expected a whole number from 0
episodes = 3      => episodes = -3       :: line 4, column 12 ~ -3 ~ expected a whole number from 0
episodes = 3      => episodes = 5000000000 :: 5000000000 ~ expected a whole number from 0 to 4294967295
seed = 2026       => seed = -1           :: line 3 ~ -1 ~ expected a whole number from 0 to 18446744073709551615
seed = 2026       => seed = 18446744073709551616 :: integer `18446744073709551616`, expected a whole number from 0 to 18446744073709551615
kind = "uav"      => kind = 3            :: line 13, column 8 ~ integer `3`, expected `uav` or `biped`
"full"            => { full = 1 }        :: line 15, column 13 ~ a table, expected one of `full`, `thrust`, `limited`
kind = "sine"     => kind = 3            :: integer `3`, expected one of `sine`, `constant`, `friction`, `gust-1-cosine`
{ choice = [0.0, 1.0] } => { choice = [0.0, 1.0], per = 1 } :: integer `1`, expected one of `episode`, `agent`, `channel`
kappa =           => kappa = true #      :: kappa = true ~ ^^^^ ~ a number, a list with one value per channel, or a distribution such as
max_error = 1.5   => max_error = "big"   :: "big" ~ expected a number, or a list with one number per channel
max_error = 1.5   => max_error = [1.0, "b"] :: column 19 ~ "b" ~ expected a number
channels = "one"  => channels = 3        :: channels = 3 ~ a list of channels such as ["x", "yaw"] or [1, 6]
channels = "one"  => channels = ["w"]    :: fault[0].channels[0] (line 55) = "w": the channels are x, y, z, roll, pitch, yaw; name one of them
channels = "one"  => channels = ["x", "pich"] :: fault[0].channels[1] (line 55) = "pich" ~ did you mean "pitch"?
channels = "one"  => channels = ["x", "x"]    :: fault[0].channels[1] (line 55) = "x": this channel is in the list already; name it once
channels = "one"  => channels = ["x", 2]      :: fault[0].channels (line 55) = ["x", 2] ~ a list of different channels, names or numbers from 1 to 6: 1 x, 2 y
channels = "one"  => channels = []            :: fault[0].channels (line 55) = [] ~ give such a list
channels = "one"  => channels = [-1, 1]  :: fault[0].channels (line 55) = [-1, 1] ~ numbers from 1 to 6
channels = "one"  => channels = [1, 2.5] :: fault[0].channels (line 55) = [1, 2.5] ~ numbers from 1 to 6
channels = "one"  => channels = [[1]]    :: line 55, column 13 ~ expected a channel's name or number, from 1
probability = 0.25 => probability = { uniform = [0, 1] } :: probability ~ a table, expected a number
"full"            => "full"\ninertia_kg_m2 = [1.0, 1.0] :: inertia_kg_m2 ~ expected a list of length 3
"full"            => "full"\ninertia_kg_m2 = [1.0, 1.0, 1.0, 9.0] :: inertia_kg_m2 ~ 4 ~ expected a list of length 3
mass_scale = { uniform = [0.8, 1.2] } => mass_scale = { uniform = [0.8, 1.0, 1.2] } :: mass_scale ~ 3 ~ expected a list of length 2
mass_scale = { uniform = [0.8, 1.2] } => mass_scale = { log_uniform = [0.8, 1.0, 1.2] } :: mass_scale ~ 3 ~ expected a list of length 2
controllers = ["ftc", "pid", "pid-tuned"] => controllers = "ftc" :: "ftc" ~ expected a list
[[disturbance]]   => [disturbance]       :: [disturbance] ~ expected a list of tables ~ [[double brackets]]
[coupling]        => [[coupling]]        :: line 42 ~ a list, expected a table of keys and values
normal = { mean = 0.0, std = 0.1 } => normal = [0.0, 0.1] :: normal = [0.0, 0.1] ~ a list, expected a table
error_integral = 0.0 => agents = [[0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]] :: agents ~ a list, expected a table
name = "smoke"    => name = "smoke       :: line 1, column 14 ~ | ~ ^
seed = 2026       => seed = 2026\nseed = 3 :: line 4, column 1 ~ seed = 3 ~ duplicate key; keep one
seed = 2026       =>                     :: missing key or table `seed`; add it
step_s = 0.002    =>                     :: [time] ~ missing key or table `step_s`; add it
"#,
    );
}

#[test]
fn a_value_beyond_its_limit_is_refused_with_key_line_value_limit_and_remedy() {
    all_refused(
        r#"
"full"            => "full"\nmass_kg = -2.0 :: agent.mass_kg (line 16) = -2.0: must be positive; give a value within the limit
"full"            => "full"\ngravity_m_s2 = -9.81 :: agent.gravity_m_s2 (line 16) = -9.81: must not be negative; give a value
"full"            => "full"\ninertia_kg_m2 = [1.0, 1.0, 3.0] :: agent.inertia_kg_m2 (line 16) = [1.0, 1.0, 3.0] ~ above the sum of the other two
mass_scale = { uniform = [0.8, => mass_scale = { uniform = [-0.8, :: agent.mass_scale (line 16) = { uniform = [-0.8, 1.2] }: must be positive; give
mass_scale = { uniform = [0.8, 1.2] } => mass_scale = { normal = { mean = 1.0, std = 0.1 } } :: agent.mass_scale ~ = { normal = { mean = 1.0, std = 0.1 } }: must be positive ~ use truncated_normal
probability = 0.25 => probability = 1.25 :: fault[0].probability (line 54) = 1.25: must lie within [0, 1]; give a value within the limit
probability = 0.25 => probability = -0.25 :: fault[0].probability (line 54) = -0.25: must lie within [0, 1]
[0.1, 0.5]        => [0.1, 1.5]          :: fault[0].magnitude (line 57) = { uniform = [0.1, 1.5] }: must lie within [0, 1]
smoothing = 0.1   => smoothing = 0       :: fault[1].smoothing (line 65) = 0.0: must be at least 1e-6
frequency_rad_s = { uniform = [1.0, 5.0] } => frequency_rad_s = [1, 1, 1, 1, -1, 1] :: disturbance[0].frequency_rad_s[4] (line 48) = -1.0: must not be negative
episodes = 3      => episodes = 0        :: episodes (line 4) = 0: at least one episode must run; give a positive number
team = 3          => team = 0            :: agent.team (line 14) = 0: a team has 1 to 64 agents
team = 3          => team = 65           :: agent.team (line 14) = 65: a team has 1 to 64 agents
step_s = 0.002    => step_s = -0.002     :: time.step_s (line 9) = -0.002: must be positive
step_s = 0.002    => step_s = 1e-7       :: time.duration_s (line 8) = 6.0 ~ 8388608 steps of time.step_s = 1e-7 ~ take longer steps
settle_s = 2.0    => settle_s = -1.0     :: time.settle_s (line 10) = -1.0: must not be negative
onset_s = { uniform = [2.5, 4.0] } => onset_s = -1 :: fault[0].onset_s (line 56) = -1.0: must not be negative
max_error = 1.5   => max_error = 0.0     :: verdict.max_error (line 69) = 0.0: must be positive
channels = "one"  => channels = [0, 7]   :: fault[0].channels (line 55) = [0, 7] ~ different channels, names or numbers from 1 to 6: 1 x, 2 y, 3 z, 4 roll, 5 pitch, 6 yaw
channels = "one"  => channels = [2, 2]   :: fault[0].channels (line 55) = [2, 2] ~ different channels
channels = "one"  => channels = "two"    :: fault[0].channels (line 55) = "two" ~ "all", "one"
name = "smoke"    => name = "../smoke"   :: name (line 1) = "../smoke": a name consists of letters, digits, '-' and '_'; rename it
"uav-paper"       => "uav-paper"\nposition.rho = -0.1 :: synthesis.position.rho (line 36) = -0.1: must be above 0
"uav-paper"       => "uav-paper"\nposition.q1 = [-1, 1, 1] :: synthesis.position.q1[0] (line 36) = -1: must be above 0
"uav-paper"       => "uav-paper"\nattitude.smoothing_leak_per_s = 0.0 :: synthesis.attitude.smoothing_leak_per_s (line 36) = 0.0 ~ must decay ~ give a leak above 0
"uav-paper"       => "uav-paper"\nposition.smoothing_order = 40 :: synthesis.position.smoothing_order (line 36) = 40: must be at most the shorter window, 3
"uav-paper"       => "uav-paper"\nposition.smoothing_weights = [] :: synthesis.position.smoothing_weights (line 36) = a list of 0: must be between 1 and 4
"#,
    );
}

#[test]
fn what_is_not_a_finite_number_is_refused() {
    all_refused(
        r#"
max_rmse = 1.0    => max_rmse = nan      :: verdict.max_rmse (line 70) = nan: must be finite; give a number
duration_s = 6.0  => duration_s = inf    :: time.duration_s (line 8) = inf: must be finite
kappa =           => kappa = nan #       :: coupling.kappa (line 43) = nan: must be finite
{ choice = [0.0, 1.0] } => { choice = [0.0, nan] } :: coupling.kappa (line 43) = { choice = [0.0, nan] } ~ finite
mass_scale = { uniform = [0.8, 1.2] => mass_scale = { uniform = [0.8, inf] :: agent.mass_scale (line 16) = { uniform = [0.8, inf] } ~ a low to a high finite number
kappa =           => kappa = { uniform = [-1.7e308, 1.7e308] } # :: coupling.kappa (line 43) = { uniform = [-1.7e308, 1.7e308] } ~ finite
amplitude = [2.0, => amplitude = [-inf,  :: reference.amplitude[0] (line 21) = -inf: must be finite
"uav-paper"       => "uav-paper"\nposition.rho = nan :: synthesis.position.rho (line 36) = NaN: must be above 0
"#,
    );
}

#[test]
fn a_distribution_that_is_none_is_shown_as_it_was_written() {
    for (form, limit, remedy) in [
        (
            "{ uniform = [0.0, 1.0], choice = [0.0, 1.0] }",
            "only one of",
            "keep one",
        ),
        ("{ per = \"agent\" }", "one of uniform, ", "add one"),
        ("{ uniform = [1.2, 0.8] }", "from a low to a high", "swap"),
        (
            "{ log_uniform = [0.0, 1.0] }",
            "positive ends",
            "use uniform",
        ),
        (
            "{ normal = { mean = 0.0, std = -0.1 } }",
            "not negative",
            "correct",
        ),
        (
            "{ truncated_normal = { mean = 0.0, std = 0.1, low = 3.0, high = 4.0 } }",
            "six standard deviations",
            "widen",
        ),
        ("{ weights = [1.0] }", "belong to a choice", "remove"),
        (
            "{ uniform = [0.0, 1.0], weights = [1.0] }",
            "belong to a choice",
            "remove",
        ),
        (
            "{ choice = [0.0, 1.0], weights = [1.0] }",
            "as many weights",
            "correct",
        ),
        (
            "{ choice = [0.0, 1.0], weights = [-1.0, 2.0] }",
            "none negative",
            "correct",
        ),
        (
            "{ choice = [0.0, 1.0], weights = [0.0, 0.0] }",
            "not all zero",
            "correct",
        ),
        ("{ choice = [] }", "a choice has values", "correct"),
    ] {
        all_refused(&format!(
            "{{ choice = [0.0, 1.0] }} => {form} :: coupling.kappa (line 43) = {form}: ~ {limit} ~ {remedy}"
        ));
    }
}

#[test]
fn a_quantity_that_does_not_fit_its_channels_or_agents_is_refused() {
    all_refused(
        r#"
error_integral = 0.0 => error_integral = [0.0, 0.0] :: initial.error_integral (line 40) = a list of 2 ~ each of the 6 channels; complete it
amplitude = [2.0, 1.5, 1.0, 0.1, 0.1, 0.3] => amplitude = [2.0] :: reference.amplitude (line 21) = a list of 1 ~ each of the 6 channels
error_integral = 0.0 => error_integral = [[0, 0], 0, 0, 0, 0, 0] :: initial.error_integral[0] (line 40) = [0.0, 0.0]: lists do not nest
mass_scale = { uniform = [0.8, 1.2] } => mass_scale = [1.0, 1.0, 1.1] :: agent.mass_scale (line 16) = a list of 3 ~ not of its channels; give one
mass_scale = { uniform = [0.8, 1.2] } => mass_scale = { uniform = [0.8, 1.2], per = "channel" } :: agent.mass_scale.per (line 16) = "channel" ~ use "episode" or "agent"
error_integral = 0.0 => error_integral = [{ uniform = [0, 1], per = "agent" }, { uniform = [0, 1] }, 0, 0, 0, 0] :: initial.error_integral ~ share one `per` ~ write the same
team = 3          => team = 2            :: reference.agents (line 24) = 3 blocks ~ each of the 2 agents ~ change agent.team
smoothing = 0.1   => smoothing = 0.1\nagents = [{}] :: fault[1].agents (line 66) = 1 blocks ~ each of the 3 agents
"#,
    );
}

#[test]
fn a_contradiction_is_refused() {
    all_refused(
        r#"
onset_s = { uniform = [2.5, 4.0] } => onset_s = { uniform = [2.5, 40.0] } :: fault[0].onset_s (line 56) = { uniform = [2.5, 40.0] } ~ by the last step at 5.998 s; begin it earlier
onset_s = { uniform = [2.5, 4.0] } => onset_s = 40.0 && duration_s = 6.0 => duration_s = 12.0 :: fault[0].onset_s (line 56) = 40.0 ~ by the last step at 11.998 s; begin it earlier
onset_s = { uniform = [2.5, 4.0] } => onset_s = 5.999 :: fault[0].onset_s (line 56) = 5.999 ~ before the end
settle_s = 2.0    => settle_s = 6.0      :: time.settle_s (line 10) = 6.0 ~ before the end at 6 s; start them earlier
"full"            => "full"\nmax_thrust_n = 10.0 :: agent.max_thrust_n (line 16) = 10.0 ~ only the actuation "thrust" ~ set agent.actuation = "thrust"
"full"            => "thrust"            :: reference.amplitude (line 21) = [2.0, 1.5, 1.0, 0.1, 0.1, 0.3] ~ roll and pitch follow from the force ~ 0 on channels 4 and 5
"full"            => "thrust" && 0.1, 0.1, 0.3] => 0.0, 0.0, 0.3] :: fault[0].channels (line 55) = "one" ~ no actuators along x and y ~ [3, 4, 5, 6]
"full"            => "thrust" && 0.1, 0.1, 0.3] => 0.0, 0.0, 0.3] && channels = "one" =>  :: fault[0].channels (line 51) = "all" ~ no actuators along x and y
target = "actuator" => target = "sensor" :: fault[0].kind (line 53) = "loss-of-effectiveness" ~ does not strike this target ~ the target "sensor" has bias, oscillatory, delay
target = "sensor" => target = "actuator" :: fault[1].kind (line 61) = "smoothed-square" ~ the target "actuator" has loss-of-effectiveness, bias, stuck, float
smoothing = 0.1   => smoothing = 0.1\nmagnitude = 1.0 :: fault[1].magnitude (line 66) = 1.0 ~ no such parameter; remove it ~ period_s
smoothing = 0.1   => smoothing = 0.1\nagents = [{}, { std = 1.0 }, {}] :: fault[1].agents[1].std (line 66) = 1.0 ~ no such parameter
kind = "loss-of-effectiveness" => kind = "stuck" :: fault[0].magnitude (line 57) = { uniform = [0.1, 0.5] }: this kind has no such parameter; remove it; it has no parameters at all
period_s = { uniform = [6.0, 12.0] } =>  :: fault[1].period_s (line 59) = absent ~ needs it; add it
kind = "sine"     => kind = "sine"\nintensity = "light" :: disturbance[0].intensity (line 47) = "light": it stands for the wind_m_s of turbulence; remove it, or set kind = "dryden"
kind = "sine"     => kind = "constant"   :: disturbance[0].frequency_rad_s (line 48) ~ no such parameter ~ its parameters are amplitude
frequency_rad_s = { uniform = [1.0, 5.0] } => frequency_rad_s = 300.0 :: disturbance[0].frequency_rad_s (line 48) = up to 300.0 rad/s ~ steps of 0.002 s resolve at most 250.0 rad/s ~ shorten time.step_s
period_s = { uniform = [6.0, 12.0] } => period_s = 0.01 :: fault[1].period_s (line 64) = up to 628.3 rad/s ~ resolve at most 250.0 rad/s; make it slower
duration_s = 6.0  => duration_s = 15000  :: time.duration_s (line 8) = 15000: the references of 3 agents over 7500000 steps would take 8 GiB; shorten it
kind = "sinusoid" => kind = "sinusoid"\nmax_speed_m_s = 1.0 :: reference.max_speed_m_s (line 21) ~ "sinusoid" does not have it; remove it
kind = "sinusoid" => kind = "waypoints"  :: reference.amplitude (line 21) ~ "waypoints" does not have it; remove it
"pid-tuned"]      => "pid"]              :: controllers (line 5) = ["ftc", "pid", "pid"] ~ each once
["ftc", "pid", "pid-tuned"] => []        :: controllers (line 5) = [] ~ one or more
[verdict]         => [[require]]\ncontroller = "lqr"\nfailure_rate_upper_95 = 0.1\n[verdict] :: require[0].controller (line 69) = "lqr" ~ ftc, pid, pid-tuned ~ add it to `controllers`
[verdict]         => [[require]]\ncontroller = "ftc"\nfailure_rate_upper_95 = 1.1\n[verdict] :: require[0].failure_rate_upper_95 (line 70) = 1.1 ~ [0, 1]
"uav-paper"       => "uav-paper"\nposition.smoothing_weights = [-1.0]\nposition.smoothing_order = 1 :: synthesis.position.smoothing_weights (line 36) ~ smoothing_order ~ remove either
"uav-paper"       => "uav-paper"\nposition.q2 = [1.0, 1.0] :: synthesis.position.q2 (line 36) = a list of 2: needs 12 values
"uav-paper"       => "uav-paper"\nnamed.ftc.gains = "g.json" :: synthesis.named.ftc (line 36) ~ built-in ~ choose another
"uav-paper"       => "uav-paper"\nnamed.mine.gains = "g.json" :: synthesis.named.mine.gains (line 36) = "g.json": no such file; name a gains.json
preset = "uav-paper" => gains = "g.json" :: synthesis.gains (line 35) = "g.json": no such file; name a gains.json, relative to the campaign
"#,
    );
}

/// The keys of a schema that hold lists of a fixed length, with that length.
fn fixed_lists(schema: &Value, key: &str, found: &mut BTreeSet<(String, u64)>) {
    if let (Some(least), Some(most)) = (schema["minItems"].as_u64(), schema["maxItems"].as_u64()) {
        assert_eq!(least, most, "{key}");
        found.insert((key.to_string(), most));
    }
    match schema {
        Value::Object(parts) => {
            for (name, part) in parts {
                // A property has the key of its name; anything else is a part of it.
                if name == "properties" {
                    let properties = part.as_object().unwrap();
                    properties
                        .iter()
                        .for_each(|(key, part)| fixed_lists(part, key, found));
                } else {
                    fixed_lists(part, key, found);
                }
            }
        }
        Value::Array(parts) => parts.iter().for_each(|part| fixed_lists(part, key, found)),
        _ => {}
    }
}

#[test]
fn a_list_of_fixed_length_takes_neither_more_nor_fewer_values() {
    // (what is replaced, its replacement with LIST in it, the key, values that are enough)
    let preset = "\"uav-paper\"";
    let synthesis = |key: &str| format!("{preset}\\nposition.{key} = LIST");
    let scale = "mass_scale = { uniform = [0.8, 1.2] }";
    let cases: [(&str, String, &str, &[&str]); 10] = [
        (
            "\"full\"",
            "\"full\"\\ninertia_kg_m2 = LIST".into(),
            "inertia_kg_m2",
            &["1.25", "1.25", "2.2"],
        ),
        (
            "\"full\"",
            "\"full\"\\nstanding = LIST".into(),
            "standing",
            &["0.1"; 12],
        ),
        (
            "\"full\"",
            "\"full\"\\nsole = LIST".into(),
            "sole",
            &["\"left\"", "\"right\""],
        ),
        (
            scale,
            "mass_scale = { uniform = LIST }".into(),
            "uniform",
            &["0.8", "1.2"],
        ),
        (
            scale,
            "mass_scale = { log_uniform = LIST }".into(),
            "log_uniform",
            &["0.8", "1.2"],
        ),
        (
            "kind = \"sinusoid\"",
            "kind = \"sinusoid\"\\noffset_m = [[0.0, 0.0, 0.0], LIST]".into(),
            "offset_m",
            &["0.0", "1.0", "2.0"],
        ),
        (
            "[synthesis]",
            "[reference.gait]\\ncom_offset_m = LIST\\n[synthesis]".into(),
            "com_offset_m",
            &["0.0", "0.0", "0.1"],
        ),
        (preset, synthesis("q1"), "q1", &["1.0", "1.0", "1.0"]),
        (
            preset,
            synthesis("sensor_fault_input"),
            "sensor_fault_input",
            &["0.0", "1.0", "0.0"],
        ),
        (
            preset,
            synthesis("smoothing_windows"),
            "smoothing_windows",
            &["4", "4"],
        ),
    ];
    // No such key is forgotten.
    let mut known = BTreeSet::new();
    fixed_lists(&Campaign::schema(), "", &mut known);
    let of_case = |case: &(&str, String, &str, &[&str])| (case.2.to_string(), case.3.len() as u64);
    assert_eq!(cases.iter().map(of_case).collect::<BTreeSet<_>>(), known);
    for (old, new, key, enough) in &cases {
        let with = |values: &[&str]| new.replace("LIST", &format!("[{}]", values.join(", ")));
        let more = [enough, &[enough[0]] as &[_]].concat();
        for wrong in [&more[..], &enough[1..], &[]] {
            all_refused(&format!(
                "{old} => {} :: {key} = ~ ^^ ~ invalid length {}, expected a list of length {}; give exactly so many values",
                with(wrong),
                wrong.len(),
                enough.len()
            ));
        }
        // So many are a list, whatever else may be wrong with it here.
        let text = smoke(&[(old, &with(enough).replace("\\n", "\n"))]);
        let said = Place::with(&text)
            .program(&["check", "c.toml", "--quiet"])
            .stderr;
        assert!(!said.contains("invalid length"), "{key}: {said}");
    }
}

#[test]
fn a_path_that_cannot_be_flown_is_refused() {
    // A waypoint reference in place of the sinusoids.
    let waypoints = |points: &str, speed: &str, more: &str| {
        let text = smoke(&[]);
        let (before, rest) = text.split_once("[reference]").unwrap();
        let (_, after) = rest.split_once("[synthesis]").unwrap();
        format!(
            "{before}[reference]\nkind = \"waypoints\"\n{points}\n{speed}\nmax_acceleration_m_s2 = 1.0\n{more}\n[synthesis]{after}"
        )
    };
    let (points, speed) = ("points_m = [[0, 0, 2], [4, 0, 3]]", "max_speed_m_s = 0.8");
    Place::with(&waypoints(points, speed, "")).succeeds(&["check", "c.toml"]);
    for (points, speed, more, words) in [
        ("", speed, "", ["points_m", "absent", "add it"]),
        (points, "", "", ["max_speed_m_s", "absent", "add it"]),
        (
            points,
            "max_speed_m_s = 0",
            "",
            ["max_speed_m_s", "= 0.0", "must be positive"],
        ),
        (
            "points_m = [[0, 0, 2]]",
            speed,
            "",
            ["points_m", "[[0.0, 0.0, 2.0]]", "at least 2"],
        ),
        (
            "points_m = [[0, 0, 2], [0, 0, 2]]",
            speed,
            "",
            ["points_m", "coincides", "remove one"],
        ),
        (
            "points_m = [[0, 0, 2], [4, 0, 3], [0, 0, 2]]",
            speed,
            "",
            ["points_m", "turns too sharply", "spread the turn"],
        ),
        (
            points,
            speed,
            "offset_m = [[0, 0, 0]]",
            ["offset_m", "1 blocks", "each of the 3 agents"],
        ),
        (
            points,
            speed,
            "offset_m = [[0, 0, 0], [0, 0, nan], [0, 0, 0]]",
            ["offset_m[1][2]", "nan", "must be finite"],
        ),
        (points, speed, "center = 1.0", ["center", "given", "remove"]),
    ] {
        let said = Place::with(&waypoints(points, speed, more)).refuses(
            &["run", "c.toml", "--out", "out"],
            2,
            &words,
        );
        assert!(said.starts_with("error: c.toml: reference."), "{said}");
    }
}

/// The number between two words of a message.
fn number(said: &str, before: &str, after: &str) -> f64 {
    let (_, rest) = said.split_once(before).unwrap();
    rest.split_once(after).unwrap().0.parse().unwrap()
}

#[test]
fn the_step_that_an_error_advises_is_accepted() {
    let run = ["run", "c.toml", "--out", "out"];
    let with = |step: &str| smoke(&[("step_s = 0.002", &format!("step_s = {step}"))]);

    let place = Place::with(&with("0.03"));
    let words = [
        "error: c.toml: time.step_s (line 9) = 0.03: ",
        "is unstable at the pole",
        "of \"pid-tuned\"",
    ];
    let said = place.refuses(&run, 2, &words);
    // A step need not be the longest stable one to be good, but has to divide the duration.
    let steps = (6.0 / number(&said, "use ", " or less")).ceil();
    place.write("c.toml", with(&format!("{:?}", 6.0 / steps)));
    place.succeeds(&run);

    let place = Place::with(&with("0.0017"));
    let words = ["time.step_s (line 9) = 0.0017: must divide time.duration_s = 6 into whole steps"];
    let said = place.refuses(&run, 2, &words);
    place.write(
        "c.toml",
        with(&format!("{:?}", number(&said, "use ", " for"))),
    );
    place.succeeds(&run);
}

#[test]
fn an_infeasible_synthesis_exits_with_3_and_the_rho_that_it_advises_is_feasible() {
    let with = |rho: f64| {
        let weights = format!("preset = \"uav-paper\"\nposition.rho = {rho:?}");
        smoke(&[("preset = \"uav-paper\"", &weights)])
    };
    let place = Place::with(&with(0.1));
    let said = place.refuses(
        &["run", "c.toml", "--out", "deep/out"],
        3,
        &[
            "error: c.toml: ",
            "position channels",
            "step 1 (feedback gain)",
            "rho = 0.1",
            "raise rho",
        ],
    );
    assert_eq!(place.refuses(&["check", "c.toml"], 3, &[]), said);
    assert_eq!(place.refuses(&["synthesize", "c.toml"], 3, &[]), said);
    let smallest = number(&said, "the smallest feasible rho is ", ";");
    Place::with(&with(smallest)).succeeds(&["synthesize", "c.toml"]);
    // It is the smallest to four digits.
    Place::with(&with(0.999 * smallest)).refuses(&["synthesize", "c.toml"], 3, &["step 1"]);
}
