// SPDX-License-Identifier: MIT OR Apache-2.0
//! A plume of smoke that becomes that of an active volcano (thesis Fig. 7.6).

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::super::transmittance::sky::Sky;
use super::easel::{
    Board, COLUMNS, Easel, Effort, Paint, Pose, Wish, daylight, decibels, fidelity, pixels, solve_size,
};
use super::mountain::Mountain;
use crate::command::CommandError;
use crate::command::inverse::paint::{Canvas, Lava, Painted};
use crate::data::{Volume, plume};
use crate::inverse::Solved;
use glam::{Mat4, Vec3};
use std::time::Instant;

const EFFORT: Effort = Effort { iterations: 6, laplacian: 1e-2, empty: false };
const EXPOSURE: f32 = 1.0;
/// Painted from so many sides.
const SIDES: u16 = 6;

fn pose(azimuth: f32) -> Pose {
    Pose::around(Vec3::new(0.0, 2.1, 0.0), [12.5, 0.7], azimuth, 29.5)
}

fn sky() -> Sky {
    Sky {
        zenith: Vec3::new(0.026, 0.046, 0.115),
        horizon: Vec3::new(0.15, 0.117, 0.14),
        glow: Vec3::new(0.34, 0.14, 0.045),
        haze: 0.32,
    }
}

/// The plume, as wide as an eruption's.
fn smoke() -> Volume {
    let Volume { size, values, world_from_unit } = plume([64, 96, 64], 3);
    let wide = 2.5;
    let world_from_unit = Mat4::from_scale(Vec3::new(wide, 1.0, wide)) * world_from_unit;
    let values = values.into_iter().map(|value| 0.5 * value).collect();
    Volume { size, values, world_from_unit }
}

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let sun = Vec3::new(-0.86, 0.30, 0.42).normalize();
    let sky = sky();
    let power = 7.0;
    let lights = daylight(&sky, (sun, power * Vec3::new(1.0, 0.66, 0.42)))?;
    let easel = Easel::new(studio, &smoke(), &lights)?;
    let mountain = Mountain { sun: (sun, power * Vec3::new(1.0, 0.66, 0.42)), sky: &sky };
    let behind = |eye: Vec3, way: Vec3| mountain.radiance(eye, way);
    let plain = Paint::plain(0.8);
    let azimuths: Vec<f32> = (0..SIDES).map(|side| 360.0 * f32::from(side) / f32::from(SIDES)).collect();

    let begun = Instant::now();
    let mut painted: Vec<(Board, Painted)> = Vec::new();
    for azimuth in &azimuths {
        let board = Board::new(&pose(*azimuth), solve_size(studio.size, COLUMNS), behind)?;
        let painting = paint(&easel, *azimuth, &board, &plain)?;
        painted.push((board, painting));
    }
    let wishes: Vec<Wish<'_>> =
        painted.iter().map(|(board, painted)| Wish::even(board, painted.canvas.pixels())).collect();
    let found = easel.solve(Solved::Both, &plain, &wishes, EFFORT)?;
    let seconds = begun.elapsed().as_secs_f64();

    let about = "Lava veins and a glow from inside are painted onto six views of a plume; emission and albedo are solved for from all six at once. Views in between are of the same volume, and none of them was painted.";
    let mut album =
        Album::new(&studio.out, folder, "A plume becomes a volcano".to_owned(), about.to_owned())?;
    let show = |radiance: &[Vec3]| pixels(studio, radiance, studio.size, EXPOSURE);
    let mut facts = Vec::new();
    for azimuth in [0.0, 120.0] {
        let board = Board::new(&pose(azimuth), studio.size, behind)?;
        let (before, opacity) = easel.shown(&board, &plain)?;
        let wanted = show(paint(&easel, azimuth, &board, &plain)?.canvas.pixels())?;
        let (after, _) = easel.shown(&board, &found)?;
        let after = show(&after)?;
        for (name, caption, shown) in [
            ("original", "Original", &show(&before)?),
            ("target", "Target", &wanted),
            ("result", "Result", &after),
        ] {
            album.add_tile(
                format!("{azimuth}_{name}.png"),
                format!("{caption}, from {azimuth}°"),
                studio.size,
                shown,
            )?;
        }
        facts.push((format!("from {azimuth}°"), decibels(fidelity(&after, &wanted, &opacity))));
    }
    for azimuth in [30.0, 90.0, 330.0] {
        let board = Board::new(&pose(azimuth), studio.size, behind)?;
        let (after, _) = easel.shown(&board, &found)?;
        let caption = format!("In between, from {azimuth}°");
        album.add_tile(format!("{azimuth}_between.png"), caption, studio.size, &show(&after)?)?;
    }
    facts.into_iter().for_each(|(what, value)| album.fact(what, value));
    album.fact("solved from six views", format!("{seconds:.1} s"));
    album.finish_with_sheet(
        3,
        "Original, target and result from two of six sides; below, from sides in between",
    )
}

/// The target of a view.
fn paint(easel: &Easel<'_>, azimuth: f32, board: &Board, plain: &Paint) -> Result<Painted, CommandError> {
    let (radiance, opacity) = easel.shown(board, plain)?;
    let lava = Lava { azimuth: azimuth.to_radians(), seed: 5, radiance: 2.5, reach: 0.85 };
    Ok(lava.paint(&Canvas::new(board.size, radiance), &opacity))
}
