// SPDX-License-Identifier: MIT OR Apache-2.0
//! Six moments of columns with weights and fall-offs of their own on the GPU: the filter against f64 prefix means whatever
//! the weights, and its reads against the f64 reference. Pictures are compared in `scattering/local_lights.rs` and `scattering/projective/pictures.rs`.

use crate::given_weights::GIVEN_WEIGHTS;
use crate::gpu::{self, Probe, Random, gpu};
use crate::probing::hold;
use airlight::validate::{Definitions, Library};
use airlight::{Pass, Shaders, Texture};
use airlight_tests::reference::scattering as reference;
use wgpu::TextureFormat::{R32Float, Rgba32Float, Rgba32Uint};
use wgpu::TextureUsages;

/// MOMENT_BIAS and MOMENT_BLEND of the shader.
const BIAS: f64 = 1e-5;
const BLEND: f64 = 0.15;
/// One step of a stored moment.
const STEP: f64 = 2.0 / 2_097_151.0;

/// The filter for 1 or 3 colours, with the callback of the tests.
fn filter(colors: u32) -> Pass {
    let folder = gpu::copy_of_wgsl();
    std::fs::write(folder.path().join("scattering/column_weights.wgsl"), GIVEN_WEIGHTS).unwrap();
    let shaders = Shaders::from_library(Library::from_directory(folder.path()).unwrap());
    let definitions = Definitions::new().set("COLORS", colors as i32);
    let definitions = if colors == 3 { definitions.flag("LIGHT_TEXTURE") } else { definitions };
    match Pass::compute_with(gpu(), &shaders, "scattering/filter_moments", &definitions) {
        Ok(pass) => pass,
        Err(error) => panic!("the filter does not compose: {error}"),
    }
}

/// What `pass` stores of rows and, for each texel, fall-off and weight.
fn filtered(pass: &Pass, colors: u32, rows: &[Vec<f32>], given: &[[f32; 4]]) -> Texture {
    let size = [rows[0].len() as u32, rows.len() as u32];
    let usage = TextureUsages::STORAGE_BINDING | TextureUsages::TEXTURE_BINDING;
    let rectified = gpu::texture(size, R32Float, &rows.concat());
    let given = gpu::texture(size, Rgba32Float, given.as_flattened());
    let moments = Texture::array(gpu(), [size[0], size[1], colors + 1], Rgba32Uint, usage);
    let resources =
        [("given", (&given).into()), ("rectified", (&rectified).into()), ("moments", (&moments).into())];
    let bound = pass.bind_known(gpu(), &resources).unwrap();
    let mut encoder = gpu().encoder();
    pass.dispatch(&mut encoder, &bound, [1, size[1], 1]);
    gpu().submit(encoder).unwrap();
    moments
}

/// Runs `body` for each record, with the map bound as `map` and `COLORS` replaced.
fn read(map: &Texture, body: &str, inputs: usize, outputs: usize, values: &[f32]) -> Vec<f32> {
    let head = "#import airlight::scattering::visibility_moments::{
                    unpack_moments, moments_color, moments_color_nearest
                }
                @group(#{GROUP}) @binding(2) var map: texture_2d_array<u32>;";
    let body = body.replace("COLORS", &format!("{}u", map.size()[2] - 1));
    Probe { head, body: &body, inputs, outputs }.run_with(values, &[("map", map)])
}

/// Six moments and the mean fall-off of a `color` of every texel.
fn texels(map: &Texture, color: u32) -> Vec<[f64; 7]> {
    let [width, height, _] = map.size();
    let places: Vec<f32> =
        (0..height).flat_map(|y| (0..width).flat_map(move |x| [x as f32, y as f32, color as f32])).collect();
    let body = "let at = vec2<u32>(vec2<f32>(input(0u), input(1u)));
                let color = u32(input(2u));
                let m = unpack_moments(textureLoad(map, at, color, 0));
                for (var k = 0u; k < 3u; k++) { output(k, m.low[k]); output(3u + k, m.high[k]); }
                output(6u, bitcast<vec4<f32>>(textureLoad(map, at, COLORS, 0))[color]);";
    read(map, body, 3, 7, &places).chunks_exact(7).map(|m| std::array::from_fn(|k| f64::from(m[k]))).collect()
}

/// Rows of depths, odd ones among them.
fn rows(random: &mut Random, count: usize, width: usize) -> Vec<Vec<f32>> {
    let odd = [f32::NAN, f32::INFINITY, -1.0, 2.0, 1e-40, 0.5];
    (0..count)
        .map(|j| {
            (0..width)
                .map(|i| match j % 4 {
                    0 => random.unit() as f32,
                    1 => [0.61, 1.0][usize::from(i % 7 < 3)],
                    2 => 0.05 + 0.9 * i as f32 / width as f32,
                    _ => odd[random.below(odd.len())],
                })
                .collect()
        })
        .collect()
}

/// Kinds of weights.
const WEIGHTS: usize = 8;

/// Fall-off and weight of each column, of a kind.
fn weights_of_kind(random: &mut Random, kind: usize, width: usize) -> Vec<[f32; 4]> {
    let rate = random.magnitude(1e-5, 0.3);
    let heavy = random.below(width);
    let edge = random.unit();
    (0..width)
        .map(|i| {
            let along = i as f64 / width as f64;
            let weight = match kind {
                0 => 1.0,
                1 => random.unit() + 1e-3,
                2 => (-rate * i as f64).exp(),
                // Of a projective row whose lengths span a million.
                3 => 1e-3 / (1.0 - along * 0.999).powi(2),
                4 => random.magnitude(1e-6, 1.0),
                5 => [1.0, 1e4][usize::from(i == heavy)],
                // Nothing here and there.
                6 => [1.0, 0.0][usize::from(i / 17 % 3 == 1)],
                _ => 1e-12 * (1.0 + along),
            };
            let falloff = match kind % 3 {
                0 => [1.0 - 0.7 * along, along, 1.0],
                1 => [random.unit(), random.unit(), 0.0],
                _ => [if along < edge { 1.0 } else { 0.0 }, along * along, 1e-3 * random.unit()],
            };
            [falloff[0] as f32, falloff[1] as f32, falloff[2] as f32, weight as f32]
        })
        .collect()
}

#[test]
fn filter_takes_weights_and_fall_offs() {
    let mut random = Random(411);
    for colors in [1, 3] {
        let pass = filter(colors);
        let (mut worst, mut of_falloff, mut compared) = ([0.0_f64; 6], 0.0_f64, 0);
        for width in [1, 8, 65, 1000] {
            let rows = rows(&mut random, 2 * WEIGHTS, width);
            let given: Vec<_> =
                (0..rows.len()).flat_map(|j| weights_of_kind(&mut random, j / 2, width)).collect();
            let map = filtered(&pass, colors, &rows, &given);
            for color in 0..colors {
                let found = texels(&map, color);
                for (j, row) in rows.iter().enumerate() {
                    let (mut sums, mut light, mut total) = ([0.0; 6], 0.0, 0.0);
                    for (i, depth) in row.iter().enumerate() {
                        let texel = j * width + i;
                        let depth = if depth.is_finite() { f64::from(*depth).clamp(0.0, 1.0) } else { 1.0 };
                        let own = reference::chebyshev_moments([(depth, 1.0)]);
                        let weight = f64::from(given[texel][3]);
                        let part = weight * f64::from(given[texel][color as usize]);
                        total += weight;
                        light += part;
                        of_falloff = of_falloff.max((found[texel][6] - light / total).abs());
                        for k in 0..6 {
                            sums[k] += part * own[k];
                            // What is read: fall-off times moments.
                            let product = found[texel][6] * found[texel][k];
                            let error = (product - sums[k] / total).abs();
                            assert!(
                                error < 1e-4,
                                "row {j} of {width}, texel {i}, color {color}, moment {k}: {error:e}"
                            );
                            worst[k] = worst[k].max(error);
                            compared += usize::from(light > 0.0);
                        }
                    }
                }
            }
        }
        println!("{colors} colours: {compared} moments, in steps {:.2?}", worst.map(|e| e / STEP));
        hold("fall-off", of_falloff, 5e-7);
        for (k, worst) in worst.into_iter().enumerate() {
            // Half a step of storage, what f32 makes of the depth, and one step for the sums.
            let budget = 0.5 * STEP + 1.2e-7 * ((k + 1) * (k + 1)) as f64 + STEP;
            hold(&format!("moment {}", k + 1), worst, budget);
        }
        assert!(compared > 50_000, "{compared}");
    }
}

#[test]
fn reads_of_colours_mix_fall_off_times_moments() {
    let mut random = Random(412);
    for (colors, [width, height]) in [(3, [37, 9]), (1, [37, 9]), (3, [1, 1]), (3, [1, 5])] {
        let rows = rows(&mut random, height, width);
        let given: Vec<_> = (0..height)
            .flat_map(|_| {
                let kind = random.below(WEIGHTS);
                weights_of_kind(&mut random, kind, width)
            })
            .collect();
        let map = filtered(&filter(colors), colors, &rows, &given);
        let held: Vec<_> = (0..colors).map(|color| texels(&map, color)).collect();
        let mut values = Vec::new();
        for i in 0..3000 {
            let place = match i % 3 {
                0 => [random.between(0.5, width as f64 - 0.5), random.between(0.0, height as f64)],
                1 => [random.below(width + 1) as f64 + 0.5, random.below(height + 1) as f64],
                _ => [random.between(-3.0, width as f64 + 3.0), random.between(-2.0, height as f64 + 2.0)],
            };
            let color = random.below(colors as usize) as f64;
            let texel = [random.below(width) as f64, random.below(height) as f64];
            let own = [random.between(0.05, 0.95), texel[0], texel[1], color];
            values.extend([place[0], place[1], f64::from(i % 2)].iter().chain(&own).map(|v| *v as f32));
        }
        let body = "let color = u32(input(6u));
                    let place = vec2<f32>(input(0u), input(1u));
                    output(0u, moments_color(map, place, input(2u) > 0.5, color, COLORS, input(3u)));
                    let texel = vec2<u32>(vec2<f32>(input(4u), input(5u)));
                    output(1u, moments_color_nearest(map, texel, color, COLORS, input(3u)));";
        let found = read(&map, body, 7, 2, &values);
        // Of texels and their shares: the mean fall-off times the visibility of the light that there is.
        let expected = |parts: &[([f64; 7], f64)], depth: f64| {
            let light: f64 = parts.iter().map(|(texel, share)| share * texel[6]).sum();
            if light < 1e-12 {
                return light;
            }
            let moments = std::array::from_fn(|k| {
                parts.iter().map(|(texel, share)| share * texel[6] * texel[k]).sum::<f64>() / light
            });
            let (low, high) = reference::visibility_bounds(&moments, BIAS, depth);
            light * (BLEND * low + (1.0 - BLEND) * high)
        };
        let (mut bilinear, mut nearest, mut lit) = (0.0_f64, 0.0_f64, 0.0);
        for (record, found) in values.chunks_exact(7).zip(found.chunks_exact(2)) {
            let [x, y, wraps, depth, i, j, color] = std::array::from_fn(|k| f64::from(record[k]));
            let held = &held[color as usize];
            let x = (x - 0.5).clamp(0.0, width as f64 - 1.0);
            let y = y.clamp(0.0, if wraps > 0.5 { height as f64 } else { height as f64 - 1.0 });
            let row = |y: usize| if wraps > 0.5 { y % height } else { y.min(height - 1) };
            let mut parts = Vec::new();
            for (column, part) in [(x.floor(), 1.0 - x.fract()), (x.floor() + 1.0, x.fract())] {
                for (line, share) in [(y.floor(), 1.0 - y.fract()), (y.floor() + 1.0, y.fract())] {
                    let texel = row(line as usize) * width + (column as usize).min(width - 1);
                    parts.push((held[texel], part * share));
                }
            }
            let off = (f64::from(found[0]) - expected(&parts, depth)).abs();
            bilinear = if off <= bilinear { bilinear } else { off };
            let texel = held[j as usize * width + i as usize];
            let off = (f64::from(found[1]) - expected(&[(texel, 1.0)], depth)).abs();
            nearest = if off <= nearest { nearest } else { off };
            lit += f64::from(found[0]) / 3000.0;
        }
        println!("{colors} colours, {width} x {height}: mean {lit:.3}");
        hold(&format!("{width} x {height}, bilinear"), bilinear, 2e-3);
        hold(&format!("{width} x {height}, nearest"), nearest, 2e-3);
        assert!((0.01..0.95).contains(&lit), "{lit}");
    }
}
