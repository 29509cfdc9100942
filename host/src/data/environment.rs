// SPDX-License-Identifier: MIT OR Apache-2.0
//! Environment maps: radiance from far away in every direction, and the lights that stand for it.
//!
//! A map is a latitude-longitude picture: rows run from the zenith (+y) down to the nadir, columns to the right as someone inside
//! sees them. Its middle is where -z is, a quarter of its width to the right of that +x, and its left and right edges meet at +z:
//! column x of `width` has the azimuth 360 degrees · (1 - (x + 0.5) / width), from +z towards +x, and row y of `height` the
//! elevation 90 - 180 degrees · (y + 0.5) / height. Radiance is constant over a texel.

mod discs;
mod resampling;
mod sampling;

pub use discs::{DiscLights, disc_lights};

use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Why there is no environment map.
#[derive(Debug, thiserror::Error)]
pub enum EnvironmentError {
    /// The number of texels is not that of the size.
    #[error("an environment map of {width}x{height} needs {} texels, not {given}", u64::from(*width) * u64::from(*height))]
    Texels {
        /// Width in texels.
        width: u32,
        /// Height in texels.
        height: u32,
        /// Number of texels that were given.
        given: usize,
    },
    /// Radiance that light cannot have.
    #[error(
        "{count} texels of the environment map are negative or not finite, the first in column {x} of row {y}: radiance must be 0 or more; repair these texels"
    )]
    Radiance {
        /// Number of texels.
        count: usize,
        /// Column of the first, from 0.
        x: u32,
        /// Row of the first, from 0 at the top.
        y: u32,
    },
    /// The number of coefficients is not that of lights.
    #[error("{lights} disc lights need a coefficient each, not {given}")]
    Coefficients {
        /// Number of lights.
        lights: usize,
        /// Number of coefficients.
        given: usize,
    },
    /// The file cannot be read.
    #[error("environment map {}: {reason}; a latitude-longitude picture is needed: .exr or .hdr (linear), or .png (sRGB)", path.display())]
    File {
        /// The file.
        path: std::path::PathBuf,
        /// What is wrong.
        reason: String,
    },
}

/// A light at infinity that stands for a part of the environment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvironmentLight {
    /// Unit vector TOWARDS the light.
    pub direction: Vec3,
    /// Irradiance on a surface that faces it: radiance times solid angle, linear RGB.
    pub irradiance: Vec3,
}

/// Radiance from infinity, linear RGB, in all directions.
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    size: [u32; 2],
    texels: Vec<Vec3>,
}

impl Environment {
    /// A map of `size` texels of radiance, rows from the zenith.
    ///
    /// # Errors
    /// [`EnvironmentError::Texels`]; [`EnvironmentError::Radiance`].
    pub fn new(size: [u32; 2], texels: Vec<Vec3>) -> Result<Self, EnvironmentError> {
        let [width, height] = size;
        let given = texels.len();
        if given == 0 || u64::from(width) * u64::from(height) != given as u64 {
            return Err(EnvironmentError::Texels { width, height, given });
        }
        let impossible = |texel: &Vec3| !(texel.is_finite() && texel.min_element() >= 0.0);
        let mut wrong = (0_u32..).zip(&texels).filter(|(_, texel)| impossible(texel)).map(|(place, _)| place);
        if let Some(first) = wrong.next() {
            let (x, y) = (first % width, first / width);
            return Err(EnvironmentError::Radiance { count: 1 + wrong.count(), x, y });
        }
        Ok(Self { size, texels })
    }

    /// The map of a function of unit vectors, sampled in the middle of each texel. Sides of 0 count as 1.
    ///
    /// # Errors
    /// [`EnvironmentError::Radiance`].
    pub fn from_function(size: [u32; 2], radiance: impl Fn(Vec3) -> Vec3) -> Result<Self, EnvironmentError> {
        let size = size.map(|side| side.max(1));
        let texels = (0..size[1])
            .flat_map(|y| (0..size[0]).map(move |x| Vec2::new(x as f32 + 0.5, y as f32 + 0.5)))
            .map(|place| radiance(direction_at(size, place)))
            .collect();
        Self::new(size, texels)
    }

    /// Width and height in texels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Radiance, linear RGB, rows from the zenith.
    pub fn texels(&self) -> &[Vec3] {
        &self.texels
    }

    /// The unit vector towards a place of the map, in texels from its upper left corner.
    pub fn direction(&self, place: Vec2) -> Vec3 {
        direction_at(self.size, place)
    }

    /// The place of a direction, of any length, in texels from the upper left corner.
    pub fn place(&self, direction: Vec3) -> Vec2 {
        let direction = direction.normalize_or(Vec3::NEG_Z);
        let around = 1.0 - (direction.x.atan2(direction.z) / TAU).rem_euclid(1.0);
        let down = 0.5 - direction.y.clamp(-1.0, 1.0).asin() / PI;
        Vec2::new(around, down) * Vec2::new(self.size[0] as f32, self.size[1] as f32)
    }

    /// Radiance that comes from a direction, of any length.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let place = self.place(direction);
        let [width, height] = self.size.map(|side| side as usize);
        // The edges meet; beyond the poles there is nothing.
        let (x, y) = (place.x as usize % width, (place.y as usize).min(height - 1));
        self.texels[y * width + x]
    }

    /// The integral over the sphere: radiance times steradians, linear RGB.
    pub fn integral(&self) -> DVec3 {
        let rows = self.texels.chunks_exact(self.size[0] as usize).enumerate();
        rows.map(|(y, row)| {
            self.texel_solid_angle(y as u32) * row.iter().map(|texel| texel.as_dvec3()).sum::<DVec3>()
        })
        .sum()
    }

    /// Steradians of each texel of a row.
    pub fn texel_solid_angle(&self, row: u32) -> f64 {
        let around = std::f64::consts::TAU / f64::from(self.size[0]);
        around * (self.sine(row) - self.sine(row + 1))
    }

    /// Sine of the elevation of the upper edge of a row.
    fn sine(&self, row: u32) -> f64 {
        (std::f64::consts::PI * f64::from(row) / f64::from(self.size[1])).cos()
    }
}

fn direction_at([width, height]: [u32; 2], place: Vec2) -> Vec3 {
    let azimuth = 360.0 * (1.0 - place.x / width as f32);
    let elevation = 90.0 - 180.0 * place.y / height as f32;
    crate::core::direction_from_angles(azimuth, elevation)
}

/// Reads a latitude-longitude picture: .exr or .hdr, whose values are radiance, or .png, taken as sRGB of 0..1. Alpha darkens.
///
/// # Errors
/// [`EnvironmentError::File`]; also where radiance is negative or not finite.
#[cfg(feature = "command")]
pub fn load_environment(path: impl AsRef<std::path::Path>) -> Result<Environment, EnvironmentError> {
    map_of(path.as_ref(), crate::formats::read_linear_picture(path.as_ref()))
}

/// A map from the bytes of a file that is part of the program. `name` stands for its path in errors.
///
/// # Errors
/// As [`load_environment`].
#[cfg(feature = "command")]
pub fn environment_from_bytes(name: &str, bytes: &[u8]) -> Result<Environment, EnvironmentError> {
    map_of(name.as_ref(), crate::formats::linear_picture_from_bytes(name, bytes))
}

#[cfg(feature = "command")]
fn map_of(
    path: &std::path::Path,
    picture: Result<crate::formats::PicturePixels, crate::formats::PictureError>,
) -> Result<Environment, EnvironmentError> {
    let failed = |reason: String| EnvironmentError::File { path: path.to_owned(), reason };
    let picture = picture.map_err(|error| failed(error.reason))?;
    let texels = picture.darkened();
    Environment::new(picture.size, texels).map_err(|error| failed(error.to_string()))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// Texels by hand from the sentence at the top, not from the formulas.
    #[test]
    fn a_marked_texel_is_seen_where_the_convention_says() {
        for ([x, y], direction) in [
            ([3, 4], Vec3::new(-0.01, -0.01, -1.0)),
            ([4, 3], Vec3::new(0.2, 0.2, -1.0)),
            ([3, 3], Vec3::new(-0.2, 0.2, -1.0)),
            ([6, 3], Vec3::new(1.0, 0.2, 0.2)),
            ([5, 3], Vec3::new(1.0, 0.2, -0.2)),
            ([2, 4], Vec3::new(-1.0, -0.2, -0.2)),
            ([7, 4], Vec3::new(0.2, -0.2, 1.0)),
            ([0, 4], Vec3::new(-0.2, -0.2, 1.0)),
            ([7, 0], Vec3::new(0.1, 1.0, 0.4)),
            ([0, 7], Vec3::new(-0.1, -1.0, 0.4)),
        ] {
            let mut texels = vec![Vec3::ZERO; 64];
            texels[y * 8 + x] = Vec3::new(1.0, 2.0, 3.0);
            let map = Environment::new([8, 8], texels).unwrap();
            assert_eq!(map.radiance(direction), Vec3::new(1.0, 2.0, 3.0), "{direction}");
            assert_eq!(map.radiance(-direction), Vec3::ZERO, "{direction}");
            let middle = map.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
            assert_eq!(map.radiance(middle), Vec3::new(1.0, 2.0, 3.0));
            assert!(middle.dot(direction) > 0.0 && middle.is_normalized());
        }
    }

    #[test]
    fn places_and_directions_are_inverse_and_edges_meet() {
        let map = Environment::from_function([16, 8], |_| Vec3::ONE).unwrap();
        let mut random = crate::data::Random::new(4);
        for _ in 0..200 {
            let direction = random.direction();
            assert!(map.direction(map.place(direction)).distance(direction) < 2e-3);
        }
        for direction in [Vec3::Z, Vec3::Y, Vec3::NEG_Y, Vec3::ZERO, Vec3::new(-0.0, 0.0, 1.0), Vec3::NAN] {
            assert_eq!(map.radiance(direction), Vec3::ONE, "{direction}");
        }
    }

    #[test]
    fn the_integral_is_that_of_the_sphere() {
        let map = Environment::from_function([7, 5], |_| Vec3::new(1.0, 2.0, 0.5)).unwrap();
        let sphere = 4.0 * std::f64::consts::PI;
        assert!(map.integral().distance(sphere * DVec3::new(1.0, 2.0, 0.5)) < 1e-9);
        // Of the squared cosine about an axis a third of that.
        for axis in [Vec3::Y, Vec3::X, Vec3::new(0.6, 0.0, 0.8)] {
            let map = Environment::from_function([256, 128], |d| Vec3::splat(d.dot(axis).powi(2))).unwrap();
            assert!((map.integral().x - sphere / 3.0).abs() < 1e-3, "{axis}: {}", map.integral());
        }
    }

    #[test]
    fn impossible_maps_are_refused() {
        assert!(matches!(Environment::new([2, 2], vec![Vec3::ONE; 3]), Err(EnvironmentError::Texels { .. })));
        assert!(matches!(Environment::new([0, 0], vec![]), Err(EnvironmentError::Texels { .. })));
        let mut texels = vec![Vec3::ONE; 6];
        (texels[4].y, texels[5].z) = (f32::NAN, -1.0);
        let error = Environment::new([3, 2], texels).unwrap_err();
        assert!(matches!(error, EnvironmentError::Radiance { count: 2, x: 1, y: 1 }), "{error}");
    }

    #[cfg(feature = "command")]
    #[test]
    fn maps_come_from_files() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.exr");
        crate::formats::write_exr(&path, 2, 1, &[0.5, 0.25, 70.0, 0.0, 1.0, 0.125]).unwrap();
        let map = load_environment(&path).unwrap();
        assert_eq!((map.size(), map.texels()[0]), ([2, 1], Vec3::new(0.5, 0.25, 70.0)));
        crate::formats::write_exr(&path, 2, 1, &[0.5, -0.25, 7.0, 0.0, 1.0, 0.125]).unwrap();
        for (name, said) in
            [("sky.exr", "column 0 of row 0"), ("no.exr", "no such file"), ("a.txt", "neither")]
        {
            let error = load_environment(folder.path().join(name)).unwrap_err().to_string();
            assert!(error.contains(said) && error.contains(name), "{error}");
        }
    }
}
