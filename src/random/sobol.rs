//! Scrambled Sobol points.

use super::philox::{Address, Stream};
use super::purpose::Purpose;

/// Dimensions that share a net; further groups are padded with independently shuffled ones.
const GROUP: u32 = 4;
const DIGITS: u32 = u32::BITS;

/// The number in (0, 1) of a `dimension` in the point `index` of the Sobol sequence number
/// `replicate`, shuffled and scrambled.
///
/// **Points.** Each four dimensions are the first four of Sobol's sequence in base 2 (direction
/// numbers: Joe and Kuo 2008, SIAM Journal on Scientific Computing 30:2635-2654). Groups are shuffled
/// against each other and padded, as in Burley 2020 ("Practical hash-based Owen scrambling",
/// Journal of Computer Graphics Techniques 9(4):1-20), so that there are as many dimensions as one
/// likes, and none is worse than another.
///
/// **Scrambling.** Owen's nested uniform scrambling (1995, in Monte Carlo and Quasi-Monte Carlo
/// Methods in Scientific Computing, 299-317), in full: whether a digit is flipped is a random bit
/// addressed by all digits before it. One counter holds the bits of seven levels of that tree, so
/// that a number takes eleven counters. No two points agree on all 32 digits, so that the digits
/// below them are independent random ones.
///
/// **What holds.** Each number is uniform, and replicates are independent. Of the first 2^m points
/// of a replicate, every dyadic interval of length 2^-m has one in each dimension; the first two
/// dimensions of a group are a (0, m, 2)-net (one point in every dyadic box of area 2^-m), other
/// pairs have t <= 2 and all four t <= 3 (2^t points in every box of volume 2^(t - m), up to m = 10).
/// So the number of points should be a power of two, and the interval of an estimate comes from
/// several replicates.
#[must_use]
pub fn sobol(seed: u64, replicate: u32, dimension: u32, index: u32) -> f64 {
    let words = |purpose: u32, member: u32, index: u32| {
        Address {
            episode: replicate,
            stream: Stream::Design,
            entry: purpose,
            member,
            index,
        }
        .words(seed)
    };
    let (group, component) = (dimension / GROUP, (dimension % GROUP) as usize);
    // The shuffle swaps halves of the sequence, halves of halves, and so on: an aligned block of
    // 2^m points becomes another one, and each of these is a net.
    let place = scrambled(index, |level, digits| {
        words(Purpose::Shuffle as u32 + level, group, digits)
    });
    let point = (0..DIGITS)
        .filter(|digit| place >> digit & 1 == 1)
        .fold(0, |point, digit| {
            point ^ DIRECTIONS[component][digit as usize]
        });
    let scrambled = scrambled(point, |level, digits| {
        words(Purpose::Scramble as u32 + level, dimension, digits)
    });
    let [tail, ..] = words(Purpose::Tail as u32, dimension, scrambled);
    let bits = (u64::from(scrambled) << 20) | u64::from(tail >> 12);
    (bits as f64 + 0.5) * (1.0 / 4_503_599_627_370_496.0)
}

/// Nested uniform scrambling of a binary fraction: each digit is flipped or not by a random bit that
/// depends on the digits before it. `random(level, digits)` gives 128 bits for the seven digits
/// that follow the first 7 `level` digits.
fn scrambled(fraction: u32, random: impl Fn(u32, u32) -> [u32; 4]) -> u32 {
    const LEVELS: u32 = 7;
    let mut flips = 0;
    for first in (0..DIGITS).step_by(LEVELS as usize) {
        let words = random(
            first / LEVELS,
            fraction.checked_shr(DIGITS - first).unwrap_or(0),
        );
        // The nodes of the subtree, numbered as a heap: 1, 2 to 3, .. 64 to 127.
        let mut node = 1;
        for digit in first..DIGITS.min(first + LEVELS) {
            let shift = DIGITS - 1 - digit;
            flips |= (words[node / 32] >> (node % 32) & 1) << shift;
            node = 2 * node + (fraction >> shift & 1) as usize;
        }
    }
    fraction ^ flips
}

/// Columns of the generator matrices, the first digit of the fraction in the highest bit.
const DIRECTIONS: [[u32; DIGITS as usize]; GROUP as usize] = [
    // The first dimension is van der Corput's: the reversed digits of the index.
    reversed_digits(),
    // Joe and Kuo's file new-joe-kuo-6.21201: degree, coefficients and initial numbers.
    directions([1], 0),
    directions([1, 3], 1),
    directions([1, 3, 1], 1),
];

const fn reversed_digits() -> [u32; DIGITS as usize] {
    let mut columns = [0; DIGITS as usize];
    let mut k = 0;
    while k < columns.len() {
        columns[k] = 1 << (columns.len() - 1 - k);
        k += 1;
    }
    columns
}

/// The direction numbers of a primitive polynomial of degree S with the inner `coefficients`, by
/// its recurrence (Bratley and Fox 1988, ACM Transactions on Mathematical Software 14:88-100).
const fn directions<const S: usize>(
    initial: [u32; S],
    coefficients: u32,
) -> [u32; DIGITS as usize] {
    let mut columns = [0; DIGITS as usize];
    let mut k = 0;
    while k < columns.len() {
        columns[k] = if k < S {
            initial[k] << (columns.len() - 1 - k)
        } else {
            let mut sum = columns[k - S] ^ (columns[k - S] >> S);
            let mut i = 1;
            while i < S {
                sum ^= (coefficients >> (S - 1 - i) & 1) * columns[k - i];
                i += 1;
            }
            sum
        };
        k += 1;
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::{DIRECTIONS, GROUP};

    /// The leading `digits` of a plain, unscrambled point.
    fn plain(index: u32, digits: u32) -> [u32; GROUP as usize] {
        let sum = |columns: &[u32; 32]| {
            let chosen = (0..32).filter(|&digit| index >> digit & 1 == 1);
            chosen.fold(0, |point, digit| point ^ columns[digit]) >> (32 - digits)
        };
        [0, 1, 2, 3].map(|component| sum(&DIRECTIONS[component]))
    }

    #[test]
    fn val_the_plain_points_are_those_of_scipy() {
        // scipy.stats.qmc.Sobol(4, scramble=False) in SciPy 1.17.1, which goes through the sequence
        // in the order of the Gray code, put back in order.
        let sixteenths = [
            [0, 0, 0, 0],
            [8, 8, 8, 8],
            [4, 12, 12, 12],
            [12, 4, 4, 4],
            [2, 10, 6, 2],
            [10, 2, 14, 10],
            [6, 6, 10, 14],
            [14, 14, 2, 6],
            [1, 15, 9, 5],
            [9, 7, 1, 13],
            [5, 3, 5, 9],
            [13, 11, 13, 1],
            [3, 5, 15, 7],
            [11, 13, 7, 15],
            [7, 9, 3, 11],
            [15, 1, 11, 3],
        ];
        for (index, expected) in (0..).zip(sixteenths) {
            assert_eq!(plain(index, 4), expected);
        }
        let further = [
            (100, [152, 792, 712, 984]),
            (511, [1022, 518, 158, 342]),
            (777, [579, 193, 913, 183]),
            (1023, [1023, 261, 749, 451]),
        ];
        for (index, expected) in further {
            assert_eq!(plain(index, 10), expected);
        }
    }
}
