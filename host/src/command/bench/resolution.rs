// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a half and a quarter of the resolution save, and the march that is as exact as prefiltering.

use super::scattering::{SIZE, SYSTEM, Truth, VISIBILITY, run, stage};
use super::{Quality, Row, figure, interleaved, ratio, time};
use crate::command::CommandError;
use crate::core::Jitter;
use crate::scattering::{
    Along, Inputs, Interpolated, March, Prefiltered, Rectification, Reduced, Resolution, Settings, Upsample,
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

/// What a reduced picture takes: its pixels, the map rectified for its camera, and the upsampling.
struct Fewer {
    resolution: Resolution,
    reduced: Reduced,
    upsample: Upsample,
}

impl Fewer {
    fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        stage: &Stage,
        resolution: Resolution,
    ) -> Result<Self, CommandError> {
        Ok(Self {
            resolution,
            reduced: Reduced::new(gpu, shaders, &stage.camera, resolution)?,
            upsample: Upsample::new(gpu, shaders, Interpolated::Visibility, SIZE)?,
        })
    }

    fn name(&self) -> &'static str {
        match self.resolution {
            Resolution::Half => "half",
            Resolution::Quarter => "quarter",
        }
    }

    /// The f64 picture over a map that was rectified for this camera.
    fn truth(&self, gpu: &Gpu, stage: &Stage, map: &Texture) -> Result<Truth, CommandError> {
        Truth::over(gpu, stage, &stage.camera.reduced(self.resolution.factor()), map, STRIDE)
    }
}

fn radiance_error(gpu: &Gpu, truth: &Truth, exact: &[f64], scattered: &Texture) -> Result<f64, CommandError> {
    Ok(error::relative_rmse(&truth.radiance(gpu, scattered)?, exact))
}

fn rectified(gpu: &Gpu, shaders: &Shaders, inputs: &Inputs<'_>) -> Result<Rectification, CommandError> {
    let map = Rectification::new(gpu, shaders, Settings::tuned(gpu).map)?;
    let bound = map.bind(gpu, inputs)?;
    run(gpu, &|encoder| map.record(encoder, &bound))?;
    Ok(map)
}

/// The march along rows at full resolution over the march of fewer pixels, their choice and the upsampling;
/// without the rectification, which is the same.
fn reduced_march(gpu: &Gpu, shaders: &Shaders, stage: &Stage) -> Result<Vec<Row>, CommandError> {
    let inputs = stage.inputs();
    let march = |map: &Rectification, inputs: &Inputs<'_>, viewport| -> Result<_, CommandError> {
        let along = Along::RowSteps { map, steps: STEPS };
        let march = March::new(gpu, shaders, &along, Weighting::Average, viewport)?;
        let bound = march.bind(gpu, inputs, &along)?;
        Ok((march, bound))
    };
    let map = rectified(gpu, shaders, &inputs)?;
    let (full, full_bound) = march(&map, &inputs, SIZE)?;
    let mut cases = Vec::new();
    for resolution in [Resolution::Half, Resolution::Quarter] {
        let fewer = Fewer::new(gpu, shaders, stage, resolution)?;
        let reduced = fewer.reduced.inputs(&inputs);
        let map = rectified(gpu, shaders, &reduced)?;
        let (march, bound) = march(&map, &reduced, fewer.reduced.viewport())?;
        let bounds = [
            fewer.reduced.bind(gpu, &inputs)?,
            bound,
            fewer.upsample.bind(gpu, &inputs, &fewer.reduced, &march.scattered)?,
        ];
        cases.push((fewer, map, march, bounds));
    }
    let whole = |case: usize| {
        let (fewer, _, march, bounds) = &cases[case];
        move |encoder: &mut wgpu::CommandEncoder| {
            fewer.reduced.record(encoder, &bounds[0]);
            march.record(encoder, &bounds[1]);
            fewer.upsample.record(encoder, &bounds[2]);
        }
    };
    let upsampling = |case: usize| {
        let (fewer, _, _, bounds) = &cases[case];
        move |encoder: &mut wgpu::CommandEncoder| fewer.upsample.record(encoder, &bounds[2])
    };
    let samples = interleaved(
        gpu,
        &[&|encoder| full.record(encoder, &full_bound), &whole(0), &whole(1), &upsampling(0), &upsampling(1)],
        5,
    )?;
    let truth = Truth::over(gpu, stage, &stage.camera, &map.rectified, STRIDE)?;
    let baseline_error = radiance_error(gpu, &truth, &average_radiance(&truth.rectified), &full.scattered)?;
    let mut rows = Vec::new();
    for (index, (fewer, map, march, _)) in cases.iter().enumerate() {
        let truth = fewer.truth(gpu, stage, &map.rectified)?;
        let exact = average_radiance(&truth.rectified);
        let error = radiance_error(gpu, &truth, &exact, &fewer.upsample.scattered)?;
        let quality = Quality { metric: RADIANCE, error, baseline_error };
        let name = format!("{}_resolution_speedup", fewer.name());
        rows.push(ratio(SYSTEM, name, &samples[0], &samples[1 + index], "higher", Some(quality)));
        let name = format!("{}_resolution_upsample", fewer.name());
        rows.push(time(SYSTEM, name, samples[3 + index].clone()));
        let radiance = Upsample::new(gpu, shaders, Interpolated::Radiance, SIZE)?;
        let bound = radiance.bind(gpu, &inputs, &fewer.reduced, &march.scattered)?;
        run(gpu, &|encoder| radiance.record(encoder, &bound))?;
        let error = radiance_error(gpu, &truth, &exact, &radiance.scattered)?;
        let name = format!("{}_resolution_error_interpolating_radiance", fewer.name());
        rows.push(figure(SYSTEM, name, error, "fraction"));
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
    let mut cases = Vec::new();
    for resolution in [Resolution::Half, Resolution::Quarter] {
        let fewer = Fewer::new(gpu, shaders, stage, resolution)?;
        let method = Prefiltered::new(gpu, shaders, settings, fewer.reduced.viewport())?;
        let bound = method.bind(gpu, &fewer.reduced.inputs(&inputs))?;
        let bounds = [
            fewer.reduced.bind(gpu, &inputs)?,
            fewer.upsample.bind(gpu, &inputs, &fewer.reduced, &method.scattered)?,
        ];
        cases.push((fewer, method, bound, bounds));
    }
    let whole = |case: usize| {
        let (fewer, method, bound, bounds) = &cases[case];
        move |encoder: &mut wgpu::CommandEncoder| {
            fewer.reduced.record(encoder, &bounds[0]);
            method.record(encoder, bound);
            fewer.upsample.record(encoder, &bounds[1]);
        }
    };
    let samples = interleaved(gpu, &[&|encoder| full.record(encoder, &full_bound), &whole(0), &whole(1)], 5)?;
    let truth = Truth::over(gpu, stage, &stage.camera, &full.rectification.rectified, STRIDE)?;
    let baseline_error = radiance_error(gpu, &truth, &truth.rectified.radiance(), &full.scattered)?;
    let mut rows = Vec::new();
    for (index, (fewer, method, ..)) in cases.iter().enumerate() {
        let truth = fewer.truth(gpu, stage, &method.rectification.rectified)?;
        let exact = truth.rectified.radiance();
        let error = radiance_error(gpu, &truth, &exact, &fewer.upsample.scattered)?;
        let quality = Quality { metric: RADIANCE, error, baseline_error };
        let name = format!("prefiltered_{}_resolution_speedup", fewer.name());
        rows.push(ratio(SYSTEM, name, &samples[0], &samples[1 + index], "higher", Some(quality)));
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
