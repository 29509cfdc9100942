// SPDX-License-Identifier: MIT OR Apache-2.0
//! The named figures of transfer functions: what a look-up adds to the evaluation of light shafts that it is fused into.

use super::scattering::{SIZE, run};
use super::{Quality, Row, interleaved, ratio, time};
use crate::command::CommandError;
use crate::scattering::{Filtering, Prefiltered, RANK_BITS, Settings, Visibility, epipole_near_picture};
use crate::stylize::{
    Baker, Color, Constraint, Layer, Place, Restyle, Source, StylizedEvaluation, Transfer, TransferSettings,
};
use crate::{Buffer, Gpu, Shaders, Stage};
use glam::{Vec2, Vec3};

const SYSTEM: &str = "stylize";
/// Samples of each piece of work.
const SAMPLES: usize = 15;

/// The fused evaluation against the plain one, by Fourier bases and by rank queries: with the library's default settings, and
/// with nearest reads, which leave less to compare with.
pub fn rows(gpu: &Gpu, shaders: &Shaders, stage: &Stage) -> Result<Vec<Row>, CommandError> {
    let rank = Visibility::Rank { bits: RANK_BITS };
    let mut rows = Vec::new();
    for (suffix, visibility, filtering) in [
        ("", Visibility::Fourier, Filtering::Linear),
        ("_rank", rank, Filtering::Linear),
        ("_nearest", Visibility::Fourier, Filtering::Nearest),
        ("_rank_nearest", rank, Filtering::Nearest),
    ] {
        rows.extend(overhead(gpu, shaders, stage, suffix, (visibility, filtering))?);
    }
    Ok(rows)
}

/// A function of four colours.
fn style() -> Transfer {
    let constraint = |x, y, rgb: [f32; 3], alpha| Constraint {
        place: Place::At(Vec2::new(x, y)),
        color: Color { rgb: Vec3::from(rgb), alpha },
    };
    let colors = vec![
        constraint(0.0, 0.0, [0.05, 0.05, 0.2], 0.6),
        constraint(1.0, 0.0, [0.9, 0.6, 0.2], 0.5),
        constraint(0.0, 1.0, [0.1, 0.2, 0.4], 0.9),
        constraint(1.0, 1.0, [1.0, 0.8, 0.5], 1.0),
    ];
    Transfer {
        size: 256,
        settings: TransferSettings::default(),
        layers: vec![Layer::new(Source::Diffusion(colors))],
    }
}

fn overhead(
    gpu: &Gpu,
    shaders: &Shaders,
    stage: &Stage,
    suffix: &str,
    (visibility, filtering): (Visibility, Filtering),
) -> Result<Vec<Row>, CommandError> {
    let style = style();
    let baker = Baker::new(gpu, shaders).map_err(CommandError::failure)?;
    let map = baker.bake(gpu, &style, None).map_err(CommandError::failure)?;
    let function = style.settings.function(&stage.medium);
    let uniform = Buffer::uniform(gpu, &function);
    let epipole_march = epipole_near_picture(&stage.camera, stage.light.direction);
    let settings = Settings { visibility, filtering, epipole_march, ..Settings::default() };
    let method = Prefiltered::new(gpu, shaders, settings, SIZE)?;
    let inputs = stage.inputs();
    let bound = method.bind(gpu, &inputs)?;
    let fused = StylizedEvaluation::new(gpu, shaders, &function, &method).map_err(CommandError::failure)?;
    let fused_bound = fused.bind(gpu, &inputs, &method, &map, &uniform).map_err(CommandError::failure)?;
    let restyle = Restyle::new(gpu, shaders, &function, &inputs, SIZE).map_err(CommandError::failure)?;
    let restyle_bound =
        restyle.bind(gpu, &inputs, &method.scattered, &map, &uniform).map_err(CommandError::failure)?;
    run(gpu, &|encoder| {
        method.record(encoder, &bound);
        restyle.record(encoder, &restyle_bound);
        fused.record(encoder, &fused_bound);
    })?;
    let read = |texture: &crate::Texture| texture.read(gpu).map_err(CommandError::failure);
    let differences = read(&fused.restyled)?;
    let differences = differences.iter().zip(read(&restyle.restyled)?).map(|(a, b)| f64::from((a - b).abs()));
    let quality = Quality {
        metric: "greatest difference from two passes, radiance and visibility",
        error: differences.fold(0.0, f64::max),
        baseline_error: 0.0,
    };
    let samples = interleaved(
        gpu,
        &[
            &|encoder| fused.record(encoder, &fused_bound),
            &|encoder| method.record_evaluation(encoder, &bound),
            &|encoder| {
                method.record_evaluation(encoder, &bound);
                restyle.record(encoder, &restyle_bound);
            },
        ],
        SAMPLES,
    )?;
    let [together, plain, apart] = &samples[..] else {
        return Err(CommandError::failure("three pieces of work are timed"));
    };
    Ok(vec![
        ratio(SYSTEM, format!("transfer_overhead{suffix}"), together, plain, "lower", Some(quality)),
        ratio(SYSTEM, format!("transfer_pass_overhead{suffix}"), apart, plain, "lower", None),
        time(SYSTEM, format!("transfer_fused{suffix}"), together.clone()),
        time(SYSTEM, format!("transfer_plain{suffix}"), plain.clone()),
    ])
}
