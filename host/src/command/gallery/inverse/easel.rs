// SPDX-License-Identifier: MIT OR Apache-2.0
//! A medium before a background, painted views of it, and what is solved for from them.

use super::super::studio::Studio;
use super::super::transmittance::sky::{Sky, directions};
use crate::command::CommandError;
use crate::command::inverse::field::{Field, colours, numbers};
use crate::command::inverse::paint::{Canvas, Grade};
use crate::command::inverse::studio::Picture;
use crate::core::{Camera, DepthRange, PerspectiveView};
use crate::data::{Environment, Volume};
use crate::inverse::{
    Basis, Channels, Fields, InverseError, LightMaps, LightPasses, Medium, Projector, ProjectorForm,
    Regulariser, SliceView, Solved, Solver, Target, Unknown, radiance_targets, touched,
};
use crate::{Lighting, Texture};
use glam::{Mat4, Vec3};
use std::sync::Arc;
use wgpu::TextureFormat::Rgba32Float;

/// Pictures and volumes are in colour.
pub const RGB: Channels = Channels::Rgb;
/// A picture that is solved for has so many columns; what is shown may be larger.
pub const COLUMNS: u32 = 320;
/// Texels and layers of the maps that light a medium: skies are soft.
const MAPS: LightMaps = LightMaps { texels: 96, layers: 96, shadow_texels: 4 };
/// Lights that stand for a sky.
const SKY_LIGHTS: u32 = 16;

/// A day without haze.
pub fn clear_sky() -> Sky {
    Sky {
        zenith: Vec3::new(0.05, 0.13, 0.33),
        horizon: Vec3::new(0.34, 0.46, 0.60),
        glow: Vec3::new(0.2, 0.16, 0.1),
        haze: 0.45,
    }
}

/// What a medium is made of besides its extinction.
#[derive(Clone)]
pub struct Paint {
    /// Radiance.
    pub emission: Field,
    /// 0..1.
    pub albedo: Field,
}

impl Paint {
    /// Without emission, and of one albedo.
    pub fn plain(albedo: f32) -> Self {
        Self { emission: Field::constant(Vec3::ZERO), albedo: Field::constant(Vec3::splat(albedo)) }
    }
}

/// A place to look from.
#[derive(Clone, Copy)]
pub struct Pose {
    /// Metres.
    pub eye: Vec3,
    /// Metres.
    pub target: Vec3,
    /// Vertical, degrees.
    pub field_of_view: f32,
}

impl Pose {
    /// On a circle about a target: `azimuth` in degrees from +z towards +x, `height` above it in metres.
    pub fn around(target: Vec3, [distance, height]: [f32; 2], azimuth: f32, field_of_view: f32) -> Self {
        let (sine, cosine) = azimuth.to_radians().sin_cos();
        let eye = target + Vec3::new(distance * sine, height, distance * cosine);
        Self { eye, target, field_of_view }
    }

    /// Its camera.
    pub fn camera(&self, size: [u32; 2]) -> Result<Camera, CommandError> {
        let Self { eye, target, field_of_view } = *self;
        let depth = DepthRange::Forward;
        let view = PerspectiveView { eye, target, field_of_view, near: 0.05, far: 1000.0, depth };
        Camera::perspective(&view, size).map_err(CommandError::failure)
    }
}

/// A view with what lies behind the medium.
pub struct Board {
    /// Its camera.
    pub camera: Camera,
    /// Columns and rows.
    pub size: [u32; 2],
    /// Radiance a pixel.
    pub background: Vec<Vec3>,
}

impl Board {
    /// `behind`: radiance that comes along a ray from the eye, of a direction of length 1.
    pub fn new(
        pose: &Pose,
        size: [u32; 2],
        behind: impl Fn(Vec3, Vec3) -> Vec3,
    ) -> Result<Self, CommandError> {
        let camera = pose.camera(size)?;
        let background = directions(&camera, size).into_iter().map(|way| behind(pose.eye, way)).collect();
        Ok(Self { camera, size, background })
    }
}

/// What is wanted of a view.
pub struct Wish<'a> {
    /// The view.
    pub board: &'a Board,
    /// Radiance a pixel, background included.
    pub picture: &'a [Vec3],
    /// How much each pixel counts.
    pub weights: Vec<f32>,
}

impl<'a> Wish<'a> {
    /// Of which all pixels count alike.
    pub fn even(board: &'a Board, picture: &'a [Vec3]) -> Self {
        Self { board, picture, weights: vec![1.0; picture.len()] }
    }
}

/// How hard a solver tries.
#[derive(Clone, Copy)]
pub struct Effort {
    /// How often.
    pub iterations: u32,
    /// Weight of the squared Laplacian.
    pub laplacian: f32,
    /// Whether empty voxels are solved for too.
    pub empty: bool,
}

/// A medium in its light.
pub struct Easel<'a> {
    /// What all sections share.
    pub studio: &'a Studio,
    /// From the box 0..1 to the world, metres.
    pub place: Mat4,
    /// 1/m.
    pub extinction: Field,
    /// For passes.
    pub medium: Arc<Medium>,
    /// Lights media.
    pub lighting: Arc<LightPasses>,
    renderer: Arc<Projector>,
}

/// The extinction of a volume as a field of colours.
pub fn grey(volume: &Volume) -> Field {
    Field { size: volume.size, values: volume.values.iter().map(|value| Vec3::splat(*value)).collect() }
}

/// A sun, and lights that stand for the sky. `sun`: towards it, and its irradiance.
pub fn daylight(sky: &Sky, (sun, irradiance): (Vec3, Vec3)) -> Result<Vec<Lighting>, CommandError> {
    let towards = sun.normalize_or(Vec3::Y);
    // Below the horizon a dim reflection of it.
    let radiance = |way: Vec3| {
        let lit = sky.radiance(Vec3::new(way.x, way.y.abs(), way.z), towards);
        if way.y > 0.0 { lit } else { 0.35 * lit }
    };
    let map = Environment::from_function([64, 32], radiance).map_err(CommandError::failure)?;
    let mut lights = vec![Lighting::directional(towards, irradiance)];
    lights.extend(map.sample_lights(SKY_LIGHTS, 7).into_iter().map(Lighting::from));
    Ok(lights)
}

/// The size of pictures that are solved for, of the shape of those that are shown.
pub fn solve_size([width, height]: [u32; 2], columns: u32) -> [u32; 2] {
    let columns = columns.min(width);
    [columns, (columns * height).div_ceil(width).max(1)]
}

impl<'a> Easel<'a> {
    /// A volume of extinctions under lights.
    pub fn new(studio: &'a Studio, volume: &Volume, lights: &[Lighting]) -> Result<Self, CommandError> {
        let (gpu, shaders) = (&studio.gpu, &studio.shaders);
        let lighting = Arc::new(LightPasses::new(gpu, shaders, RGB)?.with_maps(MAPS)?);
        let renderer = Arc::new(Projector::new(gpu, shaders, ProjectorForm::new(Solved::Both, RGB))?);
        let nothing = [(); 2].map(|()| Field::constant(Vec3::ZERO).texture(gpu, RGB));
        let [extinction, scattered] = nothing;
        let medium = Arc::new(Medium { extinction: extinction?, scattered: scattered?, index: None });
        let (place, extinction) = (volume.world_from_unit, Field::constant(Vec3::ZERO));
        Self { studio, place, extinction, medium, lighting, renderer }.of(volume, lights)
    }

    /// Another volume under other lights.
    pub fn of(&self, volume: &Volume, lights: &[Lighting]) -> Result<Self, CommandError> {
        let (gpu, place) = (&self.studio.gpu, volume.world_from_unit);
        let extinction = grey(volume);
        let texture = extinction.texture(gpu, RGB)?;
        let scattered = self.lighting.scattered(gpu, &texture, place, volume.size, lights, None)?;
        let medium = Arc::new(Medium { extinction: texture, scattered, index: None });
        Ok(Self { place, extinction, medium, ..self.shared() })
    }

    /// The same volume, and what an albedo of 1 scatters in it.
    pub fn relit(&self, scattered: &Field) -> Result<Self, CommandError> {
        let gpu = &self.studio.gpu;
        let (extinction, scattered) = (self.extinction.texture(gpu, RGB)?, scattered.texture(gpu, RGB)?);
        Ok(Self { medium: Arc::new(Medium { extinction, scattered, index: None }), ..self.shared() })
    }

    fn shared(&self) -> Self {
        Self {
            studio: self.studio,
            place: self.place,
            extinction: self.extinction.clone(),
            medium: Arc::clone(&self.medium),
            lighting: Arc::clone(&self.lighting),
            renderer: Arc::clone(&self.renderer),
        }
    }

    /// The rays of a camera.
    pub fn rays(&self, camera: &Camera) -> Result<SliceView, InverseError> {
        let longest = self.extinction.size.into_iter().max().unwrap_or(1);
        SliceView::new(camera, self.place, self.extinction.size, longest)
    }

    /// What a camera sees of the medium.
    pub fn picture(&self, camera: &Camera, paint: &Paint) -> Result<Picture, CommandError> {
        let gpu = &self.studio.gpu;
        let view = self.renderer.view(gpu, &self.rays(camera)?, None)?;
        let (emission, albedo) = (paint.emission.texture(gpu, RGB)?, paint.albedo.texture(gpu, RGB)?);
        let fields = Fields { emission: &emission, albedo: &albedo, extinction: &self.medium.extinction };
        let mut encoder = gpu.encoder();
        self.renderer.render(gpu, &mut encoder, &view, &self.medium, fields)?;
        gpu.submit(encoder)?;
        let [radiance, through] = [&view.rendered, &view.through].map(|image| image.read(gpu));
        Ok(Picture { radiance: colours(&radiance?, RGB), through: colours(&through?, RGB) })
    }

    /// The same before what lies behind, and the opacity of each pixel.
    pub fn shown(&self, board: &Board, paint: &Paint) -> Result<(Vec<Vec3>, Vec<f32>), CommandError> {
        let picture = self.picture(&board.camera, paint)?;
        let opacity = picture.through.iter().map(|through| 1.0 - through.element_sum() / 3.0);
        Ok((picture.over(&board.background), opacity.collect()))
    }

    /// Solves for emission, albedo or both of what views want, which replace those of `start`.
    pub fn solve(
        &self,
        solved: Solved,
        start: &Paint,
        wishes: &[Wish<'_>],
        effort: Effort,
    ) -> Result<Paint, CommandError> {
        let (gpu, shaders) = (&self.studio.gpu, &self.studio.shaders);
        let (emission, albedo) = (solved != Solved::Albedo, solved != Solved::Emission);
        let nothing = Field::constant(Vec3::ZERO);
        let mut known = start.clone();
        let mut unknowns = Vec::new();
        for (wanted, field, high) in [(emission, &mut known.emission, 1e30), (albedo, &mut known.albedo, 1.0)]
        {
            if wanted {
                let begun = std::mem::replace(field, nothing.clone());
                unknowns.push(self.unknown(&begun, high, effort)?);
            }
        }
        let projector = Projector::new(gpu, shaders, ProjectorForm::new(solved, RGB))?;
        let mut targets = Vec::with_capacity(wishes.len());
        for wish in wishes {
            let Picture { radiance, through } = self.picture(&wish.board.camera, &known)?;
            let [picture, background, through, radiance] =
                [wish.picture, &wish.board.background, &through, &radiance].map(|of| numbers(of, RGB));
            targets.push(Target {
                view: projector.view(gpu, &self.rays(&wish.board.camera)?, None)?,
                medium: Arc::clone(&self.medium),
                wanted: radiance_targets(&picture, &background, &through, &radiance)?,
                weights: wish.weights.clone(),
            });
        }
        let mut solver = Solver::new(gpu, shaders, projector, targets, &unknowns)?;
        for _ in 0..effort.iterations {
            solver.iterate(gpu)?;
        }
        let mut found = start.clone();
        let mut solutions = solver.solutions(gpu)?.into_iter();
        for (wanted, field) in [(emission, &mut found.emission), (albedo, &mut found.albedo)] {
            if let Some(values) = wanted.then(|| solutions.next()).flatten() {
                *field = Field { size: self.extinction.size, values: colours(&values, RGB) };
            }
        }
        Ok(found)
    }

    fn unknown(&self, start: &Field, high: f32, effort: Effort) -> Result<Unknown, InverseError> {
        let size = self.extinction.size;
        let dense: Vec<bool> = self.extinction.values.iter().map(|value| value.x > 0.0).collect();
        let solved = if effort.empty {
            vec![true; dense.len()]
        } else {
            touched(size, Basis::Triangle, size, &dense)?
        };
        Ok(Unknown {
            size,
            solved,
            start: numbers(&start.resized(size).values, RGB),
            high,
            regulariser: Regulariser { laplacian: effort.laplacian, ..Regulariser::default() },
        })
    }
}

/// A picture whose medium is graded and what lies behind it is not. Of thin medium the colour is graded that it has where it is thick, so that
/// borders change as all the rest does.
pub fn graded(grade: &Grade, board: &Board, picture: &Picture) -> Canvas {
    let opacity: Vec<f32> =
        picture.through.iter().map(|through| (1.0 - through.element_sum() / 3.0).max(0.02)).collect();
    let thick = picture.radiance.iter().zip(&opacity).map(|(color, opacity)| *color / *opacity);
    let thick = grade.apply(&Canvas::new(board.size, thick.collect()));
    let pixels = thick.pixels().iter().zip(&opacity).zip(&picture.through).zip(&board.background);
    let pixels =
        pixels.map(|(((color, opacity), through), behind)| *color * *opacity + *through * *behind).collect();
    Canvas::new(board.size, pixels)
}

/// Pixels as they are shown, 4 bytes each.
pub fn pixels(
    studio: &Studio,
    radiance: &[Vec3],
    size: [u32; 2],
    exposure: f32,
) -> Result<Vec<u8>, CommandError> {
    let texture = Texture::storage(&studio.gpu, size, Rgba32Float);
    texture.write(&studio.gpu, &numbers(radiance, RGB))?;
    studio.pixels(&texture, exposure)
}

/// Peak signal to noise ratio of pixels as they are shown, dB: of the whole picture, and of where there is medium.
pub fn fidelity(found: &[u8], wanted: &[u8], opacity: &[f32]) -> [f64; 2] {
    let (mut all, mut own) = ([0.0, 0.0], [0.0, 0.0]);
    for ((found, wanted), opacity) in found.chunks_exact(4).zip(wanted.chunks_exact(4)).zip(opacity) {
        let wrong: f64 = (0..3).map(|i| (f64::from(found[i]) - f64::from(wanted[i])).powi(2)).sum();
        let add = |sums: &mut [f64; 2]| *sums = [sums[0] + wrong, sums[1] + 3.0];
        add(&mut all);
        if *opacity > 0.02 {
            add(&mut own);
        }
    }
    [all, own].map(|[wrong, count]| {
        10.0 * (255.0_f64.powi(2) * f64::max(count, 1.0) / f64::max(wrong, 1e-6)).log10()
    })
}

/// As facts say it.
pub fn decibels([all, own]: [f64; 2]) -> String {
    format!("{all:.1} dB of the picture, {own:.1} dB of the medium in it")
}
