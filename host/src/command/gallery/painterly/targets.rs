// SPDX-License-Identifier: MIT OR Apache-2.0
//! What rays write of a surface, and what is made of its curvatures, one by one.

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::target_pictures as pictures;
use super::{Easel, Motif};
use crate::command::CommandError;
use crate::painterly::{
    Advect, CurvatureTable, IsoForm, PainterlyError, RidgeParameters, Ridges, Shade, StreakParameters,
};
use glam::Vec3;

/// Degrees that the surface has turned since the frame before.
const TURN: f32 = 3.0;

/// The section.
pub fn section(studio: &Studio, folder: &str, motif: &'static Motif) -> Result<Section, CommandError> {
    let easel = Easel::new(studio, motif)?;
    let about = format!(
        "Light is put on afterwards. Normals: x red, y green, z blue. Gradient magnitude and distance: from dark to bright. Flow for a turn \
         of {TURN} degrees: hue for its direction, the stronger the faster. Curvature: the stronger of the two, orange where convex, \
         blue where concave, at most {} 1/m. Streaks run along it.",
        motif.curvature
    );
    let mut album = Album::new(&studio.out, folder, format!("{}: what rays write", motif.name), about)?;
    let Studio { gpu, shaders, .. } = studio;
    let rays = easel.cast(IsoForm { deferred: true, curvature: true, ..Default::default() }, TURN)?;
    let targets = &rays.targets;
    let curvature =
        targets.curvature.as_ref().ok_or_else(|| CommandError::failure(PainterlyError::NoCurvature))?;

    let shade = Shade::new(gpu, shaders).map_err(CommandError::failure)?;
    let advect = Advect::new(gpu, shaders).map_err(CommandError::failure)?;
    let ridges = Ridges::new(gpu, shaders).map_err(CommandError::failure)?;
    let lit = shade.bind(gpu, &rays).map_err(CommandError::failure)?;
    let along = StreakParameters { steps: 14, ..StreakParameters::default() };
    let streaks = advect.bind(gpu, curvature, &along).map_err(CommandError::failure)?;
    let (ridge, valley) = (Vec3::new(0.95, 0.62, 0.22), Vec3::new(0.05, 0.10, 0.30));
    let table = CurvatureTable::of_ridges_and_valleys(gpu, ridge, valley).map_err(CommandError::failure)?;
    let parameters = RidgeParameters::new(0.6 * motif.curvature, 0.35).map_err(CommandError::failure)?;
    let tinted = ridges
        .bind(gpu, &rays, &table, Some(&streaks.streaks), &parameters)
        .map_err(CommandError::failure)?;
    let tinted_lit = shade.bind_color(gpu, &rays, &tinted.tinted).map_err(CommandError::failure)?;
    let mut encoder = gpu.encoder();
    shade.record(&mut encoder, &lit);
    advect.record(&mut encoder, &streaks);
    ridges.record(&mut encoder, &tinted);
    shade.record(&mut encoder, &tinted_lit);
    gpu.submit(encoder)?;

    let distance = targets.distance.read(gpu)?;
    let surface = targets.surface.read(gpu)?;
    let bent = curvature.read(gpu)?;
    let seen = |color: &dyn Fn(usize) -> Vec3| pictures::of_seen(&distance, color);
    let magnitude = pictures::ramp_over(surface.chunks_exact(4).map(|texel| texel[3]), &distance);
    let depth = pictures::ramp_over(distance.iter().map(|distance| -distance), &distance);
    let flow = targets.flow.read(gpu)?;
    let fastest = pictures::fastest(&flow);
    let streaks = streaks.streaks.read(gpu)?;
    for (file, caption, pixels) in [
        ("color", "Colour, unlit", easel.on_canvas(&targets.color)?),
        ("lit", "The same, lit", easel.on_canvas(&lit.picture)?),
        ("normals", "Normals", seen(&|i| pictures::normal(&surface[4 * i..]))),
        ("gradient_magnitude", "Gradient magnitude", seen(&|i| magnitude(surface[4 * i + 3]))),
        ("flow", "Flow", seen(&|i| pictures::flow(&flow[2 * i..], fastest))),
        ("distance", "Distance", seen(&|i| depth(-distance[i]))),
        ("curvature", "Curvature", seen(&|i| pictures::curvature(&bent[4 * i..], motif.curvature))),
        ("streaks", "Streaks along curvature", seen(&|i| Vec3::splat(0.08 + 0.9 * streaks[i]))),
        ("ridges", "Ridges and valleys, with streaks", easel.on_canvas(&tinted_lit.picture)?),
    ] {
        album.add_tile(format!("{file}.png"), caption, studio.size, &pixels)?;
    }
    album.fact("Fastest flow", format!("{fastest:.1} pixels"));
    album.finish_with_sheet(
        3,
        "Colour, the same lit, normals; gradient magnitude, flow, distance; curvature, streaks, ridges",
    )
}
