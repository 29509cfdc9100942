// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light in cones: maps, sums over them in f64 from Eq. 3.9, and look-ups on the device.
#![allow(dead_code, clippy::unwrap_used)]

use crate::gpu::{copy_of_wgsl, gpu, shaders};
use airlight::ambient::{CONE_LAYERS, ConeLight, ConeLightForm};
use airlight::data::{Environment, load_environment};
use airlight::validate::{Definitions, Library};
use airlight::{Buffer, Pass, Shaders};
use airlight_tests::linear::Vec3 as Point;
use airlight_tests::reference::ambient::{Environment as ReferenceEnvironment, Rgb};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;

/// Layers of the maps.
pub const LAYERS: usize = CONE_LAYERS as usize;

/// Half angle of a layer, radians.
pub fn layer_angle(layer: usize) -> f64 {
    FRAC_PI_2 * (layer + 1) as f64 / LAYERS as f64
}

/// One of the real maps.
pub fn real_map(name: &str) -> Environment {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/assets");
    load_environment(assets.join(name)).unwrap()
}

/// The same map in f64.
pub fn reference_map(map: &Environment) -> ReferenceEnvironment {
    let texels = map.texels().iter().map(|texel| texel.to_array().map(f64::from)).collect();
    ReferenceEnvironment::new(map.size()[1] as usize, texels)
}

/// The direction of texel (x, y) of an octahedral map, the outermost of which are on the edge of the square: the square
/// |x| + |z| <= 1 in its middle is the upper half, the corners outside of it are folded down.
pub fn texel_direction(x: usize, y: usize, side: usize) -> Point {
    let [x, z] = [x, y].map(|i| (2 * i) as f64 / (side - 1) as f64 - 1.0);
    let up = 1.0 - x.abs() - z.abs();
    // Folding down moves a place towards the middle by as much as it lies below, along both axes.
    let down = (-up).max(0.0);
    Point::new(x - down.copysign(x), up, z - down.copysign(z)).normalised()
}

/// L_c of Eq. 3.9 with t = 1 / sin² α for the angles of all layers, by a sum over equal parts of the texels.
pub fn cones_of(map: &ReferenceEnvironment, axis: Point) -> [Rgb; LAYERS] {
    const PARTS: usize = 3;
    let (width, height) = (2 * map.height(), map.height());
    let edges: [f64; LAYERS] = std::array::from_fn(|layer| layer_angle(layer).cos().max(0.0));
    let edge = |y: usize| (PI * y as f64 / (PARTS * height) as f64).cos();
    let around: Vec<[f64; 2]> = (0..PARTS * width)
        .map(|x| TAU * ((x as f64 + 0.5) / (PARTS * width) as f64 - 0.5))
        .map(|right| [right.sin(), -right.cos()])
        .collect();
    // Rings between neighbouring cones.
    let mut rings = [[0.0; 3]; LAYERS];
    for y in 0..PARTS * height {
        let (level, up) = (PI * (y as f64 + 0.5) / (PARTS * height) as f64).sin_cos();
        let solid_angle = TAU / (PARTS * width) as f64 * (edge(y) - edge(y + 1));
        let row = &map.texels()[y / PARTS * width..][..width];
        for (x, [right, back]) in around.iter().enumerate() {
            let cosine = level * (axis.x * right + axis.z * back) + axis.y * up;
            if cosine > 0.0 {
                let ring = &mut rings[edges.iter().position(|edge| cosine >= *edge).unwrap()];
                let weight = cosine * solid_angle;
                *ring = [0, 1, 2].map(|c| ring[c] + weight * row[x / PARTS][c]);
            }
        }
    }
    let mut sum = [0.0; 3];
    std::array::from_fn(|layer| {
        sum = [0, 1, 2].map(|c| sum[c] + rings[layer][c]);
        sum.map(|c| c / (PI * layer_angle(layer).sin().powi(2)))
    })
}

/// Light in the cones of a map.
pub fn lit(map: &Environment, side: u32, sampled: bool) -> ConeLight {
    ConeLight::new(gpu(), shaders(), map, ConeLightForm { side, sampled }).unwrap()
}

/// The maps of cones as they are read back.
pub struct Cones {
    /// Texels a side.
    pub side: usize,
    texels: Vec<f32>,
}

impl Cones {
    /// What a light has now.
    pub fn of(light: &ConeLight) -> Self {
        let [width, _, _] = light.cones.size();
        Self { side: width as usize, texels: light.cones.read(gpu()).unwrap() }
    }

    /// All numbers, alpha included.
    pub fn values(&self) -> &[f32] {
        &self.texels
    }

    /// A texel of the map.
    pub fn texel(&self, layer: usize, x: usize, y: usize) -> Rgb {
        let at = 4 * ((layer * self.side + y) * self.side + x);
        [0, 1, 2].map(|c| f64::from(self.texels[at + c]))
    }
}

/// Runs `expression` (vec3) of `direction`, `angle` and `normal` for records of these seven numbers over the maps of a light.
pub fn look_up(light: &ConeLight, expression: &str, records: &[[f32; 7]]) -> Vec<[f32; 3]> {
    let folder = copy_of_wgsl();
    let text = format!(
        "#import airlight::ambient::cone_light::{{cone_radiance, preconvolved_radiance, geometric_term}}
        @group(#{{GROUP}}) @binding(0) var<storage, read> inputs: array<f32>;
        @group(#{{GROUP}}) @binding(1) var<storage, read_write> outputs: array<f32>;
        @group(#{{GROUP}}) @binding(2) var cones: texture_2d_array<f32>;
        @group(#{{GROUP}}) @binding(3) var cone_sampler: sampler;
        @compute @workgroup_size(64)
        fn look_up(@builtin(global_invocation_id) id: vec3<u32>) {{
            if id.x >= {count}u {{ return; }}
            let at = 7u * id.x;
            let direction = vec3<f32>(inputs[at], inputs[at + 1u], inputs[at + 2u]);
            let angle = inputs[at + 3u];
            let normal = vec3<f32>(inputs[at + 4u], inputs[at + 5u], inputs[at + 6u]);
            let found = {expression};
            outputs[3u * id.x] = found.x;
            outputs[3u * id.x + 1u] = found.y;
            outputs[3u * id.x + 2u] = found.z;
        }}",
        count = records.len(),
    );
    std::fs::write(folder.path().join("ambient/passes/look_up.wgsl"), text).unwrap();
    let shaders = Shaders::from_library(Library::from_directory(folder.path()).unwrap());
    let pass = Pass::compute_with(gpu(), &shaders, "ambient/look_up", &Definitions::new()).unwrap();
    let from = Buffer::of_floats(gpu(), records.as_flattened());
    let to = Buffer::storage(gpu(), 12 * records.len() as u64);
    let resources = [
        ("inputs", (&from).into()),
        ("outputs", (&to).into()),
        ("cones", (&light.cones).into()),
        ("cone_sampler", (&light.sampler).into()),
    ];
    let bound = pass.bind_known(gpu(), &resources).unwrap();
    let mut encoder = gpu().encoder();
    pass.dispatch(&mut encoder, &bound, [records.len() as u32, 1, 1]);
    gpu().submit(encoder).unwrap();
    let found = to.read_floats(gpu()).unwrap();
    found.chunks_exact(3).take(records.len()).map(|c| [c[0], c[1], c[2]]).collect()
}
