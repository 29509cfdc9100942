// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rank structures over columns with weights of their own on the GPU, held to a brute-force sum over the stepped map
//! within their proven bound, whatever the weights. Pictures are compared in `scattering/local_lights.rs` and `scattering/projective/pictures.rs`.

use crate::given_weights::GIVEN_WEIGHTS;
use crate::gpu::{self, Random, gpu};
use crate::rank_rows::{KINDS, row_of_kind};
use airlight::validate::{Definitions, Library};
use airlight::{Buffer, Pass, Shaders, Texture};
use airlight_tests::reference::scattering::{SteppedRow, depth_step};
use wgpu::TextureFormat::{R32Float, R32Uint, Rg32Uint, Rgba32Float, Rgba32Uint};
use wgpu::TextureUsages;

/// Bits of a depth.
const BITS: u32 = 12;
/// What f32 makes of sums of up to 2048 weights, and of their difference.
const ROUNDING: f64 = 1e-5;

const QUERY: &str = "#import airlight::scattering::visibility_rank_weights::rank_means
@group(#{GROUP}) @binding(0) var<storage, read> inputs: array<f32>;
@group(#{GROUP}) @binding(1) var<storage, read_write> outputs: array<f32>;
@group(#{GROUP}) @binding(2) var rank_cells: texture_2d<u32>;
@group(#{GROUP}) @binding(3) var rank_starts: texture_2d<u32>;
@group(#{GROUP}) @binding(4) var rank_planes: texture_2d_array<u32>;
@group(#{GROUP}) @binding(5) var rank_weights: texture_2d_array<u32>;
@group(#{GROUP}) @binding(6) var rectified: texture_2d<f32>;
@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    let at = 3u * id.x;
    if at >= arrayLength(&inputs) { return; }
    let means = rank_means(
        rank_cells, rank_starts, rank_planes, rank_weights, BITSu, WEIGHT_BITSu, COLORSu,
        textureDimensions(rectified).x, u32(inputs[at]), inputs[at + 1u], inputs[at + 2u]
    );
    outputs[at] = means.x; outputs[at + 1u] = means.y; outputs[at + 2u] = means.z;
}
";

/// The passes for a number of colours and bits of a weight.
struct Passes {
    colors: u32,
    weight_bits: u32,
    build: Pass,
    query: Pass,
}

impl Passes {
    fn new(colors: u32, weight_bits: u32) -> Self {
        let folder = gpu::copy_of_wgsl();
        std::fs::write(folder.path().join("scattering/column_weights.wgsl"), GIVEN_WEIGHTS).unwrap();
        let query = QUERY
            .replace("WEIGHT_BITSu", &format!("{weight_bits}u"))
            .replace("BITSu", &format!("{BITS}u"))
            .replace("COLORSu", &format!("{colors}u"));
        std::fs::write(folder.path().join("core/passes/probe.wgsl"), query).unwrap();
        let shaders = Shaders::from_library(Library::from_directory(folder.path()).unwrap());
        let definitions = Definitions::new().set("RANK", BITS as i32).set("WEIGHT_BITS", weight_bits as i32);
        let definitions = match colors {
            0 => definitions,
            1 => definitions.set("COLORS", 1),
            _ => definitions.set("COLORS", 3).flag("LIGHT_TEXTURE"),
        };
        let build = Pass::compute_with(gpu(), &shaders, "scattering/rank_weights", &definitions);
        let query = Pass::compute_with(gpu(), &shaders, "core/probe", &Definitions::new());
        let composed = |pass: Result<Pass, _>| match pass {
            Ok(pass) => pass,
            Err(error) => panic!("a pass does not compose: {error}"),
        };
        Self { colors, weight_bits, build: composed(build), query: composed(query) }
    }

    /// Means for queries of row, texels and depth, over rows and, for each texel, fall-off and weight.
    fn ask(&self, rows: &[Vec<f32>], given: &[[f32; 4]], queries: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let (width, height) = (rows[0].len() as u32, rows.len() as u32);
        let blocks = width.div_ceil(32);
        let channels = self.colors + 1;
        let layers = 3 + (channels + self.colors.max(1)) * self.weight_bits / 4;
        let usage = TextureUsages::STORAGE_BINDING | TextureUsages::TEXTURE_BINDING;
        let rectified = gpu::texture([width, height], R32Float, &rows.concat());
        let given = gpu::texture([width, height], Rgba32Float, given.as_flattened());
        let cells = if self.colors == 3 { Rgba32Uint } else { Rg32Uint };
        let cells = Texture::storage(gpu(), [blocks * blocks, height], cells);
        let starts = Texture::storage(gpu(), [1 << (BITS - 1), height], R32Uint);
        let planes = Texture::array(gpu(), [blocks, height, 3], Rgba32Uint, usage);
        let weights = Texture::array(gpu(), [blocks, height, layers], Rgba32Uint, usage);
        let bytes: Vec<u8> = queries.as_flattened().iter().flat_map(|value| value.to_le_bytes()).collect();
        let from = Buffer::with_bytes(gpu(), &bytes, wgpu::BufferUsages::STORAGE);
        let to = Buffer::storage(gpu(), bytes.len() as u64);
        let resources = [
            ("given", (&given).into()),
            ("rectified", (&rectified).into()),
            ("rank_cells", (&cells).into()),
            ("rank_starts", (&starts).into()),
            ("rank_planes", (&planes).into()),
            ("rank_weights", (&weights).into()),
            ("inputs", (&from).into()),
            ("outputs", (&to).into()),
        ];
        let build = self.build.bind_known(gpu(), &resources).unwrap();
        let query = self.query.bind_known(gpu(), &resources).unwrap();
        let mut encoder = gpu().encoder();
        self.build.dispatch(&mut encoder, &build, [64 * height, 1, 1]);
        self.query.dispatch(&mut encoder, &query, [queries.len() as u32, 1, 1]);
        gpu().submit(encoder).unwrap();
        let found = to.read_floats(gpu()).unwrap();
        found.chunks_exact(3).take(queries.len()).map(|means| [means[0], means[1], means[2]]).collect()
    }
}

/// Kinds of weights.
const WEIGHTS: usize = 9;

/// Fall-off and weight of each column, of a kind.
fn weights_of_kind(random: &mut Random, kind: usize, row: &[f32]) -> Vec<[f32; 4]> {
    let width = row.len();
    let (from, to) = (random.between(0.2, 1.0), random.between(0.0, 1.0));
    let rate = random.magnitude(1e-5, 0.3);
    let heavy = random.below(width);
    (0..width)
        .map(|i| {
            let along = i as f64 / width as f64;
            let weight = match kind {
                0 => 1.0,
                1 => random.unit(),
                2 => (-rate * i as f64).exp(),
                // Of a projective row, of an eye so near to its first texel that lengths span a million.
                3 => 1e-3 / (1.0 - along * 0.999).powi(2),
                4 => random.magnitude(1e-6, 1.0),
                // One that outweighs all others together.
                5 if i == heavy => 1e4,
                // Nothing where the row begins, ends, or here and there.
                6 if i / 17 % 3 != 1 => 0.0,
                7 => 1e-12 * (1.0 + along),
                // Dark columns are heavy at one end of the chunks and light at the other.
                8 => {
                    if (row[i] * 57.0).fract() < 0.5 {
                        1.0
                    } else {
                        1e-3
                    }
                }
                _ => 1.0,
            };
            let smooth = from + (to - from) * along;
            let falloff = match kind % 3 {
                0 => [smooth, 1.0 - smooth, 1.0],
                1 => [random.unit(), random.unit(), 0.0],
                _ => [if along < to { 1.0 } else { 0.0 }, smooth * smooth, random.unit()],
            };
            [falloff[0] as f32, falloff[1] as f32, falloff[2] as f32, weight as f32]
        })
        .collect()
}

fn queries(random: &mut Random, rows: &[Vec<f32>], count: usize) -> Vec<[f32; 3]> {
    let width = rows[0].len() as f64;
    (0..count)
        .map(|_| {
            let row = random.below(rows.len());
            let texels = match random.below(8) {
                0 => [0.0, 1e-4, 0.5, width, 2.0 * width][random.below(5)],
                1 => (32 * random.below(rows[row].len().div_ceil(32) + 1)) as f64,
                2 => (1 + random.below(rows[row].len())) as f64,
                _ => random.between(0.0, width),
            };
            let stored = rows[row][random.below(rows[row].len())];
            let depth = match random.below(4) {
                0 => [0.0, 1.0, -0.5, 1.5][random.below(4)],
                1 => random.below(4096) as f32 / 4095.0,
                _ if stored.is_finite() => stored,
                _ => 1.0,
            };
            [row as f32, texels as f32, depth]
        })
        .collect()
}

/// The bound on the error of a mean: `2 n B + m C` half steps over the weight that is covered.
fn bound(row: &SteppedRow, stored: &[f32], weights: &[f64], query: [f32; 3], weight_bits: u32) -> f64 {
    let (texels, depth) = (f64::from(query[1]), f64::from(query[2]));
    let width = weights.len();
    let covered = texels.max(1e-3).min(width as f64);
    let last = (covered.floor() as usize).min(width - 1);
    let block = last / 32 * 32;
    let greatest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let heaviest = greatest(&mut weights[block..width.min(block + 32)].iter().copied());
    let columns = (covered - block as f64).ceil();
    let sorted = row.sorted_columns();
    let ray = depth_step(depth, BITS);
    let dark = stored.iter().filter(|&&z| depth_step(f64::from(z), BITS) < ray).count();
    let chunk = (dark / 32).min(width.div_ceil(32) - 1) * 32;
    let of_chunk = greatest(&mut sorted[chunk..width.min(chunk + 32)].iter().map(|&column| weights[column]));
    let meant = sorted[chunk..dark.min(chunk + 32)].iter().filter(|&&column| column < block).count();
    let (_, total) = row.lit_weight(texels, depth, weights);
    let steps = f64::from((1_u32 << weight_bits) - 1);
    (2.0 * columns * heaviest + meant as f64 * of_chunk) / (2.0 * steps * total) + ROUNDING
}

#[test]
fn means_err_by_no_more_than_proven_whatever_the_weights() {
    let mut random = Random(701);
    let mut failures = Vec::new();
    for (colors, weight_bits) in [(0, 16), (0, 8), (1, 8), (3, 8), (3, 16)] {
        let passes = Passes::new(colors, weight_bits);
        let (mut asked, mut partly, mut mean, mut greatest, mut tightest) = (0, 0, 0.0, 0.0_f64, 0.0_f64);
        for width in [1, 31, 33, 1000, 2048] {
            let rows: Vec<Vec<f32>> =
                (0..KINDS * WEIGHTS).map(|i| row_of_kind(&mut random, i % KINDS, width, BITS)).collect();
            let given: Vec<Vec<[f32; 4]>> = rows
                .iter()
                .enumerate()
                .map(|(i, row)| weights_of_kind(&mut random, i / KINDS, row))
                .collect();
            let queries = queries(&mut random, &rows, 4000);
            let found = passes.ask(&rows, &given.concat(), &queries);
            assert!(found == passes.ask(&rows, &given.concat(), &queries), "not the same bits again");
            let stepped: Vec<SteppedRow> = rows.iter().map(|row| SteppedRow::new(row, BITS)).collect();
            for (query, found) in queries.iter().zip(found) {
                let index = query[0] as usize;
                let row = &stepped[index];
                let plain: Vec<f64> = given[index].iter().map(|texel| f64::from(texel[3])).collect();
                let (texels, depth) = (f64::from(query[1]), f64::from(query[2]));
                let (lit, total) = row.lit_weight(texels, depth, &plain);
                partly += usize::from(0.0 < lit && lit < total);
                let inside = found.iter().all(|value| (0.0..=1.0).contains(value));
                let bound = bound(row, &rows[index], &plain, *query, weight_bits);
                for channel in 0..colors.max(1) as usize {
                    let off = if total > 0.0 {
                        let falloff =
                            |texel: &[f32; 4]| if colors > 0 { f64::from(texel[channel]) } else { 1.0 };
                        let weights: Vec<f64> =
                            plain.iter().zip(&given[index]).map(|(w, texel)| w * falloff(texel)).collect();
                        let exact = row.lit_weight(texels, depth, &weights).0 / total;
                        (f64::from(found[channel]) - exact).abs()
                    } else {
                        0.0
                    };
                    let beyond = total > 0.0 && (off.is_nan() || off > bound);
                    if beyond || !inside {
                        failures.push(format!(
                            "{colors} colours, {weight_bits} bits, {width} columns, weights {}, {query:?}: {found:?} \
                             off by {off:.2e}, bound {bound:.2e}",
                            index / KINDS
                        ));
                    }
                    mean += off;
                    asked += 1;
                    greatest = greatest.max(if bound < 1.0 { off } else { 0.0 });
                    tightest = tightest.max(if total > 0.0 { off / bound } else { 0.0 });
                }
            }
        }
        println!(
            "{colors} colours, {weight_bits} bits a weight: {asked} means, {partly} of part of the row, mean error {:.1e}, \
             greatest of those with a bound below 1 {greatest:.1e}, closest to the bound {tightest:.2}",
            mean / asked as f64
        );
        assert!(partly > 4000, "the cases are not varied enough: {partly}");
    }
    assert!(
        failures.is_empty(),
        "{} beyond the bound, first {:#?}",
        failures.len(),
        &failures[..5.min(failures.len())]
    );
}

#[test]
fn equal_weights_are_counted_exactly() {
    let mut random = Random(702);
    let passes = Passes::new(1, 8);
    for width in [1, 32, 33, 1024, 2048] {
        let rows: Vec<Vec<f32>> =
            (0..KINDS).map(|kind| row_of_kind(&mut random, kind, width, BITS)).collect();
        // Weights and fall-off that f32 adds without rounding.
        let given = vec![[0.5, 0.0, 0.0, 2.0]; KINDS * width];
        let queries = queries(&mut random, &rows, 3000);
        let stepped: Vec<SteppedRow> = rows.iter().map(|row| SteppedRow::new(row, BITS)).collect();
        for (query, found) in queries.iter().zip(passes.ask(&rows, &given, &queries)) {
            let (lit, covered) =
                stepped[query[0] as usize].lit_texels(f64::from(query[1]), f64::from(query[2]));
            let off = (f64::from(found[0]) - 0.5 * lit / covered).abs();
            assert!(off <= 1e-6, "{width}, {query:?}: {found:?}, {lit} of {covered} lit");
        }
    }
}
