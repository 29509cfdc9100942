// SPDX-License-Identifier: MIT OR Apache-2.0
//! Occlusion, bent normals and bent cones beside rays under both maps: Fig. 3.8 and 3.10 of the thesis.

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::{BENT, Backdrop, Easel, error};
use crate::ambient::{ConeLight, ConeLightForm, Method};
use crate::command::CommandError;
use crate::scenes::AmbientScene;

/// The program's maps.
const MAPS: [&str; 2] = ["forest", "sunset"];
/// What is compared.
const METHODS: [(Method, &str, &str); 3] = [
    (Method::Occlusion, "ao", "Occlusion alone"),
    (Method::Normals, "normals", "Bent normals"),
    (Method::Cones, "cones", "Bent cones"),
];

/// The section of a scene.
pub fn section(studio: &Studio, folder: &str, scene: AmbientScene) -> Result<Section, CommandError> {
    let easel = Easel::new(studio, scene)?;
    let settings = easel.settings();
    let title = format!("The {} under two skies", easel.scene.name);
    let about = format!(
        "{} triangles; occluders count up to {} m and are {} m thick; {} directions of {} steps; brightness as \
         printed; light of maps of 32x16 texels. Errors: RMS of the RMS of traced radiance.",
        easel.scene.mesh.triangle_count(),
        settings.radius,
        settings.thickness,
        settings.samples,
        settings.steps
    );
    let mut album = Album::new(&studio.out, folder, title, about)?;
    let ground = easel.ground()?;
    let bent = ground.bent(BENT, &settings)?;
    let backdrops = [Backdrop::new(studio, MAPS[0])?, Backdrop::new(studio, MAPS[1])?];
    let [a, b] = &backdrops;
    let [a, b, whole_a, whole_b] = easel.traced([&a.low_passed, &b.low_passed, &a.map, &b.map]);
    for ((map, backdrop), [truth, whole]) in
        MAPS.into_iter().zip(&backdrops).zip([[a, whole_a], [b, whole_b]])
    {
        let cones = ConeLight::new(&studio.gpu, &studio.shaders, &backdrop.map, ConeLightForm::default())?;
        for (method, file, name) in METHODS {
            let [exact, found] =
                [false, true].map(|printed| ground.seen(&bent, Some((&backdrop.cones, method, printed))));
            let (exact, found) = (error(&exact?, &truth), found?);
            let caption = format!("{name}, {map}");
            album.fact(&*caption, format!("error {:.4}", error(&found, &truth)));
            if method != Method::Occlusion {
                album.fact(format!("{caption}, exact share of even light"), format!("error {exact:.4}"));
            }
            let found_whole = ground.seen(&bent, Some((&cones, method, true)))?;
            let caption_whole = format!("{caption}, whole map");
            album.fact(caption_whole, format!("error {:.4}", error(&found_whole, &whole)));
            album.add_tile(
                format!("{file}_{map}.png"),
                caption,
                studio.size,
                &easel.lit(&found, backdrop)?,
            )?;
        }
        let caption = format!("Traced, {map}");
        album.add_tile(
            format!("reference_{map}.png"),
            caption,
            studio.size,
            &easel.lit(&truth, backdrop)?,
        )?;
    }
    album.finish_with_sheet(
        4,
        "Occlusion, bent normals, bent cones, rays; above in the forest, below at sunset",
    )
}
