// SPDX-License-Identifier: MIT OR Apache-2.0
//! Iterations of a solver, and the best of them.

use super::cancel::Cancel;
use crate::Gpu;
use crate::inverse::{InverseError, LightSolver, Solver};

/// A solver.
pub trait Iterated {
    /// One iteration.
    fn iterate(&mut self, gpu: &Gpu) -> Result<(), InverseError>;
    /// What was wrong when each began.
    fn residuals(&self, gpu: &Gpu) -> Result<Vec<[f32; 3]>, InverseError>;
    /// What was found so far: volumes, or coefficients.
    fn solutions(&self, gpu: &Gpu) -> Result<Vec<Vec<f32>>, InverseError>;
}

impl Iterated for Solver {
    fn iterate(&mut self, gpu: &Gpu) -> Result<(), InverseError> {
        Self::iterate(self, gpu)
    }

    fn residuals(&self, gpu: &Gpu) -> Result<Vec<[f32; 3]>, InverseError> {
        Self::residuals(self, gpu)
    }

    fn solutions(&self, gpu: &Gpu) -> Result<Vec<Vec<f32>>, InverseError> {
        Self::solutions(self, gpu)
    }
}

impl Iterated for LightSolver {
    fn iterate(&mut self, gpu: &Gpu) -> Result<(), InverseError> {
        Self::iterate(self, gpu)
    }

    fn residuals(&self, gpu: &Gpu) -> Result<Vec<[f32; 3]>, InverseError> {
        Self::residuals(self, gpu)
    }

    fn solutions(&self, gpu: &Gpu) -> Result<Vec<Vec<f32>>, InverseError> {
        Ok(vec![self.coefficients(gpu)?])
    }
}

/// What iterations came to.
pub struct Descent {
    /// What was wrong when each began: weighed sums of squares by channel.
    pub residuals: Vec<[f32; 3]>,
    /// What was found after the last one.
    pub last: Vec<Vec<f32>>,
    /// That of the least residual so far, before the last one, and that residual; none before the first.
    pub best: Option<(f64, Vec<Vec<f32>>)>,
}

/// Iterates until it is done or cancelled. `told`: hears the residuals after each iteration.
///
/// # Errors
/// [`InverseError`].
pub fn descend(
    gpu: &Gpu,
    solver: &mut impl Iterated,
    iterations: u32,
    cancel: &Cancel,
    mut told: impl FnMut(&[[f32; 3]]),
) -> Result<Descent, InverseError> {
    let mut descent = Descent { residuals: Vec::new(), last: solver.solutions(gpu)?, best: None };
    for _ in 0..iterations {
        if cancel.asked() {
            break;
        }
        solver.iterate(gpu)?;
        descent.residuals = solver.residuals(gpu)?;
        told(&descent.residuals);
        let residual = descent.residuals.last().map_or(f64::INFINITY, sum);
        let before = std::mem::replace(&mut descent.last, solver.solutions(gpu)?);
        // An iteration tells the residual with which it began.
        if descent.best.as_ref().is_none_or(|(least, _)| residual < *least) {
            descent.best = Some((residual, before));
        }
    }
    Ok(descent)
}

/// Of all channels.
pub fn sum(residual: &[f32; 3]) -> f64 {
    residual.iter().map(|channel| f64::from(*channel)).sum()
}
