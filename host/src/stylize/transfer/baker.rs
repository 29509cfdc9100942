// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions as textures: layers composed, constraints placed, key frames mixed.

use super::diffusion::Diffusion;
use super::{
    Blend, Color, Constraint, Keyed, Layer, PickScene, Place, Source, Transfer, TransferError, TransferImage,
    TransferSettings,
};
use crate::gpu::Gpu;
use crate::pass::Pass;
use crate::resource::{Buffer, Sampler, Texture};
use crate::scattering::light_resources;
use crate::shaders::Shaders;
use crate::stylize::error::check_size;
use encase::ShaderType;
use glam::{Vec2, Vec4};
use wgpu::TextureFormat::Rgba16Float;

/// The uniform `TransferLayer` of `stylize/tf_layers`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct TransferLayer {
    /// Colour of a solid layer and of a gradient's begin, premultiplied.
    pub first: Vec4,
    /// Colour of a gradient's end, premultiplied.
    pub second: Vec4,
    /// Where a gradient begins.
    pub from_position: Vec2,
    /// Where it ends.
    pub to_position: Vec2,
    /// 0 solid, 1 gradient, 2 picture.
    pub kind: u32,
    /// As [`Blend`] counts from 0.
    pub blend: u32,
    /// 0..1.
    pub opacity: f32,
    /// Padding.
    pub reserved: f32,
}

/// The uniform `TransferShare` of the pass `stylize/transfer_layer`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct TransferShare {
    /// Part of the second function, 0..1.
    pub second: f32,
    /// Padding.
    pub reserved_a: f32,
    /// Padding.
    pub reserved_b: f32,
    /// Padding.
    pub reserved_c: f32,
}

/// Turns descriptions of transfer functions into textures.
pub struct Baker {
    layer: Pass,
    mix: Pass,
    /// Without the mean distance of lit points; with it, from one shadow map and from several.
    picks: [Pass; 3],
    diffusion: Diffusion,
    sampler: Sampler,
}

impl Baker {
    /// Builds the passes.
    ///
    /// # Errors
    /// [`TransferError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, TransferError> {
        let build = |pass, permutation| Pass::compute(gpu, shaders, pass, permutation);
        let pick = |permutation| build("stylize/transfer", permutation);
        Ok(Self {
            layer: build("stylize/transfer_layer", "default")?,
            mix: build("stylize/transfer_layer", "mix")?,
            picks: [pick("pick")?, pick("pick_visible_depth")?, pick("pick_visible_depth_views")?],
            diffusion: Diffusion::new(gpu, shaders)?,
            sampler: Sampler::linear(gpu),
        })
    }

    /// The texture of a function: premultiplied linear RGBA, rgba16float. `scene`: what constraints with a pixel or a point
    /// refer to; none where there are none.
    ///
    /// # Errors
    /// [`TransferError`].
    pub fn bake(
        &self,
        gpu: &Gpu,
        transfer: &Transfer,
        scene: Option<&PickScene<'_>>,
    ) -> Result<Texture, TransferError> {
        transfer.check()?;
        let size = [transfer.size; 2];
        let empty = || Texture::storage(gpu, size, Rgba16Float);
        // New textures are zero: transparent.
        let mut below = empty();
        for (number, layer) in transfer.layers.iter().enumerate() {
            let mut encoder = gpu.encoder();
            let picture = match &layer.source {
                Source::Solid(_) | Source::Gradient(_) => Texture::storage(gpu, [1, 1], Rgba16Float),
                Source::Image(image) => upload(gpu, image)?,
                Source::Diffusion(constraints) => {
                    let key = |of| format!("layer[{number}].constraint[{of}]");
                    let placed =
                        self.place(gpu, &mut encoder, &transfer.settings, constraints, scene, &key)?;
                    let count = constraints.len() as u32;
                    self.diffusion.record(gpu, &mut encoder, &placed, count, transfer.size)?
                }
            };
            let composed = empty();
            let uniform = Buffer::uniform(gpu, &uniform(layer));
            let resources = [
                ("layer", (&uniform).into()),
                ("below", (&below).into()),
                ("picture", (&picture).into()),
                ("picture_sampler", (&self.sampler).into()),
                ("composed", (&composed).into()),
            ];
            let bound = self.layer.bind(gpu, &resources)?;
            self.layer.dispatch(&mut encoder, &bound, [transfer.size, transfer.size, 1]);
            gpu.submit(encoder)?;
            below = composed;
        }
        Ok(below)
    }

    /// The texture of a key-framed function at a frame.
    ///
    /// # Errors
    /// [`TransferError`].
    pub fn bake_frame(
        &self,
        gpu: &Gpu,
        keyed: &Keyed<Transfer>,
        frame: f32,
        scene: Option<&PickScene<'_>>,
    ) -> Result<Texture, TransferError> {
        let (before, after, share) = keyed.around(frame);
        if share <= 0.0 {
            return self.bake(gpu, before, scene);
        }
        let textures = [self.bake(gpu, before, scene)?, self.bake(gpu, after, scene)?];
        self.mix(gpu, &textures[0], &textures[1], share)
    }

    /// The textures of all key frames, to be mixed by [`Baker::mix_frame`] in every frame: for functions whose constraints
    /// do not depend on the picture.
    ///
    /// # Errors
    /// [`TransferError`].
    pub fn bake_keys(
        &self,
        gpu: &Gpu,
        keyed: &Keyed<Transfer>,
        scene: Option<&PickScene<'_>>,
    ) -> Result<Keyed<Texture>, TransferError> {
        keyed.try_map(|transfer| self.bake(gpu, transfer, scene))
    }

    /// The texture at a frame, from those of the key frames.
    ///
    /// # Errors
    /// [`TransferError`].
    pub fn mix_frame(&self, gpu: &Gpu, keyed: &Keyed<Texture>, frame: f32) -> Result<Texture, TransferError> {
        let (before, after, share) = keyed.around(frame);
        self.mix(gpu, before, after, share)
    }

    /// The mean of two functions of the same size, `share` 0..1 of the second.
    ///
    /// # Errors
    /// [`TransferError`].
    pub fn mix(
        &self,
        gpu: &Gpu,
        first: &Texture,
        second: &Texture,
        share: f32,
    ) -> Result<Texture, TransferError> {
        let [[width, height, _], [wide, high, _]] = [first.size(), second.size()];
        if [width, height] != [wide, high] {
            let (given, expected) = ([wide, high], [width, height]);
            return Err(TransferError::OtherSize { what: "a key frame's function", given, expected });
        }
        let composed = Texture::storage(gpu, [width, height], Rgba16Float);
        let share = TransferShare { second: share, reserved_a: 0.0, reserved_b: 0.0, reserved_c: 0.0 };
        let share = Buffer::uniform(gpu, &share);
        let resources = [
            ("share", (&share).into()),
            ("below", first.into()),
            ("picture", second.into()),
            ("picture_sampler", (&self.sampler).into()),
            ("composed", (&composed).into()),
        ];
        let bound = self.mix.bind(gpu, &resources)?;
        let mut encoder = gpu.encoder();
        self.mix.dispatch(&mut encoder, &bound, [width, height, 1]);
        gpu.submit(encoder)?;
        Ok(composed)
    }

    /// Where pixels and points of a scene lie in a function of `settings`, 0..1 in x and y.
    ///
    /// # Errors
    /// [`TransferError`], as for a pixel outside the picture.
    pub fn positions(
        &self,
        gpu: &Gpu,
        settings: &TransferSettings,
        places: &[Place],
        scene: &PickScene<'_>,
    ) -> Result<Vec<Vec2>, TransferError> {
        if places.is_empty() {
            return Ok(Vec::new());
        }
        let color = Color { rgb: glam::Vec3::ZERO, alpha: 0.0 };
        let constraints: Vec<_> =
            places.iter().map(|place| Constraint { place: place.clone(), color }).collect();
        let mut encoder = gpu.encoder();
        let key = |of| format!("pick {}", of + 1);
        let placed = self.place(gpu, &mut encoder, settings, &constraints, Some(scene), &key)?;
        gpu.submit(encoder)?;
        let floats = placed.read_floats(gpu)?;
        Ok(floats.chunks_exact(FLOATS).map(|record| Vec2::new(record[4], record[5])).collect())
    }

    /// The constraints on the GPU, those that name a pixel or a point moved to where that lies; nothing is read back.
    fn place(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        settings: &TransferSettings,
        constraints: &[Constraint],
        scene: Option<&PickScene<'_>>,
        key: &dyn Fn(usize) -> String,
    ) -> Result<Buffer, TransferError> {
        let mut floats = Vec::new();
        let mut picks = false;
        for (number, constraint) in constraints.iter().enumerate() {
            let key = key(number);
            let (position, pixel) = match (&constraint.place, scene) {
                (Place::At(position), _) => (*position, Vec2::NEG_ONE),
                (_, None) => return Err(TransferError::NeedsScene { key }),
                (place, Some(scene)) => {
                    let [x, y] = scene.pixel(place, &key)?.unwrap_or([0, 0]);
                    picks = true;
                    (Vec2::ZERO, Vec2::new(x as f32, y as f32))
                }
            };
            floats.extend(constraint.color.premultiplied().to_array());
            floats.extend([position.x, position.y, pixel.x, pixel.y]);
        }
        let bytes: Vec<u8> = floats.iter().flat_map(|value| value.to_le_bytes()).collect();
        let buffer = Buffer::with_bytes(gpu, &bytes, wgpu::BufferUsages::STORAGE);
        if let Some(scene) = scene.filter(|_| picks) {
            self.pick(gpu, encoder, settings, &buffer, constraints.len() as u32, scene)?;
        }
        Ok(buffer)
    }

    fn pick(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        settings: &TransferSettings,
        constraints: &Buffer,
        count: u32,
        scene: &PickScene<'_>,
    ) -> Result<(), TransferError> {
        let function = settings.function(scene.medium);
        let uniform = Buffer::uniform(gpu, &function);
        let inputs = &scene.inputs;
        let mut resources = vec![
            ("camera", inputs.camera.into()),
            ("light", inputs.light.into()),
            ("transfer_function", (&uniform).into()),
            ("depth", inputs.depth.into()),
            ("scattered", scene.scattered.into()),
            ("constraints", constraints.into()),
        ];
        resources.extend(light_resources(inputs, &self.sampler));
        let pass = &self.picks[function.permutation(inputs.shadow_views.is_some())];
        let bound = pass.bind_known(gpu, &resources)?;
        pass.dispatch(encoder, &bound, [count, 1, 1]);
        Ok(())
    }
}

/// Floats of a constraint on the GPU.
const FLOATS: usize = 8;

fn uniform(layer: &Layer) -> TransferLayer {
    let [mut first, mut second] = [Vec4::ZERO; 2];
    let [mut from_position, mut to_position] = [Vec2::ZERO; 2];
    let kind = match &layer.source {
        Source::Solid(color) => {
            first = color.premultiplied();
            0
        }
        Source::Gradient([from, to]) => {
            (from_position, first) = (from.0, from.1.premultiplied());
            (to_position, second) = (to.0, to.1.premultiplied());
            1
        }
        Source::Image(_) | Source::Diffusion(_) => 2,
    };
    let blend = match layer.blend {
        Blend::Over => 0,
        Blend::Multiply => 1,
        Blend::Add => 2,
    };
    TransferLayer {
        first,
        second,
        from_position,
        to_position,
        kind,
        blend,
        opacity: layer.opacity,
        reserved: 0.0,
    }
}

fn upload(gpu: &Gpu, image: &TransferImage) -> Result<Texture, TransferError> {
    check_size(gpu, "an image of a transfer function", image.size)?;
    let texture = Texture::new(gpu, image.size, Rgba16Float, wgpu::TextureUsages::TEXTURE_BINDING);
    let values: Vec<f32> = image.texels.iter().flat_map(Vec4::to_array).collect();
    texture.write(gpu, &values)?;
    Ok(texture)
}
