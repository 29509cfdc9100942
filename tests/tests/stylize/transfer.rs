// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions against f64: diffusion, layers, the place of a ray, what is made of a colour; and picks, key frames and
//! files that move from scene to scene.

mod baking;
mod diffusion;
mod files;
mod fused;
mod key_frames;
mod layers;
mod marched;
mod picks;
mod restyling;
mod synthetic;
