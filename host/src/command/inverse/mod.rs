// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight inverse`: pictures of a volume to paint on, and the volume that looks as they were painted.

mod between;
mod cancel;
mod conflicts;
mod descent;
mod discs;
mod error;
pub(in crate::command) mod field;
mod fits;
mod keys;
mod light;
mod options;
pub(in crate::command) mod paint;
mod parts;
mod places;
mod refraction;
mod render;
mod report;
mod solve;
mod stage;
pub(in crate::command) mod studio;
mod views;
mod volumes;
mod written;

pub use options::Options;

use super::CommandError;
use options::Task;

/// Runs the command.
pub fn run(options: &Options, quiet: bool) -> Result<(), CommandError> {
    match &options.task {
        Task::Render(options) => render::run(options, quiet),
        Task::Solve(options) => solve::run(options, quiet),
    }
}
