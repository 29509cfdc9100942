// SPDX-License-Identifier: MIT OR Apache-2.0
//! Small pictures of marched scenes, for picks.

use crate::gpu::{gpu, shaders};
use airlight::scattering::{Along, March, Weighting};
use airlight::stylize::PickScene;
use airlight::{Stage, Texture};
use glam::Vec3;
use std::collections::BTreeMap;

pub const PICTURE: [u32; 2] = [96, 72];

pub fn marched(stage: &Stage) -> Texture {
    let along = Along::ShadowMap { steps: 64 };
    let march = March::new(gpu(), shaders(), &along, Weighting::Average, PICTURE).unwrap();
    let bound = march.bind(gpu(), &stage.inputs(), &along).unwrap();
    let mut encoder = gpu().encoder();
    march.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    march.scattered
}

pub fn scene<'a>(
    stage: &'a Stage,
    scattered: &'a Texture,
    movements: &'a BTreeMap<String, Vec3>,
) -> PickScene<'a> {
    PickScene { camera: &stage.camera, medium: &stage.medium, inputs: stage.inputs(), scattered, movements }
}
