// SPDX-License-Identifier: MIT OR Apache-2.0
//! The projectively rectified map: resampled from a standard shadow map, or drawn without one.

use super::{Inputs, Projective, ProjectiveRows, ScatteringError, check_size};
use crate::core::MeshBuffers;
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, PassError, RenderStages};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;
use wgpu::TextureFormat;

/// A projectively rectified map and its rows.
pub struct ProjectiveMap {
    /// Uniform `ProjectiveRows`.
    pub rows: Buffer,
    /// The map: `R32Float` where it is resampled, `Depth32Float` where it is drawn.
    pub rectified: Texture,
    resample: Option<Pass>,
}

impl ProjectiveMap {
    /// A map of `map` columns and rows that [`ProjectiveMap::record`] resamples from a standard shadow map.
    ///
    /// # Errors
    /// [`ScatteringError`].
    pub fn resampled(gpu: &Gpu, shaders: &Shaders, map: [u32; 2]) -> Result<Self, ScatteringError> {
        check_size(gpu, "a rectified map", map)?;
        Ok(Self {
            rows: Buffer::storage(gpu, u64::from(ProjectiveRows::min_size())),
            rectified: Texture::storage(gpu, map, TextureFormat::R32Float),
            resample: Some(Pass::compute(gpu, shaders, "scattering/rectify_projective", "default")?),
        })
    }

    /// A map of `map` columns and rows that [`ProjectiveRaster`] draws.
    ///
    /// # Errors
    /// [`ScatteringError`].
    pub fn drawn(gpu: &Gpu, map: [u32; 2]) -> Result<Self, ScatteringError> {
        check_size(gpu, "a rectified map", map)?;
        Ok(Self {
            rows: Buffer::storage(gpu, u64::from(ProjectiveRows::min_size())),
            rectified: Texture::target(gpu, map, TextureFormat::Depth32Float),
            resample: None,
        })
    }

    /// Takes the rows of a frame.
    pub fn write(&self, gpu: &Gpu, projective: &Projective) {
        self.rows.write(gpu, &projective.rows);
    }

    /// Binds the inputs of the resampling; none for a map that is drawn.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn bind(&self, gpu: &Gpu, inputs: &Inputs<'_>) -> Result<Option<Bound>, PassError> {
        let resources = [
            ("light", inputs.light.into()),
            ("rows", (&self.rows).into()),
            ("shadow_map", inputs.shadow_map.into()),
            ("rectified", (&self.rectified).into()),
        ];
        self.resample.as_ref().map(|pass| pass.bind_known(gpu, &resources)).transpose()
    }

    /// Records the resampling, if there is any.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: Option<&Bound>) {
        if let (Some(pass), Some(bound)) = (&self.resample, bound) {
            let [width, height, _] = self.rectified.size();
            // A thread takes four texels of a row.
            pass.dispatch(encoder, bound, [width.div_ceil(4), height, 1]);
        }
    }
}

/// Draws meshes straight into a projectively rectified map.
pub struct ProjectiveRaster {
    pass: Pass,
}

/// The splits of a frame, bound.
pub struct ProjectiveRasterBound {
    splits: Vec<Bound>,
}

impl ProjectiveRaster {
    /// Builds the pipeline.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, PassError> {
        let stages = RenderStages {
            vertex: "vertex_project",
            fragment: Some("fragment_project"),
            vertices: Some(crate::core::MESH_VERTEX),
            target: None,
            depth: Some((wgpu::CompareFunction::Less, true)),
            samples: 1,
        };
        Ok(Self { pass: Pass::render(gpu, &shaders.compose("scattering/project", "default")?, &stages)? })
    }

    /// Binds the matrices of a frame.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn bind(&self, gpu: &Gpu, projective: &Projective) -> Result<ProjectiveRasterBound, PassError> {
        let bind = |split| self.pass.bind(gpu, &[("split", (&Buffer::uniform(gpu, split)).into())]);
        Ok(ProjectiveRasterBound { splits: projective.splits.iter().map(bind).collect::<Result<_, _>>()? })
    }

    /// Records all splits of `map`, a `Depth32Float` target. Split `k` of `K` owns the texels whose middle lies
    /// between `k` and `k + 1` times `width / K`.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        bound: &ProjectiveRasterBound,
        meshes: &[MeshBuffers],
        map: &Texture,
    ) {
        let [width, height, _] = map.size();
        let mut render = crate::core::begin(encoder, None, map, 1.0);
        let share = width as f32 / bound.splits.len() as f32;
        for (k, split) in bound.splits.iter().enumerate() {
            let left = k as f32 * share;
            let [first, end] = [left, left + share].map(|edge| (edge - 0.5).ceil().max(0.0) as u32);
            let end = end.min(width);
            if first >= end {
                continue;
            }
            render.set_viewport([left, 0.0, share.min(width as f32 - left), height as f32]);
            render.set_scissor([first, 0, end - first, height]);
            render.set(&self.pass, split);
            meshes.iter().for_each(|mesh| mesh.draw(&mut render, 0));
        }
    }
}
