// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes by every method, against a march to the light (paper Fig. 4).

use super::super::album::{Album, Section};
use super::super::plates;
use super::super::studio::Studio;
use super::setting::{Arrangement, Setting, build, upload};
use super::sky::Sky;
use super::{METHODS, Method};
use crate::command::CommandError;
use crate::core::{DepthRange, Light, PerspectiveView};
use crate::data::{self, Volume};
use crate::transmittance::{Form, MapSettings, TransmittanceMap};
use glam::Vec3;

/// What differences are multiplied by, as in the paper.
const AMPLIFIED: f32 = 40.0;
/// Pictures side by side.
const COLUMNS: usize = 4;
/// Columns and rows of all maps.
const MAP: [u32; 2] = [256, 256];

/// Smoke over a plain in the evening.
pub fn plume(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let volume = data::plume([72, 144, 72], 7);
    let arrangement = Arrangement {
        view: PerspectiveView {
            eye: Vec3::new(0.8, 0.7, 7.4),
            target: Vec3::new(0.8, 2.5, 0.0),
            field_of_view: 44.0,
            near: 0.1,
            far: 1000.0,
            depth: DepthRange::Forward,
        },
        sun: (Vec3::new(-0.85, 0.42, -0.25), Vec3::new(15.0, 8.6, 4.2)),
        fill: (Vec3::new(0.5, 0.6, 0.6), Vec3::new(0.55, 0.8, 1.35)),
        medium: (Vec3::new(0.94, 0.92, 0.90), 0.35),
        sky: Sky {
            zenith: Vec3::new(0.03, 0.07, 0.18),
            horizon: Vec3::new(0.42, 0.22, 0.15),
            glow: Vec3::new(0.75, 0.32, 0.09),
            haze: 0.22,
        },
        ground: Some(Vec3::new(0.09, 0.075, 0.06)),
        exposure: 1.0,
    };
    section(studio, folder, "A plume of smoke", &arrangement, &volume, 1.3)
}

/// A cloud at noon.
pub fn cloud(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let volume = data::cloud([90, 45, 75], 9);
    let arrangement = Arrangement {
        view: PerspectiveView {
            eye: Vec3::new(1.5, -1.0, 7.6),
            target: Vec3::new(0.0, 0.2, 0.0),
            field_of_view: 34.0,
            near: 0.1,
            far: 1000.0,
            depth: DepthRange::Forward,
        },
        sun: (Vec3::new(-0.55, 0.8, 0.15), Vec3::new(13.0, 11.9, 10.3)),
        fill: (Vec3::new(0.3, -0.3, 1.0), Vec3::new(0.8, 1.15, 1.7)),
        medium: (Vec3::new(0.99, 0.99, 0.99), 0.2),
        sky: Sky {
            zenith: Vec3::new(0.02, 0.07, 0.22),
            horizon: Vec3::new(0.20, 0.29, 0.40),
            glow: Vec3::new(0.25, 0.22, 0.16),
            haze: 0.22,
        },
        ground: None,
        exposure: 1.0,
    };
    section(studio, folder, "A cloud", &arrangement, &volume, 1.2)
}

/// A volume by every method. `scale`: from its values to extinction in 1/m.
pub fn section(
    studio: &Studio,
    folder: &str,
    title: &str,
    arrangement: &Arrangement,
    volume: &Volume,
    scale: f32,
) -> Result<Section, CommandError> {
    let points = volume.occupied_points();
    let setting = Setting::new(studio, arrangement, |towards, radiance| {
        Light::directional_leaning(towards, radiance, points.iter().copied())
    })?;
    let uploaded = upload(studio, volume, scale)?;
    let fine = MapSettings::new(Form::Bounded, 16, MAP);
    let background = setting.background(&build(studio, fine, &setting.sun, &uploaded)?)?;
    let eight = MapSettings::new(Form::Bounded, 8, MAP);
    let fill = setting.lit(&build(studio, eight, &setting.fill, &uploaded)?, &uploaded)?.read(&studio.gpu)?;
    let brute_force = setting.brute_force(&uploaded)?;
    let exact = brute_force.read(&studio.gpu)?;
    // A map that nothing was written to.
    let empty =
        TransmittanceMap::new(&studio.gpu, MapSettings::new(Form::Extinction, 4, [1, 1]), &setting.sun)?;
    let even = setting.lit(&empty, &uploaded)?;

    let [columns, rows, slices] = volume.size;
    let about = format!(
        "{columns}x{rows}x{slices} voxels, light by a march from every step and through maps of {}x{} texels. Below each \
         map its difference from the march, times {AMPLIFIED}.",
        MAP[0], MAP[1]
    );
    let mut album = Album::new(&studio.out, folder, title.to_owned(), about)?;
    let mut pictures = vec![
        (
            "reference.png".to_owned(),
            "Brute force".to_owned(),
            setting.finish(&background, &brute_force, &fill)?,
        ),
        (
            "unshadowed.png".to_owned(),
            "Without self-shadowing".to_owned(),
            setting.finish(&background, &even, &fill)?,
        ),
    ];
    for (form, coefficients, file, name) in METHODS {
        let lit = setting.lit(
            &build(studio, MapSettings::new(form, coefficients, MAP), &setting.sun, &uploaded)?,
            &uploaded,
        )?;
        let error = relative_rmse(&lit.read(&studio.gpu)?, &exact);
        album.fact(format!("{name}: relative RMSE of sunlight"), format!("{:.1} %", 100.0 * error));
        let difference = plates::difference(&studio.gpu, &lit, &exact, AMPLIFIED)?;
        let pixels = studio.pixels(&difference, arrangement.exposure)?;
        pictures.push((format!("{file}.png"), capital(name), setting.finish(&background, &lit, &fill)?));
        pictures.push((format!("{file}_error.png"), format!("Its difference times {AMPLIFIED}"), pixels));
    }
    for row in pictures.chunks(2 * COLUMNS) {
        // What belongs together is one above the other.
        for start in [0, 1] {
            for (file, caption, pixels) in row.iter().skip(start).step_by(2) {
                album.add_tile(file, caption, studio.size, pixels)?;
            }
        }
    }
    let names: Vec<&str> = METHODS.iter().map(|(.., name): &Method| *name).collect();
    album.finish_with_sheet(
        COLUMNS as u32,
        &format!("Brute force (below it without self-shadowing), {}", names.join(", ")),
    )
}

/// Over the colours of rgba pixels.
fn relative_rmse(found: &[f32], exact: &[f32]) -> f64 {
    let colors = |all: &[f32], of: &dyn Fn(usize) -> f32| -> f64 {
        (0..all.len()).filter(|i| i % 4 != 3).map(|i| f64::from(of(i)).powi(2)).sum()
    };
    (colors(exact, &|i| found[i] - exact[i]) / colors(exact, &|i| exact[i]).max(1e-30)).sqrt()
}

fn capital(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}
