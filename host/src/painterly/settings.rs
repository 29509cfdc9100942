// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which surface is seen, from where, and in which light.

use super::{IsoVolume, PainterlyError};
use crate::core::{Camera, VolumeSpace};
use crate::out_of_range::in_range;
use encase::ShaderType;
use glam::{Mat4, Vec3, Vec4};

/// Clip planes that a surface is cut by at most.
pub const MOST_CLIP_PLANES: usize = 8;

/// The uniform `IsoSurface` of `painterly/iso_surface`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct IsoSurface {
    /// The volume's box 0..1 to the world in the previous frame.
    pub previous_world_from_unit: Mat4,
    /// Normals and offsets.
    pub clip_planes: [Vec4; MOST_CLIP_PLANES],
    /// Opacity from which on the volume is solid.
    pub iso_value: f32,
    /// Added to scaled texels.
    pub value_offset: f32,
    /// Shortest side of a voxel, metres.
    pub voxel: f32,
    /// View rays end here, metres.
    pub distance_limit: f32,
    /// Clip planes that count.
    pub clip_count: u32,
    /// Halvings of the step that meets the surface.
    pub refinements: u32,
    /// Number of the frame.
    pub frame: u32,
    /// Padding.
    pub reserved: u32,
}

/// The uniform `SurfaceLighting` of `painterly/iso_surface`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SurfaceLighting {
    /// Unit vector TOWARDS the light.
    pub direction: Vec3,
    /// Share of diffuse reflection.
    pub diffuse: f32,
    /// Irradiance of the light over pi, linear RGB.
    pub radiance: Vec3,
    /// Share of mirror-like reflection.
    pub specular: f32,
    /// Radiance from all around, linear RGB.
    pub ambient: Vec3,
    /// Exponent of mirror-like reflection.
    pub shininess: f32,
}

impl SurfaceLighting {
    /// A white light of radiance 1 from a direction, of any length, with a dull gloss.
    ///
    /// # Errors
    /// [`PainterlyError::Setting`] for a direction that is none.
    pub fn towards(direction: Vec3) -> Result<Self, PainterlyError> {
        let lighting = Self {
            direction: direction.try_normalize().unwrap_or(Vec3::ZERO),
            diffuse: 0.7,
            radiance: Vec3::ONE,
            specular: 0.25,
            ambient: Vec3::splat(0.25),
            shininess: 24.0,
        };
        lighting.check()?;
        Ok(lighting)
    }

    /// Checks all numbers.
    ///
    /// # Errors
    /// [`PainterlyError::Setting`].
    pub fn check(&self) -> Result<(), PainterlyError> {
        let length = self.direction.length();
        in_range("length of the light's direction", length, 0.999..=1.001, "1")?;
        let most = 1e4;
        for (name, value) in [
            ("diffuse share", self.diffuse),
            ("specular share", self.specular),
            ("radiance of the light", self.radiance.max_element()),
            ("radiance of the light", self.radiance.min_element()),
            ("ambient radiance", self.ambient.max_element()),
            ("ambient radiance", self.ambient.min_element()),
        ] {
            in_range(name, value, 0.0..=most, "from 0 to 10000")?;
        }
        Ok(in_range("shininess", self.shininess, 1.0..=most, "from 1 to 10000")?)
    }
}

/// Which surface is seen, and how carefully it is looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct IsoSettings {
    /// Opacity from which on the volume is solid, above 0, at most 1.
    pub iso_value: f32,
    /// Steps a voxel's shortest side, 0.25 to 16.
    pub steps_per_voxel: f32,
    /// Halvings of the step that meets the surface, before a secant; at most 32.
    pub refinements: u32,
    /// View rays end here, metres.
    pub distance_limit: f32,
    /// Planes in the world: what lies where `xyz · point + w < 0` is cut away.
    pub clip_planes: Vec<Vec4>,
}

impl Default for IsoSettings {
    fn default() -> Self {
        Self {
            iso_value: 0.5,
            steps_per_voxel: 2.0,
            refinements: 3,
            distance_limit: 1e4,
            clip_planes: Vec::new(),
        }
    }
}

impl IsoSettings {
    /// Checks all numbers.
    ///
    /// # Errors
    /// [`PainterlyError`].
    pub fn check(&self) -> Result<(), PainterlyError> {
        let (name, range) = ("iso-value", "above 0, at most 1");
        in_range(name, self.iso_value, f32::MIN_POSITIVE..=1.0, range)?;
        in_range("steps per voxel", self.steps_per_voxel, 0.25..=16.0, "from 0.25 to 16")?;
        in_range("refinements", self.refinements as f32, 0.0..=32.0, "from 0 to 32")?;
        let (name, range) = ("distance limit", "positive and at most 1e7 metres");
        in_range(name, self.distance_limit, f32::MIN_POSITIVE..=1e7, range)?;
        if self.clip_planes.len() > MOST_CLIP_PLANES {
            return Err(PainterlyError::ClipPlanes(self.clip_planes.len()));
        }
        for plane in &self.clip_planes {
            let (name, range) = ("length of a clip plane's normal", "positive and finite");
            in_range(name, plane.truncate().length(), 1e-12..=1e12, range)?;
            in_range("offset of a clip plane", plane.w, -1e12..=1e12, "finite")?;
        }
        Ok(())
    }
}

/// Where camera and volume are in a frame and were in the one before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IsoFrame {
    /// The camera, for pictures of the targets' size.
    pub camera: Camera,
    /// That of the previous frame.
    pub previous_camera: Camera,
    /// The volume's box 0..1 to the world, metres; affine.
    pub world_from_unit: Mat4,
    /// That of the previous frame.
    pub previous_world_from_unit: Mat4,
    /// Number of the frame, for jittered starts.
    pub number: u32,
}

impl IsoFrame {
    /// Where nothing has moved.
    pub fn still(camera: Camera, world_from_unit: Mat4) -> Self {
        Self {
            camera,
            previous_camera: camera,
            world_from_unit,
            previous_world_from_unit: world_from_unit,
            number: 0,
        }
    }

    /// The uniforms of the volume's place and of its surface.
    pub(super) fn uniforms(
        &self,
        volume: &IsoVolume,
        settings: &IsoSettings,
    ) -> Result<(VolumeSpace, IsoSurface), PainterlyError> {
        settings.check()?;
        let unit_from_world = self.world_from_unit.as_dmat4().inverse().as_mat4();
        if !(self.world_from_unit.is_finite() && unit_from_world.is_finite()) {
            return Err(PainterlyError::Space);
        }
        let voxel = volume.voxel(self.world_from_unit);
        let space = VolumeSpace {
            unit_from_world,
            world_from_unit: self.world_from_unit,
            value_scale: volume.scale,
            step_length: voxel / settings.steps_per_voxel,
            reserved_a: 0.0,
            reserved_b: 0.0,
        };
        let mut clip_planes = [Vec4::ZERO; MOST_CLIP_PLANES];
        clip_planes[..settings.clip_planes.len()].copy_from_slice(&settings.clip_planes);
        let surface = IsoSurface {
            previous_world_from_unit: self.previous_world_from_unit,
            clip_planes,
            iso_value: settings.iso_value,
            value_offset: volume.offset,
            voxel,
            distance_limit: settings.distance_limit,
            clip_count: settings.clip_planes.len() as u32,
            refinements: settings.refinements,
            frame: self.number,
            reserved: 0,
        };
        Ok((space, surface))
    }
}
