// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: painterly/draw_strokes, permutation default
// summary: Draws strokes with brush textures, coarse layers first.
// source: Ramalhao (2010), 4.2.6.
// note: Drawn indirectly with `counts` as arguments over a background, blended as source + (1 - source alpha) * destination.
// note: Within a layer older strokes come first. The picture may be larger than what the ray caster wrote (4.1.7).
// binding frame: the frame.
// binding style: the style.
// binding strokes: the strokes.
// binding order: numbers of strokes, in the order that they are drawn in.
// binding brushes: brushes, premultiplied linear RGB that the stroke's colour tints, and opacity; what is not finite counts as 0.
// binding brush_sampler: linear, with mipmaps.

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

// ---- airlight::painterly::stroke ----
// summary: A brush stroke, its states, what a frame knows of all strokes, and the style of the three layers of strokes.
// source: Ramalhao, "Painterly stylization of real-time volume rendering" (2010), 4.2.1, 4.2.2, Table 5.1.

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

/// The number of a layer, 0..2, out of three.
fn of_layer(three: vec3<f32>, layer: u32) -> f32 {
    return select(select(three.z, three.y, layer == 1u), three.x, layer == 0u);
}

// ---- airlight::painterly::stroke_placement ----
// summary: Which layer a pixel is in by its gradient magnitude, and whether chance puts a stroke there.
// source: Ramalhao (2010), 3.5.2, 3.5.3, 4.2.1, appendix A; hash: Jarzynski and Olano (2020), PCG3D.

/// A number drawn for a stroke once for all, -1..1. `hash`: the stroke's own. `purpose`: what it is for.
fn own_variation(hash: u32, purpose: u32) -> f32 {
    return 2.0 * unit_from_hash(hash_of_three(vec3<u32>(hash, purpose, 0u)).x) - 1.0;
}

// ---- airlight::painterly::stroke_expand ----
// summary: A stroke as a quad of the picture: corners, texture coordinates, brush and tint.
// source: Ramalhao (2010), 4.2.6.

/// Which number of a stroke's own varies its tint.
const TINT: u32 = 1u;

/// Corner 0..3 of vertex 0..5, two triangles: bit 0 is the far end of the length, bit 1 of the width.
fn quad_corner(vertex: u32) -> u32 {
    return select(vertex, select(5u - vertex, 3u, vertex > 4u), vertex > 2u);
}

/// Where a corner lies, pixels of a picture of `picture_size`.
fn corner_position(stroke: Stroke, corner: u32, picture_size: vec2<f32>) -> vec2<f32> {
    let side = vec2<f32>(f32(corner & 1u), f32(corner >> 1u)) - 0.5;
    let along = vec2<f32>(cos(stroke.orientation), sin(stroke.orientation));
    let across = vec2<f32>(-along.y, along.x);
    let offset = stroke.size * (side.x * along + stroke.aspect * side.y * across);
    return stroke.position * picture_size + offset;
}

/// Clip position of a place in a picture, pixels.
fn clip_from_picture(place: vec2<f32>, picture_size: vec2<f32>) -> vec4<f32> {
    return vec4<f32>(place / picture_size * vec2<f32>(2.0, -2.0) + vec2<f32>(-1.0, 1.0), 0.5, 1.0);
}

/// Texture coordinates of a corner, 0..1; two bits of the hash mirror the brush.
fn brush_coordinates(corner: u32, hash: u32) -> vec2<f32> {
    let mirrored = corner ^ (hash >> 30u);
    return vec2<f32>(f32(mirrored & 1u), f32((mirrored >> 1u) & 1u));
}

/// Layer of the brush texture. `given`: that of the style; negative for any of `count`.
fn brush_layer(given: f32, hash: u32, count: u32) -> u32 {
    let chosen = select(u32(max(given, 0.0)), (hash & 0xffffu) % max(count, 1u), given < 0.0);
    return min(chosen, max(count, 1u) - 1u);
}

/// Factor on the colour of a stroke. `variation`: 0..1.
fn tint_factor(hash: u32, variation: f32) -> f32 {
    return 1.0 + variation * own_variation(hash, TINT);
}

// ---- painterly/draw_strokes ----

@group(0) @binding(0) var<uniform> frame: StrokeFrame;
@group(0) @binding(1) var<uniform> style: StrokeStyle;
@group(0) @binding(2) var<storage, read> strokes: array<Stroke>;
@group(0) @binding(3) var<storage, read> order: array<u32>;
@group(0) @binding(4) var brushes: texture_2d_array<f32>;
@group(0) @binding(5) var brush_sampler: sampler;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) coordinates: vec2<f32>,
    @location(1) @interpolate(flat) brush: u32,
    @location(2) @interpolate(flat) tint: vec4<f32>,
}

@vertex
fn vertex_stroke(@builtin(vertex_index) vertex: u32) -> Corner {
    let number = order[min(vertex / 6u, arrayLength(&order) - 1u)];
    let stroke = strokes[min(number, arrayLength(&strokes) - 1u)];
    let corner = quad_corner(vertex % 6u);
    let place = corner_position(stroke, corner, frame.picture_size);
    let color = stroke.color * tint_factor(stroke.hash, style.color_variation);
    return Corner(
        clip_from_picture(place, frame.picture_size),
        brush_coordinates(corner, stroke.hash),
        brush_layer(of_layer(style.brush, stroke.layer), stroke.hash, textureNumLayers(brushes)),
        vec4<f32>(min(color, vec3<f32>(65504.0)), 1.0) * stroke.opacity
    );
}

@fragment
fn fragment_stroke(corner: Corner) -> @location(0) vec4<f32> {
    let brush = textureSample(brushes, brush_sampler, corner.coordinates, corner.brush);
    return corner.tint * vec4<f32>(finite_or_rgb(brush.rgb, 0.0), finite_or(brush.a, 0.0));
}
