// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Strokes that are kept, in their order, then those that are born, closely packed into another buffer.
// source: Ramalhao (2010), 4.2.2, 4.2.4: what the geometry shaders' output streams did, here by prefix sums.
// note: The same input gives the same strokes, bit for bit. What does not fit is dropped: new strokes only, and counted.
// note: Dispatch list_survivors over the capacity, list_births over the pixels, gather_strokes over the capacity; then
// note: `core/scan` of 3 * capacity + 1 `layer_marks`.
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
// binding layer_marks: out, for each layer and place 1 where a stroke of that layer is, and a 0 at the end.

#import airlight::core::camera::{Camera, view_ray}
#import airlight::painterly::stroke::{
    Stroke, StrokeFrame, StrokeStyle, StrokeCounts, STROKE_STAYS, LAYERS, of_layer
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
@group(#{GROUP}) @binding(12) var<storage, read_write> layer_marks: array<u32>;

/// Strokes that fit into all buffers.
fn capacity() -> u32 {
    return min(frame.capacity, min(arrayLength(&sources), min(arrayLength(&strokes), arrayLength(&kept))));
}

/// Writes where the mark `index` of all comes from, if it is one and fits.
fn list(index: u32, source: u32) {
    let place = marks[min(index, arrayLength(&marks) - 1u)];
    let next = marks[min(index + 1u, arrayLength(&marks) - 1u)];
    if next != place && place < capacity() {
        sources[place] = source;
    }
}

@compute @workgroup_size(64)
fn list_survivors(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x == 0u {
        let size = source_size();
        let all = marks[min(frame.capacity + size.x * size.y, arrayLength(&marks) - 1u)];
        let survivors = marks[min(frame.capacity, arrayLength(&marks) - 1u)];
        let fit = min(all, capacity());
        counts.instances = fit;
        counts.born = fit - min(survivors, fit);
        counts.dropped = all - fit;
        counts.dropped_in_all += all - fit;
        counts.frames += 1u;
    }
    if id.x < frame.capacity {
        list(id.x, id.x);
    }
}

@compute @workgroup_size(16, 8)
fn list_births(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = source_size();
    if any(id.xy >= size) {
        return;
    }
    let pixels = size.x * size.y;
    let pixel = id.y * size.x + id.x;
    let place = place_in_queue(pixel, first_in_queue(pixels, frame.frame, frame.seed), pixels);
    list(frame.capacity + place, frame.capacity + pixel);
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
    if index >= capacity() {
        return;
    }
    let present = index < counts.instances;
    let source = select(0u, sources[index], present);
    let survives = source < frame.capacity;
    var stroke = strokes[min(source, frame.capacity - 1u)];
    // A loop: software adapters run both sides of a branch.
    for (var births = select(1u, 0u, survives); births > 0u; births--) {
        let pixel = source - frame.capacity;
        let columns = source_size().x;
        stroke = newborn(vec2<u32>(pixel % columns, pixel / columns));
    }
    if present {
        kept[index] = stroke;
    }
    for (var layer = 0u; layer < LAYERS; layer++) {
        let mark = layer * frame.capacity + index;
        if mark < arrayLength(&layer_marks) {
            layer_marks[mark] = select(0u, 1u, present && stroke.layer == layer);
        }
    }
    if index == 0u && LAYERS * frame.capacity < arrayLength(&layer_marks) {
        layer_marks[LAYERS * frame.capacity] = 0u;
    }
}
