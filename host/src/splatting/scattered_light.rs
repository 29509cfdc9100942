// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light that sheets scatter on, and back.

use super::light_path::{LightPath, LightSheets};
use super::order::tiles;
use super::passes::LIGHT;
use super::{ScatteringSettings, SplattingError};
use crate::gpu::Gpu;
use crate::out_of_range::in_range;
use crate::pass::{Bound, Pass, Resource};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use encase::ShaderType;

/// The uniform `Scattering` of `splatting/light_scattering`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct Scattering {
    /// Half the angle of the cone of light that is scattered on, radians.
    pub forward_cone: f32,
    /// Half the angle of the cone of light that is scattered back, radians.
    pub back_cone: f32,
    /// For how far scattered light keeps its direction, metres.
    pub free_path: f32,
    /// Padding.
    pub reserved_a: f32,
}

impl ScatteringSettings {
    pub(super) fn check(&self) -> Result<(), SplattingError> {
        let (most, range) = match self.back {
            true => (90.0, "from 0.5 to 90 degrees where light is scattered back: cones may not overlap"),
            false => (180.0, "from 0.5 to 180 degrees"),
        };
        in_range("cone of scattered light", self.cone, 0.5..=most, range)?;
        in_range("free path", self.free_path, 0.0..=1e6, "from 0 to 1000000 metres")?;
        Ok(in_range("number of sweeps", self.sweeps as f32, 1.0..=16.0, "from 1 to 16")?)
    }

    fn uniform(&self) -> Scattering {
        let cone = self.cone.to_radians();
        Scattering {
            forward_cone: cone,
            back_cone: if self.back { cone } else { 0.0 },
            free_path: self.free_path,
            reserved_a: 0.0,
        }
    }
}

/// What light coming back takes.
struct Back {
    sweeps: u32,
    /// Of each sheet the light on its side of the light, and its mean values; one more behind the last.
    stored: Vec<Buffer>,
    /// What arrives from behind at the sheet that is put into the picture.
    behind: Texture,
    /// What leaves the first sheet towards the light.
    returned: Texture,
    /// Of the first sheet, into `returned`.
    bound: Bound,
}

/// Light that sheets scatter.
pub(super) struct ScatteredLight {
    pass: Pass,
    scattering: Buffer,
    /// Of each sheet.
    bound: Vec<Bound>,
    shadow: Texture,
    back: Option<Back>,
    /// What arrives at surfaces.
    held: Option<Texture>,
    /// Bytes of buffers that only the pass knows.
    buffer_bytes: u64,
}

/// Bytes of a texel of a stored sheet.
const STORED: u64 = 8;
/// Bytes of the kernels of a sheet.
const KERNELS: u64 = 256;

impl ScatteredLight {
    /// `resources`: all that the picture has, by name; `numbers`: of the sheets; `surfaces`: heights of the first surface along each
    /// light ray, along the normal of the sheets, r32float of the size of the light buffer.
    pub(super) fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        resources: &[(&str, Resource<'_>)],
        [width, height]: [u32; 2],
        settings: &ScatteringSettings,
        numbers: &[Buffer],
        surfaces: Option<&Texture>,
    ) -> Result<Self, SplattingError> {
        settings.check()?;
        let texels = u64::from(width) * u64::from(height);
        let row_bytes = 16 * texels * if settings.back { 2 } else { 1 };
        let limit = gpu.limits.max_storage_buffer_binding_size;
        if row_bytes > limit {
            let (sheets, size) = (numbers.len(), [width, height]);
            return Err(SplattingError::LightBuffer { size, sheets, bytes: row_bytes, limit });
        }
        let flags = [("BACK", settings.back), ("POLYGONS", surfaces.is_some())];
        let flags = flags.into_iter().filter(|(_, set)| *set);
        let definitions = flags.fold(Definitions::new(), |all, (name, _)| all.flag(name));
        let pass = Pass::compute_with(gpu, shaders, "splatting/scatter_sheet", &definitions)?;
        let texture = || Texture::storage(gpu, [width, height], LIGHT);
        let scattering = Buffer::uniform(gpu, &settings.uniform());
        let [left, rows] = [16 * texels, row_bytes].map(|bytes| Buffer::storage(gpu, bytes));
        let kernels = Buffer::storage(gpu, KERNELS * numbers.len() as u64);
        let (shadow, behind, returned) = (texture(), texture(), texture());
        let held = surfaces.map(|_| texture());
        let stored: Vec<Buffer> = match settings.back {
            true => (0..=numbers.len()).map(|_| Buffer::storage(gpu, STORED * texels)).collect(),
            false => Vec::new(),
        };
        let mut all = resources.to_vec();
        all.extend([
            ("scattering", (&scattering).into()),
            ("left", (&left).into()),
            ("rows", (&rows).into()),
            ("kernels", (&kernels).into()),
            ("shadow", (&shadow).into()),
        ]);
        all.extend(surfaces.map(|heights| ("light_heights", heights.into())));
        all.extend(held.as_ref().map(|held| ("held", held.into())));
        let bind = |number: &Buffer, sheets: Option<[&Buffer; 2]>, back: &Texture| {
            let mut all = all.clone();
            all.push(("number", number.into()));
            if let Some([own, next]) = sheets {
                all.extend([("own", own.into()), ("next", next.into()), ("shadow_back", back.into())]);
            }
            pass.bind_known(gpu, &all)
        };
        let pair = |sheet: usize| Some([stored.get(sheet)?, stored.get(sheet + 1)?]);
        let bound = numbers.iter().enumerate().map(|(sheet, number)| bind(number, pair(sheet), &behind));
        let bound = bound.collect::<Result<_, _>>()?;
        let back = match (stored.as_slice(), numbers) {
            ([first, second, ..], [number, ..]) => {
                let bound = bind(number, Some([second, first]), &returned)?;
                Some(Back { sweeps: settings.sweeps, stored, behind, returned, bound })
            }
            _ => None,
        };
        let buffer_bytes = 16 * texels + row_bytes + KERNELS * numbers.len() as u64;
        Ok(Self { pass, scattering, bound, shadow, back, held, buffer_bytes })
    }

    fn over_light(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        bound: &Bound,
        entry: &str,
    ) -> Result<(), SplattingError> {
        Ok(self.pass.dispatch_groups(encoder, bound, entry, tiles(&self.shadow))?)
    }

    /// An entry for a sheet: where there are no surfaces, only if it has splats.
    fn of_sheet(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        sheets: &LightSheets<'_>,
        sheet: u32,
        entry: &str,
    ) -> Result<(), SplattingError> {
        let Some(bound) = self.bound.get(sheet as usize) else { return Ok(()) };
        if self.held.is_some() {
            return self.over_light(encoder, bound, entry);
        }
        Ok(self.pass.dispatch_indirect(encoder, bound, entry, sheets.order.over_shadow(sheet))?)
    }

    /// Light down and up through all sheets.
    fn sweep(&self, encoder: &mut wgpu::CommandEncoder) -> Result<(), SplattingError> {
        if let Some(first) = self.bound.first() {
            self.over_light(encoder, first, "begin_down")?;
        }
        // Sheets without splats too: what is stored has to reach the next.
        for bound in &self.bound {
            self.over_light(encoder, bound, "down_rows")?;
            self.over_light(encoder, bound, "down_columns")?;
        }
        if let Some(last) = self.bound.last() {
            self.over_light(encoder, last, "begin_up")?;
        }
        for bound in self.bound.iter().rev() {
            self.over_light(encoder, bound, "up_rows")?;
            self.over_light(encoder, bound, "up_columns")?;
        }
        Ok(())
    }
}

impl LightPath for ScatteredLight {
    fn begin(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        sheets: &LightSheets<'_>,
    ) -> Result<(), SplattingError> {
        let Some(first) = self.bound.first() else { return Ok(()) };
        let groups = [(self.bound.len() as u32).div_ceil(64), 1, 1];
        self.pass.dispatch_groups(encoder, first, "make_kernels", groups)?;
        if let Some(back) = &self.back {
            for stored in &back.stored {
                encoder.clear_buffer(&stored.raw, 0, None);
            }
            for sheet in 0..self.bound.len() as u32 {
                sheets.record(encoder, sheet);
                self.of_sheet(encoder, sheets, sheet, "keep_sheet")?;
            }
            for _ in 0..back.sweeps {
                self.sweep(encoder)?;
            }
            self.over_light(encoder, &back.bound, "light_behind")?;
        }
        self.over_light(encoder, first, "begin_light")
    }

    fn arrive(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        sheets: &LightSheets<'_>,
        sheet: u32,
    ) -> Result<(), SplattingError> {
        sheets.record(encoder, sheet);
        match self.back {
            Some(_) => self.of_sheet(encoder, sheets, sheet, "light_behind"),
            None => Ok(()),
        }
    }

    fn leave(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        sheets: &LightSheets<'_>,
        sheet: u32,
    ) -> Result<(), SplattingError> {
        self.of_sheet(encoder, sheets, sheet, "scatter_rows")?;
        self.of_sheet(encoder, sheets, sheet, "scatter_columns")
    }

    fn shadow(&self) -> &Texture {
        &self.shadow
    }

    fn returned(&self) -> Option<&Texture> {
        self.back.as_ref().map(|back| &back.returned)
    }

    fn memory(&self) -> u64 {
        let stored =
            self.back.iter().flat_map(|back| &back.stored).map(|sheet| sheet.raw.size()).sum::<u64>();
        let back = self.back.iter().flat_map(|back| [&back.behind, &back.returned]);
        let textures = back.chain(&self.held).chain([&self.shadow]).map(Texture::memory).sum::<u64>();
        textures + stored + self.buffer_bytes
    }

    fn resources(&self) -> Vec<(&'static str, Resource<'_>)> {
        let mut all = vec![("scattering", (&self.scattering).into())];
        all.extend(self.back.as_ref().map(|back| ("shadow_back", (&back.behind).into())));
        all.extend(self.held.as_ref().map(|held| ("held", held.into())));
        all
    }
}
