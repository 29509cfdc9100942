// SPDX-License-Identifier: MIT OR Apache-2.0
//! Any camera, any light and any depths: no NaN, nothing out of range.

use crate::gpu::{self, Random, gpu, shaders};
use airlight::core::Light;
use airlight::scattering::{
    BasisFormat, Inputs, LightForm, March, Medium, Prefiltered, Settings, Visibility, Weighting,
};
use airlight::{Buffer, Texture};
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use glam::Vec3;
use wgpu::TextureFormat::R32Float;

fn wild_depths(random: &mut Random, count: usize) -> Vec<f32> {
    let kind = random.below(3);
    (0..count)
        .map(|_| match (kind, random.below(8)) {
            (0, _) => random.unit() as f32,
            (1, 0..4) => random.unit() as f32,
            (_, 0) => f32::NAN,
            (_, 1) => f32::INFINITY,
            (_, 2) => -1.0,
            (_, 3) => 1e30,
            (_, 4) => f32::from_bits(random.bits()),
            (_, 5) => 0.0,
            _ => 1.0,
        })
        .collect()
}

/// A light that may be anywhere: next to the eye, in the picture, behind it, far away; and what it was made with.
fn wild_light(random: &mut Random, camera: &ReferenceCamera, point: bool) -> Light {
    let direction = gpu::host_vector(random.light(camera));
    let eye = gpu::host_vector(camera.eye);
    let distance = match random.below(4) {
        0 => 1e-6,
        1 => random.magnitude(1e-5, 1e-2) as f32,
        2 => random.magnitude(1e-2, 1e2) as f32,
        _ => random.magnitude(1e2, 1e5) as f32,
    };
    let position = eye + direction * distance;
    let near = random.magnitude(1e-3, 1.0) as f32;
    let far = near * random.magnitude(1.1, 1e5) as f32;
    let radius = random.magnitude(1e-6, 10.0) as f32;
    let bright = Vec3::new(random.magnitude(1e-3, 1e6) as f32, 1.0, 0.0);
    if point {
        return Light::point(position, bright, radius, near, far).unwrap();
    }
    // Towards the eye, away from it, past it, or anywhere.
    let away = gpu::host_vector(random.direction());
    let axis = match random.below(3) {
        0 => -direction + 0.3 * away,
        1 => direction + 0.3 * away,
        _ => away,
    };
    let outer = random.between(0.5, 80.0) as f32;
    let inner = if random.unit() < 0.2 { outer } else { outer * random.unit() as f32 };
    Light::spot(position, position + axis * 10.0, outer, inner, bright, radius, near, far).unwrap_or_else(
        |_| Light::spot(Vec3::ZERO, Vec3::X, outer, inner, bright, radius, near, far).unwrap(),
    )
}

#[test]
fn no_camera_light_or_input_gives_nan_or_a_value_out_of_range() {
    const COUNT: usize = 540;
    const PICTURE: [u32; 2] = [16, 8];
    const MAP: [u32; 2] = [16, 8];
    let mut random = Random(4048);
    let base = [
        LightForm { spot: true, ..LightForm::default() },
        LightForm { spot: true, texture: true, ..LightForm::default() },
        LightForm { point: true, shadow_array: true, ..LightForm::default() },
        LightForm { shadow_array: true, ..LightForm::default() },
        LightForm { texture: true, ..LightForm::default() },
        LightForm { shadow_array: true, texture: true, ..LightForm::default() },
    ];
    let camera = random.camera(2.0);
    let camera_buffer = Buffer::uniform(gpu(), &gpu::host_camera(&camera, PICTURE));
    let light_buffer = Buffer::uniform(gpu(), &wild_light(&mut random, &camera, false));
    let medium_buffer = Buffer::uniform(gpu(), &Medium::new(0.1, Vec3::ONE, 0.0, 10.0).unwrap());
    let cube = airlight::core::ShadowViews::cube(Vec3::ZERO, 0.1, 10.0).unwrap();
    let views_buffer = Buffer::uniform(gpu(), &cube);
    let depth = gpu::texture(PICTURE, R32Float, &[1.0; 128]);
    let shadow_map = gpu::texture([8, 8], R32Float, &[1.0; 64]);
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING;
    let shadow_maps = Texture::array(gpu(), [8, 8, 6], R32Float, usage);
    let color =
        Texture::new(gpu(), [4, 4], wgpu::TextureFormat::Rgba16Float, wgpu::TextureUsages::TEXTURE_BINDING);
    let inputs = Inputs {
        camera: &camera_buffer,
        light: &light_buffer,
        medium: &medium_buffer,
        depth: &depth,
        shadow_map: &shadow_map,
        shadow_views: Some(&views_buffer),
        shadow_maps: Some(&shadow_maps),
        light_texture: Some(&color),
    };
    let methods: Vec<_> = base
        .iter()
        .flat_map(|form| {
            let rank = Visibility::Rank { bits: 8 };
            [
                (Weighting::Average, true, Visibility::Fourier),
                (Weighting::Transmittance, false, Visibility::Fourier),
                (Weighting::Average, false, rank),
                (Weighting::Transmittance, true, rank),
                (Weighting::Average, true, Visibility::Moments),
                (Weighting::Transmittance, false, Visibility::Moments),
            ]
            .map(|(weighting, epipole_march, visibility)| {
                let settings = Settings {
                    bases: 8,
                    map: MAP,
                    format: BasisFormat::Rgba16Float,
                    weighting,
                    epipole_march,
                    visibility,
                    light: *form,
                    ..Settings::default()
                };
                let method = Prefiltered::new(gpu(), shaders(), settings, PICTURE).unwrap();
                let bound = method.bind(gpu(), &inputs).unwrap();
                let march = March::of_light(gpu(), shaders(), *form, 24, weighting, PICTURE).unwrap();
                let along = airlight::scattering::Along::ShadowMap { steps: 24 };
                let march_bound = march.bind(gpu(), &inputs, &along).unwrap();
                (*form, method, bound, march, march_bound)
            })
        })
        .collect();
    let mut bright = 0;
    for index in 0..COUNT {
        let (form, method, bound, march, march_bound) = &methods[index % methods.len()];
        let aspect = random.between(0.5, 2.5);
        let camera = random.camera(aspect);
        let light = if form.local() {
            wild_light(&mut random, &camera, form.point)
        } else {
            let towards = random.light(&camera);
            let matrix = gpu::light_matrix(towards, camera.eye, random.magnitude(0.1, 1e3), 1.0);
            gpu::host_light(towards, matrix, 1.0, Vec3::new(random.magnitude(1e-3, 1e6) as f32, 1.0, 0.0))
        };
        let mut views = cube;
        if form.point {
            let near = random.magnitude(1e-3, 1.0) as f32;
            let far = near * random.magnitude(1.1, 1e5) as f32;
            views = airlight::core::ShadowViews::cube(light.position, near, far).unwrap();
        } else {
            views.count = 1 + random.below(6) as u32;
            for view in 0..views.count as usize {
                let towards = gpu::vector(light.direction);
                let matrix = gpu::light_matrix(towards, camera.eye, random.magnitude(0.1, 1e3), 1.0);
                views.clip_from_world[view] = gpu::host_matrix(matrix);
                views.world_from_clip[view] = gpu::host_matrix(matrix.inverse().unwrap());
            }
        }
        let medium = Medium::new(
            if random.unit() < 0.15 { 0.0 } else { random.magnitude(1e-6, 1e6) as f32 },
            Vec3::new(1.0, random.unit() as f32, 0.0),
            random.between(-0.999, 0.999) as f32,
            random.magnitude(1e-3, 1e7) as f32,
        )
        .unwrap();
        camera_buffer.write(gpu(), &gpu::host_camera(&camera, PICTURE));
        light_buffer.write(gpu(), &light);
        medium_buffer.write(gpu(), &medium);
        views_buffer.write(gpu(), &views);
        depth.write(gpu(), &wild_depths(&mut random, 128)).unwrap();
        shadow_map.write(gpu(), &wild_depths(&mut random, 64)).unwrap();
        shadow_maps.write(gpu(), &wild_depths(&mut random, 384)).unwrap();
        color.write(gpu(), &wild_depths(&mut random, 64)).unwrap();
        let mut encoder = gpu().encoder();
        method.record(&mut encoder, bound);
        march.record(&mut encoder, march_bound);
        gpu().submit(encoder).unwrap();
        let name = || format!("case {index}: {form:?} {camera:?} {light:?} {medium:?}");
        for (which, texture) in [&method.scattered, &march.scattered].into_iter().enumerate() {
            for (pixel, texel) in texture.read(gpu()).unwrap().chunks_exact(4).enumerate() {
                let fine = texel.iter().all(|v| v.is_finite() && *v >= 0.0) && texel[3] <= 1.001;
                assert!(fine, "picture {which}, pixel {pixel}: {texel:?}; {}", name());
                assert!(medium.extinction > 0.0 || texel[..3] == [0.0; 3], "{texel:?}; {}", name());
                bright += usize::from(texel[0] > 0.0);
            }
        }
        for z in method.rectification.rectified.read(gpu()).unwrap() {
            assert!((0.0..=1.0).contains(&z), "map: {z}; {}", name());
        }
        if method.prefilter.textures()[0].0 == "bases" {
            for basis in method.prefilter.stored().read(gpu()).unwrap() {
                assert!((-0.003..=1.003).contains(&basis), "basis: {basis}; {}", name());
            }
        }
        for slice in method.rectification.slices.read(gpu()).unwrap().chunks_exact(4) {
            let turn = std::f32::consts::PI * 1.000_001;
            let fine = slice.iter().all(|v| v.is_finite())
                && 0.0 <= slice[0]
                && slice[0] < slice[1]
                && slice[1] <= turn;
            assert!(fine, "slice: {slice:?}; {}", name());
            let local = 0.0 <= slice[2] && slice[2] < slice[3] && slice[3] <= turn;
            assert!(local || !form.local(), "slice: {slice:?}; {}", name());
        }
    }
    let share = bright as f64 / (COUNT * 256) as f64;
    println!("{COUNT} random cases; {:.0} % of the pixels lit", 100.0 * share);
    assert!((0.15..0.95).contains(&share), "the random cases are not varied enough: {share}");
}
