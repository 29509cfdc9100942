// SPDX-License-Identifier: MIT OR Apache-2.0
//! The passes: geometry, bent normals, light.

use super::flags::Options;
use super::shown::Seen;
use crate::ambient::{BentPasses, ConeLight, ConeLightForm, Method, ShadePass, SurfaceImages};
use crate::command::CommandError;
use crate::core::{Camera, GeometryPass, MeshBuffers};
use crate::data::{Environment, Mesh};
use crate::scattering::check_size;
use crate::{Gpu, Shaders};
use glam::Vec3;

/// Draws in screen space. `radius`: metres up to which occluders count, where none was given; `light`: none where only numbers are shown.
///
/// # Errors
/// Misuse and failures of all kinds.
pub fn draw(
    (gpu, shaders): (&Gpu, &Shaders),
    options: &Options,
    (mesh, camera, radius): (&Mesh, &Camera, f32),
    light: Option<&Environment>,
    method: Method,
) -> Result<Vec<Option<Seen>>, CommandError> {
    check_size(gpu, "a picture", options.size)?;
    let passes = BentPasses::new(gpu, shaders, options.form())?;
    let buffers = MeshBuffers::new(gpu, mesh);
    let geometry = GeometryPass::new(gpu, shaders)?.draw(gpu, camera, &[buffers])?;
    let seen = SurfaceImages { camera, depth: &geometry.depth, normals: &geometry.normals };
    let mut encoder = gpu.encoder();
    let bent = passes.record(gpu, &mut encoder, seen, &options.settings(radius))?;
    let lit = match light {
        Some(environment) => {
            let light = ConeLight::new(gpu, shaders, environment, ConeLightForm::default())?;
            let shade = ShadePass::new(gpu, shaders, method, options.printed)?;
            Some(shade.record(gpu, &mut encoder, seen, &geometry.albedos, &bent, &light.cones)?)
        }
        None => None,
    };
    gpu.submit(encoder)?;
    // Memory that ran out is said here.
    gpu.check()?;
    let normals = geometry.normals.read(gpu)?;
    let bent = bent.read(gpu)?;
    let radiance = lit.map(|picture| picture.read(gpu)).transpose()?;
    let pixel = |(place, (normal, bent)): (usize, (&[f32], &[f32]))| {
        // Where nothing is the normal is 0.
        normal[..3].iter().any(|value| *value != 0.0).then(|| Seen {
            radiance: radiance.as_ref().map_or(Vec3::ZERO, |all| Vec3::from_slice(&all[4 * place..])),
            open: bent[3],
            mean: Vec3::from_slice(bent),
        })
    };
    Ok(normals.chunks_exact(4).zip(bent.chunks_exact(4)).enumerate().map(pixel).collect())
}
