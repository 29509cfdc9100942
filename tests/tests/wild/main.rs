// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every pass in every permutation, in strangers' hands: random textures, buffers and parameters of every kind, size and
//! value. Nothing hangs, nothing is refused, the device answers afterwards; with sane parameters every output is finite,
//! whatever the textures hold; and the flat form of a pass gives the same bits as the composed one.
//!
//! Cases are drawn from fixed seeds. `AIRLIGHT_WILD=PASS[:PERMUTATION[:CASE]]` runs only those whose pass contains PASS,
//! `AIRLIGHT_WILD_ROUNDS=N` draws N times as many; `--nocapture` prints how many ran and which submission was the slowest.
#![allow(clippy::unwrap_used)]

#[path = "../support/gpu.rs"]
mod gpu;

mod cases;
mod inside;
mod loops;
mod passes;
mod resources;
mod structs;
mod values;

use cases::hold;

#[test]
fn core() {
    hold("core");
}

#[test]
fn transmittance() {
    hold("transmittance");
}

#[test]
fn scattering() {
    hold("scattering");
}

#[test]
fn stylize() {
    hold("stylize");
}

#[test]
fn painterly() {
    hold("painterly");
}

#[test]
fn splatting() {
    hold("splatting");
}

#[test]
fn inverse() {
    hold("inverse");
}

#[test]
fn ambient() {
    hold("ambient");
}
