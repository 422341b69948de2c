//! Sensors as they are written, and what must be refused.

use super::cases::{changes, design, names, sensor};
use super::{GOLDEN, matrix};
use serde_json::Value;
use urts_mc::synthesis::{Sensor, SensorChanges, SensorError, Sensors};

fn uav() -> Vec<String> {
    ["x", "y", "z"].map(String::from).into()
}

fn error(change: impl FnOnce(&mut SensorChanges)) -> SensorError {
    let mut changes = SensorChanges::default();
    change(&mut changes);
    Sensors::new(&uav(), &design(), &changes).unwrap_err()
}

#[test]
fn val_matrices_of_the_reference_cases_are_as_written_there() {
    for kind in ["rotated", "shared", "redundant", "no-rate"] {
        let sensors = Sensors::new(&names(2), &design(), &changes(kind, 2)).unwrap();
        let golden = |key: &str| -> Vec<Vec<f64>> {
            let value: &Value = &GOLDEN["gains"][kind][key];
            serde_json::from_value(value.clone()).unwrap()
        };
        // One rounding of a sine.
        assert!(
            (sensors.c() - matrix(&golden("C"))).amax() < 1e-15,
            "{kind}"
        );
        assert!(
            (sensors.b2() - matrix(&golden("B2"))).amax() < 1e-15,
            "{kind}"
        );
        assert_eq!(sensors.channels(), names(2));
    }
}

#[test]
fn sensors_without_a_change_are_three_a_channel_with_its_own_fault() {
    let sensors = Sensors::new(&uav(), &design(), &SensorChanges::default()).unwrap();
    let names: Vec<&str> = sensors.rows().iter().map(|row| &*row.name).collect();
    let expected = [
        "x.integral",
        "y.integral",
        "z.integral",
        "x",
        "y",
        "z",
        "x.rate",
        "y.rate",
        "z.rate",
    ];
    assert_eq!(names, expected);
    assert_eq!(sensors.faults(), uav());
    assert_eq!(sensors.rows()[4].b2, [0.0, 0.1, 0.0]);
    assert_eq!(sensors.rows()[8].b2, [0.0, 0.0, 1.0]);
    assert!(
        sensors
            .rows()
            .iter()
            .all(|row| row.noise.to_bits() == 1e-4_f64.to_bits())
    );
}

#[test]
fn sensors_that_are_added_come_last_and_removed_ones_are_gone() {
    let mut changes = SensorChanges::default();
    changes.add.push(Sensor {
        noise: Some(0.5),
        ..sensor(&[("x", 1.0), ("z.rate", -2.0)], &[("y", 3.0)])
    });
    changes.remove.push("y".into());
    let sensors = Sensors::new(&uav(), &design(), &changes).unwrap();
    assert_eq!(sensors.rows().len(), 9);
    assert!(sensors.rows().iter().all(|row| row.name != "y"));
    let last = &sensors.rows()[8];
    assert_eq!(last.name, "add[0]");
    assert_eq!(last.c, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -2.0]);
    assert_eq!(last.b2, [0.0, 3.0, 0.0]);
    assert_eq!(last.noise.to_bits(), 0.5_f64.to_bits());
}

#[test]
fn fault_of_a_channel_that_strikes_no_sensor_any_more_is_dropped() {
    let changes = SensorChanges {
        remove: vec!["y".into(), "y.rate".into()],
        ..SensorChanges::default()
    };
    let sensors = Sensors::new(&uav(), &design(), &changes).unwrap();
    assert_eq!(sensors.faults(), ["x", "z"]);
    assert_eq!(sensors.b2().shape(), (7, 2));
    assert_eq!(sensors.rows()[6].b2, [0.0, 1.0]);
}

#[test]
fn refuses_an_integral_that_no_sensor_shows() {
    let removed = error(|changes| changes.remove.push("y.integral".into()));
    assert_eq!(
        removed.to_string(),
        "remove = [\"y.integral\"]: no sensor shows the integral of y, so no filter can hold it; \
         keep \"y.integral\" as it is, or add a sensor of it"
    );
    let mixed = error(|changes| {
        for own in ["x.integral", "y.integral"] {
            let both = sensor(&[("x.integral", 1.0), ("y.integral", 1.0)], &[]);
            changes.replace.insert(own.into(), both);
        }
    });
    let said = mixed.to_string();
    assert!(
        said.contains("no sensor shows the integral of x - y,")
            || said.contains("no sensor shows the integral of -x + y,"),
        "{said}"
    );
    assert!(mixed.key.starts_with("replace.\""), "{said}");
    // With one more sensor of either there is a filter.
    let mut changes = SensorChanges::default();
    changes.remove.push("y.integral".into());
    let both = sensor(&[("x.integral", 1.0), ("y.integral", 1.0)], &[]);
    changes.add.push(both);
    assert!(Sensors::new(&uav(), &design(), &changes).is_ok());
}

#[test]
fn refuses_names_that_there_are_not_and_suggests_the_nearest() {
    let of = |of, faults| move |changes: &mut SensorChanges| changes.add.push(sensor(of, faults));
    for (found, expected) in [
        (
            error(|changes| changes.remove.push("y.rat".into())),
            "remove[0] = \"y.rat\": the sensors are x.integral, y.integral, z.integral, x, y, z, \
             x.rate, y.rate, z.rate; did you mean \"y.rate\"?",
        ),
        (
            error(of(&[("x.speed", 1.0)], &[])),
            "add[0].of.\"x.speed\" = 1: the signals are x.integral, y.integral, z.integral, x, y, \
             z, x.rate, y.rate, z.rate; take one of them",
        ),
        (
            error(of(&[("x", 1.0)], &[("imu", 1.0)])),
            "add[0].faults.\"imu\" = 1: the faults are x, y, z; take one of them",
        ),
        (
            error(|changes| {
                changes.faults = Some(Vec::new());
                changes.add.push(sensor(&[("x", 1.0)], &[("x", 1.0)]));
            }),
            "add[0].faults.\"x\" = 1: there are no faults; take one of them",
        ),
    ] {
        assert_eq!(found.to_string(), expected);
    }
}

#[test]
fn refuses_contradictions_and_what_is_beyond_its_limits() {
    let rate = || sensor(&[("x.rate", 1.0)], &[]);
    for (found, key, limit) in [
        (
            error(|changes| {
                changes.replace.insert("x.rate".into(), rate());
                changes.remove.push("x.rate".into());
            }),
            "remove[0]",
            "a sensor is replaced or removed once",
        ),
        (
            error(|changes| changes.remove = vec!["x.rate".into(), "x.rate".into()]),
            "remove[1]",
            "a sensor is replaced or removed once",
        ),
        (
            error(|changes| changes.add.push(Sensor::default())),
            "add[0].of",
            "a sensor measures at least one signal",
        ),
        (
            error(|changes| changes.add.push(sensor(&[("x", 0.0)], &[]))),
            "add[0].of",
            "a sensor measures at least one signal",
        ),
        (
            error(|changes| changes.add.push(sensor(&[("x", 1001.0)], &[]))),
            "add[0].of.\"x\"",
            "must lie within -1000 and 1000",
        ),
        (
            error(|changes| changes.add.push(sensor(&[("x", 1.0)], &[("y", f64::NAN)]))),
            "add[0].faults.\"y\"",
            "must lie within -1000 and 1000",
        ),
        (
            error(|changes| {
                changes
                    .add
                    .push(sensor(&[("x.integral", 1.0)], &[("x", 1.0)]))
            }),
            "add[0].faults",
            "an integral is computed, not sensed, so no sensor fault enters it",
        ),
        (
            error(|changes| {
                let noise = Some(0.0);
                changes.add.push(Sensor { noise, ..rate() });
            }),
            "add[0].noise",
            "must lie within 1e-12 and 1e12",
        ),
        (
            error(|changes| changes.faults = Some(vec!["imu".into()])),
            "faults[0]",
            "strikes no sensor",
        ),
        (
            error(|changes| changes.faults = Some(vec!["imu".into(), "imu".into()])),
            "faults[1]",
            "each has a name of its own",
        ),
        (
            error(|changes| {
                changes.faults = Some(["a", "b", "c", "d"].map(String::from).into());
            }),
            "faults",
            "3 channels have at most so many faults",
        ),
    ] {
        assert_eq!((found.key.as_str(), found.limit.as_str()), (key, limit));
        assert!(!found.remedy.is_empty() && !found.value.is_empty());
    }
    let none = Sensors::new(&[], &design(), &SensorChanges::default()).unwrap_err();
    assert_eq!(none.key, "channels");
}

#[test]
fn sensors_may_be_sound_all_of_them() {
    let changes = SensorChanges {
        faults: Some(Vec::new()),
        ..SensorChanges::default()
    };
    let names = names(4);
    let sensors = Sensors::new(&names, &design(), &changes).unwrap();
    assert_eq!(sensors.b2().shape(), (12, 0));
    let found = urts_mc::synthesis::synthesize_full_order(&design(), &sensors).unwrap();
    assert_eq!(found.gains.l.len(), 28);
    assert!(found.certificate.max_eigenvalue < 0.0);
}
