// SPDX-License-Identifier: MIT OR Apache-2.0
//! The truth of a directional light with more than [`super::shadow_map_picture`] knows: cascades, a
//! light texture, and a medium that begins at the near plane.

use super::light_texture::LightTexture;
use super::picture::{Picture, Scene, Start};
use super::quadrature::integrate;
use super::shadow_map::ShadowMap;
use super::views::{ShadowViews, pieces};
use super::visibility::Visibility;
use crate::reference::phase::henyey_greenstein;

/// The picture by the shadow maps themselves (a light ray belongs to the first map that holds it;
/// nearest texel, no bias, lit outside of them) of every `stride`-th pixel. The visibilities are those
/// without the texture; only `radiance` has it.
///
/// # Panics
/// For sizes that differ from those stated, a singular matrix, a ray without end, a stride of 0.
#[must_use]
pub fn shadow_views_picture(
    scene: &Scene<'_>,
    maps: &[ShadowMap<'_>],
    texture: Option<&LightTexture<'_>>,
    start: Start,
    stride: usize,
) -> Picture {
    let views = ShadowViews::new(maps);
    let extinction = scene.medium.extinction;
    scene.evaluate_radiance(stride, start, |ray| {
        let runs = views.lit_runs(ray);
        let taken = |from: f64, to: f64| {
            (-extinction * (from - ray.begin)).exp() * -(-extinction * (to - from)).exp_m1()
        };
        let length: f64 = runs.iter().map(|run| run.to - run.from).sum();
        let weight: f64 = runs.iter().map(|run| taken(run.from, run.to)).sum();
        let whole = taken(ray.begin, ray.end);
        let average = if ray.length() > 0.0 { length / ray.length() } else { 1.0 };
        let weighted = if whole > 0.0 { weight / whole } else { average };
        let visibility = Visibility { average, weighted };
        let Some(texture) = texture else {
            let (medium, light) = (&scene.medium, &scene.light);
            return (visibility, medium.radiance(light, ray.direction, ray.length(), weighted));
        };
        let mut passed = [0.0; 3];
        for run in &runs {
            let view = run.view.map(|view| views.clip_from_world(view));
            let creases = texture.creases(view, ray, run.from, run.to);
            for piece in pieces(creases, run.from, run.to).windows(2) {
                let through = integrate(
                    |t| {
                        let weight = extinction * (-extinction * (t - ray.begin)).exp();
                        texture.at(view, ray.at(t)).map(|passes| passes * weight)
                    },
                    piece[0],
                    piece[1],
                    1e-10,
                );
                for channel in 0..3 {
                    passed[channel] += through[channel];
                }
            }
        }
        let towards_light = scene.light.direction.normalised();
        let phase = henyey_greenstein(ray.direction.dot(towards_light), scene.medium.g);
        let radiance = std::array::from_fn(|channel| {
            scene.medium.albedo * phase * scene.light.radiance[channel] * passed[channel]
        });
        (visibility, radiance)
    })
}

#[cfg(test)]
mod tests;
