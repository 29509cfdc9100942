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

/// Where the medium begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Start {
    /// At the eye; on the near plane of an orthographic camera.
    #[default]
    Eye,
    /// On the near plane: a view ray scatters and takes light from there on only.
    NearPlane,
}

/// The part of a view ray that lies in the medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewRay {
    /// Where the view ray begins, world, metres: the eye, or a point of an orthographic near plane.
    pub origin: Vec3,
    /// Its unit direction, into the scene.
    pub direction: Vec3,
    /// Where the medium begins, metres from the origin.
    pub begin: f64,
    /// Where the ray ends, metres from the origin, at least `begin`.
    pub end: f64,
}

impl ViewRay {
    /// The point at a distance from the origin, metres.
    #[must_use]
    pub fn at(&self, distance: f64) -> Vec3 {
        self.origin + self.direction * distance
    }

    /// Length in the medium, metres.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.end - self.begin
    }
}

impl Scene<'_> {
    /// The part of a pixel's view ray that lies in the medium. The distance limit counts from the
    /// origin of the ray.
    #[must_use]
    pub fn ray(&self, x: usize, y: usize, start: Start) -> ViewRay {
        let (direction, end) = self.view_ray(x, y);
        let origin = self.camera.origin(Camera::pixel_ndc(x, y, self.width, self.height));
        let begin = match start {
            Start::Eye => 0.0,
            Start::NearPlane => self.camera.near / direction.dot(self.camera.forward),
        };
        ViewRay { origin, direction, begin: begin.min(end), end }
    }

    /// Unit direction of a pixel's view ray and its length in the medium, metres.
    #[must_use]
    pub fn view_ray(&self, x: usize, y: usize) -> (Vec3, f64) {
        let ndc = Camera::pixel_ndc(x, y, self.width, self.height);
        let distance = self.camera.distance(ndc, f64::from(self.depth[y * self.width + x]));
        (self.camera.ray(ndc), distance.min(self.medium.distance_limit))
    }

    /// Every `stride`-th pixel, with the visibility that `visibility` gives for the part of its ray
    /// in the medium; radiance by [`Medium::radiance`].
    ///
    /// # Panics
    /// For a depth buffer of another size, and a stride of 0.
    pub(super) fn evaluate(
        &self,
        stride: usize,
        start: Start,
        visibility: impl Fn(&ViewRay) -> Visibility + Sync,
    ) -> Picture {
        self.evaluate_radiance(stride, start, |ray| {
            let found = visibility(ray);
            let radiance = self.medium.radiance(&self.light, ray.direction, ray.length(), found.weighted);
            (found, radiance)
        })
    }

    /// Every `stride`-th pixel, with the visibility and radiance of the part of its ray in the medium.
    ///
    /// # Panics
    /// For a depth buffer of another size, and a stride of 0.
    pub(super) fn evaluate_radiance(
        &self,
        stride: usize,
        start: Start,
        radiance: impl Fn(&ViewRay) -> (Visibility, [f64; 3]) + Sync,
    ) -> Picture {
        assert_eq!(self.depth.len(), self.width * self.height, "size of the depth buffer");
        let (columns, rows) = (self.width.div_ceil(stride), self.height.div_ceil(stride));
        let pixel = |x: usize, y: usize| {
            let ray = self.ray(x, y, start);
            let (Visibility { average, weighted }, radiance) = radiance(&ray);
            Pixel { x, y, distance: ray.length(), average, weighted, radiance }
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
    scene
        .evaluate(stride, Start::Eye, |ray| rectification.visibility(map, ray.direction, ray.end, extinction))
}
