//! Wind: the force of a gust at every step, and variance and spectrum of turbulence.

use super::{DRAG_N_S_M, MASS_KG, campaign, near, parsed, time_s, trajectory};
use urts_mc::model::ChannelSample;

/// The force on a channel of translation whose command acts as it is wanted.
fn force_n(shown: &ChannelSample) -> f64 {
    MASS_KG * shown.f1 + DRAG_N_S_M * shown.e_rate
}

#[test]
fn val_a_gust_is_one_turn_of_a_cosine() {
    let gust = "[[disturbance]]\nkind = \"gust-1-cosine\"\nspeed_m_s = [6.0, -3.0, 0.0, 0.0, 0.0, 0.0]\ngain_n_s_m = 1.5\nonset_s = 0.3\nduration_s = 0.4\n";
    let (simulated, still) = (trajectory(&campaign(gust)), trajectory(&campaign("")));
    for (step, agents) in simulated.iter().enumerate() {
        for (channel, peak_n) in [(0, 9.0), (1, -4.5), (2, 0.0)] {
            let since_s = time_s(step) - 0.3;
            let blows = (150..350).contains(&step);
            let shape = 0.5 * (1.0 - (std::f64::consts::TAU * since_s / 0.4).cos());
            let expected = if blows { peak_n * shape } else { 0.0 };
            near(
                force_n(&agents[0][channel]),
                expected,
                "the force of a gust",
            );
        }
        // Wind turns nothing.
        near(agents[0][3].x, still[step][0][3].x, "roll");
    }
}

/// Forces of turbulence on the three axes, `[axis][step]`: eight UAVs over 60 s.
fn turbulence() -> Vec<Vec<Vec<f64>>> {
    let more = "[[disturbance]]\nkind = \"dryden\"\nintensity = \"moderate\"\naltitude_m = 6.0\nairspeed_m_s = 20.0\ngain_n_s_m = 1.5\n";
    let long = ["time.duration_s=60.0", "time.step_s=0.005", "agent.team=8"];
    let simulated = trajectory(&parsed(more, &long).unwrap());
    let agents = 0..8;
    agents
        .map(|agent| {
            let of_axis = |axis: usize| {
                simulated
                    .iter()
                    .map(|agents| force_n(&agents[agent][axis]))
                    .collect()
            };
            (0..3).map(of_axis).collect()
        })
        .collect()
}

/// Standard deviation of the gusts along an axis, m/s, and the time in which the field passes, s: the formulas of
/// MIL-F-8785C in feet, with 30 kn 20 ft above the ground.
fn specified(axis: usize) -> (f64, f64) {
    let height_ft: f64 = 6.0 / 0.3048;
    let speed_ft_s = 20.0 / 0.3048;
    let wind_ft_s = 30.0 * 1.687_81;
    let sigma_w = 0.1 * wind_ft_s;
    let base = 0.177 + 0.000_823 * height_ft;
    let (sigma_ft_s, length_ft) = if axis == 2 {
        (sigma_w, height_ft)
    } else {
        (sigma_w / base.powf(0.4), height_ft / base.powf(1.2))
    };
    (sigma_ft_s * 0.3048, length_ft / speed_ft_s)
}

#[test]
fn val_turbulence_has_the_variance_of_the_standard() {
    let simulated = turbulence();
    for axis in 0..3 {
        let (sigma_m_s, passes_s) = specified(axis);
        let all = || {
            simulated
                .iter()
                .flat_map(|agent| agent[axis].iter().copied())
        };
        let count = all().count() as f64;
        let variance = all().map(|force| force * force).sum::<f64>() / count;
        let expected = (1.5 * sigma_m_s).powi(2);
        // 480 s hold some 480/(2 T) independent values, whose mean square scatters by sqrt(2/n): five times that.
        let scatter = 5.0 * (2.0 * 2.0 * passes_s / 480.0).sqrt();
        assert!(
            (variance / expected - 1.0).abs() < scatter,
            "axis {axis}: {variance:.3} and not {expected:.3} N^2, within {scatter:.2}"
        );
        assert!(scatter < 0.8, "axis {axis}: the test can fail");
    }
}

#[test]
fn val_turbulence_has_the_spectrum_of_the_standard() {
    let simulated = turbulence();
    for axis in 0..3 {
        let (sigma_m_s, passes_s) = specified(axis);
        // Periodograms of pieces of 10.24 s, averaged over 40 pieces and the frequencies of a band.
        let piece = 2048;
        let step_s = 0.005;
        for band in [2..5, 5..12, 12..30, 30..80, 80..200] {
            let (mut found, mut expected, mut count) = (0.0, 0.0, 0.0);
            for k in band.clone() {
                let w = std::f64::consts::TAU * k as f64 / (piece as f64 * step_s);
                let x2 = (w * passes_s).powi(2);
                // Two-sided, per Hz, so that its integral is the variance.
                let shape = if axis == 0 {
                    2.0 / (1.0 + x2)
                } else {
                    (1.0 + 3.0 * x2) / (1.0 + x2).powi(2)
                };
                expected += (1.5 * sigma_m_s).powi(2) * passes_s * shape;
                for agent in &simulated {
                    for samples in agent[axis].chunks_exact(piece) {
                        found += periodogram(samples, k, step_s);
                        count += 1.0 / band.len() as f64;
                    }
                }
            }
            let ratio = found / count / expected;
            // Each value of a periodogram scatters by its mean; windows leak, up to 4 % here. Five times, over all of
            // them.
            let scatter = 5.0 / (count * band.len() as f64).sqrt() + 0.04;
            assert!(
                (ratio - 1.0).abs() < scatter,
                "axis {axis}, band {band:?}: {ratio:.3} of the spectrum, within {scatter:.2}"
            );
        }
    }
}

/// Power density of samples at frequency number `k`, seen through a Hann window.
fn periodogram(samples: &[f64], k: usize, step_s: f64) -> f64 {
    let n = samples.len() as f64;
    let (mut real, mut imaginary) = (0.0, 0.0);
    for (i, sample) in samples.iter().enumerate() {
        let turn = std::f64::consts::TAU * i as f64 / n;
        let seen = sample * (0.5 - 0.5 * turn.cos());
        let (sine, cosine) = (turn * k as f64).sin_cos();
        real += seen * cosine;
        imaginary += seen * sine;
    }
    (real * real + imaginary * imaginary) * step_s / (0.375 * n)
}
