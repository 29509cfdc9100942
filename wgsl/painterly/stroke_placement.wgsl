// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::painterly::stroke_placement
// summary: Which layer a pixel is in by its gradient magnitude, and whether chance puts a stroke there.
// source: Ramalhao (2010), 3.5.2, 3.5.3, 4.2.1, appendix A; hash: Jarzynski and Olano (2020), PCG3D.
// note: The text looks numbers of 8 bits up in a texture and places where `random <= p`: then p = 0 places with .0039. Here a
// note: hash of pixel, layer, frame and seed is drawn with 24 bits and compared by `<`: 0 never places, 1 always.
// note: The text has no hysteresis: strokes on a threshold would leave and be born again with every change of the gradient.
// equation: layer = number of thresholds ≤ magnitude;  stays: begin / (1 + h) ≤ magnitude < end (1 + h)
// equation: chance: hash / 2³² < p, 24 bits
// error: frequencies within what statistics allow;
// error: test painterly/stroke_placement::placement_draws_evenly_and_anew_in_every_pixel_layer_and_frame.
// error: thresholds exact; test painterly/stroke_placement::thresholds_divide_layers_and_hysteresis_holds_strokes_in_theirs.
// parameter magnitude: of the gradient, from 0 up; negative for no surface.
// parameter thresholds: where layers end, ascending.
// parameter pixel: column and row, or number in the queue, from 0.
// parameter layer: 0..2.
// parameter frame: number of the frame, from 0.
// parameter seed: any bits.
// parameter probability: 0..1.
// parameter pixels: how many, from 1 up.

#import airlight::core::noise::{hash_of_three, unit_from_hash}
#import airlight::painterly::stroke::NO_LAYER

/// Seeds of what is drawn for different purposes.
const PLACING: u32 = 0x9e3779b9u;
const THINNING: u32 = 0x85ebca6bu;
const QUEUEING: u32 = 0xc2b2ae35u;

/// The layer of a gradient magnitude, 0..2, or NO_LAYER beyond the last of the ascending thresholds; a negative magnitude
/// stands for no surface. A threshold belongs to the layer that begins there.
fn layer_of(magnitude: f32, thresholds: vec3<f32>) -> u32 {
    let above = select(vec3<u32>(0u), vec3<u32>(1u), vec3<f32>(magnitude) >= thresholds);
    return select(NO_LAYER, above.x + above.y + above.z, magnitude >= 0.0);
}

/// Whether a stroke of `layer`, 0..2, stays where the gradient has this magnitude. `hysteresis`: share of its thresholds by
/// which a stroke may be beyond them.
fn stays_in_layer(magnitude: f32, layer: u32, thresholds: vec3<f32>, hysteresis: f32) -> bool {
    let begin = select(select(thresholds.y, thresholds.x, layer == 1u), 0.0, layer == 0u);
    let end = select(select(thresholds.z, thresholds.y, layer == 1u), thresholds.x, layer == 0u);
    let wider = 1.0 + max(hysteresis, 0.0);
    return magnitude >= begin / wider && magnitude < end * wider;
}

/// Hashes of a pixel, up to 65535 across and down, in a layer and frame: .x places, .y is the stroke's own.
fn placement_hashes(pixel: vec2<u32>, layer: u32, frame: u32, seed: u32) -> vec3<u32> {
    return hash_of_three(vec3<u32>(pixel.x | (pixel.y << 16u), (seed ^ PLACING) + layer, frame));
}

/// Whether chance with a probability of 0..1 says yes. `hash`: of what is drawn for.
fn chance(hash: u32, probability: f32) -> bool {
    return unit_from_hash(hash) < probability;
}

/// A hash that decides in a frame whether a stroke is deleted. `hash`: the stroke's own.
fn thinning_hash(hash: u32, frame: u32, seed: u32) -> u32 {
    return hash_of_three(vec3<u32>(hash, seed ^ THINNING, frame)).x;
}

/// A number drawn for a stroke once for all, -1..1. `hash`: the stroke's own. `purpose`: what it is for.
fn own_variation(hash: u32, purpose: u32) -> f32 {
    return 2.0 * unit_from_hash(hash_of_three(vec3<u32>(hash, purpose, 0u)).x) - 1.0;
}

/// Which pixel's stroke is born first in a frame, 0 .. pixels - 1: those that come last are dropped where the buffer is full,
/// which shall not always be the same part of the picture.
fn first_in_queue(pixels: u32, frame: u32, seed: u32) -> u32 {
    return hash_of_three(vec3<u32>(frame, seed ^ QUEUEING, pixels)).x % max(pixels, 1u);
}

/// Place in the queue of a pixel, both 0 .. pixels - 1. `first`: the pixel at its head.
fn place_in_queue(pixel: u32, first: u32, pixels: u32) -> u32 {
    return select(pixel + pixels - first, pixel - first, pixel >= first);
}
