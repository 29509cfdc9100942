// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the choices inside `scattering` gain: reference ray, epipole, near plane, rectification, filtering.

use super::scattering::{SHADOW_MAP, SYSTEM, Truth, run};
use super::{Row, figure};
use crate::command::CommandError;
use crate::core::{Raster, direction_from_angles};
use crate::scattering::{
    BasisFormat, Filtering, Prefiltered, ProjectiveMap, ProjectivePrefiltered, RANK_BITS, Reference,
    Settings, Visibility, epipole_near_picture, projective_rows,
};
use crate::scenes::{self, Scene};
use crate::{Gpu, Lighting, Shaders, Stage};
use airlight_tests::error;
use glam::Vec3;

const SIZE: [u32; 2] = [960, 540];
/// Splits of the projective map.
const SPLITS: u32 = 4;

/// Every figure of the choices.
pub fn rows(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let mut rows = reference_ray(gpu, shaders)?;
    rows.extend(epipole(gpu, shaders)?);
    rows.extend(projective(gpu, shaders)?);
    Ok(rows)
}

fn scene(name: &str) -> Result<Scene, CommandError> {
    scenes::scene(name)?.ok_or_else(|| CommandError::failure(format!("no scene `{name}`")))
}

fn staged(gpu: &Gpu, shaders: &Shaders, scene: &Scene) -> Result<Stage, CommandError> {
    Ok(Stage::new(gpu, &Raster::new(gpu, shaders)?, &scene.setting(), SIZE, SHADOW_MAP)?)
}

/// Relative RMSE of radiance against the f64 picture without rectification.
fn radiance_error(
    gpu: &Gpu,
    shaders: &Shaders,
    stage: &Stage,
    settings: Settings,
) -> Result<f64, CommandError> {
    let prefiltered = Prefiltered::new(gpu, shaders, settings, SIZE)?;
    let bound = prefiltered.bind(gpu, &stage.inputs())?;
    run(gpu, &|encoder| prefiltered.record(encoder, &bound))?;
    let truth = Truth::new(gpu, stage, &prefiltered.rectification.rectified)?;
    let exact = truth.shadow_map_picture(gpu, stage)?.radiance();
    Ok(error::relative_rmse(&truth.radiance(gpu, &prefiltered.scattered)?, &exact))
}

/// Optimum of Eq. 4.12 against bisectrix, in air eight times as thick, where the weights matter. 16 bits, so that
/// nothing else does.
fn reference_ray(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let mut rows = Vec::new();
    for name in ["foliage", "torus"] {
        let mut scene = scene(name)?;
        scene.medium.extinction *= 8.0;
        let stage = staged(gpu, shaders, &scene)?;
        for (label, reference) in [("optimum", Reference::Optimum), ("bisectrix", Reference::Bisectrix)] {
            let settings = Settings {
                reference,
                bases: 64,
                format: BasisFormat::Rgba16Float,
                filtering: Filtering::Linear,
                ..Settings::tuned(gpu)
            };
            let value = radiance_error(gpu, shaders, &stage, settings)?;
            rows.push(figure(SYSTEM, format!("reference_{label}_radiance_error_{name}"), value, "fraction"));
        }
    }
    Ok(rows)
}

/// The light in the picture: nothing done about it, the depth warp of thesis 4.5, and the marched block.
fn epipole(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let stage = staged(gpu, shaders, &scene("sun")?)?;
    let mut rows = Vec::new();
    let rank = Visibility::Rank { bits: RANK_BITS };
    for (label, visibility, depth_warp, epipole_march) in [
        ("nothing", Visibility::Fourier, false, false),
        ("depth_warp", Visibility::Fourier, true, false),
        ("march", Visibility::Fourier, false, true),
        ("rank", rank, false, false),
        ("rank_march", rank, false, true),
    ] {
        let tuned = Settings { filtering: Filtering::Linear, ..Settings::tuned(gpu) };
        let settings = Settings { visibility, depth_warp, epipole_march, ..tuned };
        let value = radiance_error(gpu, shaders, &stage, settings)?;
        rows.push(figure(SYSTEM, format!("epipole_{label}_radiance_error"), value, "fraction"));
    }
    Ok(rows)
}

/// Projective rows against epipolar slices, with the light at right angles to the view.
fn projective(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let mut rows = Vec::new();
    for name in ["foliage", "terrain"] {
        let mut scene = scene(name)?;
        set_light(&mut scene, direction_from_angles(100.0, 35.0));
        let stage = staged(gpu, shaders, &scene)?;
        let epipole_march = epipole_near_picture(&stage.camera, stage.light.direction);
        let settings = Settings { epipole_march, filtering: Filtering::Linear, ..Settings::tuned(gpu) };
        let epipolar = radiance_error(gpu, shaders, &stage, settings)?;
        rows.push(figure(SYSTEM, format!("epipolar_radiance_error_{name}_side"), epipolar, "fraction"));
        let limit = stage.medium.distance_limit;
        let projective = projective_rows(&stage.camera, stage.light.direction, limit, SPLITS)
            .map_err(CommandError::failure)?;
        let map = ProjectiveMap::resampled(gpu, shaders, settings.map)?;
        let method = ProjectivePrefiltered::new(gpu, shaders, map, settings, SIZE)?;
        method.write(gpu, &projective)?;
        let bound = method.bind(gpu, &stage.inputs())?;
        run(gpu, &|encoder| method.record(encoder, &bound))?;
        let prefiltered = Prefiltered::new(gpu, shaders, settings, SIZE)?;
        let truth = Truth::new(gpu, &stage, &prefiltered.rectification.rectified)?;
        let exact = truth.shadow_map_picture(gpu, &stage)?.radiance();
        let value = error::relative_rmse(&truth.radiance(gpu, &method.scattered)?, &exact);
        rows.push(figure(SYSTEM, format!("projective_radiance_error_{name}_side"), value, "fraction"));
    }
    Ok(rows)
}

fn set_light(scene: &mut Scene, towards: Vec3) {
    if let Lighting::Directional { towards: light, .. } = &mut scene.light {
        *light = towards;
    }
}
