// SPDX-License-Identifier: MIT OR Apache-2.0
//! Media that shadow themselves, through transmittance maps: the figures of the paper on media of our own.

mod burst;
mod curves;
mod scans;
mod setting;
pub(super) mod sky;
mod volumes;

use super::album::Section;
use super::studio::Studio;
use crate::command::CommandError;
use crate::transmittance::Form;

/// Pictures of this system, as in `--only transmittance/NAME`.
pub const NAMES: [&str; 5] = ["plume", "cloud", "brain", "curves", "burst"];

/// The section of a name; of the last one for a name that is not among [`NAMES`].
pub fn section(studio: &Studio, folder: &str, name: &str) -> Result<Section, CommandError> {
    match name {
        "plume" => volumes::plume(studio, folder),
        "cloud" => volumes::cloud(studio, folder),
        "brain" => scans::brain(studio, folder),
        "curves" => curves::section(studio, folder),
        _ => burst::section(studio, folder),
    }
}

/// A map that is compared: its form, its coefficients, and its name in files and in words.
type Method = (Form, u32, &'static str, &'static str);

/// Maps that are compared everywhere.
const METHODS: [Method; 7] = [
    (Form::Extinction, 4, "etm4", "extinction map, 4 coefficients"),
    (Form::Extinction, 16, "etm16", "extinction map, 16 coefficients"),
    (Form::Bounded, 4, "bounded4", "bounded extinction map, 4 coefficients"),
    (Form::Bounded, 16, "bounded16", "bounded extinction map, 16 coefficients"),
    (Form::Opacity, 4, "fom4", "Fourier opacity map, 4 coefficients"),
    (Form::Function, 4, "tfm4", "transmittance function map, 4 coefficients"),
    (Form::PowerMoments, 8, "moments", "power moments, 7 numbers"),
];
