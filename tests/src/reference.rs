// SPDX-License-Identifier: MIT OR Apache-2.0
//! One reference a system, under the system's name, and one for each shared building block.

pub mod ambient;
pub mod camera;
pub mod fourier;
pub mod inverse;
pub mod light;
pub mod noise;
pub mod painterly;
pub mod phase;
pub mod prefix_sum;
pub mod scattering;
pub mod splatting;
pub mod stylize;
pub mod transmittance;
