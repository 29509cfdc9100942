// SPDX-License-Identifier: MIT OR Apache-2.0
//! A transfer function as an artist describes it: layers, from the bottom up.

use super::{TransferError, TransferSettings};
use glam::{Vec2, Vec3, Vec4};

/// Texels a side that a function may have.
pub(super) const SIZES: std::ops::RangeInclusive<u32> = 1..=1024;

/// A transfer function.
#[derive(Debug, Clone, PartialEq)]
pub struct Transfer {
    /// Texels a side, 1..1024.
    pub size: u32,
    /// How it is read and what is made of it.
    pub settings: TransferSettings,
    /// At least one, the lowest first.
    pub layers: Vec<Layer>,
}

/// A layer.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Its colours.
    pub source: Source,
    /// How it lies over those below.
    pub blend: Blend,
    /// Factor on its colours and alpha, 0..1.
    pub opacity: f32,
}

impl Layer {
    /// A layer that covers those below by its alpha.
    pub fn new(source: Source) -> Self {
        Self { source, blend: Blend::Over, opacity: 1.0 }
    }
}

/// Colours of a layer.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// The same everywhere.
    Solid(Color),
    /// From one position to another, constant beyond both.
    Gradient([(Vec2, Color); 2]),
    /// A picture over the whole square.
    Image(TransferImage),
    /// What the colours of constraints, at least one, diffuse to.
    Diffusion(Vec<Constraint>),
}

/// How a layer lies over those below.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Blend {
    /// It covers them by its alpha.
    Over,
    /// It darkens them.
    Multiply,
    /// It is added to them.
    Add,
}

/// A colour, not premultiplied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Color {
    /// Linear RGB, 0..1.
    pub rgb: Vec3,
    /// 0..1.
    pub alpha: f32,
}

impl Color {
    /// An opaque colour, linear RGB 0..1.
    pub fn opaque(rgb: Vec3) -> Self {
        Self { rgb, alpha: 1.0 }
    }

    /// Premultiplied linear RGBA.
    pub fn premultiplied(&self) -> Vec4 {
        (self.rgb * self.alpha).extend(self.alpha)
    }
}

/// Where a constraint lies.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// In the function: x to the right and y downwards, 0..1.
    At(Vec2),
    /// Where the ray of a pixel of the picture lies; column and row.
    Pixel([u32; 2]),
    /// Where the ray through a point of the scene lies.
    Point {
        /// Metres in the world, while the followed object is where it was modelled.
        point: Vec3,
        /// The object whose movement moves the point.
        follow: Option<String>,
    },
}

/// A colour at a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraint {
    /// Where.
    pub place: Place,
    /// Which.
    pub color: Color,
}

/// A picture: premultiplied linear RGBA, rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferImage {
    /// Width and height in texels.
    pub size: [u32; 2],
    /// Its texels.
    pub texels: Vec<Vec4>,
}

/// What is wrong with a colour, or none.
pub(super) fn wrong_color(rgb: &[f64]) -> Option<String> {
    let wrong = rgb.iter().find(|value| !(0.0..=1.0).contains(*value))?;
    Some(format!("{wrong} is out of range: linear red, green and blue must lie between 0 and 1"))
}

/// What is wrong with a number that must lie in 0..1, or none.
pub(super) fn wrong_share(value: f64) -> Option<String> {
    let wrong = !(0.0..=1.0).contains(&value);
    wrong.then(|| format!("{value} is out of range: it must lie between 0 and 1"))
}

/// What is wrong with a position, or none.
pub(super) fn wrong_position(position: &[f64]) -> Option<String> {
    let wrong = position.iter().any(|value| !(0.0..=1.0).contains(value));
    wrong.then(|| format!("{position:?} lies outside the square of 0 to 1 in x and y"))
}

/// What is wrong with a size, or none.
pub(super) fn wrong_size(size: i64) -> Option<String> {
    let fits = u32::try_from(size).is_ok_and(|size| SIZES.contains(&size));
    (!fits).then(|| format!("{size} texels are impossible: the size must be a whole number from 1 to 1024"))
}

/// What is wrong with a length that must be positive and finite, or none.
pub(super) fn wrong_limit(value: f64) -> Option<String> {
    let fits = value > 0.0 && (value as f32).is_finite() && value as f32 > 0.0;
    (!fits).then(|| format!("{value} m is impossible: it must be positive and finite"))
}

/// What is wrong with a factor, or none.
pub(super) fn wrong_factor(value: f64) -> Option<String> {
    let fits = (0.0..=65504.0).contains(&value);
    (!fits).then(|| format!("{value} is out of range: it must lie between 0 and 65504"))
}

/// What is wrong with a mean cosine, or none.
pub(super) fn wrong_cosine(value: f64) -> Option<String> {
    let fits = (-0.999..=0.999).contains(&value);
    (!fits).then(|| format!("{value} is out of range: a mean cosine must lie between -0.999 and 0.999"))
}

pub(super) const NO_LAYERS: &str = "a transfer function needs at least one layer";
pub(super) const NO_CONSTRAINTS: &str = "a diffusion layer needs at least one constraint";

impl Transfer {
    /// Checks what a file is checked for.
    ///
    /// # Errors
    /// [`TransferError::Description`].
    pub fn check(&self) -> Result<(), TransferError> {
        let refuse = |key: String, wrong: Option<String>| match wrong {
            Some(reason) => Err(TransferError::Description { key, reason }),
            None => Ok(()),
        };
        let settings = &self.settings;
        refuse("size".into(), wrong_size(self.size.into()))?;
        refuse("depth_limit".into(), settings.depth_limit.and_then(|limit| wrong_limit(limit.into())))?;
        refuse("strength".into(), wrong_share(settings.strength.into()))?;
        refuse("brightness".into(), wrong_factor(settings.brightness.into()))?;
        // 0.999 in f32 is a little more than that.
        refuse("g".into(), settings.g.and_then(|g| wrong_cosine(f64::from(g) * (1.0 - 1e-7))))?;
        refuse("layer".into(), self.layers.is_empty().then(|| NO_LAYERS.into()))?;
        for (number, layer) in self.layers.iter().enumerate() {
            let key = format!("layer[{number}]");
            refuse(format!("{key}.opacity"), wrong_share(layer.opacity.into()))?;
            let color = |key: String, color: &Color| {
                refuse(format!("{key}.color"), wrong_color(&color.rgb.to_array().map(f64::from)))?;
                refuse(format!("{key}.alpha"), wrong_share(color.alpha.into()))
            };
            let at = |key: String, at: Vec2| refuse(key, wrong_position(&at.to_array().map(f64::from)));
            match &layer.source {
                Source::Solid(of) => color(key, of)?,
                Source::Gradient(ends) => {
                    for (name, (position, of)) in ["from", "to"].iter().zip(ends) {
                        at(format!("{key}.{name}.at"), *position)?;
                        color(format!("{key}.{name}"), of)?;
                    }
                }
                Source::Image(image) => {
                    let [width, height] = image.size;
                    let fits = u64::from(width) * u64::from(height) == image.texels.len() as u64;
                    let wrong = (!fits || image.texels.is_empty())
                        .then(|| format!("{} texels for {width}x{height}", image.texels.len()));
                    refuse(format!("{key}.file"), wrong)?;
                }
                Source::Diffusion(constraints) => {
                    let none = constraints.is_empty().then(|| NO_CONSTRAINTS.into());
                    refuse(format!("{key}.constraint"), none)?;
                    for (number, constraint) in constraints.iter().enumerate() {
                        let key = format!("{key}.constraint[{number}]");
                        if let Place::At(position) = constraint.place {
                            at(format!("{key}.at"), position)?;
                        }
                        color(key, &constraint.color)?;
                    }
                }
            }
        }
        Ok(())
    }
}
