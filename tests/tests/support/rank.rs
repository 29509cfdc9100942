// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rank structures over rows of the tests' own, built by the passes that ship, and queries by a pass of the tests' own.
#![allow(clippy::unwrap_used)]

use crate::gpu::{self, Random, gpu, shaders};
use airlight::scattering::{Inputs, Medium, Prefiltered, PrefilteredBound, Settings, Visibility, Weighting};
use airlight::validate::{Definitions, Library};
use airlight::{Buffer, Pass, Shaders};
use airlight_tests::linear;
use glam::Vec3;
use std::sync::OnceLock;
use wgpu::TextureFormat::R32Float;

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
    weighted: bool,
}

impl Structure {
    /// For depths of `bits` bits and a map of so many columns and rows.
    pub fn new(bits: u32, map: [u32; 2], weighting: Weighting) -> Self {
        let settings = Settings {
            visibility: Visibility::Rank { bits },
            map,
            weighting,
            epipole_march: false,
            ..Settings::default()
        };
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
        Self { method, bound, bits, weighted: weighting == Weighting::Transmittance }
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
        let pass = query_pass(self.weighted);
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

fn query_pass(weighted: bool) -> &'static Pass {
    static PASSES: [OnceLock<Pass>; 2] = [const { OnceLock::new() }; 2];
    PASSES[usize::from(weighted)].get_or_init(|| {
        let (function, more) = if weighted {
            ("rank_visibility_weighted", ", input(5u), input(6u)")
        } else {
            ("rank_visibility", "")
        };
        let text = format!(
            "#import airlight::scattering::visibility_rank::{function}
            @group(#{{GROUP}}) @binding(0) var<storage, read> inputs: array<f32>;
            @group(#{{GROUP}}) @binding(1) var<storage, read_write> outputs: array<f32>;
            @group(#{{GROUP}}) @binding(2) var rank_cells: texture_2d<u32>;
            @group(#{{GROUP}}) @binding(3) var rank_starts: texture_2d<u32>;
            @group(#{{GROUP}}) @binding(4) var rank_planes: texture_2d_array<u32>;
            var<private> record: u32;
            fn input(index: u32) -> f32 {{ return inputs[record * 7u + index]; }}
            @compute @workgroup_size(64)
            fn probe(@builtin(global_invocation_id) id: vec3<u32>) {{
                if 7u * id.x >= arrayLength(&inputs) {{ return; }}
                record = id.x;
                outputs[id.x] = {function}(
                    rank_cells, rank_starts, rank_planes, u32(input(0u)), u32(input(1u)),
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
