// SPDX-License-Identifier: MIT OR Apache-2.0
//! A heightfield terrain of ridges, by fractal ridged value noise over a warped domain.

use glam::Vec3;

use super::mesh::Mesh;
use super::random::{lattice, value_noise};

/// What [`terrain`] makes.
#[derive(Clone, Debug, PartialEq)]
pub struct TerrainParameters {
    /// Seed; the same parameters give the same terrain.
    pub seed: u64,
    /// Edge length in metres along x and z, around the origin.
    pub size: f32,
    /// Quads along each side, 1..=4096.
    pub resolution: u32,
    /// Height of the highest ridges over the lowest valleys in metres.
    pub height: f32,
}

impl Default for TerrainParameters {
    fn default() -> Self {
        Self { seed: 3, size: 40.0, resolution: 224, height: 6.0 }
    }
}

const OCTAVES: u32 = 7;
/// Ridges across the terrain's edge.
const RIDGES: f32 = 2.6;

fn fractal(seed: u64, x: f32, z: f32, octaves: u32) -> f32 {
    let (mut sum, mut weight, mut total, mut scale) = (0.0, 1.0, 0.0, 1.0);
    for octave in 0..octaves {
        sum += weight * value_noise(seed.wrapping_add(u64::from(octave) * 7919), x * scale, z * scale);
        total += weight;
        weight *= 0.5;
        scale *= 2.03;
    }
    sum / total
}

/// Height in metres of the terrain over the point (`x`, `z`), in 0..=height.
pub fn terrain_height(parameters: &TerrainParameters, x: f32, z: f32) -> f32 {
    let scale = RIDGES / parameters.size;
    let (u, v) = (x * scale, z * scale);
    let warp = |k: u64| fractal(parameters.seed ^ k, u * 1.3, v * 1.3, 3) - 0.5;
    let (wu, wv) = (u + 0.9 * warp(0x51), v + 0.9 * warp(0x52));
    let (mut sum, mut weight, mut total, mut frequency, mut carried) = (0.0, 1.0, 0.0, 1.0, 1.0f32);
    for octave in 0..OCTAVES {
        // Each octave is turned, so that the lattice of the value noise does not show.
        let (sin, cos) = (octave as f32 * 0.7).sin_cos();
        let (x, y) = ((wu * cos - wv * sin) * frequency, (wu * sin + wv * cos) * frequency);
        let seed = parameters.seed.wrapping_add(0x1000 + u64::from(octave));
        let ridge = 1.0 - (2.0 * value_noise(seed, x + 17.3, y - 4.1) - 1.0).abs();
        // Sharp crests; fine ridges grow only on coarse ones, so that valleys stay smooth.
        let ridge = ridge * ridge * (1.6 - 0.6 * ridge);
        sum += weight * ridge * carried;
        total += weight;
        carried = (ridge * 1.3).min(1.0);
        weight *= 0.43;
        frequency *= 2.07;
    }
    let shape = (sum / total).clamp(0.0, 1.0);
    // Wide valleys, steep flanks.
    shape * parameters.height
}

/// The terrain as a mesh: grass in the valleys, earth and rock on slopes, pale stone on the crests.
/// Sizes that are not positive and finite count as the defaults.
pub fn terrain(parameters: &TerrainParameters) -> Mesh {
    let mut parameters = parameters.clone();
    let default = TerrainParameters::default();
    if !(parameters.size.is_finite() && parameters.size > 0.0) {
        parameters.size = default.size;
    }
    if !(parameters.height.is_finite() && parameters.height >= 0.0) {
        parameters.height = default.height;
    }
    let count = parameters.resolution.clamp(1, 4096);
    let step = parameters.size / count as f32;
    let at = |i: u32| (i as f32 / count as f32 - 0.5) * parameters.size;
    let mut mesh = Mesh::default();
    for row in 0..=count {
        for column in 0..=count {
            let (x, z) = (at(column), at(row));
            let height = |dx: f32, dz: f32| terrain_height(&parameters, x + dx * step, z + dz * step);
            let rise_x = height(0.5, 0.0) - height(-0.5, 0.0);
            let rise_z = height(0.0, 0.5) - height(0.0, -0.5);
            let normal = Vec3::new(-rise_x, step, -rise_z).try_normalize().unwrap_or(Vec3::Y);
            let y = height(0.0, 0.0);
            let albedo = albedo(&parameters, Vec3::new(x, y, z), normal);
            mesh.push(Vec3::new(x, y, z), normal, albedo);
        }
    }
    for row in 0..count {
        for column in 0..count {
            let a = row * (count + 1) + column;
            let (b, c, d) = (a + 1, a + count + 1, a + count + 2);
            // Alternate the diagonal, so that ridges have no preferred direction.
            if (row + column) % 2 == 0 {
                mesh.indices.extend_from_slice(&[a, c, b, b, c, d]);
            } else {
                mesh.indices.extend_from_slice(&[a, d, b, a, c, d]);
            }
        }
    }
    mesh
}

fn albedo(parameters: &TerrainParameters, position: Vec3, normal: Vec3) -> Vec3 {
    let step = |low: f32, high: f32, x: f32| {
        let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    };
    let metres = parameters.size / 40.0;
    let patch = fractal(parameters.seed ^ 0x77, position.x / metres * 0.6, position.z / metres * 0.6, 4);
    let grain = lattice(parameters.seed, (position.x * 97.0) as i32, (position.z * 97.0) as i32) - 0.5;
    let relative = if parameters.height > 0.0 { position.y / parameters.height } else { 0.0 };
    let grass = Vec3::new(0.10, 0.19, 0.045).lerp(Vec3::new(0.24, 0.26, 0.08), step(0.35, 0.7, patch));
    let earth = Vec3::new(0.24, 0.165, 0.10);
    let rock = Vec3::new(0.30, 0.275, 0.25).lerp(Vec3::new(0.20, 0.185, 0.18), patch);
    let crest = Vec3::new(0.52, 0.50, 0.47);
    let slope = 1.0 - normal.y + 0.12 * (patch - 0.5);
    let ground = grass.lerp(earth, step(0.10, 0.24, slope)).lerp(rock, step(0.20, 0.42, slope));
    let ground =
        ground.lerp(crest, step(0.62, 0.85, relative + 0.2 * (patch - 0.5)) * step(0.75, 0.4, slope));
    (ground * (1.0 + 0.16 * grain)).clamp(Vec3::ZERO, Vec3::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_deterministic_valid_and_of_its_size() {
        let parameters = TerrainParameters { resolution: 64, ..Default::default() };
        let mesh = terrain(&parameters);
        assert_eq!(mesh, terrain(&parameters));
        assert_ne!(mesh, terrain(&TerrainParameters { seed: 4, ..parameters.clone() }));
        assert_eq!(mesh.validate(), Ok(()));
        assert_eq!(mesh.triangle_count(), 64 * 64 * 2);
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5 && n.y > 0.0));
        assert!(mesh.albedos.iter().all(|a| a.min_element() >= 0.0 && a.max_element() <= 1.0));
        let bounds = mesh.bounds().expect("vertices");
        assert!(bounds.min.y >= 0.0 && bounds.max.y <= parameters.height);
        assert!(bounds.size().y > 0.5 * parameters.height, "ridges: {bounds:?}");
        assert_eq!((bounds.min.x, bounds.max.z), (-20.0, 20.0));
        for p in mesh.positions.iter().step_by(97) {
            assert_eq!(p.y, terrain_height(&parameters, p.x, p.z));
        }
    }

    #[test]
    fn bad_parameters_still_make_a_terrain() {
        let parameters = TerrainParameters { seed: 1, size: f32::NAN, resolution: 0, height: -1.0 };
        assert_eq!(terrain(&parameters).validate(), Ok(()));
    }
}
