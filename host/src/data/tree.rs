// SPDX-License-Identifier: MIT OR Apache-2.0
//! A leafy tree by space colonisation (Runions, Lane, Prusinkiewicz 2007, "Modeling trees with a space
//! colonization algorithm"): the crown is a cloud of points, grouped in clumps with gaps between them, and
//! branches grow towards the points that they are nearest to. Thickness follows the pipe model: the
//! cross-sections of the branches add up to that of their parent. Leaves sit at the twigs.

mod skeleton;
mod surface;

use super::mesh::Mesh;
use super::random::Random;

/// What [`tree`] makes. Lengths are in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeParameters {
    /// Seed; the same parameters give the same tree.
    pub seed: u64,
    /// Height from the ground, at the origin, to the top of the crown.
    pub height: f32,
    /// Radius of the crown.
    pub crown_radius: f32,
    /// Number of leaves, of four triangles each.
    pub leaves: u32,
    /// Length of a leaf.
    pub leaf_length: f32,
    /// Number of clumps that the crown consists of; the gaps between them let shafts of light through.
    pub clumps: u32,
}

impl Default for TreeParameters {
    fn default() -> Self {
        Self { seed: 1, height: 6.0, crown_radius: 2.7, leaves: 9000, leaf_length: 0.13, clumps: 26 }
    }
}

/// The tree as a mesh: about 8 triangles for each segment of a branch and 4 for each leaf, both sides of
/// which are to be seen. Lengths that are not positive and finite count as the defaults.
pub fn tree(parameters: &TreeParameters) -> Mesh {
    let default = TreeParameters::default();
    let length = |value: f32, otherwise: f32| {
        if value.is_finite() && value > 0.0 && value < 1e6 { value } else { otherwise }
    };
    let parameters = TreeParameters {
        height: length(parameters.height, default.height),
        crown_radius: length(parameters.crown_radius, default.crown_radius),
        leaf_length: length(parameters.leaf_length, default.leaf_length),
        leaves: parameters.leaves.min(4_000_000),
        clumps: parameters.clumps.clamp(1, 1000),
        ..parameters.clone()
    };
    let mut random = Random::new(parameters.seed);
    let attractors = skeleton::attractors(&parameters, &mut random);
    let nodes = skeleton::grow(&parameters, attractors, &mut random);
    let radii = skeleton::thickness(&parameters, &nodes);
    let mut mesh = Mesh::default();
    surface::bark(&parameters, &nodes, &radii, &mut random, &mut mesh);
    surface::leaves(&parameters, &nodes, &radii, &mut random, &mut mesh);
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_deterministic_valid_and_of_its_size() {
        let parameters = TreeParameters::default();
        let mesh = tree(&parameters);
        assert_eq!(mesh, tree(&parameters));
        assert_ne!(mesh, tree(&TreeParameters { seed: 2, ..parameters.clone() }));
        assert_eq!(mesh.validate(), Ok(()));
        assert!(
            mesh.triangle_count() > 4 * 9000 && mesh.triangle_count() < 120_000,
            "{}",
            mesh.triangle_count()
        );
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4));
        assert!(mesh.albedos.iter().all(|a| a.min_element() > 0.0 && a.max_element() < 1.0));
        let bounds = mesh.bounds().expect("vertices");
        assert!((bounds.max.y - 6.0).abs() < 0.6, "{bounds:?}");
        assert!(bounds.min.y > -0.1, "{bounds:?}");
        for extent in [bounds.max.x, -bounds.min.x, bounds.max.z, -bounds.min.z] {
            assert!(extent > 1.8 && extent < 3.5, "{bounds:?}");
        }
    }

    #[test]
    fn the_crown_has_gaps_and_is_no_hedge() {
        // Straight down onto the crown: some of the circle is open and most of it is not.
        let parameters = TreeParameters::default();
        let mesh = tree(&parameters);
        let count = 200usize;
        let cell = |x: f32| (((x / parameters.crown_radius) * 0.5 + 0.5) * count as f32) as usize;
        let mut covered = vec![false; count * count];
        for triangle in mesh.indices.chunks_exact(3) {
            let corners = [0, 1, 2].map(|i| mesh.positions[triangle[i] as usize]);
            for weights in [(0.33, 0.33), (0.6, 0.2), (0.2, 0.6), (0.2, 0.2)] {
                let p = corners[0] * (1.0 - weights.0 - weights.1)
                    + corners[1] * weights.0
                    + corners[2] * weights.1;
                let (x, z) = (cell(p.x), cell(p.z));
                if x < count && z < count {
                    covered[z * count + x] = true;
                }
            }
        }
        let inside = |i: usize| {
            let at = |k: usize| (k as f32 + 0.5) / count as f32 * 2.0 - 1.0;
            at(i % count).hypot(at(i / count)) < 0.8
        };
        let disc = (0..covered.len()).filter(|i| inside(*i)).count();
        let hit = (0..covered.len()).filter(|i| inside(*i) && covered[*i]).count();
        let share = hit as f32 / disc as f32;
        assert!((0.5..0.93).contains(&share), "{share} of the disc is covered");
    }

    #[test]
    fn bad_parameters_still_make_a_tree() {
        let parameters = TreeParameters {
            seed: 0,
            height: f32::NAN,
            crown_radius: -1.0,
            leaves: 0,
            leaf_length: 0.0,
            clumps: 0,
        };
        assert_eq!(tree(&parameters).validate(), Ok(()));
        let tiny = TreeParameters { height: 1e-3, crown_radius: 5.0, leaves: 10, ..Default::default() };
        assert_eq!(tree(&tiny).validate(), Ok(()));
    }
}
