// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::painterly::stroke
// summary: A brush stroke, its states, what a frame knows of all strokes, and the style of the three layers of strokes.
// source: Ramalhao, "Painterly stylization of real-time volume rendering" (2010), 4.2.1, 4.2.2, Table 5.1.
// note: Sizes in Table 5.1 have no unit: here they are pixels of the picture that is drawn, whatever the size of the sources.
// note: A stroke keeps the point of the volume that it was put on, not a pixel: flow read at its old pixel would err and add up.
// equation: chunks = ⌈strokes / 32⌉, blocks = ⌈size / (8, 4)⌉
// error: exact; test painterly/strokes::coarse_strokes_come_first_and_old_ones_before_new_ones.
// parameter three: numbers of the coarse, medium and fine layer.
// parameter layer: 0..2.
// parameter strokes: how many, from 0.
// parameter size: columns and rows, pixels.
// parameter state: STROKE_GONE to STROKE_HIDDEN.

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
/// Fades out at the rate of what is occluded, or has left the picture.
const STROKE_HIDDEN: u32 = 3u;

/// Strokes run at right angles to the gradient in the picture.
const ALONG_SURFACE: u32 = 0u;
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

/// Opacity that a stroke fades to, 0..1.
fn target_opacity(style: StrokeStyle, layer: u32, state: u32) -> f32 {
    return select(0.0, of_layer(style.opacity, layer), state == STROKE_STAYS);
}
