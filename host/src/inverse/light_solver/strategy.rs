// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures of all lights and their transpose: by volumes that are rendered, or by pictures that are stored.

use super::super::descent::Sitting;
use super::super::projector::{bricks, tiles};
use super::super::{
    Collected, Fields, InverseError, LightStrategy, Projector, Target, ViewImages, VoxelGrid,
};
use super::VECTORS;
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, Resource};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;
use glam::UVec3;
use wgpu::CommandEncoder;

/// The uniform `LightNumber` of `inverse/light_numbers`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ShaderType)]
pub struct LightNumber {
    /// From 0.
    pub index: u32,
    /// How many lights there are.
    pub count: u32,
    /// Groups that each light has sums of.
    pub groups: u32,
    /// Padding.
    pub reserved_a: u32,
}

/// The products with T and its transpose.
pub(super) enum Operator {
    /// Light volumes.
    Volumes(Box<Volumes>),
    /// T.
    Columns(Columns),
}

/// Volumes of all lights.
pub(super) struct Volumes {
    size: [u32; 3],
    combine: Pass,
    pack: Pass,
    products: Pass,
    /// Of each light and vector.
    combined: Vec<[Bound; VECTORS]>,
    packed: Bound,
    /// Of each light.
    multiplied: Vec<Bound>,
    /// What is rendered.
    field: Texture,
    collected: Buffer,
    /// Ones: all voxels count.
    wanted: Buffer,
}

/// Stored pictures of all lights.
pub(super) struct Columns {
    count: u32,
    pass: Pass,
    /// Of each view and vector.
    bound: Vec<[Bound; VECTORS]>,
}

fn number(index: usize, count: usize, groups: u32) -> LightNumber {
    LightNumber { index: index as u32, count: count as u32, groups, reserved_a: 0 }
}

/// Refuses what the device does not hold in one piece.
fn in_one_piece(gpu: &Gpu, name: &'static str, bytes: u64) -> Result<u64, InverseError> {
    let limit = gpu.limits.max_storage_buffer_binding_size;
    if bytes <= limit { Ok(bytes) } else { Err(InverseError::Memory { name, bytes, limit }) }
}

/// Bytes of the stored pictures of a view, if the device holds them in one piece.
pub(super) fn bytes_of_columns(
    gpu: &Gpu,
    numbers: usize,
    lights: usize,
    view: &ViewImages,
) -> Result<u64, InverseError> {
    let pixels: u64 = view.size().into_iter().map(u64::from).product();
    let bytes = 4 * numbers as u64 * lights as u64 * pixels;
    let limit = gpu.limits.max_storage_buffer_binding_size;
    if bytes <= limit { Ok(bytes) } else { Err(InverseError::LightColumns { bytes, limit }) }
}

/// Refuses stored pictures that are too large, before anything is made.
pub(super) fn check_columns(
    gpu: &Gpu,
    strategy: LightStrategy,
    numbers: usize,
    lights: usize,
    targets: &[Target],
) -> Result<(), InverseError> {
    if strategy == LightStrategy::Columns {
        for target in targets {
            bytes_of_columns(gpu, numbers, lights, &target.view)?;
        }
    }
    Ok(())
}

impl Volumes {
    /// `vectors`: coefficients; `products`: what the transpose is added to.
    pub(super) fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        projector: &Projector,
        volumes: &[Texture],
        vectors: &[&Buffer; VECTORS],
        products: &Buffer,
    ) -> Result<Self, InverseError> {
        let definitions = projector.definitions();
        let pass = |name: &str| Pass::compute_with(gpu, shaders, name, &definitions);
        let (combine, pack) = (pass("inverse/combine_light")?, pass("inverse/pack_volume")?);
        let multiply = pass("inverse/light_products")?;
        let size = volumes.first().map_or([1; 3], Texture::size);
        let voxels: u64 = size.into_iter().map(u64::from).product();
        let bytes = in_one_piece(gpu, "light volumes", 4 * projector.channels().numbers() as u64 * voxels)?;
        let groups: u32 = bricks(size).into_iter().product();
        let sums = 16 * u64::from(groups) * volumes.len() as u64;
        let sums = Buffer::storage(gpu, in_one_piece(gpu, "sums of light volumes", sums)?);
        let [combination, collected] = [0; 2].map(|_| Buffer::storage(gpu, bytes));
        let grid = Buffer::uniform(gpu, &VoxelGrid { size: UVec3::from(size), reserved_a: 0 });
        let field = Texture::storage_volume(gpu, size, projector.format());
        let mut combined = Vec::new();
        let mut multiplied = Vec::new();
        for (index, volume) in volumes.iter().enumerate() {
            let own = Buffer::uniform(gpu, &number(index, volumes.len(), groups));
            let one = |vector: &Buffer| {
                let resources: [(&str, Resource<'_>); 5] = [
                    ("number", (&own).into()),
                    ("grid", (&grid).into()),
                    ("coefficients", vector.into()),
                    ("volume", volume.into()),
                    ("sums", (&combination).into()),
                ];
                combine.bind_known(gpu, &resources)
            };
            let [solution, direction, trial] = vectors;
            combined.push([one(solution)?, one(direction)?, one(trial)?]);
            let resources: [(&str, Resource<'_>); 6] = [
                ("number", (&own).into()),
                ("grid", (&grid).into()),
                ("volume", volume.into()),
                ("collected", (&collected).into()),
                ("sums", (&sums).into()),
                ("products", products.into()),
            ];
            multiplied.push(multiply.bind_known(gpu, &resources)?);
        }
        let resources: [(&str, Resource<'_>); 3] =
            [("grid", (&grid).into()), ("vector", (&combination).into()), ("volume", (&field).into())];
        let packed = pack.bind_known(gpu, &resources)?;
        let wanted = Buffer::of_floats(gpu, &vec![1.0; voxels as usize]);
        Ok(Self {
            size,
            combine,
            pack,
            products: multiply,
            combined,
            packed,
            multiplied,
            field,
            collected,
            wanted,
        })
    }
}

impl Columns {
    /// Renders and keeps the picture of every light in every view.
    pub(super) fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        projector: &Projector,
        volumes: &[Texture],
        vectors: &[&Buffer; VECTORS],
        products: &Buffer,
        sittings: &[Sitting],
    ) -> Result<Self, InverseError> {
        let definitions = projector.definitions();
        let pass = |name: &str| Pass::compute_with(gpu, shaders, name, &definitions);
        let (keep, pass) = (pass("inverse/keep_column")?, pass("inverse/light_columns")?);
        let numbers = projector.channels().numbers();
        let all = Buffer::uniform(gpu, &number(0, volumes.len(), 0));
        let mut bound = Vec::new();
        for sitting in sittings {
            let columns = Buffer::storage(gpu, bytes_of_columns(gpu, numbers, volumes.len(), &sitting.view)?);
            for (index, volume) in volumes.iter().enumerate() {
                let own = Buffer::uniform(gpu, &number(index, volumes.len(), 0));
                let resources: [(&str, Resource<'_>); 3] = [
                    ("number", (&own).into()),
                    ("rendered", (&sitting.view.rendered).into()),
                    ("columns", (&columns).into()),
                ];
                let kept = keep.bind_known(gpu, &resources)?;
                let mut encoder = gpu.encoder();
                let fields = Fields { emission: volume, albedo: volume, extinction: volume };
                projector.render(gpu, &mut encoder, &sitting.view, &sitting.medium, fields)?;
                keep.dispatch_groups(&mut encoder, &kept, "keep_column", tiles(sitting.view.size()))?;
                gpu.submit(encoder)?;
            }
            let one = |vector: &Buffer| {
                let resources: [(&str, Resource<'_>); 6] = [
                    ("number", (&all).into()),
                    ("columns", (&columns).into()),
                    ("coefficients", vector.into()),
                    ("picture", (&sitting.view.rendered).into()),
                    ("residual", (&sitting.difference).into()),
                    ("products", products.into()),
                ];
                pass.bind_known(gpu, &resources)
            };
            let [solution, direction, trial] = vectors;
            bound.push([one(solution)?, one(direction)?, one(trial)?]);
        }
        Ok(Self { count: volumes.len() as u32, pass, bound })
    }
}

impl Operator {
    /// Records pictures of all views in the lights of a vector.
    pub(super) fn render(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        projector: &Projector,
        sittings: &[Sitting],
        vector: usize,
    ) -> Result<(), InverseError> {
        match self {
            Self::Volumes(own) => {
                for light in &own.combined {
                    own.combine.dispatch_groups(
                        encoder,
                        &light[vector],
                        "combine_light",
                        bricks(own.size),
                    )?;
                }
                own.pack.dispatch_groups(encoder, &own.packed, "pack_volume", bricks(own.size))?;
                let fields = Fields { emission: &own.field, albedo: &own.field, extinction: &own.field };
                for sitting in sittings {
                    projector.render(gpu, encoder, &sitting.view, &sitting.medium, fields)?;
                }
            }
            Self::Columns(own) => {
                for (sitting, bound) in sittings.iter().zip(&own.bound) {
                    let groups = tiles(sitting.view.size());
                    own.pass.dispatch_groups(encoder, &bound[vector], "light_picture", groups)?;
                }
            }
        }
        Ok(())
    }

    /// Records what the differences of all views say of each light, added to the products.
    pub(super) fn collect(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        projector: &Projector,
        sittings: &[Sitting],
    ) -> Result<(), InverseError> {
        match self {
            Self::Volumes(own) => {
                encoder.clear_buffer(&own.collected.raw, 0, None);
                let part = Collected { grid: own.size, wanted: &own.wanted, sums: &own.collected };
                for Sitting { view, medium, difference, .. } in sittings {
                    projector.backproject(gpu, encoder, view, medium, difference, &[part])?;
                }
                for bound in &own.multiplied {
                    own.products.dispatch_groups(encoder, bound, "volume_products", bricks(own.size))?;
                }
                if let Some(bound) = own.multiplied.first() {
                    let lights = own.multiplied.len() as u32;
                    own.products.dispatch_groups(encoder, bound, "add_products", [lights, 1, 1])?;
                }
            }
            Self::Columns(own) => {
                for bound in &own.bound {
                    own.pass.dispatch_groups(encoder, &bound[0], "light_residual", [own.count, 1, 1])?;
                }
            }
        }
        Ok(())
    }
}
