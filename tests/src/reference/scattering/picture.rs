// SPDX-License-Identifier: MIT OR Apache-2.0
//! Whole pictures over a rectified map.

use super::slice::Rectification;
use super::visibility::Visibility;
use crate::linear::Vec3;
use crate::reference::camera::Camera;
use crate::reference::phase::henyey_greenstein;

/// A homogeneous medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Extinction, 1/m, at least 0; 0 scatters nothing.
    pub extinction: f64,
    /// Share of the extinction that is scattering, [0, 1].
    pub albedo: f64,
    /// Mean cosine of the Henyey-Greenstein phase function, (−1, 1).
    pub g: f64,
    /// Greatest distance along view rays, metres; may be infinite.
    pub distance_limit: f64,
}

impl Medium {
    /// In-scattered radiance along a view ray of a unit direction and a length (metres) with the
    /// transmittance-weighted visibility `weighted`; the light's unit and colour.
    #[must_use]
    pub fn radiance(&self, light: &Light, direction: Vec3, distance: f64, weighted: f64) -> [f64; 3] {
        if self.extinction == 0.0 {
            return [0.0; 3];
        }
        let phase = henyey_greenstein(direction.dot(light.direction.normalised()), self.g);
        let taken = -(-self.extinction * distance).exp_m1();
        light.radiance.map(|l| self.albedo * phase * l * taken * weighted)
    }
}

/// A directional light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Direction TOWARDS the light, of any length.
    pub direction: Vec3,
    /// Irradiance that it gives a surface facing it (the `L` of the thesis), scene-linear RGB.
    pub radiance: [f64; 3],
}

/// What a picture is evaluated for.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// The camera.
    pub camera: &'a Camera,
    /// The light.
    pub light: Light,
    /// The medium.
    pub medium: Medium,
    /// The depth buffer, row-major, row 0 at the top.
    pub depth: &'a [f32],
    /// Width of the picture, pixels.
    pub width: usize,
    /// Height of the picture, pixels.
    pub height: usize,
}

/// One pixel's reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Column in the full picture.
    pub x: usize,
    /// Row in the full picture.
    pub y: usize,
    /// Length of the view ray in the medium, metres.
    pub distance: f64,
    /// Mean visibility along it, [0, 1].
    pub average: f64,
    /// Transmittance-weighted visibility, [0, 1].
    pub weighted: f64,
    /// In-scattered radiance, scene-linear RGB.
    pub radiance: [f64; 3],
}

/// Every `stride`-th pixel of a picture, from (0, 0) on, row-major.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels in a row of this picture.
    pub columns: usize,
    /// Rows of this picture.
    pub rows: usize,
    /// Pixels of the full picture between two of this one, in x and y.
    pub stride: usize,
    /// The pixels, row-major.
    pub pixels: Vec<Pixel>,
}

impl Picture {
    /// The mean visibilities, row-major.
    #[must_use]
    pub fn average(&self) -> Vec<f64> {
        self.pixels.iter().map(|pixel| pixel.average).collect()
    }

    /// The transmittance-weighted visibilities, row-major.
    #[must_use]
    pub fn weighted(&self) -> Vec<f64> {
        self.pixels.iter().map(|pixel| pixel.weighted).collect()
    }

    /// The radiances, three values a pixel, row-major.
    #[must_use]
    pub fn radiance(&self) -> Vec<f64> {
        self.pixels.iter().flat_map(|pixel| pixel.radiance).collect()
    }

    /// The same pixels of a full picture of `channels` values a pixel and `width` pixels a row
    /// (the GPU's read-back), the values `keep` of each: comparable with the above.
    #[must_use]
    pub fn sample<T: Copy>(
        &self,
        full: &[T],
        width: usize,
        channels: usize,
        keep: std::ops::Range<usize>,
    ) -> Vec<T> {
        self.pixels
            .iter()
            .flat_map(|pixel| {
                let at = (pixel.y * width + pixel.x) * channels;
                full[at + keep.start..at + keep.end].iter().copied()
            })
            .collect()
    }
}

impl Scene<'_> {
    /// Unit direction of a pixel's view ray and its length in the medium, metres.
    #[must_use]
    pub fn view_ray(&self, x: usize, y: usize) -> (Vec3, f64) {
        let ndc = Camera::pixel_ndc(x, y, self.width, self.height);
        let distance = self.camera.distance(ndc, f64::from(self.depth[y * self.width + x]));
        (self.camera.ray(ndc), distance.min(self.medium.distance_limit))
    }

    /// Every `stride`-th pixel, with the visibility that `visibility` gives for a direction and a
    /// distance.
    ///
    /// # Panics
    /// For a depth buffer of another size, and a stride of 0.
    pub(super) fn evaluate(
        &self,
        stride: usize,
        visibility: impl Fn(Vec3, f64) -> Visibility + Sync,
    ) -> Picture {
        assert_eq!(self.depth.len(), self.width * self.height, "size of the depth buffer");
        let (columns, rows) = (self.width.div_ceil(stride), self.height.div_ceil(stride));
        let pixel = |x: usize, y: usize| {
            let (direction, distance) = self.view_ray(x, y);
            let Visibility { average, weighted } = visibility(direction, distance);
            let radiance = self.medium.radiance(&self.light, direction, distance, weighted);
            Pixel { x, y, distance, average, weighted, radiance }
        };
        let pixels = crate::parallel::rows(rows, |row| {
            (0..columns).map(|column| pixel(column * stride, row * stride)).collect::<Vec<_>>()
        })
        .concat();
        Picture { columns, rows, stride, pixels }
    }
}

/// The exact picture over a rectified map (row-major, f32 as read back or f64), of every
/// `stride`-th pixel in x and y.
///
/// # Panics
/// For a map or depth buffer of another size than stated, and a stride of 0.
#[must_use]
pub fn picture<T: Copy + Into<f64> + Sync>(
    scene: &Scene<'_>,
    rectification: &Rectification,
    map: &[T],
    stride: usize,
) -> Picture {
    let extinction = scene.medium.extinction;
    scene.evaluate(stride, |direction, distance| {
        rectification.visibility(map, direction, distance, extinction)
    })
}
