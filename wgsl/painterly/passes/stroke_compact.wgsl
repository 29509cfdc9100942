// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Strokes that are kept, in their order, then those that are born, closely packed into another buffer.
// source: Ramalhao (2010), 4.2.2, 4.2.4: what the geometry shaders' output streams did, here by prefix sums.
// note: The same input gives the same strokes, bit for bit. What does not fit is dropped: new strokes only, and counted.
// note: Dispatch list_survivors over chunks of 32 strokes of the capacity, list_births over blocks of 8 by 4 pixels,
// note: count_strokes once, gather_strokes over the capacity.
// definition CURVATURE: strokes may follow the direction of greatest curvature.
// binding color: premultiplied linear RGB, alpha 1 where there is a surface; rgba16float.
// binding surface: unit normal in the world, 0 where there is no surface, and gradient magnitude; rgba16float.
// binding distances: metres along the view ray, negative where there is no surface; r32float.
// binding curvature: principal curvatures, and (cos 2a, sin 2a) of the picture's direction of the greater; with CURVATURE only.
// binding camera: the camera of this frame; its viewport is not used.
// binding frame: the frame.
// binding style: the style.
// binding strokes: the strokes of before.
// binding marks: exclusive prefix sums of the marks of `stroke_population`.
// binding sources: out, of each new place, number of the stroke, or capacity + number of the pixel that gives birth.
// binding kept: out, the strokes.
// binding counts: out, how many there are.
// binding birth_bits: of each block the pixels that give birth, a bit each.

#import airlight::core::camera::{Camera, view_ray}
#import airlight::painterly::stroke::{
    Stroke, StrokeFrame, StrokeStyle, StrokeCounts, STROKE_STAYS, STROKE_GONE, LAYERS, CHUNK, BLOCK,
    of_layer, chunks_of, blocks_of
}
#import airlight::painterly::stroke_expand::varied_size
#import airlight::painterly::stroke_placement::{layer_of, placement_hashes, first_in_queue, place_in_queue}
#import airlight::painterly::stroke_targets::{surface_texel, source_size}
#import airlight::painterly::stroke_update::{surface_orientation, LEAST_OPACITY}

@group(#{GROUP}) @binding(4) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(5) var<uniform> frame: StrokeFrame;
@group(#{GROUP}) @binding(6) var<uniform> style: StrokeStyle;
@group(#{GROUP}) @binding(7) var<storage, read> strokes: array<Stroke>;
@group(#{GROUP}) @binding(8) var<storage, read> marks: array<u32>;
@group(#{GROUP}) @binding(9) var<storage, read_write> sources: array<u32>;
@group(#{GROUP}) @binding(10) var<storage, read_write> kept: array<Stroke>;
@group(#{GROUP}) @binding(11) var<storage, read_write> counts: StrokeCounts;
@group(#{GROUP}) @binding(12) var<storage, read> birth_bits: array<u32>;

/// Strokes that fit into all buffers.
fn capacity() -> u32 {
    return min(frame.capacity, min(arrayLength(&sources), min(arrayLength(&strokes), arrayLength(&kept))));
}

/// Place of the first of a chunk or block; of the end, how many there are.
fn place_of(mark: u32) -> u32 {
    return marks[min(mark, arrayLength(&marks) - 1u)];
}

@compute @workgroup_size(64)
fn list_survivors(@builtin(global_invocation_id) id: vec3<u32>) {
    let present = min(counts.instances, min(frame.capacity, arrayLength(&strokes)));
    var place = place_of(id.x);
    let first = id.x * CHUNK;
    let end = min(first + CHUNK, present);
    for (var index = first; index < end; index++) {
        let survives = strokes[index].state != STROKE_GONE;
        if survives && place < capacity() {
            sources[place] = index;
        }
        place += select(0u, 1u, survives);
    }
}

@compute @workgroup_size(8, 8)
fn list_births(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = source_size();
    let blocks = blocks_of(size);
    if any(id.xy >= blocks) {
        return;
    }
    let all = blocks.x * blocks.y;
    let block = id.y * blocks.x + id.x;
    let queue = place_in_queue(block, first_in_queue(all, frame.frame, frame.seed), all);
    var place = place_of(chunks_of(frame.capacity) + queue);
    for (var left = birth_bits[min(block, arrayLength(&birth_bits) - 1u)]; left != 0u; left &= left - 1u) {
        let bit = firstTrailingBit(left);
        let pixel = id.xy * BLOCK + vec2<u32>(bit % BLOCK.x, bit / BLOCK.x);
        if place < capacity() {
            sources[place] = frame.capacity + pixel.y * size.x + pixel.x;
        }
        place++;
    }
}

@compute @workgroup_size(1)
fn count_strokes() {
    let blocks = blocks_of(source_size());
    let chunks = chunks_of(frame.capacity);
    let all = place_of(chunks + blocks.x * blocks.y);
    let survivors = place_of(chunks);
    let fit = min(all, capacity());
    counts.instances = fit;
    counts.vertices = 6u * fit;
    counts.draws = 1u;
    counts.density_draw = vec4<u32>(3u * fit, 1u, 0u, 0u);
    counts.born = fit - min(survivors, fit);
    counts.dropped = all - fit;
    counts.dropped_in_all += all - fit;
    counts.frames += 1u;
}

/// The stroke that a pixel gives birth to.
fn newborn(pixel: vec2<u32>) -> Stroke {
    let surface = surface_texel(pixel);
    let layer = min(layer_of(surface.magnitude * style.gradient_scale, style.thresholds), LAYERS - 1u);
    let hash = placement_hashes(pixel, layer, frame.frame, frame.seed).y;
    let position = (vec2<f32>(pixel) + 0.5) / vec2<f32>(source_size());
    let ray = view_ray(camera, position * vec2<f32>(2.0, -2.0) + vec2<f32>(-1.0, 1.0));
    let world = ray.origin + max(surface.distance, 0.0) * ray.direction;
    return Stroke(
        (frame.unit_from_world * vec4<f32>(world, 1.0)).xyz,
        hash,
        surface.color,
        min(LEAST_OPACITY, of_layer(style.opacity, layer)),
        position,
        varied_size(of_layer(style.size, layer), hash, style.size_variation),
        of_layer(style.aspect, layer),
        surface_orientation(camera, world, ray, surface, style, frame.picture_size, style.angle),
        layer,
        STROKE_STAYS,
        0u
    );
}

@compute @workgroup_size(64)
fn gather_strokes(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x;
    // Loops: software adapters run both sides of a branch.
    for (var there = select(0u, 1u, index < min(counts.instances, capacity())); there > 0u; there--) {
        let source = sources[index];
        let survives = source < frame.capacity;
        var stroke = strokes[min(source, min(frame.capacity, arrayLength(&strokes)) - 1u)];
        for (var births = select(1u, 0u, survives); births > 0u; births--) {
            let pixel = source - frame.capacity;
            let columns = source_size().x;
            stroke = newborn(vec2<u32>(pixel % columns, pixel / columns));
        }
        kept[index] = stroke;
    }
}
