//! CMA-ES: a search for the smallest value of a function of which nothing is known but its values, which may be noisy.
//!
//! Only the order of the values counts, so they need no scale and may be infinite. Equations and default parameters are
//! those of Hansen, "The CMA evolution strategy: a tutorial" (arXiv 1604.00772, 2016/2023), with negative weights.

use crate::random::philox::{Address, Stream};
use crate::statistics::normal_quantile;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// The state of a search in coordinates in which a step of one is as large in every direction as far as is known.
#[derive(Debug, Clone)]
pub struct CmaEs {
    seed: u64,
    /// Which of several searches under one seed.
    number: u32,
    generation: u32,
    mean: DVector<f64>,
    /// Overall width of the next generation.
    sigma: f64,
    /// Its shape C = B D^2 B', and what C is made of.
    covariance: DMatrix<f64>,
    axes: DMatrix<f64>,
    lengths: DVector<f64>,
    /// Paths of the mean: how long it goes in one direction decides on the width, and stretches the shape.
    path_of_sigma: DVector<f64>,
    path_of_covariance: DVector<f64>,
    rates: Rates,
}

/// How fast is learned from a generation, by dimension and size of the population (Table 1 of the tutorial).
#[derive(Debug, Clone)]
struct Rates {
    /// Weight by rank; those of the better half sum up to 1, the others are negative.
    weights: Vec<f64>,
    parents: usize,
    effective_parents: f64,
    sigma: f64,
    damping: f64,
    path: f64,
    rank_one: f64,
    rank_many: f64,
    /// Expected length of a vector of independent standard normal numbers.
    expected_length: f64,
}

/// The candidates of a generation in so many dimensions, if nothing speaks for another number.
#[must_use]
pub fn usual_population(dimension: usize) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a small positive number"
    )]
    let more = (3.0 * count(dimension.max(1)).ln()) as usize;
    4 + more
}

impl CmaEs {
    /// A search that begins around `mean` with standard deviation `sigma` in every coordinate; a generation has
    /// `population` candidates, at least 4. The same seed and number give the same candidates.
    #[must_use]
    pub fn new(mean: &[f64], sigma: f64, population: usize, seed: u64, number: u32) -> Self {
        let n = mean.len();
        Self {
            seed,
            number,
            generation: 0,
            mean: DVector::from_row_slice(mean),
            sigma,
            covariance: DMatrix::identity(n, n),
            axes: DMatrix::identity(n, n),
            lengths: DVector::from_element(n, 1.0),
            path_of_sigma: DVector::zeros(n),
            path_of_covariance: DVector::zeros(n),
            rates: Rates::new(n, population),
        }
    }

    /// The middle of the next generation: of a noisy function a better result than its best candidate.
    #[must_use]
    pub fn mean(&self) -> &[f64] {
        self.mean.as_slice()
    }

    /// The candidates of the next generation.
    #[must_use]
    pub fn candidates(&self) -> Vec<Vec<f64>> {
        let of = |candidate: usize| {
            let step = self.step(candidate);
            (&self.mean + self.sigma * step).as_slice().to_vec()
        };
        (0..self.rates.weights.len()).map(of).collect()
    }

    /// The search after this generation; `losses` are the values at its [`CmaEs::candidates`].
    #[must_use]
    pub fn after(mut self, losses: &[f64]) -> Self {
        let rates = self.rates.clone();
        let n = count(self.mean.len());
        let mut order: Vec<usize> = (0..losses.len()).collect();
        order.sort_by(|&a, &b| losses[a].total_cmp(&losses[b]));
        let steps: Vec<DVector<f64>> = order.iter().map(|&rank| self.step(rank)).collect();
        let ranked = rates.weights.iter().zip(&steps);

        let zero = DVector::zeros(self.mean.len());
        let of_parents = ranked.clone().take(rates.parents);
        let towards = of_parents.fold(zero, |sum, (weight, step)| sum + *weight * step);
        self.mean += self.sigma * &towards;
        self.generation += 1;

        let whitened = |step: &DVector<f64>| {
            let along = self.axes.tr_mul(step).component_div(&self.lengths);
            &self.axes * along
        };
        let [of_sigma, of_covariance] = [rates.sigma, rates.path]
            .map(|rate| (rate * (2.0 - rate) * rates.effective_parents).sqrt());
        self.path_of_sigma =
            (1.0 - rates.sigma) * &self.path_of_sigma + of_sigma * whitened(&towards);
        let length = self.path_of_sigma.norm();
        // While the path is long by its start alone, the shape does not learn from it.
        let generations = f64::from(self.generation);
        let settled = (1.0 - (1.0 - rates.sigma).powf(2.0 * generations)).sqrt();
        let learns = length / settled < (1.4 + 2.0 / (n + 1.0)) * rates.expected_length;
        self.path_of_covariance *= 1.0 - rates.path;
        if learns {
            self.path_of_covariance += of_covariance * &towards;
        }

        let missing = if learns {
            0.0
        } else {
            rates.path * (2.0 - rates.path)
        };
        let sum: f64 = rates.weights.iter().sum();
        let kept = 1.0 + rates.rank_one * missing - rates.rank_one - rates.rank_many * sum;
        let path = &self.path_of_covariance;
        let mut covariance = kept * &self.covariance + rates.rank_one * path * path.transpose();
        for (&weight, step) in ranked {
            // What is taken away must leave the shape positive, however long the step is.
            let scale = if weight < 0.0 {
                n / whitened(step).norm_squared()
            } else {
                1.0
            };
            covariance += rates.rank_many * weight * scale * step * step.transpose();
        }
        self.covariance = (&covariance + covariance.transpose()) / 2.0;
        self.sigma *= (rates.sigma / rates.damping * (length / rates.expected_length - 1.0)).exp();
        let SymmetricEigen {
            eigenvectors,
            eigenvalues,
        } = SymmetricEigen::new(self.covariance.clone());
        self.axes = eigenvectors;
        self.lengths = eigenvalues.map(|value| value.max(f64::MIN_POSITIVE).sqrt());
        self
    }

    /// A candidate's way from the mean, in units of sigma.
    fn step(&self, candidate: usize) -> DVector<f64> {
        let number = |coordinate: usize| {
            let address = Address {
                episode: self.generation,
                stream: Stream::Search,
                entry: self.number,
                member: small(candidate),
                index: small(coordinate),
            };
            normal_quantile(address.unit(self.seed))
        };
        let along = DVector::from_fn(self.mean.len(), |row, _| self.lengths[row] * number(row));
        &self.axes * along
    }
}

impl Rates {
    fn new(dimension: usize, population: usize) -> Self {
        let n = count(dimension);
        let population = population.max(4);
        let raw = |rank: usize| ((count(population) + 1.0) / 2.0).ln() - count(rank + 1).ln();
        let raw: Vec<f64> = (0..population).map(raw).collect();
        let parents = population / 2;
        let effective = |weights: &[f64]| {
            weights.iter().sum::<f64>().powi(2)
                / weights.iter().map(|weight| weight * weight).sum::<f64>()
        };
        let (better, worse) = raw.split_at(parents);
        let (effective_parents, effective_others) = (effective(better), effective(worse));
        let sigma = (effective_parents + 2.0) / (n + effective_parents + 5.0);
        let rank_one = 2.0 / ((n + 1.3).powi(2) + effective_parents);
        let rank_many = (1.0 - rank_one).min(
            2.0 * (0.25 + effective_parents + 1.0 / effective_parents - 2.0)
                / ((n + 2.0).powi(2) + effective_parents),
        );
        let largest_others = (1.0 + rank_one / rank_many)
            .min(1.0 + 2.0 * effective_others / (effective_parents + 2.0))
            .min((1.0 - rank_one - rank_many) / (n * rank_many));
        let sum = |weights: &[f64]| weights.iter().map(|weight| weight.abs()).sum::<f64>();
        let [of_better, of_worse] = [1.0 / sum(better), largest_others / sum(worse)];
        let scaled = |weight: &f64| weight * if *weight >= 0.0 { of_better } else { of_worse };
        let weights = raw.iter().map(scaled).collect();
        let damped = (((effective_parents - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0);
        Self {
            weights,
            parents,
            effective_parents,
            sigma,
            damping: 1.0 + 2.0 * damped + sigma,
            path: (4.0 + effective_parents / n) / (n + 4.0 + 2.0 * effective_parents / n),
            rank_one,
            rank_many,
            expected_length: n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n)),
        }
    }
}

#[expect(clippy::cast_precision_loss, reason = "small counts")]
fn count(n: usize) -> f64 {
    n as f64
}

fn small(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}
