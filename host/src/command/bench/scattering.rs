// SPDX-License-Identifier: MIT OR Apache-2.0
//! The named figures of the system `scattering`.

use super::{Quality, Row, Work, figure, interleaved, ratio, time};
use crate::command::CommandError;
use crate::command::progress;
use crate::core::Raster;
use crate::scattering::{
    Along, BasisFormat, Filtering, March, Prefiltered, Settings, Weighting, epipole_near_picture,
};
use crate::scenes::{self, Scene};
use crate::{Gpu, Shaders, Stage, Texture};
use airlight_tests::error;
use airlight_tests::linear::{Mat4, Vec3};
use airlight_tests::reference::camera::Camera;
use airlight_tests::reference::scattering as reference;

/// Name of the system in its rows.
pub const SYSTEM: &str = "scattering";
/// Size of the picture of the named ratios.
pub const SIZE: [u32; 2] = [1920, 1080];
/// Size of the standard shadow map.
pub const SHADOW_MAP: [u32; 2] = [2048, 2048];
/// Every how many pixels the f64 picture is evaluated.
const STRIDE: usize = 4;

/// A scene by name, on the GPU.
pub fn stage(
    gpu: &Gpu,
    shaders: &Shaders,
    name: &str,
    size: [u32; 2],
) -> Result<(Scene, Stage), CommandError> {
    let scene = scenes::scene(name)?.ok_or_else(|| CommandError::failure(format!("no scene `{name}`")))?;
    let raster = Raster::new(gpu, shaders)?;
    let stage = Stage::new(gpu, &raster, &scene.setting(), size, SHADOW_MAP)?;
    Ok((scene, stage))
}

/// The f64 picture of a stage over a rectified map that was read back.
pub struct Truth {
    camera: Camera,
    depth: Vec<f32>,
    size: [u32; 2],
    /// Over the rectified map.
    pub rectified: reference::Picture,
}

impl Truth {
    /// Evaluates the picture.
    pub fn new(gpu: &Gpu, stage: &Stage, map: &Texture) -> Result<Self, CommandError> {
        Self::over(gpu, stage, &stage.camera, map, STRIDE)
    }

    /// Evaluates every `stride`-th pixel in x and y over a map that was rectified for `rectified`.
    pub fn over(
        gpu: &Gpu,
        stage: &Stage,
        rectified: &crate::core::Camera,
        map: &Texture,
        stride: usize,
    ) -> Result<Self, CommandError> {
        let camera = |camera: &crate::core::Camera| {
            let matrix = Mat4::from(camera.clip_from_world.to_cols_array());
            Camera::from_matrix(matrix, f64::from(camera.far_depth))
                .ok_or_else(|| CommandError::failure("the camera's matrix has no inverse"))
        };
        let (camera, rectified) = (camera(&stage.camera)?, camera(rectified)?);
        let size = [stage.camera.viewport.x as u32, stage.camera.viewport.y as u32];
        let depth = stage.pictures.depth.read(gpu).map_err(CommandError::failure)?;
        let values = map.read(gpu).map_err(CommandError::failure)?;
        let [width, height, _] = map.size();
        let scene = scene(stage, &camera, &depth, size);
        let rectification = reference::Rectification::new(
            &rectified,
            scene.light.direction,
            scene.medium.distance_limit,
            width as usize,
            height as usize,
        );
        let rectified = reference::picture(&scene, &rectification, &values, stride);
        Ok(Self { camera, depth, size, rectified })
    }

    /// The same pixels without rectification, through the standard shadow map.
    pub fn shadow_map_picture(&self, gpu: &Gpu, stage: &Stage) -> Result<reference::Picture, CommandError> {
        let depth = stage.pictures.shadow_map.read(gpu).map_err(CommandError::failure)?;
        let [width, height, _] = stage.pictures.shadow_map.size();
        let map = reference::ShadowMap {
            depth: &depth,
            width: width as usize,
            height: height as usize,
            clip_from_world: Mat4::from(stage.light.clip_from_world.to_cols_array()),
            far_depth: f64::from(stage.light.far_depth),
        };
        let scene = scene(stage, &self.camera, &self.depth, self.size);
        Ok(reference::shadow_map_picture(&scene, &map, self.rectified.stride))
    }

    /// Visibility (alpha) of a picture of the GPU at the sampled pixels.
    pub fn visibility(&self, gpu: &Gpu, scattered: &Texture) -> Result<Vec<f32>, CommandError> {
        let image = scattered.read(gpu).map_err(CommandError::failure)?;
        Ok(self.rectified.sample(&image, self.size[0] as usize, 4, 3..4))
    }

    /// Radiance of a picture of the GPU at the sampled pixels.
    pub fn radiance(&self, gpu: &Gpu, scattered: &Texture) -> Result<Vec<f32>, CommandError> {
        let image = scattered.read(gpu).map_err(CommandError::failure)?;
        Ok(self.rectified.sample(&image, self.size[0] as usize, 4, 0..3))
    }
}

fn scene<'a>(stage: &Stage, camera: &'a Camera, depth: &'a [f32], size: [u32; 2]) -> reference::Scene<'a> {
    let medium = &stage.medium;
    reference::Scene {
        camera,
        light: reference::Light {
            direction: Vec3::from(stage.light.direction.to_array()),
            radiance: stage.light.radiance.to_array().map(f64::from),
        },
        medium: reference::Medium {
            extinction: f64::from(medium.extinction),
            albedo: f64::from(medium.albedo.x),
            g: f64::from(medium.g),
            distance_limit: f64::from(medium.distance_limit),
        },
        depth,
        width: size[0] as usize,
        height: size[1] as usize,
    }
}

/// Runs what `record` puts into an encoder.
pub fn run(gpu: &Gpu, record: Work<'_>) -> Result<(), CommandError> {
    super::milliseconds(gpu, record).map(|_| ())
}

/// Every named figure.
pub fn rows(gpu: &Gpu, shaders: &Shaders, quiet: bool) -> Result<Vec<Row>, CommandError> {
    let bar = progress::bar(10, quiet);
    let mut rows = Vec::new();
    bar.set_message("march over prefiltered, foliage 1920x1080");
    rows.extend(march_over_prefiltered(gpu, shaders)?);
    bar.inc(1);
    for name in ["foliage", "plane"] {
        bar.set_message(format!("average visibility, {name}"));
        rows.extend(average_visibility(gpu, shaders, name)?);
        bar.inc(1);
    }
    for name in ["foliage", "terrain", "torus"] {
        bar.set_message(format!("weighted radiance, {name}"));
        rows.extend(weighted_radiance(gpu, shaders, name)?);
        bar.inc(1);
    }
    bar.set_message("reduced resolution and equal error, foliage 1920x1080");
    rows.extend(super::resolution::rows(gpu, shaders)?);
    bar.inc(1);
    bar.set_message("reference ray, epipole, projective rows");
    rows.extend(super::choices::rows(gpu, shaders)?);
    bar.inc(1);
    bar.set_message("ways to prefilter visibility");
    rows.extend(super::visibility::rows(gpu, shaders)?);
    bar.inc(1);
    bar.set_message("evaluation of torus against tree");
    rows.push(scene_independence(gpu, shaders)?);
    bar.finish_and_clear();
    rows.extend(super::baselines::rows(gpu, shaders, quiet)?);
    Ok(rows)
}

/// What errors of visibility are.
pub const VISIBILITY: &str = "mean absolute error of visibility";

/// Cost of marching over that of everything that prefiltering does, rectification counted in.
fn march_over_prefiltered(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let (_, stage) = stage(gpu, shaders, "foliage", SIZE)?;
    let epipole_march = epipole_near_picture(&stage.camera, stage.light.direction);
    let settings = Settings { weighting: Weighting::Average, epipole_march, ..Settings::tuned(gpu) };
    let prefiltered = Prefiltered::new(gpu, shaders, settings, SIZE)?;
    let bound = prefiltered.bind(gpu, &stage.inputs())?;
    // Smooth across rows, which no march is.
    let linear = Settings { filtering: Filtering::Linear, ..settings };
    let linear = Prefiltered::new(gpu, shaders, linear, SIZE)?;
    let linear_bound = linear.bind(gpu, &stage.inputs())?;
    let fixed = Along::RowSteps { map: &prefiltered.rectification, steps: settings.map[0] };
    let texels = Along::Rows(&prefiltered.rectification);
    let fixed_march = March::new(gpu, shaders, &fixed, Weighting::Average, SIZE)?;
    let texel_march = March::new(gpu, shaders, &texels, Weighting::Average, SIZE)?;
    let fixed_bound = fixed_march.bind(gpu, &stage.inputs(), &fixed)?;
    let texel_bound = texel_march.bind(gpu, &stage.inputs(), &texels)?;

    let samples = interleaved(
        gpu,
        &[
            &|encoder| prefiltered.record(encoder, &bound),
            &|encoder| fixed_march.record(encoder, &fixed_bound),
            &|encoder| texel_march.record(encoder, &texel_bound),
            &|encoder| prefiltered.record_rectification(encoder, &bound),
            &|encoder| prefiltered.record_filter(encoder, &bound),
            &|encoder| prefiltered.record_evaluation(encoder, &bound),
            &|encoder| linear.record(encoder, &linear_bound),
            &|encoder| linear.record_evaluation(encoder, &linear_bound),
        ],
        7,
    )?;
    let truth = Truth::new(gpu, &stage, &prefiltered.rectification.rectified)?;
    let exact = truth.rectified.average();
    let error = |texture| truth.visibility(gpu, texture).map(|values| error::mean_absolute(&values, &exact));
    let quality = |own, baseline| -> Result<_, CommandError> {
        Ok(Some(Quality { metric: VISIBILITY, error: error(own)?, baseline_error: error(baseline)? }))
    };
    let fixed_quality = quality(&prefiltered.scattered, &fixed_march.scattered)?;
    let texel_quality = quality(&prefiltered.scattered, &texel_march.scattered)?;
    let linear_quality = quality(&linear.scattered, &fixed_march.scattered)?;
    Ok(vec![
        ratio(SYSTEM, "march_over_prefiltered", &samples[1], &samples[0], "higher", fixed_quality),
        ratio(SYSTEM, "march_texels_over_prefiltered", &samples[2], &samples[0], "higher", texel_quality),
        ratio(SYSTEM, "march_over_prefiltered_linear", &samples[1], &samples[6], "higher", linear_quality),
        time(SYSTEM, "prefiltered", samples[0].clone()),
        time(SYSTEM, "march", samples[1].clone()),
        time(SYSTEM, "rectification", samples[3].clone()),
        time(SYSTEM, "filter", samples[4].clone()),
        time(SYSTEM, "evaluation", samples[5].clone()),
        time(SYSTEM, "evaluation_linear", samples[7].clone()),
        figure(SYSTEM, "memory", prefiltered.memory() as f64 / 1e6, "MB"),
    ])
}

/// Error of average visibility against the exact answer over the same rectified map.
fn average_visibility(gpu: &Gpu, shaders: &Shaders, name: &str) -> Result<Vec<Row>, CommandError> {
    let size = [960, 540];
    let (_, stage) = stage(gpu, shaders, name, size)?;
    let mut rows = Vec::new();
    let mut truth = None;
    for bases in [4, 8, 16, 32, 64, 128] {
        let mut errors = Vec::new();
        for format in [BasisFormat::Rgba8Unorm, BasisFormat::Rgba16Float] {
            // The march around the epipole reads another map than the truth does: it is left out.
            let settings = Settings {
                bases,
                format,
                weighting: Weighting::Average,
                epipole_march: false,
                ..Settings::tuned(gpu)
            };
            let prefiltered = Prefiltered::new(gpu, shaders, settings, size)?;
            let bound = prefiltered.bind(gpu, &stage.inputs())?;
            run(gpu, &|encoder| prefiltered.record(encoder, &bound))?;
            if truth.is_none() {
                truth = Some(Truth::new(gpu, &stage, &prefiltered.rectification.rectified)?);
            }
            if let Some(truth) = &truth {
                let values = truth.visibility(gpu, &prefiltered.scattered)?;
                errors.push(error::mean_absolute(&values, &truth.rectified.average()));
            }
        }
        rows.push(figure(SYSTEM, format!("visibility_error_{name}_{bases}"), errors[0], "fraction"));
        let added = errors[0] - errors[1];
        rows.push(figure(
            SYSTEM,
            format!("visibility_error_{name}_{bases}_added_by_8_bit"),
            added,
            "fraction",
        ));
    }
    Ok(rows)
}

/// Relative RMSE of weighted radiance against the marched f64 picture over the same map, and of rectification itself.
fn weighted_radiance(gpu: &Gpu, shaders: &Shaders, name: &str) -> Result<Vec<Row>, CommandError> {
    let size = [960, 540];
    let (_, stage) = stage(gpu, shaders, name, size)?;
    let settings = Settings { epipole_march: false, ..Settings::tuned(gpu) };
    let prefiltered = Prefiltered::new(gpu, shaders, settings, size)?;
    let bound = prefiltered.bind(gpu, &stage.inputs())?;
    run(gpu, &|encoder| prefiltered.record(encoder, &bound))?;
    let truth = Truth::new(gpu, &stage, &prefiltered.rectification.rectified)?;
    let exact = truth.rectified.radiance();
    let values = truth.radiance(gpu, &prefiltered.scattered)?;
    let unrectified = truth.shadow_map_picture(gpu, &stage)?.radiance();
    Ok(vec![
        figure(SYSTEM, format!("radiance_error_{name}"), error::relative_rmse(&values, &exact), "fraction"),
        figure(
            SYSTEM,
            format!("rectification_error_{name}"),
            error::relative_rmse(&exact, &unrectified),
            "fraction",
        ),
    ])
}

/// Cost of evaluating the tree over that of the torus: one, whatever the scene.
fn scene_independence(gpu: &Gpu, shaders: &Shaders) -> Result<Row, CommandError> {
    let mut prepared = Vec::new();
    for name in ["foliage", "torus"] {
        let (_, stage) = stage(gpu, shaders, name, SIZE)?;
        let prefiltered = Prefiltered::new(gpu, shaders, Settings::tuned(gpu), SIZE)?;
        let bound = prefiltered.bind(gpu, &stage.inputs())?;
        run(gpu, &|encoder| prefiltered.record(encoder, &bound))?;
        prepared.push((stage, prefiltered, bound));
    }
    let [(_, tree, tree_bound), (_, torus, torus_bound)] = &prepared[..] else {
        return Err(CommandError::failure("two scenes are needed"));
    };
    let samples = interleaved(
        gpu,
        &[&|encoder| tree.record_evaluation(encoder, tree_bound), &|encoder| {
            torus.record_evaluation(encoder, torus_bound)
        }],
        9,
    )?;
    Ok(ratio(SYSTEM, "evaluation_tree_over_torus", &samples[0], &samples[1], "lower", None))
}
