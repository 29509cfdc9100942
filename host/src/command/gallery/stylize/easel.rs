// SPDX-License-Identifier: MIT OR Apache-2.0
//! A scene whose shadow maps and whose scattered light are changed, and what comes out as pixels.

use super::super::studio::Studio;
use crate::command::CommandError;
use crate::core::{DepthRange, POINT};
use crate::data::Bounds;
use crate::scattering::{Inputs, Prefiltered};
use crate::scenes::{self, Parts, Scene};
use crate::stage::PartShadows;
use crate::stylize::{
    Baker, HoleError, HoleParameters, HolePattern, Holes, Keyed, PickScene, Restyle, ShadowMaps,
    ShadowOperator, ShadowStyle, StylizedShadows, Transfer, shadow_map_extent,
};
use crate::{Buffer, Stage, Texture};
use glam::{Mat4, Vec2, Vec3};
use std::collections::BTreeMap;

/// A scene on the device, its object known by itself, and the passes of its scattered light.
pub struct Easel<'a> {
    studio: &'a Studio,
    /// Pixels of the pictures.
    pub size: [u32; 2],
    /// The scene.
    pub scene: Scene,
    /// The same on the device.
    pub stage: Stage,
    parts: Option<[PartShadows; 2]>,
    object: Bounds,
    prefiltered: Prefiltered,
}

/// What is done to the shadow maps.
#[derive(Clone, Copy, Default)]
pub struct Change<'a> {
    /// Holes in the object.
    pub holes: Option<Holes>,
    /// Seconds.
    pub time: f64,
    /// Operators on the whole.
    pub operators: &'a [ShadowOperator],
}

impl Change<'_> {
    /// Holes that stand still.
    pub fn holes(holes: Holes) -> Self {
        Self { holes: Some(holes), ..Self::default() }
    }
}

impl<'a> Easel<'a> {
    /// A scene with pictures of the studio's size.
    pub fn new(studio: &'a Studio, name: &str, map: u32) -> Result<Self, CommandError> {
        Self::sized(studio, name, map, studio.size)
    }

    /// A scene with standard shadow maps of `map` texels a side and pictures of `size`.
    pub fn sized(studio: &'a Studio, name: &str, map: u32, size: [u32; 2]) -> Result<Self, CommandError> {
        let parts = scenes::parts(name)?;
        let (scene, meshes) = match parts {
            Some(Parts { scene, object, rest }) => (scene, Some([object, rest])),
            None => {
                let scene = scenes::scene(name)?;
                (scene.ok_or_else(|| CommandError::failure(format!("no scene `{name}`")))?, None)
            }
        };
        let gpu = &studio.gpu;
        let stage = Stage::new(gpu, &studio.raster, &scene.setting(), size, [map, map])?;
        let object = meshes.as_ref().and_then(|[object, _]| object.bounds()).or_else(|| scene.mesh.bounds());
        let object = object.unwrap_or(Bounds { min: Vec3::ZERO, max: Vec3::ONE });
        let parts = match meshes {
            Some([object, rest]) => {
                let shadows = |mesh| stage.shadows_of(gpu, &studio.raster, mesh);
                Some([shadows(&object)?, shadows(&rest)?])
            }
            None => None,
        };
        let prefiltered = Prefiltered::new(gpu, &studio.shaders, studio.settings_of(&stage), size)?;
        Ok(Self { studio, size, scene, stage, parts, object, prefiltered })
    }

    /// The holes of a change in each map of the light.
    pub fn holes(&self, change: &Change<'_>) -> Result<Vec<HoleParameters>, CommandError> {
        let Some(holes) = change.holes else { return Ok(Vec::new()) };
        let stage = &self.stage;
        // Around a lantern with the light in it, its surface counts and not its middle.
        let distance = self.object.center().distance(stage.light.position).max(0.5 * self.object.radius());
        let parameters = |matrix: &Mat4| {
            let extent = shadow_map_extent(matrix, distance);
            HolePattern::new(&holes, extent, DepthRange::Forward)?.at(change.time)
        };
        let matrices = StylizedShadows::matrices(&stage.light, stage.views.as_ref());
        let all: Result<_, HoleError> = matrices.iter().map(parameters).collect();
        all.map_err(CommandError::failure)
    }

    /// The shadow maps with a change, not yet recorded.
    fn stylized(&self, change: &Change<'_>) -> Result<StylizedShadows, CommandError> {
        let stage = &self.stage;
        let matrices = StylizedShadows::matrices(&stage.light, stage.views.as_ref());
        let holes = self.holes(change)?;
        let drawn = stage.inputs();
        let (maps, rest) = match &self.parts {
            Some([object, rest]) if change.holes.is_some() => {
                (ShadowMaps::of_part(object), Some(ShadowMaps::of_part(rest)))
            }
            _ => (ShadowMaps::of(&drawn), None),
        };
        let style = ShadowStyle { holes: &holes, operators: change.operators };
        let over = (&stage.camera, &matrices[..]);
        StylizedShadows::new(&self.studio.gpu, &self.studio.shaders, &style, over, maps, rest)
            .map_err(CommandError::failure)
    }

    /// The same, recorded.
    pub fn shadows(&self, change: &Change<'_>) -> Result<StylizedShadows, CommandError> {
        let shadows = self.stylized(change)?;
        let mut encoder = self.studio.gpu.encoder();
        shadows.record(&mut encoder);
        self.studio.gpu.submit(encoder)?;
        Ok(shadows)
    }

    /// Milliseconds of a change.
    pub fn time(&self, shadows: &StylizedShadows) -> Result<f64, CommandError> {
        self.studio.time(&|encoder| shadows.record(encoder))
    }

    /// The light that is scattered with these inputs; the next call overwrites it.
    pub fn scatter(&self, inputs: &Inputs<'_>) -> Result<&Texture, CommandError> {
        let bound = self.prefiltered.bind(&self.studio.gpu, inputs)?;
        let mut encoder = self.studio.gpu.encoder();
        self.prefiltered.record(&mut encoder, &bound);
        self.studio.gpu.submit(encoder)?;
        Ok(&self.prefiltered.scattered)
    }

    /// The picture of a change.
    pub fn picture(&self, change: &Change<'_>) -> Result<Vec<u8>, CommandError> {
        let shadows = self.shadows(change)?;
        self.finish(self.scatter(&shadows.inputs(&self.stage.inputs()))?)
    }

    /// Surfaces seen through the air, and the light that it scatters, as pixels.
    pub fn finish(&self, scattered: &Texture) -> Result<Vec<u8>, CommandError> {
        let composed = self.studio.compose(&self.stage, scattered)?;
        self.studio.pixels(&composed, self.scene.exposure)
    }

    /// Scattered light alone, as pixels.
    pub fn light(&self, scattered: &Texture) -> Result<Vec<u8>, CommandError> {
        self.studio.pixels(scattered, self.scene.exposure)
    }

    /// The texture of a transfer function at a frame, its picks placed in `scattered`.
    pub fn function(
        &self,
        baker: &Baker,
        style: &Keyed<Transfer>,
        frame: f32,
        inputs: Inputs<'_>,
        scattered: &Texture,
    ) -> Result<Texture, CommandError> {
        let movements = BTreeMap::new();
        let (camera, medium) = (&self.stage.camera, &self.stage.medium);
        let scene = PickScene { camera, medium, inputs, scattered, movements: &movements };
        baker.bake_frame(&self.studio.gpu, style, frame, Some(&scene)).map_err(CommandError::failure)
    }

    /// Scattered light through a function.
    pub fn restyled(
        &self,
        style: &Keyed<Transfer>,
        frame: f32,
        map: &Texture,
        inputs: &Inputs<'_>,
        scattered: &Texture,
    ) -> Result<Texture, CommandError> {
        let gpu = &self.studio.gpu;
        let function = style.function(frame, &self.stage.medium);
        let restyle = Restyle::new(gpu, &self.studio.shaders, &function, inputs, self.size)
            .map_err(CommandError::failure)?;
        let uniform = Buffer::uniform(gpu, &function);
        let bound = restyle.bind(gpu, inputs, scattered, map, &uniform).map_err(CommandError::failure)?;
        let mut encoder = gpu.encoder();
        restyle.record(&mut encoder, &bound);
        gpu.submit(encoder)?;
        Ok(restyle.restyled)
    }

    /// The shadow map that `inputs` have, around the object and in the shape of a picture: the object and what is new in
    /// warm colours, everything else in cool ones, the paler the nearer to the light.
    pub fn map(&self, inputs: &Inputs<'_>) -> Result<Vec<u8>, CommandError> {
        let depths = self.around_object(inputs.shadow_map, 1.0)?;
        let drawn = &self.stage.pictures.shadow_map;
        let [object, rest] = match &self.parts {
            Some([object, rest]) => {
                [self.around_object(&object.shadow_map, 1.0)?, self.around_object(&rest.shadow_map, 1.0)?]
            }
            None => [self.around_object(drawn, 1.0)?, vec![1.0; depths.len()]],
        };
        let [warm, cool] = [Ramp::over(&object, WARM), Ramp::over(&rest, COOL)];
        // The ground is extruded a little, too, where it is seen from the side.
        let margin = 0.02 * (cool.far - cool.near);
        let color = |(depth, rest): (&f32, &f32)| match *depth {
            1.0.. => [9, 11, 17, 255],
            depth if depth < rest - margin => warm.color(depth),
            depth => cool.color(depth),
        };
        Ok(depths.iter().zip(&rest).flat_map(color).collect())
    }

    /// A map of one value a texel, 0..1, around the object, in grey.
    pub fn grey(&self, map: &Texture) -> Result<Vec<u8>, CommandError> {
        let grey = |value: &f32| {
            let value = (value.clamp(0.0, 1.0) * 255.0).round() as u8;
            [value, value, value, 255]
        };
        Ok(self.around_object(map, 0.0)?.iter().flat_map(grey).collect())
    }

    /// Texels around the object, in the shape of a picture, the nearest to each pixel; `beyond` the map.
    fn around_object(&self, map: &Texture, beyond: f32) -> Result<Vec<f32>, CommandError> {
        let [width, height, _] = map.size();
        let texels = map.read(&self.studio.gpu)?;
        let matrix = self.stage.light.clip_from_world;
        let (mut least, mut greatest) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for corner in self.object.corners() {
            let ndc = matrix.project_point3(corner).truncate();
            let uv = Vec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y);
            (least, greatest) = (least.min(uv), greatest.max(uv));
        }
        let (least, greatest) = (least.clamp(Vec2::ZERO, Vec2::ONE), greatest.clamp(Vec2::ZERO, Vec2::ONE));
        // Texels need not be square.
        let [across, down] = shadow_map_extent(&matrix, 1.0);
        let (metres, texel) = (Vec2::new(across, down), Vec2::new(width as f32, height as f32));
        let (middle, extent) = (0.5 * (least + greatest), (greatest - least) * metres * 1.12);
        let [wide, high] = self.size;
        let step = (extent.x / wide as f32).max(extent.y / high as f32) / metres;
        let at = |x: u32, y: u32| {
            let from_middle =
                Vec2::new(x as f32 + 0.5 - 0.5 * wide as f32, y as f32 + 0.5 - 0.5 * high as f32);
            let place = ((middle + from_middle * step) * texel).floor();
            let inside = place.cmpge(Vec2::ZERO).all() && place.cmplt(texel).all();
            if inside { texels[place.y as usize * width as usize + place.x as usize] } else { beyond }
        };
        Ok((0..high).flat_map(|y| (0..wide).map(move |x| (x, y))).map(|(x, y)| at(x, y)).collect())
    }

    /// Whether the light's map can be shown around the object.
    pub fn has_one_map(&self) -> bool {
        self.stage.light.kind != POINT
    }
}

const WARM: [Vec3; 3] =
    [Vec3::new(255.0, 238.0, 205.0), Vec3::new(226.0, 132.0, 62.0), Vec3::new(112.0, 50.0, 48.0)];
const COOL: [Vec3; 3] =
    [Vec3::new(92.0, 116.0, 140.0), Vec3::new(58.0, 74.0, 98.0), Vec3::new(32.0, 40.0, 58.0)];

/// Colours from the least depth that occurs to the greatest of a blocker.
struct Ramp {
    near: f32,
    far: f32,
    colors: [Vec3; 3],
}

impl Ramp {
    fn over(depths: &[f32], colors: [Vec3; 3]) -> Self {
        let near = depths.iter().copied().fold(1.0, f32::min);
        let far = depths.iter().copied().filter(|depth| *depth < 1.0).fold(near, f32::max);
        Self { near, far: far.max(near + 1e-6), colors }
    }

    fn color(&self, depth: f32) -> [u8; 4] {
        let place = 2.0 * ((depth - self.near) / (self.far - self.near)).clamp(0.0, 1.0);
        let stop = (place as usize).min(1);
        let color = self.colors[stop].lerp(self.colors[stop + 1], place - stop as f32);
        [color.x as u8, color.y as u8, color.z as u8, 255]
    }
}
