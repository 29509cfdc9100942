// SPDX-License-Identifier: MIT OR Apache-2.0
//! The upsampling alone, over synthetic depths and values.

use super::cameras::{any_camera, distance};
use super::case::{channels, submit};
use crate::gpu::{self, Random, gpu, shaders};
use crate::probing::f;
use airlight::scattering::{
    Along, Inputs, Interpolated, March, Medium, Reduced, Resolution, TOLERANCE, Upsample, Weighting,
};
use airlight::{Buffer, Texture};
use airlight_tests::linear;
use glam::Vec3;
use wgpu::TextureFormat::{R32Float, Rgba16Float};

/// A directional light, a medium and a camera for synthetic buffers.
struct Bench {
    camera: Buffer,
    light: Buffer,
    medium: Buffer,
    shadow_map: Texture,
}

impl Bench {
    fn new(camera: &airlight::core::Camera, medium: &Medium) -> Self {
        let towards = linear::Vec3::new(0.3, 0.9, -0.2);
        let matrix = gpu::light_matrix(towards, linear::Vec3::new(0.0, 0.0, 0.0), 20.0, 1.0);
        Self {
            camera: Buffer::uniform(gpu(), camera),
            light: Buffer::uniform(gpu(), &gpu::host_light(towards, matrix, 1.0, Vec3::new(3.0, 2.0, 1.0))),
            medium: Buffer::uniform(gpu(), medium),
            shadow_map: gpu::texture([1, 1], R32Float, &[1.0]),
        }
    }

    fn inputs<'a>(&'a self, depth: &'a Texture) -> Inputs<'a> {
        Inputs {
            camera: &self.camera,
            light: &self.light,
            medium: &self.medium,
            depth,
            shadow_map: &self.shadow_map,
            shadow_maps: None,
            shadow_views: None,
            light_texture: None,
        }
    }

    /// The upsampled picture of synthetic depths and values of the evaluated pixels.
    fn upsampled(
        &self,
        camera: &airlight::core::Camera,
        resolution: Resolution,
        depth: &Texture,
        reduced_values: &[f32],
        interpolated: Interpolated,
    ) -> Vec<f32> {
        let reduced = Reduced::new(gpu(), shaders(), camera, resolution).unwrap();
        let bound = reduced.bind(gpu(), &self.inputs(depth)).unwrap();
        submit(|encoder| reduced.record(encoder, &bound));
        let scattered = gpu::texture(reduced.viewport(), Rgba16Float, reduced_values);
        let size = [camera.viewport.x as u32, camera.viewport.y as u32];
        let upsample = Upsample::new(gpu(), shaders(), interpolated, size).unwrap();
        let bound = upsample.bind(gpu(), &self.inputs(depth), &reduced, &scattered).unwrap();
        submit(|encoder| upsample.record(encoder, &bound));
        upsample.scattered.read(gpu()).unwrap()
    }
}

#[test]
fn upsampling_is_joint_bilateral() {
    let mut random = Random(77);
    let medium = Medium::new(0.05, Vec3::ONE, 0.3, 60.0).unwrap();
    let (mut worst, mut edges) = (0.0_f64, 0);
    for index in 0..24 {
        let size = [30 + random.below(12) as u32, 20 + random.below(12) as u32];
        let camera = any_camera(&mut random, size);
        let resolution = if index % 2 == 0 { Resolution::Half } else { Resolution::Quarter };
        let factor = resolution.factor() as usize;
        let bench = Bench::new(&camera, &medium);
        let [width, height] = size.map(|side| side as usize);
        // Blobs of a few distances.
        let forward = camera.far_depth > 0.5;
        let levels: Vec<f32> = (0..5)
            .map(|_| {
                let near = random.magnitude(0.002, 0.5) as f32;
                if camera.projection == 1 {
                    random.unit() as f32
                } else if forward {
                    1.0 - near
                } else {
                    near
                }
            })
            .collect();
        let depths: Vec<f32> = (0..width * height)
            .map(|i| {
                let (x, y) = (i % width / 3, i / width / 2);
                levels[(x * 7 + y * 3 + x * y) % 5]
            })
            .collect();
        let depth = gpu::texture(size, R32Float, &depths);
        let [low_width, low_height] = [width.div_ceil(factor), height.div_ceil(factor)];
        let values: Vec<f32> = (0..low_width * low_height)
            .flat_map(|_| {
                let visibility = (random.unit() * 1024.0).floor() as f32 / 1024.0;
                [0.0, 0.0, 0.0, if random.unit() < 0.02 { f32::NAN } else { visibility }]
            })
            .collect();
        let found = bench.upsampled(&camera, resolution, &depth, &values, Interpolated::Visibility);
        for y in 0..height {
            for x in 0..width {
                let own = distance(&camera, [x, y], depths[y * width + x], 60.0);
                let (mut near, mut all, mut near_sum, mut all_sum) = (0.0, 0.0, 0.0, 0.0);
                let (mut spread, mut weights) = (0.0_f64, 0.0);
                for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let cx = (x / factor + dx).min(low_width - 1);
                    let cy = (y / factor + dy).min(low_height - 1);
                    let share = |at: usize, d: usize| {
                        let part = (at % factor) as f64 / factor as f64;
                        if d == 0 { 1.0 - part } else { part }
                    };
                    // The neighbour's own ray: the shader takes the pixel's, a pixel or two beside it.
                    let other = distance(&camera, [x, y], depths[cy * factor * width + cx * factor], 60.0);
                    let off = (other - own) / (own * f(TOLERANCE));
                    let k = 1.0 / (1.0 + off * off);
                    let value = f(values[4 * (cy * low_width + cx) + 3]);
                    let value = if value.is_finite() { value } else { 0.0 };
                    let b = share(x, dx) * share(y, dy);
                    near += b * k;
                    near_sum += b * k * value;
                    all += k;
                    all_sum += k * value;
                    spread = spread.max(off.abs());
                    weights += b;
                }
                assert!((weights - 1.0_f64).abs() < 1e-12);
                let rest = 0.01 * (1.0 - near);
                let expected = (near_sum + rest * all_sum) / (near + rest * all);
                edges += usize::from(spread > 3.0);
                // Half a unit in the last place of f16, and distances as f32 resolves them.
                let slack = if camera.projection == 0 && forward { 3e-3 } else { 1e-3 };
                worst = worst.max((f(found[4 * (y * width + x) + 3]) - expected).abs() / slack);
            }
        }
    }
    println!("joint bilateral: worst error {worst:.2} of its budget, {edges} pixels at edges");
    assert!(worst <= 1.0 && edges > 3000, "{worst} {edges}");
}

#[test]
fn upsampled_radiance_follows_from_distance_and_phase() {
    let mut random = Random(5);
    let medium = Medium::new(0.05, Vec3::splat(0.9), 0.4, 60.0).unwrap();
    let size = [40, 24];
    let camera = gpu::host_camera(&random.camera(40.0 / 24.0), size);
    let bench = Bench::new(&camera, &medium);
    let depths: Vec<f32> = (0..40 * 24).map(|_| random.between(0.9, 1.0) as f32).collect();
    let depth = gpu::texture(size, R32Float, &depths);
    // One visibility everywhere stays what it is, whatever the depths.
    let values: Vec<f32> = [0.1, 0.2, 0.3, 0.625].repeat(20 * 12);
    let found = bench.upsampled(&camera, Resolution::Half, &depth, &values, Interpolated::Visibility);
    let march = {
        let along = Along::ShadowMap { steps: 1 };
        let march = March::new(gpu(), shaders(), &along, Weighting::Average, size).unwrap();
        let bound = march.bind(gpu(), &bench.inputs(&depth), &along).unwrap();
        submit(|encoder| march.record(encoder, &bound));
        march.scattered.read(gpu()).unwrap()
    };
    for (found, lit) in found.chunks_exact(4).zip(march.chunks_exact(4)) {
        // One unit in the last place of f16: targets may be rounded towards zero.
        assert!((found[3] - 0.625).abs() < 5e-4, "{found:?}");
        for (a, b) in found[..3].iter().zip(lit) {
            assert!((f(*a) - 0.625 * f(*b) / f(lit[3])).abs() <= 2e-3 * f(*b), "{found:?} {lit:?}");
        }
    }
    let found = bench.upsampled(&camera, Resolution::Half, &depth, &values, Interpolated::Radiance);
    for texel in found.chunks_exact(4) {
        assert!(texel.iter().zip([0.1, 0.2, 0.3, 0.625]).all(|(a, b)| (f(*a) - b).abs() < 1e-3), "{texel:?}");
    }
}

#[test]
fn nothing_but_numbers_leaves_the_upsampling() {
    let mut random = Random(9);
    let size = [37, 21];
    let wild = |random: &mut Random| match random.below(6) {
        0 => f32::NAN,
        1 => f32::INFINITY,
        2 => f32::NEG_INFINITY,
        3 => f32::from_bits(random.bits()),
        _ => random.unit() as f32,
    };
    for _ in 0..12 {
        let medium = Medium::new(
            random.magnitude(1e-6, 1e5) as f32,
            Vec3::ONE,
            0.9,
            random.magnitude(1e-2, 1e7) as f32,
        );
        let camera = any_camera(&mut random, size);
        let bench = Bench::new(&camera, &medium.unwrap());
        let depths: Vec<f32> = (0..37 * 21).map(|_| wild(&mut random)).collect();
        let depth = gpu::texture(size, R32Float, &depths);
        for resolution in [Resolution::Half, Resolution::Quarter] {
            let texels = size.map(|side| side.div_ceil(resolution.factor()));
            let values: Vec<f32> = (0..texels[0] * texels[1] * 4).map(|_| wild(&mut random)).collect();
            for interpolated in [Interpolated::Visibility, Interpolated::Radiance] {
                let found = bench.upsampled(&camera, resolution, &depth, &values, interpolated);
                assert!(found.iter().all(|x| (0.0..=65504.0).contains(x)), "{interpolated:?}");
                assert!(channels(&found, 3..4).iter().all(|v| *v <= 1.0));
            }
        }
    }
}
