// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light that is found for a cloud from painted views, and then a volume in it (thesis Fig. 7.9 to 7.11).

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::{
    Board, COLUMNS, Easel, Effort, Paint, Pose, RGB, Wish, clear_sky, daylight, decibels, fidelity, graded,
    pixels, solve_size,
};
use crate::command::CommandError;
use crate::command::inverse::field::{Field, colours, numbers};
use crate::command::inverse::paint::Grade;
use crate::data::{DiscLights, Environment, cloud, disc_lights};
use crate::inverse::{
    LightMaps, LightPasses, LightSolver, LightStrategy, LightUnknown, Medium, Projector, ProjectorForm,
    Solved, Target, radiance_targets,
};
use crate::{Lighting, Texture};
use glam::{Vec2, Vec3};
use std::sync::Arc;
use std::time::Instant;

const EXPOSURE: f32 = 1.0;
/// Painted from so many sides.
const SIDES: u16 = 6;
/// Discs that light comes from.
const DISCS: u32 = 64;
/// Columns and rows of the maps that are shown.
const MAP: [u32; 2] = [1280, 640];
/// Directional lights that stand for a disc.
const LIGHTS_A_DISC: u32 = 3;
/// Directional lights that stand for the evening that is painted.
const EVENING_LIGHTS: u32 = 48;
/// Degrees of a view that was not painted.
const BETWEEN: f32 = 30.0;
const ALBEDO: f32 = 0.9;
const EFFORT: Effort = Effort { iterations: 5, laplacian: 3e-3, empty: false };
/// Of the light.
const ITERATIONS: u32 = 30;

fn pose(azimuth: f32) -> Pose {
    Pose::around(Vec3::ZERO, [8.0, 1.4], azimuth, 27.0)
}

/// Radiance of an evening, as somebody would paint it: a low sun on one side, a cold moon on the other, violet above.
fn evening(way: Vec3) -> Vec3 {
    if way.y <= 0.0 {
        return Vec3::ZERO;
    }
    let lobe = |azimuth: f32, up: f32, power: i32| {
        let (sine, cosine) = azimuth.to_radians().sin_cos();
        way.dot(Vec3::new(sine, up, cosine).normalize()).max(0.0).powi(power)
    };
    let sky = Vec3::new(0.22, 0.12, 0.16).lerp(Vec3::new(0.16, 0.12, 0.42), way.y);
    sky + lobe(-32.0, 0.45, 12) * Vec3::new(19.0, 7.2, 2.2) + lobe(150.0, 0.7, 8) * Vec3::new(0.5, 2.8, 4.6)
}

/// What no light does: more contrast, deeper and colder shades.
fn grade() -> Grade {
    Grade {
        contrast: 1.2,
        middle: 0.5,
        saturation: 1.1,
        shade: Vec3::new(0.75, 0.8, 1.1),
        ..Grade::default()
    }
}

/// Lights that were found.
struct Found {
    discs: DiscLights,
    coefficients: Vec<Vec3>,
    scattered: Field,
}

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let sun = Vec3::new(-0.35, 0.75, 0.5).normalize();
    let sky = clear_sky();
    let power = 12.0 * Vec3::new(1.0, 0.94, 0.85);
    let volume = cloud([64, 32, 53], 9);
    let easel = Easel::new(studio, &volume, &daylight(&sky, (sun, power))?)?;
    let behind = |_: Vec3, way: Vec3| {
        Vec3::new(0.10, 0.115, 0.14).lerp(Vec3::new(0.022, 0.028, 0.042), 0.5 + 1.6 * way.y.clamp(-0.3, 0.3))
    };
    let plain = Paint::plain(ALBEDO);
    let azimuths: Vec<f32> = (0..SIDES).map(|side| 360.0 * f32::from(side) / f32::from(SIDES)).collect();
    let [known, painted_map] = [[128, 64], MAP].map(|size| Environment::from_function(size, evening));
    let (known, painted_map) =
        (known.map_err(CommandError::failure)?, painted_map.map_err(CommandError::failure)?);
    let lamps: Vec<Lighting> =
        known.sample_lights(EVENING_LIGHTS, 7).into_iter().map(Lighting::from).collect();
    let model = easel.of(&volume, &lamps)?;
    let mut painted: Vec<(Board, Vec<Vec3>)> = Vec::new();
    for azimuth in &azimuths {
        let board = Board::new(&pose(*azimuth), solve_size(studio.size, COLUMNS), behind)?;
        let target = paint(&model, &board, &plain)?;
        painted.push((board, target));
    }
    let wishes: Vec<Wish<'_>> = painted.iter().map(|(board, picture)| Wish::even(board, picture)).collect();
    let begun = Instant::now();
    // Light varies slowly, and small pictures say enough of it.
    let mut coarse: Vec<(Board, Vec<Vec3>)> = Vec::new();
    for azimuth in &azimuths {
        let board = Board::new(&pose(*azimuth), solve_size(studio.size, 160), behind)?;
        let target = paint(&model, &board, &plain)?;
        coarse.push((board, target));
    }
    let few: Vec<Wish<'_>> = coarse.iter().map(|(board, picture)| Wish::even(board, picture)).collect();
    let found = light(&easel, &few)?;
    let seconds = begun.elapsed().as_secs_f64();
    let relit = easel.relit(&found.scattered)?;
    let begun = Instant::now();
    let changed = relit.solve(Solved::Both, &plain, &wishes, EFFORT)?;
    let then = begun.elapsed().as_secs_f64();

    let about = format!(
        "Six views of a cloud at noon are repainted as of an evening: a low sun on one side, a cold moon on the other, and more contrast and deeper shades than any light makes. {DISCS} discs of light on the upper hemisphere are solved for, and then emission and albedo in that light, which adds the contrast that light alone cannot, for it reaches the whole volume."
    );
    let mut album = Album::new(&studio.out, folder, "Light for a cloud, then its volume".to_owned(), about)?;
    let show = |radiance: &[Vec3]| pixels(studio, radiance, studio.size, EXPOSURE);
    let mut facts = Vec::new();
    for azimuth in [0.0, 60.0, 180.0] {
        let board = Board::new(&pose(azimuth), studio.size, behind)?;
        let (before, opacity) = easel.shown(&board, &plain)?;
        let wanted = show(&paint(&model, &board, &plain)?)?;
        let [lit, both] = [&plain, &changed].map(|paint| relit.shown(&board, paint));
        let (lit, both) = (show(&lit?.0)?, show(&both?.0)?);
        for (name, caption, shown) in [
            ("original", "Original", &show(&before)?),
            ("target", "Target", &wanted),
            ("light", "Light", &lit),
            ("volume", "Light, then volume", &both),
        ] {
            let file = format!("{azimuth}_{name}.png");
            album.add_tile(file, format!("{caption}, from {azimuth}°"), studio.size, shown)?;
        }
        let value = |shown: &[u8]| decibels(fidelity(shown, &wanted, &opacity));
        facts.push((format!("light, from {azimuth}°"), value(&lit)));
        facts.push((format!("light, then volume, from {azimuth}°"), value(&both)));
    }
    let map = found.discs.environment_of(&found.coefficients, MAP).map_err(CommandError::failure)?;
    let radiance = hemispheres([&painted_map, &map], studio.size);
    album.add_tile(
        "lights.png",
        "Upper hemispheres: the light that was painted, and below it the light that was found",
        studio.size,
        &show(&radiance)?,
    )?;
    let board = Board::new(&pose(BETWEEN), studio.size, behind)?;
    for (name, caption, seen) in [
        ("original", "original", easel.shown(&board, &plain)),
        ("light", "light", relit.shown(&board, &plain)),
        ("light_volume", "light, then volume", relit.shown(&board, &changed)),
    ] {
        let file = format!("{BETWEEN}_between_{name}.png");
        album.add_tile(
            file,
            format!("In between, from {BETWEEN}°: {caption}"),
            studio.size,
            &show(&seen?.0)?,
        )?;
    }
    facts.into_iter().for_each(|(what, value)| album.fact(what, value));
    album.fact(format!("{DISCS} lights from six views"), format!("{seconds:.1} s"));
    album.fact("emission and albedo in them", format!("{then:.1} s"));
    album.finish_with_sheet(
        4,
        "From three of six sides: original, target, light, light then volume; below, the lights that were painted and found (latitude and longitude), and the same from in between",
    )
}

/// Upper halves of two maps, one above the other, their longitudes across. Bright light keeps its hue.
fn hemispheres(maps: [&Environment; 2], [width, height]: [u32; 2]) -> Vec<Vec3> {
    let half = height.div_ceil(2);
    let gap = height / 180;
    let radiance = |i: u32| {
        let (x, y) = (i % width, i / width);
        let row = y % half;
        if row + gap >= half {
            return Vec3::ZERO;
        }
        let map = maps[usize::from(y >= half)];
        let [columns, rows] = map.size().map(|side| side as f32);
        let part = Vec2::new((x as f32 + 0.5) / width as f32, 0.5 * (row as f32 + 0.5) / half as f32);
        let color = map.radiance(map.direction(part * Vec2::new(columns, rows)));
        color * (0.8 / (0.8 + color.element_sum() / 3.0))
    };
    (0..width * height).map(radiance).collect()
}

/// The target of a view.
fn paint(easel: &Easel<'_>, board: &Board, plain: &Paint) -> Result<Vec<Vec3>, CommandError> {
    let picture = easel.picture(&board.camera, plain)?;
    Ok(graded(&grade(), board, &picture).pixels().to_vec())
}

/// Solves for the light.
fn light(easel: &Easel<'_>, wishes: &[Wish<'_>]) -> Result<Found, CommandError> {
    let (gpu, shaders) = (&easel.studio.gpu, &easel.studio.shaders);
    let discs = disc_lights(DISCS, true);
    let groups: Vec<Vec<Lighting>> = (0..DISCS as usize)
        .map(|disc| discs.lights(disc, LIGHTS_A_DISC).into_iter().map(Lighting::from).collect())
        .collect();
    let maps = LightMaps { texels: 48, layers: 48, shadow_texels: 4 };
    let lighting = LightPasses::new(gpu, shaders, RGB)?.with_maps(maps)?;
    let size = easel.extinction.size.map(|side| side.div_ceil(2));
    let extinction = &easel.medium.extinction;
    let volumes = lighting.scattered_each(gpu, extinction, easel.place, size, &groups, None)?;
    let all: Vec<Vec<f32>> = volumes.iter().map(|volume| volume.read(gpu)).collect::<Result<_, _>>()?;

    let projector = Projector::new(gpu, shaders, ProjectorForm::new(Solved::Albedo, RGB))?;
    let albedo = || Field::constant(Vec3::splat(ALBEDO)).texture(gpu, RGB);
    let texture: Texture = easel.extinction.texture(gpu, RGB)?;
    let medium = Arc::new(Medium { extinction: texture, scattered: albedo()?, index: None });
    let mut targets = Vec::with_capacity(wishes.len());
    for wish in wishes {
        let picture = easel.picture(&wish.board.camera, &Paint::plain(0.0))?;
        let [wanted, background, through, nothing] =
            [wish.picture, &wish.board.background, &picture.through, &picture.radiance]
                .map(|of| numbers(of, RGB));
        targets.push(Target {
            view: projector.view(gpu, &easel.rays(&wish.board.camera)?, None)?,
            medium: Arc::clone(&medium),
            wanted: radiance_targets(&wanted, &background, &through, &nothing)?,
            weights: wish.weights.clone(),
        });
    }
    let start = vec![0.2; 4 * DISCS as usize];
    let unknown = LightUnknown { volumes, start, smallness: 0.005, strategy: LightStrategy::Columns };
    let mut solver = LightSolver::new(gpu, shaders, projector, targets, unknown)?;
    for _ in 0..ITERATIONS {
        solver.iterate(gpu)?;
    }
    let coefficients = colours(&solver.coefficients(gpu)?, RGB);
    let mut sum = vec![Vec3::ZERO; size.iter().map(|side| *side as usize).product()];
    for (volume, coefficient) in all.iter().zip(&coefficients) {
        for (sum, own) in sum.iter_mut().zip(volume.chunks_exact(4)) {
            *sum += *coefficient * Vec3::from_slice(own);
        }
    }
    Ok(Found { discs, coefficients, scattered: Field { size, values: sum } })
}
