//! A PID by what a control engineer would turn: the poles of its error, and how fast its observer follows what is
//! measured.

use super::channel::ERROR_STATES;
use super::error::{Step, SynthesisError};
use super::gains::ControllerGains;
use super::observer::ObserverProblem;
use nalgebra::DMatrix;

/// The shape of a PID: all that its feedback of three numbers and a Kalman filter of the same model leave free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PidShape {
    /// The error has a pole at minus this, rad/s.
    pub real_rad_s: f64,
    /// And a pair of poles of this natural frequency, rad/s.
    pub pair_rad_s: f64,
    /// The damping ratio of the pair.
    pub damping: f64,
    /// How fast the observer would be that hears only one of the measurements int x, x and x', rad/s: their noise, in
    /// units of the model's.
    pub observer_rad_s: [f64; 3],
}

impl PidShape {
    /// K and L of the shape.
    ///
    /// # Errors
    /// If the observer's Riccati equation has no solution, which positive finite numbers exclude.
    pub fn gains(&self) -> Result<ControllerGains, SynthesisError> {
        let (p, w, zeta) = (self.real_rad_s, self.pair_rad_s, self.damping);
        // (s + p) (s^2 + 2 zeta w s + w^2) = s^3 - k3 s^2 - k2 s - k1
        let k = [
            -p * w.powi(2),
            -(2.0 * zeta * w * p + w.powi(2)),
            -(p + 2.0 * zeta * w),
        ];
        Ok(ControllerGains::from_matrices(
            &DMatrix::from_row_slice(1, ERROR_STATES, &k),
            &self.observer()?,
        ))
    }

    /// L, in a unit of time in which the speeds are about one: in seconds the Riccati equation holds numbers from 1 to
    /// 1e18.
    fn observer(&self) -> Result<DMatrix<f64>, SynthesisError> {
        let unit = self.observer_rad_s.iter().product::<f64>().cbrt();
        let [integral, position, rate] = self.observer_rad_s.map(|own| own / unit);
        // A model error drives int x over three integrators, x over two and x' over one.
        let noise = [integral.powi(-3), position.powi(-2), rate.powi(-1)];
        let problem = ObserverProblem::pid(1.0, noise);
        // Without weights the level does not matter.
        let solution = problem.riccati(1.0).ok_or(SynthesisError::NotConverged {
            step: Step::Pid,
            what: "the Riccati equation of the observer",
        })?;
        let scale = [unit.powi(2), unit, 1.0];
        let l = problem.gain(&solution);
        Ok(DMatrix::from_fn(
            ERROR_STATES,
            ERROR_STATES,
            |row, column| unit * l[(row, column)] * scale[column] / scale[row],
        ))
    }
}
