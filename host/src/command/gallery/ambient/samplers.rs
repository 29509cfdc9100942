// SPDX-License-Identifier: MIT OR Apache-2.0
//! The samplers side by side: Fig. 3.7 of the thesis.

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::{BENT, Backdrop, Easel};
use crate::ambient::{BentForm, Method, OcclusionSettings, Sampling};
use crate::command::CommandError;
use crate::scenes::AmbientScene;

/// What is compared.
const SAMPLERS: [(Sampling, &str, &str); 4] = [
    (Sampling::Disc, "disc", "Disc (Crytek 2D)"),
    (Sampling::Hemisphere, "hemisphere", "Hemisphere, marched (Crytek 3D)"),
    (Sampling::Horizon, "horizon", "Horizons (HBAO)"),
    (Sampling::Bitmask, "bitmask", "Visibility bit masks"),
];

/// The section.
pub fn section(studio: &Studio, folder: &str, scene: AmbientScene) -> Result<Section, CommandError> {
    let easel = Easel::new(studio, scene)?;
    let title = "Four samplers".to_owned();
    let about =
        "Bent cones by each sampler, and openness below: 8 directions or slices of 3 steps, 1 m.".to_owned();
    let mut album = Album::new(&studio.out, folder, title, about)?;
    let ground = easel.ground()?;
    let backdrop = Backdrop::new(studio, "forest")?;
    // Near occluders, of which samplers make different things.
    let settings = OcclusionSettings { thickness: 0.5, ..OcclusionSettings::new(1.0) };
    let mut open = Vec::new();
    for (sampling, file, name) in SAMPLERS {
        let bent = ground.bent(BentForm { sampling, ..BENT }, &settings)?;
        let found = ground.seen(&bent, Some((&backdrop.cones, Method::Cones, true)))?;
        album.add_tile(format!("{file}.png"), name, studio.size, &easel.lit(&found, &backdrop)?)?;
        open.push(easel.numbers(&found, |seen| [seen.open; 3]));
    }
    for ((_, file, name), pixels) in SAMPLERS.into_iter().zip(open) {
        let caption = format!("{name}: openness");
        album.add_tile(format!("{file}_open.png"), caption, studio.size, &pixels)?;
    }
    album.finish_with_sheet(4, "Disc, hemisphere, horizons, bit masks; openness below")
}
