// SPDX-License-Identifier: MIT OR Apache-2.0
//! Smoke between two frames that were solved for (thesis Fig. 7.12).

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::super::transmittance::sky::Sky;
use super::easel::{
    Board, Easel, Effort, Paint, Pose, Wish, daylight, decibels, fidelity, graded, pixels, solve_size,
};
use super::extended::extended;
use crate::Lighting;
use crate::command::CommandError;
use crate::command::inverse::paint::{Grade, Logo, Mark};
use crate::data::{Volume, fractal_noise, turbulence};
use crate::inverse::Solved;
use glam::{Mat4, Vec2, Vec3};
use std::time::Instant;

/// Voxels.
const SIZE: [u32; 3] = [80, 49, 40];
/// Half of the box, metres.
const HALF: Vec3 = Vec3::new(2.0, 1.2222, 1.0);
/// Of the animation.
const FRAMES: u32 = 10;
const FRAME_SIZE: [u32; 2] = [480, 270];
/// Frames a second.
const RATE: u16 = 7;
const EXPOSURE: f32 = 1.0;
/// Only where there is smoke, and everywhere.
const BARE: Effort = Effort { iterations: 5, laplacian: 2e-3, empty: false };
const SPREAD: Effort = Effort { iterations: 3, laplacian: 5e-3, empty: true };
/// Voxels that differ by so much from how they began were seen.
const SEEN: f32 = 0.02;

fn pose(azimuth: f32) -> Pose {
    Pose::around(Vec3::ZERO, [7.0, 0.3], azimuth, 20.0)
}

/// A puff that drifts from the left to the right and rolls, at a time from 0 to 1.
fn puff(time: f32) -> Volume {
    let middle = Vec3::new(-0.75 + 1.5 * time, -0.18 + 0.36 * time, 0.0);
    let value = |i: u32| {
        let voxel =
            Vec3::new((i % SIZE[0]) as f32, (i / SIZE[0] % SIZE[1]) as f32, (i / (SIZE[0] * SIZE[1])) as f32);
        let sides = Vec3::from(SIZE.map(|side| side as f32));
        let at = ((voxel + 0.5) / sides * 2.0 - 1.0) * HALF;
        let own = at - middle;
        // It rolls about the z axis as it goes, and boils.
        let turn = Vec2::from_angle(1.1 * time).rotate(Vec2::new(own.x, own.y));
        let place = Vec3::new(turn.x, turn.y - 0.5 * time, own.z + 0.3 * time);
        let warp = turbulence(61, 1.4 * place + 7.0, 3) - 0.5;
        let detail = fractal_noise(60, 2.6 * place + 0.7 * warp, 5);
        let round = 1.0 - (own / Vec3::new(1.02, 0.78, 0.75)).length();
        let dense = round + 1.5 * (detail - 0.52);
        let fade = ((Vec3::ONE - (at / HALF).abs()) / 0.06).min_element().clamp(0.0, 1.0);
        5.0 * (2.2 * dense).clamp(0.0, 1.0) * fade
    };
    let count = SIZE.iter().product::<u32>();
    let place = Mat4::from_translation(-HALF) * Mat4::from_scale(2.0 * HALF);
    Volume { size: SIZE, values: (0..count).map(value).collect(), world_from_unit: place }
}

/// What is painted onto the first and onto the last frame.
fn paint(easel: &Easel<'_>, last: bool, board: &Board) -> Result<Vec<Vec3>, CommandError> {
    let picture = easel.picture(&board.camera, &plain())?;
    let opacity: Vec<f32> = picture.through.iter().map(|through| 1.0 - through.element_sum() / 3.0).collect();
    let grade = if last {
        Grade { shade: Vec3::new(0.14, 0.10, 0.42), light: Vec3::new(0.72, 0.50, 1.08), ..Grade::default() }
    } else {
        Grade { shade: Vec3::new(0.45, 0.12, 0.25), light: Vec3::new(1.25, 0.55, 0.4), ..Grade::default() }
    };
    let graded = graded(&grade, board, &picture);
    let logo = |mark, middle| Logo { mark, middle, radius: 0.42, turn: 0.25, shade: 0.6 };
    let logo =
        if last { logo(Mark::Leaf, Vec2::new(0.58, 0.08)) } else { logo(Mark::Sun, Vec2::new(-0.60, -0.14)) };
    Ok(logo.paint(&graded, &opacity).canvas.pixels().to_vec())
}

fn plain() -> Paint {
    Paint::plain(0.85)
}

/// What was found where there is smoke that was seen, and everywhere else what is nearby: there a solver finds nothing but the Laplacian,
/// which takes many iterations to come from afar.
fn begun_with(easel: &Easel<'_>, found: &Paint) -> Paint {
    let plain = plain();
    let (albedo, emission) = (&found.albedo.values, &found.emission.values);
    let dense = easel.extinction.values.iter().map(|value| value.x > 0.0);
    let changed = albedo.iter().zip(emission).map(|(albedo, emission)| {
        (*albedo - plain.albedo.values[0]).abs().max(emission.abs()).max_element() > SEEN
    });
    let seen: Vec<bool> = dense.zip(changed).map(|(dense, changed)| dense && changed).collect();
    let [emission, albedo] = [&found.emission, &found.albedo].map(|field| extended(field, &seen));
    Paint { emission, albedo }
}

fn blended(from: &Paint, to: &Paint, part: f32) -> Paint {
    Paint {
        emission: from.emission.blended(&to.emission, part),
        albedo: from.albedo.blended(&to.albedo, part),
    }
}

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let sun = Vec3::new(-0.45, 0.75, 0.6).normalize();
    let sky = Sky {
        zenith: Vec3::new(0.04, 0.05, 0.07),
        horizon: Vec3::new(0.30, 0.32, 0.36),
        glow: Vec3::new(0.1, 0.09, 0.07),
        haze: 0.4,
    };
    let lights: Vec<Lighting> = daylight(&sky, (sun, 16.0 * Vec3::new(1.0, 0.95, 0.88)))?;
    let behind = |_: Vec3, way: Vec3| Vec3::new(0.085, 0.09, 0.10) * (1.0 - 1.4 * way.y).clamp(0.4, 1.6);
    let keys = [Easel::new(studio, &puff(0.0), &lights)?, Easel::new(studio, &puff(1.0), &lights)?];
    let sides = [0.0, 45.0];

    let begun = Instant::now();
    let mut found = Vec::new();
    for (last, easel) in [false, true].into_iter().zip(&keys) {
        let mut painted = Vec::new();
        for side in sides {
            let board = Board::new(&pose(side), solve_size(FRAME_SIZE, 240), behind)?;
            let target = if side == 0.0 { paint(easel, last, &board)? } else { tinted(easel, last, &board)? };
            painted.push((board, target));
        }
        let wishes: Vec<Wish<'_>> = painted
            .iter()
            .zip([1.0, 0.25])
            .map(|((board, picture), weight)| Wish { board, picture, weights: vec![weight; picture.len()] })
            .collect();
        let bare = easel.solve(Solved::Both, &plain(), &wishes, BARE)?;
        let spread = easel.solve(Solved::Both, &begun_with(easel, &bare), &wishes, SPREAD)?;
        found.push([bare, spread]);
    }
    let seconds = begun.elapsed().as_secs_f64();

    let about = "The first and the last frame of drifting smoke are painted and solved for; emission and albedo are blended in between, extinction moves on its own. Space that was empty or hidden begins with the colours nearby, which the Laplacian keeps smooth; without them smoke that comes there has none.";
    let mut album = Album::new(&studio.out, folder, "Smoke between two frames".to_owned(), about.to_owned())?;
    let smoke = |time: f32| keys[0].of(&puff(time), &lights);
    let frame = |easel: &Easel<'_>, time: f32, which: usize, size: [u32; 2]| {
        let board = Board::new(&pose(0.0), size, behind)?;
        let paint = blended(&found[0][which], &found[1][which], time);
        pixels(studio, &easel.shown(&board, &paint)?.0, size, EXPOSURE)
    };
    for (last, easel) in [false, true].into_iter().zip(&keys) {
        let board = Board::new(&pose(0.0), studio.size, behind)?;
        let (before, opacity) = easel.shown(&board, &plain())?;
        let wanted = pixels(studio, &paint(easel, last, &board)?, studio.size, EXPOSURE)?;
        let name = if last { "last" } else { "first" };
        let before = pixels(studio, &before, studio.size, EXPOSURE)?;
        album.add_tile(
            format!("{name}_original.png"),
            format!("Original, {name} frame"),
            studio.size,
            &before,
        )?;
        album.add_tile(
            format!("{name}_target.png"),
            format!("Target, {name} frame"),
            studio.size,
            &wanted,
        )?;
        let shown = frame(easel, if last { 1.0 } else { 0.0 }, 1, studio.size)?;
        album.fact(format!("{name} frame"), decibels(fidelity(&shown, &wanted, &opacity)));
    }
    let times = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0];
    let steps = times.map(&smoke).into_iter().collect::<Result<Vec<_>, _>>()?;
    for (which, name) in [(1, "diffused"), (0, "not diffused")] {
        for (step, (time, easel)) in times.into_iter().zip(&steps).enumerate() {
            let file = format!("{}_{step}.png", name.replace(' ', "_"));
            let shown = frame(easel, time, which, studio.size)?;
            album.add_tile(file, format!("Colours {name}, {time:.2}"), studio.size, &shown)?;
        }
    }
    let frames = (0..FRAMES).map(|i| {
        let time = i as f32 / (FRAMES - 1) as f32;
        frame(&smoke(time)?, time, 1, FRAME_SIZE)
    });
    let frames: Vec<Vec<u8>> = frames.collect::<Result<_, _>>()?;
    album.add_animation("animation.png", "Animated", FRAME_SIZE, &frames, RATE)?;
    album.fact("two frames, each with and without diffusion", format!("{seconds:.1} s"));
    album.finish_with_sheet(
        4,
        "Originals and targets of both frames; the blend with diffused colours, and without",
    )
}

/// What is wanted from aside: the tint alone.
fn tinted(easel: &Easel<'_>, last: bool, board: &Board) -> Result<Vec<Vec3>, CommandError> {
    let picture = easel.picture(&board.camera, &plain())?;
    let tint = if last { Vec3::new(0.60, 0.42, 0.98) } else { Vec3::new(1.05, 0.42, 0.35) };
    let pixels = picture.radiance.iter().zip(&picture.through).zip(&board.background);
    Ok(pixels.map(|((color, through), behind)| *color * tint + *through * *behind).collect())
}
