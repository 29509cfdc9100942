// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every shadow map of a light, with holes and through operators, in the place of those that the engine drew.

use super::{
    Element, EpipolarBound, EpipolarMorphology, EpipolarSettings, Epipole, Form, HoleParameters, Morphology,
    MorphologyBound, MorphologySettings, Operator, PunchHoles, PunchHolesBound, StylizeError, Width,
};
use crate::core::{Camera, DepthRange, Light, ShadowViews};
use crate::gpu::Gpu;
use crate::resource::Texture;
use crate::scattering::Inputs;
use crate::shaders::Shaders;
use crate::stage::PartShadows;
use glam::Mat4;
use wgpu::TextureFormat::R32Float;

/// What is done to the blockers of a light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShadowOperator {
    /// Across the shadow map.
    Across {
        /// The operator.
        operator: Operator,
        /// The structuring element.
        element: Element,
        /// Its width.
        width: Width,
    },
    /// Along view rays: new blockers are hidden from the camera.
    Along {
        /// The operator. A dilation extrudes blockers.
        operator: Operator,
        /// How lines are taken.
        form: Form,
        /// Texels of the kernel.
        width: Width,
    },
}

/// Holes, then operators in their order, over every shadow map of a light. Depth is forward, as [`crate::core::Raster`]
/// draws it.
#[derive(Debug, Clone, Copy)]
pub struct ShadowStyle<'a> {
    /// For each map the holes of the object (see [`StylizedShadows::matrices`]); none for no holes.
    pub holes: &'a [HoleParameters],
    /// The operators. Widths are texels of each map.
    pub operators: &'a [ShadowOperator],
}

/// A shadow map, or an array of them.
#[derive(Clone, Copy)]
pub struct ShadowMaps<'a> {
    /// The standard shadow map.
    pub shadow_map: &'a Texture,
    /// The array of the views, which then is read instead.
    pub shadow_maps: Option<&'a Texture>,
}

impl<'a> ShadowMaps<'a> {
    /// Those that an engine drew.
    pub fn of(inputs: &Inputs<'a>) -> Self {
        Self { shadow_map: inputs.shadow_map, shadow_maps: inputs.shadow_maps }
    }

    /// Those of a part of the scene.
    pub fn of_part(shadows: &'a PartShadows) -> Self {
        Self { shadow_map: &shadows.shadow_map, shadow_maps: shadows.shadow_maps.as_ref() }
    }

    /// A texture for each map.
    fn layers(&self) -> Vec<Texture> {
        match self.shadow_maps {
            Some(maps) => (0..maps.size()[2]).map(|layer| maps.of_layer(layer)).collect(),
            None => vec![self.shadow_map.of_layer(0)],
        }
    }
}

enum Change {
    Holes(PunchHoles, PunchHolesBound),
    Across(Morphology, MorphologyBound),
    Along(EpipolarMorphology, EpipolarBound),
}

impl Change {
    fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        match self {
            Self::Holes(pass, bound) => pass.record(encoder, bound),
            Self::Across(passes, bound) => passes.record(encoder, bound),
            Self::Along(passes, bound) => passes.record(encoder, bound),
        }
    }

    fn changed(&self) -> &Texture {
        match self {
            Self::Holes(pass, _) => &pass.punched,
            Self::Across(passes, _) => &passes.morphed,
            Self::Along(passes, _) => &passes.morphed,
        }
    }
}

/// The shadow maps of a light as scattering is to see them. Surfaces keep the maps that were drawn.
pub struct StylizedShadows {
    /// For each map its changes in order.
    layers: Vec<Vec<Change>>,
    /// What changed: r32float, an array where the maps are one.
    pub stylized: Texture,
}

impl StylizedShadows {
    /// The matrices of the maps that a light's scattering reads, in order: of its views, else of its one map.
    pub fn matrices(light: &Light, views: Option<&ShadowViews>) -> Vec<Mat4> {
        match views {
            Some(views) => views.clip_from_world[..views.count.min(6) as usize].to_vec(),
            None => vec![light.clip_from_world],
        }
    }

    /// Builds all passes and binds them. `matrices`: of the maps, see [`StylizedShadows::matrices`]; `maps`: of all blockers,
    /// or with holes of the object that they are made in; `rest`: then those of everything else, if there is anything else.
    ///
    /// # Errors
    /// [`StylizeError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        style: &ShadowStyle<'_>,
        (camera, matrices): (&Camera, &[Mat4]),
        maps: ShadowMaps<'_>,
        rest: Option<ShadowMaps<'_>>,
    ) -> Result<Self, StylizeError> {
        let sources = maps.layers();
        let rest = rest.map(|rest| rest.layers());
        let [width, height, _] = sources[0].size();
        let (given, expected) = (matrices.len(), sources.len());
        if given != expected || !(style.holes.is_empty() || style.holes.len() == expected) {
            return Err(StylizeError::Maps { matrices: given, holes: style.holes.len(), expected });
        }
        let mut layers = Vec::new();
        for (layer, (source, matrix)) in sources.iter().zip(matrices).enumerate() {
            let mut changes: Vec<Change> = Vec::new();
            if let Some(holes) = style.holes.get(layer) {
                let pass = PunchHoles::new(gpu, shaders, holes, [width, height])?;
                let rest = rest.as_ref().and_then(|rest| rest.get(layer));
                let bound = pass.bind(gpu, source, rest)?;
                changes.push(Change::Holes(pass, bound));
            }
            for operator in style.operators {
                let from = changes.last().map_or(source, Change::changed);
                let change = change(gpu, shaders, operator, (camera, matrix), from)?;
                changes.push(change);
            }
            layers.push(changes);
        }
        let stylized = match maps.shadow_maps {
            Some(maps) => Texture::array(gpu, maps.size(), R32Float, wgpu::TextureUsages::TEXTURE_BINDING),
            None => Texture::new(gpu, [width, height], R32Float, wgpu::TextureUsages::TEXTURE_BINDING),
        };
        Ok(Self { layers, stylized })
    }

    /// Takes other holes, one for each map.
    ///
    /// # Errors
    /// [`StylizeError`].
    pub fn set_holes(&self, gpu: &Gpu, holes: &[HoleParameters]) -> Result<(), StylizeError> {
        for (changes, holes) in self.layers.iter().zip(holes) {
            for change in changes {
                if let Change::Holes(pass, _) = change {
                    pass.set(gpu, holes)?;
                }
            }
        }
        Ok(())
    }

    /// Records all changes.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        for (layer, changes) in self.layers.iter().enumerate() {
            changes.iter().for_each(|change| change.record(encoder));
            let Some(last) = changes.last() else { continue };
            let mut to = self.stylized.raw.as_image_copy();
            to.origin.z = layer as u32;
            let size = wgpu::Extent3d { depth_or_array_layers: 1, ..self.stylized.raw.size() };
            encoder.copy_texture_to_texture(last.changed().raw.as_image_copy(), to, size);
        }
    }

    /// What scattering is given: what the engine drew, with these shadow maps. Nothing to change, nothing is changed.
    pub fn inputs<'a>(&'a self, inputs: &Inputs<'a>) -> Inputs<'a> {
        if self.layers.iter().all(Vec::is_empty) {
            return *inputs;
        }
        match inputs.shadow_maps {
            Some(_) => Inputs { shadow_maps: Some(&self.stylized), ..*inputs },
            None => Inputs { shadow_map: &self.stylized, ..*inputs },
        }
    }
}

fn change(
    gpu: &Gpu,
    shaders: &Shaders,
    operator: &ShadowOperator,
    (camera, matrix): (&Camera, &Mat4),
    from: &Texture,
) -> Result<Change, StylizeError> {
    let [width, height, _] = from.size();
    let (size, depth) = ([width, height], DepthRange::Forward);
    Ok(match *operator {
        ShadowOperator::Across { operator, element, width } => {
            let settings = MorphologySettings { operator, element, width, depth };
            let passes = Morphology::new(gpu, shaders, settings, size)?;
            let bound = passes.bind(gpu, from)?;
            Change::Across(passes, bound)
        }
        ShadowOperator::Along { operator, form, width } => {
            let settings = EpipolarSettings { operator, form, width, depth };
            let epipole = Epipole::in_map(matrix.as_dmat4(), Epipole::eye(camera), size)?;
            let passes = EpipolarMorphology::new(gpu, shaders, settings, &epipole, size)?;
            let bound = passes.bind(gpu, from)?;
            Change::Along(passes, bound)
        }
    })
}
