//! Latin hypercubes.

use super::permutation::{bits_of, permuted};
use super::philox::{Address, Stream};
use super::purpose::Purpose;

/// The number in (0, 1) of a `dimension` in an `episode` of a Latin hypercube of `n` episodes
/// (McKay, Beckman and Conover 1979, Technometrics 21:239-245).
///
/// Over the episodes 0..n each of the strata ((i) / n, (i + 1) / n) is hit once in every dimension,
/// in an order of its own, at a uniformly random place. The episodes from n on make the next
/// hypercube, independent of the first, and so on: replicate r is r n..(r + 1) n. An `n` of 0 counts
/// as 1.
#[must_use]
pub fn latin_hypercube(seed: u64, dimension: u32, n: u32, episode: u32) -> f64 {
    let n = n.max(1);
    let (replicate, row) = (episode / n, episode % n);
    let words = |entry: u32, index: u32| {
        Address {
            episode: replicate,
            stream: Stream::Design,
            entry,
            member: dimension,
            index,
        }
        .words(seed)
    };
    let stratum = permuted(row, n, |round, half| {
        words(Purpose::Strata as u32 + round, half)[0]
    });
    // As many random digits as leave the sum and the product with n exact in double precision, so
    // that no rounding leaves the stratum.
    let digits = 50 - bits_of(n);
    let [w0, w1, ..] = words(Purpose::Place as u32, row);
    let place = ((u64::from(w0) << 32) | u64::from(w1)) >> (64 - digits);
    let numerator = (u64::from(stratum) << digits) | place;
    let denominator = u64::from(n) << digits;
    (numerator as f64 + 0.5) / denominator as f64
}
