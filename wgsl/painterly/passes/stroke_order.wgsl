// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: The order in which strokes are drawn: coarse before medium before fine, and within a layer as they lie.
// source: Ramalhao (2010), 3.5.2: coarse strokes for the general shape first, finer ones on top.
// binding frame: the frame.
// binding strokes: the strokes.
// binding layer_marks: exclusive prefix sums of the marks of `stroke_compact`.
// binding order: out, numbers of strokes.
// binding counts: how many there are; out, of each layer.

#import airlight::painterly::stroke::{Stroke, StrokeFrame, StrokeCounts, LAYERS}

@group(#{GROUP}) @binding(0) var<uniform> frame: StrokeFrame;
@group(#{GROUP}) @binding(1) var<storage, read> strokes: array<Stroke>;
@group(#{GROUP}) @binding(2) var<storage, read> layer_marks: array<u32>;
@group(#{GROUP}) @binding(3) var<storage, read_write> order: array<u32>;
@group(#{GROUP}) @binding(4) var<storage, read_write> counts: StrokeCounts;

/// Strokes before the mark `index` of all.
fn before(index: u32) -> u32 {
    return layer_marks[min(index, arrayLength(&layer_marks) - 1u)];
}

@compute @workgroup_size(64)
fn order_strokes(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x;
    if index == 0u {
        let medium = before(frame.capacity);
        let fine = before(2u * frame.capacity);
        counts.coarse = medium;
        counts.medium = fine - medium;
        counts.fine = before(3u * frame.capacity) - fine;
    }
    if index >= min(min(frame.capacity, counts.instances), arrayLength(&strokes)) {
        return;
    }
    let place = before(min(strokes[index].layer, LAYERS - 1u) * frame.capacity + index);
    if place < arrayLength(&order) {
        order[place] = index;
    }
}
