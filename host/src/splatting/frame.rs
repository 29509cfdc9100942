// SPDX-License-Identifier: MIT OR Apache-2.0
//! Who looks at what in which light, and how sheets are drawn.

use super::{Kernel, SplattingError};
use crate::core::{Camera, DIRECTIONAL, Light};
use crate::out_of_range::in_range;
use encase::ShaderType;
use glam::{Vec2, Vec3};

/// What the medium does with light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shading {
    /// It scatters by a phase function, like droplets.
    #[default]
    Scattering,
    /// It reflects by Phong across its gradient, like surfaces.
    Phong,
}

/// The uniform `SheetLighting` of `splatting/sheet_shading`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SheetLighting {
    /// Radiance from all around, linear RGB.
    pub ambient: Vec3,
    /// Extinction where the transfer function's opacity is 1, 1/m.
    pub extinction: f32,
    /// Mean cosine of the phase function.
    pub g: f32,
    /// Share of diffuse reflection.
    pub diffuse: f32,
    /// Share of mirror-like reflection.
    pub specular: f32,
    /// Exponent of mirror-like reflection.
    pub shininess: f32,
}

impl SheetLighting {
    /// A medium of an extinction where the transfer function's opacity is 1, 1/m; isotropic, with dull reflection.
    pub fn new(extinction: f32) -> Self {
        Self { ambient: Vec3::ZERO, extinction, g: 0.0, diffuse: 0.8, specular: 0.3, shininess: 24.0 }
    }

    pub(super) fn check(&self) -> Result<(), SplattingError> {
        let most = 1e6;
        let range = "from 0 to 1000000";
        in_range("extinction", self.extinction, 0.0..=most, range)?;
        for ambient in self.ambient.to_array() {
            in_range("ambient radiance", ambient, 0.0..=65504.0, "from 0 to 65504")?;
        }
        in_range("mean cosine", self.g, -0.99..=0.99, "from -0.99 to 0.99")?;
        in_range("diffuse share", self.diffuse, 0.0..=most, range)?;
        in_range("specular share", self.specular, 0.0..=most, range)?;
        Ok(in_range("shininess", self.shininess, 1.0..=10_000.0, "from 1 to 10000")?)
    }
}

/// How light goes from sheet to sheet.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum LightTransport {
    /// The medium only takes it away.
    #[default]
    Direct,
    /// The medium also scatters it on and back.
    Scattering(ScatteringSettings),
    /// The same, from an area light that casts penumbras.
    Soft(SoftShadows),
}

/// How sheets scatter light on, and back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScatteringSettings {
    /// Half the angle of the cones about the light's direction, and about its reverse, within which scattered light counts as going on,
    /// and back; 0.5 to 90 degrees, 180 where nothing is scattered back.
    pub cone: f32,
    /// For how far scattered light keeps its direction, metres; 0 for the depth of the sheet, as in the paper, where blur depends on
    /// the number of sheets.
    pub free_path: f32,
    /// Light is scattered back as well. Stores each sheet, eight bytes a texel of the light buffer.
    pub back: bool,
    /// How often light goes down and up before it is seen, 1 to 16; 1 as in the paper.
    pub sweeps: u32,
}

impl Default for ScatteringSettings {
    /// Forward only, within 60 degrees; with `back`, four sweeps.
    fn default() -> Self {
        Self { cone: 60.0, free_path: 0.0, back: false, sweeps: 4 }
    }
}

/// Shadows of an area light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoftShadows {
    /// Of a directional light the angle that it has in the sky, degrees, 0 to 60; of a light at a point the side of a square that faces
    /// the scene, metres, 0 to 1000000.
    pub size: f32,
    /// Depth of solids where their surface rises by a metre for each metre across the light, metres; about half the width of things.
    /// Solids end where the light ray leaves them in any case; an open mesh is none.
    pub filling: f32,
    /// Greatest depth of solids, metres; 0 where surfaces are thin.
    pub deepest: f32,
}

impl SoftShadows {
    /// A light of a size; see there. Solids are as deep as the slope of their surface says, about things of a metre.
    pub fn new(size: f32) -> Self {
        Self { size, filling: 1.0, deepest: 1e6 }
    }

    pub(super) fn check(&self, directional: bool) -> Result<(), SplattingError> {
        let (most, range) =
            if directional { (60.0, "from 0 to 60 degrees") } else { (1e6, "from 0 to 1000000 m") };
        in_range("size of the light", self.size, 0.0..=most, range)?;
        in_range("filling of solids", self.filling, 0.0..=1e6, "from 0 to 1000000 m")?;
        Ok(in_range("greatest depth of solids", self.deepest, 0.0..=1e6, "from 0 to 1000000 m")?)
    }
}

/// How sheets are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SheetSettings {
    /// How many.
    pub count: u32,
    /// Columns and rows of the shadow buffer.
    pub light_size: [u32; 2],
    /// Of all splats.
    pub kernel: Kernel,
    /// What the medium does with light.
    pub shading: Shading,
    /// How light goes from sheet to sheet.
    pub transport: LightTransport,
    /// Every sheet looks at all splats, unsorted: for comparison.
    pub scanning: bool,
}

impl Default for SheetSettings {
    fn default() -> Self {
        Self {
            count: 128,
            light_size: [512; 2],
            kernel: Kernel::default(),
            shading: Shading::Scattering,
            transport: LightTransport::Direct,
            scanning: false,
        }
    }
}

/// Who looks at what in which light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SheetFrame {
    /// A camera of the picture's size.
    pub camera: Camera,
    /// The light; its map has to hold the volume.
    pub light: Light,
    /// Of the medium.
    pub lighting: SheetLighting,
}

impl SheetFrame {
    /// The light as a camera of pictures of `size`.
    pub(super) fn light_camera(&self, size: [u32; 2]) -> Camera {
        let light = &self.light;
        Camera {
            clip_from_world: light.clip_from_world,
            world_from_clip: light.world_from_clip,
            eye: light.position,
            near_depth: 1.0 - light.far_depth,
            viewport: Vec2::from(size.map(|side| side as f32)),
            far_depth: light.far_depth,
            projection: u32::from(light.kind == DIRECTIONAL),
        }
    }

    /// In which the eye looks.
    pub(super) fn view_direction(&self) -> Vec3 {
        let camera = &self.camera;
        if camera.projection == 1 {
            return camera.world_from_clip.z_axis.truncate() * (camera.far_depth - camera.near_depth);
        }
        camera.clip_from_world.transpose().w_axis.truncate()
    }

    /// In which light goes at a point.
    pub(super) fn light_direction(&self, point: Vec3) -> Vec3 {
        if self.light.kind == DIRECTIONAL { -self.light.direction } else { point - self.light.position }
    }
}
