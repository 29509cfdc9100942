// SPDX-License-Identifier: MIT OR Apache-2.0
//! The named figures of the system `stylize`: what morphology of a shadow map costs, and how that grows.

use super::scattering::{SHADOW_MAP, SIZE, run, stage};
use super::{Quality, Row, baselines, interleaved, ratio, time};
use crate::command::{CommandError, progress};
use crate::core::DepthRange;
use crate::pass::Pass;
use crate::stylize::{
    Element, EpipolarBound, EpipolarMorphology, EpipolarSettings, Epipole, Form, Morphology, MorphologyBound,
    MorphologySettings, Operator, Width, Window,
};
use crate::{Buffer, Gpu, Shaders, Stage, Texture};
use airlight_tests::error;
use wgpu::TextureFormat::R32Float;

const SYSTEM: &str = "stylize";
/// Samples of each piece of work.
const SAMPLES: usize = 9;

/// Every named figure, over the shadow map of the foliage.
pub fn rows(gpu: &Gpu, shaders: &Shaders, quiet: bool) -> Result<Vec<Row>, CommandError> {
    let bar = progress::bar(4, quiet);
    let (_, stage) = stage(gpu, shaders, "foliage", SIZE)?;
    let mut rows = Vec::new();
    bar.set_message("sliding minimum against a copy");
    rows.extend(row_minimum(gpu, shaders, &stage)?);
    bar.inc(1);
    for (element, name, narrow, wide) in [(Element::Box, "box", 11, 61), (Element::Disc, "disc", 11, 41)] {
        bar.set_message(format!("closing, {name}"));
        rows.extend(closing(gpu, shaders, &stage, (element, name, narrow, wide))?);
        bar.inc(1);
    }
    bar.set_message("closing and dilation along view rays");
    rows.extend(epipolar(gpu, shaders, &stage)?);
    rows.extend(super::transfer::rows(gpu, shaders, &stage)?);
    bar.finish_and_clear();
    Ok(rows)
}

/// One sliding minimum of 61 texels along rows against a pass that copies texel by texel.
fn row_minimum(gpu: &Gpu, shaders: &Shaders, stage: &Stage) -> Result<Vec<Row>, CommandError> {
    let [width, height] = SHADOW_MAP;
    let values = &stage.pictures.shadow_map;
    let target = Texture::storage(gpu, SHADOW_MAP, R32Float);
    let copy = Pass::compute_with(
        gpu,
        &baselines::with_baselines(shaders),
        "baselines/copy",
        &airlight_validate::Definitions::new(),
    )?;
    let copy_bound = copy.bind(gpu, &[("values", values.into()), ("copied", (&target).into())])?;
    let window = Window {
        before: 30,
        after: 30,
        stride: 1,
        reserved_a: 0,
        sign: 1.0,
        far_depth: 1.0,
        reserved_b: 0.0,
        reserved_c: 0.0,
    };
    let window = Buffer::uniform(gpu, &window);
    let minimum = Pass::compute(gpu, shaders, "stylize/sliding_extremum", "default")?;
    let resources = [("window", (&window).into()), ("values", values.into()), ("extrema", (&target).into())];
    let minimum_bound = minimum.bind(gpu, &resources)?;
    let columns = Pass::compute(gpu, shaders, "stylize/sliding_extremum", "columns")?;
    let columns_bound = columns.bind(gpu, &resources)?;
    let samples = interleaved(
        gpu,
        &[
            &|encoder| minimum.dispatch(encoder, &minimum_bound, [height, width.div_ceil(61), 1]),
            &|encoder| columns.dispatch(encoder, &columns_bound, [width, height.div_ceil(61), 1]),
            &|encoder| copy.dispatch(encoder, &copy_bound, [width, height, 1]),
        ],
        SAMPLES,
    )?;
    let [rows, columns, copies] = &samples[..] else {
        return Err(CommandError::failure("three pieces of work are timed"));
    };
    Ok(vec![
        ratio(SYSTEM, "row_minimum_over_copy", rows, copies, "lower", None),
        ratio(SYSTEM, "column_minimum_over_copy", columns, copies, "lower", None),
        time(SYSTEM, "copy", copies.clone()),
    ])
}

fn width(texels: u32) -> Result<Width, CommandError> {
    Width::new(texels).map_err(CommandError::failure)
}

fn bound(
    gpu: &Gpu,
    shaders: &Shaders,
    stage: &Stage,
    settings: MorphologySettings,
) -> Result<(Morphology, MorphologyBound), CommandError> {
    let morphology = Morphology::new(gpu, shaders, settings, SHADOW_MAP).map_err(CommandError::failure)?;
    let bound = morphology.bind(gpu, &stage.pictures.shadow_map).map_err(CommandError::failure)?;
    Ok((morphology, bound))
}

/// How the cost of a closing grows with the width of its element.
fn closing(
    gpu: &Gpu,
    shaders: &Shaders,
    stage: &Stage,
    (element, name, narrow, wide): (Element, &str, u32, u32),
) -> Result<Vec<Row>, CommandError> {
    let settings = |texels| -> Result<_, CommandError> {
        let (operator, depth) = (Operator::Closing, DepthRange::Forward);
        Ok(MorphologySettings { operator, element, width: width(texels)?, depth })
    };
    let (small, small_bound) = bound(gpu, shaders, stage, settings(narrow)?)?;
    let (large, large_bound) = bound(gpu, shaders, stage, settings(wide)?)?;
    let samples = interleaved(
        gpu,
        &[&|encoder| large.record(encoder, &large_bound), &|encoder| small.record(encoder, &small_bound)],
        SAMPLES,
    )?;
    Ok(vec![
        ratio(
            SYSTEM,
            format!("{name}_close_k{wide}_over_k{narrow}"),
            &samples[0],
            &samples[1],
            "lower",
            None,
        ),
        time(SYSTEM, format!("{name}_close_k{wide}"), samples[0].clone()),
        time(SYSTEM, format!("{name}_close_k{narrow}"), samples[1].clone()),
    ])
}

/// An operator along view rays, bound.
struct Along {
    morphology: EpipolarMorphology,
    bound: EpipolarBound,
}

impl Along {
    fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        stage: &Stage,
        (operator, form, texels): (Operator, Form, u32),
    ) -> Result<Self, CommandError> {
        let epipole = Epipole::new(&stage.light, &stage.camera, SHADOW_MAP).map_err(CommandError::failure)?;
        let settings = EpipolarSettings { operator, form, width: width(texels)?, depth: DepthRange::Forward };
        let morphology = EpipolarMorphology::new(gpu, shaders, settings, &epipole, SHADOW_MAP)
            .map_err(CommandError::failure)?;
        let bound = morphology.bind(gpu, &stage.pictures.shadow_map).map_err(CommandError::failure)?;
        Ok(Self { morphology, bound })
    }

    fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.morphology.record(encoder, &self.bound);
    }
}

/// How the cost of a closing along view rays grows, and the direct form against the rectified one, both resamplings counted.
fn epipolar(gpu: &Gpu, shaders: &Shaders, stage: &Stage) -> Result<Vec<Row>, CommandError> {
    let along = |operator, form, texels| Along::new(gpu, shaders, stage, (operator, form, texels));
    let narrow = along(Operator::Closing, Form::Rectified, 15)?;
    let wide = along(Operator::Closing, Form::Rectified, 61)?;
    let direct = along(Operator::Dilation, Form::Direct, 61)?;
    let rectified = along(Operator::Dilation, Form::Rectified, 61)?;
    let samples = interleaved(
        gpu,
        &[
            &|encoder| narrow.record(encoder),
            &|encoder| wide.record(encoder),
            &|encoder| direct.record(encoder),
            &|encoder| rectified.record(encoder),
        ],
        SAMPLES,
    )?;
    run(gpu, &|encoder| {
        direct.record(encoder);
        rectified.record(encoder);
    })?;
    // The direct form is exact for every texel.
    let read = |of: &Along| of.morphology.morphed.read(gpu).map_err(CommandError::failure);
    let exact: Vec<f64> = read(&direct)?.into_iter().map(f64::from).collect();
    let quality = Quality {
        metric: "mean absolute difference of depth from the direct form",
        error: error::mean_absolute(&read(&rectified)?, &exact),
        baseline_error: 0.0,
    };
    let [narrow, wide, direct, rectified] = &samples[..] else {
        return Err(CommandError::failure("four pieces of work are timed"));
    };
    Ok(vec![
        ratio(SYSTEM, "epipolar_close_k61_over_k15", wide, narrow, "lower", None),
        ratio(SYSTEM, "epipolar_direct_over_rectified", direct, rectified, "higher", Some(quality)),
        time(SYSTEM, "epipolar_close_k61", wide.clone()),
        time(SYSTEM, "epipolar_dilate_k61", rectified.clone()),
        time(SYSTEM, "epipolar_dilate_k61_direct", direct.clone()),
    ])
}
