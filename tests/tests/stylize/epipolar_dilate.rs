// SPDX-License-Identifier: MIT OR Apache-2.0
//! Extrusion of blockers along view rays: the direct form against Eq. 3 in f64, the rectified form against what
//! resampling may do to it, and the promise that the camera never sees what was added.

mod epipole;
mod equation;
mod morphed;
mod promises;
