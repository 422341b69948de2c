//! Exact Euclidean distance transform (Felzenszwalb and Huttenlocher, "Distance transforms of sampled functions",
//! Theory of Computing 8:415-428, 2012).

use crate::mission::plane::number;
use crate::mission::world::raster::Raster;

/// Distance where nothing is occupied, m.
const NOTHING_NEAR_M: f64 = 1e6;

/// Distance of every cell's centre to the centre of the nearest occupied cell, m.
pub(super) fn to_occupied_m(occupied: &[bool], raster: &Raster) -> Vec<f64> {
    if !occupied.contains(&true) {
        return vec![NOTHING_NEAR_M; occupied.len()];
    }
    let (columns, rows) = (raster.columns(), raster.rows());
    let zero_if = |&occupied: &bool| if occupied { 0.0 } else { f64::INFINITY };
    let mut squares: Vec<f64> = occupied.iter().map(zero_if).collect();
    let mut envelope = Envelope::default();
    let mut line = Vec::with_capacity(rows.max(columns));
    for column in 0..columns {
        line.clear();
        line.extend((0..rows).map(|row| squares[row * columns + column]));
        envelope.transform(&mut line);
        for (row, &square) in line.iter().enumerate() {
            squares[row * columns + column] = square;
        }
    }
    for row in squares.chunks_mut(columns) {
        envelope.transform(row);
    }
    let to_metres = |square: f64| square.sqrt() * raster.resolution_m();
    squares.into_iter().map(to_metres).collect()
}

/// The lower envelope of the parabolas (x - q)² + f(q): where each of them is the lowest begins at its `from`.
#[derive(Default)]
struct Envelope {
    parabolas: Vec<Parabola>,
}

struct Parabola {
    q: usize,
    height: f64,
    from: f64,
}

impl Envelope {
    /// Replaces f by the minimum over q of (x - q)² + f(q).
    fn transform(&mut self, values: &mut [f64]) {
        self.parabolas.clear();
        for (q, &height) in values.iter().enumerate().filter(|(_, f)| f.is_finite()) {
            let mut from = f64::NEG_INFINITY;
            while let Some(last) = self.parabolas.last() {
                let (a, b) = (number(last.q), number(q));
                from = ((height + b * b) - (last.height + a * a)) / (2.0 * (b - a));
                if from > last.from {
                    break;
                }
                self.parabolas.pop();
                from = f64::NEG_INFINITY;
            }
            self.parabolas.push(Parabola { q, height, from });
        }
        let mut lowest = 0;
        for (x, value) in values.iter_mut().enumerate() {
            let next_begins = |lowest: usize| self.parabolas.get(lowest + 1).map(|p| p.from);
            while next_begins(lowest).is_some_and(|from| from < number(x)) {
                lowest += 1;
            }
            if let Some(parabola) = self.parabolas.get(lowest) {
                let apart = number(x) - number(parabola.q);
                *value = apart * apart + parabola.height;
            }
        }
    }
}
