// SPDX-License-Identifier: MIT OR Apache-2.0
//! Importance sampling of the map, light looked up along each direction, and bent cones: Fig. 3.11 of the thesis.

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::{BENT, Backdrop, Easel, error};
use crate::ambient::{Method, OcclusionSettings, environment_texture};
use crate::command::CommandError;
use crate::command::bench::baselines::with_baselines;
use crate::command::bench::ssdo::{Spread, Ssdo, lights_buffer};
use crate::pass::Resource;
use crate::scenes::AmbientScene;

/// The section.
pub fn section(studio: &Studio, folder: &str, scene: AmbientScene) -> Result<Section, CommandError> {
    let easel = Easel::new(studio, scene)?;
    let title = "Bent cones beside light that is looked up".to_owned();
    let about = "Directions drawn from the map by its brightness, directions spread with the cosine whose light is looked up, and bent \
                 cones: the same march of 3 steps, pattern of 8x8 pixels and blur. Errors: RMS of the RMS of traced radiance."
        .to_owned();
    let mut album = Album::new(&studio.out, folder, title, about)?;
    let gpu = &studio.gpu;
    let ground = easel.ground()?;
    let backdrop = Backdrop::new(studio, "forest")?;
    let [truth] = easel.traced([&backdrop.low_passed]);
    let of = |samples| OcclusionSettings { samples, ..easel.settings() };
    let shaders = with_baselines(&studio.shaders);
    let map = environment_texture(gpu, &backdrop.low_passed)?;
    let lights = lights_buffer(gpu, &backdrop.low_passed, &of(32));
    let looked_up: [(Spread, u32, Resource<'_>, &str, &str); 2] = [
        (
            Spread::Lights,
            32,
            (&lights).into(),
            "importance.png",
            "Importance sampling of the map, 32 directions",
        ),
        (Spread::Cosine, 16, (&map).into(), "ssdo.png", "Directional occlusion, 16 directions"),
    ];
    let mut pictures = Vec::new();
    for (spread, samples, environment, file, caption) in looked_up {
        let ssdo = Ssdo::new(gpu, &shaders, spread)?;
        let albedos = &ground.geometry.albedos;
        let mut encoder = gpu.encoder();
        let picture = ssdo.record(gpu, &mut encoder, ground.images(), &of(samples), albedos, environment)?;
        gpu.submit(encoder)?;
        let texels = picture.read(gpu)?;
        let found = truth.iter().zip(texels.chunks_exact(4)).map(|(seen, texel)| {
            seen.filter(|_| texel[3] == 1.0).map(|mut seen| {
                seen.radiance = glam::Vec3::from_slice(texel);
                seen
            })
        });
        pictures.push((found.collect(), file, caption));
    }
    let bent = ground.bent(BENT, &of(8))?;
    let cones = ground.seen(&bent, Some((&backdrop.cones, Method::Cones, false)))?;
    pictures.push((cones, "cones.png", "Bent cones, 8 directions"));
    for (found, file, caption) in pictures {
        album.fact(caption, format!("error {:.4}", error(&found, &truth)));
        album.add_tile(file, caption, studio.size, &easel.lit(&found, &backdrop)?)?;
    }
    album.add_tile("reference.png", "Traced", studio.size, &easel.lit(&truth, &backdrop)?)?;
    album.finish_with_sheet(2, "Importance sampling and directional occlusion; bent cones and rays")
}
