// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Chance deletes strokes where they lie too densely, and puts new ones on pixels where they lie too thinly.
// source: Ramalhao (2010), 4.2.1, 4.2.4, 4.2.5.
// note: `marks` is filled with how many strokes are kept of each chunk of 32, then how many pixels give birth of each block of
// note: 8 by 4, in the order of the frame's queue, and a 0 at the end; `core/scan` of chunks + blocks + 1 of them gives each its
// note: place in the next buffer. Dispatch thin_strokes over the capacity, count_survivors over chunks of it, place_strokes over
// note: blocks of the sources.
// note: What is deleted fades out. Density is read at the nearest texel.
// binding surface: unit normal in the world, 0 where there is no surface, and gradient magnitude; rgba16float.
// binding distances: metres along the view ray, negative where there is no surface; r32float.
// binding frame: the frame.
// binding style: the style.
// binding density: density of the strokes, a layer a channel; rgba16float.
// binding strokes: the strokes: their states change.
// binding counts: how many there are.
// binding marks: out, strokes of each chunk that are kept, and births of each block.
// binding birth_bits: out, of each block the pixels that give birth, a bit each, row after row.

#import airlight::painterly::stroke::{
    Stroke, StrokeFrame, StrokeStyle, StrokeCounts, STROKE_GONE, STROKE_STAYS, STROKE_LEAVES, LAYERS, CHUNK, BLOCK, of_layer,
    chunks_of, blocks_of
}
#import airlight::painterly::stroke_density::{birth_probability, deletion_probability}
#import airlight::painterly::stroke_placement::{
    layer_of, placement_hashes, thinning_hash, chance, first_in_queue, place_in_queue
}
#import airlight::painterly::stroke_targets::{magnitude_at, source_size}

@group(#{GROUP}) @binding(4) var<uniform> frame: StrokeFrame;
@group(#{GROUP}) @binding(5) var<uniform> style: StrokeStyle;
@group(#{GROUP}) @binding(6) var density: texture_2d<f32>;
@group(#{GROUP}) @binding(7) var<storage, read_write> strokes: array<Stroke>;
@group(#{GROUP}) @binding(8) var<storage, read> counts: StrokeCounts;
@group(#{GROUP}) @binding(9) var<storage, read_write> marks: array<u32>;
@group(#{GROUP}) @binding(10) var<storage, read_write> birth_bits: array<u32>;

/// Density of a layer at a position of the picture, 0..1.
fn density_at(position: vec2<f32>, layer: u32) -> f32 {
    let size = textureDimensions(density);
    let texel = vec2<u32>(clamp(position * vec2<f32>(size), vec2<f32>(0.0), vec2<f32>(size) - 1.0));
    return of_layer(textureLoad(density, texel, 0).xyz, layer);
}

/// Strokes that there are, within all buffers.
fn present() -> u32 {
    return min(counts.instances, min(frame.capacity, arrayLength(&strokes)));
}

@compute @workgroup_size(64)
fn thin_strokes(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x;
    // A loop: software adapters run both sides of a branch.
    for (var there = select(0u, 1u, index < present()); there > 0u; there--) {
        let stroke = strokes[index];
        let most = of_layer(style.density_max, stroke.layer);
        let probability = deletion_probability(density_at(stroke.position, stroke.layer), most) * frame.deletion;
        let drawn = chance(thinning_hash(stroke.hash, frame.frame, frame.seed), probability);
        strokes[index].state = select(stroke.state, STROKE_LEAVES, stroke.state == STROKE_STAYS && drawn);
    }
}

@compute @workgroup_size(64)
fn count_survivors(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= min(chunks_of(frame.capacity), arrayLength(&marks)) {
        return;
    }
    let first = id.x * CHUNK;
    let end = min(first + CHUNK, present());
    var survivors = 0u;
    for (var index = first; index < end; index++) {
        survivors += select(0u, 1u, strokes[index].state != STROKE_GONE);
    }
    marks[id.x] = survivors;
}

/// Probability that a pixel of the sources gives birth, 0..1. `layer`: 0..2.
fn birth_at(pixel: vec2<u32>, size: vec2<u32>, layer: u32) -> f32 {
    let position = (vec2<f32>(pixel) + 0.5) / vec2<f32>(size);
    return frame.generation * birth_probability(
        density_at(position, layer), of_layer(style.density_min, layer), style.density_unit,
        of_layer(style.opacity, layer), of_layer(frame.areas, layer), of_layer(style.probability, layer)
    );
}

@compute @workgroup_size(8, 8)
fn place_strokes(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = source_size();
    let blocks = blocks_of(size);
    if any(id.xy >= blocks) {
        return;
    }
    let first = id.xy * BLOCK;
    let end = min(size - first, BLOCK);
    var born = 0u;
    for (var y = 0u; y < end.y; y++) {
        for (var x = 0u; x < end.x; x++) {
            let pixel = first + vec2<u32>(x, y);
            let layer = layer_of(magnitude_at(pixel) * style.gradient_scale, style.thresholds);
            var probability = 0.0;
            // Loops: software adapters run both sides of a branch, and few pixels give birth.
            for (var seen = select(0u, 1u, layer < LAYERS); seen > 0u; seen--) {
                probability = birth_at(pixel, size, layer);
            }
            for (var drawn = select(0u, 1u, probability > 0.0); drawn > 0u; drawn--) {
                let hash = placement_hashes(pixel, layer, frame.frame, frame.seed).x;
                born |= select(0u, 1u, chance(hash, probability)) << (y * BLOCK.x + x);
            }
        }
    }
    let all = blocks.x * blocks.y;
    let block = id.y * blocks.x + id.x;
    let place = place_in_queue(block, first_in_queue(all, frame.frame, frame.seed), all);
    let chunks = chunks_of(frame.capacity);
    if chunks + place < arrayLength(&marks) && block < arrayLength(&birth_bits) {
        birth_bits[block] = born;
        marks[chunks + place] = countOneBits(born);
    }
    if block == 0u && chunks + all < arrayLength(&marks) {
        marks[chunks + all] = 0u;
    }
}
