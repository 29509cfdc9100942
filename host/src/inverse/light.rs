// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light that single scattering sends to the eye: opacity shadow maps of lights, and shadow maps of surfaces.

mod views;

pub use views::LightLayers;

use super::projector::{bricks, tiles};
use super::{Channels, InverseError, VoxelGrid};
use crate::core::{MeshBuffers, Raster};
use crate::data::{Bounds, EnvironmentLight};
use crate::gpu::Gpu;
use crate::out_of_range::in_range;
use crate::pass::{Pass, Resource};
use crate::resource::{Buffer, Sampler, Texture};
use crate::shaders::Shaders;
use crate::stage::Lighting;
use airlight_validate::Definitions;
use glam::{Mat4, UVec3};
use views::{LightView, views_of};
use wgpu::TextureFormat::Depth32Float;

/// Least and most texels and layers of a map that is chosen by itself.
const USUAL: [u32; 2] = [64, 192];

/// How finely a light's way through a volume is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LightMaps {
    /// Columns and rows of an opacity shadow map, 4 to 1024.
    pub texels: u32,
    /// Layers of it, 1 to 1024: steps of a light ray.
    pub layers: u32,
    /// Columns and rows of a shadow map of surfaces, 4 to 8192.
    pub shadow_texels: u32,
}

impl LightMaps {
    /// Three texels and layers a voxel of the longest side, 64 to 192 of them; shadow maps of 1024 texels.
    pub fn of_volume(size: [u32; 3]) -> Self {
        let longest = size.into_iter().max().unwrap_or(1);
        let [least, most] = USUAL;
        let texels = longest.saturating_mul(3).clamp(least, most);
        Self { texels, layers: texels, shadow_texels: 1024 }
    }

    fn check(self) -> Result<(), InverseError> {
        let Self { texels, layers, shadow_texels } = self;
        in_range("texels of an opacity shadow map", texels as f32, 4.0..=1024.0, "from 4 to 1024")?;
        in_range("layers of an opacity shadow map", layers as f32, 1.0..=1024.0, "from 1 to 1024")?;
        Ok(in_range("texels of a shadow map", shadow_texels as f32, 4.0..=8192.0, "from 4 to 8192")?)
    }
}

/// Surfaces that cast shadows on a volume.
#[derive(Clone, Copy)]
pub struct ShadowCasters<'a> {
    /// What draws them.
    pub raster: &'a Raster,
    /// The surfaces.
    pub meshes: &'a [MeshBuffers],
    /// A box in the world that holds all of them, metres.
    pub bounds: Bounds,
}

/// A far light of the surroundings, for [`LightPasses::scattered`].
impl From<EnvironmentLight> for Lighting {
    fn from(light: EnvironmentLight) -> Self {
        Self::directional(light.direction, light.irradiance)
    }
}

/// Computes what lights make a volume scatter.
pub struct LightPasses {
    channels: Channels,
    maps: Option<LightMaps>,
    depths: Pass,
    /// Without surfaces and with them.
    scatter: [Pass; 2],
    pack: Pass,
    sampler: Sampler,
}

impl LightPasses {
    /// Builds all passes. With [`Channels::One`] the first channel of extinction and of lights is all that counts.
    ///
    /// # Errors
    /// [`InverseError::Pass`].
    pub fn new(gpu: &Gpu, shaders: &Shaders, channels: Channels) -> Result<Self, InverseError> {
        let pass = |name: &str, surfaces: bool| {
            let flags = [("RGB", channels == Channels::Rgb), ("SURFACES", surfaces)];
            let flags = flags.iter().filter(|(_, set)| *set);
            let definitions = flags.fold(Definitions::new(), |all, (flag, _)| all.flag(*flag));
            Pass::compute_with(gpu, shaders, name, &definitions)
        };
        Ok(Self {
            channels,
            maps: None,
            depths: pass("inverse/light_depths", false)?,
            scatter: [pass("inverse/scatter_light", false)?, pass("inverse/scatter_light", true)?],
            pack: pass("inverse/pack_volume", false)?,
            sampler: Sampler::shadow(gpu),
        })
    }

    /// The same with maps of a size; else they are those of [`LightMaps::of_volume`] for the extinction.
    ///
    /// # Errors
    /// [`InverseError::Setting`].
    pub fn with_maps(self, maps: LightMaps) -> Result<Self, InverseError> {
        maps.check()?;
        Ok(Self { maps: Some(maps), ..self })
    }

    /// Radiance that an albedo of 1 scatters towards the eye, the same in every direction, at the middles of `size` voxels: irradiance
    /// over 4 pi, times transmittance through the volume, times what `surfaces` let pass; black without lights.
    /// `extinction`: 1/m, of as many channels. `world_from_unit`: the box 0..1 of the volume in the world, metres.
    ///
    /// # Errors
    /// [`InverseError::Light`] and [`InverseError::Setting`] for lights that are impossible, [`InverseError::Camera`] for a box without
    /// an inverse, [`InverseError::Count`] for an extinction of other channels, [`InverseError::Memory`], [`InverseError::Pass`].
    pub fn scattered(
        &self,
        gpu: &Gpu,
        extinction: &Texture,
        world_from_unit: Mat4,
        size: [u32; 3],
        lights: &[Lighting],
        surfaces: Option<ShadowCasters<'_>>,
    ) -> Result<Texture, InverseError> {
        let maps = self.maps.unwrap_or_else(|| LightMaps::of_volume(extinction.size()));
        self.fitting(gpu, size)?;
        let scattered = Texture::storage_volume(gpu, size, self.channels.format());
        self.scatter_into(gpu, [extinction, &scattered], world_from_unit, lights, surfaces, maps)?;
        Ok(scattered)
    }

    /// What each of several groups of lights makes the volume scatter, such as the lights of a disc with irradiance for a radiance
    /// of 1 ([`crate::data::DiscLights::lights`]).
    ///
    /// # Errors
    /// As [`Self::scattered`].
    pub fn scattered_each(
        &self,
        gpu: &Gpu,
        extinction: &Texture,
        world_from_unit: Mat4,
        size: [u32; 3],
        groups: &[Vec<Lighting>],
        surfaces: Option<ShadowCasters<'_>>,
    ) -> Result<Vec<Texture>, InverseError> {
        let scattered =
            |lights: &Vec<Lighting>| self.scattered(gpu, extinction, world_from_unit, size, lights, surfaces);
        groups.iter().map(scattered).collect()
    }

    /// What [`Self::scattered`] does, into a texture that is there. `volumes`: extinction and scattered light.
    fn scatter_into(
        &self,
        gpu: &Gpu,
        [extinction, scattered]: [&Texture; 2],
        world_from_unit: Mat4,
        lights: &[Lighting],
        surfaces: Option<ShadowCasters<'_>>,
        maps: LightMaps,
    ) -> Result<(), InverseError> {
        let size = scattered.size();
        let (needed, given) = (self.channels.numbers(), usize::from(extinction.raw.format().components()));
        if needed != given {
            return Err(InverseError::Count { name: "voxels of the extinction", needed, given });
        }
        let bytes = self.fitting(gpu, size)?;
        for light in lights {
            check(light)?;
        }
        let casters = surfaces.map(|surfaces| surfaces.bounds);
        let mut views = Vec::new();
        for light in lights {
            views.extend(views_of(light, world_from_unit, size, casters, maps)?);
        }
        let depths =
            Texture::storage_volume(gpu, [maps.texels, maps.texels, maps.layers + 1], self.channels.format());
        let shadow_map = surfaces.map(|_| Texture::target(gpu, [maps.shadow_texels; 2], Depth32Float));
        let sums = Buffer::storage(gpu, bytes);
        for view in &views {
            let mut encoder = gpu.encoder();
            let light = Buffer::uniform(gpu, &view.light);
            if let (Some(surfaces), Some(map)) = (surfaces, &shadow_map) {
                surfaces.raster.record_shadow_map(gpu, &mut encoder, &light, surfaces.meshes, map)?;
            }
            self.add_view(
                gpu,
                &mut encoder,
                view,
                [extinction, &depths],
                &light,
                &sums,
                shadow_map.as_ref(),
            )?;
            gpu.submit(encoder)?;
        }
        let grid = Buffer::uniform(gpu, &VoxelGrid { size: UVec3::from(size), reserved_a: 0 });
        let resources: [(&str, Resource<'_>); 3] =
            [("grid", (&grid).into()), ("vector", (&sums).into()), ("volume", scattered.into())];
        let bound = self.pack.bind_known(gpu, &resources)?;
        let mut encoder = gpu.encoder();
        self.pack.dispatch_groups(&mut encoder, &bound, "pack_volume", bricks(size))?;
        Ok(gpu.submit(encoder)?)
    }

    /// Bytes of a volume's numbers, if the device holds them in one piece.
    fn fitting(&self, gpu: &Gpu, size: [u32; 3]) -> Result<u64, InverseError> {
        let voxels = size.into_iter().map(u64::from).product::<u64>();
        let bytes = voxels.saturating_mul(4 * self.channels.numbers() as u64);
        let limit = gpu.limits.max_storage_buffer_binding_size;
        if bytes <= limit {
            return Ok(bytes);
        }
        Err(InverseError::Memory { name: "volumes of scattered light", bytes, limit })
    }

    #[allow(clippy::too_many_arguments)]
    fn add_view(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &LightView,
        [extinction, depths]: [&Texture; 2],
        light: &Buffer,
        sums: &Buffer,
        shadow_map: Option<&Texture>,
    ) -> Result<(), InverseError> {
        let layers = Buffer::uniform(gpu, &view.layers);
        let slices = Buffer::uniform(gpu, &view.view);
        let mut resources: Vec<(&str, Resource<'_>)> = vec![
            ("view", (&slices).into()),
            ("layers", (&layers).into()),
            ("light", light.into()),
            ("extinction", extinction.into()),
            ("depths", depths.into()),
            ("sums", sums.into()),
        ];
        if let Some(map) = shadow_map {
            resources.extend([("shadow_map", map.into()), ("shadow_sampler", (&self.sampler).into())]);
        }
        let bound = self.depths.bind_known(gpu, &resources)?;
        self.depths.dispatch_groups(
            encoder,
            &bound,
            "light_depths",
            tiles([view.view.width, view.view.height]),
        )?;
        let scatter = &self.scatter[usize::from(shadow_map.is_some())];
        let bound = scatter.bind_known(gpu, &resources)?;
        let groups = bricks(view.layers.size.to_array());
        Ok(scatter.dispatch_groups(encoder, &bound, "scatter_light", groups)?)
    }
}

/// Refuses light that is negative or no number. Directions, places and cones are refused where views are made.
fn check(light: &Lighting) -> Result<(), InverseError> {
    let (name, power) = match *light {
        Lighting::Directional { radiance, .. } => ("irradiance of a light", radiance),
        Lighting::Spot { intensity, .. } | Lighting::Point { intensity, .. } => {
            ("radiant intensity of a light", intensity)
        }
    };
    for channel in power.to_array() {
        in_range(name, channel, 0.0..=f32::MAX, "0 or more and finite")?;
    }
    Ok(())
}
