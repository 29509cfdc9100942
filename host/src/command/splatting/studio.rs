// SPDX-License-Identifier: MIT OR Apache-2.0
//! The picture, frame by frame.

use super::flags::Options;
use super::framing::Framing;
use crate::command::CommandError;
use crate::command::scattering::Buffers;
use crate::command::sky::behind;
use crate::core::POINT;
use crate::splatting::{SheetFrame, SheetPicture, Sheets};
use crate::transmittance::Composite;
use crate::{Gpu, Shaders, Texture};

/// Everything that draws frames.
pub struct Studio<'a> {
    /// The device and the shaders.
    pub device: (&'a Gpu, &'a Shaders),
    /// The flags.
    pub options: &'a Options,
    /// Light and eye.
    pub framing: &'a Framing,
    /// The sheets.
    pub picture: SheetPicture<'a>,
    /// What puts the medium over what lies behind.
    pub composite: Composite,
}

/// What was drawn of a frame.
pub struct Drawn {
    /// The medium over what lies behind it.
    pub composed: Texture,
    background: Texture,
    /// How sheets lay.
    pub sheets: Sheets,
}

impl Studio<'_> {
    /// Draws a frame.
    ///
    /// # Errors
    /// Misuse: an impossible camera. A failure of the device.
    pub fn draw(&self, frame: u32) -> Result<Drawn, CommandError> {
        let Self { device: (gpu, shaders), options, framing, picture, composite } = self;
        let camera = framing.camera(options, frame)?;
        let (light, lighting) = (framing.light, framing.lighting);
        let sheets = picture.set(gpu, &SheetFrame { camera, light, lighting })?;
        let mut encoder = gpu.encoder();
        picture.record(gpu, &mut encoder)?;
        gpu.submit(encoder)?;
        let background = behind((gpu, shaders), &camera, &light, options.background)?.surface;
        let composed = composite.run(gpu, &background, &picture.picture)?;
        Ok(Drawn { composed, background, sheets })
    }

    /// What was on the way to the last frame.
    ///
    /// # Errors
    /// A failure of the device.
    pub fn buffers(&self, drawn: &Drawn) -> Result<Buffers, CommandError> {
        let gpu = self.device.0;
        let mut buffers = Buffers::default();
        buffers.texture(gpu, "medium", &self.picture.picture)?;
        buffers.texture(gpu, "light_left", self.picture.shadow())?;
        buffers.texture(gpu, "background", &drawn.background)?;
        buffers.texture(gpu, "composed", &drawn.composed)?;
        Ok(buffers)
    }

    /// That a light at a point lies beside some of the sheets.
    pub fn warning(&self, sheets: &Sheets) -> Option<String> {
        let light = &self.framing.light;
        let beside = light.kind == POINT && sheets.normal.dot(light.position) > sheets.first;
        beside.then(|| {
            let position = light.position;
            format!(
                "--light: the light at {position} lies beside some of the sheets, which it does not meet in their order: \
                 shadows are wrong there; move it away, or the eye"
            )
        })
    }
}
