// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions of few words, the baker, and colours as the references take them.

use crate::gpu::{Random, gpu, shaders};
use crate::probing::{f, worst};
use airlight::Texture;
use airlight::stylize::{Baker, Color, Constraint, Layer, Place, Source, Transfer, TransferSettings};
use glam::Vec2;
use std::sync::OnceLock;

/// Half a step of rgba16float below 1.
pub const HALF_FLOAT: f64 = 2.5e-4;

pub fn baker() -> &'static Baker {
    static BAKER: OnceLock<Baker> = OnceLock::new();
    BAKER.get_or_init(|| Baker::new(gpu(), shaders()).unwrap())
}

pub fn transfer(size: u32, layers: Vec<Layer>) -> Transfer {
    Transfer { size, settings: TransferSettings::default(), layers }
}

pub fn baked(of: &Transfer) -> Vec<[f64; 4]> {
    texels(&baker().bake(gpu(), of, None).unwrap())
}

pub fn texels(texture: &Texture) -> Vec<[f64; 4]> {
    let values = texture.read(gpu()).unwrap();
    values.chunks_exact(4).map(|c| std::array::from_fn(|i| f(c[i]))).collect()
}

pub fn color(rgb: [f32; 3], alpha: f32) -> Color {
    Color { rgb: rgb.into(), alpha }
}

pub fn at(x: f32, y: f32, color: Color) -> Constraint {
    Constraint { place: Place::At(Vec2::new(x, y)), color }
}

pub fn diffusion(constraints: Vec<Constraint>) -> Layer {
    Layer::new(Source::Diffusion(constraints))
}

pub fn random_color(random: &mut Random) -> Color {
    let [r, g, b, a] = [0; 4].map(|_| random.unit() as f32);
    color([r, g, b], a)
}

/// Premultiplied, as the references take it.
pub fn premultiplied(of: &Color) -> [f64; 4] {
    let a = f(of.alpha);
    [f(of.rgb.x) * a, f(of.rgb.y) * a, f(of.rgb.z) * a, a]
}

pub fn straight(of: &Color) -> [f64; 4] {
    [f(of.rgb.x), f(of.rgb.y), f(of.rgb.z), f(of.alpha)]
}

pub fn greatest(found: &[[f64; 4]], expected: &[[f64; 4]]) -> f64 {
    assert_eq!(found.len(), expected.len());
    worst(found.iter().flatten().copied().zip(expected.iter().flatten().copied()))
}
