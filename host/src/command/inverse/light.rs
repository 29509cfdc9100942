// SPDX-License-Identifier: MIT OR Apache-2.0
//! What light the medium has to scatter.

use super::field::Field;
use glam::Vec3;

/// The radiance that an albedo of 1 scatters towards the eye, in the box of the volume: the mean of the radiance that arrives over all
/// directions, weighed by the phase function. Light from all around that nothing takes away on its way arrives everywhere alike.
///
/// This is the one place where light enters: light of a map or of a lamp, with its way through `extinction`, replaces this volume.
pub fn scattered_volume(_extinction: &Field, ambient: Vec3) -> Field {
    Field::constant(ambient)
}
