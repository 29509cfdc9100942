// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light that sheets scatter on and back: shares of cones, kernels, energy, the exact sum of all bounces, and that more scattering
//! is more light at every point.

mod kernels;
mod light;
mod pictures;
