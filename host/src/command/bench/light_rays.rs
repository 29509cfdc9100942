// SPDX-License-Identifier: MIT OR Apache-2.0
//! Many light rays in one transmittance map, and how far each form of map is from them.

use crate::command::CommandError;
use crate::core::{Light, Reading, VolumeTexture};
use crate::data::Volume;
use crate::transmittance::{Form, MapSettings, Query, TransmittanceMap, Voxels};
use crate::{Gpu, Shaders};
use airlight_tests::media::RANGE;
use airlight_tests::parallel;
use airlight_tests::reference::transmittance::Profile;
use glam::{Mat4, Vec3};

/// Shares of the second texel in the reads between two neighbours.
const BETWEEN: [f64; 4] = [0.0, 0.25, 0.5, 0.75];
const DEPTHS: usize = 32;

/// Extinctions in 1/m, from the light on, of each ray; all of one length. A texel a ray, light along −z.
pub struct LightRays {
    extinctions: Vec<Vec<f32>>,
}

impl LightRays {
    /// Of these extinctions, none of them empty.
    pub fn new(extinctions: Vec<Vec<f32>>) -> Self {
        Self { extinctions }
    }

    /// Texels of the map and columns of the volume. Places in a power of two are exact, and a whole number of marching
    /// steps fits into a voxel.
    fn width(&self) -> usize {
        self.extinctions.len().next_power_of_two()
    }

    fn volume(&self) -> Result<Volume, CommandError> {
        let (width, length) = (self.width(), self.extinctions.first().map_or(0, Vec::len));
        let last = self.extinctions.len() - 1;
        let value = |i: usize| self.extinctions[(i % width).min(last)][length - 1 - i / width];
        let values = (0..width * length).map(value).collect();
        let side = RANGE as f32;
        let space = Mat4::from_translation(Vec3::splat(-0.5 * side)) * Mat4::from_scale(Vec3::splat(side));
        Volume::new([width as u32, 1, length as u32], values, space).map_err(CommandError::failure)
    }

    /// What a form of map says, `DEPTHS` depths a place, places in order.
    fn found(
        &self,
        gpu: &Gpu,
        shaders: &Shaders,
        (form, coefficients): (Form, u32),
        places: &[f64],
    ) -> Result<Vec<f32>, CommandError> {
        let settings = MapSettings::new(form, coefficients, [self.width() as u32, 1]);
        let volume =
            VolumeTexture::new(gpu, &self.volume()?, 1.0, Reading::Nearest).map_err(CommandError::failure)?;
        let texels = self.width() as f64;
        let points: Vec<Vec3> = places
            .iter()
            .flat_map(|place| depths().map(move |depth| (place, depth)))
            .map(|(place, depth)| {
                let x = (place + 0.5) / texels * RANGE - 0.5 * RANGE;
                Vec3::new(x as f32, 0.0, (0.5 * RANGE - depth * RANGE) as f32)
            })
            .collect();
        answers((gpu, shaders), settings, &light()?, (&volume, Reading::Nearest), &points)
    }

    /// Exact transmittance of every ray at every depth.
    fn exact(&self) -> Vec<Vec<f64>> {
        parallel::rows(self.extinctions.len(), |ray| {
            let wide: Vec<f64> = self.extinctions[ray].iter().map(|value| f64::from(*value)).collect();
            let profile = Profile::of_steps(RANGE, &wide);
            depths().map(|depth| profile.transmittance(depth * RANGE)).collect()
        })
    }

    /// Mean absolute error of transmittance of each group of `group` rays in the middles of texels.
    pub fn errors(
        &self,
        gpu: &Gpu,
        shaders: &Shaders,
        form: (Form, u32),
        group: usize,
    ) -> Result<Vec<f64>, CommandError> {
        let places: Vec<f64> = (0..self.extinctions.len()).map(|ray| ray as f64).collect();
        let found = self.found(gpu, shaders, form, &places)?;
        Ok(group_means(&found, &self.exact().concat(), group * DEPTHS))
    }

    /// The same in and between the middles of neighbours within each group, where the mean of both transmittances is exact.
    pub fn filtered_errors(
        &self,
        gpu: &Gpu,
        shaders: &Shaders,
        form: (Form, u32),
        group: usize,
    ) -> Result<Vec<f64>, CommandError> {
        let exact = self.exact();
        let pairs: Vec<(usize, f64)> = (0..self.extinctions.len())
            .filter(|ray| ray % group + 1 < group)
            .flat_map(|ray| BETWEEN.map(|share| (ray, share)))
            .collect();
        let places: Vec<f64> = pairs.iter().map(|(ray, share)| *ray as f64 + share).collect();
        let truth: Vec<f64> =
            pairs.iter().flat_map(|(ray, share)| mixed(&exact[*ray], &exact[ray + 1], *share)).collect();
        let found = self.found(gpu, shaders, form, &places)?;
        Ok(group_means(&found, &truth, (group - 1) * BETWEEN.len() * DEPTHS))
    }
}

fn depths() -> impl Iterator<Item = f64> + Clone {
    (0..DEPTHS).map(|i| (i as f64 + 0.37) / DEPTHS as f64)
}

/// `a`, and `share` of it replaced by `b`.
fn mixed(a: &[f64], b: &[f64], share: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| (1.0 - share) * a + share * b).collect()
}

/// Mean absolute difference of each `length` values.
fn group_means(found: &[f32], exact: &[f64], length: usize) -> Vec<f64> {
    found
        .chunks(length)
        .zip(exact.chunks(length))
        .map(|(found, exact)| airlight_tests::error::mean_absolute(found, exact))
        .collect()
}

/// Transmittance at points, by a map of a volume.
pub fn answers(
    (gpu, shaders): (&Gpu, &Shaders),
    settings: MapSettings,
    light: &Light,
    (volume, reading): (&VolumeTexture, Reading),
    points: &[Vec3],
) -> Result<Vec<f32>, CommandError> {
    let map = TransmittanceMap::new(gpu, settings, light).map_err(CommandError::failure)?;
    let voxels = Voxels::new(gpu, shaders, settings, reading).map_err(CommandError::failure)?;
    let bound = voxels.bind(gpu, &map, volume).map_err(CommandError::failure)?;
    let query = Query::new(gpu, shaders, settings, false).map_err(CommandError::failure)?;
    let asked = query.bind(gpu, &map, points).map_err(CommandError::failure)?;
    let mut encoder = gpu.encoder();
    voxels.record(&mut encoder, &bound);
    query.record(&mut encoder, &asked).map_err(CommandError::failure)?;
    gpu.submit(encoder)?;
    asked.read(gpu).map_err(CommandError::failure)
}

/// A light that shines along −z through the range.
fn light() -> Result<Light, CommandError> {
    let half = 0.5 * RANGE as f32;
    let light = Light::directional(Vec3::Z, Vec3::ONE, Vec3::splat(-half), Vec3::splat(half))
        .map_err(CommandError::failure)?;
    let scale = Mat4::from_scale(Vec3::new(1.0 / half, 1.0 / half, -0.5 / half));
    let clip_from_world = Mat4::from_translation(Vec3::new(0.0, 0.0, 0.5)) * scale;
    Ok(Light { clip_from_world, world_from_clip: clip_from_world.inverse(), ..light })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_grows_away_from_the_light() -> Result<(), CommandError> {
        let light = light()?;
        let depth = |z| light.clip_from_world.project_point3(Vec3::new(0.0, 0.0, z)).z;
        assert!(depth(4.0).abs() < 1e-6 && (depth(-4.0) - 1.0).abs() < 1e-6);
        assert_eq!(light.direction, Vec3::Z);
        Ok(())
    }

    #[test]
    fn volumes_hold_a_column_a_ray_and_the_light_meets_its_first_step_first() -> Result<(), CommandError> {
        let volume = LightRays::new(vec![vec![1.0, 2.0, 3.0], vec![4.0, 5.0, 6.0]]).volume()?;
        assert_eq!(volume.size, [2, 1, 3]);
        assert_eq!(volume.values, [3.0, 6.0, 2.0, 5.0, 1.0, 4.0]);
        Ok(())
    }

    #[test]
    fn means_are_of_groups_and_mixtures_of_shares() {
        assert_eq!(group_means(&[1.0, 2.0, 5.0, 5.0], &[0.0, 0.0, 5.0, 3.0], 2), [1.5, 1.0]);
        assert_eq!(mixed(&[1.0, 0.0], &[0.0, 1.0], 0.25), [0.75, 0.25]);
    }
}
