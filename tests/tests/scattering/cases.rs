// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scenes of the gallery with their rectified maps and exact pictures.

use crate::gpu::{self, gpu};
use crate::methods::rectified;
use airlight::scattering::Rectification;
use airlight::{Stage, scenes};
use airlight_tests::reference::scattering as reference;
use std::sync::OnceLock;

/// Size of the pictures whose figures are asked for.
pub const PICTURE: [u32; 2] = [480, 270];

/// A scene of the gallery on the GPU with its rectified map and exact picture.
pub struct Case {
    pub stage: Stage,
    pub map: Rectification,
    pub exact: reference::Picture,
    pub view: airlight::core::PerspectiveView,
}

impl Case {
    pub fn new(name: &str, picture: [u32; 2], map: [u32; 2]) -> Self {
        let scene = scenes::scene(name).unwrap().unwrap();
        let view = scene.view.perspective().unwrap();
        let stage = Stage::new(gpu(), gpu::raster(), &scene.setting(), picture, [1024, 1024]).unwrap();
        let map = rectified(&stage.inputs(), map);
        let exact = gpu::exact_picture(&stage, &view, &map, 1);
        Self { stage, map, exact, view }
    }
}

pub fn foliage() -> &'static Case {
    static CASE: OnceLock<Case> = OnceLock::new();
    CASE.get_or_init(|| Case::new("foliage", PICTURE, [512, 512]))
}

pub fn plane() -> &'static Case {
    static CASE: OnceLock<Case> = OnceLock::new();
    CASE.get_or_init(|| Case::new("plane", PICTURE, [512, 512]))
}
