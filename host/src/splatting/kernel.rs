// SPDX-License-Identifier: MIT OR Apache-2.0
//! The kernel of splats.

use super::SplattingError;
use crate::out_of_range::in_range;
use encase::ShaderType;

/// The uniform `Kernel` of `splatting/footprint`: a Gaussian of voxels less its tangent at a radius, where it ends.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct Kernel {
    /// Standard deviation, voxels.
    pub sigma: f32,
    /// Where it ends, voxels.
    pub radius: f32,
    /// Factor on sections, so that the kernel holds 1.
    pub scale: f32,
    /// The Gaussian at the radius.
    pub edge: f32,
}

impl Kernel {
    /// A kernel. `sigma`: standard deviation, 0.3 to 4 voxels; below 0.6 a constant volume shows its lattice. `radius`: 1 to 3.5
    /// times that.
    ///
    /// # Errors
    /// [`SplattingError::Setting`].
    pub fn new(sigma: f32, radius: f32) -> Result<Self, SplattingError> {
        in_range("standard deviation of the kernel", sigma, 0.3..=4.0, "from 0.3 to 4 voxels")?;
        let range = "from 1 to 3.5 standard deviations";
        in_range("radius of the kernel", radius, sigma..=3.5001 * sigma, range)?;
        let [s, r] = [sigma, radius].map(f64::from);
        let edge = (-0.5 * (r / s).powi(2)).exp();
        let scale = held(s, r, edge).recip();
        Ok(Self { sigma, radius, scale: scale as f32, edge: edge as f32 })
    }
}

impl Default for Kernel {
    /// 0.7 voxels that end at 2.25: a constant volume ripples by 0.2 %.
    fn default() -> Self {
        let [s, r] = [0.7_f32, 2.25].map(f64::from);
        let edge = (-0.5 * (r / s).powi(2)).exp();
        Self { sigma: 0.7, radius: 2.25, scale: held(s, r, edge).recip() as f32, edge: edge as f32 }
    }
}

/// What a kernel of scale 1 holds, by Simpson's rule over spheres.
fn held(s: f64, r: f64, edge: f64) -> f64 {
    const STEPS: u32 = 512;
    let kernel = |t: f64| (-0.5 * (t / s).powi(2)).exp() - edge * (1.0 + 0.5 * (r * r - t * t) / (s * s));
    let step = r / f64::from(STEPS);
    let weight = |i: u32| match i {
        0 | STEPS => 1.0,
        i if i % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let shell = |i: u32| {
        let t = step * f64::from(i);
        weight(i) * 4.0 * std::f64::consts::PI * t * t * kernel(t)
    };
    (0..=STEPS).map(shell).sum::<f64>() * step / 3.0
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn wide_kernels_hold_what_gaussians_do() {
        let edge = (-0.5_f64 * 64.0).exp();
        let gaussian = (std::f64::consts::TAU * 0.49).powf(1.5);
        assert!((held(0.7, 5.6, edge) / gaussian - 1.0).abs() < 1e-8);
        // The integral of the Gaussian in the ball less those of both parts of the tangent, from a table of chi with three degrees.
        let edge = (-0.5_f64 * 4.0).exp();
        let ball = 4.0 / 3.0 * std::f64::consts::PI * 8.0;
        let expected = 0.738_535_87 * std::f64::consts::TAU.powf(1.5) - edge * ball * (1.0 + 2.0 * 0.4);
        assert!((held(1.0, 2.0, edge) - expected).abs() < 1e-6, "{}", held(1.0, 2.0, edge));
    }

    #[test]
    fn impossible_kernels_are_refused() {
        for (sigma, radius) in
            [(0.0, 1.0), (-1.0, 2.0), (f32::NAN, 2.0), (0.65, -2.0), (0.65, f32::NAN), (0.65, 3.0)]
        {
            assert!(Kernel::new(sigma, radius).is_err(), "{sigma} {radius}");
        }
        assert_eq!(Kernel::default(), Kernel::new(0.7, 2.25).unwrap());
    }
}
