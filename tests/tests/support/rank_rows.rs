// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rank structures over rows of the tests' own, built by the passes that ship, and queries by a pass of the tests' own.
#![allow(dead_code, clippy::unwrap_used)]

use crate::gpu::{self, Random, gpu, shaders};
use airlight::scattering::{
    Inputs, Medium, Prefiltered, PrefilteredBound, ScatteringError, Settings, Visibility, Weighting,
};
use airlight::validate::{Definitions, Library};
use airlight::{Buffer, Pass, Shaders};
use airlight_tests::linear;
use airlight_tests::reference::scattering::{SteppedRow, depth_step};
use glam::Vec3;
use std::sync::OnceLock;
use wgpu::TextureFormat::R32Float;

/// What f32 makes of a mean of up to 2048 texels: of a division, and of a subtraction from 1.
const ROUNDING: f64 = 3e-7;

/// A question to a structure.
#[derive(Clone, Copy, Debug)]
pub struct Query {
    /// Row of the map.
    pub row: u32,
    /// Texels that the ray covers.
    pub texels: f32,
    /// Depth of the ray.
    pub depth: f32,
    /// Optical depth of a texel of the ray; 0 where the structure holds counts.
    pub optical_step: f32,
    /// The lesser of those that the structure was built for.
    pub least_step: f32,
}

/// A structure over a map whose rows the test writes.
pub struct Structure {
    method: Prefiltered,
    bound: PrefilteredBound,
    bits: u32,
    question: Question,
}

/// The function of the shader that is asked.
#[derive(Clone, Copy)]
enum Question {
    Rank,
    RankWeighted,
    Wavelet,
}

impl Structure {
    /// Of rank queries for depths of `bits` bits and a map of so many columns and rows.
    pub fn new(bits: u32, map: [u32; 2], weighting: Weighting) -> Self {
        Self::of(Visibility::Rank { bits }, map, weighting)
    }

    /// Of an exact method.
    pub fn of(visibility: Visibility, map: [u32; 2], weighting: Weighting) -> Self {
        let (bits, question) = match visibility {
            Visibility::Rank { bits } if weighting == Weighting::Average => (bits, Question::Rank),
            Visibility::Rank { bits } => (bits, Question::RankWeighted),
            Visibility::Wavelet { bits } => (bits, Question::Wavelet),
            other => panic!("{other:?} is not exact"),
        };
        let settings = Settings { visibility, map, weighting, epipole_march: false, ..Settings::default() };
        let method = Prefiltered::new(gpu(), shaders(), settings, [1, 1]).unwrap();
        let up = linear::Vec3::new(0.0, 1.0, 0.0);
        let camera = Random(1).camera(1.0);
        let matrix = gpu::light_matrix(up, camera.eye, 20.0, 1.0);
        let depth = gpu::texture([1, 1], R32Float, &[1.0]);
        let inputs = Inputs {
            camera: &Buffer::uniform(gpu(), &gpu::host_camera(&camera, [1, 1])),
            light: &Buffer::uniform(gpu(), &gpu::host_light(up, matrix, 1.0, Vec3::ONE)),
            // With this extinction the radius of a slice is its optical depth.
            medium: &Buffer::uniform(gpu(), &Medium::new(1.0, Vec3::ONE, 0.0, 1.0).unwrap()),
            depth: &depth,
            shadow_map: &depth,
            shadow_views: None,
            shadow_maps: None,
            light_texture: None,
        };
        let bound = method.bind(gpu(), &inputs).unwrap();
        Self { method, bound, bits, question }
    }

    /// Builds it over the rows.
    pub fn build(&self, rows: &[Vec<f32>]) {
        self.method.rectification.rectified.write(gpu(), &rows.concat()).unwrap();
        let mut encoder = gpu().encoder();
        self.method.record_filter(&mut encoder, &self.bound);
        gpu().submit(encoder).unwrap();
    }

    /// Builds it over the rows with texels of an optical depth on the fastest ray, and returns what f32 makes of that.
    pub fn build_weighted(&self, rows: &[Vec<f32>], optical_step: f32) -> f32 {
        let width = rows[0].len() as f32;
        let radius = optical_step * width;
        // With a ray at right angles to the light. The last number is of the reference ray, which does not count.
        let slices: Vec<f32> = rows.iter().flat_map(|_| [0.1, 1.8, radius, 0.5]).collect();
        self.method.rectification.slices.write(gpu(), &slices).unwrap();
        self.build(rows);
        radius / width
    }

    /// The words of its first texture.
    pub fn words(&self) -> Vec<u32> {
        self.method.prefilter.stored().read_words(gpu()).unwrap()
    }

    /// The visibility for each query.
    pub fn ask(&self, queries: &[Query]) -> Vec<f32> {
        let columns = self.method.rectification.rectified.size()[0] as f32;
        let values: Vec<f32> = queries
            .iter()
            .flat_map(|q| {
                let steps = [q.optical_step, q.least_step];
                [self.bits as f32, columns, q.row as f32, q.texels, q.depth, steps[0], steps[1]]
            })
            .collect();
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let from = Buffer::with_bytes(gpu(), &bytes, wgpu::BufferUsages::STORAGE);
        let to = Buffer::storage(gpu(), 4 * queries.len() as u64);
        let mut resources = vec![("inputs", (&from).into()), ("outputs", (&to).into())];
        let textures = self.method.prefilter.textures();
        resources.extend(textures.iter().map(|(name, texture)| (*name, texture.into())));
        let pass = query_pass(self.question);
        let bound = pass.bind(gpu(), &resources).unwrap();
        let mut encoder = gpu().encoder();
        pass.dispatch(&mut encoder, &bound, [queries.len() as u32, 1, 1]);
        gpu().submit(encoder).unwrap();
        let mut found = to.read_floats(gpu()).unwrap();
        found.truncate(queries.len());
        assert_eq!(found.len(), queries.len());
        found
    }
}

fn query_pass(question: Question) -> &'static Pass {
    static PASSES: [OnceLock<Pass>; 3] = [const { OnceLock::new() }; 3];
    PASSES[question as usize].get_or_init(|| {
        const RANK: [(&str, &str); 3] = [
            ("rank_cells", "texture_2d"),
            ("rank_starts", "texture_2d"),
            ("rank_planes", "texture_2d_array"),
        ];
        let (function, textures, more) = match question {
            Question::Rank => ("rank_visibility", &RANK[..], ""),
            Question::RankWeighted => ("rank_visibility_weighted", &RANK[..], ", input(5u), input(6u)"),
            Question::Wavelet => ("wavelet_visibility", &[("wavelet", "texture_2d")][..], ""),
        };
        let module = function.split('_').next().unwrap();
        let declare = |(index, (name, kind)): (usize, &(&str, &str))| {
            format!("@group(#{{GROUP}}) @binding({}) var {name}: {kind}<u32>;\n", index + 2)
        };
        let declared: String = textures.iter().enumerate().map(declare).collect();
        let names = textures.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
        let text = format!(
            "#import airlight::scattering::visibility_{module}::{function}
            @group(#{{GROUP}}) @binding(0) var<storage, read> inputs: array<f32>;
            @group(#{{GROUP}}) @binding(1) var<storage, read_write> outputs: array<f32>;
            {declared}
            var<private> record: u32;
            fn input(index: u32) -> f32 {{ return inputs[record * 7u + index]; }}
            @compute @workgroup_size(64)
            fn probe(@builtin(global_invocation_id) id: vec3<u32>) {{
                if 7u * id.x >= arrayLength(&inputs) {{ return; }}
                record = id.x;
                outputs[id.x] = {function}(
                    {names}, u32(input(0u)), u32(input(1u)),
                    u32(input(2u)), input(3u), input(4u){more}
                );
            }}"
        );
        let folder = gpu::copy_of_wgsl();
        std::fs::write(folder.path().join("core/passes/probe.wgsl"), text).unwrap();
        let shaders = Shaders::from_library(Library::from_directory(folder.path()).unwrap());
        match Pass::compute_with(gpu(), &shaders, "core/probe", &Definitions::new()) {
            Ok(pass) => pass,
            Err(error) => panic!("the probe does not compose: {error}"),
        }
    })
}

/// True where no rounding of f32 can take a depth to another step than f64 does: away from the borders between two.
pub fn clear_of_borders(depth: f32, bits: u32) -> bool {
    let steps = f64::from(depth).clamp(0.0, 1.0) * f64::from((1_u32 << bits) - 1);
    !depth.is_finite() || (steps.fract() - 0.5).abs() > 1e-3
}

/// Kinds of rows.
pub const KINDS: usize = 12;

/// A row of a kind, its depths clear of the borders between steps.
pub fn row_of_kind(random: &mut Random, kind: usize, width: usize, bits: u32) -> Vec<f32> {
    let steps = (1_usize << bits) - 1;
    let centre = random.between(0.1, 0.9);
    let pair = [random.unit() as f32, random.unit() as f32];
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 2.0, 1e30, -0.0, 1e-40, 0.5];
    (0..width)
        .map(|i| {
            let along = i as f64 / width as f64;
            let value = match kind {
                0 => random.unit() as f32,
                1 => centre as f32,
                2 => 1.0,
                3 => 0.0,
                4 => pair[random.below(2)],
                5 => (0.05 + 0.9 * along) as f32,
                6 => (0.95 - 0.9 * along) as f32,
                7 if random.unit() < 0.5 => random.unit() as f32,
                7 => odd[random.below(odd.len())],
                8 => random.below(steps + 1) as f32 / steps as f32,
                // A few steps, so that there are many ties and chunks of one value.
                9 => (steps / 2 + random.below(5)) as f32 / steps as f32,
                // Blockers with edges in an empty row.
                10 => {
                    if i / 37 % 3 == 0 {
                        (centre + 0.1 * (along * 20.0).sin()) as f32
                    } else {
                        1.0
                    }
                }
                _ => (centre + 0.02 * random.unit()) as f32,
            };
            if clear_of_borders(value, bits) {
                return value;
            }
            // The middle of the step next to it.
            (f64::from(value) * steps as f64).floor() as f32 / steps as f32
        })
        .collect()
}

/// Stretches of all kinds, texels.
fn stretch(random: &mut Random, width: u32) -> f32 {
    let wide = f64::from(width);
    match random.below(10) {
        0 => [0.0, 1e-4, 9.9e-4, 1.1e-3, 0.5][random.below(5)],
        1 => width as f32,
        2 => [wide + 0.5, 2.0 * wide, 1e9][random.below(3)] as f32,
        3 => (32 * random.below(width.div_ceil(32) as usize + 1)) as f32,
        4 => (32.0 * random.below(width.div_ceil(32) as usize + 1) as f64 + random.between(-1.0, 1.0))
            .max(0.0) as f32,
        5 | 6 => (1 + random.below(width as usize)) as f32,
        _ => random.between(0.0, wide) as f32,
    }
}

/// Depths of rays: the ends, values that are stored, whole steps, and others.
fn ray_depth(random: &mut Random, row: &[f32], bits: u32) -> f32 {
    let steps = (1_usize << bits) - 1;
    match random.below(8) {
        0 => [0.0, 1.0, -0.5, 1.5][random.below(4)],
        1 => random.below(steps + 1) as f32 / steps as f32,
        2..=5 => {
            let stored = row[random.below(row.len())];
            if stored.is_finite() { stored } else { 1.0 }
        }
        _ => loop {
            let depth = random.unit() as f32;
            if clear_of_borders(depth, bits) {
                return depth;
            }
        },
    }
}

/// Queries of all kinds.
pub fn queries(random: &mut Random, rows: &[Vec<f32>], bits: u32, count: usize) -> Vec<Query> {
    (0..count)
        .map(|_| {
            let row = random.below(rows.len());
            Query {
                row: row as u32,
                texels: stretch(random, rows[row].len() as u32),
                depth: ray_depth(random, &rows[row], bits),
                optical_step: 0.0,
                least_step: 0.0,
            }
        })
        .collect()
}

/// Holds that a method gives the exact counts of the stepped map, for rows and queries of all kinds. `of`: it by its bits.
pub fn hold_counts(seed: u64, of: impl Fn(u32) -> Visibility) {
    const QUERIES: usize = 2000;
    let mut random = Random(seed);
    let (mut asked, mut partly, mut worst, mut ties) = (0_usize, 0_usize, 0.0_f64, 0_usize);
    for bits in [8, 10, 12] {
        for width in [1, 2, 31, 32, 33, 100, 1000, 1024, 2048] {
            for height in [1, 7_usize] {
                let structure = Structure::of(of(bits), [width, height as u32], Weighting::Average);
                // Maps of few rows take turns, so that every kind of row comes at every size.
                for first in (0..KINDS).step_by(height) {
                    let rows: Vec<Vec<f32>> = (first..first + height)
                        .map(|kind| row_of_kind(&mut random, kind % KINDS, width as usize, bits))
                        .collect();
                    structure.build(&rows);
                    let queries = queries(&mut random, &rows, bits, QUERIES / (KINDS / height).max(1));
                    let stepped: Vec<SteppedRow> =
                        rows.iter().map(|row| SteppedRow::new(row, bits)).collect();
                    for (query, found) in queries.iter().zip(structure.ask(&queries)) {
                        let row = &stepped[query.row as usize];
                        let depth = f64::from(query.depth);
                        let (lit, covered) = row.lit_texels(f64::from(query.texels), depth);
                        let off = (f64::from(found) - lit / covered).abs();
                        worst = if off <= worst { worst } else { off };
                        let what = || format!("{bits} bits, {width}x{height}, kinds from {first}, {query:?}");
                        assert!((0.0..=1.0).contains(&found), "{found}: {}", what());
                        assert!(off <= ROUNDING, "{} of {lit} lit: {}", f64::from(found) * covered, what());
                        if covered.fract() == 0.0 {
                            let count = (f64::from(found) * covered).round();
                            assert_eq!(count, lit, "of {covered}: {}", what());
                        }
                        asked += 1;
                        partly += usize::from(0.0 < lit && lit < covered);
                        let ray = depth_step(depth, bits);
                        let stored = &rows[query.row as usize];
                        let equal = stored.iter().any(|v| depth_step(f64::from(*v), bits) == ray);
                        ties += usize::from(equal);
                    }
                }
            }
        }
    }
    println!(
        "{asked} counts, {partly} neither none nor all, {ties} with equal steps in the row: no mismatch"
    );
    assert!(partly > asked / 5 && ties > asked / 3, "the cases are not varied enough");
    crate::probing::hold("visibility from counts", worst, ROUNDING);
}

/// Why settings are refused.
pub fn refusal(settings: Settings) -> String {
    match Prefiltered::new(gpu(), shaders(), settings, [16, 16]) {
        Err(ScatteringError::Settings(error)) => error.to_string(),
        Err(other) => panic!("{settings:?}: {other}"),
        Ok(_) => panic!("{settings:?} are taken"),
    }
}
