// SPDX-License-Identifier: MIT OR Apache-2.0
//! Soft shadows between sheets: penumbras of half-planes have the width that geometry says, at any tilt and distance, and a ball's
//! shadow is that of a ball.

mod ball;
mod blur;
mod half_planes;
mod lights;
mod limits;
mod slab;
