// SPDX-License-Identifier: MIT OR Apache-2.0
//! The shadow maps of every eye through holes and operators, and scattering bound to them.

use super::Options;
use crate::command::CommandError;
use crate::command::scattering::{Buffers, Shafts, whole};
use crate::command::sequence::{FrameRange, RATE};
use crate::data::Mesh;
use crate::scattering::{Inputs, ViewsBound};
use crate::stage::PartShadows;
use crate::stylize::{
    HoleMask, HoleParameters, HolePicture, ShadowMaps, ShadowOperator, ShadowStyle, StylizedShadows,
};
use glam::Mat4;

/// Shadow maps of the object with holes, and of the rest if there is any.
struct Parts {
    object: PartShadows,
    rest: Option<PartShadows>,
}

/// What was built for the operators of a frame.
struct Built {
    operators: Vec<ShadowOperator>,
    /// Of each eye.
    stylized: Vec<StylizedShadows>,
    bound: ViewsBound,
}

/// The shadow maps that scattering reads.
pub struct Shadows<'a> {
    options: &'a Options,
    shafts: &'a Shafts,
    first: u32,
    /// Of every frame; none without holes.
    holes: Vec<Vec<HoleParameters>>,
    /// Of each eye, where not everything has holes.
    parts: Vec<Parts>,
    built: Option<Built>,
    /// The holes of the last frame.
    shown: Vec<HoleParameters>,
}

impl<'a> Shadows<'a> {
    /// Draws the parts that holes need, and finds the holes of all frames.
    ///
    /// # Errors
    /// Misuse: holes that cannot be made at their size.
    pub fn new(
        options: &'a Options,
        shafts: &'a Shafts,
        meshes: &[Mesh],
        frames: FrameRange,
    ) -> Result<Self, CommandError> {
        let mut all = Self {
            options,
            shafts,
            first: frames.first,
            holes: Vec::new(),
            parts: Vec::new(),
            built: None,
            shown: Vec::new(),
        };
        let Some(keyed) = &options.holes else { return Ok(all) };
        let named = |file| options.holes_on.is_empty() || options.holes_on.contains(file);
        let files = || options.scattering.mesh.iter().zip(meshes);
        let object = whole(files().filter(|(file, _)| named(file)).map(|(_, mesh)| mesh));
        let rest = whole(files().filter(|(file, _)| !named(file)).map(|(_, mesh)| mesh));
        let bounds = object.bounds();
        let bounds = bounds.ok_or_else(|| CommandError::failure("--holes-on: nothing to make holes in"))?;
        let light = &shafts.eyes[0].stage.light;
        let rate = options.rate.unwrap_or(RATE);
        for frame in (0..frames.count).map(|index| frames.first + index) {
            let holes = keyed.parameters(frame, rate, light, &all.matrices(0), &bounds);
            all.holes.push(holes.map_err(|error| CommandError::misuse("--holes", error))?);
        }
        if rest.bounds().is_some() {
            for eye in &shafts.eyes {
                let drawn = |mesh| eye.stage.shadows_of(&shafts.gpu, &shafts.raster, mesh);
                all.parts.push(Parts { object: drawn(&object)?, rest: Some(drawn(&rest)?) });
            }
        }
        Ok(all)
    }

    /// Matrices of the maps that an eye's scattering reads.
    fn matrices(&self, eye: usize) -> Vec<Mat4> {
        let stage = &self.shafts.eyes[eye].stage;
        StylizedShadows::matrices(&stage.light, stage.views.as_ref())
    }

    /// Takes the holes and the operators of a frame. Passes are built anew where a width is another one.
    ///
    /// # Errors
    /// [`CommandError`].
    pub fn set(&mut self, frame: u32) -> Result<(), CommandError> {
        let none = Vec::new();
        let holes = self.holes.get(frame.saturating_sub(self.first) as usize).unwrap_or(&none).clone();
        let operators = self.options.operators(frame as f32);
        match &self.built {
            Some(built) if built.operators == operators => {
                for stylized in &built.stylized {
                    stylized.set_holes(&self.shafts.gpu, &holes)?;
                }
            }
            _ => self.built = Some(self.build(&holes, operators)?),
        }
        self.shown = holes;
        Ok(())
    }

    fn build(&self, holes: &[HoleParameters], operators: Vec<ShadowOperator>) -> Result<Built, CommandError> {
        let Shafts { gpu, shaders, eyes, views, .. } = self.shafts;
        let style = ShadowStyle { holes, operators: &operators };
        let mut stylized = Vec::new();
        for (index, eye) in eyes.iter().enumerate() {
            let inputs = eye.inputs();
            let (maps, rest) = match self.parts.get(index) {
                Some(Parts { object, rest }) => {
                    (ShadowMaps::of_part(object), rest.as_ref().map(ShadowMaps::of_part))
                }
                None => (ShadowMaps::of(&inputs), None),
            };
            let seen = (&eye.stage.camera, &self.matrices(index)[..]);
            stylized.push(StylizedShadows::new(gpu, shaders, &style, seen, maps, rest)?);
        }
        let changed = eyes.iter().zip(&stylized).map(|(eye, stylized)| stylized.inputs(&eye.inputs()));
        let bound = views.bind(gpu, &changed.collect::<Vec<_>>())?;
        Ok(Built { operators, stylized, bound })
    }

    /// Records the shadow maps, and the light shafts from them.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(built) = &self.built {
            built.stylized.iter().for_each(|stylized| stylized.record(encoder));
            self.shafts.views.record(encoder, &built.bound);
        }
    }

    /// What an eye's scattering is given.
    pub fn inputs(&self, eye: usize) -> Inputs<'_> {
        let inputs = self.shafts.eyes[eye].inputs();
        match &self.built {
            Some(built) => built.stylized[eye].inputs(&inputs),
            None => inputs,
        }
    }

    /// Reads the maps of an eye that were changed.
    ///
    /// # Errors
    /// [`CommandError`].
    pub fn buffers(&self, buffers: &mut Buffers, prefix: &str, eye: usize) -> Result<(), CommandError> {
        let Some(built) = &self.built else { return Ok(()) };
        if built.operators.is_empty() && self.shown.is_empty() {
            return Ok(());
        }
        let several = self.shafts.eyes[eye].inputs().shadow_maps.is_some();
        let name = if several { "stylized_shadow_maps" } else { "stylized_shadow_map" };
        buffers.texture(&self.shafts.gpu, &format!("{prefix}{name}"), &built.stylized[eye].stylized)
    }

    /// Reads the masks of the holes, a layer for each map.
    ///
    /// # Errors
    /// [`CommandError`].
    pub fn masks(&self, buffers: &mut Buffers) -> Result<(), CommandError> {
        let Shafts { gpu, shaders, .. } = self.shafts;
        let inputs = self.shafts.eyes[0].inputs();
        let [width, height, _] = inputs.shadow_maps.unwrap_or(inputs.shadow_map).size();
        let mut encoder = gpu.encoder();
        let mut masks = Vec::new();
        for holes in &self.shown {
            let mask = HoleMask::new(gpu, shaders, HolePicture::Mask, holes, [width, height])?;
            mask.record(&mut encoder);
            masks.push(mask);
        }
        gpu.submit(encoder)?;
        let pictures: Vec<_> = masks.iter().map(|mask| &mask.mask).collect();
        buffers.layers(gpu, "hole_mask", &pictures)
    }
}
