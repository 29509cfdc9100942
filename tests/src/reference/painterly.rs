// SPDX-License-Identifier: MIT OR Apache-2.0
//! What painterly rendering is compared with.

pub mod strokes;
