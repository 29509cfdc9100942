// SPDX-License-Identifier: MIT OR Apache-2.0
//! The way of the light of an area light through the sheets.

use super::light_path::{LightPath, LightSheets};
use super::order::tiles;
use super::passes::LIGHT;
use super::soft_schedule::SOFT_LAYERS;
use super::{
    LayerBlur, LayerMerge, SheetFrame, SheetNumber, Sheets, SoftLight, SoftPlane, SoftShadows, SplattingError,
};
use crate::core::Camera;
use crate::gpu::Gpu;
use crate::out_of_range::in_range;
use crate::pass::{Bound, Pass, Resource};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use encase::internal::WriteInto;
use encase::{ShaderSize, ShaderType};
use glam::Vec3;

/// Surfaces as the light's middle sees them; both r32float, of the shadow buffer's size.
#[derive(Clone, Copy)]
pub(super) struct LitSurfaces<'a> {
    /// Height of the first surface along each light ray, metres; 1e30 where there is none.
    pub(super) heights: &'a Texture,
    /// Height at which the light ray leaves the first solid, likewise.
    pub(super) exit_heights: &'a Texture,
}

fn write_all<T: ShaderType + ShaderSize + WriteInto>(gpu: &Gpu, buffer: &Buffer, all: &Vec<T>) {
    let mut bytes = encase::StorageBuffer::new(Vec::<u8>::new());
    // Writing to a growing vector cannot fail: the error is about fixed capacities.
    bytes.write(all).unwrap_or_default();
    gpu.queue.write_buffer(&buffer.raw, 0, bytes.as_ref());
}

/// One set of layers with its blurs.
struct LayerSet {
    layers: Buffer,
    /// Of each sheet.
    bound: Vec<Bound>,
}

/// An area light.
pub(super) struct AreaLight {
    settings: SoftShadows,
    size: [u32; 2],
    soft: Buffer,
    merges: Buffer,
    blurs: Buffer,
    light: Pass,
    /// Of each sheet, and of one behind the last.
    arrivals: Vec<Bound>,
    soften: Pass,
    sets: Vec<LayerSet>,
    /// Bytes of all layers.
    layer_bytes: u64,
    shadow: Texture,
    /// What arrives at the first surface along each light ray, linear RGB; rgba16float. With surfaces.
    held: Option<Texture>,
}

impl AreaLight {
    /// `resources`: all that the picture has, by name; `count`: of sheets.
    pub(super) fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        resources: &[(&str, Resource<'_>)],
        settings: SoftShadows,
        count: u32,
        size: [u32; 2],
        surfaces: Option<LitSurfaces<'_>>,
    ) -> Result<Self, SplattingError> {
        let bytes = 4 * SOFT_LAYERS as u64 * u64::from(size[0]) * u64::from(size[1]);
        let limit = u64::from(gpu.limits.max_storage_buffer_binding_size as u32);
        let most = (limit / (4 * SOFT_LAYERS as u64)) as f32;
        let texels = size[0] as f32 * size[1] as f32;
        if bytes > limit {
            in_range(
                "texels of a soft shadow buffer",
                texels,
                1.0..=most,
                "at most a binding's bytes over 64",
            )?;
        }
        let permutation = if surfaces.is_some() { "polygons" } else { "default" };
        let light = Pass::compute(gpu, shaders, "splatting/soft_light", permutation)?;
        let soften = Pass::compute(gpu, shaders, "splatting/soften_sheet", "default")?;
        let shadow = Texture::storage(gpu, size, LIGHT);
        let held = surfaces.map(|_| Texture::storage(gpu, size, LIGHT));
        let soft = Buffer::storage(gpu, SoftLight::min_size().get());
        let merges = Buffer::storage(gpu, LayerMerge::min_size().get() * u64::from(count));
        let blurs = Buffer::storage(gpu, LayerBlur::min_size().get() * SOFT_LAYERS as u64 * u64::from(count));
        let softened = Buffer::storage(gpu, bytes);
        let numbers = (0..=count).map(|index| Buffer::uniform(gpu, &SheetNumber::new(index)));
        let numbers: Vec<Buffer> = numbers.collect();
        let sets = if surfaces.is_some() { 3 } else { 1 };
        let sets = (0..sets).map(|_| {
            let layers = Buffer::storage(gpu, bytes);
            let bind = |number: &Buffer| {
                let resources = [
                    ("number", number.into()),
                    ("soft", (&soft).into()),
                    ("blurs", (&blurs).into()),
                    ("layers", (&layers).into()),
                    ("softened", (&softened).into()),
                ];
                soften.bind(gpu, &resources)
            };
            let bound = numbers.iter().take(count as usize).map(bind).collect::<Result<_, _>>()?;
            Ok(LayerSet { layers, bound })
        });
        let sets: Vec<LayerSet> = sets.collect::<Result<_, SplattingError>>()?;
        let mut all = resources.to_vec();
        all.extend([("soft", (&soft).into()), ("merges", (&merges).into()), ("shadow", (&shadow).into())]);
        let names = ["layers", "kept", "filled"];
        all.extend(names.into_iter().zip(sets.iter().map(|set| Resource::from(&set.layers))));
        if let Some(surfaces) = surfaces {
            all.push(("light_heights", surfaces.heights.into()));
            all.push(("light_exit_heights", surfaces.exit_heights.into()));
        }
        all.extend(held.as_ref().map(|held| ("held", held.into())));
        let arrive = |number: &Buffer| {
            let mut all = all.clone();
            all.push(("number", number.into()));
            light.bind_known(gpu, &all)
        };
        let arrivals = numbers.iter().map(arrive).collect::<Result<_, _>>()?;
        // Softened rows are as large as a set.
        let layer_bytes = bytes * (sets.len() as u64 + 1);
        Ok(Self {
            settings,
            size,
            soft,
            merges,
            blurs,
            light,
            arrivals,
            soften,
            sets,
            layer_bytes,
            shadow,
            held,
        })
    }

    /// Of a sheet, or behind the last.
    fn record(&self, encoder: &mut wgpu::CommandEncoder, sheet: u32) -> Result<(), SplattingError> {
        let Some(bound) = self.arrivals.get(sheet as usize) else { return Ok(()) };
        Ok(self.light.dispatch_groups(encoder, bound, "soft_light", tiles(&self.shadow))?)
    }
}

impl LightPath for AreaLight {
    fn set(
        &self,
        gpu: &Gpu,
        sheets: &Sheets,
        frame: &SheetFrame,
        points: &[Vec3],
    ) -> Result<Camera, SplattingError> {
        let plane = SoftPlane::new(&self.settings, frame, sheets, points, self.size)?;
        self.soft.write(gpu, &plane.light);
        write_all(gpu, &self.merges, &plane.schedule.merges);
        write_all(gpu, &self.blurs, &plane.schedule.blurs);
        Ok(plane.camera)
    }

    fn begin(&self, _: &mut wgpu::CommandEncoder, _: &LightSheets<'_>) -> Result<(), SplattingError> {
        Ok(())
    }

    fn arrive(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        sheets: &LightSheets<'_>,
        sheet: u32,
    ) -> Result<(), SplattingError> {
        sheets.record(encoder, sheet);
        self.record(encoder, sheet)
    }

    fn leave(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        _: &LightSheets<'_>,
        sheet: u32,
    ) -> Result<(), SplattingError> {
        for set in &self.sets {
            let Some(bound) = set.bound.get(sheet as usize) else { continue };
            for entry in ["soften_across", "soften_down"] {
                self.soften.dispatch_groups(encoder, bound, entry, tiles(&self.shadow))?;
            }
        }
        if sheet as usize + 2 == self.arrivals.len() { self.record(encoder, sheet + 1) } else { Ok(()) }
    }

    fn shadow(&self) -> &Texture {
        &self.shadow
    }

    fn memory(&self) -> u64 {
        let textures: u64 =
            [Some(&self.shadow), self.held.as_ref()].into_iter().flatten().map(Texture::memory).sum();
        textures + self.layer_bytes + self.merges.raw.size() + self.blurs.raw.size()
    }

    fn resources(&self) -> Vec<(&'static str, Resource<'_>)> {
        self.held.iter().map(|held| ("held", held.into())).collect()
    }
}
