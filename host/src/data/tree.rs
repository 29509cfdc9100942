// SPDX-License-Identifier: MIT OR Apache-2.0
//! A leafy tree by space colonisation (Runions, Lane, Prusinkiewicz 2007, "Modeling trees with a space
//! colonization algorithm"): the crown is a cloud of points, grouped in clumps with gaps between them, and
//! branches grow towards the points that they are nearest to. Thickness follows the pipe model: the
//! cross-sections of the branches add up to that of their parent. Leaves sit at the twigs.

use std::f32::consts::TAU;

use glam::{Quat, Vec3};

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

/// Nodes grown at most, so that any parameters end.
const MAX_NODES: usize = 12_000;
/// Points that attract branches.
const ATTRACTORS: usize = 1500;

struct Node {
    position: Vec3,
    parent: usize,
    depth: u32,
}

struct Clump {
    center: Vec3,
    radii: Vec3,
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
    let clumps = clumps(&parameters, &mut random);
    let mut attractors = Vec::with_capacity(ATTRACTORS);
    let weights: Vec<f32> = clumps.iter().map(|c| c.radii.element_product()).collect();
    let total: f32 = weights.iter().sum();
    while attractors.len() < ATTRACTORS {
        let mut at = random.unit() * total;
        let chosen = weights.iter().position(|w| {
            at -= w;
            at <= 0.0
        });
        let clump = &clumps[chosen.unwrap_or(clumps.len() - 1)];
        // More of them near the shell of a clump, where the light is.
        let point = random.in_ball();
        let point = point.normalize_or_zero() * point.length().powf(0.6);
        attractors.push(clump.center + point * clump.radii);
    }
    let nodes = grow(&parameters, attractors, &mut random);
    let radii = thickness(&parameters, &nodes);
    let mut mesh = Mesh::default();
    bark(&parameters, &nodes, &radii, &mut random, &mut mesh);
    leaves(&parameters, &nodes, &radii, &mut random, &mut mesh);
    mesh
}

/// Ellipsoids over a broad crown, by rejection of those too close to others.
fn clumps(parameters: &TreeParameters, random: &mut Random) -> Vec<Clump> {
    let (height, radius) = (parameters.height, parameters.crown_radius);
    let base = 0.32 * height;
    let crown = height - base;
    let count = parameters.clumps as usize;
    let typical = 1.05 * radius / (count as f32).cbrt();
    let mut clumps: Vec<Clump> = Vec::with_capacity(count);
    let mut spacing = 1.35 * typical;
    let mut misses = 0;
    while clumps.len() < count {
        let size = typical * random.range(0.7, 1.2);
        // The crown: a dome over a flatter underside, widest at two fifths of its height.
        let up = random.unit();
        let wide = if up < 0.4 { (1.0 - ((0.4 - up) / 0.62).powi(2)).sqrt() } else { 0.0 };
        let wide =
            wide.max(if up >= 0.4 { (1.0 - ((up - 0.4) / 0.62).powi(2)).max(0.0).sqrt() } else { 0.0 });
        let angle = random.unit() * TAU;
        let away = random.unit().powf(0.42) * (wide * radius - 0.75 * size).max(0.0);
        let y = base + (up * crown).min(crown - 0.7 * size).max(0.5 * size);
        let center = Vec3::new(away * angle.cos(), y, away * angle.sin());
        if clumps.iter().any(|other| other.center.distance(center) < spacing) {
            misses += 1;
            if misses % 40 == 0 {
                spacing *= 0.93;
            }
            continue;
        }
        clumps.push(Clump { center, radii: Vec3::new(size, 0.7 * size, size) });
    }
    clumps
}

/// Grows the skeleton. A parent stands before its children; node 0 is its own.
fn grow(parameters: &TreeParameters, attractors: Vec<Vec3>, random: &mut Random) -> Vec<Node> {
    let step = 0.022 * parameters.height;
    let reach = 0.30 * parameters.height;
    let kill = 2.1 * step;
    let mut nodes = vec![Node { position: Vec3::ZERO, parent: 0, depth: 0 }];
    // The trunk, with a gentle bend.
    let bend = random.unit() * TAU;
    let trunk = (0.36 * parameters.height / step) as usize;
    for i in 0..trunk {
        let t = (i + 1) as f32 / trunk as f32;
        let aside = 0.02 * parameters.height * (t * 2.6).sin();
        let swing = bend + 1.4 * t;
        let position = Vec3::new(aside * swing.cos(), (i + 1) as f32 * step, aside * swing.sin());
        nodes.push(Node { position, parent: i, depth: 0 });
    }
    struct Attractor {
        position: Vec3,
        nearest: usize,
        distance: f32,
        alive: bool,
    }
    let mut attractors: Vec<_> = attractors
        .into_iter()
        .map(|position| Attractor { position, nearest: 0, distance: f32::INFINITY, alive: true })
        .collect();
    let mut fresh = 0;
    let mut range = reach;
    while nodes.len() < MAX_NODES {
        for attractor in attractors.iter_mut().filter(|a| a.alive) {
            for (offset, node) in nodes[fresh..].iter().enumerate() {
                let distance = node.position.distance(attractor.position);
                if distance < attractor.distance {
                    (attractor.nearest, attractor.distance) = (fresh + offset, distance);
                }
            }
            attractor.alive = attractor.distance > kill;
        }
        fresh = nodes.len();
        let mut pulls: Vec<(usize, Vec3)> = attractors
            .iter()
            .filter(|a| a.alive && a.distance < range)
            .map(|a| (a.nearest, (a.position - nodes[a.nearest].position).normalize_or_zero()))
            .collect();
        if attractors.iter().all(|a| !a.alive) {
            break;
        }
        if pulls.is_empty() {
            range *= 1.5;
            if range > 100.0 * parameters.height {
                break;
            }
            continue;
        }
        pulls.sort_by_key(|(node, _)| *node);
        let before = nodes.len();
        for group in pulls.chunk_by(|a, b| a.0 == b.0) {
            let parent = group[0].0;
            let sum: Vec3 = group.iter().map(|(_, pull)| *pull).sum();
            let grandparent = nodes[nodes[parent].parent].position;
            let onwards = (nodes[parent].position - grandparent).normalize_or(Vec3::Y);
            // Branches keep their way a little, wander a little and rise a little.
            let way = sum.normalize_or_zero() + 0.45 * onwards + 0.22 * random.in_ball() + 0.06 * Vec3::Y;
            let position = nodes[parent].position + way.normalize_or(Vec3::Y) * step;
            // Two attractors may pull a node to and fro for ever.
            let again =
                nodes[fresh.saturating_sub(64)..].iter().any(|n| n.position.distance(position) < 0.2 * step);
            if !again && nodes.len() < MAX_NODES {
                let depth = nodes[parent].depth + 1;
                nodes.push(Node { position, parent, depth });
            }
        }
        if nodes.len() == before {
            // Nothing grew: drop the points that cannot be reached.
            let stuck: Vec<usize> = pulls.iter().map(|(node, _)| *node).collect();
            for attractor in &mut attractors {
                attractor.alive &= !stuck.contains(&attractor.nearest);
            }
        }
    }
    nodes
}

fn thickness(parameters: &TreeParameters, nodes: &[Node]) -> Vec<f32> {
    const EXPONENT: f32 = 2.35;
    let twig: f32 = 0.0011 * parameters.height;
    let mut sums = vec![0.0f32; nodes.len()];
    for i in (1..nodes.len()).rev() {
        if sums[i] == 0.0 {
            sums[i] = twig.powf(EXPONENT);
        }
        sums[nodes[i].parent] += sums[i];
    }
    let mut radii: Vec<f32> = sums.iter().map(|sum| sum.powf(1.0 / EXPONENT)).collect();
    // The trunk of a tree this high, whatever the number of twigs, and the flare of its roots.
    let scale = 0.023 * parameters.height / radii[0].max(f32::MIN_POSITIVE);
    for (radius, node) in radii.iter_mut().zip(nodes) {
        let relative = (*radius / twig.max(f32::MIN_POSITIVE)).clamp(1.0, 8.0);
        // Twigs keep their thickness, thick branches take the scale.
        *radius *= 1.0 + (scale - 1.0) * ((relative - 1.0) / 7.0);
        let flare = (-node.position.y / (0.05 * parameters.height)).exp();
        *radius *= 1.0 + if node.depth == 0 { 0.75 * flare } else { 0.0 };
    }
    radii
}

/// Tapered tubes along chains of nodes: each chain follows the thickest child.
fn bark(parameters: &TreeParameters, nodes: &[Node], radii: &[f32], random: &mut Random, mesh: &mut Mesh) {
    let mut thickest = vec![usize::MAX; nodes.len()];
    for i in 1..nodes.len() {
        let best = &mut thickest[nodes[i].parent];
        if *best == usize::MAX || radii[i] > radii[*best] {
            *best = i;
        }
    }
    let brown = Vec3::new(0.150, 0.105, 0.070);
    for first in 0..nodes.len() {
        let parent = nodes[first].parent;
        if first != 0 && thickest[parent] == first {
            continue;
        }
        // A side branch starts inside of its parent, with its own thickness.
        let mut chain = Vec::new();
        if first != 0 {
            chain.push((nodes[parent].position, (radii[first] * 1.25).min(radii[parent])));
        }
        let mut at = first;
        while at != usize::MAX {
            chain.push((nodes[at].position, radii[at]));
            at = thickest[at];
        }
        if chain.len() < 2 {
            continue;
        }
        let sides = match chain[0].1 / parameters.height {
            r if r > 0.012 => 14,
            r if r > 0.005 => 8,
            r if r > 0.0025 => 5,
            _ => 3u32,
        };
        let mut frame = (chain[1].0 - chain[0].0).normalize_or(Vec3::Y).any_orthonormal_vector();
        let mut previous = None;
        let tint = random.range(0.85, 1.15);
        for (i, (position, radius)) in chain.iter().enumerate() {
            let before = chain[i.saturating_sub(1)].0;
            let after = chain[(i + 1).min(chain.len() - 1)].0;
            let along = (after - before).normalize_or(Vec3::Y);
            // Parallel transport, so that tubes do not twist.
            frame = (frame - along * frame.dot(along)).normalize_or(along.any_orthonormal_vector());
            let across = along.cross(frame);
            let start = u32::try_from(mesh.positions.len()).unwrap_or(u32::MAX);
            let end = i + 1 == chain.len();
            for side in 0..sides {
                let angle = side as f32 / sides as f32 * TAU;
                let normal = frame * angle.cos() + across * angle.sin();
                let furrow =
                    if sides == 14 { 1.0 + 0.09 * (((side * 5) % 7) as f32 / 3.0 - 1.0) } else { 1.0 };
                let radius = if end { 0.3 * radius } else { radius * furrow };
                let shade = tint * (0.8 + 0.4 * (furrow - 0.9) / 0.2) * random.range(0.9, 1.1);
                mesh.push(position + normal * radius, normal, brown * shade);
            }
            if let Some(previous) = previous {
                for side in 0..sides {
                    let next = (side + 1) % sides;
                    let (a, b) = (previous + side, previous + next);
                    let (c, d) = (start + side, start + next);
                    mesh.indices.extend_from_slice(&[a, b, c, b, d, c]);
                }
            }
            previous = Some(start);
        }
    }
}

/// Leaves in sprays around the twigs, turned outwards and to the light.
fn leaves(parameters: &TreeParameters, nodes: &[Node], radii: &[f32], random: &mut Random, mesh: &mut Mesh) {
    let mut children = vec![0u32; nodes.len()];
    for node in &nodes[1..] {
        children[node.parent] += 1;
    }
    // A tip carries a spray of leaves, the twig behind it single ones.
    let thin = 0.0026 * parameters.height;
    let mut places = Vec::new();
    for (i, node) in nodes.iter().enumerate().skip(1) {
        if node.depth >= 2 && radii[i] < thin {
            let copies = if children[i] == 0 { 5 } else { 1 };
            places.extend(std::iter::repeat_n(i, copies));
        }
    }
    if places.is_empty() {
        places.extend(1..nodes.len());
    }
    let middle = Vec3::new(0.0, 0.55 * parameters.height, 0.0);
    let spread = 1.25 * parameters.leaf_length;
    // Colour goes by branch as well as by leaf, so that clumps differ.
    let branch_tints: Vec<f32> = (0..64).map(|_| random.unit()).collect();
    for leaf in 0..parameters.leaves {
        // Each place in turn, then all of them again: evenly, whatever the number of leaves.
        let place = places[(leaf as usize).wrapping_mul(7919) % places.len()];
        let node = &nodes[place];
        let stem = node.position - nodes[node.parent].position;
        let along = stem.normalize_or(Vec3::Y);
        let outward = (node.position - middle).normalize_or(Vec3::Y);
        let base = node.position - stem * random.unit() + random.in_ball() * spread * 0.6;
        let droop = Vec3::new(0.0, -0.35, 0.0);
        let direction =
            (0.5 * along + 0.45 * outward + droop + 0.95 * random.direction()).normalize_or(Vec3::X);
        let facing = Vec3::Y + 0.5 * outward + 0.8 * random.direction();
        let side = direction.cross(facing).normalize_or(direction.any_orthonormal_vector());
        let normal = side.cross(direction);
        let length = parameters.leaf_length * random.range(0.7, 1.25);
        let width = length * random.range(0.26, 0.36);
        let fold = Quat::from_axis_angle(side, -random.range(0.1, 0.5));
        let tip_way = fold * direction;
        let cup = random.range(0.05, 0.14) * length;
        let heart = base + direction * (0.48 * length) - normal * cup;
        let shoulder = base + direction * (0.42 * length);
        let tip = heart + tip_way * (0.55 * length);

        let warmth = 0.55 * branch_tints[place / 16 % 64] + 0.45 * random.unit();
        let outside = ((node.position - middle).length() / parameters.crown_radius).clamp(0.0, 1.2);
        let dark = Vec3::new(0.045, 0.115, 0.030);
        let fresh = Vec3::new(0.175, 0.270, 0.055);
        let yellow = Vec3::new(0.330, 0.300, 0.060);
        let albedo = dark.lerp(fresh, 0.25 + 0.5 * warmth + 0.2 * (outside - 0.5));
        let albedo = if random.unit() < 0.05 { albedo.lerp(yellow, 0.7) } else { albedo };
        let albedo = albedo.clamp(Vec3::splat(0.01), Vec3::ONE);

        let lean = cup / (0.5 * width).max(f32::MIN_POSITIVE);
        let left = (normal + side * 0.5 * lean.min(1.0)).normalize_or(normal);
        let right = (normal - side * 0.5 * lean.min(1.0)).normalize_or(normal);
        let far = (fold * normal).normalize_or(normal);
        let a = mesh.push(base, normal, albedo);
        let b = mesh.push(shoulder - side * width, left, albedo);
        let c = mesh.push(heart, normal, albedo * 0.9);
        let d = mesh.push(shoulder + side * width, right, albedo);
        let e = mesh.push(tip, far, albedo);
        mesh.indices.extend_from_slice(&[a, c, b, b, c, e, a, d, c, c, d, e]);
    }
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
