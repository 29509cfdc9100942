// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a half and a quarter of the resolution save, and the march that is as exact as prefiltering.

use super::scattering::{SIZE, SYSTEM, Truth, VISIBILITY, run, stage};
use super::{Quality, Row, figure, interleaved, ratio, time};
use crate::command::CommandError;
use crate::core::Jitter;
use crate::scattering::{
    Along, Interpolated, March, Prefiltered, Rectification, Reduced, Resolution, Settings, Upsample,
    Weighting, epipole_near_picture,
};
use crate::{Gpu, Shaders, Stage, Texture};
use airlight_tests::error;
use airlight_tests::reference::scattering::Picture;

/// Every how many pixels the f64 picture is evaluated: no multiple of a factor of reduction, so that
/// interpolated pixels are judged.
const STRIDE: usize = 5;
/// Steps of the march whose resolution is reduced.
const STEPS: u32 = 1024;
const RADIANCE: &str = "relative RMSE of radiance";

/// Every figure of reduced resolution and of equal error.
pub fn rows(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let (_, stage) = stage(gpu, shaders, "foliage", SIZE)?;
    let mut rows = reduced_march(gpu, shaders, &stage)?;
    rows.extend(reduced_prefiltered(gpu, shaders, &stage)?);
    rows.extend(equal_error(gpu, shaders, &stage)?);
    Ok(rows)
}

/// Radiance with average visibility, three values a pixel: both visibilities vanish together.
fn average_radiance(picture: &Picture) -> Vec<f64> {
    let pixels = picture.pixels.iter();
    pixels
        .flat_map(|p| p.radiance.map(|l| if p.weighted > 0.0 { l * p.average / p.weighted } else { 0.0 }))
        .collect()
}

fn resolution_name(resolution: Resolution) -> &'static str {
    match resolution {
        Resolution::Half => "half",
        Resolution::Quarter => "quarter",
    }
}

/// The march along rows at full resolution over the march of fewer pixels, their choice and the upsampling.
fn reduced_march(gpu: &Gpu, shaders: &Shaders, stage: &Stage) -> Result<Vec<Row>, CommandError> {
    let inputs = stage.inputs();
    let map = Rectification::new(gpu, shaders, Settings::tuned(gpu).map)?;
    let bound = map.bind(gpu, &inputs)?;
    run(gpu, &|encoder| map.record(encoder, &bound))?;
    let truth = Truth::with_stride(gpu, stage, &map.rectified, STRIDE)?;
    let exact = average_radiance(&truth.rectified);
    let error = |texture: &Texture| -> Result<f64, CommandError> {
        Ok(error::relative_rmse(&truth.radiance(gpu, texture)?, &exact))
    };
    let along = Along::RowSteps { map: &map, steps: STEPS };
    let full = March::new(gpu, shaders, &along, Weighting::Average, SIZE)?;
    let full_bound = full.bind(gpu, &inputs, &along)?;
    let mut rows = Vec::new();
    for resolution in [Resolution::Half, Resolution::Quarter] {
        let name = resolution_name(resolution);
        let reduced = Reduced::new(gpu, shaders, &stage.camera, resolution)?;
        let reduced_bound = reduced.bind(gpu, &inputs)?;
        let march = March::new(gpu, shaders, &along, Weighting::Average, reduced.viewport())?;
        let march_bound = march.bind(gpu, &reduced.inputs(&inputs), &along)?;
        let upsample = Upsample::new(gpu, shaders, Interpolated::Visibility, SIZE)?;
        let upsample_bound = upsample.bind(gpu, &inputs, &reduced, &march.scattered)?;
        let samples = interleaved(
            gpu,
            &[
                &|encoder| full.record(encoder, &full_bound),
                &|encoder| {
                    reduced.record(encoder, &reduced_bound);
                    march.record(encoder, &march_bound);
                    upsample.record(encoder, &upsample_bound);
                },
                &|encoder| upsample.record(encoder, &upsample_bound),
            ],
            5,
        )?;
        let quality = Quality {
            metric: RADIANCE,
            error: error(&upsample.scattered)?,
            baseline_error: error(&full.scattered)?,
        };
        let speedup = format!("{name}_resolution_speedup");
        rows.push(ratio(SYSTEM, speedup, &samples[0], &samples[1], "higher", Some(quality)));
        rows.push(time(SYSTEM, format!("{name}_resolution_upsample"), samples[2].clone()));
        let radiance = Upsample::new(gpu, shaders, Interpolated::Radiance, SIZE)?;
        let radiance_bound = radiance.bind(gpu, &inputs, &reduced, &march.scattered)?;
        run(gpu, &|encoder| radiance.record(encoder, &radiance_bound))?;
        let name = format!("{name}_resolution_error_interpolating_radiance");
        rows.push(figure(SYSTEM, name, error(&radiance.scattered)?, "fraction"));
    }
    Ok(rows)
}

/// Everything that prefiltering does, rectification counted in, over the same with fewer pixels evaluated.
fn reduced_prefiltered(gpu: &Gpu, shaders: &Shaders, stage: &Stage) -> Result<Vec<Row>, CommandError> {
    let inputs = stage.inputs();
    let epipole_march = epipole_near_picture(&stage.camera, stage.light.direction);
    let settings = Settings { epipole_march, ..Settings::tuned(gpu) };
    let full = Prefiltered::new(gpu, shaders, settings, SIZE)?;
    let full_bound = full.bind(gpu, &inputs)?;
    run(gpu, &|encoder| full.record(encoder, &full_bound))?;
    let truth = Truth::with_stride(gpu, stage, &full.rectification.rectified, STRIDE)?;
    let exact = truth.rectified.radiance();
    let error = |texture: &Texture| -> Result<f64, CommandError> {
        Ok(error::relative_rmse(&truth.radiance(gpu, texture)?, &exact))
    };
    let mut rows = Vec::new();
    for resolution in [Resolution::Half, Resolution::Quarter] {
        let reduced = Reduced::new(gpu, shaders, &stage.camera, resolution)?;
        let reduced_bound = reduced.bind(gpu, &inputs)?;
        let fewer = Prefiltered::new(gpu, shaders, settings, reduced.viewport())?;
        let fewer_bound = fewer.bind_reduced(gpu, &inputs, &reduced.inputs(&inputs))?;
        let upsample = Upsample::new(gpu, shaders, Interpolated::Visibility, SIZE)?;
        let upsample_bound = upsample.bind(gpu, &inputs, &reduced, &fewer.scattered)?;
        let samples = interleaved(
            gpu,
            &[&|encoder| full.record(encoder, &full_bound), &|encoder| {
                reduced.record(encoder, &reduced_bound);
                fewer.record(encoder, &fewer_bound);
                upsample.record(encoder, &upsample_bound);
            }],
            7,
        )?;
        let quality = Quality {
            metric: RADIANCE,
            error: error(&upsample.scattered)?,
            baseline_error: error(&full.scattered)?,
        };
        let name = format!("prefiltered_{}_resolution_speedup", resolution_name(resolution));
        rows.push(ratio(SYSTEM, name, &samples[0], &samples[1], "higher", Some(quality)));
    }
    Ok(rows)
}

/// The cheapest march along rows that is at least as exact as prefiltering, over all that prefiltering does,
/// rectification counted in there and not in the march.
fn equal_error(gpu: &Gpu, shaders: &Shaders, stage: &Stage) -> Result<Vec<Row>, CommandError> {
    let inputs = stage.inputs();
    let epipole_march = epipole_near_picture(&stage.camera, stage.light.direction);
    let settings = Settings { weighting: Weighting::Average, epipole_march, ..Settings::tuned(gpu) };
    let prefiltered = Prefiltered::new(gpu, shaders, settings, SIZE)?;
    let prefiltered_bound = prefiltered.bind(gpu, &inputs)?;
    run(gpu, &|encoder| prefiltered.record(encoder, &prefiltered_bound))?;
    let map = &prefiltered.rectification;
    let truth = Truth::new(gpu, stage, &map.rectified)?;
    let exact = truth.rectified.average();
    let error = |texture: &Texture| -> Result<f64, CommandError> {
        Ok(error::mean_absolute(&truth.visibility(gpu, texture)?, &exact))
    };
    let target = error(&prefiltered.scattered)?;
    // The fewest steps that reach it, else the most exact march there is.
    let mut chosen: Option<(March, u32, f64)> = None;
    'search: for steps in [8, 16, 24, 32, 48, 64, 96, 128, 192, 256, 512, 1024] {
        for jitter in [Jitter::None, Jitter::Gradient] {
            let along = Along::RowSteps { map, steps };
            let march = March::jittered(gpu, shaders, &along, Weighting::Average, jitter, SIZE)?;
            let bound = march.bind(gpu, &inputs, &along)?;
            run(gpu, &|encoder| march.record(encoder, &bound))?;
            let found = error(&march.scattered)?;
            if chosen.as_ref().is_none_or(|(_, _, least)| found < *least) {
                chosen = Some((march, steps, found));
            }
            if found <= target {
                break 'search;
            }
        }
    }
    let Some((march, steps, baseline_error)) = chosen else { return Ok(Vec::new()) };
    let along = Along::RowSteps { map, steps };
    let bound = march.bind(gpu, &inputs, &along)?;
    let samples = interleaved(
        gpu,
        &[&|encoder| prefiltered.record(encoder, &prefiltered_bound), &|encoder| {
            march.record(encoder, &bound)
        }],
        7,
    )?;
    let quality = Quality { metric: VISIBILITY, error: target, baseline_error };
    let name = "march_equal_error_over_prefiltered";
    Ok(vec![
        ratio(SYSTEM, name, &samples[1], &samples[0], "higher", Some(quality)),
        figure(SYSTEM, "march_equal_error_steps", f64::from(steps), "steps"),
    ])
}
