//! Other designs, presets, determinism, files and speed.

use super::*;

#[test]
fn other_smoothing_models_synthesize_and_certify() {
    let leaky = |order, leak_per_s| SmoothingRule::Leaky { order, leak_per_s };
    for (windows, rule) in [
        ([3, 4], leaky(0, 1.0)),
        ([3, 4], leaky(2, 1.0)),
        ([0, 0], leaky(0, 2.0)),
        ([2, 2], leaky(1, 0.5)),
        ([3, 4], SmoothingRule::Weights(vec![1.2, -0.1, -0.2])),
    ] {
        let smoothing = Smoothing {
            windows,
            rule,
            ..Smoothing::paper()
        };
        let design = ChannelDesign {
            q2: geometric_q2(&smoothing, [0.1, 10.0, 1.0], 1.0, 20.0),
            smoothing: smoothing.clone(),
            ..uav().design.clone()
        };
        let synthesis = synthesize(&design).unwrap_or_else(|e| panic!("{smoothing:?}: {e}"));
        assert_eq!(synthesis.ftc.k.len(), design.states());
        assert!(synthesis.certificate.max_eigenvalue < 0.0);
    }
}

#[test]
fn same_design_gives_the_same_bytes() {
    let case = uav();
    let again = synthesize(&case.design).unwrap();
    let text = |synthesis| serde_json::to_string(synthesis).unwrap();
    assert_eq!(text(&again), text(&case.synthesis));
}

#[test]
fn synthesis_survives_its_file_bit_for_bit() {
    for case in CASES.iter() {
        let text = serde_json::to_string_pretty(&case.synthesis).unwrap();
        let back: ChannelSynthesis = serde_json::from_str(&text).unwrap();
        assert_eq!(back.design, case.design);
        assert_eq!(back.ftc, case.synthesis.ftc);
        assert_eq!(back.certificate, case.synthesis.certificate);
        assert_eq!(serde_json::to_string_pretty(&back).unwrap(), text);
        assert!(!text.contains("time"), "no clock in a result");
    }
}

#[test]
fn presets_name_their_channels_by_role() {
    let roles =
        |preset: Preset| -> Vec<_> { preset.designs().into_iter().map(|(role, _)| role).collect() };
    use ChannelRole::{Attitude, Joints, Position};
    assert_eq!(roles(Preset::UavPaper), [Position, Attitude]);
    assert_eq!(roles(Preset::UavPhysical), [Position, Attitude]);
    assert_eq!(roles(Preset::BipedPaper), [Joints]);
    for preset in Preset::ALL {
        let quoted = serde_json::to_string(&preset).unwrap();
        assert_eq!(quoted, format!("\"{}\"", preset.name()));
    }
}

/// Optimised builds only: the limit is meant for what users run.
#[cfg(not(debug_assertions))]
#[test]
fn synthesis_of_a_channel_takes_less_than_two_seconds() {
    for case in CASES.iter() {
        let best = (0..3)
            .map(|_| {
                let start = std::time::Instant::now();
                synthesize(&case.design).unwrap();
                start.elapsed()
            })
            .min()
            .unwrap();
        // About 0.4 s on a quiet core; the best of three on a busy one.
        assert!(best.as_secs_f64() < 2.0, "{}: {best:?}", case.name);
    }
}

#[test]
fn weights_on_the_integral_alone_are_enough() {
    let design = ChannelDesign {
        q1: [10.0, 0.0, 0.0],
        q2: vec![0.0; uav().design.states()],
        sensor_fault_input: [0.0; 3],
        ..uav().design.clone()
    };
    assert!(synthesize(&design).unwrap().certificate.max_eigenvalue < 0.0);
}

#[test]
fn gains_on_delayed_and_sensor_fault_taps_are_certified_too() {
    let case = uav();
    let mut gains = case.synthesis.ftc.clone();
    gains.k[5] = 0.02;
    gains.k[8] = -0.05;
    let certificate = verify(&case.design, &gains).unwrap().certificate.unwrap();
    assert!(certificate.max_eigenvalue < 0.0);
    // The gain lets the sensor fault into the control: the level changes.
    assert!((certificate.rho - case.synthesis.certificate.rho).abs() > 1e-3);
}
