// SPDX-License-Identifier: MIT OR Apache-2.0
//! Styles of strokes, in the words of a person.

use super::{Brushes, StrokeError, StrokeStyle};
use glam::Vec3;

/// Which way strokes run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "command", derive(serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Orientation {
    /// At right angles to the gradient in the picture.
    #[default]
    Gradient,
    /// All at the style's angle.
    Fixed,
    /// Along the direction of greatest curvature, and where there is none as with the gradient.
    Curvature,
}

/// Bounds of the density of a layer.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "command", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct DensityBounds {
    /// Strokes are born below it.
    pub min: f32,
    /// Strokes are deleted above it; at least `min`. Where both are equal strokes come and go in every frame.
    pub max: f32,
}

/// A layer of strokes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "command", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct LayerStyle {
    /// Where it ends: change of the volume's value, 0..1 for its whole range, over a voxel.
    pub threshold: f32,
    /// Probability that a pixel of the sources gets a stroke in a frame, at most, 0..1.
    pub probability: f32,
    /// Length of a stroke, pixels of the picture.
    pub size: f32,
    /// Width over length, 0.01 to 100.
    #[cfg_attr(feature = "command", serde(default = "default_aspect"))]
    pub aspect: f32,
    /// Opacity of a stroke, 0..1.
    #[cfg_attr(feature = "command", serde(default = "default_opacity"))]
    pub opacity: f32,
    /// Bounds of its density.
    pub density: DensityBounds,
    /// Its brush, from 0 on; any by chance where it is not given.
    #[cfg_attr(feature = "command", serde(default))]
    pub brush: Option<u32>,
}

#[cfg(feature = "command")]
fn default_aspect() -> f32 {
    0.35
}

#[cfg(feature = "command")]
fn default_opacity() -> f32 {
    1.0
}

/// Shares, 0..1, of what is new that strokes take in a sixtieth of a second.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "command", derive(serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct Rates {
    /// Of the colour.
    pub color: f32,
    /// Of the orientation.
    pub orientation: f32,
    /// Of the size.
    pub size: f32,
    /// Of the opacity, fading in.
    pub fade_in: f32,
    /// Of the opacity, fading out.
    pub fade_out: f32,
    /// Of the opacity of what is occluded or has left the picture.
    pub hidden: f32,
}

impl Rates {
    /// As printed (4.2.3): 5 % of the orientation, a third of the colour, 90 % of the opacity. Strokes appear within a frame.
    pub const PRINTED: Self = Self {
        color: 1.0 / 3.0,
        orientation: 0.05,
        size: 1.0 / 3.0,
        fade_in: 0.9,
        fade_out: 0.9,
        hidden: 0.9,
    };
    /// The same with 10 % of the opacity, which fades in 22 frames: "seamless", as the text says it is.
    pub const SEAMLESS: Self = Self { fade_in: 0.1, fade_out: 0.1, ..Self::PRINTED };
}

impl Default for Rates {
    fn default() -> Self {
        Self::SEAMLESS
    }
}

/// A style of strokes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "command", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct PainterlyStyle {
    /// Coarse strokes, where the gradient is small.
    pub coarse: LayerStyle,
    /// Medium strokes.
    pub medium: LayerStyle,
    /// Fine strokes, where the gradient is great.
    pub fine: LayerStyle,
    /// How fast strokes change.
    #[cfg_attr(feature = "command", serde(default))]
    pub rates: Rates,
    /// Share of the thresholds by which a stroke may be beyond those of its layer, 0..10.
    #[cfg_attr(feature = "command", serde(default = "defaults::hysteresis"))]
    pub hysteresis: f32,
    /// Factor on gradient magnitudes before they meet the thresholds.
    #[cfg_attr(feature = "command", serde(default = "defaults::one"))]
    pub gradient_scale: f32,
    /// Density that an opaque stroke adds where it lies, kappa: 0.01 reads a density of 0.01 as one stroke everywhere.
    #[cfg_attr(feature = "command", serde(default = "defaults::density_unit"))]
    pub density_unit: f32,
    /// 1: density counts strokes with the opacity that they fade to; 0: with the one that they have, as printed.
    #[cfg_attr(feature = "command", serde(default = "defaults::one"))]
    pub anticipation: f32,
    /// Share of the way between the bounds of density by which births and deletions keep away from either, 0..0.5: chance lets
    /// densities stray, and a surface that turns crowds strokes.
    #[cfg_attr(feature = "command", serde(default = "defaults::density_margin"))]
    pub density_margin: f32,
    /// Strokes are longer or shorter by up to this share, 0..0.9.
    #[cfg_attr(feature = "command", serde(default))]
    pub size_variation: f32,
    /// Strokes are lighter or darker by up to this share, 0..1.
    #[cfg_attr(feature = "command", serde(default))]
    pub color_variation: f32,
    /// Which way strokes run.
    #[cfg_attr(feature = "command", serde(default))]
    pub orientation: Orientation,
    /// Turned by this, degrees, clockwise in the picture; with [`Orientation::Fixed`] from the horizontal.
    #[cfg_attr(feature = "command", serde(default))]
    pub angle: f32,
    /// A stroke is seen where the surface lies within this many pixels' slope of its point.
    #[cfg_attr(feature = "command", serde(default = "defaults::occlusion_tolerance"))]
    pub occlusion_tolerance: f32,
}

#[cfg(feature = "command")]
mod defaults {
    pub(super) fn one() -> f32 {
        1.0
    }
    pub(super) fn hysteresis() -> f32 {
        0.1
    }
    pub(super) fn density_unit() -> f32 {
        0.01
    }
    pub(super) fn density_margin() -> f32 {
        0.15
    }
    pub(super) fn occlusion_tolerance() -> f32 {
        1.0
    }
}

impl PainterlyStyle {
    /// Names of the layers.
    pub const LAYERS: [&'static str; 3] = ["coarse", "medium", "fine"];

    /// The coarse, medium and fine layer.
    pub fn layers(&self) -> [&LayerStyle; 3] {
        [&self.coarse, &self.medium, &self.fine]
    }

    fn three(&self, of: impl Fn(&LayerStyle) -> f32) -> Vec3 {
        Vec3::from(self.layers().map(of))
    }

    /// Densities below which strokes of a layer are born, and above which they are deleted.
    pub fn within_bounds(&self, layer: &LayerStyle) -> [f32; 2] {
        let DensityBounds { min, max } = layer.density;
        let margin = self.density_margin * (max - min);
        [min + margin, max - margin]
    }

    /// What is wrong with the style, if anything.
    ///
    /// # Errors
    /// [`StrokeError::Style`].
    pub fn check(&self) -> Result<(), StrokeError> {
        let share = (0.0, 1.0, "0 to 1");
        let positive = (1e-9, 1e9, "positive and finite");
        let not_negative = (0.0, 1e9, "finite and not negative");
        let within = |name: String, value: f32, (low, high, range): (f32, f32, &'static str)| {
            let fits = value >= low && value <= high;
            if fits { Ok(()) } else { Err(StrokeError::Style { name, value, range }) }
        };
        let mut before = 0.0;
        for (name, layer) in Self::LAYERS.into_iter().zip(self.layers()) {
            let of = |number: &str| format!("{name}.{number}");
            within(of("threshold"), layer.threshold, positive)?;
            if layer.threshold <= before {
                let range = "greater than that of the layer before";
                return Err(StrokeError::Style { name: of("threshold"), value: layer.threshold, range });
            }
            before = layer.threshold;
            within(of("probability"), layer.probability, share)?;
            within(of("size"), layer.size, (0.01, 65536.0, "0.01 to 65536 pixels"))?;
            within(of("aspect"), layer.aspect, (0.01, 100.0, "0.01 to 100"))?;
            within(of("opacity"), layer.opacity, share)?;
            within(of("density.min"), layer.density.min, not_negative)?;
            let most = (layer.density.min, 1e9, "finite and at least density.min");
            within(of("density.max"), layer.density.max, most)?;
        }
        let rates = &self.rates;
        for (name, rate) in [
            ("color", rates.color),
            ("orientation", rates.orientation),
            ("size", rates.size),
            ("fade_in", rates.fade_in),
            ("fade_out", rates.fade_out),
            ("hidden", rates.hidden),
        ] {
            within(format!("rates.{name}"), rate, share)?;
        }
        within("hysteresis".into(), self.hysteresis, (0.0, 10.0, "0 to 10"))?;
        within("gradient_scale".into(), self.gradient_scale, positive)?;
        within("density_unit".into(), self.density_unit, positive)?;
        within("anticipation".into(), self.anticipation, share)?;
        within("density_margin".into(), self.density_margin, (0.0, 0.5, "0 to 0.5"))?;
        within("size_variation".into(), self.size_variation, (0.0, 0.9, "0 to 0.9"))?;
        within("color_variation".into(), self.color_variation, share)?;
        within("angle".into(), self.angle, (-360.0, 360.0, "-360 to 360 degrees"))?;
        within("occlusion_tolerance".into(), self.occlusion_tolerance, not_negative)
    }

    /// Mean area of a stroke of each layer times the mean opacity of its brush, pixels of the picture.
    pub(super) fn areas(&self, brushes: &Brushes) -> Vec3 {
        let variation = 1.0 + self.size_variation * self.size_variation / 3.0;
        self.three(|layer| {
            layer.size * layer.size * layer.aspect * variation * brushes.mean_opacity(layer.brush)
        })
    }

    /// Strokes that a layer has where its density lies at its bounds, over an area in pixels of the picture.
    pub fn expected_strokes(&self, layer: usize, area: f32, brushes: &Brushes) -> [f32; 2] {
        let of = self.layers()[layer.min(2)];
        let each = self.density_unit * of.opacity * self.areas(brushes).to_array()[layer.min(2)];
        [of.density.min, of.density.max].map(|density| density * area / each.max(1e-12))
    }

    /// The uniform of the style.
    pub fn uniform(&self) -> StrokeStyle {
        StrokeStyle {
            thresholds: self.three(|layer| layer.threshold),
            hysteresis: self.hysteresis,
            probability: self.three(|layer| layer.probability),
            gradient_scale: self.gradient_scale,
            size: self.three(|layer| layer.size),
            size_variation: self.size_variation,
            aspect: self.three(|layer| layer.aspect),
            color_variation: self.color_variation,
            opacity: self.three(|layer| layer.opacity),
            density_unit: self.density_unit,
            density_min: self.three(|layer| self.within_bounds(layer)[0]),
            anticipation: self.anticipation,
            density_max: self.three(|layer| self.within_bounds(layer)[1]),
            occlusion_tolerance: self.occlusion_tolerance,
            brush: self.three(|layer| layer.brush.map_or(-1.0, |brush| brush as f32)),
            orientation: match self.orientation {
                Orientation::Gradient => 0,
                Orientation::Fixed => 1,
                Orientation::Curvature => 2,
            },
            angle: self.angle.to_radians(),
            color_rate: self.rates.color,
            orientation_rate: self.rates.orientation,
            size_rate: self.rates.size,
            opacity_rate: self.rates.fade_in,
            fade_out_rate: self.rates.fade_out,
            hidden_rate: self.rates.hidden,
            reserved: 0.0,
        }
    }
}
