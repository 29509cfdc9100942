// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pixels and points of a scene, as positions in a transfer function.

use super::{Place, TransferError};
use crate::core::Camera;
use crate::resource::Texture;
use crate::scattering::{Inputs, Medium};
use glam::Vec3;
use std::collections::BTreeMap;

/// A rendered scene that constraints refer to.
#[derive(Clone, Copy)]
pub struct PickScene<'a> {
    /// The camera that rendered it.
    pub camera: &'a Camera,
    /// Its medium, which settings that are left out follow.
    pub medium: &'a Medium,
    /// Its uniforms, depth and shadow maps.
    pub inputs: Inputs<'a>,
    /// What a scattering method wrote: radiance, and in alpha the mean visibility.
    pub scattered: &'a Texture,
    /// Of each object that may be followed, how far it has moved, metres.
    pub movements: &'a BTreeMap<String, Vec3>,
}

impl PickScene<'_> {
    /// The pixel that a place names; none where it is a position already. `key`: for errors.
    pub(super) fn pixel(&self, place: &Place, key: &str) -> Result<Option<[u32; 2]>, TransferError> {
        let [width, height, _] = self.scattered.size();
        match place {
            Place::At(_) => Ok(None),
            Place::Pixel([x, y]) if *x < width && *y < height => Ok(Some([*x, *y])),
            Place::Pixel([x, y]) => {
                Err(TransferError::PixelOutside { key: key.to_owned(), x: *x, y: *y, width, height })
            }
            Place::Point { point, follow } => {
                let moved = *point + self.movement(follow.as_deref(), key)?;
                let outside = || TransferError::PointOutside { key: key.to_owned(), point: moved };
                let clip = self.camera.clip_from_world * moved.extend(1.0);
                // Neither NaN nor what lies behind the eye passes.
                if !(clip.w > 0.0 && clip.x.abs() <= clip.w && clip.y.abs() <= clip.w) {
                    return Err(outside());
                }
                let across = (0.5 + 0.5 * clip.x / clip.w) * width as f32;
                let down = (0.5 - 0.5 * clip.y / clip.w) * height as f32;
                Ok(Some([(across as u32).min(width - 1), (down as u32).min(height - 1)]))
            }
        }
    }

    fn movement(&self, follow: Option<&str>, key: &str) -> Result<Vec3, TransferError> {
        let Some(name) = follow else { return Ok(Vec3::ZERO) };
        self.movements.get(name).copied().ok_or_else(|| {
            let known: Vec<_> = self.movements.keys().map(|name| format!("`{name}`")).collect();
            let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
            TransferError::UnknownObject { key: key.to_owned(), name: name.to_owned(), known }
        })
    }
}
