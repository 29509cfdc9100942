// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cascades, textures and a half-space blocker before a directional light, in the prefiltered method and in the march.

use crate::gpu::{self, gpu};
use crate::lit_case::*;
use airlight::core::Cascades;
use airlight::data::LightImage;
use airlight::scattering::{BasisFormat, Medium, Settings, Visibility, Weighting};
use airlight::{Buffer, Lighting, Texture};
use airlight_tests::error;
use airlight_tests::reference::scattering as reference;
use glam::{Vec2, Vec3};
use reference::Start;
use wgpu::TextureFormat::R32Float;

#[test]
fn one_cascade_is_the_single_map() {
    let mut plain = Case::new("sun", sun(), None, None);
    let mut cascades = Case::new("cascades", sun(), None, Some(Cascades::new(1)));
    // The same map and matrix, as an array of one. Its border is blocked, for light rays beyond it are not.
    let mut map = plain.stage.pictures.shadow_map.read(gpu()).unwrap();
    let side = SHADOW[0] as usize;
    for (i, depth) in map.iter_mut().enumerate() {
        if [i % side, i / side].iter().any(|at| *at == 0 || *at == side - 1) {
            *depth = 0.0;
        }
    }
    plain.stage.pictures.shadow_map = gpu::texture(SHADOW, R32Float, &map);
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING;
    let array = Texture::array(gpu(), [SHADOW[0], SHADOW[1], 1], R32Float, usage);
    array.write(gpu(), &map).unwrap();
    cascades.stage.pictures.shadow_maps = Some(array);
    let mut views = cascades.stage.views.unwrap();
    views.count = 1;
    views.clip_from_world[0] = plain.stage.light.clip_from_world;
    views.world_from_clip[0] = plain.stage.light.world_from_clip;
    cascades.stage.shadow_views = Some(Buffer::uniform(gpu(), &views));
    let settings = |case: &Case| Settings { format: BasisFormat::Rgba16Float, ..case.settings() };
    let (a, one) = prefiltered(&plain, settings(&plain));
    let (b, other) = prefiltered(&cascades, settings(&cascades));
    let [a, b] = [&a, &b].map(|method| method.rectification.rectified.read(gpu()).unwrap());
    let off = a.iter().zip(&b).filter(|(a, b)| (**a - **b).abs() > 1e-4).count();
    let difference = error::relative_rmse(&other.radiance, &one.radiance);
    println!("one cascade: {off} of {} texels off, radiance {:.3} %", a.len(), 100.0 * difference);
    assert!(off < a.len() / 500 && difference < 2e-3);
    let march = [&plain, &cascades].map(|case| marched(case, 512, Weighting::Transmittance));
    let difference = error::relative_rmse(&march[1].radiance, &march[0].radiance);
    println!("one cascade, marched: {:.3} %", 100.0 * difference);
    assert!(difference < 2e-3);
}

#[test]
fn cascades_show_what_the_single_map_shows() {
    let plain = Case::new("sun", sun(), None, None);
    let cascades = Case::new("cascades", sun(), None, Some(Cascades::new(3)));
    assert!(cascades.form.shadow_array && !cascades.form.local());
    let one = prefiltered(&plain, plain.settings()).1;
    let other = prefiltered(&cascades, cascades.settings()).1;
    let difference = error::relative_rmse(&other.radiance, &one.radiance);
    println!("three cascades: {:.2} % from one map", 100.0 * difference);
    assert!(difference < 0.03);
}

#[test]
fn a_texture_colours_a_directional_light() {
    let case = Case::new("sun, texture", sun(), Some(panes()), None);
    let plain = Case::new("sun", sun(), None, None);
    // White lets through what is there without it.
    let white = Case::new("sun, white", sun(), Some(LightImage::from_function([4, 4], |_| Vec3::ONE)), None);
    let one = prefiltered(&plain, plain.settings()).1;
    let other = prefiltered(&white, white.settings()).1;
    let difference = error::relative_rmse(&other.radiance, &one.radiance);
    println!("white texture: {:.2} %", 100.0 * difference);
    assert!(difference < 0.01);
    let exact = |case: &Case| {
        case.with_reference(|scene, maps| {
            let scene_of_sun = reference::Scene {
                camera: scene.camera,
                light: gpu::reference_light(&case.stage.light),
                medium: scene.medium,
                depth: scene.depth,
                width: scene.width,
                height: scene.height,
            };
            reference::shadow_views_picture(&scene_of_sun, maps, scene.texture.as_ref(), Start::Eye, STRIDE)
        })
    };
    let rank = Settings { visibility: Visibility::Rank { bits: 12 }, ..case.settings() };
    // In thin air nothing is left of what the rays of a row share, their weights.
    let mut thin = Case::new("sun, texture, thin air", sun(), Some(panes()), None);
    thin.stage.medium = Medium { extinction: 1e-4, ..thin.stage.medium };
    thin.stage.medium_buffer = Buffer::uniform(gpu(), &thin.stage.medium);
    let in_thin_air = exact(&thin);
    let [bases, ranks] =
        [thin.settings(), rank].map(|settings| relative_rmse(&prefiltered(&thin, settings).1, &in_thin_air));
    println!("sun, texture, thin air: bases {:.2} %, rank queries {:.2} %", 100.0 * bases, 100.0 * ranks);
    assert!(ranks < 0.6 * bases, "{ranks} {bases}");
    let six = Settings { visibility: Visibility::Moments, ..case.settings() };
    let moments = relative_rmse(&prefiltered(&thin, six).1, &in_thin_air);
    println!("sun, texture, thin air: moments {:.2} %", 100.0 * moments);
    assert!(moments < ranks + MOMENTS, "{moments} {ranks}");
    let exact = exact(&case);
    let error = relative_rmse(&prefiltered(&case, case.settings()).1, &exact);
    let ranked = relative_rmse(&prefiltered(&case, rank).1, &exact);
    let march = relative_rmse(&marched(&case, 256, Weighting::Transmittance), &exact);
    println!(
        "sun, texture: bases {:.2} %, rank queries {:.2} %, marched {:.2} %",
        100.0 * error,
        100.0 * ranked,
        100.0 * march
    );
    let moments = relative_rmse(&prefiltered(&case, six).1, &exact);
    println!("sun, texture: moments {:.2} %", 100.0 * moments);
    assert!(error < 0.05, "{error}");
    assert!(ranked < 0.05, "{ranked}");
    assert!(moments < ranked + MOMENTS, "{moments} {ranked}");
    assert!(march < 0.02, "{march}");
}

#[test]
fn a_half_space_blocker_leaves_the_other_half() {
    // A spot straight above that shines down; everything beyond the plane x = x of the light is blocked right there.
    let light = Lighting::Spot {
        position: Vec3::new(0.0, 6.0, 0.0),
        target: Vec3::ZERO,
        outer_degrees: 60.0,
        // A wide fall-off, so that what is lit and what is not differ in it.
        inner_degrees: 5.0,
        intensity: Vec3::splat(100.0),
        radius: 0.02,
    };
    let mut case = Case::new("half space", light, None, None);
    let size = 512_usize;
    let inverse = case.stage.light.world_from_clip;
    let texels: Vec<f32> = (0..size * size)
        .map(|i| {
            let ndc = Vec2::new((i % size) as f32 + 0.5, (i / size) as f32 + 0.5) * 2.0 / size as f32 - 1.0;
            let point = inverse.project_point3(Vec3::new(ndc.x, -ndc.y, 0.5));
            if point.x > 0.0 { 0.0 } else { 1.0 }
        })
        .collect();
    case.stage.pictures.shadow_map = gpu::texture([size as u32; 2], R32Float, &texels);
    let half = case.with_reference(|scene, maps| scene.truth(maps, Start::Eye, STRIDE));
    let found = prefiltered(&case, case.settings()).1;
    let error = relative_rmse(&found, &half);
    println!("half space: {:.2} %", 100.0 * error);
    assert!(error < 0.03, "{error}");
    let whole = case.empty();
    let whole = whole.with_reference(|scene, maps| scene.truth(maps, Start::Eye, STRIDE));
    let sum = |picture: &reference::Picture| picture.radiance().iter().sum::<f64>();
    assert!(sum(&half) < 0.8 * sum(&whole) && sum(&half) > 0.1 * sum(&whole));
}
