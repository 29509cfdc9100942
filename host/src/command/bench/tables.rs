// SPDX-License-Identifier: MIT OR Apache-2.0
//! The long tables of `airlight bench --tables`.

use super::scattering::{SIZE, Truth, run, stage};
use super::{Row, figure, interleaved, time};
use crate::command::{CommandError, progress};
use crate::scattering::{Prefiltered, Settings};
use crate::{Gpu, Shaders};
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
        let settings = Settings { bases, map, ..Settings::tuned(gpu) };
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
    Ok(rows)
}
