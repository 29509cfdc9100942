// SPDX-License-Identifier: MIT OR Apache-2.0
//! The sun in the picture, where rays cover next to nothing of their rows (thesis Fig. 4.9).

use super::album::{Album, Section};
use super::plates;
use super::studio::{AMPLIFIED, STEPS, Studio, parameters};
use crate::command::CommandError;
use crate::core::Camera;
use crate::scattering::{Prefiltered, RANK_BITS, Settings, Visibility};
use crate::{Stage, Texture};
use glam::{Vec2, Vec3};
use image::RgbaImage;
use image::imageops::{FilterType, crop_imm, resize};

/// Remedies side by side.
const COLUMNS: u32 = 5;
/// How much the surroundings of the sun are enlarged.
const ENLARGED: u32 = 4;

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let (scene, stage) = studio.scene("sun")?;
    let settings = studio.settings();
    let nothing = Settings { epipole_march: false, ..settings };
    let warp = Settings { depth_warp: true, ..nothing };
    let rank = Settings { visibility: Visibility::Rank { bits: RANK_BITS }, ..settings };
    let (reference, reference_time) = studio.march(&stage)?;
    let exact = reference.read(&studio.gpu)?;
    let mut entries = Vec::new();
    for (file, caption, settings) in [
        ("nothing", "Nothing done", nothing),
        ("warp", "Depth warp", warp),
        ("march", "Marched where rays cover fewer than 8 texels", settings),
        ("rank", "The same with rank queries", rank),
    ] {
        let (scattered, time) = evaluate(studio, &stage, settings)?;
        entries.push((file, format!("{caption}, {time:.0} ms"), scattered));
    }
    entries.push(("reference", format!("All marched, {STEPS} steps, {reference_time:.0} ms"), reference));

    let about = format!(
        "Scattered light around the epipole; the sun's surroundings enlarged {ENLARGED} times; differences to the \
         march, times {AMPLIFIED}. {}",
        parameters(&scene)
    );
    let mut album = Album::new(&studio.out, folder, scene.title.to_owned(), about)?;
    let mut rows: [Vec<(String, String, Vec<u8>)>; 3] = Default::default();
    for (file, caption, scattered) in &entries {
        let pixels = studio.pixels(scattered, scene.exposure)?;
        let difference = plates::difference(&studio.gpu, scattered, &exact, AMPLIFIED)?;
        let difference = studio.pixels(&difference, scene.exposure)?;
        let close =
            |pixels: &[u8]| enlarged(pixels, studio.size, epipole(&stage.camera, stage.light.direction));
        rows[1].push((format!("{file}_close.png"), "Enlarged".to_owned(), close(&pixels)));
        rows[2].push((format!("{file}_error.png"), "Its error, enlarged".to_owned(), close(&difference)));
        rows[0].push((format!("{file}.png"), caption.clone(), pixels));
    }
    for (file, caption, pixels) in rows.iter().flatten() {
        album.add_tile(file, caption, studio.size, pixels)?;
    }
    if let Some((.., scattered)) = entries.get(3) {
        let composed = studio.compose(&stage, scattered)?;
        album.add("final.png", "Final picture", studio.size, &studio.pixels(&composed, scene.exposure)?)?;
    }
    album.finish_with_sheet(
        COLUMNS,
        "Nothing done, depth warp, marched around the sun, with rank queries, all marched",
    )
}

/// Scattered light by the settings, and milliseconds from the shadow map on.
fn evaluate(studio: &Studio, stage: &Stage, settings: Settings) -> Result<(Texture, f64), CommandError> {
    let prefiltered = Prefiltered::new(&studio.gpu, &studio.shaders, settings, studio.size)?;
    let bound = prefiltered.bind(&studio.gpu, &stage.inputs())?;
    let time = studio.time(&|encoder| prefiltered.record(encoder, &bound))?;
    Ok((prefiltered.scattered, time))
}

/// Where a direction is in the picture: x right and y down, 0..1 inside.
fn epipole(camera: &Camera, towards: Vec3) -> Vec2 {
    let clip = camera.clip_from_world * towards.extend(0.0);
    let ndc = Vec2::new(clip.x, clip.y) / clip.w.max(1e-6);
    Vec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y)
}

/// A part of a picture around a place in it, at the size of the whole.
fn enlarged(pixels: &[u8], [width, height]: [u32; 2], place: Vec2) -> Vec<u8> {
    let Some(picture) = RgbaImage::from_raw(width, height, pixels.to_vec()) else { return pixels.to_vec() };
    let part = [(width / ENLARGED).max(1), (height / ENLARGED).max(1)];
    let corner = |place: f32, whole: u32, part: u32| {
        let first = (place * whole as f32 - 0.5 * part as f32).max(0.0) as u32;
        first.min(whole - part)
    };
    let [x, y] = [corner(place.x, width, part[0]), corner(place.y, height, part[1])];
    let part = crop_imm(&picture, x, y, part[0], part[1]).to_image();
    resize(&part, width, height, FilterType::Nearest).into_raw()
}
