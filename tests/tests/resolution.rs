// SPDX-License-Identifier: MIT OR Apache-2.0
//! Fewer pixels, shifted samples, multisampled depth: each against f64.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;

use airlight::core::{Jitter, ResolveDepth, SampleChoice};
use airlight::data::{BLUE_NOISE_SIDE, blue_noise};
use airlight::scattering::{
    Along, Inputs, Interpolated, March, Medium, Prefiltered, Rectification, Reduced, Resolution, Settings,
    TOLERANCE, Upsample, Weighting,
};
use airlight::validate::Definitions;
use airlight::{Buffer, Pass, Stage, Texture, scenes};
use airlight_tests::error;
use airlight_tests::linear;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::scattering as reference;
use glam::{Vec2, Vec3};
use gpu::{Random, gpu, shaders};
use std::f64::consts::PI;
use wgpu::TextureFormat::{R32Float, Rgba16Float};

fn f(x: f32) -> f64 {
    f64::from(x)
}

fn submit(record: impl FnOnce(&mut wgpu::CommandEncoder)) {
    let mut encoder = gpu().encoder();
    record(&mut encoder);
    gpu().submit(encoder).unwrap();
}

/// The uniform of an orthographic camera: `half` metres to every side of `centre`, looking away from `towards`.
fn orthographic(
    towards: linear::Vec3,
    centre: linear::Vec3,
    half: f64,
    reversed: bool,
) -> airlight::core::Camera {
    let far_depth = if reversed { 0.0 } else { 1.0 };
    let clip = gpu::light_matrix(towards, centre, half, far_depth);
    airlight::core::Camera {
        clip_from_world: gpu::host_matrix(clip),
        world_from_clip: gpu::host_matrix(clip.inverse().unwrap()),
        eye: Vec3::ZERO,
        near_depth: 1.0 - far_depth as f32,
        viewport: Vec2::ONE,
        far_depth: far_depth as f32,
        projection: 1,
    }
}

/// A camera of any kind, with the given viewport.
fn any_camera(random: &mut Random, viewport: [u32; 2]) -> airlight::core::Camera {
    let viewport_of = Vec2::new(viewport[0] as f32, viewport[1] as f32);
    if random.unit() < 0.3 {
        let (towards, centre) = (random.direction(), random.direction() * random.between(0.0, 20.0));
        let (half, reversed) = (random.between(1.0, 30.0), random.unit() < 0.5);
        airlight::core::Camera { viewport: viewport_of, ..orthographic(towards, centre, half, reversed) }
    } else {
        let camera = random.camera(f64::from(viewport[0]) / f64::from(viewport[1]));
        gpu::host_camera(&camera, viewport)
    }
}

// Fewer pixels.

#[test]
fn reduced_cameras_look_through_the_centres_of_evaluated_pixels() {
    let mut random = Random(41);
    let (mut worst, mut round_trip) = (0.0_f64, 0.0_f64);
    for _ in 0..500 {
        let viewport = [1 + random.below(200) as u32, 1 + random.below(200) as u32];
        let camera = any_camera(&mut random, viewport);
        for factor in [1_u32, 2, 3, 4] {
            let reduced = camera.reduced(factor);
            let size = viewport.map(|side| side.div_ceil(factor));
            assert_eq!(reduced.viewport.to_array(), size.map(|side| side as f32));
            let at = [random.below(size[0] as usize), random.below(size[1] as usize)];
            let ndc = |pixel: [usize; 2], [width, height]: [u32; 2]| {
                ReferenceCamera::pixel_ndc(pixel[0], pixel[1], width as usize, height as usize)
            };
            let depth = random.unit();
            let unproject = |camera: &airlight::core::Camera, [x, y]: [f64; 2]| {
                gpu::matrix(camera.world_from_clip).apply([x, y, depth, 1.0])
            };
            let full = unproject(&camera, ndc(at.map(|a| a * factor as usize), viewport));
            let found = unproject(&reduced, ndc(at, size));
            // Homogeneous points, equal with their scale: rays and distances are the same, as far as f32 holds
            // the matrix.
            let scale =
                camera.world_from_clip.to_cols_array().map(|x| f(x).abs()).into_iter().fold(1.0, f64::max);
            worst = full.iter().zip(found).map(|(a, b)| (a - b).abs() / scale).fold(worst, f64::max);
            // The matrices stay each other's inverses, as far as they were.
            let product = gpu::matrix(reduced.clip_from_world).apply(found);
            let before = gpu::matrix(camera.clip_from_world).apply(full);
            let off = |p: [f64; 4], [x, y]: [f64; 2]| (p[0] - x * p[3]).abs().max((p[1] - y * p[3]).abs());
            let excess = off(product, ndc(at, size))
                - 4.0 * off(before, ndc(at.map(|a| a * factor as usize), viewport));
            round_trip = round_trip.max(excess);
        }
    }
    println!("reduced cameras: points {worst:.1e}, round trip {round_trip:.1e}");
    assert!(worst < 1e-6 && round_trip < 2e-3, "{worst:e} {round_trip:e}");
}

fn rectified(inputs: &Inputs<'_>) -> Rectification {
    let map = Rectification::new(gpu(), shaders(), [512, 512]).unwrap();
    let bound = map.bind(gpu(), inputs).unwrap();
    submit(|encoder| map.record(encoder, &bound));
    map
}

/// A scene of the gallery with its rectified map.
struct Case {
    stage: Stage,
    map: Rectification,
    view: airlight::core::PerspectiveView,
    size: [u32; 2],
}

impl Case {
    fn new(name: &str, size: [u32; 2]) -> Self {
        let scene = scenes::scene(name).unwrap().unwrap();
        let view = scene.setting().view.perspective().unwrap();
        let stage = Stage::new(gpu(), gpu::raster(), &scene.setting(), size, [1024, 1024]).unwrap();
        let map = rectified(&stage.inputs());
        Self { stage, map, view, size }
    }

    /// The exact picture over a map that was rectified for the camera reduced by `factor`.
    fn exact(&self, map: &Rectification, factor: u32) -> reference::Picture {
        let [width, height] = self.size.map(|side| side as usize);
        let camera = gpu::reference_camera(&self.view, self.size);
        let reduced = self.stage.camera.reduced(factor);
        let reduced = ReferenceCamera::from_matrix(gpu::matrix(reduced.clip_from_world), 1.0).unwrap();
        let limit = self.stage.medium.distance_limit;
        let rectification = gpu::read_back(&reduced, self.stage.light.direction, limit, map);
        let depth = self.stage.pictures.depth.read(gpu()).unwrap();
        let scene = reference::Scene {
            camera: &camera,
            light: gpu::reference_light(&self.stage.light),
            medium: gpu::reference_medium(&self.stage.medium),
            depth: &depth,
            width,
            height,
        };
        reference::picture(&scene, &rectification, &map.rectified.read(gpu()).unwrap(), 1)
    }

    fn march(&self, inputs: &Inputs<'_>, along: &Along<'_>, viewport: [u32; 2]) -> March {
        self.jittered(inputs, along, Jitter::None, 0, viewport)
    }

    fn jittered(
        &self,
        inputs: &Inputs<'_>,
        along: &Along<'_>,
        jitter: Jitter,
        frame: u32,
        viewport: [u32; 2],
    ) -> March {
        let march = March::jittered(gpu(), shaders(), along, Weighting::Average, jitter, viewport).unwrap();
        march.set_frame(gpu(), frame).unwrap();
        let bound = march.bind(gpu(), inputs, along).unwrap();
        submit(|encoder| march.record(encoder, &bound));
        march
    }

    fn reduced(&self, resolution: Resolution) -> Reduced {
        let reduced = Reduced::new(gpu(), shaders(), &self.stage.camera, resolution).unwrap();
        let bound = reduced.bind(gpu(), &self.stage.inputs()).unwrap();
        submit(|encoder| reduced.record(encoder, &bound));
        reduced
    }

    fn upsampled(&self, reduced: &Reduced, scattered: &Texture, interpolated: Interpolated) -> Vec<f32> {
        let upsample = Upsample::new(gpu(), shaders(), interpolated, self.size).unwrap();
        let bound = upsample.bind(gpu(), &self.stage.inputs(), reduced, scattered).unwrap();
        submit(|encoder| upsample.record(encoder, &bound));
        upsample.scattered.read(gpu()).unwrap()
    }
}

fn channels(texels: &[f32], keep: std::ops::Range<usize>) -> Vec<f32> {
    texels.chunks_exact(4).flat_map(|texel| texel[keep.clone()].to_vec()).collect()
}

/// Radiance with average visibility: both visibilities vanish together.
fn average_radiance(picture: &reference::Picture) -> Vec<f64> {
    let scale = |p: &reference::Pixel| if p.weighted > 0.0 { p.average / p.weighted } else { 0.0 };
    picture.pixels.iter().flat_map(|p| p.radiance.map(|l| l * scale(p))).collect()
}

#[test]
fn evaluated_pixels_are_those_of_the_full_picture() {
    let _turn = gpu::turn();
    // A size that is no multiple of the factors.
    let case = Case::new("foliage", [479, 269]);
    let inputs = case.stage.inputs();
    let along = Along::ShadowMap { steps: 256 };
    let full = case.march(&inputs, &along, case.size).scattered.read(gpu()).unwrap();
    let depth = case.stage.pictures.depth.read(gpu()).unwrap();
    for resolution in [Resolution::Half, Resolution::Quarter] {
        let reduced = case.reduced(resolution);
        let factor = resolution.factor() as usize;
        let [width, height] = reduced.viewport().map(|side| side as usize);
        assert_eq!([width, height], [479_usize.div_ceil(factor), 269_usize.div_ceil(factor)]);
        let depths = reduced.depth.read(gpu()).unwrap();
        let march = case.march(&reduced.inputs(&inputs), &along, reduced.viewport());
        let found = march.scattered.read(gpu()).unwrap();
        let mut visibilities: [Vec<f32>; 2] = [Vec::new(), Vec::new()];
        let mut radiances = visibilities.clone();
        for y in 0..height {
            for x in 0..width {
                let (from, to) = (y * factor * 479 + x * factor, y * width + x);
                assert_eq!(depths[to], depth[from], "pixel ({x}, {y})");
                visibilities[0].push(found[4 * to + 3]);
                visibilities[1].push(full[4 * from + 3]);
                radiances[0].extend(&found[4 * to..4 * to + 3]);
                radiances[1].extend(&full[4 * from..4 * from + 3]);
            }
        }
        // Rounding of the matrices moves a ray over the edge of a texel here and there.
        let visibility = error::mean_absolute(&visibilities[0], &visibilities[1]);
        let radiance = error::relative_rmse(&radiances[0], &radiances[1]);
        println!("1/{factor}: visibility {visibility:.1e}, radiance {radiance:.1e}");
        assert!(visibility < 1e-3 && radiance < 5e-3, "{visibility:e} {radiance:e}");
    }
}

#[test]
fn upsampled_radiance_is_that_of_the_exact_picture() {
    let _turn = gpu::turn();
    // Budgets at this size, where a leaf covers a quarter of the pixels that it covers at 1920x1080:
    // half, quarter.
    for (name, budgets) in
        [("foliage", [0.01, 0.015]), ("terrain", [0.002, 0.003]), ("torus", [0.003, 0.004])]
    {
        let case = Case::new(name, [959, 539]);
        let inputs = case.stage.inputs();
        let exact = average_radiance(&case.exact(&case.map, 1));
        let along = Along::RowSteps { map: &case.map, steps: 512 };
        let full = case.march(&inputs, &along, case.size).scattered.read(gpu()).unwrap();
        let baseline = error::relative_rmse(&channels(&full, 0..3), &exact);
        for (resolution, budget) in [Resolution::Half, Resolution::Quarter].into_iter().zip(budgets) {
            let reduced = case.reduced(resolution);
            let map = rectified(&reduced.inputs(&inputs));
            let exact = average_radiance(&case.exact(&map, resolution.factor()));
            let along = Along::RowSteps { map: &map, steps: 512 };
            let march = case.march(&reduced.inputs(&inputs), &along, reduced.viewport());
            let of = |interpolated| {
                let picture = case.upsampled(&reduced, &march.scattered, interpolated);
                error::relative_rmse(&channels(&picture, 0..3), &exact)
            };
            let (visibility, radiance) = (of(Interpolated::Visibility), of(Interpolated::Radiance));
            println!(
                "{name} 1/{}: {visibility:.4}, interpolating radiance {radiance:.4}, full {baseline:.4}",
                resolution.factor()
            );
            assert!(visibility <= budget, "{name}, {resolution:?}: {visibility} exceeds {budget}");
            assert!(radiance <= 3.0 * budget, "{name}, {resolution:?}: {radiance}");
        }
    }
}

#[test]
fn prefiltered_pictures_are_upsampled_as_well() {
    let _turn = gpu::turn();
    let case = Case::new("foliage", [960, 540]);
    let inputs = case.stage.inputs();
    let settings = Settings { map: [512, 512], epipole_march: false, ..Settings::default() };
    let evaluated = |viewport: [u32; 2], inputs: &Inputs<'_>| {
        let method = Prefiltered::new(gpu(), shaders(), settings, viewport).unwrap();
        let bound = method.bind(gpu(), inputs).unwrap();
        submit(|encoder| method.record(encoder, &bound));
        method
    };
    let method = evaluated(case.size, &inputs);
    let exact = case.exact(&method.rectification, 1).radiance();
    let full = error::relative_rmse(&channels(&method.scattered.read(gpu()).unwrap(), 0..3), &exact);
    for resolution in [Resolution::Half, Resolution::Quarter] {
        let reduced = case.reduced(resolution);
        let method = evaluated(reduced.viewport(), &reduced.inputs(&inputs));
        let picture = case.upsampled(&reduced, &method.scattered, Interpolated::Visibility);
        let exact = case.exact(&method.rectification, resolution.factor()).radiance();
        let found = error::relative_rmse(&channels(&picture, 0..3), &exact);
        println!("prefiltered 1/{}: {found:.4}, full {full:.4}", resolution.factor());
        assert!(found <= full + 0.01, "{resolution:?}: {found}, full {full}");
    }
}

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

/// Distance along the ray of a pixel of any camera, metres, from its matrix in f64.
fn distance(camera: &airlight::core::Camera, [x, y]: [usize; 2], depth: f32, limit: f64) -> f64 {
    let ndc = ReferenceCamera::pixel_ndc(x, y, camera.viewport.x as usize, camera.viewport.y as usize);
    let point = |z: f64| {
        let [x, y, z, w] = gpu::matrix(camera.world_from_clip).apply([ndc[0], ndc[1], z, 1.0]);
        (linear::Vec3::new(x, y, z), w)
    };
    let (at, w) = point(f(depth));
    if camera.projection == 1 {
        let (near, near_w) = point(f(camera.near_depth));
        return ((at * w.recip()) - near * near_w.recip()).length().min(limit);
    }
    if w <= 1e-9 {
        return limit;
    }
    (at * w.recip() - gpu::vector(camera.eye)).length().min(limit)
}

#[test]
fn upsampling_is_joint_bilateral() {
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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

// Shifted samples.

#[test]
fn blue_noise_is_uniform_and_blue() {
    let side = BLUE_NOISE_SIDE;
    let tile: Vec<f64> = blue_noise().iter().map(|x| f(*x)).collect();
    // The histogram is exactly uniform, at 8 bits as well.
    let mut ranks: Vec<usize> = tile.iter().map(|x| (x * 4096.0 - 0.5) as usize).collect();
    let mut eight_bits = [0; 256];
    ranks.iter().for_each(|rank| eight_bits[rank * 256 / 4096] += 1);
    assert!(eight_bits.iter().all(|count| *count == 16));
    ranks.sort_unstable();
    assert!(ranks.into_iter().eq(0..4096));
    // The power spectrum: rows, then columns.
    let transform = |line: &dyn Fn(usize) -> (f64, f64), k: usize| {
        (0..side).fold((0.0, 0.0), |(re, im), i| {
            let (sine, cosine) = (-2.0 * PI * (k * i % side) as f64 / side as f64).sin_cos();
            let (a, b) = line(i);
            (re + a * cosine - b * sine, im + a * sine + b * cosine)
        })
    };
    let mut rows = vec![(0.0, 0.0); side * side];
    for y in 0..side {
        for k in 0..side {
            rows[y * side + k] = transform(&|i| (tile[y * side + i] - 0.5, 0.0), k);
        }
    }
    let (mut low, mut middle, mut total) = ((0.0, 0), (0.0, 0), 0.0);
    for kx in 0..side {
        for ky in 0..side {
            let (re, im) = transform(&|i| rows[i * side + kx], ky);
            let power = (re * re + im * im) / (side * side) as f64;
            let wrapped = |k: usize| k.min(side - k) as f64;
            let frequency = wrapped(kx).hypot(wrapped(ky));
            total += power;
            if frequency > 0.0 && frequency < side as f64 / 8.0 {
                low = (low.0 + power, low.1 + 1);
            } else if frequency < side as f64 / 4.0 {
                middle = (middle.0 + power, middle.1 + 1);
            }
        }
    }
    // Parseval: the mean power is the variance of uniform numbers.
    let mean = total / (side * side) as f64;
    assert!((mean - 1.0 / 12.0).abs() < 1e-4, "{mean}");
    let (low, middle) = (low.0 / f64::from(low.1) / mean, middle.0 / f64::from(middle.1) / mean);
    println!(
        "blue noise: power {low:.4} below 1/8, {middle:.3} from there to 1/4 of the sampling rate; white is 1"
    );
    assert!(low < 0.02 && middle < 0.3, "{low} {middle}");
}

/// Mean visibility over 4x4 pixels that lie at about one distance; none elsewhere.
fn blocks(values: &[f64], smooth: &[bool], [width, height]: [usize; 2]) -> Vec<f64> {
    let mut means = Vec::new();
    for y in (0..height - 3).step_by(4) {
        for x in (0..width - 3).step_by(4) {
            let at = |i: usize| (y + i / 4) * width + x + i % 4;
            if (0..16).all(|i| smooth[at(i)]) {
                means.push((0..16).map(|i| values[at(i)]).sum::<f64>() / 16.0);
            }
        }
    }
    means
}

#[test]
fn jitter_makes_a_coarse_march_exact_on_average() {
    let _turn = gpu::turn();
    const STEPS: u32 = 16;
    let case = Case::new("foliage", [480, 270]);
    let inputs = case.stage.inputs();
    let size = case.size.map(|side| side as usize);
    let rows = Along::RowSteps { map: &case.map, steps: STEPS };
    let shadow_map = Along::ShadowMap { steps: STEPS };
    let fine = [Along::RowSteps { map: &case.map, steps: 4096 }, Along::ShadowMap { steps: 4096 }];
    let everywhere = vec![true; size[0] * size[1]];
    for (along, fine, name) in [(&rows, &fine[0], "rows"), (&shadow_map, &fine[1], "shadow map")] {
        let visibility = |along: &Along<'_>, jitter, frame| -> Vec<f64> {
            let march = case.jittered(&inputs, along, jitter, frame, case.size);
            channels(&march.scattered.read(gpu()).unwrap(), 3..4).into_iter().map(f).collect()
        };
        let exact = visibility(fine, Jitter::None, 0);
        let exact_blocks = blocks(&exact, &everywhere, size);
        let of = |values: &[f64]| {
            let means = blocks(values, &everywhere, size);
            [error::mean_absolute(&means, &exact_blocks), error::mean_absolute(values, &exact)]
        };
        let [plain_blocks, plain] = of(&visibility(along, Jitter::None, 0));
        for jitter in [Jitter::Gradient, Jitter::BlueNoise] {
            let first = visibility(along, jitter, 0);
            let [block, pixel] = of(&first);
            let mut mean = vec![0.0; first.len()];
            for frame in 0..16 {
                for (sum, value) in mean.iter_mut().zip(visibility(along, jitter, frame)) {
                    *sum += value / 16.0;
                }
            }
            let frames = error::mean_absolute(&mean, &exact);
            println!(
                "{name}, {jitter:?}: 4x4 {block:.4} (without {plain_blocks:.4}), 16 frames {frames:.4} \
                 (without {plain:.4}), one pixel {pixel:.4}"
            );
            assert!(block < 0.6 * plain_blocks, "{name}, {jitter:?}: {block} without {plain_blocks}");
            assert!(frames < 0.35 * plain, "{name}, {jitter:?}: {frames} without {plain}");
            assert_ne!(first, visibility(along, jitter, 1), "{name}, {jitter:?} stands still");
        }
    }
    // One step a texel has nothing to shift.
    let texels = Along::Rows(&case.map);
    let plain = case.march(&inputs, &texels, case.size).scattered.read(gpu()).unwrap();
    let jittered = case.jittered(&inputs, &texels, Jitter::BlueNoise, 3, case.size);
    assert_eq!(plain, jittered.scattered.read(gpu()).unwrap());
}

// Multisampled depth.

/// A multisampled depth buffer of four samples a pixel: `depths`, four values a pixel.
fn multisampled([width, height]: [u32; 2], depths: &[f32]) -> Texture {
    let source = gpu::texture([4 * width, height], R32Float, depths);
    let device = &gpu().device;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(
            "@group(0) @binding(0) var source: texture_2d<f32>;
             struct Varyings { @builtin(position) position: vec4<f32>, @location(0) @interpolate(flat) index: u32 }
             struct Sample { @builtin(frag_depth) depth: f32, @builtin(sample_mask) mask: u32 }
             @vertex fn vertex(
                 @builtin(vertex_index) v: u32, @builtin(instance_index) index: u32
             ) -> Varyings {
                 let corner = vec2<f32>(f32(v & 1u), f32(v >> 1u)) * 4.0 - 1.0;
                 return Varyings(vec4<f32>(corner, 0.0, 1.0), index);
             }
             @fragment fn fragment(in: Varyings) -> Sample {
                 let pixel = vec2<u32>(in.position.xy);
                 let depth = textureLoad(source, vec2<u32>(4u * pixel.x + in.index, pixel.y), 0).x;
                 return Sample(depth, 1u << in.index);
             }"
            .into(),
        ),
    });
    let samples = 4;
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: wgpu::TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    });
    let raw = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: samples,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Depth32Float,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let view = raw.create_view(&wgpu::TextureViewDescriptor::default());
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::TextureView(&source.view),
        }],
    });
    submit(|encoder| {
        let mut render = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.5),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        render.set_pipeline(&pipeline);
        render.set_bind_group(0, &group, &[]);
        render.draw(0..3, 0..4);
    });
    Texture { raw, view, dimension: wgpu::TextureViewDimension::D2 }
}

#[test]
fn resolved_depths_scatter_what_their_samples_scatter() {
    let _turn = gpu::turn();
    const LIMIT: f64 = 60.0;
    let size = [16_u32, 12];
    let mut random = Random(31);
    let (mut radiance, mut means, mut mixed) = (0.0_f64, 0.0_f64, 0);
    for index in 0..30 {
        let camera = any_camera(&mut random, size);
        let forward = camera.far_depth > 0.5;
        let extinction = [0.0, 1e-5, 0.02, 0.3][index % 4];
        let depths: Vec<f32> = (0..16 * 12)
            .flat_map(|_| {
                let kind = random.below(4);
                let mut one = || match random.below(5) {
                    0 => camera.far_depth,
                    _ if camera.projection == 1 => random.unit() as f32,
                    _ => {
                        let near = random.magnitude(2e-3, 0.3) as f32;
                        if forward { 1.0 - near } else { near }
                    }
                };
                let first = one();
                // All alike, one of another depth, all different.
                match kind {
                    0 => [first; 4],
                    1 => [one(), first, first, first],
                    _ => [first, one(), one(), one()],
                }
            })
            .collect();
        let samples = multisampled(size, &depths);
        let buffer = Buffer::uniform(gpu(), &camera);
        let resolve = |choice| {
            let pass = ResolveDepth::new(gpu(), shaders(), choice, size).unwrap();
            let bound = pass.bind(gpu(), &buffer, &samples).unwrap();
            submit(|encoder| pass.record(encoder, &bound));
            pass.depth.read(gpu()).unwrap()
        };
        let mean =
            resolve(SampleChoice::Mean { extinction: extinction as f32, distance_limit: LIMIT as f32 });
        let (nearest, farthest) = (resolve(SampleChoice::Nearest), resolve(SampleChoice::Farthest));
        for (i, four) in depths.chunks_exact(4).enumerate() {
            let least = four.iter().copied().fold(1.0, f32::min);
            let greatest = four.iter().copied().fold(0.0, f32::max);
            let ends = if forward { [least, greatest] } else { [greatest, least] };
            assert_eq!([nearest[i], farthest[i]], ends);
            if least == greatest {
                assert_eq!(mean[i], least);
                continue;
            }
            mixed += 1;
            let at = [i % 16, i / 16];
            let lengths: Vec<f64> = four.iter().map(|d| distance(&camera, at, *d, LIMIT)).collect();
            let found = distance(&camera, at, mean[i], LIMIT);
            // As far as f32 resolves depths.
            let step =
                (distance(&camera, at, f32::from_bits(mean[i].to_bits() + 4), LIMIT) - found).abs().max(
                    (distance(&camera, at, f32::from_bits(mean[i].to_bits().saturating_sub(4)), LIMIT)
                        - found)
                        .abs(),
                );
            let spread = lengths.iter().copied().fold(0.0, f64::max)
                - lengths.iter().copied().fold(f64::INFINITY, f64::min);
            let slack = step + 1e-5 * (found + gpu::vector(camera.eye).length()) + 3e-4 * spread;
            if extinction == 0.0 {
                let expected = lengths.iter().sum::<f64>() / 4.0;
                means = means.max((found - expected).abs() / slack);
            } else {
                let lit = |s: f64| -(-extinction * s).exp_m1();
                let expected = lengths.iter().map(|s| lit(*s)).sum::<f64>() / 4.0;
                // The slope of the radiance over the distance is that of the transmittance.
                let slope = extinction * (-extinction * (found - slack).max(0.0)).exp();
                radiance = radiance.max((lit(found) - expected).abs() / (slope * slack));
            }
        }
    }
    println!(
        "resolved depth: radiance {radiance:.2}, mean distance {means:.2} of their budgets; {mixed} mixed"
    );
    assert!(radiance <= 1.0 && means <= 1.0 && mixed > 3000, "{radiance} {means} {mixed}");
}

#[test]
fn depth_textures_resolve_like_floats() {
    let _turn = gpu::turn();
    let size = [16_u32, 12];
    let mut random = Random(3);
    let camera = gpu::host_camera(&random.camera(4.0 / 3.0), size);
    let depths: Vec<f32> = (0..16 * 12 * 4).map(|_| random.unit() as f32).collect();
    let samples = multisampled(size, &depths);
    let buffer = Buffer::uniform(gpu(), &camera);
    let choice = SampleChoice::Mean { extinction: 0.1, distance_limit: 50.0 };
    let floats = ResolveDepth::new(gpu(), shaders(), choice, size).unwrap();
    let bound = floats.bind(gpu(), &buffer, &samples).unwrap();
    submit(|encoder| floats.record(encoder, &bound));
    let parameters = airlight::core::ResolveDepthParameters {
        extinction: 0.1,
        distance_limit: 50.0,
        reserved_a: 0.0,
        reserved_b: 0.0,
    };
    let parameters = Buffer::uniform(gpu(), &parameters);
    let definitions = Definitions::new().flag("DEPTH_TEXTURE");
    let pass = Pass::compute_with(gpu(), shaders(), "core/resolve_depth", &definitions).unwrap();
    let resolved = Texture::storage(gpu(), size, R32Float);
    let bound = pass.bind(
        gpu(),
        &[
            ("camera", (&buffer).into()),
            ("parameters", (&parameters).into()),
            ("samples", (&samples).into()),
            ("resolved", (&resolved).into()),
        ],
    );
    let bound = bound.unwrap();
    submit(|encoder| pass.dispatch(encoder, &bound, [size[0], size[1], 1]));
    assert_eq!(resolved.read(gpu()).unwrap(), floats.depth.read(gpu()).unwrap());
}
