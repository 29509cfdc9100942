// SPDX-License-Identifier: MIT OR Apache-2.0
//! Placeholder.
use super::CommandError;

/// Placeholder.
#[derive(clap::Args)]
pub struct Options {}

pub fn run(_options: &Options, _quiet: bool) -> Result<(), CommandError> {
    Ok(())
}
