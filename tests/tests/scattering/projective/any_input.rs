// SPDX-License-Identifier: MIT OR Apache-2.0
//! Any camera, any light, any input.

use super::cameras::{LIMIT, host_camera, light_for, orthographic};
use crate::gpu::{self, Random, gpu, shaders};
use airlight::Buffer;
use airlight::scattering::{
    Along, BasisFormat, Inputs, March, Medium, ProjectiveMap, ProjectivePrefiltered, Settings, SettingsError,
    Start, Visibility, Weighting, projective_rows,
};
use airlight_tests::linear;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use glam::Vec3;
use wgpu::TextureFormat::R32Float;

#[test]
fn an_orthographic_camera_is_refused_where_rays_begin_at_the_eye() {
    let level = orthographic(&mut Random(5), 1.5);
    let light = gpu::host_vector(level.right + level.forward * 0.2);
    let rows = projective_rows(&host_camera(&level, [96, 64]), light, LIMIT, 1).unwrap();
    for (start, expected) in [(Start::Eye, Err(SettingsError::OrthographicStart)), (Start::NearPlane, Ok(()))]
    {
        let map = ProjectiveMap::resampled(gpu(), shaders(), [16, 8]).unwrap();
        let settings = Settings { start, ..Settings::default() };
        let method = ProjectivePrefiltered::new(gpu(), shaders(), map, settings, [16, 8]).unwrap();
        assert_eq!(method.write(gpu(), &rows), expected);
    }
}

#[test]
fn no_camera_light_or_input_gives_nan_or_a_value_out_of_range() {
    const SMALL: [u32; 2] = [16, 8];
    let mut random = Random(77);
    let depth = gpu::texture(SMALL, R32Float, &[1.0; 128]);
    let shadow_map = gpu::texture([8, 8], R32Float, &[1.0; 64]);
    let first = host_camera(&random.camera(2.0), SMALL);
    let matrix = gpu::light_matrix(linear::Vec3::new(0.0, 1.0, 0.0), linear::Vec3::default(), 10.0, 1.0);
    let camera = Buffer::uniform(gpu(), &first);
    let light =
        Buffer::uniform(gpu(), &gpu::host_light(linear::Vec3::new(0.0, 1.0, 0.0), matrix, 1.0, Vec3::ONE));
    let medium = Buffer::uniform(gpu(), &Medium::new(0.1, Vec3::ONE, 0.0, 10.0).unwrap());
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
    let base = Settings {
        bases: 8,
        format: BasisFormat::Rgba16Float,
        start: Start::NearPlane,
        ..Settings::default()
    };
    let plain =
        Settings { window: false, epipole_march: false, regions: 3, weighting: Weighting::Average, ..base };
    let rank = Settings { visibility: Visibility::Rank { bits: 10 }, ..base };
    let moments = Settings { visibility: Visibility::Moments, ..base };
    let methods = [base, plain, rank, moments].map(|settings| {
        let map = ProjectiveMap::resampled(gpu(), shaders(), SMALL).unwrap();
        ProjectivePrefiltered::new(gpu(), shaders(), map, settings, SMALL).unwrap()
    });
    let bound = [0, 1, 2, 3].map(|i| methods[i].bind(gpu(), &inputs).unwrap());
    let along = Along::Projective(&methods[0].map);
    let march = March::new(gpu(), shaders(), &along, Weighting::Transmittance, SMALL).unwrap();
    let march_bound = march.bind(gpu(), &inputs, &along).unwrap();
    let (mut done, mut sum) = (0, 0.0);
    while done < 800 {
        let near = random.magnitude(1e-3, 1.0);
        let far_away = if random.unit() < 0.1 { 1e4 } else { 30.0 };
        let eye = random.direction() * random.between(0.0, far_away);
        let seen = if random.unit() < 0.3 {
            orthographic(&mut random, 2.0)
        } else {
            ReferenceCamera::perspective(&airlight_tests::reference::camera::View {
                eye: gpu::vector(gpu::host_vector(eye)),
                target: eye + random.direction(),
                up: random.direction(),
                fov_y: if random.unit() < 0.1 {
                    random.magnitude(0.002, 0.2)
                } else {
                    random.between(0.2, 2.9)
                },
                aspect: 2.0,
                near,
                far: if random.unit() < 0.3 { f64::INFINITY } else { near * random.magnitude(1.1, 1e5) },
                reversed: random.unit() < 0.5,
            })
        };
        let host = host_camera(&seen, SMALL);
        let towards = light_for(&mut random, &seen);
        let far_depth = if random.unit() < 0.5 { 1.0 } else { 0.0 };
        let air = Medium::new(
            if random.unit() < 0.15 { 0.0 } else { random.magnitude(1e-6, 1e6) as f32 },
            Vec3::new(1.0, random.unit() as f32, 0.0),
            random.between(-0.999, 0.999) as f32,
            random.magnitude(1e-3, 1e7) as f32,
        )
        .unwrap();
        let splits = random.below(4) as u32 + 1;
        let Ok(rows) = projective_rows(&host, gpu::host_vector(towards), air.distance_limit, splits) else {
            continue;
        };
        let matrix = gpu::light_matrix(towards, seen.eye, random.magnitude(0.1, 1e3), far_depth);
        camera.write(gpu(), &host);
        light.write(gpu(), &gpu::host_light(towards, matrix, far_depth, Vec3::new(1e4, 1.0, 0.0)));
        medium.write(gpu(), &air);
        let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 3.0, 1e30, 0.0, 1.0];
        let mut depths = |count: usize| -> Vec<f32> {
            let share = random.unit();
            (0..count)
                .map(|_| if random.unit() < share { wild[random.below(8)] } else { random.unit() as f32 })
                .collect()
        };
        depth.write(gpu(), &depths(128)).unwrap();
        shadow_map.write(gpu(), &depths(64)).unwrap();
        let method = &methods[done % 4];
        method.write(gpu(), &rows).unwrap();
        methods[0].map.write(gpu(), &rows);
        let mut encoder = gpu().encoder();
        method.record(&mut encoder, &bound[done % 4]);
        march.record(&mut encoder, &march_bound);
        gpu().submit(encoder).unwrap();
        let name = || format!("case {done}: {host:?} {rows:?} {air:?}");
        let map = method.map.rectified.read(gpu()).unwrap();
        assert!(map.iter().all(|z| (0.0..=1.0).contains(z)), "{}", name());
        let stored = &method.prefilter.textures()[0];
        let bases = if stored.0 == "bases" { stored.1.read(gpu()).unwrap() } else { Vec::new() };
        assert!(bases.iter().all(|b| (-0.01..=1.01).contains(b)), "{}", name());
        for texture in [&method.scattered, &march.scattered] {
            for texel in texture.read(gpu()).unwrap().chunks_exact(4) {
                let fine = texel.iter().all(|v| v.is_finite() && *v >= 0.0) && texel[3] <= 1.0;
                assert!(fine, "{texel:?}; {}", name());
                assert!(air.extinction > 0.0 || texel[..3] == [0.0; 3], "{texel:?}; {}", name());
                sum += f64::from(texel[3]);
            }
        }
        done += 1;
    }
    let mean = sum / (800.0 * 256.0);
    println!("mean visibility {mean:.3}");
    assert!((0.2..0.95).contains(&mean), "the random cases are not varied enough: {mean}");
}
