// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: painterly/stroke_compact, permutation default
// summary: Strokes that are kept, in their order, then those that are born, closely packed into another buffer.
// source: Ramalhao (2010), 4.2.2, 4.2.4: what the geometry shaders' output streams did, here by prefix sums.
// note: The same input gives the same strokes, bit for bit. What does not fit is dropped: new strokes only, and counted.
// note: Dispatch list_survivors over chunks of 32 strokes of the capacity, list_births over blocks of 8 by 4 pixels,
// note: count_strokes once, gather_strokes over the capacity.
// binding color: premultiplied linear RGB, alpha 1 where there is a surface; rgba16float.
// binding surface: unit normal in the world, 0 where there is no surface, and gradient magnitude; rgba16float.
// binding distances: metres along the view ray, negative where there is no surface; r32float.
// binding camera: the camera of this frame; its viewport is not used.
// binding frame: the frame.
// binding style: the style.
// binding strokes: the strokes of before.
// binding marks: exclusive prefix sums of the marks of `stroke_population`.
// binding sources: out, of each new place, number of the stroke, or capacity + number of the pixel that gives birth.
// binding kept: out, the strokes.
// binding counts: out, how many there are.
// binding birth_bits: of each block the pixels that give birth, a bit each.

// ---- airlight::core::camera ----
// summary: View rays, distances and frustum planes from a camera's matrices, for any depth convention.
// source: homogeneous unprojection; planes after Gribb and Hartmann, "Fast extraction of viewing frustum planes" (2001).

/// Orthographic projection: view rays are parallel and leave the near plane.
const ORTHOGRAPHIC: u32 = 1u;

/// A camera, as an engine hands it over. 160 bytes.
struct Camera {
    /// View-projection matrix, world to clip.
    clip_from_world: mat4x4<f32>,
    /// Its inverse, clip to world.
    world_from_clip: mat4x4<f32>,
    /// Position of the eye in the world, metres; unused by an orthographic camera.
    eye: vec3<f32>,
    /// Clip depth of the near plane: 0 forward, 1 reversed.
    near_depth: f32,
    /// Width and height of the picture in pixels.
    viewport: vec2<f32>,
    /// Clip depth of the far plane: 1 forward, 0 reversed.
    far_depth: f32,
    /// PERSPECTIVE or ORTHOGRAPHIC.
    projection: u32,
}

/// A view ray: world-space origin in metres, unit direction.
struct Ray {
    /// Where it starts in the world, metres.
    origin: vec3<f32>,
    /// Unit vector, away from the eye.
    direction: vec3<f32>,
}

/// The view ray through `ndc`, of any camera.
fn view_ray(camera: Camera, ndc: vec2<f32>) -> Ray {
    // Values, not branches: some drivers compile a shader anew for every value of a uniform that a branch depends on.
    let parallel = camera.projection == ORTHOGRAPHIC;
    let far = camera.world_from_clip * vec4<f32>(ndc, camera.far_depth, 1.0);
    let near = camera.world_from_clip * vec4<f32>(ndc, camera.near_depth, 1.0);
    let origin = select(camera.eye, near.xyz / select(1.0, near.w, parallel), parallel);
    // With w = 0 (infinite far plane) far.xyz is the direction itself.
    return Ray(origin, normalize(far.xyz - select(camera.eye * far.w, near.xyz, parallel)));
}

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

/// `x` where it is finite, `fallback` elsewhere.
fn finite_or(x: f32, fallback: f32) -> f32 {
    return select(fallback, x, is_finite(x));
}

/// Like `finite_or`, each component by itself.
fn finite_or_rgb(x: vec3<f32>, fallback: f32) -> vec3<f32> {
    return vec3<f32>(finite_or(x.x, fallback), finite_or(x.y, fallback), finite_or(x.z, fallback));
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

// ---- airlight::painterly::iso_surface ----
// summary: Iso-surface of classified opacity in a volume: crossing, gradient, Phong lighting, flow and occlusion of a surface point.
// source: dissertation on painterly volume rendering, 4.1.1 to 4.1.6, Eq. 4.1 and 4.2.

/// Direction in a picture of `size` pixels, x right, y down, of any length, of a `direction` of the world at a point before the camera.
fn direction_in_picture(camera: Camera, point: vec3<f32>, direction: vec3<f32>, size: vec2<f32>) -> vec2<f32> {
    let clip = camera.clip_from_world * vec4<f32>(point, 1.0);
    let change = camera.clip_from_world * vec4<f32>(direction, 0.0);
    // The derivative of xy / w, times w squared.
    return (change.xy * clip.w - clip.xy * change.w) * size * vec2<f32>(1.0, -1.0);
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

/// Strokes have one angle.
const FIXED_ANGLE: u32 = 1u;
/// Strokes run along the direction of greatest curvature, and where there is none as with ALONG_SURFACE.
const ALONG_CURVATURE: u32 = 2u;

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

// ---- airlight::painterly::stroke_placement ----
// summary: Which layer a pixel is in by its gradient magnitude, and whether chance puts a stroke there.
// source: Ramalhao (2010), 3.5.2, 3.5.3, 4.2.1, appendix A; hash: Jarzynski and Olano (2020), PCG3D.

/// Seeds of what is drawn for different purposes.
const PLACING: u32 = 0x9e3779b9u;
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

// ---- airlight::painterly::stroke_expand ----
// summary: A stroke as a quad of the picture: corners, texture coordinates, brush and tint.
// source: Ramalhao (2010), 4.2.6.

/// The same for its length.
const LENGTH: u32 = 2u;

/// Length of a stroke, pixels. `size`: of its layer. `variation`: 0..1.
fn varied_size(size: f32, hash: u32, variation: f32) -> f32 {
    return size * (1.0 + variation * own_variation(hash, LENGTH));
}

// ---- airlight::painterly::stroke_update ----
// summary: A stroke follows its point of the surface and takes part of the new colour, orientation, size and opacity.
// source: Ramalhao (2010), 4.1.6, 4.2.1, 4.2.3.

/// Strokes fainter than this are not seen: a new one begins with it, and one that fades out ends below it.
const LEAST_OPACITY: f32 = 0.00392156862745098;
/// Where the normal is within this sine of the view ray, its direction in the picture means nothing.
const LEAST_SINE: f32 = 0.02;
const PI: f32 = 3.141592653589793;

/// What the ray caster says of a pixel.
struct SurfaceTexel {
    /// Scene-linear RGB.
    color: vec3<f32>,
    /// Metres along the view ray; negative where there is no surface.
    distance: f32,
    /// Unit normal in the world.
    normal: vec3<f32>,
    /// Gradient magnitude; negative where there is no surface.
    magnitude: f32,
    /// (cos 2a, sin 2a) of the picture's direction of greatest curvature, x right, y down; 0 where there is none.
    curvature: vec2<f32>,
}

/// `angle`, radians, modulo pi in -pi/2 .. pi/2, the upper end excluded.
fn wrapped_orientation(angle: f32) -> f32 {
    return angle - PI * floor(angle / PI + 0.5);
}

/// Orientation that a stroke on a surface has by its style, radians, -pi/2 .. pi/2; `otherwise` where the surface has none.
/// `ray`: view ray to the point.
fn surface_orientation(
    camera: Camera, world: vec3<f32>, ray: Ray, surface: SurfaceTexel, style: StrokeStyle, picture_size: vec2<f32>,
    otherwise: f32
) -> f32 {
    let gradient = direction_in_picture(camera, world, surface.normal, picture_size);
    let cosine = dot(surface.normal, ray.direction);
    let oblique = 1.0 - cosine * cosine > LEAST_SINE * LEAST_SINE && any(gradient != vec2<f32>(0.0));
    let across = atan2(gradient.x, select(1.0, -gradient.y, oblique));
    let along = select(otherwise - style.angle, across, oblique);
    let curved = any(surface.curvature != vec2<f32>(0.0)) && style.orientation == ALONG_CURVATURE;
    let twice = select(vec2<f32>(1.0, 0.0), surface.curvature, curved);
    let chosen = select(along, 0.5 * atan2(twice.y, twice.x), curved);
    return wrapped_orientation(select(chosen, 0.0, style.orientation == FIXED_ANGLE) + style.angle);
}

// ---- airlight::painterly::stroke_targets ----
// summary: What the ray caster wrote, for passes that put strokes on surfaces: a callback that an engine may replace.
// source: Ramalhao (2010), 4.1, 4.2.1: the off-screen textures that strokes look up.

@group(0) @binding(0) var color: texture_2d<f32>;
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

/// All that there is to know of a pixel of the sources.
fn surface_texel(pixel: vec2<u32>) -> SurfaceTexel {
    let magnitude = magnitude_at(pixel);
    let there = magnitude >= 0.0;
    let tint = clamp(finite_or_rgb(textureLoad(color, pixel, 0).rgb, 0.0), vec3<f32>(0.0), vec3<f32>(65504.0));
    let normal = textureLoad(surface, pixel, 0).xyz;
    let length_squared = select(1.0, dot(normal, normal), there);
    var direction = vec2<f32>(0.0);
    return SurfaceTexel(
        tint,
        select(-1.0, textureLoad(distances, pixel, 0).x, there),
        select(vec3<f32>(0.0), normal * inverseSqrt(length_squared), there),
        magnitude,
        direction
    );
}

// ---- painterly/stroke_compact ----

@group(0) @binding(4) var<uniform> camera: Camera;
@group(0) @binding(5) var<uniform> frame: StrokeFrame;
@group(0) @binding(6) var<uniform> style: StrokeStyle;
@group(0) @binding(7) var<storage, read> strokes: array<Stroke>;
@group(0) @binding(8) var<storage, read> marks: array<u32>;
@group(0) @binding(9) var<storage, read_write> sources: array<u32>;
@group(0) @binding(10) var<storage, read_write> kept: array<Stroke>;
@group(0) @binding(11) var<storage, read_write> counts: StrokeCounts;
@group(0) @binding(12) var<storage, read> birth_bits: array<u32>;

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
