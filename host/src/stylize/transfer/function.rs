// SPDX-License-Identifier: MIT OR Apache-2.0
//! How a transfer function is read and what is made of it.

use crate::scattering::Medium;
use encase::ShaderType;

/// A property of a view ray, 0..1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RayProperty {
    /// Its mean visibility.
    Visibility,
    /// Its length over the depth limit.
    Depth,
    /// Its angle to the direction towards the light over pi.
    LightAngle,
    /// The angle in the picture from its x axis to the direction towards the light, over two pi.
    PictureAngle,
    /// Mean distance of its lit points over the depth limit. It costs a march of 96 steps a pixel.
    VisibleDepth,
}

/// What the function's colour stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// The scattered radiance itself.
    Replace,
    /// Albedo and visibility: times the light's radiance and the phase function.
    Light,
    /// A factor on the physically based radiance.
    Scattering,
}

/// The phase function of the modes replace and light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// The same in every direction.
    Constant,
    /// That of Henyey and Greenstein.
    HenyeyGreenstein,
}

/// Settings of a transfer function; what is left out follows the medium of the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransferSettings {
    /// The property along x.
    pub across: RayProperty,
    /// The property along y.
    pub down: RayProperty,
    /// What the colour stands for.
    pub mode: Mode,
    /// The phase function.
    pub phase: Phase,
    /// Length of ray that counts as 1, metres, positive; none: that at which rays end in the medium.
    pub depth_limit: Option<f32>,
    /// How much of the function is shown, 0..1.
    pub strength: f32,
    /// Factor on its colours, not negative.
    pub brightness: f32,
    /// Mean cosine of the phase function, -0.999..0.999; none: that of the medium.
    pub g: Option<f32>,
}

impl Default for TransferSettings {
    fn default() -> Self {
        Self {
            across: RayProperty::Visibility,
            down: RayProperty::Depth,
            mode: Mode::Replace,
            phase: Phase::Constant,
            depth_limit: None,
            strength: 1.0,
            brightness: 1.0,
            g: None,
        }
    }
}

/// The uniform `TransferFunction` of `stylize/tf_lookup`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct TransferFunction {
    /// The property along x, as [`RayProperty`] counts from 0.
    pub across: u32,
    /// The property along y.
    pub down: u32,
    /// As [`Mode`] counts from 0.
    pub mode: u32,
    /// As [`Phase`] counts from 0.
    pub phase: u32,
    /// Metres.
    pub depth_limit: f32,
    /// 0..1.
    pub strength: f32,
    /// Factor on colours.
    pub brightness: f32,
    /// Mean cosine.
    pub g: f32,
}

impl TransferSettings {
    /// The uniform, for a scene with `medium`.
    pub fn function(&self, medium: &Medium) -> TransferFunction {
        TransferFunction {
            across: self.across as u32,
            down: self.down as u32,
            mode: self.mode as u32,
            phase: self.phase as u32,
            depth_limit: self.depth_limit.unwrap_or(medium.distance_limit),
            strength: self.strength,
            brightness: self.brightness,
            g: self.g.unwrap_or(medium.g),
        }
    }
}

impl TransferFunction {
    /// Whether the mean distance of lit points is asked for.
    pub fn needs_visible_depth(&self) -> bool {
        [self.across, self.down].contains(&(RayProperty::VisibleDepth as u32))
    }

    /// Whether an angle is asked for.
    pub fn needs_angles(&self) -> bool {
        let angles = [RayProperty::LightAngle as u32, RayProperty::PictureAngle as u32];
        angles.contains(&self.across) || angles.contains(&self.down)
    }

    /// Whether its own phase function is other than constant.
    pub fn is_anisotropic(&self) -> bool {
        self.phase == Phase::HenyeyGreenstein as u32
    }

    /// Numbers between those of two functions, `share` 0..1 of the second; what is no number stays that of the first until
    /// the second is reached.
    #[must_use]
    pub fn between(&self, second: &Self, share: f32) -> Self {
        let kinds = if share >= 1.0 { second } else { self };
        let mix = |a: f32, b: f32| a + (b - a) * share;
        Self {
            depth_limit: mix(self.depth_limit, second.depth_limit),
            strength: mix(self.strength, second.strength),
            brightness: mix(self.brightness, second.brightness),
            g: mix(self.g, second.g),
            ..*kinds
        }
    }

    /// The permutation of the pass `stylize/transfer` that computes what the function asks for.
    pub(super) fn permutation(&self, views: bool) -> usize {
        if self.needs_visible_depth() { 1 + usize::from(views) } else { 0 }
    }
}
