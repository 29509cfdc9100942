// SPDX-License-Identifier: MIT OR Apache-2.0
//! What host and shaders share of strokes: the structs of `painterly/stroke`.

use encase::ShaderType;
use glam::{Mat4, UVec4, Vec2, Vec3};

/// Words of a stroke in its buffer.
pub(super) const STROKE_WORDS: usize = 16;

/// The uniform `StrokeFrame`: what a frame knows of all strokes.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct StrokeFrame {
    /// Unit space of the volume to the world, metres.
    pub world_from_unit: Mat4,
    /// Its inverse.
    pub unit_from_world: Mat4,
    /// Width and height of the picture that strokes are drawn into, pixels.
    pub picture_size: Vec2,
    /// Time since the frame before, seconds.
    pub seconds: f32,
    /// Number of the frame.
    pub frame: u32,
    /// Of a stroke of each layer, times the mean opacity of its brush: pixels of the sources.
    pub areas: Vec3,
    /// Other seeds give other strokes.
    pub seed: u32,
    /// Strokes that fit into the buffers.
    pub capacity: u32,
    /// Factor on the probability of birth, 0..1.
    pub generation: f32,
    /// Factor on the probability of deletion, 0..1.
    pub deletion: f32,
    /// Padding.
    pub reserved: f32,
}

/// The uniform `StrokeStyle`; three numbers are those of the coarse, medium and fine layer.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct StrokeStyle {
    /// Where each layer ends, gradient magnitude.
    pub thresholds: Vec3,
    /// Share of the thresholds by which a stroke may be beyond them.
    pub hysteresis: f32,
    /// Probability, 0..1, that a pixel of the sources gets a stroke in a frame.
    pub probability: Vec3,
    /// Factor on gradient magnitudes.
    pub gradient_scale: f32,
    /// Length, pixels of the picture.
    pub size: Vec3,
    /// Share of the length, 0..1.
    pub size_variation: f32,
    /// Width over length.
    pub aspect: Vec3,
    /// Share of the colour, 0..1.
    pub color_variation: f32,
    /// Opacity, 0..1.
    pub opacity: Vec3,
    /// Density that one opaque stroke adds.
    pub density_unit: f32,
    /// Below it strokes are born.
    pub density_min: Vec3,
    /// Share of the opacity that strokes fade to in what density counts, 0..1.
    pub anticipation: f32,
    /// Above it strokes are deleted.
    pub density_max: Vec3,
    /// Pixels' slope.
    pub occlusion_tolerance: f32,
    /// Brush of each layer; negative for any.
    pub brush: Vec3,
    /// 0 along the surface, 1 fixed, 2 along curvature.
    pub orientation: u32,
    /// Radians.
    pub angle: f32,
    /// Share in a sixtieth of a second, 0..1.
    pub color_rate: f32,
    /// Share in a sixtieth of a second, 0..1.
    pub orientation_rate: f32,
    /// Share in a sixtieth of a second, 0..1.
    pub size_rate: f32,
    /// Share in a sixtieth of a second, 0..1.
    pub opacity_rate: f32,
    /// Share in a sixtieth of a second, 0..1.
    pub fade_out_rate: f32,
    /// Share in a sixtieth of a second, 0..1.
    pub hidden_rate: f32,
    /// Padding.
    pub reserved: f32,
}

/// The counts that stay on the GPU; the first four are the arguments of an indirect draw.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ShaderType)]
pub struct StrokeCounts {
    /// Vertices of all strokes, 6 each.
    pub vertices: u32,
    /// 1.
    pub draws: u32,
    /// 0.
    pub first_vertex: u32,
    /// 0.
    pub first_instance: u32,
    /// Born in the last frame.
    pub born: u32,
    /// Dropped in the last frame, before they were born, because the buffer was full.
    pub dropped: u32,
    /// Dropped in all frames.
    pub dropped_in_all: u32,
    /// Strokes in the buffer.
    pub instances: u32,
    /// Strokes of the coarse layer.
    pub coarse: u32,
    /// Strokes of the medium layer.
    pub medium: u32,
    /// Strokes of the fine layer.
    pub fine: u32,
    /// Frames that were counted.
    pub frames: u32,
    /// Arguments of the indirect draw of densities: vertices of all strokes, 3 each; 1; 0; 0.
    pub density_draw: UVec4,
}

impl StrokeCounts {
    pub(super) fn from_words(words: &[u32]) -> Self {
        let word = |index: usize| words.get(index).copied().unwrap_or(0);
        Self {
            vertices: word(0),
            draws: word(1),
            first_vertex: word(2),
            first_instance: word(3),
            born: word(4),
            dropped: word(5),
            dropped_in_all: word(6),
            instances: word(7),
            coarse: word(8),
            medium: word(9),
            fine: word(10),
            frames: word(11),
            density_draw: UVec4::from([12, 13, 14, 15].map(word)),
        }
    }

    /// Strokes of the coarse, medium and fine layer.
    pub fn layers(&self) -> [u32; 3] {
        [self.coarse, self.medium, self.fine]
    }
}

/// What becomes of a stroke.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StrokeState {
    /// Has faded out.
    Gone,
    /// Fades in, or has done so.
    Stays,
    /// Fades out.
    Leaves,
    /// Fades out, occluded or out of the picture.
    Hidden,
}

/// A stroke as it was read back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// In the unit space of the volume.
    pub point: Vec3,
    /// Drawn at its birth.
    pub hash: u32,
    /// Linear RGB.
    pub color: Vec3,
    /// 0..1.
    pub opacity: f32,
    /// In the picture, (0, 0) top left, (1, 1) bottom right.
    pub position: Vec2,
    /// Length, pixels of the picture.
    pub size: f32,
    /// Width over length.
    pub aspect: f32,
    /// Radians from +x towards +y (downwards).
    pub orientation: f32,
    /// 0 coarse, 1 medium, 2 fine.
    pub layer: u32,
    /// What becomes of it.
    pub state: StrokeState,
}

impl Stroke {
    /// From the words of a buffer.
    pub(super) fn from_words(words: &[u32]) -> Self {
        let number = |index: usize| f32::from_bits(words[index]);
        Self {
            point: Vec3::new(number(0), number(1), number(2)),
            hash: words[3],
            color: Vec3::new(number(4), number(5), number(6)),
            opacity: number(7),
            position: Vec2::new(number(8), number(9)),
            size: number(10),
            aspect: number(11),
            orientation: number(12),
            layer: words[13],
            state: match words[14] {
                1 => StrokeState::Stays,
                2 => StrokeState::Leaves,
                3 => StrokeState::Hidden,
                _ => StrokeState::Gone,
            },
        }
    }
}
