// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: The order in which strokes are drawn: coarse before medium before fine, and within a layer as they lie.
// source: Ramalhao (2010), 3.5.2: coarse strokes for the general shape first, finer ones on top.
// note: Dispatch count_layers over chunks of 32 strokes of the capacity; then `core/scan` of 3 * chunks + 1 `layer_marks`; then
// note: order_strokes over chunks.
// binding frame: the frame.
// binding strokes: the strokes.
// binding layer_marks: of each layer how many strokes of it are in each chunk, and a 0 at the end; then their prefix sums.
// binding order: out, numbers of strokes.
// binding counts: how many there are; out, of each layer.

#import airlight::painterly::stroke::{Stroke, StrokeFrame, StrokeCounts, LAYERS, CHUNK, chunks_of}

@group(#{GROUP}) @binding(0) var<uniform> frame: StrokeFrame;
@group(#{GROUP}) @binding(1) var<storage, read> strokes: array<Stroke>;
@group(#{GROUP}) @binding(2) var<storage, read_write> layer_marks: array<u32>;
@group(#{GROUP}) @binding(3) var<storage, read_write> order: array<u32>;
@group(#{GROUP}) @binding(4) var<storage, read_write> counts: StrokeCounts;

/// One beyond the last stroke of a chunk that begins with `first`.
fn end_of(first: u32) -> u32 {
    return min(first + CHUNK, min(min(frame.capacity, counts.instances), arrayLength(&strokes)));
}

/// One more of a layer, 0..2.
fn one_of(layer: u32) -> vec3<u32> {
    return select(vec3<u32>(0u), vec3<u32>(1u), vec3<u32>(0u, 1u, 2u) == vec3<u32>(min(layer, LAYERS - 1u)));
}

/// Strokes before the mark `index` of all.
fn before(index: u32) -> u32 {
    return layer_marks[min(index, arrayLength(&layer_marks) - 1u)];
}

@compute @workgroup_size(64)
fn count_layers(@builtin(global_invocation_id) id: vec3<u32>) {
    let chunks = chunks_of(frame.capacity);
    let end = LAYERS * chunks;
    if id.x >= chunks || end >= arrayLength(&layer_marks) {
        return;
    }
    let first = id.x * CHUNK;
    let last = end_of(first);
    var found = vec3<u32>(0u);
    for (var index = first; index < last; index++) {
        found += one_of(strokes[index].layer);
    }
    layer_marks[id.x] = found.x;
    layer_marks[chunks + id.x] = found.y;
    layer_marks[2u * chunks + id.x] = found.z;
    if id.x == 0u {
        layer_marks[end] = 0u;
    }
}

@compute @workgroup_size(64)
fn order_strokes(@builtin(global_invocation_id) id: vec3<u32>) {
    let chunks = chunks_of(frame.capacity);
    if id.x >= chunks {
        return;
    }
    let first = id.x * CHUNK;
    let last = end_of(first);
    var places = vec3<u32>(before(id.x), before(chunks + id.x), before(2u * chunks + id.x));
    for (var index = first; index < last; index++) {
        let one = one_of(strokes[index].layer);
        let place = dot(one, places);
        if place < arrayLength(&order) {
            order[place] = index;
        }
        places += one;
    }
    if id.x == 0u {
        let medium = before(chunks);
        let fine = before(2u * chunks);
        counts.coarse = medium;
        counts.medium = fine - medium;
        counts.fine = before(3u * chunks) - fine;
    }
}
