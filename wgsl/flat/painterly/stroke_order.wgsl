// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: painterly/stroke_order, permutation default
// summary: The order in which strokes are drawn: coarse before medium before fine, and within a layer as they lie.
// source: Ramalhao (2010), 3.5.2: coarse strokes for the general shape first, finer ones on top.
// note: Dispatch count_layers over chunks of 32 strokes of the capacity; then `core/scan` of 3 * chunks + 1 `layer_marks`; then
// note: order_strokes over chunks.
// binding frame: the frame.
// binding strokes: the strokes.
// binding layer_marks: of each layer how many strokes of it are in each chunk, and a 0 at the end; then their prefix sums.
// binding order: out, numbers of strokes.
// binding counts: how many there are; out, of each layer.

// ---- airlight::painterly::stroke ----
// summary: A brush stroke, its states, what a frame knows of all strokes, and the style of the three layers of strokes.
// source: Ramalhao, "Painterly stylization of real-time volume rendering" (2010), 4.2.1, 4.2.2, Table 5.1.

/// Layers of strokes: coarse 0, medium 1, fine 2.
const LAYERS: u32 = 3u;
/// Strokes that one thread counts and lists.
const CHUNK: u32 = 32u;

/// A brush stroke. 64 bytes.
struct Stroke {
    /// The point of the surface that it stands for, in the unit space of the volume, 0..1.
    point: vec3<f32>,
    /// Drawn at its birth: chooses brush, mirroring and variation, and seeds what chance does to it later.
    hash: u32,
    /// Scene-linear RGB that tints the brush.
    color: vec3<f32>,
    /// 0..1.
    opacity: f32,
    /// Of the point in the picture: (0, 0) top left, (1, 1) bottom right.
    position: vec2<f32>,
    /// Length, pixels of the picture.
    size: f32,
    /// Width over length.
    aspect: f32,
    /// Of its length in the picture, radians from +x towards +y (downwards), -pi/2 .. pi/2.
    orientation: f32,
    /// 0..2.
    layer: u32,
    /// STROKE_GONE, STROKE_STAYS, STROKE_LEAVES or STROKE_HIDDEN.
    state: u32,
    reserved: u32,
}

/// What a frame knows of all strokes. 176 bytes.
struct StrokeFrame {
    /// Unit space of the volume to the world, metres, in this frame.
    world_from_unit: mat4x4<f32>,
    /// Its inverse.
    unit_from_world: mat4x4<f32>,
    /// Width and height of the picture that strokes are drawn into, pixels.
    picture_size: vec2<f32>,
    /// Time since the frame before, seconds.
    seconds: f32,
    /// Number of the frame, for chance.
    frame: u32,
    /// Of a stroke of each layer, times the mean opacity of its brush: pixels of the sources.
    areas: vec3<f32>,
    /// Other seeds give other strokes.
    seed: u32,
    /// Strokes that fit into the buffers.
    capacity: u32,
    /// Factor on the probability of birth, 0..1; 0 for no new strokes.
    generation: f32,
    /// Factor on the probability of deletion, 0..1; 0 to thin nothing out.
    deletion: f32,
    reserved: f32,
}

/// Counts that stay on the GPU. The first four are the arguments of an indirect draw. 48 bytes.
struct StrokeCounts {
    /// Vertices of all strokes, 6 each.
    vertices: u32,
    /// 1: all strokes are one instance, for small instances leave threads idle.
    draws: u32,
    /// 0.
    first_vertex: u32,
    /// 0.
    first_instance: u32,
    /// Born in this frame.
    born: u32,
    /// Dropped in this frame, before they were born, because the buffer was full.
    dropped: u32,
    /// Dropped in all frames.
    dropped_in_all: u32,
    /// Strokes in the buffer.
    instances: u32,
    /// Strokes of the coarse layer.
    coarse: u32,
    /// Strokes of the medium layer.
    medium: u32,
    /// Strokes of the fine layer.
    fine: u32,
    /// Frames that were counted.
    frames: u32,
    /// Arguments of the indirect draw of densities: vertices of all strokes, 3 each; 1; 0; 0.
    density_draw: vec4<u32>,
}

/// Chunks of so many strokes.
fn chunks_of(strokes: u32) -> u32 {
    return (strokes + CHUNK - 1u) / CHUNK;
}

// ---- painterly/stroke_order ----

@group(0) @binding(0) var<uniform> frame: StrokeFrame;
@group(0) @binding(1) var<storage, read> strokes: array<Stroke>;
@group(0) @binding(2) var<storage, read_write> layer_marks: array<u32>;
@group(0) @binding(3) var<storage, read_write> order: array<u32>;
@group(0) @binding(4) var<storage, read_write> counts: StrokeCounts;

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
