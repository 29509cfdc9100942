// SPDX-License-Identifier: MIT OR Apache-2.0
//! The branches of a tree as a skeleton: where they grow and how thick they are.

use std::f32::consts::TAU;

use glam::Vec3;

use super::{Random, TreeParameters};

/// Nodes grown at most, so that any parameters end.
const MAX_NODES: usize = 12_000;
/// Points that attract branches.
const ATTRACTORS: usize = 1500;

/// A joint of the branches.
pub(super) struct Node {
    pub(super) position: Vec3,
    /// The node that it grew from.
    pub(super) parent: usize,
    /// Number of nodes between it and the trunk, 0 on the trunk itself.
    pub(super) depth: u32,
}

struct Clump {
    center: Vec3,
    radii: Vec3,
}

/// The cloud of points that the branches grow towards.
pub(super) fn attractors(parameters: &TreeParameters, random: &mut Random) -> Vec<Vec3> {
    let clumps = clumps(parameters, random);
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
    attractors
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
pub(super) fn grow(parameters: &TreeParameters, attractors: Vec<Vec3>, random: &mut Random) -> Vec<Node> {
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

/// Radius of the branch at each node.
pub(super) fn thickness(parameters: &TreeParameters, nodes: &[Node]) -> Vec<f32> {
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
