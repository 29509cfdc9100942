// SPDX-License-Identifier: MIT OR Apache-2.0
//! A lit scene on the GPU, with everything that a system of light shafts is given by an engine.

use crate::core::{
    Camera, CameraError, Cascades, Drawing, Light, LightError, MeshBuffers, POINT, Pictures, Raster,
    ShadowViews, Sky, View,
};
use crate::data::{Bounds, LightImage, Mesh};
use crate::gpu::{Gpu, GpuError};
use crate::pass::PassError;
use crate::resource::{Buffer, Texture};
use crate::scattering::{Inputs, Medium, SettingsError, check_size};
use glam::Vec3;
use std::fmt;

/// Why a scene could not be put on the GPU.
#[derive(Debug, thiserror::Error)]
pub enum StageError {
    /// The camera.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The light.
    #[error(transparent)]
    Light(#[from] LightError),
    /// The size of a picture, of a shadow map or of the light texture.
    #[error(transparent)]
    Size(#[from] SettingsError),
    /// The number of samples a pixel.
    #[error("{0} samples a pixel are impossible: 1 and 4 are possible")]
    Samples(u32),
    /// A pass.
    #[error(transparent)]
    Pass(#[from] PassError),
}

impl From<GpuError> for StageError {
    fn from(error: GpuError) -> Self {
        Self::Pass(error.into())
    }
}

/// A light in the words of a person.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lighting {
    /// At infinity.
    Directional {
        /// Direction TOWARDS the light, of any length.
        towards: Vec3,
        /// Irradiance at normal incidence, linear RGB.
        radiance: Vec3,
    },
    /// At a point, into a cone.
    Spot {
        /// Where it is, metres.
        position: Vec3,
        /// Where its axis points, metres.
        target: Vec3,
        /// Degrees from the axis to where there is no light.
        outer_degrees: f32,
        /// Degrees from the axis to where the light begins to fall off.
        inner_degrees: f32,
        /// Radiant intensity, linear RGB: the irradiance at one metre.
        intensity: Vec3,
        /// Metres; nearer to it the fall-off with distance stops.
        radius: f32,
    },
    /// At a point, everywhere.
    Point {
        /// Where it is, metres.
        position: Vec3,
        /// Radiant intensity, linear RGB: the irradiance at one metre.
        intensity: Vec3,
        /// Metres; nearer to it the fall-off with distance stops.
        radius: f32,
    },
}

impl Lighting {
    /// A light at infinity.
    pub fn directional(towards: Vec3, radiance: Vec3) -> Self {
        Self::Directional { towards, radiance }
    }

    /// The light with shadow maps for blockers in `bounds`, forward depth. Blockers nearer to a spot or point light
    /// than a thousandth of its range are not seen.
    ///
    /// # Errors
    /// [`LightError`].
    pub fn fitted(&self, bounds: &Bounds) -> Result<Light, LightError> {
        match *self {
            Self::Directional { towards, radiance } => {
                Light::directional(towards, radiance, bounds.min, bounds.max)
            }
            Self::Spot { position, target, outer_degrees, inner_degrees, intensity, radius } => {
                let [near, far] = local_range(position, bounds);
                Light::spot(position, target, outer_degrees, inner_degrees, intensity, radius, near, far)
            }
            Self::Point { position, intensity, radius } => {
                let [near, far] = local_range(position, bounds);
                Light::point(position, intensity, radius, near, far)
            }
        }
    }
}

/// Distances from a light that hold all blockers.
fn local_range(position: Vec3, bounds: &Bounds) -> [f32; 2] {
    let reach = bounds.corners().iter().map(|corner| corner.distance(position)).fold(0.0, f32::max);
    let far = if reach > 1e-3 { 1.01 * reach } else { 1.0 };
    [1e-3 * far, far]
}

impl fmt::Display for Lighting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Directional { towards, .. } => write!(f, "light {towards:.3}"),
            Self::Spot { position, target, outer_degrees, .. } => {
                write!(f, "spot at {position:.2} aimed at {target:.2}, {outer_degrees}°")
            }
            Self::Point { position, .. } => write!(f, "point light at {position:.2}"),
        }
    }
}

/// A scene in the words of a person.
#[derive(Clone, Copy)]
pub struct Setting<'a> {
    /// What is drawn and what casts shadows.
    pub mesh: &'a Mesh,
    /// The camera.
    pub view: View,
    /// The light.
    pub light: Lighting,
    /// What colours a directional light or a spot, over its whole shadow map.
    pub light_texture: Option<&'a LightImage>,
    /// Shadow maps of a directional light fitted to parts of the view, besides the one of the whole scene.
    pub cascades: Option<Cascades>,
    /// Sky and ground.
    pub sky: Sky,
    /// The air.
    pub medium: Medium,
    /// Samples a pixel, 1 or 4.
    pub samples: u32,
}

/// Shadow maps of a part of a scene.
pub struct PartShadows {
    /// Depth from a directional light or a spot; one empty texel for a point light.
    pub shadow_map: Texture,
    /// Depth in the views of the light, where it has several.
    pub shadow_maps: Option<Texture>,
}

/// A scene on the GPU: uniforms, shadow maps, picture and depth.
pub struct Stage {
    /// The camera.
    pub camera: Camera,
    /// The light, its shadow map fitted to the mesh.
    pub light: Light,
    /// Cascades, or the faces around a point light.
    pub views: Option<ShadowViews>,
    /// The air.
    pub medium: Medium,
    /// Uniform of the camera.
    pub camera_buffer: Buffer,
    /// Uniform of the light.
    pub light_buffer: Buffer,
    /// Uniform of the medium.
    pub medium_buffer: Buffer,
    /// Uniform of the views.
    pub shadow_views: Option<Buffer>,
    /// What colours the light, rgba16float.
    pub light_texture: Option<Texture>,
    /// Shadow maps, surface radiance, depth.
    pub pictures: Pictures,
}

impl Stage {
    /// Renders the shadow maps and the picture of a scene. `shadow_map`: size of the standard shadow map and of each
    /// cascade; the faces around a point light are squares of half its lesser side.
    ///
    /// # Errors
    /// [`StageError`].
    pub fn new(
        gpu: &Gpu,
        raster: &Raster,
        setting: &Setting<'_>,
        viewport: [u32; 2],
        shadow_map: [u32; 2],
    ) -> Result<Self, StageError> {
        check_size(gpu, "a picture", viewport)?;
        check_size(gpu, "a shadow map", shadow_map)?;
        if !matches!(setting.samples, 1 | 4) {
            return Err(StageError::Samples(setting.samples));
        }
        let camera = Camera::new(&setting.view, viewport)?;
        let bounds = setting.mesh.bounds().unwrap_or(Bounds { min: Vec3::ZERO, max: Vec3::ZERO });
        let light = setting.light.fitted(&bounds)?;
        let views = match (setting.light, setting.cascades) {
            (Lighting::Point { position, .. }, None) => {
                let [near, far] = local_range(position, &bounds);
                let side = (shadow_map[0].min(shadow_map[1]) / 2).max(1);
                Some((ShadowViews::cube(position, near, far)?, [side, side]))
            }
            (_, None) => None,
            (_, Some(cascades)) => {
                let limit = setting.medium.distance_limit;
                let bounds = [bounds.min, bounds.max];
                Some((ShadowViews::cascades(&light, &camera, cascades, limit, bounds)?, shadow_map))
            }
        };
        let light_texture = match (setting.light_texture, setting.light) {
            (None, _) => None,
            (Some(_), Lighting::Point { .. }) => return Err(LightError::TextureOfPoint.into()),
            (Some(image), _) => Some(self::light_texture(gpu, image)?),
        };
        let meshes = [MeshBuffers::new(gpu, setting.mesh)];
        let pictures = raster.draw(
            gpu,
            &Drawing {
                camera: &camera,
                light: &light,
                sky: &setting.sky,
                meshes: &meshes,
                shadow_map,
                views: views.as_ref().map(|(views, size)| (views, *size)),
                light_texture: light_texture.as_ref(),
                samples: setting.samples,
            },
        )?;
        let views = views.map(|(views, _)| views);
        Ok(Self {
            camera,
            light,
            medium: setting.medium,
            camera_buffer: Buffer::uniform(gpu, &camera),
            light_buffer: Buffer::uniform(gpu, &light),
            medium_buffer: Buffer::uniform(gpu, &setting.medium),
            shadow_views: views.as_ref().map(|views| Buffer::uniform(gpu, views)),
            views,
            light_texture,
            pictures,
        })
    }

    /// The shadow maps of a part of the scene alone, drawn like those of the whole.
    ///
    /// # Errors
    /// [`StageError`].
    pub fn shadows_of(&self, gpu: &Gpu, raster: &Raster, mesh: &Mesh) -> Result<PartShadows, StageError> {
        let meshes = [MeshBuffers::new(gpu, mesh)];
        let [width, height, _] = self.pictures.shadow_map.size();
        let format = wgpu::TextureFormat::Depth32Float;
        let shadow_map = Texture::target(gpu, [width, height], format);
        let maps = self.pictures.shadow_maps.as_ref();
        let shadow_maps = maps.map(|maps| Texture::target_array(gpu, maps.size(), format));
        let mut encoder = gpu.encoder();
        if self.light.kind != POINT {
            raster.record_shadow_map(gpu, &mut encoder, &self.light_buffer, &meshes, &shadow_map)?;
        }
        if let (Some(views), Some(maps)) = (&self.shadow_views, &shadow_maps) {
            raster.record_shadow_maps(gpu, &mut encoder, views, maps.size()[2], &meshes, maps)?;
        }
        gpu.submit(encoder)?;
        Ok(PartShadows { shadow_map, shadow_maps })
    }

    /// What the passes are given.
    pub fn inputs(&self) -> Inputs<'_> {
        Inputs {
            camera: &self.camera_buffer,
            light: &self.light_buffer,
            medium: &self.medium_buffer,
            depth: &self.pictures.depth,
            shadow_map: &self.pictures.shadow_map,
            shadow_views: self.shadow_views.as_ref(),
            shadow_maps: self.pictures.shadow_maps.as_ref(),
            light_texture: self.light_texture.as_ref(),
        }
    }
}

/// A light texture as passes take it.
///
/// # Errors
/// [`StageError::Size`] beyond the device's limit.
pub fn light_texture(gpu: &Gpu, image: &LightImage) -> Result<Texture, StageError> {
    check_size(gpu, "a light texture", image.size())?;
    let usage = wgpu::TextureUsages::TEXTURE_BINDING;
    let texture = Texture::new(gpu, image.size(), wgpu::TextureFormat::Rgba16Float, usage);
    let values: Vec<f32> = image.texels().iter().flat_map(|texel| texel.extend(1.0).to_array()).collect();
    texture.write(gpu, &values)?;
    Ok(texture)
}
