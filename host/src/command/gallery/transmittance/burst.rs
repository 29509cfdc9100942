// SPDX-License-Identifier: MIT OR Apache-2.0
//! Particles that shadow each other.

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::setting::{Arrangement, Setting};
use super::sky::Sky;
use crate::command::CommandError;
use crate::core::{DepthRange, Light, PerspectiveView};
use crate::data;
use crate::transmittance::{
    Form, MapSettings, ParticleBuffer, ParticlePicture, SplatFixed, TransmittanceMap,
};
use glam::Vec3;

/// How many particles.
const COUNT: usize = 40_000;
/// Columns and rows of all maps.
const MAP: [u32; 2] = [256, 256];
/// Maps side by side, and the one that no particle is splatted to.
const MAPS: [(Form, u32, bool, &str, &str); 6] = [
    (Form::Extinction, 4, false, "unshadowed", "Without the map"),
    (Form::Bounded, 16, true, "bounded16", "Bounded extinction map, 16 coefficients"),
    (Form::Extinction, 4, true, "etm4", "Extinction map, 4 coefficients"),
    (Form::Extinction, 16, true, "etm16", "Extinction map, 16 coefficients"),
    (Form::Bounded, 4, true, "bounded4", "Bounded extinction map, 4 coefficients"),
    (Form::PowerMoments, 8, true, "moments", "Power moments, 7 numbers"),
];

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let gpu = &studio.gpu;
    let particles = data::burst(COUNT, 12);
    let arrangement = Arrangement {
        view: PerspectiveView {
            eye: Vec3::new(2.0, 1.2, 6.0),
            target: Vec3::ZERO,
            field_of_view: 42.0,
            near: 0.1,
            far: 1000.0,
            depth: DepthRange::Forward,
        },
        sun: (Vec3::new(-0.7, 0.6, 0.25), Vec3::new(12.5, 8.6, 5.2)),
        fill: (Vec3::new(0.6, -0.2, 0.6), Vec3::new(0.3, 0.55, 1.05)),
        medium: (Vec3::new(0.95, 0.90, 0.84), 0.1),
        sky: Sky {
            zenith: Vec3::new(0.004, 0.009, 0.022),
            horizon: Vec3::new(0.018, 0.026, 0.045),
            glow: Vec3::new(0.05, 0.03, 0.015),
            haze: 0.5,
        },
        ground: None,
        exposure: 1.0,
    };
    let setting = Setting::new(studio, &arrangement, |towards, radiance| {
        Light::directional_around_balls(towards, radiance, particles.balls())
    })?;
    let buffer = ParticleBuffer::new(gpu, &particles)?;
    let lit = |form, coefficients, light, splatted: bool| {
        let settings = MapSettings::new(form, coefficients, MAP);
        let map = TransmittanceMap::new(gpu, settings, light)?;
        let splat = SplatFixed::new(gpu, &studio.shaders, settings)?;
        let sums = splat.bind(gpu, &map, &buffer)?;
        let pass = ParticlePicture::new(gpu, &studio.shaders, settings, false)?;
        let bound = pass.bind(gpu, &setting.view(), &map, &buffer)?;
        let mut encoder = gpu.encoder();
        if splatted {
            splat.record(&mut encoder, &sums)?;
        }
        pass.record(gpu, &mut encoder, &bound)?;
        gpu.submit(encoder)?;
        Ok::<_, CommandError>(bound.picture)
    };
    let fill = lit(Form::Bounded, 8, &setting.fill, true)?.read(gpu)?;
    let background = setting.background(&TransmittanceMap::new(
        gpu,
        MapSettings::new(Form::Extinction, 4, [1, 1]),
        &setting.sun,
    )?)?;
    let about = format!(
        "{COUNT} particles, splatted to maps of {}x{} texels in fixed point, sorted and blended.",
        MAP[0], MAP[1]
    );
    let mut album = Album::new(&studio.out, folder, "A burst of particles".to_owned(), about)?;
    for (form, coefficients, splatted, file, name) in MAPS {
        let picture = lit(form, coefficients, &setting.sun, splatted)?;
        let pixels = setting.finish(&background, &picture, &fill)?;
        album.add_tile(format!("{file}.png"), name, studio.size, &pixels)?;
    }
    album.finish_with_sheet(2, "Without the map and with it, and the same through other maps")
}
