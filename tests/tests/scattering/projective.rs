// SPDX-License-Identifier: MIT OR Apache-2.0
//! Projective rectification on the GPU against the f64 references and closed forms.

mod any_input;
mod cameras;
mod choice;
mod closed_form;
mod geometry;
mod maps;
mod pictures;
mod stage;
