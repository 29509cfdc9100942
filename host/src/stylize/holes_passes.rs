// SPDX-License-Identifier: MIT OR Apache-2.0
//! The passes `stylize/punch_holes` and `stylize/hole_mask`.

use super::error::check_size;
use super::{HoleParameters, StylizeError};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use wgpu::TextureFormat::R32Float;

/// Makes holes in the shadow map of an object, and puts it together with that of the rest of the scene.
pub struct PunchHoles {
    alone: Pass,
    with_rest: Pass,
    parameters: Buffer,
    /// The shadow map with holes: r32float.
    pub punched: Texture,
}

/// The maps of an object and of the rest, bound.
pub struct PunchHolesBound {
    bound: Bound,
    with_rest: bool,
}

impl PunchHoles {
    /// Builds the pass for shadow maps of `size` texels. Several objects take one each, and the result for one is the rest
    /// for the next.
    ///
    /// # Errors
    /// [`StylizeError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        parameters: &HoleParameters,
        size: [u32; 2],
    ) -> Result<Self, StylizeError> {
        parameters.validate()?;
        check_size(gpu, "a shadow map", size)?;
        Ok(Self {
            alone: Pass::compute(gpu, shaders, "stylize/punch_holes", "default")?,
            with_rest: Pass::compute(gpu, shaders, "stylize/punch_holes", "rest")?,
            parameters: Buffer::uniform(gpu, parameters),
            punched: Texture::storage(gpu, size, R32Float),
        })
    }

    /// Takes other parameters, as those of another time.
    ///
    /// # Errors
    /// [`StylizeError`].
    pub fn set(&self, gpu: &Gpu, parameters: &HoleParameters) -> Result<(), StylizeError> {
        write(gpu, &self.parameters, parameters)
    }

    /// Binds the shadow map of the object alone, and that of the rest of the scene, if there is any: depth formats or
    /// r32float.
    ///
    /// # Errors
    /// [`StylizeError`].
    pub fn bind(
        &self,
        gpu: &Gpu,
        object: &Texture,
        rest: Option<&Texture>,
    ) -> Result<PunchHolesBound, StylizeError> {
        let [width, height, _] = self.punched.size();
        for map in [Some(object), rest].into_iter().flatten() {
            let [given_width, given_height, _] = map.size();
            if [given_width, given_height] != [width, height] {
                let given = [given_width, given_height];
                return Err(StylizeError::OtherSize { given, expected: [width, height] });
            }
        }
        let mut resources = vec![
            ("holes", (&self.parameters).into()),
            ("object", object.into()),
            ("punched", (&self.punched).into()),
        ];
        resources.extend(rest.map(|rest| ("rest", rest.into())));
        let pass = if rest.is_some() { &self.with_rest } else { &self.alone };
        Ok(PunchHolesBound { bound: pass.bind(gpu, &resources)?, with_rest: rest.is_some() })
    }

    /// Records the holes.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &PunchHolesBound) {
        let pass = if bound.with_rest { &self.with_rest } else { &self.alone };
        let [width, height, _] = self.punched.size();
        pass.dispatch(encoder, &bound.bound, [width, height, 1]);
    }
}

/// What is written of holes by themselves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum HolePicture {
    /// 1 in a hole, else 0.
    #[default]
    Mask,
    /// The noise before it is thresholded, 0..1.
    Noise,
}

/// The mask of holes by itself, to look at.
pub struct HoleMask {
    pass: Pass,
    bound: Bound,
    parameters: Buffer,
    /// The picture: r32float.
    pub mask: Texture,
}

impl HoleMask {
    /// Builds the pass for a mask of `size` texels.
    ///
    /// # Errors
    /// [`StylizeError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        picture: HolePicture,
        parameters: &HoleParameters,
        size: [u32; 2],
    ) -> Result<Self, StylizeError> {
        parameters.validate()?;
        check_size(gpu, "a shadow map", size)?;
        let permutation = match picture {
            HolePicture::Mask => "default",
            HolePicture::Noise => "noise",
        };
        let pass = Pass::compute(gpu, shaders, "stylize/hole_mask", permutation)?;
        let parameters = Buffer::uniform(gpu, parameters);
        let mask = Texture::storage(gpu, size, R32Float);
        let bound = pass.bind(gpu, &[("holes", (&parameters).into()), ("mask", (&mask).into())])?;
        Ok(Self { pass, bound, parameters, mask })
    }

    /// Takes other parameters, as those of another time.
    ///
    /// # Errors
    /// [`StylizeError`].
    pub fn set(&self, gpu: &Gpu, parameters: &HoleParameters) -> Result<(), StylizeError> {
        write(gpu, &self.parameters, parameters)
    }

    /// Records the mask.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        let [width, height, _] = self.mask.size();
        self.pass.dispatch(encoder, &self.bound, [width, height, 1]);
    }
}

fn write(gpu: &Gpu, buffer: &Buffer, parameters: &HoleParameters) -> Result<(), StylizeError> {
    parameters.validate()?;
    buffer.write(gpu, parameters);
    gpu.check().map_err(|error| StylizeError::Pass(error.into()))
}
