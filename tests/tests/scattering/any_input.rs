// SPDX-License-Identifier: MIT OR Apache-2.0
//! Any camera, any light, any input.

use crate::gpu::{self, Random, gpu, shaders};
use crate::methods::all_methods;
use airlight::scattering::{
    Along, BasisFormat, Inputs, March, Medium, Prefiltered, Settings, Visibility, Weighting,
};
use airlight::{Buffer, Texture};
use airlight_tests::error;
use airlight_tests::reference::camera::{Camera as ReferenceCamera, View};
use glam::Vec3;
use wgpu::TextureFormat::R32Float;

/// A texture that outside data may look like: any depths, none, or bit patterns of all kinds.
fn wild_depths(random: &mut Random, count: usize, empty: f32) -> Vec<f32> {
    let kind = random.below(4);
    (0..count)
        .map(|_| match kind {
            0 => random.unit() as f32,
            1 => empty,
            2 if random.unit() < 0.5 => random.unit() as f32,
            _ => match random.below(9) {
                0 => f32::NAN,
                1 => f32::INFINITY,
                2 => f32::NEG_INFINITY,
                3 => -1.0,
                4 => 3.0,
                5 => 1e30,
                6 => f32::from_bits(random.bits()),
                7 => 0.0,
                _ => empty,
            },
        })
        .collect()
}

struct Wild {
    camera: airlight::core::Camera,
    light: airlight::core::Light,
    medium: Medium,
}

fn wild(random: &mut Random, picture: [u32; 2]) -> Wild {
    let far_away = if random.unit() < 0.1 { 1e4 } else { 30.0 };
    let eye = random.direction() * random.between(0.0, far_away);
    let eye = gpu::vector(gpu::host_vector(eye));
    let near = random.magnitude(1e-3, 1.0);
    let camera = ReferenceCamera::perspective(&View {
        eye,
        target: eye + random.direction(),
        up: random.direction(),
        fov_y: if random.unit() < 0.1 { random.magnitude(0.002, 0.2) } else { random.between(0.2, 2.96) },
        aspect: f64::from(picture[0]) / f64::from(picture[1]),
        near,
        far: if random.unit() < 0.3 { f64::INFINITY } else { near * random.magnitude(1.1, 1e5) },
        reversed: random.unit() < 0.5,
    });
    let light = random.light(&camera);
    // Next to a pole, but not at it.
    let light =
        if random.unit() < 0.2 { light + random.direction() * random.magnitude(1e-8, 1e-2) } else { light };
    let far_depth = if random.unit() < 0.5 { 1.0 } else { 0.0 };
    let centre = if random.unit() < 0.8 { eye } else { random.direction() * 100.0 };
    let matrix = gpu::light_matrix(light, centre, random.magnitude(0.1, 1e3), far_depth);
    let bright = random.magnitude(1e-3, 1e6) as f32;
    let radiance = Vec3::new(bright, 0.5 * bright, 0.0);
    let medium = Medium::new(
        if random.unit() < 0.15 { 0.0 } else { random.magnitude(1e-6, 1e6) as f32 },
        Vec3::new(1.0, random.unit() as f32, 0.0),
        random.between(-0.999, 0.999) as f32,
        random.magnitude(1e-3, 1e7) as f32,
    );
    Wild {
        camera: gpu::host_camera(&camera, picture),
        light: gpu::host_light(light, matrix, far_depth, radiance),
        medium: medium.unwrap(),
    }
}

#[test]
fn no_camera_light_or_input_gives_nan_or_a_value_out_of_range() {
    const COUNT: usize = 3200;
    const BATCH: usize = 64;
    const PICTURE: [u32; 2] = [16, 8];
    const PIXELS: usize = 128;
    const MAP: [u32; 2] = [16, 8];
    const SHADOW: [u32; 2] = [8, 8];
    let mut random = Random(2024);
    let first = wild(&mut random, PICTURE);
    let camera = Buffer::uniform(gpu(), &first.camera);
    let light = Buffer::uniform(gpu(), &first.light);
    let medium = Buffer::uniform(gpu(), &first.medium);
    let depth = gpu::texture(PICTURE, R32Float, &[1.0; PIXELS]);
    let shadow_map = gpu::texture(SHADOW, R32Float, &[1.0; 64]);
    let inputs = Inputs {
        camera: &camera,
        light: &light,
        medium: &medium,
        depth: &depth,
        shadow_map: &shadow_map,
        shadow_views: None,
        shadow_maps: None,
        light_texture: None,
    };
    let defaults = Settings { bases: 8, map: MAP, format: BasisFormat::Rgba16Float, ..Settings::default() };
    let plain = Settings { window: false, epipole_march: false, weighting: Weighting::Average, ..defaults };
    let rank = Settings { visibility: Visibility::Rank { bits: 12 }, ..defaults };
    let moments = Settings { visibility: Visibility::Moments, ..defaults };
    let wavelet = Visibility::Wavelet { bits: 12 };
    let wavelet = Settings { visibility: wavelet, weighting: Weighting::Average, ..defaults };
    // Cases take turns: with everything and along rows, plain and through the shadow map; then the other methods.
    let methods = [defaults, plain, rank, moments, wavelet]
        .map(|settings| Prefiltered::new(gpu(), shaders(), settings, PICTURE).unwrap());
    let bound = [0, 1, 2, 3, 4].map(|i| methods[i].bind(gpu(), &inputs).unwrap());
    let alongs = [Along::Rows(&methods[0].rectification), Along::ShadowMap { steps: 24 }];
    let marches = [0, 1].map(|i| {
        let march = March::new(gpu(), shaders(), &alongs[i], Weighting::Transmittance, PICTURE).unwrap();
        let bound = march.bind(gpu(), &inputs, &alongs[i]).unwrap();
        (march, bound)
    });
    // Every picture of a batch in one buffer: rows are padded to 256 bytes.
    const ROW: usize = 256;
    let pictures = [0, 1, 2, 3, 4].map(|i| {
        let (method, map) = (&methods[i], &methods[i].rectification);
        let mut all = vec![&method.scattered, &marches[i % 2].0.scattered, &map.rectified, &map.slices];
        // What the other methods store has tests of its own.
        all.extend((i < 2).then(|| method.prefilter.stored()));
        all
    });
    let height = |texture: &&Texture| (texture.size()[1] * texture.size()[2]) as usize;
    let stride = pictures[0].iter().map(height).sum::<usize>() * ROW;
    let store = Buffer::storage(gpu(), (stride * BATCH) as u64);
    let half = |bytes: &[u8], i: usize| half::f16::from_le_bytes([bytes[2 * i], bytes[2 * i + 1]]).to_f32();
    let float = |bytes: &[u8], i: usize| f32::from_le_bytes(bytes[4 * i..4 * i + 4].try_into().unwrap());
    let mut visible = 0.0;
    for batch in 0..COUNT / BATCH {
        let mut cases = Vec::new();
        for index in 0..BATCH {
            let case = wild(&mut random, PICTURE);
            camera.write(gpu(), &case.camera);
            light.write(gpu(), &case.light);
            medium.write(gpu(), &case.medium);
            depth.write(gpu(), &wild_depths(&mut random, PIXELS, case.camera.far_depth)).unwrap();
            shadow_map.write(gpu(), &wild_depths(&mut random, 64, case.light.far_depth)).unwrap();
            let mut encoder = gpu().encoder();
            methods[index % 5].record(&mut encoder, &bound[index % 5]);
            let (march, march_bound) = &marches[index % 5 % 2];
            march.record(&mut encoder, march_bound);
            let mut offset = index * stride;
            for texture in &pictures[index % 5] {
                encoder.copy_texture_to_buffer(
                    texture.raw.as_image_copy(),
                    wgpu::TexelCopyBufferInfo {
                        buffer: &store.raw,
                        layout: wgpu::TexelCopyBufferLayout {
                            offset: offset as u64,
                            bytes_per_row: Some(ROW as u32),
                            rows_per_image: Some(texture.size()[1]),
                        },
                    },
                    texture.raw.size(),
                );
                offset += height(texture) * ROW;
            }
            gpu().submit(encoder).unwrap();
            cases.push(case);
        }
        let bytes = store.read(gpu()).unwrap();
        for (index, (case, bytes)) in cases.iter().zip(bytes.chunks_exact(stride)).enumerate() {
            let name = || {
                format!(
                    "case {}: {:?} {:?} {:?}",
                    batch * BATCH + index,
                    case.camera,
                    case.light,
                    case.medium
                )
            };
            let mut offset = 0;
            for (which, texture) in pictures[index % 5].iter().enumerate() {
                let rows = height(texture);
                let columns = texture.size()[0] as usize;
                for (y, x) in (0..rows).flat_map(|y| (0..columns).map(move |x| (y, x))) {
                    let line = &bytes[offset + y * ROW..][..ROW];
                    match which {
                        0 | 1 => {
                            let texel = [0, 1, 2, 3].map(|c| half(line, 4 * x + c));
                            let fine = texel.iter().all(|v| v.is_finite() && *v >= 0.0) && texel[3] <= 1.0;
                            assert!(fine, "picture {which}, ({x}, {y}): {texel:?}; {}", name());
                            let clear = case.medium.extinction == 0.0;
                            assert!(!clear || texel[..3] == [0.0; 3], "({x}, {y}): {texel:?}; {}", name());
                            visible += f64::from(texel[3]);
                        }
                        2 => {
                            let z = float(line, x);
                            assert!((0.0..=1.0).contains(&z), "map ({x}, {y}): {z}; {}", name());
                        }
                        3 => {
                            let slice = [0, 1, 2, 3].map(|c| float(line, 4 * x + c));
                            let fine = slice.iter().all(|v| v.is_finite())
                                && 0.0 <= slice[0]
                                && slice[0] < slice[1]
                                && slice[1] <= std::f32::consts::PI * 1.000_001
                                && slice[2] > 0.0
                                && (0.0999..=1.0001).contains(&slice[3]);
                            assert!(fine, "slice {x}: {slice:?}; {}", name());
                        }
                        // A mean of (sin, cos) is no longer than 1.
                        _ => {
                            let basis = [0, 1, 2, 3].map(|c| 2.0 * half(line, 4 * x + c) - 1.0);
                            let fine = basis[0].hypot(basis[1]) <= 1.005 && basis[2].hypot(basis[3]) <= 1.005;
                            assert!(fine, "basis ({x}, {y}): {basis:?}; {}", name());
                        }
                    }
                }
                offset += rows * ROW;
            }
        }
    }
    let share = visible / (COUNT * 2 * PIXELS) as f64;
    println!("{COUNT} random cases; mean visibility {share:.3}");
    assert!((0.2..0.95).contains(&share), "the random cases are not varied enough: {share}");
}

#[test]
fn depths_that_are_not_finite_count_as_empty_and_far() {
    let scene = gpu::small_tree();
    let (picture, shadow) = ([60, 40], [64, 64]);
    let mut stage = scene.stage(picture, shadow);
    let [depths, shadows] =
        [&stage.pictures.depth, &stage.pictures.shadow_map].map(|t| t.read(gpu()).unwrap());
    let broken = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::from_bits(0xffff_ffff)];
    // Every third texel, in both.
    let mut pictures = [false, true].map(|wild| {
        let with = |values: &[f32]| -> Vec<f32> {
            let replace = |i: usize| if wild { broken[i / 3 % 4] } else { 1.0 };
            values.iter().enumerate().map(|(i, v)| if i % 3 == 0 { replace(i) } else { *v }).collect()
        };
        stage.pictures.depth = gpu::texture(picture, R32Float, &with(&depths));
        stage.pictures.shadow_map = gpu::texture(shadow, R32Float, &with(&shadows));
        all_methods(&stage, picture, [64, 64])
    });
    let wild = std::mem::take(&mut pictures[1]);
    for ((name, weighted, empty), (_, _, wild)) in pictures[0].iter().zip(wild) {
        let worst = error::max_absolute(&wild.radiance, &empty.radiance);
        assert!(worst == 0.0, "{name}, weighted {weighted}: radiance differs by {worst}");
    }
}
