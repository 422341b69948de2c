//! The sensors of the reference cases: channels in pairs, a third alone.

use std::collections::BTreeMap;
use urts_mc::synthesis::{ChannelDesign, Preset, Sensor, SensorChanges, Sensors};

/// The paper's UAV weights.
pub(crate) fn design() -> ChannelDesign {
    Preset::UavPaper.designs()[0].1.clone()
}

/// Names of n channels.
pub(crate) fn names(n: usize) -> Vec<String> {
    (0..n).map(|channel| format!("x{channel}")).collect()
}

/// A sensor of some signals with some faults.
pub(crate) fn sensor(of: &[(&str, f64)], faults: &[(&str, f64)]) -> Sensor {
    let map = |list: &[(&str, f64)]| -> BTreeMap<String, f64> {
        let named = list
            .iter()
            .map(|(name, factor)| (name.to_string(), *factor));
        named.collect()
    };
    Sensor {
        of: map(of),
        faults: map(faults),
        noise: None,
    }
}

/// The changes of a reference case on n channels.
pub(crate) fn changes(kind: &str, n: usize) -> SensorChanges {
    let mut changes = SensorChanges::default();
    let names = names(n);
    let (sine, cosine) = 20_f64.to_radians().sin_cos();
    let mut faults = Vec::new();
    for pair in names.chunks(2) {
        let [a, b] = pair else {
            faults.extend(pair.iter().cloned());
            if kind == "shared" {
                alone(&mut changes, &pair[0]);
            }
            continue;
        };
        let rates = [a, b].map(|own| format!("{own}.rate"));
        match kind {
            "kronecker" => {}
            "rotated" => {
                let of = [(&*rates[0], cosine), (&*rates[1], -sine)];
                let own = sensor(&of, &[(a, 1.0)]);
                changes.replace.insert(rates[0].clone(), own);
                let of = [(&*rates[0], sine), (&*rates[1], cosine)];
                let own = sensor(&of, &[(b, 1.0)]);
                changes.replace.insert(rates[1].clone(), own);
            }
            "shared" => {
                let fault = format!("imu-{a}");
                for (own, rate, share) in [(a, &rates[0], 1.0), (b, &rates[1], 0.5)] {
                    let of_rate = sensor(&[(rate, 1.0)], &[(&fault, share)]);
                    changes.replace.insert(rate.clone(), of_rate);
                    let of_x = sensor(&[(own, 1.0)], &[(&fault, 0.1 * share)]);
                    changes.replace.insert(own.clone(), of_x);
                }
                faults.push(fault);
            }
            "redundant" => {
                let half = 0.5_f64.sqrt();
                changes.add.push(sensor(&[(a, half), (b, half)], &[]));
            }
            "no-rate" => changes.remove.push(rates[1].clone()),
            _ => panic!("{kind}"),
        }
    }
    if kind == "shared" {
        changes.faults = Some(faults);
    }
    changes
}

/// The sensors of a channel beside others whose faults are named: its own fault, as without changes.
fn alone(changes: &mut SensorChanges, channel: &str) {
    let rate = format!("{channel}.rate");
    let of_rate = sensor(&[(&rate, 1.0)], &[(channel, 1.0)]);
    let of_x = sensor(&[(channel, 1.0)], &[(channel, 0.1)]);
    changes.replace.insert(rate, of_rate);
    changes.replace.insert(channel.to_string(), of_x);
}

/// The sensors of a reference case on n channels.
pub(crate) fn sensors(kind: &str, n: usize) -> Sensors {
    Sensors::new(&names(n), &design(), &changes(kind, n)).unwrap()
}
