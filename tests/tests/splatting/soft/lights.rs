// SPDX-License-Identifier: MIT OR Apache-2.0
//! Far and near lights that have a size.

use airlight::core::Light;
use glam::Vec3;

pub fn sun(towards: Vec3) -> Light {
    Light::directional(towards, Vec3::ONE, Vec3::splat(-9.0), Vec3::splat(9.0)).unwrap()
}

pub fn lamp(position: Vec3) -> Light {
    Light::point(position, Vec3::ONE, 0.05, 0.05, 100.0).unwrap()
}
