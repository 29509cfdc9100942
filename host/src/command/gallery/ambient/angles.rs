// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bent normals of the screen against traced ones: Fig. 3.9 of the thesis.

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::{BENT, Easel};
use crate::ambient::OcclusionSettings;
use crate::command::CommandError;
use crate::command::ambient::shown::Seen;
use crate::scenes::AmbientScene;

/// What angles are multiplied by before they are shown.
const AMPLIFIED: f32 = 8.0;

/// The section.
pub fn section(studio: &Studio, folder: &str, scene: AmbientScene) -> Result<Section, CommandError> {
    let easel = Easel::new(studio, scene)?;
    let settings = OcclusionSettings { thickness: 0.5, ..OcclusionSettings::new(1.0) };
    let about = format!(
        "Bent normals of occluders up to {} m, x, y and z from -1 to 1 in red, green and blue, by rays and on the screen, \
         and the angle between, times {AMPLIFIED}: white is {} degrees and more.",
        settings.radius,
        90.0 / AMPLIFIED
    );
    let title = "Bent normals of the screen and of rays".to_owned();
    let mut album = Album::new(&studio.out, folder, title, about)?;
    let ground = easel.ground()?;
    let found = ground.seen(&ground.bent(BENT, &settings)?, None)?;
    let traced = easel.traced_within(settings.radius);
    let colour = |seen: &Seen| (seen.mean.normalize_or_zero() * 0.5 + 0.5).to_array();
    album.add_tile("traced.png", "Traced", studio.size, &easel.numbers(&traced, colour))?;
    album.add_tile("screen.png", "On the screen", studio.size, &easel.numbers(&found, colour))?;
    let apart: Vec<Option<f32>> = found
        .iter()
        .zip(&traced)
        .map(|(found, traced)| {
            found.zip(*traced).map(|(found, traced)| found.mean.angle_between(traced.mean).to_degrees())
        })
        .map(|angle| angle.filter(|angle| angle.is_finite()))
        .collect();
    let shade = |angle: &Option<f32>| {
        let byte = (angle.unwrap_or(0.0) * AMPLIFIED / 90.0 * 255.0).min(255.0) as u8;
        [byte, byte, byte, 255]
    };
    let pixels: Vec<u8> = apart.iter().flat_map(shade).collect();
    album.add_tile("apart.png", format!("Angle between, times {AMPLIFIED}"), studio.size, &pixels)?;
    let mut angles: Vec<f32> = apart.into_iter().flatten().collect();
    angles.sort_by(f32::total_cmp);
    let mean = angles.iter().sum::<f32>() / angles.len().max(1) as f32;
    album.fact("mean angle", format!("{mean:.2} degrees"));
    for part in [50, 90, 99] {
        let angle = angles.get(angles.len() * part / 100).copied().unwrap_or(0.0);
        album.fact(format!("{part} % of pixels below"), format!("{angle:.2} degrees"));
    }
    album.finish_with_sheet(3, "Traced, on the screen, angle between")
}
