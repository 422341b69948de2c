//! How long full-order synthesis takes by the number of coupled channels: `cargo bench --bench full_order`.
#![expect(clippy::print_stdout, reason = "a benchmark prints")]
#![expect(clippy::unwrap_used, reason = "a benchmark may stop where it stands")]

#[path = "../suite/synthesis/full_order/cases.rs"]
mod cases;

use std::time::Instant;
use urts_mc::synthesis::synthesize_full_order;

fn main() {
    println!(
        "states sensors     norm       slowest pole  residual  max of (27)  residual  s      of it Clarabel  difference"
    );
    for (kind, n) in [
        ("kronecker", 1),
        ("kronecker", 2),
        ("rotated", 2),
        ("shared", 2),
        ("redundant", 2),
        ("no-rate", 2),
        ("rotated", 3),
        ("rotated", 6),
        ("shared", 6),
        ("rotated", 12),
        ("redundant", 12),
    ] {
        let sensors = cases::sensors(kind, n);
        let start = Instant::now();
        let found = synthesize_full_order(&cases::design(), &sensors)
            .unwrap_or_else(|error| panic!("{kind} {n}: {error}"));
        let seconds = start.elapsed().as_secs_f64();
        let certificate = &found.certificate;
        let (clarabel, difference) = found
            .confirmation
            .as_ref()
            .map_or((0.0, f64::NAN), |own| (own.solve_time_s, own.difference));
        println!(
            "{:5}  {kind:9} {n:2}  {:.6}  {:.9}  {:.1e}  {:+.2e}  {:.1e}  {seconds:5.2}  {clarabel:5.2}  {difference:.1e}",
            found.gains.l.len(),
            certificate.hinf_norm,
            found.slowest_pole_per_s,
            found.residual,
            certificate.max_eigenvalue,
            certificate.residual,
        );
    }
}
