// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a projector does, and what it is given.

use crate::resource::{Buffer, Texture};
use wgpu::TextureFormat::{self, R32Float, Rgba32Float};

/// What is solved for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solved {
    /// Emission: radiance of a medium so thick that nothing shines through.
    Emission,
    /// Albedo, 0..1.
    Albedo,
    /// Emission and albedo.
    Both,
    /// Extinction, 1/m, from optical depths.
    Extinction,
}

/// How many channels pictures and volumes have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channels {
    /// One.
    One,
    /// Linear RGB, each by itself; texels have a fourth that is not used.
    Rgb,
}

impl Channels {
    /// Numbers a voxel or a pixel in textures and buffers.
    pub fn numbers(self) -> usize {
        match self {
            Self::One => 1,
            Self::Rgb => 4,
        }
    }

    /// Numbers of them that mean something.
    pub(in super::super) fn used(self) -> usize {
        match self {
            Self::One => 1,
            Self::Rgb => 3,
        }
    }

    /// Of textures.
    pub(in super::super) fn format(self) -> TextureFormat {
        match self {
            Self::One => R32Float,
            Self::Rgb => Rgba32Float,
        }
    }
}

/// Basis functions of what is solved for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// Straight between the middles of voxels.
    Triangle,
    /// Constant in each voxel.
    Box,
}

/// How a picture is projected back. All three have the same weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Transpose {
    /// Each voxel collects from the pixels that see it: the same bits in every run. Of bent rays no voxel knows which meet it: they
    /// take [`Transpose::FixedPoint`] instead.
    #[default]
    Collect,
    /// Each ray scatters, and sums are whole numbers of 64 bits: the same bits in every run. Needs 8 bytes a voxel and channel. The medium's
    /// extinction must not be negative, else sums may overflow.
    FixedPoint,
    /// Each ray scatters, and sums are floats, added in an order that no one knows: results differ a little from run to run. Needs 4 bytes a
    /// voxel and channel.
    Swap,
}

/// What a projector does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProjectorForm {
    /// What is solved for.
    pub solved: Solved,
    /// Of pictures and volumes.
    pub channels: Channels,
    /// Of what is solved for.
    pub basis: Basis,
    /// How pictures are projected back.
    pub transpose: Transpose,
    /// Length of a step of rays that the medium's index of refraction bends, metres, above 0; none where rays are straight.
    pub refraction: Option<f32>,
}

impl ProjectorForm {
    /// Straight rays, functions that are straight between the middles of voxels, and voxels that collect.
    pub fn new(solved: Solved, channels: Channels) -> Self {
        Self { solved, channels, basis: Basis::Triangle, transpose: Transpose::Collect, refraction: None }
    }

    /// Whether emission and whether albedo is solved for.
    pub(super) fn radiance(&self) -> [bool; 2] {
        [Solved::Emission, Solved::Albedo].map(|own| self.solved == own || self.solved == Solved::Both)
    }
}

/// What is known of the medium, as one view sees it.
pub struct Medium {
    /// 1/m; 3D, of the projector's channels.
    pub extinction: Texture,
    /// Radiance that an albedo of 1 scatters towards the eye, likewise; black where light does not matter.
    pub scattered: Texture,
    /// Index of refraction, 3D, r32float, from 0.01 to 100; what bent rays need and no others. Between voxels it is straight. Light is not
    /// refracted by the faces of the box, only by slopes of the index within it.
    pub index: Option<Texture>,
}

/// Volumes that are rendered; those that are not solved for may be any.
#[derive(Clone, Copy)]
pub struct Fields<'a> {
    /// Radiance.
    pub emission: &'a Texture,
    /// 0..1.
    pub albedo: &'a Texture,
    /// 1/m.
    pub extinction: &'a Texture,
}

/// What is collected from pictures, of one volume that is solved for.
#[derive(Clone, Copy)]
pub struct Collected<'a> {
    /// Voxels along x, y and z.
    pub grid: [u32; 3],
    /// A number a voxel, 0 where it is not solved for, x fastest.
    pub wanted: &'a Buffer,
    /// Numbers of the projector's channels a voxel, to which is added.
    pub sums: &'a Buffer,
}
