// SPDX-License-Identifier: MIT OR Apache-2.0
//! Layers and how they are blended.

use super::baking::{baked, greatest, premultiplied, random_color, straight, transfer};
use crate::gpu::Random;
use crate::probing::{f, hold};
use airlight::stylize::{Blend, Layer, Source, TransferImage};
use airlight_tests::reference::stylize::transfer as reference;
use glam::{Vec2, Vec4};

/// A layer's straight colour at a position, before opacity.
fn layer_color(layer: &Layer, [x, y]: [f64; 2], size: u32) -> [f64; 4] {
    let unmultiplied = |c: [f64; 4]| {
        let a = if c[3] > 0.0 { c[3] } else { 1.0 };
        [c[0] / a, c[1] / a, c[2] / a, c[3]]
    };
    match &layer.source {
        Source::Solid(of) => straight(of),
        Source::Gradient([(from, first), (to, second)]) => {
            let along = [f(to.x) - f(from.x), f(to.y) - f(from.y)];
            let length = along[0].hypot(along[1]);
            let share = ((x - f(from.x)) * along[0] + (y - f(from.y)) * along[1]) / (length * length);
            let share = share.clamp(0.0, 1.0);
            let (a, b) = (premultiplied(first), premultiplied(second));
            unmultiplied(std::array::from_fn(|i| a[i] * (1.0 - share) + b[i] * share))
        }
        Source::Image(image) => {
            let texel =
                image.texels[((y * f64::from(size)) as u32 * size + (x * f64::from(size)) as u32) as usize];
            unmultiplied(texel.to_array().map(f))
        }
        Source::Diffusion(_) => unreachable!(),
    }
}

#[test]
fn layers_are_blended_as_the_equations_say() {
    let mut random = Random(23);
    let mut error = 0.0_f64;
    for stack in 0..40 {
        let size = [24, 17, 40][stack % 3];
        let count = 1 + random.below(4);
        let layers: Vec<Layer> = (0..count)
            .map(|_| {
                let source = match random.below(3) {
                    0 => Source::Solid(random_color(&mut random)),
                    1 => Source::Gradient([0; 2].map(|_| {
                        let place = Vec2::new(random.unit() as f32, random.unit() as f32);
                        (place, random_color(&mut random))
                    })),
                    _ => Source::Image(TransferImage {
                        size: [size, size],
                        // As the texture holds them.
                        texels: (0..size * size)
                            .map(|_| {
                                let of = random_color(&mut random).premultiplied();
                                Vec4::from(of.to_array().map(|v| half::f16::from_f32(v).to_f32()))
                            })
                            .collect(),
                    }),
                };
                let blend = [Blend::Over, Blend::Multiply, Blend::Add][random.below(3)];
                Layer { source, blend, opacity: if random.unit() < 0.5 { 1.0 } else { random.unit() as f32 } }
            })
            .collect();
        let expected: Vec<[f64; 4]> = (0..size * size)
            .map(|i| {
                let position = [i % size, i / size].map(|p| (f64::from(p) + 0.5) / f64::from(size));
                let mut below = [0.0; 4];
                for layer in &layers {
                    let mut source = layer_color(layer, position, size);
                    source[3] *= f(layer.opacity);
                    let blend = match layer.blend {
                        Blend::Over => reference::Blend::Over,
                        Blend::Multiply => reference::Blend::Multiply,
                        Blend::Add => reference::Blend::Add,
                    };
                    below = reference::blend(blend, source, below);
                }
                [below[0] * below[3], below[1] * below[3], below[2] * below[3], below[3]]
            })
            .collect();
        let found = baked(&transfer(size, layers.clone()));
        let worst = greatest(&found, &expected);
        assert!(worst < 4e-3, "{worst:e}: {layers:?}");
        error = error.max(worst);
    }
    // Each of up to four layers is rounded to rgba16float, sums up to 4.
    hold("layers", error, 4e-3);
}
