// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight ambient`: meshes of the user's in the light of an environment map, by bent normals and cones in screen space.

mod conflicts;
mod flags;
pub(super) mod shown;
pub(super) mod studio;
pub(super) mod traced;

pub use flags::Options;

use super::camera::Subject;
use super::environments::environment;
use super::models::meshes;
use super::scattering::tone_mapped;
use super::{CommandError, progress};
use crate::ambient::ConeLight;
use crate::core::{Camera, Tonemap};
use crate::data::{Bounds, Environment};
use crate::formats::{write_exr, write_png};
use crate::{Gpu, Shaders, StageError, Texture};
use glam::Vec3;
use shown::Seen;
use std::path::Path;

/// From the middle to the eye.
const FROM: Vec3 = Vec3::new(-0.4, 0.3, 1.0);
/// Radius of occlusion over the diagonal of the box around the meshes.
const REACH: f32 = 0.2;
/// Texels of environments that cones can follow.
pub(super) const LOW_PASS: [u32; 2] = [32, 16];
/// The map where none is asked for.
const ENVIRONMENT: &str = "forest";

/// Runs the command.
pub fn run(options: &Options, quiet: bool) -> Result<(), CommandError> {
    conflicts::check(options)?;
    super::run::check_writable("--out", &options.out)?;
    let bar = progress::bar(3, quiet);
    bar.set_message("reading meshes and light");
    let mesh = meshes(&options.mesh)?;
    let light = (!options.numbers()).then(|| read_light(options)).transpose()?;
    let bounds = mesh.bounds().ok_or_else(|| CommandError::failure("--mesh: there is nothing to draw"))?;
    let camera = frame(options, &bounds)?;
    let radius = (REACH * bounds.size().length()).max(1e-6);
    bar.inc(1);

    bar.set_message("light on surfaces");
    // Rays, and pictures without a tone curve, need no device.
    let tone_curve = light.is_some() && !options.linear();
    let method = options.method.method();
    let device = if tone_curve || method.is_some() { Some(device()?) } else { None };
    let seen = match (method, &device) {
        (Some(method), Some((gpu, shaders))) => {
            studio::draw((gpu, shaders), options, (&mesh, &camera, radius), light.as_ref(), method)?
        }
        _ => traced::trace(&mesh, light.as_ref(), &camera, options.rays(), options.radius, 1),
    };
    bar.inc(1);

    bar.set_message("writing");
    write(options, &seen, light.as_ref(), &camera, device.as_ref())?;
    bar.finish_and_clear();
    let count = seen.iter().flatten().count();
    if count == 0 {
        eprintln!("airlight: warning: --eye, --target: no surface is in the picture");
    }
    if !quiet {
        if method.is_some() {
            println!("radius: {:.4} m", options.settings(radius).radius);
        }
        println!("surfaces: in {count} of {} pixels", seen.len());
        println!("{}", options.out.display());
    }
    Ok(())
}

fn device() -> Result<(Gpu, Shaders), CommandError> {
    Ok((pollster::block_on(Gpu::new())?, Shaders::builtin()))
}

fn read_light(options: &Options) -> Result<Environment, CommandError> {
    let path = options.environment.as_deref().unwrap_or(Path::new(ENVIRONMENT));
    let map = environment(path)?;
    ConeLight::check(&map)?;
    Ok(if options.low_pass { map.resized(LOW_PASS) } else { map })
}

/// The camera, with what was not said taken from the box around the meshes.
fn frame(options: &Options, bounds: &Bounds) -> Result<Camera, CommandError> {
    let ball = (bounds.center(), bounds.radius().max(1e-4));
    let points = bounds.corners();
    let subject = Subject { center: bounds.center(), points: &points, ball, from: FROM, turn: 0.0 };
    let view = options.view.view(&subject, options.size);
    Ok(Camera::new(&view, options.size).map_err(StageError::Camera)?)
}

fn write(
    options: &Options,
    seen: &[Option<Seen>],
    light: Option<&Environment>,
    camera: &Camera,
    device: Option<&(Gpu, Shaders)>,
) -> Result<(), CommandError> {
    let (path, [width, height]) = (&options.out, options.size);
    let (show, method) = (options.show, options.method);
    let written = match (light, device) {
        (None, _) if options.linear() => write_exr(path, width, height, &shown::numbers(seen, show, method)),
        (None, _) => write_png(path, width, height, &shown::bytes(seen, show, method)),
        (Some(light), Some((gpu, shaders))) if !options.linear() => {
            let texture = Texture::new(
                gpu,
                options.size,
                wgpu::TextureFormat::Rgba32Float,
                wgpu::TextureUsages::TEXTURE_BINDING,
            );
            texture.write(gpu, &shown::before(seen, light, camera))?;
            let tonemap = Tonemap::new(gpu, shaders)?;
            let pixels = tone_mapped(gpu, &tonemap, &[texture], options.exposure.unwrap_or(1.0))?;
            write_png(path, width, height, &pixels)
        }
        (Some(light), _) => write_exr(path, width, height, &shown::before(seen, light, camera)),
    };
    written.map_err(|error| CommandError::failure(format!("--out: {error}")))
}
