// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes of colours, and pictures as numbers of one channel or of three.

use crate::command::CommandError;
use crate::data::Volume;
use crate::formats::write_volumes;
use crate::inverse::Channels;
use crate::{Gpu, GpuError, Texture};
use glam::{Mat4, Vec3};
use std::path::Path;
use wgpu::TextureFormat::{R32Float, Rgba32Float};

/// Colours on a grid in the box of the volume. With one channel all three are the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Voxels along x, y and z.
    pub size: [u32; 3],
    /// One a voxel, x fastest.
    pub values: Vec<Vec3>,
}

impl Field {
    /// The same everywhere.
    pub fn constant(value: Vec3) -> Self {
        Self { size: [1; 3], values: vec![value] }
    }

    /// For passes.
    ///
    /// # Errors
    /// [`GpuError::Refused`].
    pub fn texture(&self, gpu: &Gpu, channels: Channels) -> Result<Texture, GpuError> {
        let format = match channels {
            Channels::One => R32Float,
            Channels::Rgb => Rgba32Float,
        };
        let texture = Texture::volume(gpu, self.size, format);
        texture.write(gpu, &numbers(&self.values, channels))?;
        Ok(texture)
    }

    /// On another grid, straight between the middles of voxels; the same where it has that size.
    pub fn resized(&self, size: [u32; 3]) -> Self {
        if size == self.size {
            return self.clone();
        }
        let spots: [Vec<Spot>; 3] = [0, 1, 2].map(|axis| spots(self.size[axis], size[axis]));
        let [width, height, _] = self.size.map(|side| side as usize);
        let mut values = Vec::with_capacity(spots.iter().map(Vec::len).product());
        for z in &spots[2] {
            for y in &spots[1] {
                for x in &spots[0] {
                    let at = |i: usize, j: usize, k: usize| {
                        self.values[(z.voxels[k] * height + y.voxels[j]) * width + x.voxels[i]]
                    };
                    let row = |j: usize, k: usize| at(0, j, k).lerp(at(1, j, k), x.part);
                    let slice = |k: usize| row(0, k).lerp(row(1, k), y.part);
                    values.push(slice(0).lerp(slice(1), z.part));
                }
            }
        }
        Self { size, values }
    }

    /// Straight between this and another, `part` of it, 0 to 1; on the finer grid where they have two.
    pub fn blended(&self, other: &Self, part: f32) -> Self {
        if self.values.len() < other.values.len() {
            return self.resized(other.size).blended(other, part);
        }
        let other = other.resized(self.size);
        let values = self.values.iter().zip(&other.values).map(|(own, other)| own.lerp(*other, part));
        Self { size: self.size, values: values.collect() }
    }

    /// Writes it as `.nii.gz` and `.npy` into a folder.
    ///
    /// # Errors
    /// A failure.
    pub fn write(
        &self,
        folder: &Path,
        name: &str,
        place: Mat4,
        channels: Channels,
    ) -> Result<(), CommandError> {
        let channel = |channel: usize| Volume {
            size: self.size,
            values: self.values.iter().map(|value| value[channel]).collect(),
            world_from_unit: place,
        };
        let count = if channels == Channels::One { 1 } else { 3 };
        let volumes: Vec<Volume> = (0..count).map(channel).collect();
        for ending in ["nii.gz", "npy"] {
            write_volumes(folder.join(format!("{name}.{ending}")), &volumes)
                .map_err(|error| CommandError::failure(format!("--out: {error}")))?;
        }
        Ok(())
    }
}

/// Where a middle lies among others.
struct Spot {
    voxels: [usize; 2],
    /// Of the second.
    part: f32,
}

fn spots(others: u32, count: u32) -> Vec<Spot> {
    let last = (others - 1) as f32;
    let spot = |index: u32| {
        let at = ((index as f32 + 0.5) * others as f32 / count as f32 - 0.5).clamp(0.0, last);
        let first = at.floor();
        Spot { voxels: [first as usize, (first + 1.0).min(last) as usize], part: at - first }
    };
    (0..count).map(spot).collect()
}

/// Colours as passes take them: one number each, or four.
pub fn numbers(colours: &[Vec3], channels: Channels) -> Vec<f32> {
    match channels {
        Channels::One => colours.iter().map(|colour| colour.x).collect(),
        Channels::Rgb => colours.iter().flat_map(|colour| colour.extend(0.0).to_array()).collect(),
    }
}

/// Colours as passes give them.
pub fn colours(numbers: &[f32], channels: Channels) -> Vec<Vec3> {
    match channels {
        Channels::One => numbers.iter().map(|number| Vec3::splat(*number)).collect(),
        Channels::Rgb => numbers.chunks_exact(4).map(Vec3::from_slice).collect(),
    }
}

/// With one channel the relative luminance (ITU-R BT.709) in all three.
pub fn reduced(colour: Vec3, channels: Channels) -> Vec3 {
    match channels {
        Channels::One => Vec3::splat(colour.dot(Vec3::new(0.2126, 0.7152, 0.0722))),
        Channels::Rgb => colour,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_sizes_have_the_same_shape() {
        let size = [6, 4, 5];
        // Linear along each axis, so that only the outermost half voxels differ.
        let make = |size: [u32; 3]| {
            let values = (0..size.iter().product::<u32>()).map(|i| {
                let at = [i % size[0], i / size[0] % size[1], i / (size[0] * size[1])];
                let unit = Vec3::from([0, 1, 2].map(|axis| (at[axis] as f32 + 0.5) / size[axis] as f32));
                unit + unit.x * unit.y
            });
            Field { size, values: values.collect() }
        };
        assert_eq!(make(size).resized(size), make(size));
        let (finer, expected) = (make(size).resized([12, 4, 10]), make([12, 4, 10]));
        let mut inner = 0;
        for (i, (found, expected)) in finer.values.iter().zip(&expected.values).enumerate() {
            let (x, z) = (i % 12, i / 48);
            if (1..11).contains(&x) && (1..9).contains(&z) {
                assert!(found.distance(*expected) < 1e-5, "{found} {expected}");
                inner += 1;
            }
        }
        assert_eq!(inner, 10 * 4 * 8);
        assert_eq!(Field::constant(Vec3::X).resized([2, 1, 1]).values, [Vec3::X; 2]);
    }

    #[test]
    fn blends_go_from_one_to_the_other() {
        let size = [2, 1, 1];
        let [one, other] =
            [[0.0, 4.0], [1.0, 2.0]].map(|values| Field { size, values: values.map(Vec3::splat).to_vec() });
        assert_eq!(one.blended(&other, 0.25).values, [0.25, 3.5].map(Vec3::splat));
        assert_eq!((one.blended(&other, 0.0), one.blended(&other, 1.0)), (one.clone(), other.clone()));
        let even = Field::constant(Vec3::splat(2.0));
        assert_eq!(one.blended(&even, 0.5).values, [1.0, 3.0].map(Vec3::splat));
        assert_eq!(even.blended(&one, 0.5), one.blended(&even, 0.5));
    }

    #[test]
    fn colours_go_there_and_back() {
        let given = [Vec3::new(0.1, 0.2, 0.3), Vec3::ONE];
        assert_eq!(colours(&numbers(&given, Channels::Rgb), Channels::Rgb), given);
        let grey = given.map(|colour| reduced(colour, Channels::One));
        assert_eq!(colours(&numbers(&grey, Channels::One), Channels::One), grey);
        assert!((grey[1].x - 1.0).abs() < 1e-6 && (grey[0].x - 0.18596).abs() < 1e-5);
    }
}
