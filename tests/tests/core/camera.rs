// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cameras of the core on the GPU against f64, within stated error budgets: rays, distances and depths along
//! them, planes, and depths of several samples.

use crate::gpu::{self, Probe, Random};
use crate::probing::{MATRIX_AT, f, hold, triple, worst};
use airlight::core::Camera;
use airlight_tests::linear::{Mat4, Vec3};
use airlight_tests::reference::camera::Camera as ReferenceCamera;

const CAMERA: &str = "#import airlight::core::camera::{
        Camera, view_ray, perspective_ray, ndc_from_pixel, distance_from_depth, perspective_distance, matrix_row, side_normal, forward_direction,
        far_plane_distance
    }
    fn camera_at() -> Camera {
        return Camera(
            matrix_at(0u), matrix_at(16u), vec3<f32>(input(32u), input(33u), input(34u)), input(35u),
            vec2<f32>(input(36u), input(37u)), input(38u), u32(input(39u))
        );
    }
    fn output_vector(first: u32, v: vec3<f32>) {
        output(first, v.x); output(first + 1u, v.y); output(first + 2u, v.z);
    }";

/// Imports, and a camera from the first 40 numbers of a record.
fn camera_head() -> String {
    format!("{CAMERA}{MATRIX_AT}")
}

fn camera_words(camera: &Camera) -> Vec<f32> {
    let mut words = camera.clip_from_world.to_cols_array().to_vec();
    words.extend(camera.world_from_clip.to_cols_array());
    words.extend(camera.eye.to_array());
    words.extend([camera.near_depth, camera.viewport.x, camera.viewport.y, camera.far_depth]);
    words.push(camera.projection as f32);
    words
}

/// A light's matrix is that of an orthographic camera that looks away from the light. Its eye is nowhere.
fn orthographic_camera(clip_from_world: Mat4, far_depth: f64) -> Camera {
    Camera {
        clip_from_world: gpu::host_matrix(clip_from_world),
        world_from_clip: gpu::host_matrix(clip_from_world.inverse().unwrap()),
        eye: glam::Vec3::splat(1e3),
        near_depth: 1.0 - far_depth as f32,
        viewport: glam::Vec2::new(96.0, 64.0),
        far_depth: far_depth as f32,
        projection: 1,
    }
}

#[test]
fn rays_distances_and_planes_of_perspective_cameras() {
    const LIMIT: f64 = 500.0;
    let probe = Probe {
        head: &camera_head(),
        body: "let camera = camera_at();
               let ndc = ndc_from_pixel(camera, vec2<f32>(input(40u), input(41u)));
               let ray = view_ray(camera, ndc);
               output_vector(0u, ray.origin);
               output_vector(3u, ray.direction);
               let same = perspective_ray(camera, ndc);
               output_vector(30u, same.origin);
               output_vector(33u, same.direction);
               output(36u, perspective_distance(camera, ndc, input(42u), 500.0));
               output(37u, perspective_distance(camera, ndc, camera.far_depth, 500.0));
               output(6u, distance_from_depth(camera, ray, ndc, input(42u), 500.0));
               output(7u, distance_from_depth(camera, ray, ndc, camera.far_depth, 500.0));
               output(8u, ndc.x); output(9u, ndc.y);
               for (var side = 0u; side < 4u; side++) { output_vector(10u + 3u * side, side_normal(camera, side)); }
               output_vector(22u, forward_direction(camera));
               output(25u, far_plane_distance(camera, 500.0));
               output_vector(26u, matrix_row(camera.clip_from_world, 1u).xyz);
               output(29u, matrix_row(camera.clip_from_world, 1u).w);",
        inputs: 43,
        outputs: 38,
    };
    let viewport = [96_usize, 64];
    let mut random = Random(17);
    let (mut inputs, mut cases) = (Vec::new(), Vec::new());
    for _ in 0..2000 {
        let camera = random.camera(1.5);
        let (x, y) = (random.below(viewport[0]), random.below(viewport[1]));
        let ndc = ReferenceCamera::pixel_ndc(x, y, viewport[0], viewport[1]);
        let direction = camera.ray(ndc);
        let distance = random.magnitude(0.5, 100.0).min(0.9 * camera.far);
        let depth = camera.project(camera.eye + direction * distance).unwrap()[2] as f32;
        inputs.extend(camera_words(&gpu::host_camera(&camera, [96, 64])));
        inputs.extend([x as f32 + 0.5, y as f32 + 0.5, depth]);
        cases.push((camera, ndc, direction, distance));
    }
    let found = probe.run(&inputs);
    // The greatest error of each kind in units of its budget.
    let mut errors = [0.0_f64; 8];
    for ((camera, ndc, direction, distance), found) in cases.iter().zip(found.chunks_exact(38)) {
        let mut note = |kind: usize, error: f64, budget: f64| {
            if error / budget > errors[kind] || error.is_nan() {
                errors[kind] = error / budget;
            }
        };
        assert_eq!(found[..6], found[30..36], "perspective_ray");
        assert_eq!(triple(&found[0..3]), gpu::vector(gpu::host_vector(camera.eye)));
        // The far plane is unprojected and the eye taken off: with forward depth the terms that cancel
        // are as large as the eye's distance from the origin over that of the near plane.
        let cancelled = camera.eye.length() / if camera.far_depth > 0.5 { camera.near } else { camera.far };
        note(0, (triple(&found[3..6]) - *direction).length(), 1e-6 + 2e-7 * cancelled);
        note(1, (f(found[8]) - ndc[0]).abs().max((f(found[9]) - ndc[1]).abs()), 5e-7);
        // A depth is as good as f32 resolves it: near 1, forward depth by 6e-8.
        let slant = direction.dot(camera.forward);
        let depth = if camera.far_depth > 0.5 { 4e-7 * distance * distance / camera.near } else { 0.0 };
        let budget = 2e-6 * (distance + camera.eye.length()) + depth * slant.max(0.1) + 1e-5;
        note(2, (f(found[6]) - distance).abs(), budget);
        note(7, (f(found[36]) - distance).abs(), budget + distance * 2e-7 * cancelled);
        // The same at the far plane; beyond the limit the limit stands, exactly.
        let plane = if camera.far_depth > 0.5 { 1e-6 * camera.far / camera.near } else { 1e-5 };
        let sky = camera.far / slant;
        if camera.far.is_infinite() {
            assert_eq!([f(found[7]), f(found[25]), f(found[37])], [LIMIT; 3]);
        } else {
            note(3, (f(found[7]) / sky.min(LIMIT) - 1.0).abs(), plane);
            note(7, (f(found[37]) / sky.min(LIMIT) - 1.0).abs(), plane + 2e-7 * cancelled);
            note(4, (f(found[25]) / camera.far - 1.0).abs(), plane);
        }
        let [bottom, right, top, left] = camera.side_normals();
        for (side, expected) in [left, right, bottom, top].into_iter().enumerate() {
            note(5, (triple(&found[10 + 3 * side..]) - expected).length(), 1e-6);
        }
        note(5, (triple(&found[22..25]) - camera.forward).length(), 1e-6);
        let row = camera.clip_from_world.row(1);
        let row = row.iter().zip(&found[26..30]).map(|(r, f)| (f64::from(*f) - r).abs() / (1.0 + r.abs()));
        note(6, row.fold(0.0, f64::max), 1e-7);
    }
    for (kind, error) in [
        "view_ray",
        "ndc_from_pixel",
        "distance_from_depth",
        "of the far plane",
        "far_plane_distance",
        "normals",
        "matrix_row",
        "perspective_distance",
    ]
    .iter()
    .zip(errors)
    {
        hold(&format!("{kind}, in budgets"), error, 1.0);
    }
}

#[test]
fn depths_beyond_what_a_camera_draws_stay_in_range() {
    let probe = Probe {
        head: &camera_head(),
        body: "let camera = camera_at();
               let ray = view_ray(camera, vec2<f32>(0.3, -0.4));
               output(0u, distance_from_depth(camera, ray, vec2<f32>(0.3, -0.4), input(40u), 50.0));
               output(1u, perspective_distance(camera, vec2<f32>(0.3, -0.4), input(40u), 50.0));",
        inputs: 41,
        outputs: 2,
    };
    let mut random = Random(23);
    let mut inputs = Vec::new();
    for _ in 0..1000 {
        let camera = random.camera(1.5);
        inputs.extend(camera_words(&gpu::host_camera(&camera, [96, 64])));
        inputs.push(random.unit() as f32);
    }
    for distance in probe.run(&inputs) {
        assert!((0.0..=50.0).contains(&distance), "{distance}");
    }
}

#[test]
fn orthographic_cameras_look_along_parallel_rays() {
    let probe = Probe {
        head: &camera_head(),
        body: "let camera = camera_at();
               let ndc = ndc_from_pixel(camera, vec2<f32>(input(40u), input(41u)));
               let ray = view_ray(camera, ndc);
               output_vector(0u, ray.origin);
               output_vector(3u, ray.direction);
               output(6u, distance_from_depth(camera, ray, ndc, input(42u), 500.0));",
        inputs: 43,
        outputs: 7,
    };
    let mut random = Random(29);
    let (mut inputs, mut cases) = (Vec::new(), Vec::new());
    for _ in 0..500 {
        let (towards, centre) = (random.direction(), random.direction() * random.between(0.0, 20.0));
        let (half, reversed) = (random.between(1.0, 30.0), random.unit() < 0.5);
        let far_depth = if reversed { 0.0 } else { 1.0 };
        let clip = gpu::light_matrix(towards, centre, half, far_depth);
        let camera = orthographic_camera(clip, far_depth);
        let (x, y) = (random.below(96), random.below(64));
        let ndc = ReferenceCamera::pixel_ndc(x, y, 96, 64);
        let [px, py, pz, _] = clip.inverse().unwrap().apply([ndc[0], ndc[1], 1.0 - far_depth, 1.0]);
        let distance = random.between(0.0, 2.0 * half);
        let depth = if reversed { 1.0 - distance / (2.0 * half) } else { distance / (2.0 * half) };
        inputs.extend(camera_words(&camera));
        inputs.extend([x as f32 + 0.5, y as f32 + 0.5, depth as f32]);
        cases.push((Vec3::new(px, py, pz), -towards, distance, half));
    }
    let found = probe.run(&inputs);
    let (mut origin, mut direction, mut along) = (0.0_f64, 0.0_f64, 0.0_f64);
    for ((from, towards, distance, half), found) in cases.iter().zip(found.chunks_exact(7)) {
        let size = half + from.length();
        origin = origin.max((triple(found) - *from).length() / size);
        direction = direction.max((triple(&found[3..]) - *towards).length() * half / size);
        along = along.max((f(found[6]) - distance).abs() / size);
    }
    hold("orthographic origin, of the scene's size", origin, 1e-6);
    hold("orthographic direction", direction, 1e-6);
    hold("orthographic distance, of the scene's size", along, 1e-6);
}

#[test]
fn viewers_are_where_the_camera_says() {
    let probe = Probe {
        head: &camera_head().replace("ndc_from_pixel,", "ndc_from_pixel, towards_viewer,"),
        body: "output_vector(0u, towards_viewer(camera_at(), vec3<f32>(input(40u), input(41u), input(42u))));",
        inputs: 43,
        outputs: 3,
    };
    let mut random = Random(47);
    let (mut inputs, mut cases) = (Vec::new(), Vec::new());
    for case in 0..400 {
        let point = random.direction() * random.between(0.0, 9.0);
        let (camera, expected);
        if case % 2 == 0 {
            let reference = random.camera(1.5);
            camera = gpu::host_camera(&reference, [96, 64]);
            expected = (reference.eye - point).normalised();
        } else {
            let towards = random.direction();
            let far_depth = if case % 4 == 1 { 0.0 } else { 1.0 };
            let matrix = gpu::light_matrix(towards, point, random.between(1.0, 9.0), far_depth);
            let eye = gpu::host_vector(random.camera(1.5).eye);
            camera = Camera { eye, ..orthographic_camera(matrix, far_depth) };
            expected = towards;
        }
        inputs.extend(camera_words(&camera));
        inputs.extend(gpu::host_vector(point).to_array());
        cases.push(expected);
    }
    let found = probe.run(&inputs);
    let error = worst(
        cases
            .iter()
            .zip(found.chunks_exact(3))
            .map(|(e, found)| ((triple(found).normalised() - *e).length(), 0.0)),
    );
    hold("towards_viewer", error, 1e-4);
}

// Depths on a ray, and of several samples.

#[test]
fn depths_and_distances_on_a_ray_are_those_of_the_camera() {
    let head = camera_head().replace(
        "#import airlight::core::camera",
        "#import airlight::core::ray_depth::{ray_depth, distance_on_ray, depth_on_ray}
         #import airlight::core::camera",
    );
    let probe = Probe {
        head: &head,
        body: "let camera = camera_at();
               let ndc = vec2<f32>(input(40u), input(41u));
               let ray = ray_depth(camera, view_ray(camera, ndc), ndc);
               output(0u, distance_on_ray(ray, input(42u), 500.0));
               output(1u, depth_on_ray(ray, input(43u)));
               output(2u, distance_on_ray(ray, depth_on_ray(ray, input(43u)), 500.0));
               output(3u, distance_on_ray(ray, camera.far_depth, 500.0));
               output(4u, depth_on_ray(ray, 0.0));
               output(5u, depth_on_ray(ray, 1e30));",
        inputs: 44,
        outputs: 6,
    };
    let mut random = Random(53);
    let (mut inputs, mut cases) = (Vec::new(), Vec::new());
    for index in 0..2000 {
        let ndc = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)].map(|x| f(x as f32));
        if index % 4 == 0 {
            let (towards, centre) = (random.direction(), random.direction() * random.between(0.0, 20.0));
            let half = random.between(1.0, 30.0);
            let far_depth = if random.unit() < 0.5 { 0.0 } else { 1.0 };
            let clip = gpu::light_matrix(towards, centre, half, far_depth);
            let camera = Camera {
                eye: glam::Vec3::ZERO,
                viewport: glam::Vec2::ONE,
                ..orthographic_camera(clip, far_depth)
            };
            let distance = random.between(0.01, 1.99) * half;
            let along = distance / (2.0 * half);
            let depth = if far_depth > 0.5 { along } else { 1.0 - along };
            inputs.extend(camera_words(&camera));
            inputs.extend([ndc[0] as f32, ndc[1] as f32, depth as f32, distance as f32]);
            let size = half + centre.length();
            cases.push((
                distance,
                2e-6 * size,
                depth,
                2e-6 * size / half,
                2.0 * half,
                far_depth,
                size / half,
            ));
        } else {
            let camera = random.camera(1.5);
            let direction = camera.ray(ndc);
            let distance = random.magnitude(0.5, 100.0).min(0.9 * camera.far);
            let depth = camera.project(camera.eye + direction * distance).unwrap()[2];
            inputs.extend(camera_words(&gpu::host_camera(&camera, [96, 64])));
            inputs.extend([ndc[0] as f32, ndc[1] as f32, depth as f32, distance as f32]);
            // As for distance_from_depth: forward depth resolves what f32 resolves next to 1, and the far
            // plane is unprojected and the eye taken off.
            let cancelled =
                camera.eye.length() / if camera.far_depth > 0.5 { camera.near } else { camera.far };
            let resolved =
                if camera.far_depth > 0.5 { 4e-7 * distance * distance / camera.near } else { 0.0 };
            let budget =
                2e-6 * (distance + camera.eye.length()) + resolved + distance * 2e-7 * cancelled + 1e-5;
            let of_depth = 3e-7 + (2e-6 + 2e-7 * cancelled) * (1.0 - depth).min(depth).abs();
            let sky = camera.far / direction.dot(camera.forward);
            cases.push((distance, budget, depth, of_depth, sky, camera.far_depth, 0.0));
        }
    }
    let found = probe.run(&inputs);
    let mut errors = [0.0_f64; 4];
    for ((distance, budget, depth, of_depth, sky, far_depth, size), found) in
        cases.iter().zip(found.chunks_exact(6))
    {
        let mut note = |kind: usize, error: f64| {
            if error > errors[kind] || error.is_nan() {
                errors[kind] = error;
            }
        };
        note(0, (f(found[0]) - distance).abs() / budget);
        note(1, (f(found[1]) - depth).abs() / of_depth);
        note(2, (f(found[2]) - distance).abs() / (2.0 * budget));
        let plane = if *far_depth > 0.5 { 1e-3 } else { 1e-4 };
        note(3, (f(found[3]) / sky.min(500.0) - 1.0).abs() / plane);
        assert!((f(found[4]) - (1.0 - far_depth)).abs() <= 2e-6 * size, "depth at the eye: {}", found[4]);
        assert!((f(found[5]) - far_depth).abs() < 1e-6, "depth at infinity: {}", found[5]);
    }
    for (kind, error) in
        ["distance_on_ray", "depth_on_ray", "there and back", "of the far plane"].iter().zip(errors)
    {
        hold(&format!("{kind}, in budgets"), error, 1.0);
    }
}

#[test]
fn distances_of_mean_transmittance() {
    let probe = Probe {
        head: "#import airlight::core::resolve_depth::{averaging_extinction, distance_of_transmittance}",
        body: "let nearest = min(input(0u), input(1u));
               let farthest = max(input(0u), input(1u));
               let extinction = averaging_extinction(input(2u), nearest, farthest);
               let mean = 0.5 * (exp(-extinction * (input(0u) - nearest)) + exp(-extinction * (input(1u) - nearest)));
               output(0u, distance_of_transmittance(nearest, extinction, mean));
               output(1u, distance_of_transmittance(nearest, extinction, 0.0));",
        inputs: 3,
        outputs: 2,
    };
    let mut random = Random(61);
    let mut inputs: Vec<f32> = (0..2000)
        .flat_map(|_| {
            let extinction = if random.unit() < 0.2 { 0.0 } else { random.magnitude(1e-9, 1e2) };
            [random.magnitude(1e-2, 1e3), random.magnitude(1e-2, 1e3), extinction].map(|x| x as f32)
        })
        .collect();
    inputs.extend([5.0, 5.0, 0.0, 0.0, 0.0, 1e6, 0.0, 1e7, 1e6]);
    let found = probe.run(&inputs);
    let error = worst(inputs.chunks_exact(3).zip(found.chunks_exact(2)).map(|(input, found)| {
        let [a, b, extinction] = [0, 1, 2].map(|i| f(input[i]));
        assert!(found.iter().all(|x| x.is_finite()), "{input:?}: {found:?}");
        let spread = (a - b).abs();
        let expected = if extinction * spread < 1e-7 {
            0.5 * (a + b)
        } else {
            let nearest = a.min(b);
            // ln((1 + e^-x) / 2) without cancellation.
            nearest - (0.5 * (-extinction * spread).exp_m1()).ln_1p() / extinction
        };
        ((f(found[0]) - expected).abs() / (2e-4 * spread + 2e-7 * a.max(b) + 1e-30), 0.0)
    }));
    hold("distance_of_transmittance, in 2e-4 of the spread", error, 1.0);
}
