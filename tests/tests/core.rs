// SPDX-License-Identifier: MIT OR Apache-2.0
//! The functions of the core modules, evaluated on the GPU and held to their f64 references within a
//! stated error budget: which test holds which; values and colours, jitter; and scans of any length.
//! `core_camera.rs`, `core_light.rs` and `core_fourier.rs` hold the others.
//!
//! `--nocapture` prints the measured errors next to the budgets.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;
#[path = "support/probing.rs"]
mod probing;

use airlight::core::Scan;
use airlight::{Buffer, Texture};
use airlight_tests::reference::prefix_sum;
use gpu::{Probe, Random, gpu, shaders};
use probing::{f, hold, worst};

/// Every function of the core modules, each with a test here or in one of `core_*.rs`.
const COVERED: [(&str, &[&str]); 19] = [
    // In tests/tests/painterly.rs, by what rays find and see.
    ("transfer_function", &["classified"]),
    // In tests/tests/core_cosine.rs.
    (
        "cosine_basis",
        &[
            "harmonics_first",
            "harmonics_next",
            "harmonics_sum",
            "cosine_orders",
            "cosine_basis",
            "cosine_integral",
            "sine_over_angle",
            "cosine_spread",
            "fejer_window",
        ],
    ),
    // In tests/tests/moments.rs, the bounds as a whole and the roots alone.
    (
        "moment_bounds",
        &[
            "chebyshev",
            "moments_at",
            "mix_moments",
            "moment_factors",
            "orthogonal_polynomials",
            "greatest_weight",
            "cosine_of_third",
            "newton_step",
            "greatest_cubic_root",
            "share_bounds",
        ],
    ),
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
            "metres_of_texel",
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
    // In tests/tests/core_bricks.rs; runs of samples as wholes in tests/tests/transmittance_bricks.rs.
    ("bricks", &["brick_count", "brick_at", "samples_alike", "run_of_samples"]),
    ("volume", &["segment_in_box", "march_steps", "voxel_at", "metres_across"]),
    // In tests/tests/core_sort.rs.
    ("sort", &["ascending_key", "key_digit", "one_counted", "counted_together", "counted"]),
    // In tests/tests/core_noise.rs.
    (
        "noise",
        &[
            "hash_of_three",
            "unit_from_hash",
            "direction_from_hash",
            "quintic_fade",
            "corner_slope",
            "gradient_noise_in_cell",
            "gradient_noise",
        ],
    ),
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
