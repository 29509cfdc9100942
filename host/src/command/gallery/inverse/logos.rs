// SPDX-License-Identifier: MIT OR Apache-2.0
//! Two logos painted onto a cloud from two sides (thesis Fig. 7.5).

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::{
    Board, COLUMNS, Easel, Effort, Paint, Pose, Wish, clear_sky, daylight, decibels, fidelity, pixels,
    solve_size,
};
use crate::command::CommandError;
use crate::command::inverse::paint::{Canvas, Logo, Mark, Painted};
use crate::data::cloud;
use crate::inverse::Solved;
use glam::{Vec2, Vec3};
use std::time::Instant;

const EFFORT: Effort = Effort { iterations: 12, laplacian: 5e-4, empty: false };
/// What only adds light, or only takes it away, is soon as near as it gets.
const LESS: Effort = Effort { iterations: 6, ..EFFORT };
const FIELD: f32 = 30.0;
const EXPOSURE: f32 = 1.0;

/// A view that is painted on.
struct Side {
    name: &'static str,
    pose: Pose,
    logo: Logo,
}

fn sides() -> [Side; 2] {
    let logo = |mark, middle, radius, turn| Logo { mark, middle, radius, turn, shade: 0.6 };
    [
        Side { name: "front", pose: pose(0.0), logo: logo(Mark::Sun, Vec2::new(0.0, 0.08), 0.5, 0.2) },
        Side { name: "side", pose: pose(90.0), logo: logo(Mark::Leaf, Vec2::new(0.0, 0.08), 0.54, 1.1) },
    ]
}

fn pose(azimuth: f32) -> Pose {
    Pose::around(Vec3::new(0.0, 0.0, 0.0), [8.0, -0.4], azimuth, FIELD)
}

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let sun = Vec3::new(0.62, 0.62, 0.62).normalize();
    let sky = clear_sky();
    let volume = cloud([96, 48, 80], 9);
    let power = 20.0;
    let lights = daylight(&sky, (sun, power * Vec3::new(1.0, 0.92, 0.80)))?;
    let easel = Easel::new(studio, &volume, &lights)?;
    let behind = |_: Vec3, way: Vec3| sky.radiance(way, sun);
    let plain = Paint::plain(0.85);
    let sides = sides();

    let begun = Instant::now();
    let mut painted: Vec<(Board, Painted)> = Vec::new();
    for side in &sides {
        let board = Board::new(&side.pose, solve_size(studio.size, COLUMNS), behind)?;
        let painting = paint(&easel, side, &board, &plain)?;
        painted.push((board, painting));
    }
    let wishes: Vec<Wish<'_>> =
        painted.iter().map(|(board, painting)| Wish::even(board, painting.canvas.pixels())).collect();
    let mut found = Vec::new();
    for (solved, effort, name) in [
        (Solved::Both, EFFORT, "emission and albedo"),
        (Solved::Emission, LESS, "emission only"),
        (Solved::Albedo, LESS, "albedo only"),
    ] {
        found.push((name, easel.solve(solved, &plain, &wishes, effort)?));
    }
    let seconds = begun.elapsed().as_secs_f64();
    let mut facts = Vec::new();
    for (side, (board, painting)) in sides.iter().zip(&painted) {
        let show = |radiance: &[Vec3]| pixels(studio, radiance, board.size, EXPOSURE);
        let wanted = show(painting.canvas.pixels())?;
        for (what, paint) in &found {
            let (radiance, opacity) = easel.shown(board, paint)?;
            let value = decibels(fidelity(&show(&radiance)?, &wanted, &opacity));
            facts.push((format!("{what}, {}", side.name), value));
        }
    }

    let about = "A sun is painted onto a cloud as it is seen from the front, and a leaf as it is seen from the side. Emission and albedo together look as painted from both; emission alone only adds light, albedo alone only takes it away. Between the two views the marks dissolve into the cloud.";
    let mut album = Album::new(&studio.out, folder, "Two logos in a cloud".to_owned(), about.to_owned())?;
    for side in &sides {
        let board = Board::new(&side.pose, studio.size, behind)?;
        let (before, _) = easel.shown(&board, &plain)?;
        let target = paint(&easel, side, &board, &plain)?;
        let show = |radiance: &[Vec3]| pixels(studio, radiance, studio.size, EXPOSURE);
        let wanted = show(target.canvas.pixels())?;
        let name = side.name;
        album.add_tile(
            format!("{name}_original.png"),
            format!("Original, {name}"),
            studio.size,
            &show(&before)?,
        )?;
        album.add_tile(format!("{name}_target.png"), format!("Target, {name}"), studio.size, &wanted)?;
        for (what, paint) in &found {
            let (radiance, _) = easel.shown(&board, paint)?;
            let shown = show(&radiance)?;
            let file = format!("{name}_{}.png", what.replace(' ', "_"));
            album.add_tile(file, format!("Result, {name}: {what}"), studio.size, &shown)?;
        }
        // The sixth of a row: from half-way on.
        let azimuth = if name == "front" { 32.0 } else { 62.0 };
        let board = Board::new(&pose(azimuth), studio.size, behind)?;
        let (radiance, _) = easel.shown(&board, &found[0].1)?;
        let caption = format!("Emission and albedo, from {azimuth}°");
        album.add_tile(format!("between_{azimuth}.png"), caption, studio.size, &show(&radiance)?)?;
    }
    facts.into_iter().for_each(|(what, value)| album.fact(what, value));
    album.fact("three solves from two views", format!("{seconds:.1} s"));
    album.finish_with_sheet(3, "From the front and from the side: original, target and results; the sixth of each is between the views")
}

/// The target of a view.
fn paint(easel: &Easel<'_>, side: &Side, board: &Board, plain: &Paint) -> Result<Painted, CommandError> {
    let (radiance, opacity) = easel.shown(board, plain)?;
    // Thin edges take paint as fully as they are there, no less.
    Ok(side.logo.paint(&Canvas::new(board.size, radiance), &opacity))
}
