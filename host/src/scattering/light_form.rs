// SPDX-License-Identifier: MIT OR Apache-2.0
//! What kind of light the passes are composed for.

use super::{Inputs, SettingsError};
use crate::core::{Camera, Light};
use crate::core::{POINT, SPOT};
use airlight_validate::Definitions;

/// Least distance of the eye from a spot or point light whose rows go round it, metres.
const LEAST_DISTANCE: f32 = 1e-4;

/// What kind of light the passes are composed for: the permutation follows from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LightForm {
    /// A light at a point that shines into a cone.
    pub spot: bool,
    /// A light at a point that shines everywhere; needs an array of shadow maps.
    pub point: bool,
    /// Shadow maps come in an array: cascades, or the faces around a point light.
    pub shadow_array: bool,
    /// A texture colours the light; not a point light.
    pub texture: bool,
}

impl LightForm {
    /// The form of a light and of what comes with it.
    pub fn of(light: &Light, inputs: &Inputs<'_>) -> Self {
        Self {
            spot: light.kind == SPOT,
            point: light.kind == POINT,
            shadow_array: inputs.shadow_views.is_some() && inputs.shadow_maps.is_some(),
            texture: inputs.light_texture.is_some(),
        }
    }

    /// A spot or a point light.
    pub fn local(&self) -> bool {
        self.spot || self.point
    }

    /// A directional light with one shadow map and no texture.
    pub fn plain(&self) -> bool {
        *self == Self::default()
    }

    /// Colours for each of which columns have a fall-off of their own; none where it is 1 everywhere.
    pub fn colors(&self) -> Option<u32> {
        match (self.texture, self.spot) {
            (true, _) => Some(3),
            (false, true) => Some(1),
            (false, false) => None,
        }
    }

    /// Layers of the filtered bases for `bases` bases.
    pub fn layers(&self, bases: u32) -> u32 {
        self.colors().map_or(bases / 4, |colors| colors * bases / 4 + 1)
    }

    /// Checks that there are passes for it.
    ///
    /// # Errors
    /// [`SettingsError::LightForm`].
    pub fn validate(&self) -> Result<(), SettingsError> {
        let impossible = |reason| Err(SettingsError::LightForm(reason));
        match (self.point, self.shadow_array, self.texture) {
            (true, false, _) => impossible("a point light needs an array of shadow maps and their views"),
            (true, _, true) => impossible("a point light takes no light texture"),
            _ if self.point && self.spot => impossible("a light is a spot or a point light, not both"),
            _ => Ok(()),
        }
    }

    /// Checks that the eye of a perspective camera is not at a spot or point light: rows go round the line between.
    ///
    /// # Errors
    /// [`SettingsError::LightAtEye`].
    pub fn check_eye(camera: &Camera, light: &Light) -> Result<(), SettingsError> {
        let distance = light.position.distance(camera.eye);
        let local = light.kind == SPOT || light.kind == POINT;
        if local && !(distance.is_finite() && distance >= LEAST_DISTANCE) {
            return Err(SettingsError::LightAtEye { distance, least: LEAST_DISTANCE });
        }
        Ok(())
    }

    /// LOCAL, where it is.
    pub(super) fn local_definitions(&self, definitions: Definitions) -> Definitions {
        if self.local() { definitions.flag("LOCAL") } else { definitions }
    }

    /// LOCAL and SHADOW_ARRAY, where they are.
    pub(super) fn shadow_definitions(&self, definitions: Definitions) -> Definitions {
        let definitions = self.local_definitions(definitions);
        if self.shadow_array { definitions.flag("SHADOW_ARRAY") } else { definitions }
    }

    /// COLORS, where it is.
    pub(super) fn color_definitions(&self, definitions: Definitions) -> Definitions {
        let definitions = match self.colors() {
            Some(colors) => definitions.set("COLORS", colors as i32),
            None => definitions,
        };
        self.texture_definitions(definitions)
    }

    /// LIGHT_TEXTURE, where it is.
    pub(super) fn texture_definitions(&self, definitions: Definitions) -> Definitions {
        if self.texture { definitions.flag("LIGHT_TEXTURE") } else { definitions }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::core::{DepthRange, PerspectiveView};
    use glam::Vec3;

    #[test]
    fn layers_and_forms() {
        let spot = LightForm { spot: true, ..LightForm::default() };
        let point = LightForm { point: true, shadow_array: true, ..LightForm::default() };
        assert_eq!(LightForm::default().layers(32), 8);
        assert_eq!(point.layers(32), 8);
        assert_eq!(spot.layers(32), 9);
        assert_eq!(LightForm { texture: true, ..spot }.layers(32), 25);
        assert!(
            spot.validate().is_ok() && point.validate().is_ok() && LightForm::default().validate().is_ok()
        );
        assert!(LightForm { shadow_array: false, ..point }.validate().is_err());
        assert!(LightForm { texture: true, ..point }.validate().is_err());
        assert!(LightForm { spot: true, ..point }.validate().is_err());
    }

    #[test]
    fn an_eye_at_the_light_is_refused() {
        let view = PerspectiveView {
            eye: Vec3::new(1.0, 2.0, 3.0),
            target: Vec3::ZERO,
            field_of_view: 50.0,
            near: 0.1,
            far: 50.0,
            depth: DepthRange::Forward,
        };
        let camera = Camera::perspective(&view, [8, 8]).unwrap();
        let light = |at: Vec3| Light::point(at, Vec3::ONE, 0.1, 0.1, 10.0).unwrap();
        assert!(LightForm::check_eye(&camera, &light(view.eye + Vec3::X * 1e-3)).is_ok());
        let error = LightForm::check_eye(&camera, &light(view.eye)).unwrap_err();
        assert!(matches!(error, SettingsError::LightAtEye { .. }), "{error}");
        let sun = Light::directional(Vec3::Y, Vec3::ONE, Vec3::ZERO, Vec3::ONE).unwrap();
        assert!(LightForm::check_eye(&camera, &sun).is_ok());
    }
}
