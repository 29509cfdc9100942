// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every public function of the core modules, evaluated on the GPU and held to its f64 reference
//! within a stated error budget; and scans of any length.
//!
//! `--nocapture` prints the measured errors next to the budgets.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;

use airlight::core::{Scan, ShadowViews};
use airlight::{Buffer, Texture};
use airlight_tests::linear::Vec3;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::{fourier, light, phase, prefix_sum, scattering};
use gpu::{Probe, Random, gpu, shaders};
use std::f64::consts::PI;

/// Every function of the core modules, by the test that holds it.
const COVERED: [(&str, &[&str]); 12] = [
    (
        "camera",
        &[
            "ndc_from_pixel",
            "view_ray",
            "perspective_ray",
            "towards_viewer",
            "distance_from_depth",
            "perspective_distance",
            "matrix_row",
            "side_normal",
            "forward_direction",
            "far_plane_distance",
        ],
    ),
    ("color", &["luminance", "tone_curve", "srgb_from_linear"]),
    ("finite", &["is_finite", "finite_or", "finite_or_rgb"]),
    (
        "fourier_basis",
        &[
            "guarded",
            "sine_cosine",
            "rotate",
            "series_at",
            "series_first",
            "series_next",
            "coefficients",
            "coefficients_lanczos",
            "coefficient_scale",
            "stored_from_basis",
            "basis_from_stored",
            "surface_bias",
        ],
    ),
    (
        "light",
        &[
            "direction_to_light",
            "angular_falloff",
            "light_falloff",
            "texels_from_clip",
            "point_from_texels",
            "shadow_position",
            "shadow_point",
            // Takes a texture: tests/tests/stage.rs holds it by what it does to surfaces.
            "light_texture_color",
        ],
    ),
    ("phase", &["isotropic", "henyey_greenstein"]),
    ("prefix_sum", &["row_weights", "row_weights_next", "running_mean", "one_minus_exp", "prefix_weight"]),
    ("shadow_views", &["view_contains", "or_in_view", "clip_in_views", "view_position", "point_at_depth"]),
    ("jitter", &["gradient_noise_offset", "blue_noise_offset"]),
    ("ray_depth", &["ray_depth", "distance_on_ray", "depth_on_ray"]),
    ("resolve_depth", &["averaging_extinction", "distance_of_transmittance"]),
    ("picture", &["picture_corner"]),
];

#[test]
fn every_function_of_the_core_has_a_test_here() {
    let mut functions = Vec::new();
    for module in airlight_wgsl::MODULES.iter().filter(|module| module.file.starts_with("core/")) {
        let name = module.path.rsplit("::").next().unwrap();
        for line in module.source.lines() {
            if let Some(rest) = line.strip_prefix("fn ") {
                functions.push((name, rest.split('(').next().unwrap()));
            }
        }
    }
    let covered: Vec<_> =
        COVERED.iter().flat_map(|(module, names)| names.iter().map(move |name| (*module, *name))).collect();
    let missing: Vec<_> = functions.iter().filter(|function| !covered.contains(function)).collect();
    let gone: Vec<_> = covered.iter().filter(|function| !functions.contains(function)).collect();
    assert!(missing.is_empty() && gone.is_empty(), "without a test: {missing:?}; no longer there: {gone:?}");
}

/// Prints and holds a measured error.
fn hold(what: &str, error: f64, budget: f64) {
    println!("{what}: {error:.2e} of at most {budget:.1e}");
    assert!(error <= budget, "{what}: {error:e} exceeds {budget:e}");
}

fn worst(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    pairs.map(|(found, expected)| (found - expected).abs()).fold(0.0, |a, b| if b <= a { a } else { b })
}

fn f(x: f32) -> f64 {
    f64::from(x)
}

/// Depths of all kinds in [0, 1].
fn depths() -> Vec<f32> {
    let mut random = Random(3);
    let mut depths: Vec<f32> = (0..=256).map(|i| i as f32 / 256.0).collect();
    depths.extend((0..2000).map(|_| random.unit() as f32));
    depths.extend([0.05, 0.95, 1e-7, 1.0 - 6e-8, 1.0 / 3.0]);
    depths
}

// Fourier basis.

#[test]
fn bases_are_sines_and_cosines() {
    let probe = Probe {
        head: "#import airlight::core::fourier_basis::{series_at, series_first, series_next, sine_cosine, rotate}",
        body: "for (var g = 0u; g < 32u; g++) {
                   let s = series_at(input(0u), g);
                   for (var k = 0u; k < 4u; k++) { output(4u * g + k, s.basis[k]); }
               }
               var s = series_at(input(0u), 0u);
               for (var g = 0u; g < 32u; g++) {
                   for (var k = 0u; k < 4u; k++) { output(128u + 4u * g + k, s.basis[k]); }
                   s = series_next(s);
               }
               let a = sine_cosine(input(0u) * 100.0 - 50.0);
               let b = rotate(sine_cosine(input(0u)), sine_cosine(0.25));
               output(256u, a.x); output(257u, a.y); output(258u, b.x); output(259u, b.y);
               s = series_first(input(0u));
               for (var g = 0u; g < 32u; g++) {
                   for (var k = 0u; k < 4u; k++) { output(260u + 4u * g + k, s.basis[k]); }
                   s = series_next(s);
               }",
        inputs: 1,
        outputs: 388,
    };
    let depths = depths();
    let found = probe.run(&depths);
    let records = || depths.iter().zip(found.chunks_exact(388)).map(|(z, found)| (f(*z), found));
    for group in [0, 1, 3, 7, 15, 31] {
        // The argument is rounded once: half a unit in the last place of the number of half turns.
        let frequency = f64::from(4 * group as u32 + 3);
        let budget = 1e-6 + 3e-7 * frequency;
        let error = |offset: usize| {
            worst(records().flat_map(|(z, found)| {
                let expected = fourier::basis(128, z)[4 * group..4 * group + 4].to_vec();
                let found = found[offset + 4 * group..][..4].to_vec();
                found.into_iter().map(f).zip(expected)
            }))
        };
        hold(&format!("series_at, group {group}"), error(0), budget);
        hold(&format!("series_next, group {group}"), error(128), 1e-6 + 4e-7 * group as f64 * PI);
        // The turn is four times the first angle, error included.
        hold(&format!("series_first, group {group}"), error(260), 1e-6 + 8e-7 * group as f64 * PI);
    }
    let turns = worst(records().flat_map(|(z, found)| {
        let angle = PI * f((z as f32) * 100.0 - 50.0);
        [(f(found[256]), angle.sin()), (f(found[257]), angle.cos())]
    }));
    // The product may be fused with the difference: one rounding of 100 half turns.
    hold("sine_cosine", turns, 2e-5);
    let rotated = worst(records().flat_map(|(z, found)| {
        let angle = PI * (z + 0.25);
        [(f(found[258]), angle.sin()), (f(found[259]), angle.cos())]
    }));
    hold("rotate", rotated, 1e-6);
}

/// Coefficients, plain and windowed, and the series of a ray and a texel, for M bases.
fn series(m: u32, pairs: &[[f32; 2]]) -> Vec<f32> {
    let body = "let groups = u32(input(2u)) / 4u;
        var ray = series_at(input(0u), 0u);
        var texel = series_at(input(1u), 0u);
        var window = series_at(1.0 / input(2u), 0u);
        var plain = 0.5;
        var lanczos = 0.5;
        for (var g = 0u; g < groups; g++) {
            let a = coefficients(ray, g);
            let b = coefficients_lanczos(ray, window, g, 4u * groups);
            for (var k = 0u; k < 4u; k++) { output(4u * g + k, a[k]); output(128u + 4u * g + k, b[k]); }
            let stored = basis_from_stored(stored_from_basis(texel.basis));
            plain += dot(a, stored);
            lanczos += dot(b, stored);
            ray = series_next(ray); texel = series_next(texel); window = series_next(window);
        }
        output(256u, plain); output(257u, lanczos);
        let scale = coefficient_scale(groups - 1u);
        output(258u, scale.x); output(259u, scale.y);";
    let probe = Probe {
        head: "#import airlight::core::fourier_basis::{
            series_at, series_next, coefficients, coefficients_lanczos, coefficient_scale, stored_from_basis, basis_from_stored
        }",
        body,
        inputs: 3,
        outputs: 260,
    };
    let inputs: Vec<f32> = pairs.iter().flat_map(|[ray, texel]| [*ray, *texel, m as f32]).collect();
    probe.run(&inputs)
}

#[test]
fn coefficients_and_series_are_those_of_the_reference() {
    let mut random = Random(5);
    let pairs: Vec<[f32; 2]> = (0..500).map(|_| [random.unit() as f32, random.unit() as f32]).collect();
    for m in [4_u32, 8, 12, 16, 32, 64, 100, 128] {
        let found = series(m, &pairs);
        let count = m as usize;
        for (window, offset, name) in
            [(fourier::Window::None, 0, "plain"), (fourier::Window::Lanczos, 128, "Lanczos")]
        {
            let records = || pairs.iter().zip(found.chunks_exact(260));
            let coefficients = worst(records().flat_map(|(pair, found)| {
                let expected = fourier::coefficients(count, f(pair[0]), window);
                found[offset..offset + count]
                    .iter()
                    .map(|x| f(*x))
                    .collect::<Vec<_>>()
                    .into_iter()
                    .zip(expected)
            }));
            hold(&format!("coefficients, {name}, {m} bases"), coefficients, 1e-6);
            let at = 256 + usize::from(offset > 0);
            let sums =
                worst(records().map(|(pair, found)| {
                    (f(found[at]), fourier::series(count, f(pair[0]), f(pair[1]), window))
                }));
            hold(&format!("series, {name}, {m} bases"), sums, 1e-5);
        }
        let scale =
            found[258..260].iter().zip([m - 3, m - 1]).map(|(s, n)| (f(*s), 2.0 / (PI * f64::from(n))));
        hold(&format!("coefficient_scale, {m} bases"), worst(scale), 1e-7);
    }
}

#[test]
fn errors_on_a_plane_are_those_of_the_table() {
    // EQUATIONS.md 1.4: mean error of one texel at 0.5 over all rays, to four digits.
    let rays: Vec<[f32; 2]> = (0..8000).map(|i| [(i as f32 + 0.5) / 8000.0, 0.5]).collect();
    for (m, none, lanczos) in [
        (4, 0.1091, 0.1262),
        (8, 0.0660, 0.0643),
        (16, 0.0386, 0.0326),
        (32, 0.0221, 0.0164),
        (64, 0.0125, 0.0082),
        (128, 0.0069, 0.0041),
    ] {
        let found = series(m, &rays);
        let mean = |at: usize| {
            let errors = rays.iter().zip(found.chunks_exact(260));
            errors.map(|(r, found)| (f(found[at]) - fourier::visibility(f(r[0]), 0.5)).abs()).sum::<f64>()
                / 8000.0
        };
        let (plain, windowed) = (mean(256), mean(257));
        println!("{m} bases on a plane: {plain:.4} plain, {windowed:.4} Lanczos");
        assert!((plain - none).abs() < 1e-4, "{m} plain: {plain} instead of {none}");
        assert!((windowed - lanczos).abs() < 1e-4, "{m} Lanczos: {windowed} instead of {lanczos}");
        // Overshoot: 9 % of the plain series, 1.2 % of the windowed one.
        let over = |at: usize| found.chunks_exact(260).map(|r| f(r[at]) - 1.0).fold(0.0, f64::max);
        assert!(m < 16 || ((over(256) - 0.09).abs() < 0.005 && (over(257) - 0.012).abs() < 0.003), "{m}");
    }
}

#[test]
fn the_guard_keeps_rays_from_both_ends() {
    let probe = Probe {
        head: "#import airlight::core::fourier_basis::{guarded, GUARD, surface_bias}",
        body: "output(0u, guarded(input(0u))); output(1u, GUARD);
               output(2u, surface_bias(4u)); output(3u, surface_bias(32u)); output(4u, surface_bias(128u));",
        inputs: 1,
        outputs: 5,
    };
    let mut inputs: Vec<f32> = (-100..=200).map(|i| i as f32 / 100.0).collect();
    inputs.extend([-1e30, 1e30, -0.06, 1.06]);
    let found = probe.run(&inputs);
    let error = worst(inputs.iter().zip(found.chunks_exact(5)).map(|(unit, found)| {
        assert_eq!(found[1], 0.05);
        // Half the softened edge, and never the whole guard.
        assert!(worst([0.04, 0.01875, 0.0046875].iter().zip(&found[2..]).map(|(e, b)| (*e, f(*b)))) < 1e-8);
        (f(found[0]), (0.05 + 0.9 * f(*unit)).clamp(0.0, 1.0))
    }));
    hold("guarded", error, 1.5e-7);
    for (unit, found) in
        inputs.iter().zip(found.chunks_exact(5)).filter(|(unit, _)| (0.0..=1.0).contains(*unit))
    {
        assert!((0.05 - 1e-7..=0.95 + 1e-7).contains(&f(found[0])), "{unit}");
    }
}

// Phase functions.

fn henyey_greenstein(pairs: &[f32]) -> Vec<f32> {
    Probe {
        head: "#import airlight::core::phase::{henyey_greenstein, isotropic}",
        body: "output(0u, henyey_greenstein(input(0u), input(1u))); output(1u, isotropic());",
        inputs: 2,
        outputs: 2,
    }
    .run(pairs)
}

const MEAN_COSINES: [f32; 11] = [-0.99, -0.9, -0.6, -0.2, 0.0, 1e-4, 0.3, 0.76, 0.9, 0.97, 0.99];

#[test]
fn phase_functions_are_those_of_the_reference() {
    // Cosines close to 1 are f32 as well: the difference from 1 is exact.
    let mut cosines: Vec<f32> = (0..=400).map(|i| i as f32 / 200.0 - 1.0).collect();
    cosines.extend((1..=24).flat_map(|i| [1.0 - 0.5_f32.powi(i), 0.5_f32.powi(i) - 1.0]));
    let pairs: Vec<f32> = MEAN_COSINES.iter().flat_map(|g| cosines.iter().flat_map(|c| [*c, *g])).collect();
    let found = henyey_greenstein(&pairs);
    let error = worst(
        pairs
            .chunks_exact(2)
            .zip(found.chunks_exact(2))
            .map(|(pair, found)| (f(found[0]) / phase::henyey_greenstein(f(pair[0]), f(pair[1])), 1.0)),
    );
    hold("henyey_greenstein, relative", error, 2e-6);
    hold("isotropic, relative", (f(found[1]) / phase::isotropic() - 1.0).abs(), 1e-7);
    // Cosines that rounding has carried out of range, and means beyond the clamp, stay finite.
    let wild = henyey_greenstein(&[1.0000002, 0.9, -1.0000002, -0.9, 1.0, 1.0, -1.0, -1.0, 0.5, 1e30]);
    assert!(wild.iter().all(|p| p.is_finite() && *p >= 0.0), "{wild:?}");
    let clamped = phase::henyey_greenstein(1.0, f(0.999));
    hold("henyey_greenstein at its clamp, relative", (f(wild[4]) / clamped - 1.0).abs(), 1e-3);
}

#[test]
fn phase_functions_are_normalised_with_mean_cosine_g() {
    const STEPS: usize = 20_000;
    for g in MEAN_COSINES {
        // Nodes crowd at the peak; the trapezoids are between the f32 cosines themselves.
        let cosines: Vec<f32> = (0..=STEPS)
            .map(|i| {
                let angle = PI * (i as f64 / STEPS as f64).powi(2);
                let cosine = angle.cos() as f32;
                if g >= 0.0 { cosine } else { -cosine }
            })
            .collect();
        let pairs: Vec<f32> = cosines.iter().flat_map(|c| [*c, g]).collect();
        let values: Vec<f64> = henyey_greenstein(&pairs).chunks_exact(2).map(|p| f(p[0])).collect();
        let (mut norm, mut mean) = (0.0, 0.0);
        for i in 0..STEPS {
            let (a, b) = (f(cosines[i]), f(cosines[i + 1]));
            let width = 2.0 * PI * (a - b).abs() * 0.5;
            norm += width * (values[i] + values[i + 1]);
            mean += width * (a * values[i] + b * values[i + 1]);
        }
        hold(&format!("norm, g {g}"), (norm - 1.0).abs(), 1e-4);
        hold(&format!("mean cosine, g {g}"), (mean - f(g)).abs(), 1e-4);
    }
}

// Cameras.

const CAMERA: &str = "#import airlight::core::camera::{
        Camera, view_ray, perspective_ray, ndc_from_pixel, distance_from_depth, perspective_distance, matrix_row, side_normal, forward_direction,
        far_plane_distance
    }
    fn matrix_at(first: u32) -> mat4x4<f32> {
        var m: mat4x4<f32>;
        for (var c = 0u; c < 4u; c++) {
            let k = first + 4u * c;
            m[c] = vec4<f32>(input(k), input(k + 1u), input(k + 2u), input(k + 3u));
        }
        return m;
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

fn camera_words(camera: &airlight::core::Camera) -> Vec<f32> {
    let mut words = camera.clip_from_world.to_cols_array().to_vec();
    words.extend(camera.world_from_clip.to_cols_array());
    words.extend(camera.eye.to_array());
    words.extend([camera.near_depth, camera.viewport.x, camera.viewport.y, camera.far_depth]);
    words.push(camera.projection as f32);
    words
}

fn triple(values: &[f32]) -> Vec3 {
    Vec3::from([values[0], values[1], values[2]])
}

#[test]
fn rays_distances_and_planes_of_perspective_cameras() {
    const LIMIT: f64 = 500.0;
    let probe = Probe {
        head: CAMERA,
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
        head: CAMERA,
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
        head: CAMERA,
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
        // A light's matrix is that of an orthographic camera that looks away from the light.
        let clip = gpu::light_matrix(towards, centre, half, far_depth);
        let world = clip.inverse().unwrap();
        let camera = airlight::core::Camera {
            clip_from_world: gpu::host_matrix(clip),
            world_from_clip: gpu::host_matrix(world),
            eye: glam::Vec3::splat(1e3),
            near_depth: 1.0 - far_depth as f32,
            viewport: glam::Vec2::new(96.0, 64.0),
            far_depth: far_depth as f32,
            projection: 1,
        };
        let (x, y) = (random.below(96), random.below(64));
        let ndc = ReferenceCamera::pixel_ndc(x, y, 96, 64);
        let [px, py, pz, _] = world.apply([ndc[0], ndc[1], 1.0 - far_depth, 1.0]);
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
fn points_go_to_the_shadow_map_and_back() {
    let probe = Probe {
        head: "#import airlight::core::light::{Light, shadow_position, shadow_point}
            fn matrix_at(first: u32) -> mat4x4<f32> {
                var m: mat4x4<f32>;
                for (var c = 0u; c < 4u; c++) {
                    let k = first + 4u * c;
                    m[c] = vec4<f32>(input(k), input(k + 1u), input(k + 2u), input(k + 3u));
                }
                return m;
            }",
        body: "let light = Light(matrix_at(0u), matrix_at(16u), vec3<f32>(0.0), 1.0, vec3<f32>(0.0), 0u,
                   vec3<f32>(0.0), 0.0, vec2<f32>(0.0), 0.0, 0.0);
               let at = shadow_position(light, vec2<f32>(512.0, 256.0), vec3<f32>(input(32u), input(33u), input(34u)));
               let back = shadow_point(light, vec2<f32>(512.0, 256.0), at.xy, at.z);
               output(0u, at.x); output(1u, at.y); output(2u, at.z);
               output(3u, back.x); output(4u, back.y); output(5u, back.z);",
        inputs: 35,
        outputs: 6,
    };
    let mut random = Random(31);
    let (mut inputs, mut cases) = (Vec::new(), Vec::new());
    for _ in 0..500 {
        let towards = random.direction();
        let half = random.between(1.0, 50.0);
        let centre = random.direction() * random.between(0.0, 20.0);
        let matrix = gpu::light_matrix(towards, centre, half, if random.unit() < 0.5 { 1.0 } else { 0.0 });
        let point = gpu::vector(gpu::host_vector(centre + random.direction() * random.between(0.0, half)));
        inputs.extend(gpu::host_matrix(matrix).to_cols_array());
        inputs.extend(gpu::host_matrix(matrix.inverse().unwrap()).to_cols_array());
        inputs.extend(gpu::host_vector(point).to_array());
        cases.push((matrix, point, half));
    }
    let found = probe.run(&inputs);
    let (mut forth, mut back) = (0.0_f64, 0.0_f64);
    for ((matrix, point, half), found) in cases.iter().zip(found.chunks_exact(6)) {
        let map = scattering::ShadowMap {
            depth: &[],
            width: 512,
            height: 256,
            clip_from_world: *matrix,
            far_depth: 1.0,
        };
        let [x, y, z] = map.project(*point);
        let scale = 1.0 + point.length() / half;
        let texels = (f(found[0]) - x).abs().max((f(found[1]) - y).abs()) / 512.0;
        forth = forth.max(texels.max((f(found[2]) - z).abs()) / scale);
        back = back.max((triple(&found[3..]) - *point).length() / (half + point.length()));
    }
    hold("shadow_position, of the map", forth, 5e-7);
    hold("shadow_point of it, of the scene's size", back, 1e-6);
}

const LIGHT: &str = "#import airlight::core::light::{
        Light, shadow_position, shadow_point, direction_to_light, angular_falloff, light_falloff
    }
    fn matrix_at(first: u32) -> mat4x4<f32> {
        var m: mat4x4<f32>;
        for (var c = 0u; c < 4u; c++) {
            let k = first + 4u * c;
            m[c] = vec4<f32>(input(k), input(k + 1u), input(k + 2u), input(k + 3u));
        }
        return m;
    }";

#[test]
fn points_go_to_the_map_of_a_spot_and_back() {
    let probe = Probe {
        head: LIGHT,
        body: "let light = Light(matrix_at(0u), matrix_at(16u), vec3<f32>(0.0), 1.0, vec3<f32>(0.0), 1u,
                   vec3<f32>(0.0), 0.0, vec2<f32>(0.0), 0.0, 0.0);
               let at = shadow_position(light, vec2<f32>(512.0, 256.0), vec3<f32>(input(32u), input(33u), input(34u)));
               let back = shadow_point(light, vec2<f32>(512.0, 256.0), at.xy, at.z);
               output(0u, at.x); output(1u, at.y); output(2u, at.z);
               output(3u, back.x); output(4u, back.y); output(5u, back.z);",
        inputs: 35,
        outputs: 6,
    };
    let mut random = Random(37);
    let (mut inputs, mut cases) = (Vec::new(), Vec::new());
    for case in 0..1000 {
        // A spot's map is the picture of a camera at its place.
        let eye = random.direction() * random.between(0.0, 10.0);
        let axis = random.direction();
        let half = random.between(0.1, 1.3);
        let camera = ReferenceCamera::perspective(&airlight_tests::reference::camera::View {
            eye,
            target: eye + axis,
            up: random.direction(),
            fov_y: 2.0 * half,
            aspect: 1.0,
            near: 0.05,
            far: 40.0,
            reversed: false,
        });
        let across = random.direction().without(axis).normalised() * (half.tan() * random.unit());
        let distance = random.between(0.1, 30.0);
        let behind = case % 8 == 0;
        let point = eye + (axis + across) * if behind { -distance } else { distance };
        let point = gpu::vector(gpu::host_vector(point));
        inputs.extend(gpu::host_matrix(camera.clip_from_world).to_cols_array());
        inputs.extend(gpu::host_matrix(camera.world_from_clip).to_cols_array());
        inputs.extend(gpu::host_vector(point).to_array());
        cases.push((camera.clip_from_world, eye, point, distance, behind));
    }
    let found = probe.run(&inputs);
    let (mut forth, mut depth, mut back) = (0.0_f64, 0.0_f64, 0.0_f64);
    for ((matrix, eye, point, distance, behind), found) in cases.iter().zip(found.chunks_exact(6)) {
        if *behind {
            assert!(found[0] < 0.0 && found[1] < 0.0 && found.iter().all(|x| x.is_finite()), "{found:?}");
            continue;
        }
        let [x, y, z, w] = matrix.apply_point(*point);
        // Cancellation: the f32 matrix holds the eye's place to an ulp of its size.
        let scale = 1.0 + point.length().max(eye.length()) / distance;
        let texels = (f(found[0]) / 512.0 - (0.5 + 0.5 * x / w)).abs();
        let texels = texels.max((f(found[1]) / 256.0 - (0.5 - 0.5 * y / w)).abs());
        forth = forth.max(texels / scale);
        depth = depth.max((f(found[2]) - z / w).abs() * w / scale);
        // Depth is steep near the light and flat far away: an ulp of it is distance^2 / near metres.
        let room = 1.0 + eye.length() + distance + distance * distance / 0.05;
        back = back.max((triple(&found[3..]) - *point).length() / room);
    }
    hold("shadow_position of a spot, of the map", forth, 3e-6);
    hold("depth of a spot, times metres", depth, 3e-6);
    hold("shadow_point of a spot, of an ulp's reach", back, 1e-6);
}

#[test]
fn light_falls_off_by_cones_and_inverse_squares() {
    let probe = Probe {
        head: LIGHT,
        body: "let m = mat4x4<f32>();
               let light = Light(m, m, vec3<f32>(input(0u), input(1u), input(2u)), 1.0, vec3<f32>(0.0), u32(input(3u)),
                   vec3<f32>(input(4u), input(5u), input(6u)), input(7u), vec2<f32>(input(8u), input(9u)), 0.0, 0.0);
               let point = vec3<f32>(input(10u), input(11u), input(12u));
               let towards = direction_to_light(light, point);
               output(0u, towards.x); output(1u, towards.y); output(2u, towards.z);
               output(3u, angular_falloff(light, towards));
               output(4u, light_falloff(light, point));",
        inputs: 13,
        outputs: 5,
    };
    let mut random = Random(41);
    let (mut inputs, mut cases) = (Vec::new(), Vec::new());
    let mut record =
        |direction: Vec3, kind: u32, position: Vec3, radius: f64, cosines: [f64; 2], point: Vec3| {
            inputs.extend(gpu::host_vector(direction).to_array());
            inputs.push(kind as f32);
            inputs.extend(gpu::host_vector(position).to_array());
            inputs.extend([radius as f32, cosines[0] as f32, cosines[1] as f32]);
            inputs.extend(gpu::host_vector(point).to_array());
        };
    for case in 0..3000_u32 {
        let axis = random.direction();
        let position = gpu::vector(gpu::host_vector(random.direction() * random.between(0.0, 5.0)));
        let radius = random.magnitude(1e-3, 1.0);
        let outer = random.between(0.1, 1.3);
        let inner = outer * random.between(0.0, 0.95);
        // Most points in the cone's neighbourhood, some anywhere.
        let across = random.direction().without(axis).normalised() * (outer.tan() * random.between(0.0, 1.3));
        let direction = if case % 5 == 0 { random.direction() } else { (axis + across).normalised() };
        let point = gpu::vector(gpu::host_vector(position + direction * random.magnitude(0.05, 50.0)));
        let kind = case % 3;
        record(-axis, kind, position, radius, [inner.cos(), outer.cos()], point);
        cases.push((
            match kind {
                0 => light::Light::Directional { towards: -axis },
                1 => light::Light::Spot { position, axis, inner, outer, radius },
                _ => light::Light::Point { position, radius },
            },
            point,
            outer,
            inner,
        ));
    }
    // At the light itself, far beyond every scene, and with one edge for both cones: finite and in range.
    let y = Vec3::new(0.0, 1.0, 0.0);
    let o = Vec3::new(0.0, 0.0, 0.0);
    for (position, point, radius) in
        [(o, o, 0.0), (y, y, 0.1), (o, y * 1e30, 0.1), (o, y * -1e30, 0.0), (o, y, 0.0)]
    {
        record(-y, 1, position, radius, [0.9, 0.9], point);
        record(-y, 2, position, radius, [0.0, 0.0], point);
    }
    let found = probe.run(&inputs);
    let (mut towards, mut cone, mut whole) = (0.0_f64, 0.0_f64, 0.0_f64);
    for ((light, point, outer, inner), found) in cases.iter().zip(found.chunks_exact(5)) {
        let expected = light.towards(*point);
        towards = towards.max((triple(found) - expected).length());
        let cosine = match light {
            light::Light::Spot { axis, .. } => -expected.dot(*axis),
            _ => 1.0,
        };
        // Cosines are rounded to f32 before their narrow difference divides.
        let steep = 1.0 / (inner.cos() - outer.cos());
        cone = cone.max((f(found[3]) - light.cone(cosine.clamp(-1.0, 1.0).acos())).abs() / (1.0 + steep));
        let (exact, open) = (light.irradiance(*point), 1.0 + steep);
        let free = match light {
            light::Light::Directional { .. } => 1.0,
            light::Light::Spot { position, radius, .. } | light::Light::Point { position, radius } => {
                1.0 / ((*point - *position).dot(*point - *position) + radius * radius)
            }
        };
        whole = whole.max((f(found[4]) - exact).abs() / (free * open));
        if cosine < outer.cos() - 1e-6 {
            assert_eq!((found[3], found[4]), (0.0, 0.0), "outside the cone");
        }
    }
    hold("direction_to_light", towards, 4e-7 * 100.0);
    hold("angular_falloff, of its steepness", cone, 2e-6);
    hold("light_falloff, relative, of its steepness", whole, 4e-6);
    for found in found[5 * cases.len()..].chunks_exact(5) {
        assert!(found.iter().all(|x| x.is_finite()) && (0.0..=1.0).contains(&found[3]), "{found:?}");
    }
}

#[test]
fn light_rays_find_their_view() {
    let probe = Probe {
        head: "#import airlight::core::shadow_views::{
                ShadowViews, clip_in_views, view_position, point_at_depth, view_contains, or_in_view
            }
            fn matrix_at(first: u32) -> mat4x4<f32> {
                var m: mat4x4<f32>;
                for (var c = 0u; c < 4u; c++) {
                    let k = first + 4u * c;
                    m[c] = vec4<f32>(input(k), input(k + 1u), input(k + 2u), input(k + 3u));
                }
                return m;
            }",
        body: "var views: ShadowViews;
               for (var k = 0u; k < 6u; k++) {
                   views.clip_from_world[k] = matrix_at(16u * k);
                   views.world_from_clip[k] = matrix_at(96u + 16u * k);
               }
               views.count = u32(input(192u));
               let point = vec3<f32>(input(193u), input(194u), input(195u));
               let at = view_position(views, vec2<f32>(512.0, 256.0), point);
               output(0u, f32(at.inside)); output(1u, f32(at.view));
               output(2u, at.at.x / 512.0); output(3u, at.at.y / 256.0); output(4u, at.at.z);
               let back = point_at_depth(views.clip_from_world[at.view], views.world_from_clip[at.view], point, at.at.z);
               output(5u, back.x); output(6u, back.y); output(7u, back.z);",
        inputs: 196,
        outputs: 8,
    };
    let mut random = Random(43);
    let (mut inputs, mut cases) = (Vec::new(), Vec::new());
    for case in 0..1500 {
        let centre = random.direction() * random.between(0.0, 4.0);
        let cube = case % 2 == 0;
        let views = if cube {
            ShadowViews::cube(gpu::host_vector(centre), 0.05, 30.0).unwrap()
        } else {
            // Nested boxes, as cascades are.
            let towards = random.direction();
            let count = 1 + random.below(6);
            let mut views = ShadowViews::cube(glam::Vec3::ZERO, 0.1, 1.0).unwrap();
            views.count = count as u32;
            for view in 0..count {
                let matrix = gpu::light_matrix(towards, centre, 2.0 * (view + 1) as f64, 1.0);
                views.clip_from_world[view] = gpu::host_matrix(matrix);
                views.world_from_clip[view] = gpu::host_matrix(matrix.inverse().unwrap());
            }
            views
        };
        let point = centre + random.direction() * random.magnitude(0.2, 20.0);
        let point = gpu::host_vector(point);
        for matrix in views.clip_from_world.iter().chain(&views.world_from_clip) {
            inputs.extend(matrix.to_cols_array());
        }
        inputs.push(views.count as f32);
        inputs.extend(point.to_array());
        cases.push((views, gpu::vector(point), cube));
    }
    let found = probe.run(&inputs);
    let (mut places, mut back, mut hits, mut skipped) = (0.0_f64, 0.0_f64, [0; 2], 0);
    for ((views, point, cube), found) in cases.iter().zip(found.chunks_exact(8)) {
        let matrices: Vec<_> =
            views.clip_from_world[..views.count as usize].iter().map(|m| gpu::matrix(*m)).collect();
        let (expected, margin) = light::first_view(&matrices, *point);
        if margin < 1e-4 {
            skipped += 1;
            continue;
        }
        assert_eq!(found[0] == 1.0, expected.is_some(), "{point:?}");
        hits[usize::from(expected.is_some())] += 1;
        assert!(expected.is_some() || !cube);
        let Some((view, [x, y, z])) = expected else { continue };
        assert_eq!(found[1] as usize, view);
        let errors = [f(found[2]) - (0.5 + 0.5 * x), f(found[3]) - (0.5 - 0.5 * y), f(found[4]) - z];
        places = errors.iter().fold(places, |worst, error| worst.max(error.abs()));
        let room = if *cube { 1.0 + point.length().powi(2) / 0.05 } else { 1.0 + point.length() };
        back = back.max((triple(&found[5..]) - *point).length() / room);
    }
    assert!(hits[0] > 50 && hits[1] > 500 && skipped < 50, "{hits:?} {skipped}");
    hold("view_position, of the map", places, 2e-5);
    hold("point_at_depth, of an ulp's reach", back, 2e-6);
}

#[test]
fn viewers_are_where_the_camera_says() {
    let probe = Probe {
        head: &CAMERA.replace("ndc_from_pixel,", "ndc_from_pixel, towards_viewer,"),
        body: "output_vector(0u, towards_viewer(camera_at(), vec3<f32>(input(40u), input(41u), input(42u))));",
        inputs: 43,
        outputs: 3,
    };
    let mut random = Random(47);
    let (mut inputs, mut cases) = (Vec::new(), Vec::new());
    for case in 0..400 {
        let point = random.direction() * random.between(0.0, 9.0);
        let (mut camera, expected);
        if case % 2 == 0 {
            let reference = random.camera(1.5);
            camera = gpu::host_camera(&reference, [96, 64]);
            expected = (reference.eye - point).normalised();
        } else {
            let towards = random.direction();
            let far_depth = if case % 4 == 1 { 0.0 } else { 1.0 };
            let matrix = gpu::light_matrix(towards, point, random.between(1.0, 9.0), far_depth);
            camera = gpu::host_camera(&random.camera(1.5), [96, 64]);
            camera.clip_from_world = gpu::host_matrix(matrix);
            camera.world_from_clip = gpu::host_matrix(matrix.inverse().unwrap());
            (camera.near_depth, camera.far_depth) = (1.0 - far_depth as f32, far_depth as f32);
            camera.projection = 1;
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

// Prefix sums.

#[test]
fn running_means_are_those_of_the_reference() {
    let probe = Probe {
        head: "#import airlight::core::prefix_sum::{row_weights, row_weights_next, running_mean}",
        body: "var weights = row_weights(input(0u));
               var mean = vec4<f32>(0.0);
               let count = u32(input(1u));
               for (var i = 0u; i < count; i++) {
                   let value = vec4<f32>(input(2u + i), -input(2u + i), 1.0, 0.0);
                   mean = running_mean(mean, value, weights);
                   output(2u * i, mean.x);
                   output(2u * i + 1u, mean.z);
                   weights = row_weights_next(weights);
               }",
        inputs: 4098,
        outputs: 8192,
    };
    let mut random = Random(37);
    let values: Vec<f32> = (0..4096).map(|_| random.between(-1.0, 1.0) as f32).collect();
    let steps = [0.0_f32, 1e-9, 1e-5, 1e-3, 0.03, 1.0, 60.0, 1e6, -1.0];
    let mut inputs = Vec::new();
    for step in steps {
        inputs.extend([step, 4096.0]);
        inputs.extend(&values);
    }
    let found = probe.run(&inputs);
    let exact: Vec<f64> = values.iter().map(|v| f(*v)).collect();
    for (step, found) in steps.iter().zip(found.chunks_exact(8192)) {
        // An optical depth below zero counts as none. Weights are powers of a rounded ratio: the budget
        // allows for that over the texels that still weigh anything.
        let weights = prefix_sum::transmittance_weights(4096, f(step.max(0.0)));
        let expected = prefix_sum::running_mean(&exact, &weights);
        let error = worst(found.chunks_exact(2).map(|pair| f(pair[0])).zip(expected));
        hold(&format!("running_mean, optical step {step}"), error, 5e-6);
        let ones = worst(found.chunks_exact(2).map(|pair| (f(pair[1]), 1.0)));
        hold(&format!("mean of ones, optical step {step}"), ones, 1e-6);
    }
}

// Finite values.

#[test]
fn what_is_not_finite_is_replaced() {
    let probe = Probe {
        head: "#import airlight::core::finite::{is_finite, finite_or, finite_or_rgb}",
        body: "let x = input(0u);
               output(0u, select(0.0, 1.0, is_finite(x)));
               output(1u, finite_or(x, 7.0));
               let rgb = finite_or_rgb(vec3<f32>(x, 2.0, x), 7.0);
               output(2u, rgb.x); output(3u, rgb.y); output(4u, rgb.z);",
        inputs: 1,
        outputs: 5,
    };
    let wild = [
        f32::NAN,
        -f32::NAN,
        f32::from_bits(0x7f80_0001),
        f32::from_bits(0xffff_ffff),
        f32::INFINITY,
        f32::NEG_INFINITY,
    ];
    let fine = [0.0, -0.0, 1.0, -1.5, f32::MAX, f32::MIN, f32::MIN_POSITIVE, 1e-30];
    let subnormal = [f32::from_bits(1), f32::from_bits(0x8000_0001), f32::from_bits(0x007f_ffff)];
    let inputs: Vec<f32> = wild.into_iter().chain(fine).chain(subnormal).collect();
    for (x, found) in inputs.iter().zip(probe.run(&inputs).chunks_exact(5)) {
        if x.is_finite() {
            // A subnormal number may be flushed to zero.
            let kept = |y: f32| y == *x || (!x.is_normal() && y == 0.0);
            assert!(found[0] == 1.0 && [1, 2, 4].iter().all(|i| kept(found[*i])), "{x:e}: {found:?}");
        } else {
            assert_eq!(found, [0.0, 7.0, 7.0, 2.0, 7.0], "{x}");
        }
        assert_eq!(found[3], 2.0);
    }
}

// Colour.

#[test]
fn colours_follow_their_closed_forms() {
    let probe = Probe {
        head: "#import airlight::core::color::{luminance, tone_curve, srgb_from_linear}",
        body: "let x = input(0u);
               output(0u, srgb_from_linear(vec3<f32>(x, 0.0, 1.0)).x);
               output(1u, tone_curve(vec3<f32>(x, 0.0, 1.0)).x);
               output(2u, luminance(vec3<f32>(x, 0.5, 0.25)));
               output(3u, srgb_from_linear(vec3<f32>(x, 0.0, 1.0)).z);",
        inputs: 1,
        outputs: 4,
    };
    let mut inputs: Vec<f32> = (0..=2000).map(|i| i as f32 / 2000.0).collect();
    inputs.extend([0.0031307, 0.0031308, 0.0031309]);
    inputs.extend((0..600).map(|i| 10_f32.powf(i as f32 / 15.0 - 10.0)));
    inputs.sort_unstable_by(f32::total_cmp);
    let found = probe.run(&inputs);
    let srgb = worst(inputs.iter().zip(found.chunks_exact(4)).map(|(x, found)| {
        let x = f(*x).clamp(0.0, 1.0);
        (f(found[0]), if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 })
    }));
    hold("srgb_from_linear", srgb, 5e-6);
    let tone =
        worst(inputs.iter().zip(found.chunks_exact(4)).filter(|(x, _)| **x < 1e4).map(|(x, found)| {
            let x = f(*x);
            (f(found[1]), ((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0))
        }));
    hold("tone_curve", tone, 1e-6);
    let luminance = worst(inputs.iter().zip(found.chunks_exact(4)).map(|(x, found)| {
        let expected = 0.2126 * f(*x) + 0.7152 * 0.5 + 0.0722 * 0.25;
        (f(found[2]) / expected, 1.0)
    }));
    hold("luminance, relative", luminance, 3e-7);
    let mut before = 0.0;
    for (x, found) in inputs.iter().zip(found.chunks_exact(4)) {
        assert!((0.0..=1.0).contains(&found[1]) && (0.0..=1.0).contains(&found[0]), "{x}: {found:?}");
        // Equal inputs of different order of operations may differ in the last place.
        assert!(found[1] >= before - 1e-7, "the tone curve falls at {x}: {} after {before}", found[1]);
        assert!((1.0 - 1e-6..=1.0).contains(&found[3]), "white is {}", found[3]);
        before = found[1];
    }
    assert_eq!(before, 1.0, "the tone curve ends at 1");
    let beyond = probe.run(&[-1.0, -1e30, f32::MAX]);
    assert_eq!([beyond[0], beyond[1], beyond[4], beyond[5], beyond[9]], [0.0, 0.0, 0.0, 0.0, 1.0]);
    assert!((beyond[8] - 1.0).abs() < 1e-6);
}

// What `scattering/single_scatter` adds.

#[test]
fn absorption_and_in_scattering_keep_their_precision() {
    let probe = Probe {
        head: "#import airlight::scattering::single_scatter::{Medium, transmittance, in_scattered}
               #import airlight::core::prefix_sum::{one_minus_exp, prefix_weight}",
        body: "let medium = Medium(vec3<f32>(0.9), input(0u), input(1u), 100.0, 0.0, 0.0);
               output(0u, one_minus_exp(input(0u)));
               output(1u, transmittance(input(0u)));
               output(2u, in_scattered(medium, vec3<f32>(3.0, 2.0, 1.0), input(2u), input(3u), 0.75).y);
               output(3u, prefix_weight(input(0u), 10.0 * input(3u)));",
        inputs: 4,
        outputs: 4,
    };
    let mut random = Random(41);
    let mut inputs = Vec::new();
    for i in 0..=1200 {
        let x = 10_f32.powf(i as f32 / 25.0 - 40.0);
        let x = if i < 20 { [0.0, 0.05, 0.049_999, 0.050_001][i % 4] } else { x.min(1e6) };
        let g = random.between(-0.9, 0.9) as f32;
        inputs.extend([x, g, random.between(-1.0, 1.0) as f32, random.magnitude(0.01, 100.0) as f32]);
    }
    let found = probe.run(&inputs);
    let (mut absorbed, mut passed, mut radiance, mut prefix) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for (input, found) in inputs.chunks_exact(4).zip(found.chunks_exact(4)) {
        let [x, g, cosine, distance] = [0, 1, 2, 3].map(|i| f(input[i]));
        // Below 1e-37 the number itself is at the end of f32.
        if x > 1e-37 {
            absorbed = absorbed.max((f(found[0]) / -(-x).exp_m1() - 1.0).abs());
        }
        passed = passed.max((f(found[1]) - (-x).exp()).abs());
        // In units of the first of equal texels of the optical depth x; up to 1000 texels.
        let texels = 10.0 * distance;
        let weight = if x == 0.0 { texels } else { (-x * texels).exp_m1() / (-x).exp_m1() };
        prefix = prefix.max((f(found[3]) / weight - 1.0).abs());
        let medium = scattering::Medium { extinction: x, albedo: f(0.9), g, distance_limit: 100.0 };
        let light = scattering::Light { direction: Vec3::new(0.0, 1.0, 0.0), radiance: [3.0, 2.0, 1.0] };
        let direction = Vec3::new((1.0 - cosine * cosine).sqrt(), cosine, 0.0);
        let expected = medium.radiance(&light, direction, distance, 0.75)[1];
        if expected > 1e-35 {
            radiance = radiance.max((f(found[2]) / expected - 1.0).abs());
        } else {
            assert!(f(found[2]).abs() <= 1e-34, "{found:?}");
        }
    }
    hold("one_minus_exp, relative", absorbed, 1e-6);
    hold("transmittance", passed, 3e-7);
    // Where a texel's optical depth is below 1e-6, texels count alike.
    hold("prefix_weight, relative", prefix, 6e-4);
    hold("in_scattered, relative", radiance, 5e-6);
    assert_eq!(found[0..3], [0.0, 1.0, 0.0], "no medium scatters nothing");
}

// Scans.

#[test]
fn scans_of_any_length_are_exact() {
    let scan = Scan::new(gpu(), shaders()).unwrap();
    let mut random = Random(43);
    for length in [0_usize, 1, 2, 3, 255, 256, 1023, 1024, 1025, 4096, 1_048_576, 1_048_577, 3_000_000] {
        // Wrap-around: thousands of numbers of all sizes up to 2^32.
        let mut values: Vec<u32> = (0..length).map(|_| random.bits() >> (random.below(4) * 10)).collect();
        // What follows the counted values must stay.
        values.extend([77, 78, 79, 80, 81]);
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let buffer = Buffer::with_bytes(gpu(), &bytes, wgpu::BufferUsages::STORAGE);
        let mut encoder = gpu().encoder();
        scan.record(gpu(), &mut encoder, &buffer, length as u32).unwrap();
        gpu().submit(encoder).unwrap();
        let found = buffer.read_words(gpu()).unwrap();
        let mut expected = prefix_sum::exclusive(&values[..length]);
        expected.extend(&values[length..]);
        let wrong = found.iter().zip(&expected).position(|(f, e)| f != e);
        assert_eq!(
            wrong,
            None,
            "length {length}: {:?} instead of {:?}",
            wrong.map(|i| found[i]),
            wrong.map(|i| expected[i])
        );
    }
}

#[test]
fn textures_come_back_as_they_went() {
    use wgpu::TextureFormat as F;
    // Rows whose bytes are no multiple of 256, and layers.
    for (format, channels, scale) in [
        (F::R32Float, 1, 1.0),
        (F::Rgba32Float, 4, 1.0),
        (F::Rgba16Float, 4, 1.0 / 1024.0),
        (F::Rgba8Unorm, 4, 1.0 / 255.0),
        (F::R32Uint, 1, 1.0),
    ] {
        let texture = Texture::array(gpu(), [7, 5, 3], format, wgpu::TextureUsages::TEXTURE_BINDING);
        let values: Vec<f32> = (0..7 * 5 * 3 * channels).map(|i| (i % 256) as f32 * scale).collect();
        texture.write(gpu(), &values).unwrap();
        let back = texture.read(gpu()).unwrap();
        assert!(back.iter().zip(&values).all(|(b, v)| (b - v).abs() < 1e-6), "{format:?}");
        assert_eq!(back.len(), values.len());
        assert!(texture.write(gpu(), &values[1..]).is_err(), "{format:?}");
    }
}

// Jitter.

/// Gradient noise of pixels in frames: x, y, frame.
fn gradient_noise(places: &[[u32; 3]]) -> Vec<f64> {
    let probe = Probe {
        head: "#import airlight::core::jitter::gradient_noise_offset",
        body: "output(0u, gradient_noise_offset(vec2<u32>(u32(input(0u)), u32(input(1u))), u32(input(2u))));",
        inputs: 3,
        outputs: 1,
    };
    let inputs: Vec<f32> = places.iter().flatten().map(|value| *value as f32).collect();
    probe.run(&inputs).into_iter().map(f).collect()
}

/// Distance on the circle of circumference one.
fn around(a: f64, b: f64) -> f64 {
    let d = (a - b).abs();
    d.min(1.0 - d)
}

#[test]
fn gradient_noise_is_that_of_jimenez() {
    let mut random = Random(19);
    let places: Vec<[u32; 3]> = (0..20_000)
        .map(|_| [random.below(4096) as u32, random.below(4096) as u32, random.below(200) as u32])
        .collect();
    let found = gradient_noise(&places);
    let error = worst(places.iter().zip(&found).map(|([x, y, frame], found)| {
        assert!((0.0..1.0).contains(found), "{found}");
        let at = [x, y].map(|c| f64::from(*c) + 5.588238 * f64::from(frame % 64));
        let expected = (52.9829189 * (0.06711056 * at[0] + 0.00583715 * at[1]).fract()).fract();
        (around(*found, expected), 0.0)
    }));
    // The dot product is up to 330, rounded to 3e-5, and then magnified 53 times.
    hold("gradient_noise_offset, around the circle", error, 3e-3);
}

#[test]
fn gradient_noise_is_uniform_in_space_and_in_time() {
    let picture: Vec<[u32; 3]> = (0..256 * 256).map(|i| [i % 256, i / 256, 0]).collect();
    let values = gradient_noise(&picture);
    let mut sorted = values.clone();
    sorted.sort_by(f64::total_cmp);
    // Kolmogorov's distance of 65536 random numbers would be below 0.0064 with a confidence of 99 %.
    let distance = worst(sorted.iter().enumerate().map(|(i, v)| (*v, (i as f64 + 0.5) / 65536.0)));
    hold("gradient noise, distance from the uniform distribution", distance, 0.0064);
    // The means of 3x3 pixels: of random numbers they would scatter by 0.096.
    let mut squares = 0.0;
    for y in 0..254 {
        for x in 0..254 {
            let mean = (0..9).map(|i| values[(y + i / 3) * 256 + x + i % 3]).sum::<f64>() / 9.0;
            squares += (mean - 0.5).powi(2) / (254.0 * 254.0);
        }
    }
    hold("gradient noise, scatter of the means of 3x3 pixels", squares.sqrt(), 0.04);
    // The means of frames: of random numbers they would scatter by 0.289 over the root of their number.
    for (frames, budget) in [(8, 0.06), (16, 0.04), (64, 0.02)] {
        let places: Vec<[u32; 3]> =
            (0..32 * 32 * frames).map(|i| [i / frames % 32, i / frames / 32, i % frames]).collect();
        let means = gradient_noise(&places);
        let means = means.chunks_exact(frames as usize).map(|v| v.iter().sum::<f64>() / f64::from(frames));
        let scatter = (means.map(|m| (m - 0.5).powi(2)).sum::<f64>() / 1024.0).sqrt();
        hold(&format!("gradient noise, scatter of the means of {frames} frames"), scatter, budget);
    }
}

#[test]
fn blue_noise_turns_by_the_golden_ratio() {
    let folder = gpu::copy_of_wgsl();
    let text = "#import airlight::core::jitter::blue_noise_offset
        @group(#{GROUP}) @binding(0) var tile: texture_2d<f32>;
        @group(#{GROUP}) @binding(1) var<storage, read> frames: array<u32>;
        @group(#{GROUP}) @binding(2) var<storage, read_write> outputs: array<f32>;
        @compute @workgroup_size(64)
        fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
            let pixel = vec2<u32>(id.x % 8u, id.x / 8u);
            if id.x < 64u {
                for (var i = 0u; i < arrayLength(&frames); i++) {
                    outputs[64u * i + id.x] = blue_noise_offset(tile, pixel, frames[i]);
                }
            }
        }";
    std::fs::write(folder.path().join("core/passes/probe.wgsl"), text).unwrap();
    let library = airlight::validate::Library::from_directory(folder.path()).unwrap();
    let shaders = airlight::Shaders::from_library(library);
    let pass =
        airlight::Pass::compute_with(gpu(), &shaders, "core/probe", &airlight::validate::Definitions::new())
            .unwrap();
    // A tile of 4x4, repeated; one value is not a number, one is out of range, one is 1.
    let mut values: Vec<f32> = (0..16).map(|i| (i as f32 + 0.5) / 16.0).collect();
    (values[3], values[5], values[6]) = (f32::NAN, 1.75, 1.0);
    let tile = gpu::texture([4, 4], wgpu::TextureFormat::R32Float, &values);
    let mut frames: Vec<u32> = (0..64).collect();
    frames.extend([1_000_003, u32::MAX]);
    let bytes: Vec<u8> = frames.iter().flat_map(|frame| frame.to_le_bytes()).collect();
    let frame_buffer = Buffer::with_bytes(gpu(), &bytes, wgpu::BufferUsages::STORAGE);
    let outputs = Buffer::storage(gpu(), 64 * 4 * frames.len() as u64);
    let resources =
        [("tile", (&tile).into()), ("frames", (&frame_buffer).into()), ("outputs", (&outputs).into())];
    let bound = pass.bind(gpu(), &resources).unwrap();
    let mut encoder = gpu().encoder();
    pass.dispatch(&mut encoder, &bound, [64, 1, 1]);
    gpu().submit(encoder).unwrap();
    let found = outputs.read_floats(gpu()).unwrap();
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut first, mut any) = (0.0_f64, 0.0_f64);
    for (i, frame) in frames.iter().enumerate() {
        // Turns are counted in units of 2^-32, off by half a unit a frame.
        let turn = f64::from(frame.wrapping_mul(2_654_435_769)) / 4_294_967_296.0;
        for pixel in 0..64 {
            let value = values[pixel / 8 % 4 * 4 + pixel % 4];
            let value = if value.is_finite() { f(value).clamp(0.0, 1.0) } else { 0.0 };
            let turned = f(found[64 * i + pixel]);
            assert!((0.0..1.0).contains(&turned), "{turned}");
            any = any.max(around(turned, (value + turn).fract()));
            if i < 64 {
                first = first.max(around(turned, (value + f64::from(*frame) * golden).fract()));
            }
        }
    }
    hold("blue_noise_offset, around the circle, 64 frames", first, 2e-7);
    hold("blue_noise_offset, around the circle, any frame", any, 2e-7);
    // The mean over n frames, n a Fibonacci number: the values lie within 1 / (sqrt(5) n) of n even places,
    // so that their mean is off by (1 + 1 / sqrt(5)) / (2 n) at most; random ones would scatter by 0.289 / sqrt(n).
    for frames in [8, 21, 55] {
        let budget = 0.5 * (1.0 + 0.2_f64.sqrt()) / frames as f64;
        let off =
            worst((0..64).map(|pixel| {
                ((0..frames).map(|i| f(found[64 * i + pixel])).sum::<f64>() / frames as f64, 0.5)
            }));
        hold(&format!("blue noise, greatest error of the mean of {frames} frames"), off, budget);
    }
}

// Depths on a ray, and of several samples.

#[test]
fn depths_and_distances_on_a_ray_are_those_of_the_camera() {
    let head = CAMERA.replace(
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
            let camera = airlight::core::Camera {
                clip_from_world: gpu::host_matrix(clip),
                world_from_clip: gpu::host_matrix(clip.inverse().unwrap()),
                eye: glam::Vec3::ZERO,
                near_depth: 1.0 - far_depth as f32,
                viewport: glam::Vec2::ONE,
                far_depth: far_depth as f32,
                projection: 1,
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
