// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is to be seen of a tree: bark around its skeleton, and leaves.

use std::f32::consts::TAU;

use glam::{Quat, Vec3};

use super::skeleton::Node;
use super::{Mesh, Random, TreeParameters};

/// Tapered tubes along chains of nodes: each chain follows the thickest child.
pub(super) fn bark(
    parameters: &TreeParameters,
    nodes: &[Node],
    radii: &[f32],
    random: &mut Random,
    mesh: &mut Mesh,
) {
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
pub(super) fn leaves(
    parameters: &TreeParameters,
    nodes: &[Node],
    radii: &[f32],
    random: &mut Random,
    mesh: &mut Mesh,
) {
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
