//! Faults of one episode leave those beside it in a block alone.

use crate::common::{gains, repository};
use urts_mc::backend::cpu::{Cpu, Precision, Simd};
use urts_mc::campaign::Campaign;

#[test]
fn all_faults_at_once_give_the_same_bits_alone_and_in_blocks_of_any_width() {
    for name in ["uav_faults", "thrust_faults", "biped_faults"] {
        let path = repository(&format!("tests/suite/backend/gpu/{name}.toml"));
        let campaign = Campaign::load(&path).unwrap().with_episodes(11).unwrap();
        let gains = gains(&campaign).loops();
        let digits = |precision, simd, episodes| {
            let cpu = Cpu::new(campaign.first_group(), &gains, precision, simd);
            let simulated = cpu.simulate(episodes, &|_| ()).into_iter();
            simulated
                .map(|simulated| format!("{simulated:?}"))
                .collect::<Vec<_>>()
        };
        // Both vector widths fuse every multiply-add.
        let widths = [Simd::Avx2, Simd::Avx512].into_iter();
        let widths: Vec<Simd> = widths.filter(|simd| simd.is_available()).collect();
        for (precision, simds) in [
            (Precision::F32, widths.iter().copied().map(Some).collect()),
            (Precision::F32, vec![Some(Simd::Scalar)]),
            (Precision::F64, vec![None]),
        ] {
            let all: Vec<_> = simds
                .iter()
                .map(|&simd| digits(precision, simd, 0..11))
                .collect();
            for (&simd, own) in simds.iter().zip(&all) {
                assert!(own == &all[0], "{name}: {simd:?}");
                assert!(
                    digits(precision, simd, 7..8)[0] == own[7],
                    "{name}: alone, {simd:?}"
                );
            }
        }
    }
}
