// SPDX-License-Identifier: MIT OR Apache-2.0
//! The long tables of `airlight bench --tables`.

use super::scattering::{SIZE, Truth, run, stage};
use super::{Row, figure, interleaved, time};
use crate::command::{CommandError, progress};
use crate::scattering::{Filtering, Prefiltered, Settings};
use crate::{Gpu, Shaders, Stage};
use airlight_tests::error;

const SYSTEM: &str = "scattering";

/// Cost, memory and error over the number of bases and the size of the map (thesis Table 4.2).
pub fn scattering(gpu: &Gpu, shaders: &Shaders, quiet: bool) -> Result<Vec<Row>, CommandError> {
    let (_, stage) = stage(gpu, shaders, "foliage", SIZE)?;
    // Columns by rows, and bases.
    let cases = [
        ([512, 1024], 32),
        ([1024, 1024], 32),
        ([2048, 1024], 32),
        ([4096, 1024], 32),
        ([1024, 256], 32),
        ([1024, 512], 32),
        ([1024, 768], 32),
        ([1024, 1536], 32),
        ([1024, 2048], 32),
        ([1024, 1024], 4),
        ([1024, 1024], 8),
        ([1024, 1024], 16),
        ([1024, 1024], 64),
        ([1024, 1024], 128),
    ];
    let bar = progress::bar(cases.len() as u64, quiet);
    let mut rows = Vec::new();
    for (map, bases) in cases {
        let [width, height] = map;
        bar.set_message(format!("map {width}x{height}, {bases} bases"));
        let settings = Settings { bases, map, epipole_march: false, ..Settings::tuned(gpu) };
        let prefiltered = Prefiltered::new(gpu, shaders, settings, SIZE)?;
        let bound = prefiltered.bind(gpu, &stage.inputs())?;
        run(gpu, &|encoder| prefiltered.record(encoder, &bound))?;
        let samples = interleaved(
            gpu,
            &[
                &|encoder| prefiltered.record_rectification(encoder, &bound),
                &|encoder| prefiltered.record_filter(encoder, &bound),
                &|encoder| prefiltered.record_evaluation(encoder, &bound),
            ],
            5,
        )?;
        let truth = Truth::new(gpu, &stage, &prefiltered.rectification.rectified)?;
        let exact = truth.shadow_map_picture(gpu, &stage)?.radiance();
        let values = truth.radiance(gpu, &prefiltered.scattered)?;
        let name = |what: &str| format!("{what}_{width}x{height}_{bases}");
        for (what, list) in ["rectification", "filter", "evaluation"].iter().zip(&samples) {
            rows.push(time(SYSTEM, name(what), list.clone()));
        }
        rows.push(figure(SYSTEM, name("memory"), prefiltered.memory() as f64 / 1e6, "MB"));
        rows.push(figure(SYSTEM, name("radiance_error"), error::relative_rmse(&values, &exact), "fraction"));
        bar.inc(1);
    }
    bar.finish_and_clear();
    rows.extend(parallel_strategies(gpu, shaders, &stage, quiet)?);
    rows.extend(screens(gpu, shaders, quiet)?);
    Ok(rows)
}

/// Regions a row times bases a thread (thesis Table 4.1), the recurrence against new sines, and both ways to read.
fn parallel_strategies(
    gpu: &Gpu,
    shaders: &Shaders,
    stage: &Stage,
    quiet: bool,
) -> Result<Vec<Row>, CommandError> {
    let bar = progress::bar(20, quiet);
    let tuned = Settings { epipole_march: false, ..Settings::tuned(gpu) };
    let mut rows = Vec::new();
    let mut measure = |name: String, settings: Settings| -> Result<(), CommandError> {
        bar.set_message(name.clone());
        let prefiltered = Prefiltered::new(gpu, shaders, settings, SIZE)?;
        let bound = prefiltered.bind(gpu, &stage.inputs())?;
        // Filter and evaluation need the slices of the frame.
        run(gpu, &|encoder| prefiltered.record(encoder, &bound))?;
        let samples = interleaved(
            gpu,
            &[&|encoder| prefiltered.record_filter(encoder, &bound), &|encoder| {
                prefiltered.record_evaluation(encoder, &bound)
            }],
            5,
        )?;
        rows.push(time(SYSTEM, format!("filter_{name}"), samples[0].clone()));
        rows.push(time(SYSTEM, format!("evaluation_{name}"), samples[1].clone()));
        bar.inc(1);
        Ok(())
    };
    for regions in [1, 2, 3, 4] {
        for bases_per_thread in [4, 8, 16, 32] {
            let settings = Settings { regions, bases_per_thread, ..tuned };
            measure(format!("regions_{regions}_bases_{bases_per_thread}"), settings)?;
        }
    }
    measure("recurrence".to_owned(), tuned)?;
    measure("direct_sines".to_owned(), Settings { direct_sines: true, ..tuned })?;
    measure("linear".to_owned(), Settings { filtering: Filtering::Linear, ..tuned })?;
    measure("nearest".to_owned(), Settings { filtering: Filtering::Nearest, ..tuned })?;
    bar.finish_and_clear();
    Ok(rows)
}

/// Cost over the size of the picture, the map kept.
fn screens(gpu: &Gpu, shaders: &Shaders, quiet: bool) -> Result<Vec<Row>, CommandError> {
    // 0.5, 1, 2, 4 and 8 megapixels.
    let sizes = [[960, 540], [1360, 765], [1920, 1080], [2720, 1530], [3840, 2160]];
    let bar = progress::bar(sizes.len() as u64, quiet);
    let mut rows = Vec::new();
    for size in sizes {
        let [width, height] = size;
        bar.set_message(format!("picture {width}x{height}"));
        let (_, stage) = stage(gpu, shaders, "foliage", size)?;
        let settings = Settings { epipole_march: false, ..Settings::tuned(gpu) };
        let prefiltered = Prefiltered::new(gpu, shaders, settings, size)?;
        let bound = prefiltered.bind(gpu, &stage.inputs())?;
        let samples = interleaved(
            gpu,
            &[
                &|encoder| prefiltered.record_rectification(encoder, &bound),
                &|encoder| prefiltered.record_filter(encoder, &bound),
                &|encoder| prefiltered.record_evaluation(encoder, &bound),
            ],
            5,
        )?;
        for (what, list) in ["rectification", "filter", "evaluation"].iter().zip(&samples) {
            rows.push(time(SYSTEM, format!("{what}_picture_{width}x{height}"), list.clone()));
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(rows)
}
