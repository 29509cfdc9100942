// SPDX-License-Identifier: MIT OR Apache-2.0
//! The book's chapters with Rust in them, as documentation whose examples are compiled; tests/tests/book.rs knows that
//! none is missing. Chapters listed here have shell lines in fences: an indented block would count as Rust.

#[doc = include_str!("../../docs/src/holes.md")]
mod holes {}

#[doc = include_str!("../../docs/src/vendoring/naga_oil.md")]
mod naga_oil {}

#[doc = include_str!("../../docs/src/vendoring/wgpu.md")]
mod wgpu {}
