// SPDX-License-Identifier: MIT OR Apache-2.0
//! The eye in a shadow map.

use super::StylizeError;
use crate::core::{Camera, Light, POINT};
use encase::ShaderType;
use glam::{DMat4, DVec4, Vec2};

/// The uniform `Epipole` of `stylize/epipolar_dilate`: the eye in a shadow map, a homogeneous point.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct Epipole {
    /// Position, texels, times the weight.
    pub position: Vec2,
    /// Depth in the map's own convention, times the weight.
    pub depth: f32,
    /// 1 for an eye in front of the light, 0 at infinity, below 0 behind the light.
    pub weight: f32,
}

/// Farther away, in texels, the weight is given up for the position's sake: both have to be floats.
const FARTHEST: f64 = 1e6;

impl Epipole {
    /// Where the eye of a camera is in the shadow map of `size` texels of a directional or a spot light. The eye of an
    /// orthographic camera is at infinity, against its view direction.
    ///
    /// # Errors
    /// [`StylizeError`] for a point light, and where anything is not finite.
    pub fn new(light: &Light, camera: &Camera, size: [u32; 2]) -> Result<Self, StylizeError> {
        if light.kind == POINT {
            return Err(StylizeError::PointLight);
        }
        Self::in_map(light.clip_from_world.as_dmat4(), Self::eye(camera), size)
    }

    /// The eye of a camera as a homogeneous point of the world: where view rays meet.
    pub fn eye(camera: &Camera) -> DVec4 {
        if camera.projection == 0 {
            return camera.eye.as_dvec3().extend(1.0);
        }
        let from_clip = camera.world_from_clip.as_dmat4();
        let forward = f64::from(camera.far_depth - camera.near_depth) * from_clip.z_axis;
        -forward.truncate().normalize_or_zero().extend(0.0)
    }

    /// Where a homogeneous point of the world (weight 0: a direction TOWARDS the eye) is in the shadow map of `size` texels
    /// with this matrix.
    ///
    /// # Errors
    /// [`StylizeError::Epipole`] where anything is not finite, or all is zero.
    pub fn in_map(clip_from_world: DMat4, eye: DVec4, size: [u32; 2]) -> Result<Self, StylizeError> {
        let clip = clip_from_world * eye;
        let [width, height] = size.map(f64::from);
        let x = 0.5 * (clip.x + clip.w) * width;
        let y = 0.5 * (clip.w - clip.y) * height;
        let greatest = x.abs().max(y.abs());
        let scale = clip.w.abs().max(greatest / FARTHEST);
        let scale = if scale > 0.0 { scale } else { clip.z.abs() };
        if !(scale.is_finite() && scale > 0.0 && clip.z.is_finite()) {
            return Err(StylizeError::Epipole(clip));
        }
        // At infinity lengths have no meaning: one texel along the longer axis.
        let scale = if clip.w.abs() < scale { greatest } else { scale };
        let scale = if scale > 0.0 { scale } else { clip.z.abs() };
        Ok(Self {
            position: Vec2::new((x / scale) as f32, (y / scale) as f32),
            depth: (clip.z / scale) as f32,
            weight: (clip.w / scale) as f32,
        })
    }
}
