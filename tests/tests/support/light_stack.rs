// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light through sheets of any mean values, by the passes alone: no splats, and every sheet is looked at.
#![allow(dead_code, clippy::unwrap_used)]

use crate::gpu::{gpu, shaders};
use crate::sheets::colored;
use airlight::core::{Camera, DepthRange, Light, OrthographicView};
use airlight::splatting::{Scattering, SheetLighting, SheetNumber, Sheets};
use airlight::validate::Definitions;
use airlight::{Buffer, Pass, Resource, Sampler, Texture};
use glam::Vec3;
use wgpu::{TextureFormat, TextureUsages};

/// Sheets across light that goes straight down, the first at the height 0.
pub struct LightStack<'a> {
    /// Mean value of a sheet at a texel, column and row.
    pub means: &'a dyn Fn(u32, [u32; 2]) -> f32,
    /// Columns and rows.
    pub size: [u32; 2],
    /// Metres a texel.
    pub texel: f32,
    pub count: u32,
    /// Of a sheet, metres.
    pub thickness: f32,
    pub lighting: SheetLighting,
    /// The only albedo.
    pub albedo: Vec3,
    /// Nothing scatters where there is none.
    pub scattering: Option<Scattering>,
    /// How often light comes back; never at 0.
    pub sweeps: u32,
    /// Heights of surfaces, metres down.
    pub surfaces: Option<Vec<f32>>,
}

/// What light there was: four numbers a texel.
pub struct StackLight {
    /// Behind each sheet.
    pub down: Vec<Vec<f32>>,
    /// What came from behind each sheet.
    pub up: Vec<Vec<f32>>,
    /// Out of the first sheet.
    pub returned: Vec<f32>,
    /// At surfaces.
    pub held: Vec<f32>,
}

impl LightStack<'_> {
    /// Runs all passes in the order that they ask for.
    pub fn run(&self) -> StackLight {
        let [width, height] = self.size;
        let texels = u64::from(width * height);
        let view = OrthographicView {
            eye: 100.0 * Vec3::Y,
            target: Vec3::ZERO,
            height: self.texel * height as f32,
            near: 0.0,
            far: 300.0,
            depth: DepthRange::Forward,
        };
        let camera = Buffer::uniform(gpu(), &Camera::orthographic(&view, self.size).unwrap());
        let light =
            Light::directional(Vec3::Y, Vec3::new(4.0, 2.0, 1.0), Vec3::splat(-9.0), Vec3::splat(9.0));
        let light = Buffer::uniform(gpu(), &light.unwrap());
        let (first, thickness, count) = (0.0, self.thickness, self.count);
        let sheets = Sheets { normal: Vec3::NEG_Y, first, thickness, count, span: count, front_to_back: 1 };
        let sheets = Buffer::uniform(gpu(), &sheets);
        let lighting = Buffer::uniform(gpu(), &self.lighting);
        let nothing = Scattering { forward_cone: 1.0, back_cone: 0.0, free_path: 0.0, reserved_a: 0.0 };
        let scattering = Buffer::uniform(gpu(), &self.scattering.unwrap_or(nothing));
        let transfer = colored([self.albedo; 2]);
        let sampler = Sampler::linear(gpu());
        let written = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
        let means = Texture::new(gpu(), self.size, TextureFormat::Rgba16Float, written);
        let surfaces = Texture::new(gpu(), self.size, TextureFormat::R32Float, written);
        if let Some(down) = &self.surfaces {
            surfaces.write(gpu(), down).unwrap();
        }
        let [shadow, behind, returned, held] =
            [0; 4].map(|_| Texture::storage(gpu(), self.size, TextureFormat::Rgba16Float));
        let [left, rows, kernels] =
            [16 * texels, 32 * texels, 256 * u64::from(count)].map(|bytes| Buffer::storage(gpu(), bytes));
        let stored: Vec<Buffer> = (0..=count).map(|_| Buffer::storage(gpu(), 8 * texels)).collect();
        let name =
            if self.scattering.is_some() { "splatting/scatter_sheet" } else { "splatting/light_sheet" };
        let flags = [("BACK", self.sweeps > 0), ("POLYGONS", self.surfaces.is_some())];
        let flags = flags.into_iter().filter(|(_, set)| *set);
        let definitions = flags.fold(Definitions::new(), |all, (flag, _)| all.flag(flag));
        let pass = Pass::compute_with(gpu(), shaders(), name, &definitions).unwrap();
        let bind = |sheet: u32, [own, next]: [usize; 2], back: &Texture| {
            let number = SheetNumber::new(sheet);
            let number = Buffer::uniform(gpu(), &number);
            let all: Vec<(&str, Resource<'_>)> = vec![
                ("light_camera", (&camera).into()),
                ("light", (&light).into()),
                ("sheets", (&sheets).into()),
                ("lighting", (&lighting).into()),
                ("scattering", (&scattering).into()),
                ("number", (&number).into()),
                ("light_sheet", (&means).into()),
                ("transfer", (&transfer.texture).into()),
                ("linear_sampler", (&sampler).into()),
                ("left", (&left).into()),
                ("rows", (&rows).into()),
                ("kernels", (&kernels).into()),
                ("shadow", (&shadow).into()),
                ("own", (&stored[own]).into()),
                ("next", (&stored[next]).into()),
                ("shadow_back", back.into()),
                ("light_heights", (&surfaces).into()),
                ("held", (&held).into()),
            ];
            pass.bind_known(gpu(), &all).unwrap()
        };
        let bound: Vec<_> =
            (0..count).map(|sheet| bind(sheet, [sheet as usize, sheet as usize + 1], &behind)).collect();
        let groups = [width.div_ceil(16), height.div_ceil(8), 1];
        let run = |sheet: u32, entry: &str| {
            let mut encoder = gpu().encoder();
            let groups = if entry == "make_kernels" { [count.div_ceil(64), 1, 1] } else { groups };
            pass.dispatch_groups(&mut encoder, &bound[sheet as usize], entry, groups).unwrap();
            gpu().submit(encoder).unwrap();
        };
        let draw = |sheet: u32| {
            let texel = |i: u32| {
                let value = (self.means)(sheet, [i % width, i / width]);
                let coarse = (value * 512.0).round() / 512.0;
                [coarse, (value - coarse) * 512.0, 0.0, 0.0]
            };
            means.write(gpu(), &(0..width * height).flat_map(texel).collect::<Vec<_>>()).unwrap();
        };
        let mut found =
            StackLight { down: Vec::new(), up: Vec::new(), returned: Vec::new(), held: Vec::new() };
        if self.scattering.is_none() {
            run(0, "begin_light");
            for sheet in 0..count {
                draw(sheet);
                run(sheet, "light_sheet_left");
                found.down.push(left.read_floats(gpu()).unwrap());
            }
            return found;
        }
        run(0, "make_kernels");
        if self.sweeps > 0 {
            for sheet in 0..count {
                draw(sheet);
                run(sheet, "keep_sheet");
            }
        }
        for _ in 0..self.sweeps {
            run(0, "begin_down");
            for sheet in 0..count {
                run(sheet, "down_rows");
                run(sheet, "down_columns");
            }
            run(count - 1, "begin_up");
            for sheet in (0..count).rev() {
                run(sheet, "up_rows");
                run(sheet, "up_columns");
            }
        }
        if self.sweeps > 0 {
            let first = bind(0, [1, 0], &returned);
            let mut encoder = gpu().encoder();
            pass.dispatch_groups(&mut encoder, &first, "light_behind", groups).unwrap();
            gpu().submit(encoder).unwrap();
            found.returned = returned.read(gpu()).unwrap();
        }
        run(0, "begin_light");
        for sheet in 0..count {
            draw(sheet);
            if self.sweeps > 0 {
                run(sheet, "light_behind");
                found.up.push(behind.read(gpu()).unwrap());
            }
            run(sheet, "scatter_rows");
            run(sheet, "scatter_columns");
            found.down.push(left.read_floats(gpu()).unwrap());
        }
        found.held = held.read(gpu()).unwrap();
        found
    }
}
