// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight bench`: ratios against baselines, interleaved in one run, with the error of both sides.

mod ambient;
mod ambient_directional;
pub mod baselines;
mod choices;
mod inverse;
mod inverse_scenes;
mod light_rays;
mod media_pictures;
mod painterly;
mod painterly_stroke_costs;
mod painterly_strokes;
mod resolution;
mod scattering;
mod splatting;
mod splatting_scenes;
mod splatting_tables;
pub mod ssdo;
mod stylize;
mod tables;
mod transfer;
mod transmittance;
mod transmittance_tables;
mod visibility;

use super::CommandError;
use crate::formats::write_whole;
use crate::{Gpu, Shaders};
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

/// What is measured, and where it goes.
#[derive(clap::Args)]
pub struct Options {
    /// Systems to measure; all if none is named.
    systems: Vec<String>,
    /// Writes the rows as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Adds the long tables, which take more than five minutes.
    #[arg(long)]
    tables: bool,
}

/// Error of both sides against the same picture.
#[derive(Clone, Debug, Serialize)]
pub struct Quality {
    /// What the errors are.
    pub metric: &'static str,
    /// Of the system.
    pub error: f64,
    /// Of the baseline.
    pub baseline_error: f64,
}

/// One measured figure.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The system.
    pub system: &'static str,
    /// Name of the figure.
    pub name: String,
    /// Its value: the median of the samples.
    pub value: f64,
    /// `ratio`, `ms`, `ns`, `MB`, `steps`, `fraction`, or what is counted.
    pub unit: &'static str,
    /// Which way is better.
    pub better: &'static str,
    /// Errors, where the figure compares.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quality: Option<Quality>,
    /// Every sample.
    pub samples: Vec<f64>,
}

#[derive(Serialize)]
struct Report {
    adapter: String,
    driver: String,
    rows: Vec<Row>,
}

const SYSTEMS: [&str; 7] =
    ["ambient", "inverse", "painterly", "scattering", "splatting", "stylize", "transmittance"];

/// Runs the command.
pub fn run(options: &Options, quiet: bool) -> Result<(), CommandError> {
    for system in &options.systems {
        if !SYSTEMS.contains(&system.as_str()) {
            let known = SYSTEMS.join(", ");
            return Err(CommandError::misuse(
                "bench",
                format!("no system `{system}` to measure; there is {known}"),
            ));
        }
    }
    let gpu = pollster::block_on(Gpu::new())?;
    let shaders = Shaders::builtin();
    println!("adapter: {}", gpu.description());
    let asked =
        |system: &str| options.systems.is_empty() || options.systems.iter().any(|name| name == system);
    let mut rows = Vec::new();
    let mut add = |more: Vec<Row>| {
        print(&more);
        rows.extend(more);
    };
    if asked("ambient") {
        add(ambient::rows(&gpu, &shaders, quiet)?);
    }
    if asked("inverse") {
        add(inverse::rows(&gpu, &shaders, quiet)?);
        if options.tables {
            add(inverse::tables(&gpu, &shaders, quiet)?);
        }
    }
    if asked("painterly") {
        add(painterly::rows(&gpu, &shaders, quiet)?);
        if options.tables {
            add(painterly::tables(&gpu, &shaders, quiet)?);
        }
    }
    if asked("scattering") {
        add(scattering::rows(&gpu, &shaders, quiet)?);
        if options.tables {
            add(tables::scattering(&gpu, &shaders, quiet)?);
        }
    }
    if asked("splatting") {
        add(splatting::rows(&gpu, &shaders, quiet)?);
        if options.tables {
            add(splatting_tables::rows(&gpu, &shaders, quiet)?);
        }
    }
    if asked("stylize") {
        add(stylize::rows(&gpu, &shaders, quiet)?);
    }
    if asked("transmittance") {
        add(transmittance::rows(&gpu, &shaders, quiet)?);
        if options.tables {
            add(transmittance_tables::rows(&gpu, &shaders, quiet)?);
        }
    }
    if let Some(path) = &options.json {
        let driver = format!("{} {}", gpu.adapter.driver, gpu.adapter.driver_info);
        let report = Report { adapter: gpu.adapter.name.clone(), driver, rows };
        write_whole(path, |writer| {
            serde_json::to_writer_pretty(writer, &report).map_err(std::io::Error::other)
        })
        .map_err(CommandError::failure)?;
    }
    Ok(())
}

fn print(rows: &[Row]) {
    for row in rows {
        let least = row.samples.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = row.samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let better = if row.better == "higher" { "+" } else { "-" };
        print!("{} {:<48} {:>11.4} {:<8} {better}", row.system, row.name, row.value, row.unit);
        if row.samples.len() > 1 {
            print!(" [{least:.3} .. {greatest:.3}]");
        }
        if let Some(quality) = &row.quality {
            print!(" {}: {:.5}, baseline {:.5}", quality.metric, quality.error, quality.baseline_error);
        }
        println!();
    }
}

/// Wall-clock milliseconds of what `record` puts into an encoder, to the end of the work.
pub fn milliseconds(gpu: &Gpu, record: &dyn Fn(&mut wgpu::CommandEncoder)) -> Result<f64, CommandError> {
    let mut encoder = gpu.encoder();
    record(&mut encoder);
    let start = Instant::now();
    gpu.submit(encoder)?;
    gpu.wait()?;
    Ok(start.elapsed().as_secs_f64() * 1e3)
}

/// A piece of work: records its commands.
pub type Work<'a> = &'a dyn Fn(&mut wgpu::CommandEncoder);

/// Work shorter than this is repeated within a sample.
const SAMPLE_MILLISECONDS: f64 = 600.0;

/// `count` samples of each piece of work, taken by turns after a warm-up of each. One list a piece. A sample
/// of short work is the median of several runs in a row, so that what another process does in between
/// weighs no more on the short side of a ratio than on the long one.
pub fn interleaved(gpu: &Gpu, works: &[Work<'_>], count: usize) -> Result<Vec<Vec<f64>>, CommandError> {
    let mut repeats = Vec::new();
    for work in works {
        let mut warm = milliseconds(gpu, work)?;
        // Of long work what a driver compiles is a small part.
        if warm < 10.0 * SAMPLE_MILLISECONDS {
            warm = milliseconds(gpu, work)?;
        }
        repeats.push((SAMPLE_MILLISECONDS / warm.max(1.0)).clamp(1.0, 9.0) as usize);
    }
    let mut samples = vec![Vec::new(); works.len()];
    for _ in 0..count {
        for ((work, list), repeats) in works.iter().zip(&mut samples).zip(&repeats) {
            let runs: Result<Vec<f64>, _> = (0..*repeats).map(|_| milliseconds(gpu, work)).collect();
            list.push(median(&runs?));
        }
    }
    Ok(samples)
}

/// The median.
pub fn median(samples: &[f64]) -> f64 {
    airlight_tests::statistics::median(samples)
}

/// A row whose samples are the ratios of two lists, pair by pair.
pub fn ratio(
    system: &'static str,
    name: impl Into<String>,
    over: &[f64],
    under: &[f64],
    better: &'static str,
    quality: Option<Quality>,
) -> Row {
    let samples: Vec<f64> = over.iter().zip(under).map(|(a, b)| a / b).collect();
    Row { system, name: name.into(), value: median(&samples), unit: "ratio", better, quality, samples }
}

/// A row of a single number.
pub fn figure(system: &'static str, name: impl Into<String>, value: f64, unit: &'static str) -> Row {
    Row { system, name: name.into(), value, unit, better: "lower", quality: None, samples: vec![value] }
}

/// A row of milliseconds.
pub fn time(system: &'static str, name: impl Into<String>, samples: Vec<f64>) -> Row {
    Row {
        system,
        name: name.into(),
        value: median(&samples),
        unit: "ms",
        better: "lower",
        quality: None,
        samples,
    }
}
