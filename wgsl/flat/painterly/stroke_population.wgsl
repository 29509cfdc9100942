// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: painterly/stroke_population, permutation default
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

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

// ---- airlight::core::noise ----
// summary: Gradient noise in two dimensions, in -1/sqrt 2 .. 1/sqrt 2, of an integer hash.
// source: Perlin, "An image synthesizer" (1985); fade: Perlin, "Improving noise" (2002); hash: Jarzynski and Olano, "Hash functions for GPU rendering" (2020), PCG3D.

/// Three hashes of three whole numbers; high bits are better than low ones.
fn hash_of_three(key: vec3<u32>) -> vec3<u32> {
    var v = key * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v = v ^ (v >> vec3<u32>(16u));
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

/// The upper 24 bits of a hash as a number in [0, 1), exact.
fn unit_from_hash(hash: u32) -> f32 {
    return f32(hash >> 8u) * (1.0 / 16777216.0);
}

// ---- airlight::painterly::stroke ----
// summary: A brush stroke, its states, what a frame knows of all strokes, and the style of the three layers of strokes.
// source: Ramalhao, "Painterly stylization of real-time volume rendering" (2010), 4.2.1, 4.2.2, Table 5.1.

/// Layers of strokes: coarse 0, medium 1, fine 2.
const LAYERS: u32 = 3u;
/// Strokes that one thread counts and lists.
const CHUNK: u32 = 32u;
/// Columns and rows of pixels that one thread looks at for births: as many as a word has bits.
const BLOCK: vec2<u32> = vec2<u32>(8u, 4u);
/// Where there is no surface, or its gradient is beyond the last threshold.
const NO_LAYER: u32 = 3u;

/// Has faded out: the next compaction leaves it away.
const STROKE_GONE: u32 = 0u;
/// Fades in to the opacity of its layer, or has done so.
const STROKE_STAYS: u32 = 1u;
/// Fades out: it left its layer, or there were too many.
const STROKE_LEAVES: u32 = 2u;

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

/// Style of the strokes; three numbers are those of the coarse, medium and fine layer. 192 bytes.
struct StrokeStyle {
    /// Where each layer ends, gradient magnitude, ascending; the first begins at 0.
    thresholds: vec3<f32>,
    /// A stroke leaves its layer where the gradient is beyond its ends by this share of them.
    hysteresis: f32,
    /// Probability, 0..1, that a pixel of the sources gets a stroke in a frame where density is lacking.
    probability: vec3<f32>,
    /// Factor on gradient magnitudes before they meet the thresholds.
    gradient_scale: f32,
    /// Length, pixels of the picture.
    size: vec3<f32>,
    /// Strokes are longer or shorter by up to this share, 0..1.
    size_variation: f32,
    /// Width over length.
    aspect: vec3<f32>,
    /// Strokes are lighter or darker by up to this share, 0..1.
    color_variation: f32,
    /// Of a stroke that has faded in, 0..1.
    opacity: vec3<f32>,
    /// Density that one opaque stroke adds, kappa.
    density_unit: f32,
    /// Below this density strokes are born.
    density_min: vec3<f32>,
    /// 1: density counts strokes with the opacity they fade to; 0: with the opacity they have. Between: mixed.
    anticipation: f32,
    /// Above this density strokes are deleted.
    density_max: vec3<f32>,
    /// A stroke is seen where the surface lies within this many pixels' slope of its point.
    occlusion_tolerance: f32,
    /// Brush of each layer, a layer of the texture; negative for any, by the stroke's hash.
    brush: vec3<f32>,
    /// ALONG_SURFACE, FIXED_ANGLE or ALONG_CURVATURE.
    orientation: u32,
    /// Added to the orientation, radians; with FIXED_ANGLE it is the orientation.
    angle: f32,
    /// Share of the new colour that a stroke takes in a sixtieth of a second, 0..1.
    color_rate: f32,
    /// The same of its orientation.
    orientation_rate: f32,
    /// The same of its size.
    size_rate: f32,
    /// The same of its opacity while it fades in.
    opacity_rate: f32,
    /// The same while it fades out.
    fade_out_rate: f32,
    /// The same where it is occluded or out of the picture.
    hidden_rate: f32,
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

/// The number of a layer, 0..2, out of three.
fn of_layer(three: vec3<f32>, layer: u32) -> f32 {
    return select(select(three.z, three.y, layer == 1u), three.x, layer == 0u);
}

/// Chunks of so many strokes.
fn chunks_of(strokes: u32) -> u32 {
    return (strokes + CHUNK - 1u) / CHUNK;
}

/// Columns and rows of blocks of so many pixels.
fn blocks_of(size: vec2<u32>) -> vec2<u32> {
    return (size + BLOCK - 1u) / BLOCK;
}

// ---- airlight::painterly::stroke_density ----
// summary: How densely strokes lie, and the probabilities of birth and deletion that keep it within bounds.
// source: Ramalhao (2010), 4.2.4, 4.2.5, Table 5.1.

/// Probability, 0..1, that a stroke is born at a pixel. `probability`: at most, of the layer. `opacity`: that it fades to.
/// `area`: in pixels that may give birth, times the mean opacity of the brush.
fn birth_probability(density: f32, least: f32, unit: f32, opacity: f32, area: f32, probability: f32) -> f32 {
    // As many as fill the gap, if every pixel within the area of a stroke draws.
    let filling = max(least - density, 0.0) / max(unit * opacity * area, 1e-12);
    return clamp(min(filling, probability), 0.0, 1.0);
}

/// Probability, 0..1, that a stroke is deleted where the density is above `most`.
fn deletion_probability(density: f32, most: f32) -> f32 {
    return select(0.0, 1.0 - most / max(density, 1e-12), density > most);
}

// ---- airlight::painterly::stroke_placement ----
// summary: Which layer a pixel is in by its gradient magnitude, and whether chance puts a stroke there.
// source: Ramalhao (2010), 3.5.2, 3.5.3, 4.2.1, appendix A; hash: Jarzynski and Olano (2020), PCG3D.

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

/// Which pixel's stroke is born first in a frame, 0 .. pixels - 1: those that come last are dropped where the buffer is full,
/// which shall not always be the same part of the picture.
fn first_in_queue(pixels: u32, frame: u32, seed: u32) -> u32 {
    return hash_of_three(vec3<u32>(frame, seed ^ QUEUEING, pixels)).x % max(pixels, 1u);
}

/// Place in the queue of a pixel, both 0 .. pixels - 1. `first`: the pixel at its head.
fn place_in_queue(pixel: u32, first: u32, pixels: u32) -> u32 {
    return select(pixel + pixels - first, pixel - first, pixel >= first);
}

// ---- airlight::painterly::stroke_targets ----
// summary: What the ray caster wrote, for passes that put strokes on surfaces: a callback that an engine may replace.
// source: Ramalhao (2010), 4.1, 4.2.1: the off-screen textures that strokes look up.

@group(0) @binding(1) var surface: texture_2d<f32>;
@group(0) @binding(2) var distances: texture_2d<f32>;

/// Columns and rows of the sources.
fn source_size() -> vec2<u32> {
    return textureDimensions(distances);
}

/// Gradient magnitude at a pixel of the sources; negative where there is no surface.
fn magnitude_at(pixel: vec2<u32>) -> f32 {
    let at = textureLoad(surface, pixel, 0);
    let far = textureLoad(distances, pixel, 0).x;
    let finite = is_finite(far) && is_finite(at.x) && is_finite(at.y) && is_finite(at.z) && is_finite(at.w);
    let normal = select(vec3<f32>(0.0), at.xyz, finite);
    let there = finite && far >= 0.0 && at.w >= 0.0 && dot(normal, normal) > 0.25;
    return select(-1.0, at.w, there);
}

// ---- painterly/stroke_population ----

@group(0) @binding(4) var<uniform> frame: StrokeFrame;
@group(0) @binding(5) var<uniform> style: StrokeStyle;
@group(0) @binding(6) var density: texture_2d<f32>;
@group(0) @binding(7) var<storage, read_write> strokes: array<Stroke>;
@group(0) @binding(8) var<storage, read> counts: StrokeCounts;
@group(0) @binding(9) var<storage, read_write> marks: array<u32>;
@group(0) @binding(10) var<storage, read_write> birth_bits: array<u32>;

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
