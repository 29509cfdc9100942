// SPDX-License-Identifier: MIT OR Apache-2.0
//! The named figures of the system `inverse`: what projecting back costs over rendering, and what an iteration costs.

use super::inverse_scenes::{Scene, Size};
use super::{Quality, Row, Work, figure, interleaved, median, ratio, time};
use crate::command::{CommandError, progress};
use crate::inverse::{Solved, Solver};
use crate::{Gpu, Shaders};
use std::time::Instant;

/// Name of the system in its rows.
const SYSTEM: &str = "inverse";
/// Samples of each piece of work.
const SAMPLES: usize = 5;
/// What is solved for, by the end of a row's name.
const SOLVED: [(&str, Solved); 2] = [("", Solved::Emission), ("_extinction", Solved::Extinction)];

/// Every named figure.
pub fn rows(gpu: &Gpu, shaders: &Shaders, quiet: bool) -> Result<Vec<Row>, CommandError> {
    let bar = progress::bar(SOLVED.len() as u64 + 1, quiet);
    let mut rows = Vec::new();
    for (name, solved) in SOLVED {
        bar.set_message(format!("rendering and projecting back{}", name.replace('_', " ")));
        rows.extend(pair(gpu, shaders, name, solved)?);
        bar.inc(1);
    }
    bar.set_message("iterations over 4 and 8 views");
    rows.extend(views(gpu, shaders)?);
    bar.finish_and_clear();
    Ok(rows)
}

/// Two views of 256x256 pixels projected back, over their rendering: 128^3 voxels, a step a voxel.
fn pair(gpu: &Gpu, shaders: &Shaders, name: &str, solved: Solved) -> Result<Vec<Row>, CommandError> {
    let size = Size { voxels: 128, views: 2, pixels: 256, slices: 128 };
    let scene = Scene::new(gpu, shaders, size, solved)?;
    let quality = Quality {
        metric: "mismatch of the pair, of |Wx| |y|",
        error: scene.mismatch(gpu)?,
        baseline_error: 0.0,
    };
    // The only errors are of entry points, which the mismatch has met.
    let works: [Work<'_>; 2] = [
        &|encoder| {
            let _ = scene.render(gpu, encoder);
        },
        &|encoder| {
            let _ = scene.backproject(gpu, encoder);
        },
    ];
    let samples = interleaved(gpu, &works, SAMPLES)?;
    let over = format!("backproject_over_render{name}");
    let mut rows = vec![ratio(SYSTEM, over, &samples[1], &samples[0], "lower", Some(quality))];
    for (part, list) in ["render", "backproject"].iter().zip(samples) {
        rows.push(time(SYSTEM, format!("{part}{name}_2_views"), list));
    }
    Ok(rows)
}

/// Milliseconds of an iteration.
fn iteration(gpu: &Gpu, solver: &mut Solver) -> Result<f64, CommandError> {
    gpu.wait()?;
    let start = Instant::now();
    solver.iterate(gpu).map_err(CommandError::failure)?;
    gpu.wait()?;
    Ok(1e3 * start.elapsed().as_secs_f64())
}

/// Milliseconds of iterations of several solvers, by turns; the first of each is not counted.
fn iterations(gpu: &Gpu, solvers: &mut [Solver], count: usize) -> Result<Vec<Vec<f64>>, CommandError> {
    let mut samples = vec![Vec::new(); solvers.len()];
    for sample in 0..=count {
        for (solver, list) in solvers.iter_mut().zip(&mut samples) {
            let taken = iteration(gpu, solver)?;
            if sample > 0 {
                list.push(taken);
            }
        }
    }
    Ok(samples)
}

/// An iteration with 8 views over one with 4.
fn views(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let mut solvers = Vec::new();
    for views in [8, 4] {
        let size = Size { voxels: 64, views, pixels: 160, slices: 96 };
        solvers.push(Scene::new(gpu, shaders, size, Solved::Emission)?.solver(gpu, shaders)?);
    }
    let samples = iterations(gpu, &mut solvers, SAMPLES)?;
    let mut rows = vec![ratio(SYSTEM, "iteration_cost_at_2x_views", &samples[0], &samples[1], "lower", None)];
    for (views, list) in [8, 4].iter().zip(samples) {
        rows.push(time(SYSTEM, format!("iteration_{views}_views"), list));
    }
    Ok(rows)
}

/// Iterations by voxels, steps and views as in Fig. 7.3 of the thesis, and 64 views of 256x256 as itk-rtk's were measured.
pub fn tables(gpu: &Gpu, shaders: &Shaders, quiet: bool) -> Result<Vec<Row>, CommandError> {
    let by_steps =
        [32, 64, 128].into_iter().flat_map(|voxels| [64, 128, 256, 512].map(|slices| (voxels, slices, 2)));
    let by_views =
        [32, 64, 128].into_iter().flat_map(|voxels| [2, 4, 8].map(|views| (voxels, voxels, views)));
    let all: Vec<_> = by_steps.chain(by_views).collect();
    let bar = progress::bar(all.len() as u64 + 1, quiet);
    let mut rows = Vec::new();
    for (voxels, slices, views) in all {
        let name = format!("table_iteration_{voxels}_{slices}_steps_{views}_views");
        bar.set_message(name.clone());
        let size = Size { voxels, views, pixels: 240, slices };
        let mut solvers = [Scene::new(gpu, shaders, size, Solved::Emission)?.solver(gpu, shaders)?];
        let samples = iterations(gpu, &mut solvers, 3)?;
        rows.extend(samples.into_iter().map(|list| time(SYSTEM, name.clone(), list)));
        bar.inc(1);
    }
    bar.set_message("64 views of 256x256");
    rows.extend(many_views(gpu, shaders)?);
    bar.finish_and_clear();
    Ok(rows)
}

/// W, its transpose and five iterations, 128^3 voxels and 64 views: extinction, as itk-rtk solves for.
fn many_views(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let size = Size { voxels: 128, views: 64, pixels: 256, slices: 128 };
    let scene = Scene::new(gpu, shaders, size, Solved::Extinction)?;
    let works: [Work<'_>; 2] = [
        &|encoder| {
            let _ = scene.render(gpu, encoder);
        },
        &|encoder| {
            let _ = scene.backproject(gpu, encoder);
        },
    ];
    let samples = interleaved(gpu, &works, 3)?;
    let mut rows: Vec<Row> = ["render", "backproject"]
        .iter()
        .zip(samples)
        .map(|(part, list)| time(SYSTEM, format!("{part}_64_views"), list))
        .collect();
    let mut solvers = [scene.solver(gpu, shaders)?];
    let five = iterations(gpu, &mut solvers, 5)?.concat();
    rows.push(figure(SYSTEM, "five_iterations_64_views", five.iter().sum(), "ms"));
    rows.push(figure(SYSTEM, "iteration_64_views", median(&five), "ms"));
    Ok(rows)
}
