// SPDX-License-Identifier: MIT OR Apache-2.0
//! The named figures of the system `ambient`: what bent normals cost over occlusion alone, and what bent cones save over light that is looked up.

use super::{Quality, Row, Work, ambient_directional, interleaved, ratio, time};
use crate::ambient::{
    AmbientError, BentForm, BentPasses, Blurring, OcclusionSettings, Sampling, SurfaceImages,
};
use crate::command::{CommandError, progress};
use crate::core::{Camera, DepthRange, Geometry, GeometryPass, MeshBuffers, PerspectiveView};
use crate::data::{Mesh, mesh_from_bytes, plane};
use crate::scenes::BUNNY;
use crate::{Gpu, Shaders, StageError, Texture};
use glam::{Mat4, Vec2, Vec3};

/// Name of the system in its rows.
pub const SYSTEM: &str = "ambient";
/// Samples of each piece of work.
pub const SAMPLES: usize = 5;
/// As in Fig. 3.1 of the thesis.
const SIZE: [u32; 2] = [2048, 1024];
/// Metres up to which occluders count.
pub const RADIUS: f32 = 0.5;

/// The bunny, as high as 1.6 metres, on a floor that fills the lower part of the picture.
pub struct Scene {
    /// What is seen.
    pub mesh: Mesh,
    /// From where.
    pub camera: Camera,
    /// Its depth, normals and albedos.
    pub geometry: Geometry,
}

impl Scene {
    fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, CommandError> {
        let bunny = mesh_from_bytes(BUNNY.0, BUNNY.1).map_err(CommandError::failure)?;
        let bounds = bunny.bounds().ok_or_else(|| CommandError::failure("the bunny has no triangles"))?;
        let feet = Vec3::new(bounds.center().x, bounds.min.y, bounds.center().z);
        let scale = Mat4::from_scale(Vec3::splat(1.6 / bounds.size().y));
        let mut mesh = bunny.transformed(scale * Mat4::from_translation(-feet));
        mesh.append(&plane(Vec2::splat(12.0), 1));
        let view = PerspectiveView {
            eye: Vec3::new(0.5, 1.8, 3.4),
            target: Vec3::new(0.0, 0.7, 0.0),
            field_of_view: 36.0,
            near: 0.1,
            far: 30.0,
            depth: DepthRange::Reversed,
        };
        let camera = Camera::new(&view.into(), SIZE).map_err(StageError::Camera)?;
        let geometry =
            GeometryPass::new(gpu, shaders)?.draw(gpu, &camera, &[MeshBuffers::new(gpu, &mesh)])?;
        Ok(Self { mesh, camera, geometry })
    }

    /// As the passes take it.
    pub fn images(&self) -> SurfaceImages<'_> {
        SurfaceImages { camera: &self.camera, depth: &self.geometry.depth, normals: &self.geometry.normals }
    }
}

/// Every named figure.
pub fn rows(gpu: &Gpu, shaders: &Shaders, quiet: bool) -> Result<Vec<Row>, CommandError> {
    let bar = progress::bar(2, quiet);
    bar.set_message("bent normals and occlusion alone");
    let scene = Scene::new(gpu, shaders)?;
    let mut rows = costs(gpu, shaders, &scene)?;
    bar.inc(1);
    bar.set_message("bent cones and light that is looked up");
    rows.extend(ambient_directional::rows(gpu, shaders, &scene)?);
    bar.finish_and_clear();
    Ok(rows)
}

/// What bent normals cost over occlusion alone.
fn costs(gpu: &Gpu, shaders: &Shaders, scene: &Scene) -> Result<Vec<Row>, CommandError> {
    let seen = scene.images();
    let settings = OcclusionSettings::new(RADIUS);
    let passes = |occlusion_only: bool, blurring: Blurring| {
        let form = BentForm { sampling: Sampling::Hemisphere, blurring, occlusion_only, halved: false };
        BentPasses::new(gpu, shaders, form)
    };
    let all = [
        passes(false, Blurring::Difference)?,
        passes(true, Blurring::Difference)?,
        passes(false, Blurring::Off)?,
        passes(true, Blurring::Off)?,
    ];
    let found = |passes: &BentPasses, encoder: &mut wgpu::CommandEncoder| -> Result<Texture, AmbientError> {
        passes.record(gpu, encoder, seen, &settings)
    };
    let mut encoder = gpu.encoder();
    let [bent, alone] = [found(&all[0], &mut encoder)?, found(&all[1], &mut encoder)?];
    gpu.submit(encoder)?;
    let (bent, alone) = (bent.read(gpu)?, alone.read(gpu)?);
    let squares = bent.chunks_exact(4).zip(&alone).map(|(bent, alone)| f64::from(bent[3] - alone).powi(2));
    let error = (squares.sum::<f64>() / alone.len() as f64).sqrt();
    let quality = || Some(Quality { metric: "RMS difference of openness", error, baseline_error: 0.0 });
    // The only errors are of settings, which the quality has met.
    let works: [Work<'_>; 4] = [
        &|encoder| drop(found(&all[0], encoder)),
        &|encoder| drop(found(&all[1], encoder)),
        &|encoder| drop(found(&all[2], encoder)),
        &|encoder| drop(found(&all[3], encoder)),
    ];
    let samples = interleaved(gpu, &works, SAMPLES)?;
    let mut rows = vec![
        ratio(SYSTEM, "bent_over_ao", &samples[0], &samples[1], "lower", quality()),
        ratio(SYSTEM, "bent_over_ao_without_blur", &samples[2], &samples[3], "lower", None),
    ];
    for (name, list) in ["bent", "ao", "bent_without_blur", "ao_without_blur"].iter().zip(samples) {
        rows.push(time(SYSTEM, *name, list));
    }
    Ok(rows)
}
