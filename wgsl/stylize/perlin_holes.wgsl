// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::stylize::perlin_holes
// summary: Random holes in the shadow of an object: where octaves of gradient noise lie below a threshold.
// source: stylized scattering 4.1, Eq. 4 and 5; thesis 6.2.1, Eq. 6.2 and 6.3.
// note: N(q) = sum over i = 0 .. o-1 of p^i / max(1, o - i - 1) P(2^i q + offset), q = t g f: cells of the first octave.
// note: Eq. 5 prints P(q), with which octaves do nothing. Each octave has gradients and an offset of its own: P is 0 on
// note: lattice points, and without offsets all octaves would be 0 on those of the first.
// note: A threshold h in 0..1 needs noise in 0..1: it is .5 + .5 N / (sum of the weights / sqrt 2). H = 1 where that is
// note: below h, and H = 1 is a hole. The host finds h from the share of the area that is to be hole, and q from the size.
// note: Animation looks up twice: one octave of noise that travels with time says by how much, and through the turn in which
// note: direction, to displace where N is read. Eq. 5 is read there for the first look-up too; one octave of gradients of
// note: its own leaves the share of holes as it is, since the displacement then knows nothing of N, and does not tear holes.
// equation: N(q) = Σ_(i<o) p^i / max(1, o − i − 1) P(2^i q + o_i);  noise = ½ + N / (√2 Σ weights);  hole ⇔ noise < h
// equation: displaced: q' = q + a v (cos(turn v), sin(turn v)), v = √2 P of the travelling noise
// error: noise within 5e-5, moving 1e-4; test stylize/perlin_holes::noise_and_masks_are_those_of_the_reference.
// error: area within 0.02, size within 15 % of what was asked for; test stylize/perlin_holes::holes_have_the_area_and_size_that_were_asked_for.
// parameter seed: any bits.
// parameter position: cells of the first octave.
// parameter uv: place in the map, 0..1.
// parameter a, b: depths, 0..1.
// parameter far_depth: 1 forward, 0 reversed.
// parameter depth: 0..1, finite.

#import airlight::core::noise::{hash_of_three, unit_from_hash, gradient_noise, gradient_noise_in_cell}

/// Octaves at most.
const MOST_OCTAVES: u32 = 8u;
/// Between the seeds of octaves: 2^32 over the golden ratio.
const OCTAVE_SEED: u32 = 2654435769u;
/// Tells the hashes of offsets from those of gradients.
const OFFSET_KEY: u32 = 0x6f666673u;
/// Tells the travelling noise from the octaves.
const TRAVEL_KEY: u32 = 0x74726176u;

/// What holes look like.
struct HoleParameters {
    /// Cells of the first octave across the width and the height of the map, g f of Eq. 4; positive.
    cells: vec2<f32>,
    /// Noise below it is a hole: nothing at 0 and below, all above 1.
    threshold: f32,
    /// Weight of an octave over that of the one before, 0..1.
    persistence: f32,
    /// Number of octaves, 1..8.
    octaves: u32,
    /// Any number: other holes.
    seed: u32,
    /// How far the first look-up has travelled, whole cells, modulo 2^32.
    travel: u32,
    /// The rest of it, 0..1, cells.
    travel_part: f32,
    /// How far the second look-up is displaced at most, cells; 0 for holes that stand still.
    displacement: f32,
    /// By how much the displacement turns from the noise's middle to its end, radians.
    turn: f32,
    /// Depth of an empty texel: 1 forward, 0 reversed.
    far_depth: f32,
    reserved: f32,
}

/// Where the lattice of an octave lies, cells, 0..1.
fn octave_offset(seed: u32) -> vec2<f32> {
    let hash = hash_of_three(vec3<u32>(OFFSET_KEY, seed, OFFSET_KEY));
    return vec2<f32>(unit_from_hash(hash.x), unit_from_hash(hash.y));
}

/// Octaves of noise (Eq. 5), mapped to 0..1. `position`: cells of the first octave.
fn octave_noise(holes: HoleParameters, position: vec2<f32>) -> f32 {
    let octaves = clamp(holes.octaves, 1u, MOST_OCTAVES);
    var sum = 0.0;
    var weights = 0.0;
    let persistence = clamp(holes.persistence, 0.0, 1.0);
    var power = 1.0;
    var scale = 1.0;
    for (var octave = 0u; octave < octaves; octave++) {
        let seed = holes.seed + octave * OCTAVE_SEED;
        let weight = power / f32(max(octaves - octave, 2u) - 1u);
        sum += weight * gradient_noise(scale * position + octave_offset(seed), seed);
        weights += weight;
        power *= persistence;
        scale *= 2.0;
    }
    return clamp(0.5 + 0.70710678 * sum / weights, 0.0, 1.0);
}

/// Where the second look-up reads, for a position in cells of the first octave.
fn displaced(holes: HoleParameters, position: vec2<f32>) -> vec2<f32> {
    let seed = holes.seed ^ TRAVEL_KEY;
    let start = position + octave_offset(seed) + vec2<f32>(holes.travel_part, 0.0);
    let cell = floor(start);
    let travelled = vec2<i32>(cell) + vec2<i32>(bitcast<i32>(holes.travel), 0);
    // -1..1.
    let value = 1.4142135 * gradient_noise_in_cell(travelled, start - cell, seed);
    let angle = holes.turn * value;
    return position + holes.displacement * value * vec2<f32>(cos(angle), sin(angle));
}

/// The noise that is thresholded, 0..1. `uv`: place in the map, 0..1 across and down.
fn hole_noise(holes: HoleParameters, uv: vec2<f32>) -> f32 {
    let position = uv * holes.cells;
    if holes.displacement == 0.0 {
        return octave_noise(holes, position);
    }
    return octave_noise(holes, displaced(holes, position));
}

/// H of Eq. 4: true in a hole. `uv`: place in the map, 0..1 across and down. For fragment shaders that draw an object into a
/// shadow map with others, to discard what falls into a hole: `if discards_hole(holes, position.xy / size) { discard; }`.
fn discards_hole(holes: HoleParameters, uv: vec2<f32>) -> bool {
    return hole_noise(holes, uv) < holes.threshold;
}

/// Depth of an object with its holes: far where there is one. `depth`: finite.
fn punched_depth(holes: HoleParameters, uv: vec2<f32>, depth: f32) -> f32 {
    return select(depth, holes.far_depth, discards_hole(holes, uv));
}

/// The depth nearer to the light of two, in the convention of `far_depth`: 1 forward, 0 reversed.
fn nearer_depth(far_depth: f32, a: f32, b: f32) -> f32 {
    return select(max(a, b), min(a, b), far_depth > 0.5);
}
