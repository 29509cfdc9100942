// SPDX-License-Identifier: MIT OR Apache-2.0
//! Each way to a picture, and what it gives.

use crate::gpu::{gpu, shaders};
use airlight::scattering::{Along, Inputs, March, Prefiltered, Rectification, Settings, Weighting};
use airlight::{Stage, Texture};

pub fn rectified(inputs: &Inputs<'_>, map: [u32; 2]) -> Rectification {
    let rectification = Rectification::new(gpu(), shaders(), map).unwrap();
    let bound = rectification.bind(gpu(), inputs).unwrap();
    let mut encoder = gpu().encoder();
    rectification.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    rectification
}

/// Visibility, and radiance as three values a pixel.
pub struct Scattered {
    pub visibility: Vec<f32>,
    pub radiance: Vec<f32>,
}

fn scattered(texture: &Texture) -> Scattered {
    let values = texture.read(gpu()).unwrap();
    Scattered {
        visibility: values.chunks_exact(4).map(|texel| texel[3]).collect(),
        radiance: values.chunks_exact(4).flat_map(|texel| texel[..3].to_vec()).collect(),
    }
}

pub fn prefiltered(inputs: &Inputs<'_>, settings: Settings, picture: [u32; 2]) -> Scattered {
    let method = Prefiltered::new(gpu(), shaders(), settings, picture).unwrap();
    let bound = method.bind(gpu(), inputs).unwrap();
    let mut encoder = gpu().encoder();
    method.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    scattered(&method.scattered)
}

pub fn marched(inputs: &Inputs<'_>, along: &Along<'_>, weighting: Weighting, picture: [u32; 2]) -> Scattered {
    let method = March::new(gpu(), shaders(), along, weighting, picture).unwrap();
    let bound = method.bind(gpu(), inputs, along).unwrap();
    let mut encoder = gpu().encoder();
    method.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    scattered(&method.scattered)
}

/// Each way to a picture: name, whether weighted by transmittance, result.
pub fn all_methods(stage: &Stage, picture: [u32; 2], map: [u32; 2]) -> Vec<(&'static str, bool, Scattered)> {
    let inputs = stage.inputs();
    let rows = rectified(&inputs, map);
    let mut results = Vec::new();
    for weighting in [Weighting::Average, Weighting::Transmittance] {
        let weighted = weighting == Weighting::Transmittance;
        let settings = Settings { map, weighting, ..Settings::default() };
        results.push(("prefiltered", weighted, prefiltered(&inputs, settings, picture)));
        results.push(("rows", weighted, marched(&inputs, &Along::Rows(&rows), weighting, picture)));
        let along = Along::ShadowMap { steps: 2048 };
        results.push(("shadow map", weighted, marched(&inputs, &along, weighting, picture)));
    }
    results
}
