// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light shafts of several views in one call: the two eyes of a headset, the faces of a cube.

use super::{
    Along, Inputs, Interpolated, LightForm, March, Prefiltered, PrefilteredBound, Projective, ProjectiveMap,
    ProjectivePrefiltered, ProjectivePrefilteredBound, Reduced, Resolution, ScatteringError, Settings,
    SettingsError, Start, Upsample, Weighting,
};
use crate::core::{Camera, Jitter};
use crate::gpu::Gpu;
use crate::pass::{Bound, PassError};
use crate::resource::Texture;
use crate::shaders::Shaders;

/// How the light shafts of a view are found.
#[derive(Clone, Debug, PartialEq)]
pub enum Method {
    /// Prefiltered bases over epipolar rows: any light, perspective cameras.
    Epipolar(Settings),
    /// Prefiltered bases over projective rows: a plain directional light. The rows are those of the view's camera,
    /// reduced where its resolution is.
    Projective(Settings, Box<Projective>),
    /// A march through the shadow maps: any light, any camera.
    March {
        /// The kind of light.
        form: LightForm,
        /// Steps a ray, at least 1.
        steps: u32,
        /// How visibility is averaged.
        weighting: Weighting,
        /// How samples are shifted; only for a plain directional light.
        jitter: Jitter,
        /// Number of the frame, for jitter.
        frame: u32,
    },
}

impl Method {
    /// What a reduced picture of this method is interpolated by. `camera`: of the view.
    pub fn interpolated(&self, camera: &Camera) -> Interpolated {
        let (form, start) = match self {
            Self::Epipolar(settings) | Self::Projective(settings, _) => (settings.light, settings.start),
            Self::March { form, .. } => (*form, Start::Eye),
        };
        // An orthographic ray begins at the near plane, and so does its distance.
        let skips = start == Start::NearPlane && camera.projection == 0;
        if form.local() || form.texture || skips { Interpolated::Radiance } else { Interpolated::Visibility }
    }
}

/// A view: its camera, how many of its pixels are evaluated, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewSettings {
    /// The camera of the full picture.
    pub camera: Camera,
    /// None for every pixel.
    pub resolution: Option<Resolution>,
    /// How its light shafts are found.
    pub method: Method,
}

/// The passes and textures of one method.
pub enum ViewPasses {
    /// See [`Method::Epipolar`].
    Epipolar(Box<Prefiltered>),
    /// See [`Method::Projective`].
    Projective(Box<ProjectivePrefiltered>),
    /// See [`Method::March`].
    March {
        /// The march.
        march: Box<March>,
        /// Steps a ray.
        steps: u32,
    },
}

enum MethodBound {
    Epipolar(PrefilteredBound),
    Projective(ProjectivePrefilteredBound),
    March(Bound),
}

impl ViewPasses {
    fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        method: &Method,
        viewport: [u32; 2],
    ) -> Result<Self, ScatteringError> {
        Ok(match method {
            Method::Epipolar(settings) => {
                Self::Epipolar(Box::new(Prefiltered::new(gpu, shaders, *settings, viewport)?))
            }
            Method::Projective(settings, projective) => {
                let map = ProjectiveMap::resampled(gpu, shaders, settings.map)?;
                let made = ProjectivePrefiltered::new(gpu, shaders, map, *settings, viewport)?;
                made.write(gpu, projective)?;
                Self::Projective(Box::new(made))
            }
            Method::March { form, steps, weighting, jitter, frame } => {
                let march = if form.plain() {
                    let along = Along::ShadowMap { steps: *steps };
                    March::jittered(gpu, shaders, &along, *weighting, *jitter, viewport)?
                } else if *jitter == Jitter::None {
                    March::of_light(gpu, shaders, *form, *steps, *weighting, viewport)?
                } else {
                    return Err(SettingsError::LightForm(
                        "only the march of a directional light with one shadow map and no texture is jittered",
                    )
                    .into());
                };
                march.set_frame(gpu, *frame)?;
                Self::March { march: Box::new(march), steps: *steps }
            }
        })
    }

    /// Radiance of the evaluated pixels, and visibility in alpha.
    pub fn scattered(&self) -> &Texture {
        match self {
            Self::Epipolar(passes) => &passes.scattered,
            Self::Projective(passes) => &passes.scattered,
            Self::March { march, .. } => &march.scattered,
        }
    }

    fn bind(&self, gpu: &Gpu, inputs: &Inputs<'_>) -> Result<MethodBound, PassError> {
        Ok(match self {
            Self::Epipolar(passes) => MethodBound::Epipolar(passes.bind(gpu, inputs)?),
            Self::Projective(passes) => MethodBound::Projective(passes.bind(gpu, inputs)?),
            Self::March { march, steps } => {
                MethodBound::March(march.bind(gpu, inputs, &Along::ShadowMap { steps: *steps })?)
            }
        })
    }

    fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &MethodBound) {
        match (self, bound) {
            (Self::Epipolar(passes), MethodBound::Epipolar(bound)) => passes.record(encoder, bound),
            (Self::Projective(passes), MethodBound::Projective(bound)) => passes.record(encoder, bound),
            (Self::March { march, .. }, MethodBound::March(bound)) => march.record(encoder, bound),
            // Bound to another view: there is nothing to record.
            _ => {}
        }
    }
}

/// One view of [`Views`].
pub struct ViewShafts {
    /// The choice of the pixels that are evaluated, where not all are.
    pub reduced: Option<Reduced>,
    /// What finds their light.
    pub passes: ViewPasses,
    upsample: Option<Upsample>,
}

impl ViewShafts {
    fn new(gpu: &Gpu, shaders: &Shaders, view: &ViewSettings) -> Result<Self, ScatteringError> {
        let full = [view.camera.viewport.x as u32, view.camera.viewport.y as u32];
        let Some(resolution) = view.resolution else {
            let passes = ViewPasses::new(gpu, shaders, &view.method, full)?;
            return Ok(Self { reduced: None, passes, upsample: None });
        };
        let reduced = Reduced::new(gpu, shaders, &view.camera, resolution)?;
        let interpolated = view.method.interpolated(&view.camera);
        Ok(Self {
            passes: ViewPasses::new(gpu, shaders, &view.method, reduced.viewport())?,
            upsample: Some(Upsample::new(gpu, shaders, interpolated, full)?),
            reduced: Some(reduced),
        })
    }

    /// Radiance of the full picture, and visibility in alpha.
    pub fn scattered(&self) -> &Texture {
        self.upsample.as_ref().map_or_else(|| self.passes.scattered(), |upsample| &upsample.scattered)
    }
}

/// Light shafts of several views. All are recorded into one encoder: views of one light share its shadow maps,
/// and no view waits for the submission of another.
pub struct Views {
    /// The views, in the order of their settings.
    pub views: Vec<ViewShafts>,
}

struct ViewBound {
    reduction: Option<[Bound; 2]>,
    method: MethodBound,
}

/// Inputs bound to every pass of [`Views`].
pub struct ViewsBound {
    views: Vec<ViewBound>,
}

impl Views {
    /// Builds all passes and textures of all views.
    ///
    /// # Errors
    /// [`ScatteringError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders, views: &[ViewSettings]) -> Result<Self, ScatteringError> {
        let views = views.iter().map(|view| ViewShafts::new(gpu, shaders, view));
        Ok(Self { views: views.collect::<Result<_, _>>()? })
    }

    /// Binds the inputs of each view, at the full size of its picture; a view without inputs is not recorded.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn bind(&self, gpu: &Gpu, inputs: &[Inputs<'_>]) -> Result<ViewsBound, PassError> {
        let bind = |(view, inputs): (&ViewShafts, &Inputs<'_>)| {
            let (Some(reduced), Some(upsample)) = (&view.reduced, &view.upsample) else {
                return Ok(ViewBound { reduction: None, method: view.passes.bind(gpu, inputs)? });
            };
            let scattered = view.passes.scattered();
            Ok(ViewBound {
                method: view.passes.bind(gpu, &reduced.inputs(inputs))?,
                reduction: Some([
                    reduced.bind(gpu, inputs)?,
                    upsample.bind(gpu, inputs, reduced, scattered)?,
                ]),
            })
        };
        Ok(ViewsBound { views: self.views.iter().zip(inputs).map(bind).collect::<Result<_, PassError>>()? })
    }

    /// Records everything from shadow maps and depth buffers to radiance.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &ViewsBound) {
        for (view, bound) in self.views.iter().zip(&bound.views) {
            if let (Some(reduced), Some([reduce, _])) = (&view.reduced, &bound.reduction) {
                reduced.record(encoder, reduce);
            }
            view.passes.record(encoder, &bound.method);
            if let (Some(upsample), Some([_, spread])) = (&view.upsample, &bound.reduction) {
                upsample.record(encoder, spread);
            }
        }
    }
}
