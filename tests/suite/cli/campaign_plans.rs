//! Campaign files whose faults, wind, strata, designs or stops cannot be.

use super::campaign_files::all_refused;
use super::{Place, smoke};

#[test]
fn what_no_fault_wind_or_loop_can_be_is_refused() {
    // Each in the place of the first fault's magnitude, on line 57, or of the table of the verdict.
    all_refused(
        r#"
magnitude = { uniform = [0.1, 0.5] } => magnitude = 0.2\nduration_s = 0.0 :: fault[0].duration_s (line 58) = 0.0 ~ must be positive
magnitude = { uniform = [0.1, 0.5] } => magnitude = 0.2\nduration_s = [1.0, 2.0] :: fault[0].duration_s (line 58) = a list of 2 ~ a quantity of the agent
magnitude = { uniform = [0.1, 0.5] } => magnitude = 0.2\nagents = [{}, { probability = 1.5 }, {}] :: fault[0].agents[1].probability (line 58) = 1.5 ~ within [0, 1]
magnitude = { uniform = [0.1, 0.5] } => magnitude = 0.2\nagents = [{}, { channels = [7] }, {}] :: fault[0].agents[1].channels (line 58) = [7] ~ numbers from 1 to 6
magnitude = { uniform = [0.1, 0.5] } => magnitude = 0.2\nagents = [{}, {}, { onset_s = 6.0 }] :: fault[0].agents[2].onset_s (line 58) = 6.0: it must begin before the end
magnitude = { uniform = [0.1, 0.5] } => magnitude = 0.2\nagents = [{}, { duration_s = 1.0 }, {}] :: fault[0].duration_s ~ = absent: some agents have one and others do not; give it here
magnitude = { uniform = [0.1, 0.5] } => magnitude = 0.2\nagents = [{}, { onset_s = { uniform = [1.0, 2.0], per = "channel" } }, {}] :: fault[0].agents[1].onset_s.per ~ a quantity of the agent
magnitude = { uniform = [0.1, 0.5] } => magnitude = 0.2\nagents = [{}, { kind = "bias" }, {}] :: agents ~ unknown key `kind`
magnitude = { uniform = [0.1, 0.5] } => magnitude = 0.2\nagents = [{}, {}] :: fault[0].agents ~ 2 blocks ~ one block for each of the 3 agents
probability = 0.25 => background = true && [verdict] => [[strata]]\nfaults = ["actuator loss-of-effectiveness"]\n[verdict] :: strata[0].faults[0] ~ "actuator loss-of-effectiveness": this fault is part of the background of all strata; remove it from the list
kind = "sine"     => kind = "sine"\nagents = [{}, { probability = 0.5 }, {}] :: agents ~ unknown key `probability`
magnitude = { uniform = [0.1, 0.5] } => magnitude = 0.2\nlink = "command" :: fault[0].link (line 58) = given ~ only the network has two ways ~ target = "network"
[verdict] => [[fault]]\ntarget = "actuator"\nkind = "stuck"\nramp_s = 1.0\n[verdict] :: fault[2].ramp_s (line 71) = 1.0 ~ "stuck" cannot build up gradually; remove it
[verdict] => [[fault]]\ntarget = "actuator"\nkind = "delay"\ndelay_s = 3.0\n[verdict] :: fault[2].delay_s (line 71) = up to 3 s ~ at most 1024 steps of 0.002 s are remembered, 2.048 s
[verdict] => [[fault]]\ntarget = "network"\nkind = "replay"\nwindow_s = { uniform = [1.0, 3.0] }\n[verdict] :: fault[2].window_s (line 71) = up to 3 s ~ 2.048 s; shorten it
[verdict] => [[fault]]\ntarget = "network"\nkind = "interference"\nlink = "measurement"\nmagnitude = 0.1\n[verdict] :: fault[2].link (line 71) = "measurement" ~ on the way of the command
[verdict] => [[fault]]\ntarget = "sensor"\nkind = "dropout"\nburst_s = 0.1\nshare = 0.0\n[verdict] :: fault[2].share (line 72) = 0.0 ~ more than 0 and at most 1
[verdict] => [[fault]]\ntarget = "plant"\nkind = "payload"\nmass_kg = { uniform = [0.0, 1.0], per = "channel" }\noffset_x_m = 0.0\noffset_y_m = 0.0\n[verdict] :: fault[2].mass_kg.per (line 71) = "channel" ~ a quantity of the agent
[verdict] => [[fault]]\ntarget = "plant"\nkind = "mass"\nchannels = "one"\nmagnitude = 0.1\n[verdict] :: fault[2].channels (line 71) = "one" ~ the plant changes as a whole
[verdict] => [[fault]]\ntarget = "sensor"\nkind = "oscillatory"\namplitude = 1.0\nfrequency_rad_s = 300.0\n[verdict] :: fault[2].frequency_rad_s (line 72) = up to 300.0 rad/s ~ at most 250.0 rad/s
[verdict] => [[disturbance]]\nkind = "dryden"\nintensity = "light"\nwind_m_s = 5.0\naltitude_m = 10.0\nairspeed_m_s = 5.0\ngain_n_s_m = 1.0\n[verdict] :: disturbance[1].intensity (line 70) = "light" ~ remove it, or remove wind_m_s
[verdict] => [[disturbance]]\nkind = "dryden"\nintensity = 3\n[verdict] :: intensity = 3 ~ integer `3`, expected one of `light`, `moderate`, `severe`
[verdict] => [[disturbance]]\nkind = "dryden"\nintensity = "light"\naltitude_m = 1.0\nairspeed_m_s = 5.0\ngain_n_s_m = 1.0\n[verdict] :: disturbance[1].altitude_m (line 71) = 1.0 ~ within [3, 305]
[verdict] => [[disturbance]]\nkind = "dryden"\nintensity = "light"\naltitude_m = 10.0\nairspeed_m_s = 0.0\ngain_n_s_m = 1.0\n[verdict] :: disturbance[1].airspeed_m_s (line 72) = 0.0 ~ at least
[verdict] => [[disturbance]]\nkind = "gust-1-cosine"\nspeed_m_s = 5.0\ngain_n_s_m = 1.0\nonset_s = 1.0\nduration_s = 1.0\nagents = [{}, {}, { onset_s = 7.0 }]\n[verdict] :: disturbance[1].agents[2].onset_s (line 74) = 7.0 ~ before the end
[verdict] => [[fault]]\ntarget = "actuator"\nkind = "stuck"\nagents = [{}, { ramp_s = 1.0 }, {}]\n[verdict] :: fault[2].agents[1].ramp_s (line 71) = 1.0: "stuck" cannot build up gradually; remove it
[verdict] => [[disturbance]]\nkind = "gust-1-cosine"\nspeed_m_s = 5.0\ngain_n_s_m = 1.0\nonset_s = 7.0\nduration_s = 1.0\n[verdict] :: disturbance[1].onset_s (line 72) = 7.0 ~ before the end
[verdict] => [control]\nrate_hz = 300.0\n[verdict] :: control.rate_hz (line 69) = 300.0 ~ whole steps ~ use 250
[verdict] => [control]\ndelay_s = 4.0\n[verdict] :: control.delay_s (line 69) = up to 4 s ~ remembered
"#,
    );
}

#[test]
fn strata_and_names_that_cannot_be_are_refused() {
    let strata = |text: &str| format!("[verdict] => {text}\\n[verdict]");
    let cases = [
        (
            r#"[[strata]]\nfaults = "eech""#,
            r#"strata[0].faults (line 69) = "eech" ~ "each", "all", or a list ~ [] for none"#,
        ),
        (
            r#"[[strata]]\nfaults = 3"#,
            r#""each", "all", or a list of names of faults"#,
        ),
        (r#"[[strata]]"#, "missing key or table ~ `faults`"),
        (
            r#"[[strata]]\nfaults = []\nshare = 0"#,
            "strata[0].share (line 70) = 0 ~ 1 to 1000",
        ),
        (
            r#"[[strata]]\nfaults = []\nshare = 4"#,
            "episodes (line 4) = 3 ~ take 4 episodes to go round once ~ simulate more",
        ),
        (
            r#"[[strata]]\nfaults = ["sensor smoothed square"]"#,
            r#"strata[0].faults[0] (line 69) = "sensor smoothed square" ~ did you mean "sensor smoothed-square"?"#,
        ),
        (
            r#"[[strata]]\nfaults = ["sensor smoothed-square", "sensor smoothed-square"]"#,
            "strata[0].faults[1] (line 69) ~ in the list already",
        ),
        (
            r#"[[strata]]\nfaults = []\n[[strata]]\nfaults = []"#,
            r#"strata[1] (line 70) = "none" ~ another stratum has this name"#,
        ),
        (
            r#"[[strata]]\nfaults = []\nname = "all""#,
            r#"strata[0].name (line 70) = "all" ~ stands for all episodes"#,
        ),
        (
            r#"[[strata]]\nfaults = "each"\nname = "a""#,
            "strata[0].name (line 70) ~ makes several strata ~ remove it",
        ),
        (
            r#"[[strata]]\nfaults = "all"\nname = " x""#,
            "strata[0].name (line 70) ~ without blanks at its ends",
        ),
        (
            r#"[[strata]]\nfaults = "all"\nname = "=1+1""#,
            "strata[0].name (line 70) ~ begins with none of = + - @, which spreadsheets take for a formula; rename it",
        ),
        (
            "[[strata]]\\nfaults = \"all\"\\nname = \"left\\u202eright\"",
            "strata[0].name (line 70) ~ characters that can be seen",
        ),
        (
            r#"[[fault]]\nname = ""\ntarget = "sensor"\nkind = "bias"\nmagnitude = 1.0"#,
            "fault[2].name (line 69) ~ 1 to 60 characters",
        ),
        (
            r#"[[fault]]\nname = "x"\ntarget = "sensor"\nkind = "bias"\nmagnitude = 1.0\n[[fault]]\nname = "x"\ntarget = "sensor"\nkind = "bias"\nmagnitude = 1.0"#,
            "fault[3].name (line 74) ~ another fault has this name",
        ),
    ];
    for (text, words) in cases {
        all_refused(&format!("{} :: {words}", strata(text)));
    }
}

#[test]
fn designs_and_stops_that_cannot_be_are_refused() {
    let lhs = r#"[sampling]\ndesign = "latin-hypercube"\n"#;
    let sobol = r#"[sampling]\ndesign = "sobol"\n"#;
    let stop = r#"[stop]\ncontroller = "ftc"\n"#;
    let strata = r#"[[strata]]\nfaults = []\n"#;
    let require = r#"[[require]]\ncontroller = "ftc"\nfailure_rate_upper_95 = 0.1\n"#;
    let cases = [
        (
            r#"[sampling]\ndesign = "sobl"\n"#.to_string(),
            "unknown value `sobl` ~ did you mean `sobol`?",
        ),
        (
            r#"[sampling]\nreplicates = 4\n"#.to_string(),
            "sampling.replicates (line 69) = 4: independent numbers need no replicates ~ give a design",
        ),
        (
            lhs.to_string(),
            "episodes (line 4) = 3: sampling.replicates = 8 makes 8 hypercubes of equal size ~ simulate 16 episodes",
        ),
        (
            format!("{lhs}replicates = 2\\n"),
            "2 hypercubes of equal size, 2 or more; simulate 4 episodes",
        ),
        (
            format!("{sobol}replicates = 1\\n"),
            "makes 1 nets, each of a power of two of episodes; simulate 4 episodes",
        ),
        (
            format!("{sobol}replicates = 0\\n"),
            "sampling.replicates (line 70) = 0: there is at least one replicate",
        ),
        (
            format!("{lhs}replicates = 1\\n{strata}"),
            "sampling.design (line 69) = \"latin-hypercube\": ~ each of the strata ~ remove [[strata]]",
        ),
        (
            format!("{lhs}replicates = 1\\n{require}"),
            "require[0].failure_rate_upper_95 (line 73) = 0.1: its bound takes independent episodes ~ sampling.design = \"independent\"",
        ),
        (
            format!("{lhs}replicates = 1\\n{stop}half_width = 0.1\\n"),
            "stop (line 71) = given: what is proved on the way takes independent episodes",
        ),
        (
            format!("{strata}{stop}half_width = 0.1\\n"),
            "stop (line 70) = given ~ strata are of several ~ remove [[strata]]",
        ),
        (
            stop.to_string(),
            "stop (line 68) = without a goal ~ give failure_rate_below, failure_rate_above or half_width",
        ),
        (
            format!("{stop}failure_rate_below = 1.0\\n"),
            "stop.failure_rate_below (line 70) = 1.0: must lie between 0 and 1",
        ),
        (
            format!("{stop}half_width = 0.5\\n"),
            "stop.half_width (line 70) = 0.5: must lie between 0 and 0.5",
        ),
        (
            format!("{stop}half_width = 0.1\\nconfidence = 95\\n"),
            "stop.confidence (line 71) = 95.0: must lie between 0 and 1",
        ),
        (
            format!("{stop}half_width = 0.1\\nevery = 0\\n"),
            "stop.every (line 71) = 0: at least one episode",
        ),
        (
            r#"[stop]\ncontroller = "lqr"\nhalf_width = 0.1\n"#.to_string(),
            "stop.controller (line 69) = \"lqr\" ~ ftc, pid, pid-tuned",
        ),
        (
            format!("{require}stratum = \"none\"\\n"),
            "require[0].stratum (line 71) = \"none\": the campaign has no [[strata]]",
        ),
        (
            format!("{strata}{require}stratum = \"nine\"\\n"),
            "require[0].stratum (line 73) = \"nine\": the campaign's strata are none; did you mean \"none\"?",
        ),
    ];
    for (text, words) in cases {
        all_refused(&format!("[verdict] => {text}[verdict] :: {words}"));
    }
    // A number of episodes on the command line has to fit too.
    let sampled = smoke(&[
        (
            "[verdict]",
            "[sampling]\ndesign = \"sobol\"\nreplicates = 1\n[verdict]",
        ),
        ("episodes = 3", "episodes = 4"),
    ]);
    Place::with(&sampled).refuses(
        &["run", "c.toml", "--episodes", "6"],
        2,
        &["--episodes = 6", "simulate 8 episodes"],
    );
}

#[test]
fn the_number_of_episodes_that_is_asked_for_is_judged_and_not_the_one_of_the_file() {
    let strata = "[[strata]]\nfaults = []\nshare = 5\n[[strata]]\nfaults = \"all\"\n[verdict]";
    let place = Place::smoke(&[("[verdict]", strata)]);
    // Three are too few to go round once, whoever says so.
    let words = [
        "episodes (",
        ") = 3: the shares of the 2 strata take 6 episodes",
    ];
    place.refuses(&["check", "c.toml"], 2, &words);
    place.succeeds(&["check", "c.toml", "--episodes", "6"]);
    let words = ["--episodes = 5: the shares of the 2 strata take 6 episodes"];
    place.refuses(&["check", "c.toml", "--episodes", "5"], 2, &words);
    // A run of so many is read back as it was flown.
    let run = ["run", "c.toml", "--episodes", "6", "--out", "out"];
    place.succeeds(&run);
    place.succeeds(&["replay", "out", "--episode", "5"]);
    place.succeeds(&["report", "out"]);
}
