// SPDX-License-Identifier: MIT OR Apache-2.0
//! Single scattering on the GPU against the f64 references, closed forms and invariants.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;

use airlight::scattering::{
    Along, BasisFormat, Frame, Inputs, March, Medium, Prefiltered, Rectification, Settings, Visibility,
    Weighting,
};
use airlight::{Buffer, Stage, Texture, scenes};
use airlight_tests::error;
use airlight_tests::linear;
use airlight_tests::reference::camera::{Camera as ReferenceCamera, View};
use airlight_tests::reference::scattering as reference;
use glam::Vec3;
use gpu::{Random, gpu, shaders};
use std::f64::consts::PI;
use std::sync::OnceLock;
use wgpu::TextureFormat::R32Float;

/// Size of the pictures whose figures are asked for.
const PICTURE: [u32; 2] = [480, 270];

/// A scene of the gallery on the GPU with its rectified map and exact picture.
struct Case {
    stage: Stage,
    map: Rectification,
    exact: reference::Picture,
    view: airlight::core::PerspectiveView,
}

impl Case {
    fn new(name: &str, picture: [u32; 2], map: [u32; 2]) -> Self {
        let scene = scenes::scene(name).unwrap().unwrap();
        let view = scene.view.perspective().unwrap();
        let stage = Stage::new(gpu(), gpu::raster(), &scene.setting(), picture, [1024, 1024]).unwrap();
        let map = rectified(&stage.inputs(), map);
        let exact = gpu::exact_picture(&stage, &view, &map, 1);
        Self { stage, map, exact, view }
    }
}

fn foliage() -> &'static Case {
    static CASE: OnceLock<Case> = OnceLock::new();
    CASE.get_or_init(|| Case::new("foliage", PICTURE, [512, 512]))
}

fn plane() -> &'static Case {
    static CASE: OnceLock<Case> = OnceLock::new();
    CASE.get_or_init(|| Case::new("plane", PICTURE, [512, 512]))
}

fn rectified(inputs: &Inputs<'_>, map: [u32; 2]) -> Rectification {
    let rectification = Rectification::new(gpu(), shaders(), map).unwrap();
    let bound = rectification.bind(gpu(), inputs).unwrap();
    let mut encoder = gpu().encoder();
    rectification.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    rectification
}

/// Visibility, and radiance as three values a pixel.
struct Scattered {
    visibility: Vec<f32>,
    radiance: Vec<f32>,
}

fn scattered(texture: &Texture) -> Scattered {
    let values = texture.read(gpu()).unwrap();
    Scattered {
        visibility: values.chunks_exact(4).map(|texel| texel[3]).collect(),
        radiance: values.chunks_exact(4).flat_map(|texel| texel[..3].to_vec()).collect(),
    }
}

fn prefiltered(inputs: &Inputs<'_>, settings: Settings, picture: [u32; 2]) -> Scattered {
    let method = Prefiltered::new(gpu(), shaders(), settings, picture).unwrap();
    let bound = method.bind(gpu(), inputs).unwrap();
    let mut encoder = gpu().encoder();
    method.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    scattered(&method.scattered)
}

fn marched(inputs: &Inputs<'_>, along: &Along<'_>, weighting: Weighting, picture: [u32; 2]) -> Scattered {
    let method = March::new(gpu(), shaders(), along, weighting, picture).unwrap();
    let bound = method.bind(gpu(), inputs, along).unwrap();
    let mut encoder = gpu().encoder();
    method.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    scattered(&method.scattered)
}

// (a) Frame and slices.

#[test]
fn frame_and_slices_are_those_of_the_reference() {
    let _turn = gpu::turn();
    const ROWS: usize = 64;
    let limit = 80.0_f64;
    let map = Rectification::new(gpu(), shaders(), [8, ROWS as u32]).unwrap();
    let (depth, shadow) = (gpu::texture([1, 1], R32Float, &[1.0]), gpu::texture([1, 1], R32Float, &[1.0]));
    let medium = Medium::new(0.1, Vec3::ONE, 0.0, limit as f32).unwrap();
    let mut random = Random(11);
    let camera = random.camera(1.5);
    let camera_buffer = Buffer::uniform(gpu(), &gpu::host_camera(&camera, [96, 64]));
    let light_buffer = Buffer::uniform(
        gpu(),
        &gpu::host_light(camera.up, gpu::light_matrix(camera.up, camera.eye, 20.0, 1.0), 1.0, Vec3::ONE),
    );
    let inputs = Inputs {
        camera: &camera_buffer,
        light: &light_buffer,
        medium: &Buffer::uniform(gpu(), &medium),
        depth: &depth,
        shadow_map: &shadow,
        shadow_views: None,
        shadow_maps: None,
        light_texture: None,
    };
    let bound = map.bind(gpu(), &inputs).unwrap();
    let (mut slices, mut skipped, mut circles, mut borders) = (0, 0, 0, 0);
    // The greatest error of each kind, in units of its budget.
    let mut worst = [0.0_f64; 4];
    for index in 0..200 {
        let aspect = random.between(0.5, 2.5);
        let camera = random.camera(aspect);
        let mut light = random.light(&camera);
        if random.unit() < 0.1 {
            // Barely outside of the picture, where some slices miss it.
            let corner = camera.corners()[random.below(4)];
            light = camera.forward + (corner - camera.forward) * random.between(1.0, 1.001);
        }
        camera_buffer.write(gpu(), &gpu::host_camera(&camera, [96, 64]));
        let matrix = gpu::light_matrix(light, camera.eye, 20.0, 1.0);
        light_buffer.write(gpu(), &gpu::host_light(light, matrix, 1.0, Vec3::ONE));
        let mut encoder = gpu().encoder();
        map.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        let frame = map.frame.read_floats(gpu()).unwrap();
        let texels = map.slices.read(gpu()).unwrap();
        let rounded = gpu::vector(gpu::host_vector(light));
        let expected = reference::Rectification::new(&camera, rounded, limit, 8, ROWS);

        // At the border of the cases f32 may choose the other one: both are right there.
        let sides = camera.side_normals().map(|n| n.dot(expected.frame.l));
        let least = sides.into_iter().fold(f64::INFINITY, f64::min);
        let greatest = sides.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let off_axis = camera.forward.without(expected.frame.l).length();
        let near = |a: f64, b: f64| (a - b).abs() < 1e-5;
        if near(least, -1e-3) || near(greatest, 1e-3) || near(off_axis, 1e-3) {
            borders += 1;
            continue;
        }
        let at = |index: usize| f64::from(frame[index]);
        let axis = |index: usize| linear::Vec3::new(at(index), at(index + 1), at(index + 2));
        assert_eq!(at(15) > 0.5, expected.full_circle, "camera {index}: wrapping; {least} {greatest}");
        circles += usize::from(expected.full_circle);
        // Axes: f32 over the length that is normalised.
        let axes = if off_axis < 1e-3 { 1e-5 } else { 1e-6 + 1e-6 / off_axis };
        for (found, wanted) in
            [(axis(0), expected.frame.l), (axis(4), expected.frame.a), (axis(8), expected.frame.b)]
        {
            worst[0] = worst[0].max((found - wanted).length() / axes);
        }
        assert!((axis(12) - camera.eye).length() < 1e-5);
        assert_eq!(at(11), ROWS as f64);
        // Rows: azimuths of corners next to the light are as good as their distance from it.
        let closest = camera
            .corners()
            .map(|d| expected.frame.polar_direction(d).theta.sin())
            .into_iter()
            .fold(1.0, f64::min);
        let turn = axes + if expected.full_circle { 1e-6 } else { 3e-6 / closest.max(1e-6) };
        let rows = expected.slices.len();
        for j in 0..rows {
            let azimuth = at(3) + j as f64 / at(7);
            worst[1] = worst[1].max((azimuth - expected.slices[j].phi).abs() / (2.0 * turn));
        }
        // Bounds.
        for (j, (slice, texel)) in expected.slices.iter().zip(texels.chunks_exact(4)).enumerate() {
            assert!(texel.iter().all(|x| x.is_finite()), "camera {index}, slice {j}: {texel:?}");
            let radial = expected.frame.radial(slice.phi);
            let planes = camera.side_normals().map(|n| n.dot(expected.frame.l).hypot(n.dot(radial)));
            let flattest = planes.into_iter().filter(|p| *p > 5e-5).fold(1.0, f64::min);
            if planes.iter().any(|p| (*p / 1e-4 - 1.0).abs() < 0.5) {
                skipped += 1;
                continue;
            }
            // A slice that misses the picture next to a light in the plane of a side: its bounds cross
            // the other way round with the sign of rounding.
            let missed = slice.theta_max - slice.theta_min < 1.01e-3;
            if missed && camera.side_normals().iter().any(|n| n.dot(expected.frame.l).abs() < 1e-4) {
                skipped += 1;
                continue;
            }
            slices += 1;
            // The convention: a slice of the least width lies inside [0, pi].
            let shift = (0.0 - slice.theta_min).max(0.0) - (slice.theta_max - PI).max(0.0);
            let angle = (2.0 * turn + 1e-6) / flattest;
            let error = (f64::from(texel[0]) - slice.theta_min - shift)
                .abs()
                .max((f64::from(texel[1]) - slice.theta_max - shift).abs());
            if error / angle > 1.0 {
                println!("camera {index}, slice {j}: {texel:?} instead of {slice:?}, budget {angle:.1e}");
            }
            worst[2] = worst[2].max(error / angle);
            if !missed {
                // The far plane as f32 matrices hold it, and the angle of the rays that reach it.
                let plane = if camera.far.is_finite() && camera.far_depth > 0.5 {
                    camera.far / camera.near
                } else {
                    1.0
                };
                let slant = camera.corners().map(|d| d.dot(camera.forward)).into_iter().fold(1.0, f64::min);
                let steep = slice.theta_min.sin().min(slice.theta_max.sin()).max(1e-3);
                let radius = 1e-6 * plane + 1e-5 + angle / slant / steep;
                worst[3] = worst[3].max((f64::from(texel[2]) / slice.r_max - 1.0).abs() / radius);
                let reference = (f64::from(texel[3]) - slice.k()).abs();
                worst[3] = worst[3].max(reference / (1e-6 + 2.0 * angle / slice.k_min.max(0.1)));
            }
        }
    }
    println!("slices: {slices} compared, {skipped} skipped, {circles} full circles, {borders} at borders");
    println!("worst error over budget: axes, rows, angles, radii and reference: {worst:?}");
    assert!(circles >= 60 && borders <= 20 && skipped < slices / 4, "the random cases are not varied enough");
    assert!(worst.iter().all(|w| *w <= 1.0), "{worst:?}");
}

// (b) The rectified map.

#[test]
fn rectified_maps_are_those_of_the_reference() {
    let _turn = gpu::turn();
    let torus = gpu::torus_over_plane();
    let tree = gpu::small_tree();
    let cases: [(&str, &Stage, _, &Rectification); 2] = [
        ("foliage", &foliage().stage, foliage().view, &foliage().map),
        ("plane", &plane().stage, plane().view, &plane().map),
    ];
    let small =
        [(torus.stage(PICTURE, [512, 512]), torus.view), (tree.stage(PICTURE, [512, 512]), tree.view)]
            .map(|(stage, view)| (rectified(&stage.inputs(), [512, 256]), stage, view));
    let small =
        small.iter().zip(["torus", "tree"]).map(|((map, stage, view), name)| (name, stage, *view, map));
    for (name, stage, view, map) in cases.into_iter().chain(small) {
        let camera = gpu::reference_camera(&view, PICTURE);
        let rectification = gpu::read_back(&camera, stage.light.direction, stage.medium.distance_limit, map);
        let shadow_map = stage.pictures.shadow_map.read(gpu()).unwrap();
        let [width, height, _] = stage.pictures.shadow_map.size();
        let expected = reference::rectify(
            &reference::ShadowMap {
                depth: &shadow_map,
                width: width as usize,
                height: height as usize,
                clip_from_world: gpu::matrix(stage.light.clip_from_world),
                far_depth: f64::from(stage.light.far_depth),
            },
            &rectification,
            0.02,
        );
        let found = map.rectified.read(gpu()).unwrap();
        let (mut worst, mut at) = (0.0_f64, 0);
        for (i, (z, texel)) in found.iter().zip(&expected).enumerate() {
            let z = f64::from(*z);
            let beyond = (texel.low - z).max(z - texel.high);
            if beyond > worst || beyond.is_nan() {
                (worst, at) = (beyond, i);
            }
        }
        let total = expected.len() as f64;
        let ambiguous = expected.iter().filter(|t| t.ambiguous).count() as f64 / total;
        let spread = expected.iter().filter(|t| t.high - t.low > 1e-3).count() as f64 / total;
        let blocked = found.iter().filter(|z| **z < 1.0).count() as f64 / total;
        println!(
            "rectified {name}: worst {worst:.2e}, {:.1} % within 0.02 texel of an edge, {:.1} % where it matters, {:.0} % blocked",
            100.0 * ambiguous,
            100.0 * spread,
            100.0 * blocked
        );
        let texel = expected[at];
        assert!(worst <= 1e-4, "{name}: texel {at}: {} beyond {texel:?}", found[at]);
        assert!(ambiguous < 0.1 && blocked > 0.02, "{name}");
    }
}

// (c) The march.

/// Exact visibility over the row that is nearest to each pixel's azimuth.
fn nearest_row(case: &Case) -> (Vec<f64>, Vec<f64>) {
    let map = case.map.rectified.read(gpu()).unwrap();
    let extinction = f64::from(case.stage.medium.extinction);
    let pixels = gpu::of_pixels(&case.stage, &case.view, &case.map, |rectification, ray| {
        let j = ray.nearest();
        let row = &map[j * rectification.width..(j + 1) * rectification.width];
        reference::row_visibility(row, ray.end(rectification, j, extinction))
    });
    (pixels.iter().map(|p| p.average).collect(), pixels.iter().map(|p| p.weighted).collect())
}

#[test]
fn march_along_rows_is_the_exact_sum_over_the_nearest_row() {
    let _turn = gpu::turn();
    let case = foliage();
    let (average, weighted) = nearest_row(case);
    for (weighting, expected) in [(Weighting::Average, average), (Weighting::Transmittance, weighted)] {
        let found = marched(&case.stage.inputs(), &Along::Rows(&case.map), weighting, PICTURE).visibility;
        let mean = error::mean_absolute(&found, &expected);
        // Half floats hold 0..1 to 4.9e-4, for this adapter rounds towards zero; one texel more or less where z ties, or another row where two are as near.
        let off = found.iter().zip(&expected).filter(|(f, e)| (f64::from(**f) - **e).abs() > 2e-3).count();
        let share = off as f64 / found.len() as f64;
        println!(
            "march along rows, {}: mean {mean:.2e}, {:.2} % off by more than 2e-3, {}",
            gpu::weighting_name(weighting),
            100.0 * share,
            error::worst(&found, &expected, PICTURE[0] as usize).unwrap()
        );
        assert!(mean < 4e-4 && share < 0.005);
    }
}

/// A level view over a directional light from straight above, with a shadow map of the test's.
struct Synthetic {
    view: airlight::core::PerspectiveView,
    stage: Stage,
}

impl Synthetic {
    const PICTURE: [u32; 2] = [160, 90];

    /// `blocked`: whether the light ray at x, z is blocked high above everything.
    fn new(medium: Medium, light: Vec3, blocked: impl Fn(f64, f64) -> bool) -> Self {
        let scene = gpu::torus_over_plane();
        let mut view = scene.view;
        (view.eye, view.target) = (Vec3::new(-3.0, 0.0, 0.0), Vec3::new(0.0, 0.4, 0.3));
        view.far = medium.distance_limit;
        let mut stage = scene.stage(Self::PICTURE, [64, 64]);
        stage.camera = airlight::core::Camera::perspective(&view, Self::PICTURE).unwrap();
        stage.medium = medium;
        let towards = gpu::vector(light);
        let matrix = gpu::light_matrix(towards, linear::Vec3::new(0.0, 0.0, 0.0), 64.0, 1.0);
        stage.light = gpu::host_light(towards, matrix, 1.0, Vec3::new(10.0, 9.0, 8.0));
        stage.camera_buffer = Buffer::uniform(gpu(), &stage.camera);
        stage.light_buffer = Buffer::uniform(gpu(), &stage.light);
        stage.medium_buffer = Buffer::uniform(gpu(), &stage.medium);
        let size = 2048;
        let inverse = matrix.inverse().unwrap();
        let mut texels = vec![1.0_f32; size * size];
        for (i, texel) in texels.iter_mut().enumerate() {
            let ndc = ReferenceCamera::pixel_ndc(i % size, i / size, size, size);
            let [x, _, z, _] = inverse.apply([ndc[0], ndc[1], 0.5, 1.0]);
            if blocked(x, z) {
                *texel = 0.0;
            }
        }
        stage.pictures.shadow_map = gpu::texture([size as u32; 2], R32Float, &texels);
        // A wall far away on one side, nothing on the other.
        let [width, height] = Self::PICTURE.map(|side| side as usize);
        let camera = gpu::reference_camera(&view, Self::PICTURE);
        let depth: Vec<f32> = (0..width * height)
            .map(|i| {
                if i % width < width / 2 {
                    return 1.0;
                }
                let direction = camera.pixel_ray(i % width, i / width, width, height);
                camera.project(camera.eye + direction * 9.0).unwrap()[2] as f32
            })
            .collect();
        stage.pictures.depth = gpu::texture(Self::PICTURE, R32Float, &depth);
        Self { view, stage }
    }

    /// Direction and length of each pixel's ray.
    fn rays(&self) -> Vec<(linear::Vec3, f64)> {
        let [width, height] = Self::PICTURE.map(|side| side as usize);
        let camera = gpu::reference_camera(&self.view, Self::PICTURE);
        let depth = self.stage.pictures.depth.read(gpu()).unwrap();
        let limit = f64::from(self.stage.medium.distance_limit);
        (0..width * height)
            .map(|i| {
                let ndc = ReferenceCamera::pixel_ndc(i % width, i / width, width, height);
                (camera.ray(ndc), camera.distance(ndc, f64::from(depth[i])).min(limit))
            })
            .collect()
    }
}

/// Each way to a picture: name, whether weighted by transmittance, result.
fn all_methods(stage: &Stage, picture: [u32; 2], map: [u32; 2]) -> Vec<(&'static str, bool, Scattered)> {
    let inputs = stage.inputs();
    let rows = rectified(&inputs, map);
    let mut results = Vec::new();
    for weighting in [Weighting::Average, Weighting::Transmittance] {
        let weighted = weighting == Weighting::Transmittance;
        let settings = Settings { map, weighting, ..Settings::default() };
        results.push(("prefiltered", weighted, prefiltered(&inputs, settings, picture)));
        results.push(("rows", weighted, marched(&inputs, &Along::Rows(&rows), weighting, picture)));
        let along = Along::ShadowMap { steps: 2048 };
        results.push(("shadow map", weighted, marched(&inputs, &along, weighting, picture)));
    }
    results
}

#[test]
fn an_empty_shadow_map_lights_everything_and_a_slab_has_its_closed_form() {
    let _turn = gpu::turn();
    let lights = [Vec3::Y, Vec3::new(0.4, 0.3, 0.2).normalize(), Vec3::new(-0.9, -0.2, 0.1).normalize()];
    for (g, extinction, light) in [(0.0, 0.1, lights[0]), (0.7, 0.6, lights[1]), (-0.4, 0.004, lights[2])] {
        let medium = Medium::new(extinction, Vec3::splat(0.8), g, 20.0).unwrap();
        let case = Synthetic::new(medium, light, |_, _| false);
        let rays = case.rays();
        let (medium, light) = (gpu::reference_medium(&medium), gpu::reference_light(&case.stage.light));
        let expected: Vec<f64> =
            rays.iter().flat_map(|(direction, s)| medium.radiance(&light, *direction, *s, 1.0)).collect();
        for (name, weighted, found) in all_methods(&case.stage, Synthetic::PICTURE, [256, 256]) {
            // Bases of 8 bits hold visibility to 2/255; a march but for the step of a half float.
            let budget = if name == "prefiltered" { 2.0 / 255.0 } else { 4.9e-4 };
            let ones = vec![1.0_f32; found.visibility.len()];
            let visibility = error::max_absolute(&found.visibility, &ones);
            let radiance = found
                .radiance
                .iter()
                .zip(&expected)
                .map(|(f, e)| (f64::from(*f) / e - 1.0).abs())
                .fold(0.0, f64::max);
            println!(
                "slab g {g}, {name}, weighted {weighted}: visibility off by {visibility:.1e}, radiance {radiance:.1e}"
            );
            assert!(visibility <= budget, "{name}: {visibility}");
            assert!(radiance <= budget + 1e-3, "{name}: {radiance}");
        }
    }
}

#[test]
fn a_half_plane_blocker_has_its_closed_form() {
    let _turn = gpu::turn();
    let medium = Medium::new(0.15, Vec3::splat(0.8), 0.2, 20.0).unwrap();
    // Everything beyond x = 0 lies in shadow, whatever the height.
    let case = Synthetic::new(medium, Vec3::Y, |x, _| x > 0.0);
    let rays = case.rays();
    let sigma = f64::from(medium.extinction);
    let expected = |weighted: bool| -> Vec<f64> {
        rays.iter()
            .map(|(direction, s)| {
                let lit = if direction.x > 0.0 { (3.0 / direction.x).min(*s) } else { *s };
                if weighted { (-sigma * lit).exp_m1() / (-sigma * s).exp_m1() } else { lit / s }
            })
            .collect()
    };
    for (name, weighted, found) in all_methods(&case.stage, Synthetic::PICTURE, [1024, 1024]) {
        let expected = expected(weighted);
        let mean = error::mean_absolute(&found.visibility, &expected);
        let worst = error::worst(&found.visibility, &expected, Synthetic::PICTURE[0] as usize).unwrap();
        println!("half plane, {name}, weighted {weighted}: mean {mean:.2e}, {worst}");
        // One texel of 1024 of the row, two neighbouring rows; for the series the ringing of one edge.
        let budget = match (name, weighted) {
            ("prefiltered", false) => 4e-3,
            ("prefiltered", true) => 0.012,
            _ => 1e-3,
        };
        assert!(mean <= budget, "{name}, weighted {weighted}: {mean}");
    }
}

// (d) Average visibility by prefiltered bases.

fn average_error(case: &Case, settings: Settings) -> f64 {
    let settings = Settings { map: [512, 512], weighting: Weighting::Average, ..settings };
    let found = prefiltered(&case.stage.inputs(), settings, PICTURE).visibility;
    error::mean_absolute(&found, &case.exact.average())
}

#[test]
fn average_visibility_on_foliage_falls_with_the_bases_to_its_figure() {
    let _turn = gpu::turn();
    let mut previous = f64::INFINITY;
    let mut figures = Vec::new();
    for bases in [4, 8, 16, 32, 64, 128] {
        let found = average_error(foliage(), Settings { bases, ..Settings::default() });
        let half = Settings { bases, format: BasisFormat::Rgba16Float, ..Settings::default() };
        let half = average_error(foliage(), half);
        let plain = average_error(foliage(), Settings { bases, window: false, ..Settings::default() });
        println!(
            "foliage, {bases} bases: {found:.5} rgba8unorm, {half:.5} rgba16float, {plain:.5} without window"
        );
        figures.push((bases, found, half, previous));
        previous = found;
    }
    for (bases, found, half, previous) in figures {
        assert!(found < previous, "{bases} bases: {found} after {previous}");
        assert!(found - half <= 0.002, "{bases} bases: 8 bits add {}", found - half);
        assert!(bases != 32 || found <= 0.005, "{bases} bases: {found}");
    }
}

#[test]
fn average_visibility_on_a_plane_under_an_overhead_light_reaches_its_figure() {
    let _turn = gpu::turn();
    let found = average_error(plane(), Settings::default());
    let half = average_error(plane(), Settings { format: BasisFormat::Rgba16Float, ..Settings::default() });
    let plain = average_error(plane(), Settings { window: false, ..Settings::default() });
    println!("plane, 32 bases: {found:.5} rgba8unorm, {half:.5} rgba16float, {plain:.5} without window");
    assert!(found <= 0.020, "{found}");
    assert!(found - half <= 0.002, "8 bits add {}", found - half);
}

// (e) Radiance.

fn radiance_error(case: &Case, map: [u32; 2]) -> f64 {
    let found = prefiltered(&case.stage.inputs(), Settings { map, ..Settings::default() }, PICTURE).radiance;
    error::relative_rmse(&found, &case.exact.radiance())
}

#[test]
fn radiance_reaches_its_figures() {
    let _turn = gpu::turn();
    let cases = [("foliage", 0.03), ("terrain", 0.03), ("torus", 0.05)];
    let mut failures = Vec::new();
    for (name, budget) in cases {
        for map in [[512, 512], [1024, 1024]] {
            let case = Case::new(name, PICTURE, map);
            let found = radiance_error(&case, map);
            let rows =
                marched(&case.stage.inputs(), &Along::Rows(&case.map), Weighting::Transmittance, PICTURE);
            let rows = error::relative_rmse(&rows.radiance, &case.exact.radiance());
            println!(
                "{name}, map {}x{}: relative RMSE {:.2} % of at most {:.0} %; marched row {:.2} %",
                map[0],
                map[1],
                100.0 * found,
                100.0 * budget,
                100.0 * rows
            );
            if found > budget || found.is_nan() {
                failures.push(format!("{name} {map:?}: {found}"));
            }
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

// (f) Any camera, any light, any input.

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
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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

// (g) Invariants.

#[test]
fn blockers_only_take_light_away() {
    let _turn = gpu::turn();
    for scene in [gpu::torus_over_plane(), gpu::small_tree()] {
        let picture = [120, 80];
        let mut stage = scene.stage(picture, [256, 256]);
        let with = all_methods(&stage, picture, [128, 128]);
        stage.pictures.shadow_map = gpu::texture([8, 8], R32Float, &[1.0; 64]);
        let without = all_methods(&stage, picture, [128, 128]);
        for ((name, weighted, shadowed), (_, _, lit)) in with.iter().zip(&without) {
            let over = shadowed.radiance.iter().zip(&lit.radiance).map(|(s, l)| s - l * (1.0 + 2.0 / 255.0));
            let over = over.fold(0.0, f32::max);
            assert!(over <= 1e-3, "{name}, weighted {weighted}: {over} more with blockers");
            let dark = shadowed.visibility.iter().filter(|v| **v < 0.98).count();
            assert!(dark > shadowed.visibility.len() / 20, "{name}: the blockers block nothing");
        }
    }
}

#[test]
fn thicker_air_scatters_more_of_a_lit_ray() {
    let _turn = gpu::turn();
    let scene = gpu::torus_over_plane();
    let picture = [60, 40];
    let mut stage = scene.stage(picture, [64, 64]);
    stage.pictures.shadow_map = gpu::texture([8, 8], R32Float, &[1.0; 64]);
    let mut before = vec![0.0_f32; 60 * 40 * 3];
    for extinction in [0.0, 1e-3, 1e-2, 0.1, 1.0, 10.0] {
        stage.medium.extinction = extinction;
        stage.medium_buffer.write(gpu(), &stage.medium);
        let settings = Settings { map: [64, 64], ..Settings::default() };
        let now = prefiltered(&stage.inputs(), settings, picture).radiance;
        assert!(
            now.iter().zip(&before).all(|(n, b)| *n >= b * (1.0 - 2.0 / 255.0)),
            "extinction {extinction}"
        );
        assert!(extinction > 0.0 || now.iter().all(|n| *n == 0.0));
        before = now;
    }
}

#[test]
fn layout_of_the_frame_in_memory_is_the_twin() {
    // The tests above read the frame by position.
    use encase::ShaderType;
    assert_eq!(u64::from(Frame::min_size()), 128);
}
