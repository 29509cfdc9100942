// SPDX-License-Identifier: MIT OR Apache-2.0
//! Fewer pixels, shifted samples, multisampled depth: each against f64.

mod cameras;
mod case;
mod jitter;
mod multisampled;
mod reduced;
mod upsampling;
