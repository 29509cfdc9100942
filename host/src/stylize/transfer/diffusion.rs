// SPDX-License-Identifier: MIT OR Apache-2.0
//! Colours of constraints, diffused over a square by multigrid.

use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, PassError};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;
use wgpu::TextureFormat::Rgba16Float;

/// The uniform `DiffusionLevel` of `stylize/tf_diffuse`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct DiffusionLevel {
    /// Cells a side.
    pub size: u32,
    /// Index of the first cell.
    pub first: u32,
    /// Cells a side of the next level.
    pub coarse_size: u32,
    /// Index of that one's first cell.
    pub coarse_first: u32,
    /// Which cells are smoothed.
    pub parity: u32,
    /// Number of constraints.
    pub count: u32,
    /// Radius of a constraint's disc.
    pub radius: f32,
    /// Padding.
    pub reserved: f32,
}

/// Radius of a constraint's disc, in units of the square's side.
const RADIUS: f32 = 0.03;
/// Each takes about two thirds of what is left.
const CYCLES: usize = 12;
/// Smoothings of both parities, on the way down and on the way up.
const SMOOTHINGS: usize = 2;
/// Cells a side that one workgroup solves.
const COARSEST: u32 = 16;

/// The pass `stylize/diffuse`.
pub(super) struct Diffusion {
    pass: Pass,
}

/// What the steps of a level are given, by parity.
struct Level {
    bound: [Bound; 2],
    size: u32,
    coarse_size: u32,
}

impl Diffusion {
    pub(super) fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, PassError> {
        Ok(Self { pass: Pass::compute(gpu, shaders, "stylize/diffuse", "default")? })
    }

    /// Records what makes the layer of `count` constraints: a square of `size` texels of premultiplied RGBA.
    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        constraints: &Buffer,
        count: u32,
        size: u32,
    ) -> Result<Texture, PassError> {
        let mut sizes = vec![size];
        while let Some(last) = sizes.last().copied().filter(|last| *last > COARSEST) {
            sizes.push(last.div_ceil(2));
        }
        let cells = sizes.iter().map(|size| u64::from(size * size)).sum::<u64>();
        let buffers = [(); 3].map(|()| Buffer::storage(gpu, 16 * cells));
        let diffused = Texture::storage(gpu, [size, size], Rgba16Float);
        let mut first = 0;
        let mut levels = Vec::new();
        for (number, size) in sizes.iter().copied().enumerate() {
            let coarse_size = sizes.get(number + 1).copied().unwrap_or(1);
            let coarse_first = if number + 1 < sizes.len() { first + size * size } else { first };
            let bind = |parity| {
                let level = DiffusionLevel {
                    size,
                    first,
                    coarse_size,
                    coarse_first,
                    parity,
                    count,
                    radius: RADIUS,
                    reserved: 0.0,
                };
                let level = Buffer::uniform(gpu, &level);
                let resources = [
                    ("level", (&level).into()),
                    ("constraints", constraints.into()),
                    ("couplings", (&buffers[0]).into()),
                    ("values", (&buffers[1]).into()),
                    ("sources", (&buffers[2]).into()),
                    ("diffused", (&diffused).into()),
                ];
                self.pass.bind(gpu, &resources)
            };
            levels.push(Level { bound: [bind(0)?, bind(1)?], size, coarse_size });
            first += size * size;
        }
        self.steps(encoder, &levels)?;
        Ok(diffused)
    }

    fn steps(&self, encoder: &mut wgpu::CommandEncoder, levels: &[Level]) -> Result<(), PassError> {
        let mut step = |name, bound: &Bound, width: u32, height: u32| {
            self.pass.dispatch_groups(encoder, bound, name, [width.div_ceil(16), height.div_ceil(8), 1])
        };
        let Some((coarsest, finer)) = levels.split_last() else { return Ok(()) };
        let finest = &levels[0];
        step("begin", &finest.bound[0], finest.size, finest.size)?;
        for level in finer {
            step("coarsen", &level.bound[0], level.coarse_size, level.coarse_size)?;
        }
        for _ in 0..CYCLES {
            for level in finer {
                for smoothing in 0..2 * SMOOTHINGS {
                    let bound = &level.bound[smoothing % 2];
                    step("smooth_cells", bound, level.size.div_ceil(2), level.size)?;
                }
                step("restrict_residual", &level.bound[0], level.coarse_size, level.coarse_size)?;
            }
            step("solve_coarsest", &coarsest.bound[0], 1, 1)?;
            for level in finer.iter().rev() {
                step("prolong", &level.bound[0], level.size, level.size)?;
                for smoothing in 0..2 * SMOOTHINGS {
                    let bound = &level.bound[(smoothing + 1) % 2];
                    step("smooth_cells", bound, level.size.div_ceil(2), level.size)?;
                }
            }
        }
        step("finish", &finest.bound[0], finest.size, finest.size)
    }
}
