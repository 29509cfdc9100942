// SPDX-License-Identifier: MIT OR Apache-2.0
//! Preconvolved light: an environment map as cones of every direction and eight angles gather it (Section 3.3.3, Eq. 3.9).

use crate::data::Environment;
use crate::gpu::{Gpu, GpuError};
use crate::pass::{Bound, Pass, PassError};
use crate::resource::{Sampler, Texture};
use crate::shaders::Shaders;
use wgpu::TextureFormat::{Rgba16Float, Rgba32Float};

/// Angles of cones: layer k of 8 has the half angle 90 degrees · (k + 1) / 8.
pub const CONE_LAYERS: u32 = 8;

/// Sides of octahedral maps that are offered, texels.
const SIDES: std::ops::RangeInclusive<u32> = 8..=512;
/// Width of the map that the exact form sums over.
const EXACT_WIDTH: u32 = 512;
/// Width of the first level that the sampled form reads: the nearest directions of a ring are two of its texels apart.
const SAMPLED_WIDTH: u32 = 256;
/// Levels of the sampled form, down to 8x4 texels: the farthest directions are 12 degrees apart.
const SAMPLED_LEVELS: u32 = 6;

/// Why light cannot be preconvolved.
#[derive(Debug, thiserror::Error)]
pub enum ConeLightError {
    /// The side of the octahedral maps.
    #[error("a side of {0} texels is impossible for the maps of cones: it must lie between 8 and 512")]
    Side(u32),
    /// The environment map is no latitude-longitude map of the whole sphere.
    #[error(
        "the environment map is {width}x{height}: a latitude-longitude map must be twice as wide as high (2:1)"
    )]
    Shape {
        /// Width in texels.
        width: u32,
        /// Height in texels.
        height: u32,
    },
    /// The environment map is larger than textures may be.
    #[error(
        "the environment map is {width}x{height}, but sides of more than {limit} texels are impossible on this device: reduce it"
    )]
    TooLarge {
        /// Width in texels.
        width: u32,
        /// Height in texels.
        height: u32,
        /// The device's limit.
        limit: u32,
    },
    /// A pass failed.
    #[error(transparent)]
    Pass(#[from] PassError),
    /// The device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// How light is preconvolved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ConeLightForm {
    /// Texels a side of the octahedral maps: 8 to 512. Odd ones filter better (`ambient/octahedral`).
    pub side: u32,
    /// Rings of each cone are sampled, for light that moves; otherwise all texels are summed.
    pub sampled: bool,
}

impl Default for ConeLightForm {
    fn default() -> Self {
        Self { side: 65, sampled: false }
    }
}

/// The light of an environment in cones, and the passes that make it.
pub struct ConeLight {
    form: ConeLightForm,
    /// `ambient/reduce_environment`.
    reduce: Pass,
    /// `ambient/convolve_cones`.
    convolve: Pass,
    around: Sampler,
    /// The environment as it is convolved, with its levels where it is sampled.
    radiance: Texture,
    /// L_c: [`CONE_LAYERS`] layers of `side` texels squared, rgba16float, as `ambient/cone_light` reads them.
    pub cones: Texture,
    /// The sampler for `cones`: linear.
    pub sampler: Sampler,
}

/// An environment map, bound: recorded again when its texels have changed.
pub struct ConeLightBound {
    reductions: Vec<(Bound, [u32; 3])>,
    convolution: Bound,
}

impl ConeLight {
    /// Preconvolves an environment map of any size of 2:1.
    ///
    /// # Errors
    /// [`ConeLightError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        environment: &Environment,
        form: ConeLightForm,
    ) -> Result<Self, ConeLightError> {
        let light = Self::unlit(gpu, shaders, form)?;
        light.set(gpu, environment)?;
        Ok(light)
    }

    /// Builds the passes; `cones` is black until [`ConeLight::set`] or [`ConeLight::record`].
    ///
    /// # Errors
    /// [`ConeLightError::Side`], [`ConeLightError::Pass`].
    pub fn unlit(gpu: &Gpu, shaders: &Shaders, form: ConeLightForm) -> Result<Self, ConeLightError> {
        if !SIDES.contains(&form.side) {
            return Err(ConeLightError::Side(form.side));
        }
        let (reduction, convolution) =
            if form.sampled { ("half", "sampled") } else { ("default", "default") };
        let (format, width, levels) = if form.sampled {
            (Rgba16Float, SAMPLED_WIDTH, SAMPLED_LEVELS)
        } else {
            (Rgba32Float, EXACT_WIDTH, 1)
        };
        let side = form.side;
        let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING;
        Ok(Self {
            form,
            reduce: Pass::compute(gpu, shaders, "ambient/reduce_environment", reduction)?,
            convolve: Pass::compute(gpu, shaders, "ambient/convolve_cones", convolution)?,
            around: Sampler::around(gpu),
            radiance: Texture::storage_levels(gpu, [width, width / 2], format, levels),
            cones: Texture::array(gpu, [side, side, CONE_LAYERS], Rgba16Float, usage),
            sampler: Sampler::linear(gpu),
        })
    }

    /// Whether an environment map has the shape that is needed, before there is a device.
    ///
    /// # Errors
    /// [`ConeLightError::Shape`].
    pub fn check(environment: &Environment) -> Result<(), ConeLightError> {
        let [width, height] = environment.size();
        check_shape(width, height)
    }

    /// How the light is preconvolved.
    pub fn form(&self) -> ConeLightForm {
        self.form
    }

    /// Preconvolves another environment map. Work is submitted, not awaited.
    ///
    /// # Errors
    /// [`ConeLightError`].
    pub fn set(&self, gpu: &Gpu, environment: &Environment) -> Result<(), ConeLightError> {
        let [width, height] = environment.size();
        check_shape(width, height)?;
        let limit = gpu.limits.max_texture_dimension_2d;
        check_limit(width, height, limit)?;
        let texture = environment_texture(gpu, environment)?;
        let bound = self.bind(gpu, &texture)?;
        let mut encoder = gpu.encoder();
        self.record(&mut encoder, &bound);
        Ok(gpu.submit(encoder)?)
    }

    /// Binds an environment map that lies on the device already: any float format, latitude-longitude as in
    /// [`crate::data::Environment`]. Texels that are negative or not finite count as black.
    ///
    /// # Errors
    /// [`ConeLightError::Shape`], [`ConeLightError::Pass`].
    pub fn bind(&self, gpu: &Gpu, environment: &Texture) -> Result<ConeLightBound, ConeLightError> {
        let [width, height, _] = environment.size();
        check_shape(width, height)?;
        let mut reductions = Vec::new();
        let mut source = environment.clone();
        for level in 0..self.radiance.raw.mip_level_count() {
            let reduced = self.radiance.of_level(level);
            let resources = [("environment", (&source).into()), ("reduced", (&reduced).into())];
            let [width, height, _] = self.radiance.size();
            reductions.push((self.reduce.bind(gpu, &resources)?, [width >> level, height >> level, 1]));
            source = reduced;
        }
        let resources = [
            ("radiance", (&self.radiance).into()),
            ("radiance_sampler", (&self.around).into()),
            ("cones", (&self.cones).into()),
        ];
        Ok(ConeLightBound { reductions, convolution: self.convolve.bind_known(gpu, &resources)? })
    }

    /// Records the reduction of the map and its convolution.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &ConeLightBound) {
        for (reduction, size) in &bound.reductions {
            self.reduce.dispatch(encoder, reduction, *size);
        }
        let [side, _, _] = self.cones.size();
        self.convolve.dispatch(encoder, &bound.convolution, [side * side, 1, 1]);
    }
}

/// An environment map on the device: rgba32float, linear RGB, no larger than textures may be.
///
/// # Errors
/// [`GpuError`].
pub fn environment_texture(gpu: &Gpu, environment: &Environment) -> Result<Texture, GpuError> {
    let usage = wgpu::TextureUsages::TEXTURE_BINDING;
    let texture = Texture::new(gpu, environment.size(), Rgba32Float, usage);
    let texels: Vec<f32> =
        environment.texels().iter().flat_map(|texel| [texel.x, texel.y, texel.z, 1.0]).collect();
    texture.write(gpu, &texels)?;
    Ok(texture)
}

fn check_limit(width: u32, height: u32, limit: u32) -> Result<(), ConeLightError> {
    if width > limit {
        return Err(ConeLightError::TooLarge { width, height, limit });
    }
    Ok(())
}

fn check_shape(width: u32, height: u32) -> Result<(), ConeLightError> {
    if height == 0 || width != 2 * height {
        return Err(ConeLightError::Shape { width, height });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_as_large_as_textures_can_be_are_taken_and_no_larger() {
        assert!(check_limit(8192, 4096, 8192).is_ok());
        let error = check_limit(8194, 4097, 8192).map_err(|error| error.to_string());
        assert!(error.is_err_and(|text| text.contains("8194x4097") && text.contains("8192 texels")));
    }
}
