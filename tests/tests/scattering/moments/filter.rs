// SPDX-License-Identifier: MIT OR Apache-2.0
//! What texels hold, the filter against prefix means, and reads of its results.

use super::bounds::{BIAS, BLEND, STEP};
use crate::gpu::{self, Probe, Random, gpu, shaders};
use crate::probing::hold;
use airlight::scattering::Medium;
use airlight::{Buffer, Pass, Texture};
use airlight_tests::reference::scattering as reference;
use glam::Vec3;
use wgpu::TextureFormat::{R32Float, Rgba32Float, Rgba32Uint};

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
pub fn read(map: &Texture, body: &str, inputs: usize, outputs: usize, values: &[f32]) -> Vec<f32> {
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
pub fn filtered(rectified: &Texture, weights: Option<(&Medium, &Texture)>) -> Texture {
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
