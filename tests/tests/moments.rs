// SPDX-License-Identifier: MIT OR Apache-2.0
//! Six moments of a rectified map on the GPU: bounds and reads against the f64 reference, the filter against prefix
//! means, and the error that six moments leave on scenes.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;
#[path = "support/probing.rs"]
mod probing;

use airlight::scattering::{
    Filtering, Inputs, LightForm, Medium, Prefiltered, ProjectiveMap, ProjectivePrefiltered, Rectification,
    ScatteringError, Settings, SettingsError, Start, Visibility, Weighting,
};
use airlight::{Buffer, Pass, Stage, Texture, scenes};
use airlight_tests::error;
use airlight_tests::reference::scattering as reference;
use glam::Vec3;
use gpu::{Probe, Random, gpu, shaders};
use probing::hold;
use wgpu::TextureFormat::{R32Float, Rgba32Float, Rgba32Uint};

/// MOMENT_BIAS and MOMENT_BLEND of the shader.
const BIAS: f64 = 1e-5;
const BLEND: f64 = 0.15;
/// One step of a stored moment.
const STEP: f64 = 2.0 / 2_097_151.0;

/// Depths of the texels of a prefix: of all kinds, degenerate ones among them.
fn prefix(random: &mut Random) -> Vec<f64> {
    let most = [1, 4, 40, 400][random.below(4)];
    let count = 1 + random.below(most);
    let centre = random.between(0.05, 0.95);
    let spread = random.magnitude(1e-6, 1.0);
    let levels = 1 + random.below(5);
    let kind = random.below(8);
    let edge = random.unit();
    (0..count)
        .map(|i| match kind {
            0 => 1.0,
            1 => centre,
            2 => (centre + spread * (random.unit() - 0.5)).clamp(0.0, 1.0),
            3 => (random.below(levels) as f64 + 0.5) / levels as f64,
            4 => edge + (1.0 - edge) * i as f64 / count as f64,
            5 => [0.0, 1.0, centre][random.below(3)],
            6 => {
                if random.unit() < edge {
                    1.0
                } else {
                    centre + 1e-3 * random.unit()
                }
            }
            _ => random.unit(),
        })
        .collect()
}

/// A ray's depth, often at or next to one that is stored.
fn ray(random: &mut Random, depths: &[f64]) -> f64 {
    let stored = depths[random.below(depths.len())];
    let depth = match random.below(4) {
        0 => stored,
        1 => stored + random.between(-1.0, 1.0) * random.magnitude(1e-6, 0.1),
        _ => random.unit(),
    };
    depth.clamp(0.05, 0.95)
}

#[test]
fn bounds_are_those_of_the_reference() {
    let probe = Probe {
        head: "#import airlight::core::moment_bounds::Moments
               #import airlight::scattering::visibility_moments::{moment_bounds, moment_visibility}",
        body: "let m = Moments(vec3<f32>(input(0u), input(1u), input(2u)), vec3<f32>(input(3u), input(4u), input(5u)));
               let bounds = moment_bounds(m, input(6u));
               output(0u, bounds.x); output(1u, bounds.y); output(2u, moment_visibility(m, input(6u)));",
        inputs: 7,
        outputs: 3,
    };
    let mut random = Random(401);
    let mut records = Vec::new();
    let mut truths = Vec::new();
    for _ in 0..20_000 {
        let depths = prefix(&mut random);
        // What a filter sees: f32 depths; and what it stores.
        let moments = reference::chebyshev_moments(depths.iter().map(|d| (f64::from(*d as f32), 1.0)));
        let stored = moments.map(|m| (((m * 0.5 + 0.5) / (0.5 * STEP)).round() * STEP - 1.0) as f32);
        let depth = ray(&mut random, &depths) as f32;
        let lit = depths.iter().filter(|d| f64::from(depth) <= f64::from(**d as f32)).count();
        truths.push(lit as f64 / depths.len() as f64);
        records.extend(stored);
        records.push(depth);
    }
    let found = probe.run(&records);
    let (mut worst, mut outside, mut blend, mut mean, mut wide) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0, 0);
    for ((record, found), truth) in records.chunks_exact(7).zip(found.chunks_exact(3)).zip(&truths) {
        let moments: [f64; 6] = std::array::from_fn(|k| f64::from(record[k]));
        let (low, high) = reference::visibility_bounds(&moments, BIAS, f64::from(record[6]));
        let [least, greatest, visibility] = [0, 1, 2].map(|k| f64::from(found[k]));
        assert!((0.0..=1.0).contains(&least) && (least..=1.0).contains(&greatest), "{record:?}: {found:?}");
        let error = (least - low).abs().max((greatest - high).abs());
        worst = if error <= worst { worst } else { error };
        mean += error;
        outside = outside.max(least - truth).max(truth - greatest);
        blend = blend.max((visibility - (BLEND * least + (1.0 - BLEND) * greatest)).abs());
        wide += usize::from(high - low > 0.01);
    }
    println!("{} prefixes, mean error {:.1e}, {wide} with room", truths.len(), mean / truths.len() as f64);
    assert!(wide > truths.len() / 5);
    // Where all depths are nearly the same, the pivots of the matrix are BIAS / 2, and a weight w = 1 / (1 + x / pivot) errs by
    // at most a quarter of the pivot's relative error: that of two roundings of f32, each of 6e-8.
    hold("bounds", worst, 0.25 * 2.0 * 6e-8 / (0.5 * BIAS));
    hold("bounds, mean", mean / truths.len() as f64, 5e-5);
    hold("truth outside of the bounds", outside, 1e-4);
    hold("blend", blend, 1e-6);
}

#[test]
fn any_moments_give_a_visibility() {
    let probe = Probe {
        head: "#import airlight::core::moment_bounds::Moments
               #import airlight::scattering::visibility_moments::{moment_visibility, moment_bounds}",
        body: "let m = Moments(vec3<f32>(input(0u), input(1u), input(2u)), vec3<f32>(input(3u), input(4u), input(5u)));
               output(0u, moment_visibility(m, input(6u)));
               let bounds = moment_bounds(m, input(6u));
               output(1u, bounds.x); output(2u, bounds.y);",
        inputs: 7,
        outputs: 3,
    };
    let mut random = Random(402);
    let mut records: Vec<[f32; 7]> = (0..20_000)
        .map(|i| {
            std::array::from_fn(|_| match i % 4 {
                0 => random.between(-1.0, 1.0) as f32,
                1 => [0.0, 1.0, -1.0, 1e-20, 3e38, -3e38][random.below(6)],
                2 => [1.0, -1.0, 1.0 - 6e-8, -1.0 + 1e-6][random.below(4)],
                _ => (random.between(-1.0, 1.0) * random.magnitude(1e-30, 1e30)) as f32,
            })
        })
        .collect();
    records.push([0.0; 7]);
    for (record, found) in records.iter().zip(probe.run(records.as_flattened()).chunks_exact(3)) {
        assert!(found.iter().all(|v| (0.0..=1.0).contains(v)), "{record:?}: {found:?}");
    }
}

#[test]
fn cosine_of_a_third_is_never_too_small() {
    let probe = Probe {
        head: "#import airlight::core::moment_bounds::cosine_of_third",
        body: "output(0u, cosine_of_third(input(0u)));",
        inputs: 1,
        outputs: 1,
    };
    let records: Vec<f32> = (0..=4000).map(|i| -1.0 + i as f32 / 2000.0).collect();
    let (mut below, mut above) = (0.0_f64, 0.0_f64);
    for (x, found) in records.iter().zip(probe.run(&records)) {
        let error = f64::from(found) - (f64::from(*x).acos() / 3.0).cos();
        (below, above) = (below.max(-error), above.max(error));
    }
    // Two units in the last place.
    hold("cosine of a third of an angle, too small", below, 1.2e-7);
    hold("cosine of a third of an angle, too great", above, 3e-6);
}

#[test]
fn texels_hold_the_moments() {
    let probe = Probe {
        head: "#import airlight::core::moment_bounds::Moments
               #import airlight::scattering::visibility_moments::{
                   pack_moments, unpack_moments, moments_from_depth, signed_depth
               }",
        body: "let m = Moments(vec3<f32>(input(0u), input(1u), input(2u)), vec3<f32>(input(3u), input(4u), input(5u)));
               let back = unpack_moments(pack_moments(m));
               for (var k = 0u; k < 3u; k++) { output(k, back.low[k]); output(3u + k, back.high[k]); }
               let own = moments_from_depth(input(6u));
               for (var k = 0u; k < 3u; k++) { output(6u + k, own.low[k]); output(9u + k, own.high[k]); }
               output(12u, signed_depth(input(6u)));",
        inputs: 7,
        outputs: 13,
    };
    let mut random = Random(403);
    let mut records: Vec<[f32; 7]> =
        (0..4000)
            .map(|_| {
                std::array::from_fn(|k| {
                    if k == 6 { random.unit() as f32 } else { random.between(-1.0, 1.0) as f32 }
                })
            })
            .collect();
    // Each field at its ends, alone.
    for k in 0..6 {
        for value in [-1.0, 1.0] {
            let mut record = [-value; 7];
            record[k] = value;
            records.push(record);
        }
    }
    let (mut stored, mut exact, mut depth) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (record, found) in records.iter().zip(probe.run(records.as_flattened()).chunks_exact(13)) {
        for k in 0..6 {
            stored = stored.max(f64::from((found[k] - record[k]).abs()));
        }
        let expected = reference::chebyshev_moments([(f64::from(record[6]), 1.0)]);
        for k in 0..6 {
            exact = exact.max((f64::from(found[6 + k]) - expected[k]).abs() / ((k + 1) * (k + 1)) as f64);
        }
        depth = depth.max((f64::from(found[12]) - reference::signed_depth(f64::from(record[6]))).abs());
    }
    hold("stored moments, in steps", stored / STEP, 0.57);
    // A depth off by one unit in the last place of f32 moves the moment of degree k by k^2 times that.
    hold("moments of a depth, over the square of the degree", exact, 2e-7);
    hold("signed depth", depth, 1.2e-7);
}

/// Runs `body` for each record, with the map bound as `map`; `input` and `output` as in a probe.
fn read(map: &Texture, body: &str, inputs: usize, outputs: usize, values: &[f32]) -> Vec<f32> {
    let head = "#import airlight::scattering::visibility_moments::{
                    unpack_moments, moments_visibility, moments_visibility_nearest
                }
                @group(#{GROUP}) @binding(2) var map: texture_2d<u32>;";
    Probe { head, body, inputs, outputs }.run_with(values, &[("map", map)])
}

/// All moments of a map, six a texel.
fn texels(map: &Texture) -> Vec<[f64; 6]> {
    let [width, height, _] = map.size();
    let places: Vec<f32> =
        (0..height).flat_map(|y| (0..width).flat_map(move |x| [x as f32, y as f32])).collect();
    let body = "let m = unpack_moments(textureLoad(map, vec2<u32>(vec2<f32>(input(0u), input(1u))), 0));
                for (var k = 0u; k < 3u; k++) { output(k, m.low[k]); output(3u + k, m.high[k]); }";
    read(map, body, 2, 6, &places).chunks_exact(6).map(|m| std::array::from_fn(|k| f64::from(m[k]))).collect()
}

/// The filtered moments of a rectified map; with medium and slices weighted by transmittance.
fn filtered(rectified: &Texture, weights: Option<(&Medium, &Texture)>) -> Texture {
    let [width, height, _] = rectified.size();
    let moments = Texture::storage(gpu(), [width, height], Rgba32Uint);
    let mut resources = vec![("rectified", rectified.into()), ("moments", (&moments).into())];
    let medium = weights.map(|(medium, _)| Buffer::uniform(gpu(), medium));
    if let (Some(medium), Some((_, slices))) = (&medium, weights) {
        resources.extend([("medium", medium.into()), ("slices", slices.into())]);
    }
    let permutation = if weights.is_some() { "default" } else { "average" };
    let pass = Pass::compute(gpu(), shaders(), "scattering/filter_moments", permutation).unwrap();
    let bound = pass.bind(gpu(), &resources).unwrap();
    let mut encoder = gpu().encoder();
    pass.dispatch(&mut encoder, &bound, [1, height, 1]);
    gpu().submit(encoder).unwrap();
    moments
}

/// Rows of all kinds.
fn rows(random: &mut Random, width: usize) -> Vec<Vec<f32>> {
    let mut rows = vec![vec![1.0; width], vec![0.0; width], vec![0.37; width], vec![0.951_234; width]];
    rows.push((0..width).map(|_| random.unit() as f32).collect());
    rows.push((0..width).map(|i| if i % 7 < 3 { 0.61 } else { 1.0 }).collect());
    rows.push((0..width).map(|i| 0.05 + 0.9 * i as f32 / width as f32).collect());
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 2.0, -0.0, 1e-40, 0.5];
    rows.push((0..width).map(|_| odd[random.below(odd.len())]).collect());
    rows
}

#[test]
fn filter_writes_prefix_means() {
    let _turn = gpu::turn();
    let mut random = Random(404);
    let medium = Medium::new(0.05, Vec3::ONE, 0.0, 100.0).unwrap();
    let (mut plain, mut weighted) = ([0.0_f64; 6], [0.0_f64; 6]);
    for width in [1, 2, 63, 64, 65, 1000, 4096] {
        let rows = rows(&mut random, width);
        let rectified = gpu::texture([width as u32, rows.len() as u32], R32Float, &rows.concat());
        // Optical depths over the row from nothing to what f32 cannot hold the transmittance of.
        let radii: [f32; 8] = [40.0, 1e-6, 40.0, 400.0, 40.0, 5.0, 4000.0, 40.0];
        let references: [f32; 8] = [0.8, 0.1, 1.0, 0.5, 0.3, 0.7, 0.2, 0.9];
        let slices: Vec<f32> = radii.iter().zip(references).flat_map(|(r, k)| [0.1, 1.2, *r, k]).collect();
        let slices = gpu::texture([8, 1], Rgba32Float, &slices);
        for (weights, worst) in [(None, &mut plain), (Some((&medium, &slices)), &mut weighted)] {
            let found = texels(&filtered(&rectified, weights));
            for (j, row) in rows.iter().enumerate() {
                let step = match weights {
                    None => 0.0,
                    Some(_) => {
                        f64::from(medium.extinction) * f64::from(radii[j])
                            / (width as f64 * f64::from(references[j]))
                    }
                };
                let (mut sums, mut total) = ([0.0; 6], 0.0);
                for (i, depth) in row.iter().enumerate() {
                    let depth = if depth.is_finite() { f64::from(*depth).clamp(0.0, 1.0) } else { 1.0 };
                    let weight = (-step * i as f64).exp();
                    let own = reference::chebyshev_moments([(depth, 1.0)]);
                    total += weight;
                    for k in 0..6 {
                        sums[k] += weight * own[k];
                        let error = (found[j * width + i][k] - sums[k] / total).abs();
                        assert!(error < 1e-4, "row {j} of {width}, texel {i}, moment {k}: off by {error:e}");
                        worst[k] = worst[k].max(error);
                    }
                }
            }
        }
    }
    println!(
        "in steps of the storage: plain {:.2?}, weighted {:.2?}",
        plain.map(|e| e / STEP),
        weighted.map(|e| e / STEP)
    );
    for k in 0..6_usize {
        // Half a step of storage, what f32 makes of the depth, and one step for the sums.
        let budget = 0.5 * STEP + 1.2e-7 * ((k + 1) * (k + 1)) as f64 + STEP;
        hold(&format!("moment {}, plain", k + 1), plain[k], budget);
        hold(&format!("moment {}, weighted", k + 1), weighted[k], budget);
    }
}

#[test]
fn reads_are_nearest_or_bilinear() {
    let _turn = gpu::turn();
    let mut random = Random(405);
    for [width, height] in [[37, 9], [1, 1], [2, 1], [1, 5]] {
        let depths: Vec<f32> = (0..width * height)
            .map(|_| if random.unit() < 0.4 { 1.0 } else { random.unit() as f32 })
            .collect();
        let map = filtered(&gpu::texture([width as u32, height as u32], R32Float, &depths), None);
        let held = texels(&map);
        let mut values = Vec::new();
        for i in 0..3000 {
            let inside = [random.between(0.5, width as f64 - 0.5), random.between(0.0, height as f64)];
            let place = match i % 3 {
                0 => inside,
                // Whole texels, and places outside of the map.
                1 => [random.below(width + 1) as f64 + 0.5, random.below(height + 1) as f64],
                _ => [random.between(-3.0, width as f64 + 3.0), random.between(-2.0, height as f64 + 2.0)],
            };
            let wraps = f64::from(u8::from(i % 2 == 0));
            let texel = [random.below(width) as f64, random.below(height) as f64];
            values.extend(
                [place[0], place[1], wraps, random.between(0.05, 0.95), texel[0], texel[1]].map(|v| v as f32),
            );
        }
        let body = "output(0u, moments_visibility(map, vec2<f32>(input(0u), input(1u)), input(2u) > 0.5, input(3u)));
                    let texel = vec2<u32>(vec2<f32>(input(4u), input(5u)));
                    output(1u, moments_visibility_nearest(map, texel, input(3u)));";
        let found = read(&map, body, 6, 2, &values);
        let expected = |moments: &[f64; 6], depth: f64| {
            let (low, high) = reference::visibility_bounds(moments, BIAS, depth);
            BLEND * low + (1.0 - BLEND) * high
        };
        let (mut bilinear, mut nearest) = (0.0_f64, 0.0_f64);
        for (record, found) in values.chunks_exact(6).zip(found.chunks_exact(2)) {
            let [x, y, wraps, depth, i, j] = std::array::from_fn(|k| f64::from(record[k]));
            let x = (x - 0.5).clamp(0.0, width as f64 - 1.0);
            let top = if wraps > 0.5 { height as f64 } else { height as f64 - 1.0 };
            let y = y.clamp(0.0, top);
            let row = |y: usize| if wraps > 0.5 { y % height } else { y.min(height - 1) };
            let mut moments = [0.0; 6];
            for (column, part) in [(x.floor(), 1.0 - x.fract()), (x.floor() + 1.0, x.fract())] {
                for (line, share) in [(y.floor(), 1.0 - y.fract()), (y.floor() + 1.0, y.fract())] {
                    let texel = row(line as usize) * width + (column as usize).min(width - 1);
                    for k in 0..6 {
                        moments[k] += part * share * held[texel][k];
                    }
                }
            }
            bilinear = bilinear.max((f64::from(found[0]) - expected(&moments, depth)).abs());
            let texel = &held[j as usize * width + i as usize];
            nearest = nearest.max((f64::from(found[1]) - expected(texel, depth)).abs());
        }
        hold(&format!("{width} x {height}, bilinear"), bilinear, 2e-3);
        hold(&format!("{width} x {height}, nearest"), nearest, 2e-3);
    }
}

/// Mean and greatest error of visibility on a scene.
#[derive(Debug, Default)]
struct Errors {
    mean: f64,
    greatest: f64,
}

#[test]
fn errors_on_scenes_are_those_of_the_book() {
    let _turn = gpu::turn();
    // Bounds of the mean errors of plain means and of means by transmittance, and of the greatest of either.
    for (name, means, greatest) in [
        ("foliage", [0.0107, 0.0101], 0.2),
        ("torus", [0.01, 0.0123], 0.11),
        ("plane", [0.0099, 0.0087], 0.15),
        ("terrain", [0.005, 0.0047], 0.18),
    ] {
        let scene = scenes::scene(name).unwrap().unwrap();
        let view = scene.view.perspective().unwrap();
        let stage = Stage::new(gpu(), gpu::raster(), &scene.setting(), PICTURE, [1024, 1024]).unwrap();
        let map = Rectification::new(gpu(), shaders(), [1024, 1024]).unwrap();
        let bound = map.bind(gpu(), &stage.inputs()).unwrap();
        let mut encoder = gpu().encoder();
        map.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        let rectified = map.rectified.read(gpu()).unwrap();
        let extinction = f64::from(stage.medium.extinction);
        // The row next to each pixel, where its ray ends in it, and what is visible of it.
        let rays = gpu::of_pixels(&stage, &view, &map, |rectification, ray| {
            let j = ray.nearest();
            let end = ray.end(rectification, j, extinction);
            (j, end, reference::row_visibility(&rectified[j * 1024..(j + 1) * 1024], end))
        });
        let values: Vec<f32> = rays
            .iter()
            .flat_map(|(j, end, _)| [(end.s - 0.5).max(0.5) as f32, *j as f32, end.z as f32])
            .collect();
        let body = "output(0u, moments_visibility(map, vec2<f32>(input(0u), input(1u)), false, input(2u)));";
        for (weighting, weights, mean) in
            [("average", None, means[0]), ("transmittance", Some((&stage.medium, &map.slices)), means[1])]
        {
            let found = read(&filtered(&map.rectified, weights), body, 3, 1, &values);
            let mut errors = Errors::default();
            for (found, (_, _, exact)) in found.iter().zip(&rays) {
                let exact = if weights.is_some() { exact.weighted } else { exact.average };
                let error = (f64::from(*found) - exact).abs();
                errors.mean += error / rays.len() as f64;
                errors.greatest = errors.greatest.max(error);
            }
            println!("{name}, {weighting}: mean {:.4}, greatest {:.2}", errors.mean, errors.greatest);
            assert!(errors.mean < mean && errors.greatest < greatest, "{name}, {weighting}: {errors:?}");
        }
    }
}

/// Size of the pictures.
const PICTURE: [u32; 2] = [480, 270];

/// Moments of a map of 1024 x 1024 texels, read and weighted in one of the ways there are; no march near the epipole.
fn settings(filtering: Filtering, weighting: Weighting) -> Settings {
    Settings {
        visibility: Visibility::Moments,
        map: [1024, 1024],
        filtering,
        weighting,
        epipole_march: false,
        ..Settings::default()
    }
}

/// A picture, four values a pixel, and the map that it came from.
fn picture(inputs: &Inputs<'_>, settings: Settings) -> (Vec<f32>, Rectification) {
    let method = Prefiltered::new(gpu(), shaders(), settings, PICTURE).unwrap();
    let bound = method.bind(gpu(), inputs).unwrap();
    let mut encoder = gpu().encoder();
    method.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    (method.scattered.read(gpu()).unwrap(), method.rectification)
}

#[test]
fn pictures_are_near_the_exact_ones() {
    let _turn = gpu::turn();
    let reads = [Filtering::Linear, Filtering::Nearest];
    let mut failures = Vec::new();
    // Bounds of the mean errors of plain means and of means by transmittance; of the greatest error; and of the relative
    // root of the mean square of radiance.
    for (name, means, greatest, radiance) in [
        ("foliage", [0.0109, 0.0104], 0.22, 0.013),
        ("torus", [0.0103, 0.0125], 0.105, 0.0195),
        ("plane", [0.0102, 0.0089], 0.155, 0.02),
        ("terrain", [0.0056, 0.0051], 0.175, 0.0085),
    ] {
        let scene = scenes::scene(name).unwrap().unwrap();
        let view = scene.view.perspective().unwrap();
        let stage = Stage::new(gpu(), gpu::raster(), &scene.setting(), PICTURE, [1024, 1024]).unwrap();
        let mut exact = None;
        for (filtering, weighting) in
            reads.into_iter().flat_map(|r| [Weighting::Average, Weighting::Transmittance].map(|w| (r, w)))
        {
            let (found, map) = picture(&stage.inputs(), settings(filtering, weighting));
            let exact = exact.get_or_insert_with(|| gpu::exact_picture(&stage, &view, &map, 1));
            let visibility: Vec<f32> = found.chunks_exact(4).map(|texel| texel[3]).collect();
            let colours: Vec<f32> = found.chunks_exact(4).flat_map(|texel| texel[..3].to_vec()).collect();
            let (truth, mean) = match weighting {
                Weighting::Average => (exact.average(), means[0]),
                Weighting::Transmittance => (exact.weighted(), means[1]),
            };
            let errors = Errors {
                mean: error::mean_absolute(&visibility, &truth),
                greatest: error::max_absolute(&visibility, &truth),
            };
            // The exact radiance is weighted by transmittance.
            let relative = match weighting {
                Weighting::Average => 0.0,
                Weighting::Transmittance => error::relative_rmse(&colours, &exact.radiance()),
            };
            let what = format!("{name}, {filtering:?}, {weighting:?}");
            println!("{what}: mean {:.4}, greatest {:.3}", errors.mean, errors.greatest);
            if relative > 0.0 {
                println!("    radiance {:.2} %", 100.0 * relative);
            }
            if !(errors.mean <= mean && errors.greatest <= greatest && relative <= radiance) {
                failures.push(what);
            }
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

#[test]
fn no_permutation_gives_nan_or_a_value_out_of_range() {
    let _turn = gpu::turn();
    for scene in [gpu::torus_over_plane(), gpu::small_tree()] {
        let stage = scene.stage(PICTURE, [512, 512]);
        for index in 0..16 {
            let bit = |k: usize| index >> k & 1 == 1;
            let filtering = if bit(0) { Filtering::Nearest } else { Filtering::Linear };
            let weighting = if bit(1) { Weighting::Average } else { Weighting::Transmittance };
            let settings = Settings {
                map: [256, 256],
                epipole_march: bit(2),
                start: if bit(3) { Start::NearPlane } else { Start::Eye },
                ..settings(filtering, weighting)
            };
            let (found, _) = picture(&stage.inputs(), settings);
            let fine = |texel: &[f32]| texel.iter().all(|v| v.is_finite() && *v >= 0.0) && texel[3] <= 1.0;
            assert!(found.chunks_exact(4).all(fine), "{settings:?}");
            let mean = found.chunks_exact(4).map(|texel| f64::from(texel[3])).sum::<f64>() / (480.0 * 270.0);
            assert!((0.2..0.98).contains(&mean), "{settings:?}: {mean}");
        }
    }
}

#[test]
fn what_moments_cannot_do_is_refused() {
    let plain = settings(Filtering::Linear, Weighting::Average);
    let spot = LightForm { spot: true, ..LightForm::default() };
    let texture = LightForm { texture: true, ..LightForm::default() };
    let point = LightForm { point: true, shadow_array: true, ..LightForm::default() };
    let refused = |error: Option<ScatteringError>, needed: &str| {
        let Some(ScatteringError::Settings(error)) = error else { panic!("{error:?} instead of: {needed}") };
        assert!(matches!(error, SettingsError::Visibility { method: "moments", .. }), "{error:?}");
        let sentence = format!("the method `moments` needs {needed}; `fourier` does without");
        assert_eq!(error.to_string(), sentence);
    };
    refused(
        Prefiltered::new(gpu(), shaders(), Settings { regions: 3, ..plain }, PICTURE).err(),
        "rows in one region",
    );
    let map = || ProjectiveMap::drawn(gpu(), plain.map).unwrap();
    let parts = Settings { regions: 3, ..plain };
    refused(ProjectivePrefiltered::new(gpu(), shaders(), map(), parts, PICTURE).err(), "rows in one region");
    // All lights and rows, with and without colours.
    for light in [LightForm::default(), spot, LightForm { texture: true, ..spot }, texture, point] {
        let method = Prefiltered::new(gpu(), shaders(), Settings { light, map: [64, 16], ..plain }, [16, 16]);
        let method = method.unwrap();
        let layers = light.colors().map_or(1, |colors| colors + 1);
        assert_eq!(method.prefilter.stored().size(), [64, 16, layers]);
        assert_eq!(method.prefilter.memory(), u64::from(64 * 16 * layers * 16));
    }
    assert!(ProjectivePrefiltered::new(gpu(), shaders(), map(), plain, PICTURE).is_ok());
}
