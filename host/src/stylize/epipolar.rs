// SPDX-License-Identifier: MIT OR Apache-2.0
//! Morphology of shadow maps along view rays.

use super::error::check_size;
use super::kernel::windows;
use super::{Epipole, Operator, Step, StylizeError, Width, Window, record, values};
use crate::core::DepthRange;
use crate::gpu::{Gpu, GpuError};
use crate::pass::Pass;
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;

/// The uniform `EpipolarKernel` of `stylize/epipolar_dilate`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct EpipolarKernel {
    /// Texels besides the own one.
    pub reach: u32,
    /// 1 away from the epipole.
    pub away: u32,
    /// 1 for minima, -1 for maxima.
    pub sign: f32,
    /// Depth of an empty texel.
    pub far_depth: f32,
    /// 1 where the source is a shadow map.
    pub first: u32,
    /// 1 where the result is one.
    pub finish: u32,
    /// 1 keeps what is nearer to the light, -1 what is farther.
    pub keep: f32,
    /// Padding.
    pub reserved: u32,
}

/// How lines towards the epipole are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Form {
    /// As rows of a texture, and back: costs the same for all widths up to 63.
    #[default]
    Rectified,
    /// For each texel by itself: exact, and as many reads as the kernel has texels.
    Direct,
}

/// What is done to a shadow map along view rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EpipolarSettings {
    /// The operator. A dilation enhances silhouettes.
    pub operator: Operator,
    /// How lines are taken.
    pub form: Form,
    /// Texels of the kernel, the own one counted: the others lie towards the epipole.
    pub width: Width,
    /// Which way depth runs in the map.
    pub depth: DepthRange,
}

const MAP_LINES: usize = 0;
const LINES: usize = 1;
const RETURN: usize = 2;

/// An operator along view rays on shadow maps of one size.
pub struct EpipolarMorphology {
    passes: Vec<Pass>,
    settings: EpipolarSettings,
    spare: Vec<Texture>,
    epipole: Buffer,
    /// The shadow map as it was changed: r32float.
    pub morphed: Texture,
}

/// A shadow map, bound.
pub struct EpipolarBound {
    steps: Vec<Step>,
}

impl EpipolarMorphology {
    /// Builds the passes for shadow maps of `size` texels. The rectified form takes two textures of twice the longer
    /// side in both directions.
    ///
    /// # Errors
    /// [`StylizeError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        settings: EpipolarSettings,
        epipole: &Epipole,
        size: [u32; 2],
    ) -> Result<Self, StylizeError> {
        check_size(gpu, "a shadow map", size)?;
        let build = |pass, permutation| Pass::compute(gpu, shaders, pass, permutation);
        let (passes, spare) = match settings.form {
            Form::Direct => (vec![build("stylize/epipolar_direct", "default")?], size),
            Form::Rectified => {
                let lines = [2 * size[0].max(size[1]); 2];
                check_size(gpu, "the epipolar lines of a shadow map in a texture", lines)?;
                let sliding = "stylize/sliding_extremum";
                let passes = vec![
                    build(sliding, "epipolar_map")?,
                    build(sliding, "epipolar")?,
                    build("stylize/epipolar_return", "default")?,
                ];
                (passes, lines)
            }
        };
        let spare = (0..2).map(|_| values(gpu, spare)).collect();
        let epipole = Buffer::uniform(gpu, epipole);
        Ok(Self { passes, settings, spare, epipole, morphed: values(gpu, size) })
    }

    /// Width and height of the maps.
    pub fn size(&self) -> [u32; 2] {
        let [width, height, _] = self.morphed.size();
        [width, height]
    }

    /// Takes the epipole of a camera or light that has moved.
    ///
    /// # Errors
    /// [`GpuError`].
    pub fn set_epipole(&self, gpu: &Gpu, epipole: &Epipole) -> Result<(), GpuError> {
        self.epipole.write(gpu, epipole);
        gpu.check()
    }

    /// Binds a shadow map, a depth format or r32float.
    ///
    /// # Errors
    /// [`StylizeError`].
    pub fn bind(&self, gpu: &Gpu, shadow_map: &Texture) -> Result<EpipolarBound, StylizeError> {
        let [width, height, _] = shadow_map.size();
        if [width, height] != self.size() {
            return Err(StylizeError::OtherSize { given: [width, height], expected: self.size() });
        }
        let steps = match self.settings.form {
            Form::Direct => self.bind_direct(gpu, shadow_map)?,
            Form::Rectified => self.bind_rectified(gpu, shadow_map)?,
        };
        Ok(EpipolarBound { steps })
    }

    /// A dilation or erosion as a kernel. The longest line has as many texels as the longer side of the map.
    fn kernel(&self, dilation: bool, first: bool, finish: bool) -> EpipolarKernel {
        let longer = self.size()[0].max(self.size()[1]);
        let nearer = matches!(self.settings.operator, Operator::Dilation | Operator::Closing);
        EpipolarKernel {
            reach: (self.settings.width.texels() - 1).min(2 * (longer / 2)),
            away: u32::from(!dilation),
            sign: if dilation { 1.0 } else { -1.0 },
            far_depth: if self.settings.depth == DepthRange::Forward { 1.0 } else { 0.0 },
            first: u32::from(first),
            finish: u32::from(finish),
            keep: if nearer { 1.0 } else { -1.0 },
            reserved: 0,
        }
    }

    fn bind_direct(&self, gpu: &Gpu, shadow_map: &Texture) -> Result<Vec<Step>, StylizeError> {
        let dilations = self.settings.operator.dilations();
        let mut source = shadow_map;
        let mut steps = Vec::new();
        for (number, dilation) in dilations.iter().enumerate() {
            let finish = number + 1 == dilations.len();
            let to = if finish { &self.morphed } else { &self.spare[0] };
            let kernel = Buffer::uniform(gpu, &self.kernel(*dilation, number == 0, finish));
            let resources = [
                ("epipole", (&self.epipole).into()),
                ("kernel", (&kernel).into()),
                ("shadow_map", shadow_map.into()),
                ("source", source.into()),
                ("morphed", to.into()),
            ];
            let [width, height] = self.size();
            steps.push(Step {
                pass: 0,
                bound: self.passes[0].bind(gpu, &resources)?,
                size: [width, height, 1],
            });
            source = to;
        }
        Ok(steps)
    }

    fn bind_rectified(&self, gpu: &Gpu, shadow_map: &Texture) -> Result<Vec<Step>, StylizeError> {
        let [width, height] = self.size();
        let longer = width.max(height);
        let mut all = Vec::new();
        for dilation in self.settings.operator.dilations() {
            let kernel = self.kernel(*dilation, false, false);
            for (radius, stride) in windows(kernel.reach / 2) {
                // Lines begin at the side of the map: the epipole lies behind each texel.
                let [before, after] = if *dilation { [0, 2 * radius] } else { [2 * radius, 0] };
                all.push(Window::new(before, after, stride, kernel.sign, kernel.far_depth));
            }
        }
        let mut from = None;
        let mut steps = Vec::new();
        for (number, window) in all.iter().enumerate() {
            let to = &self.spare[number % 2];
            let uniform = Buffer::uniform(gpu, window);
            let mut resources = vec![
                ("window", (&uniform).into()),
                ("extrema", to.into()),
                ("epipole", (&self.epipole).into()),
                ("shadow_map", shadow_map.into()),
            ];
            resources.extend(from.map(|from: &Texture| ("values", from.into())));
            let pass = if number == 0 { MAP_LINES } else { LINES };
            let bound = self.passes[pass].bind(gpu, &resources)?;
            steps.push(Step { pass, bound, size: [4 * longer, window.blocks(longer), 1] });
            from = Some(to);
        }
        let kernel = Buffer::uniform(gpu, &self.kernel(true, false, true));
        let mut resources = vec![
            ("epipole", (&self.epipole).into()),
            ("kernel", (&kernel).into()),
            ("shadow_map", shadow_map.into()),
            ("morphed", (&self.morphed).into()),
        ];
        resources.extend(from.map(|lines| ("lines", lines.into())));
        let bound = self.passes[RETURN].bind(gpu, &resources)?;
        steps.push(Step { pass: RETURN, bound, size: [width, height, 1] });
        Ok(steps)
    }

    /// Records the operator.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &EpipolarBound) {
        record(&self.passes, &bound.steps, encoder);
    }
}
