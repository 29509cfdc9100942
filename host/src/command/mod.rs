// SPDX-License-Identifier: MIT OR Apache-2.0
//! The command-line program: parsing, progress, exit codes.

mod ambient;
mod bench;
mod camera;
mod environments;
mod error;
mod fit;
mod gallery;
mod info;
mod inverse;
mod list;
mod models;
mod painterly;
mod parse;
mod progress;
mod run;
mod scans;
mod scattering;
mod sequence;
mod sky;
mod splatting;
mod staging;
mod stylize;
mod text;
mod transfers;
mod transmittance;
mod volumes;

pub use bench::{baselines, ssdo};
pub use error::CommandError;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Stylized light in volumes: runs Airlight's WGSL modules, measures them, shows them.
#[derive(Parser)]
#[command(name = "airlight", version, about)]
struct Arguments {
    /// No progress, no summary: only errors and what was asked for.
    #[arg(long, global = true)]
    quiet: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Every picture from real data, with an index page.
    Gallery(gallery::Options),
    /// Light shafts around meshes of yours.
    Scattering(scattering::Options),
    /// Light shafts around meshes of yours, their shadows reshaped and their light recoloured.
    #[command(mut_arg("frame", |frame| frame.help(
        "Number of the frame, for key frames, the time of holes and --jitter [default: 0]"
    )))]
    Stylize(Box<stylize::Options>),
    /// A volume or particles of yours, lit through a transmittance map.
    Transmittance(Box<transmittance::Options>),
    /// A volume of yours as a painting, frame by frame.
    Painterly(Box<painterly::Options>),
    /// Volumes and meshes of yours as sheets of splats, lit from sheet to sheet.
    Splatting(Box<splatting::Options>),
    /// Volumes that look from every side as somebody painted them.
    Inverse(inverse::Options),
    /// Meshes of yours in the light of an environment map, by bent normals and cones in screen space.
    Ambient(ambient::Options),
    /// Any compute or full-screen pass on arrays of yours, by binding name.
    Run(run::Options),
    /// Ratios against baselines, interleaved, with the error of both sides.
    Bench(bench::Options),
    /// Passes with their one-line descriptions.
    List(list::ListOptions),
    /// Adapter, driver and limits.
    Info,
}

/// Runs the program on the process's arguments. Exit code 2: misuse of the command line; 1: anything else that failed.
pub fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let quiet = arguments.quiet;
    let done = match arguments.command {
        Command::Gallery(options) => gallery::run(&options, quiet),
        Command::Scattering(options) => scattering::run(&options, quiet),
        Command::Stylize(options) => stylize::run(&options, quiet),
        Command::Transmittance(options) => transmittance::run(&options, quiet),
        Command::Painterly(options) => painterly::run(&options, quiet),
        Command::Splatting(options) => splatting::run(&options, quiet),
        Command::Inverse(options) => inverse::run(&options, quiet),
        Command::Ambient(options) => ambient::run(&options, quiet),
        Command::Run(options) => run::run(&options),
        Command::Bench(options) => bench::run(&options, quiet),
        Command::List(options) => list::list(&options),
        Command::Info => info::run(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("airlight: {}", error::one_line(error.to_string()));
            error.exit_code()
        }
    }
}
