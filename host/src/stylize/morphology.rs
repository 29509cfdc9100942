// SPDX-License-Identifier: MIT OR Apache-2.0
//! Dilation, erosion, closing and opening of shadow maps with a box or a disc.

use super::error::check_size;
use super::kernel::windows;
use super::{Element, Operator, Step, StylizeError, Width, record, values};
use crate::core::DepthRange;
use crate::gpu::Gpu;
use crate::pass::Pass;
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;

/// The uniform `Window` of `stylize/morphology`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct Window {
    /// Texels before the own one.
    pub before: u32,
    /// Texels behind it.
    pub after: u32,
    /// Texels from one to the next.
    pub stride: u32,
    /// Padding.
    pub reserved_a: u32,
    /// 1 for minima, -1 for maxima.
    pub sign: f32,
    /// Depth of an empty texel.
    pub far_depth: f32,
    /// Padding.
    pub reserved_b: f32,
    /// Padding.
    pub reserved_c: f32,
}

impl Window {
    pub(super) fn new(before: u32, after: u32, stride: u32, sign: f32, far_depth: f32) -> Self {
        Self { before, after, stride, reserved_a: 0, sign, far_depth, reserved_b: 0.0, reserved_c: 0.0 }
    }

    /// Blocks of all residues that a line of `length` texels is cut into.
    pub(super) fn blocks(&self, length: u32) -> u32 {
        self.stride * length.div_ceil(self.stride).div_ceil(self.before + self.after + 1)
    }
}

/// The uniform `Disc` of `stylize/morphology`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct Disc {
    /// Radius, texels.
    pub radius: u32,
    /// The table holds extrema over 2^level texels.
    pub level: u32,
    /// The least distance of rows from the middle that it serves.
    pub first_row: u32,
    /// Where it ends.
    pub end_row: u32,
    /// 1 for minima, -1 for maxima.
    pub sign: f32,
    /// Depth of an empty texel.
    pub far_depth: f32,
    /// 1 at level 0.
    pub begins: u32,
    /// 1 at the last level.
    pub ends: u32,
}

/// What is done to a shadow map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MorphologySettings {
    /// The operator.
    pub operator: Operator,
    /// The structuring element.
    pub element: Element,
    /// Its width.
    pub width: Width,
    /// Which way depth runs in the map.
    pub depth: DepthRange,
}

impl MorphologySettings {
    fn far_depth(&self) -> f32 {
        if self.depth == DepthRange::Forward { 1.0 } else { 0.0 }
    }

    /// Signs of the extrema, in order: 1 for minima.
    fn signs(&self) -> impl Iterator<Item = f32> {
        let facing = if self.depth == DepthRange::Forward { 1.0 } else { -1.0 };
        self.operator.dilations().iter().map(move |dilation| if *dilation { facing } else { -facing })
    }
}

const ROWS: usize = 0;
const COLUMNS: usize = 1;

/// A morphological operator on shadow maps of one size.
pub struct Morphology {
    passes: Vec<Pass>,
    settings: MorphologySettings,
    spare: Vec<Texture>,
    /// The shadow map as it was changed: r32float.
    pub morphed: Texture,
}

/// A shadow map, bound.
pub struct MorphologyBound {
    steps: Vec<Step>,
}

impl Morphology {
    /// Builds the passes for shadow maps of `size` texels.
    ///
    /// # Errors
    /// [`StylizeError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        settings: MorphologySettings,
        size: [u32; 2],
    ) -> Result<Self, StylizeError> {
        check_size(gpu, "a shadow map", size)?;
        let build = |pass, permutation| Pass::compute(gpu, shaders, pass, permutation);
        let (passes, spare) = match settings.element {
            Element::Box => {
                let sliding = "stylize/sliding_extremum";
                (vec![build(sliding, "default")?, build(sliding, "columns")?], 2)
            }
            Element::Disc => (vec![build("stylize/disc", "default")?], 4),
        };
        let spare = (0..spare).map(|_| values(gpu, size)).collect();
        Ok(Self { passes, settings, spare, morphed: values(gpu, size) })
    }

    /// Width and height of the maps.
    pub fn size(&self) -> [u32; 2] {
        let [width, height, _] = self.morphed.size();
        [width, height]
    }

    /// Binds a shadow map, a depth format or r32float.
    ///
    /// # Errors
    /// [`StylizeError`].
    pub fn bind(&self, gpu: &Gpu, shadow_map: &Texture) -> Result<MorphologyBound, StylizeError> {
        let [width, height, _] = shadow_map.size();
        if [width, height] != self.size() {
            return Err(StylizeError::OtherSize { given: [width, height], expected: self.size() });
        }
        let steps = match self.settings.element {
            Element::Box => self.bind_box(gpu, shadow_map)?,
            Element::Disc => self.bind_disc(gpu, shadow_map)?,
        };
        Ok(MorphologyBound { steps })
    }

    fn bind_box(&self, gpu: &Gpu, shadow_map: &Texture) -> Result<Vec<Step>, StylizeError> {
        let size = self.size();
        let far_depth = self.settings.far_depth();
        let mut all = Vec::new();
        for sign in self.settings.signs() {
            for axis in [ROWS, COLUMNS] {
                // A window that reaches beyond both ends of every line is as good as a wider one.
                let radius = self.settings.width.radius().min(size[axis] - 1);
                let windows = windows(radius).into_iter();
                all.extend(
                    windows.map(|(own, stride)| (axis, Window::new(own, own, stride, sign, far_depth))),
                );
            }
        }
        let count = all.len();
        let mut from = shadow_map;
        let mut steps = Vec::new();
        for (number, (axis, window)) in all.iter().enumerate() {
            let to = if number + 1 == count { &self.morphed } else { &self.spare[number % 2] };
            let uniform = Buffer::uniform(gpu, window);
            let resources = [("window", (&uniform).into()), ("values", from.into()), ("extrema", to.into())];
            let bound = self.passes[*axis].bind(gpu, &resources)?;
            steps.push(Step { pass: *axis, bound, size: [size[1 - axis], window.blocks(size[*axis]), 1] });
            from = to;
        }
        Ok(steps)
    }

    fn bind_disc(&self, gpu: &Gpu, shadow_map: &Texture) -> Result<Vec<Step>, StylizeError> {
        let size = self.size();
        let levels = disc_levels(self.settings.width.radius(), size);
        let signs: Vec<f32> = self.settings.signs().collect();
        let (tables, sums) = self.spare.split_at(2);
        let mut from = shadow_map;
        let mut steps = Vec::new();
        for (stage, sign) in signs.iter().enumerate() {
            let (mut table, mut accumulated) = (from, from);
            for (level, [first_row, end_row]) in levels.iter().enumerate() {
                let ends = level + 1 == levels.len();
                let to =
                    if ends && stage + 1 == signs.len() { &self.morphed } else { &sums[steps.len() % 2] };
                let next = &tables[level % 2];
                let disc = Disc {
                    radius: self.settings.width.radius().min(size[0] + size[1]),
                    level: level as u32,
                    first_row: *first_row,
                    end_row: *end_row,
                    sign: *sign,
                    far_depth: self.settings.far_depth(),
                    begins: u32::from(level == 0),
                    ends: u32::from(ends),
                };
                let uniform = Buffer::uniform(gpu, &disc);
                let resources = [
                    ("disc", (&uniform).into()),
                    ("table", table.into()),
                    ("accumulated", accumulated.into()),
                    ("next_table", next.into()),
                    ("next_accumulated", to.into()),
                ];
                let bound = self.passes[0].bind(gpu, &resources)?;
                steps.push(Step { pass: 0, bound, size: [size[0], size[1], 1] });
                (table, accumulated, from) = (next, to, to);
            }
        }
        Ok(steps)
    }

    /// Records the operator.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &MorphologyBound) {
        record(&self.passes, &bound.steps, encoder);
    }
}

/// For each level of tables the rows of a disc that it serves: those whose chord, cut to the map, has 2^level to
/// 2^(level + 1) - 1 texels. Rows beyond the map add nothing.
fn disc_levels(radius: u32, [width, height]: [u32; 2]) -> Vec<[u32; 2]> {
    let radius = u64::from(radius.min(width + height));
    let level_of = |row: u64| {
        let half = (radius * radius - row * row).isqrt().min(u64::from(width) - 1);
        (2 * half + 1).ilog2() as usize
    };
    // Chords grow towards the middle.
    let end = radius.min(u64::from(height) - 1) + 1;
    let mut levels = vec![[0, 0]; level_of(0) + 1];
    for row in (0..end).rev() {
        let level = &mut levels[level_of(row)];
        level[0] = row as u32;
        level[1] = level[1].max(row as u32 + 1);
    }
    levels
}
