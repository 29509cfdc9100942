// SPDX-License-Identifier: MIT OR Apache-2.0
//! Gradient noise and blue noise that shift samples.

use crate::gpu::{self, Probe, Random, gpu};
use crate::probing::{f, hold, worst};
use airlight::Buffer;

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
