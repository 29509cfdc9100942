// SPDX-License-Identifier: MIT OR Apache-2.0
//! Views that lights have of a volume: one, or one for each face of a cube around a point light.

use super::super::{InverseError, SliceView};
use super::LightMaps;
use crate::core::{Camera, Light, ShadowViews};
use crate::data::Bounds;
use crate::stage::Lighting;
use encase::ShaderType;
use glam::{DMat4, DVec2, DVec3, DVec4, Mat4, UVec3, Vec2, Vec3, Vec4};

/// What is left of a map to each side of what it has to hold, of the whole.
const ROOM: f64 = 0.01;
/// The face that is all directions.
const EVERY_FACE: u32 = 6;

/// The uniform `LightLayers` of `inverse/light_layers`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct LightLayers {
    /// From the box 0..1 of the volume to the world, metres.
    pub world_from_unit: Mat4,
    /// What gives the layer of a point (x, y, z, 1) of the box, from 0 where the box begins as the light sees it.
    pub layer_of: Vec4,
    /// Voxels of scattered light along x, y and z.
    pub size: UVec3,
    /// Face of the cube around a point light, +x -x +y -y +z -z; 6 of other lights.
    pub face: u32,
}

/// A light's view of a volume.
pub(super) struct LightView {
    pub(super) view: SliceView,
    pub(super) layers: LightLayers,
    /// With the matrix of this view.
    pub(super) light: Light,
}

/// A projection of a light.
struct Projection {
    clip_from_world: DMat4,
    parallel: bool,
    eye: Vec3,
    face: u32,
}

/// The views that a light has of the box of a volume; none where it does not reach it.
pub(super) fn views_of(
    light: &Lighting,
    world_from_unit: Mat4,
    size: [u32; 3],
    casters: Option<Bounds>,
    maps: LightMaps,
) -> Result<Vec<LightView>, InverseError> {
    let corners: [Vec3; 8] = std::array::from_fn(|corner| {
        let bit = |axis: usize| (corner >> axis & 1) as f32;
        world_from_unit.transform_point3(Vec3::new(bit(0), bit(1), bit(2)))
    });
    let both = corners.into_iter().chain(casters.iter().flat_map(Bounds::corners));
    let bounds = Bounds::of(both).filter(|bounds| bounds.min.is_finite() && bounds.max.is_finite());
    let bounds = bounds.ok_or(InverseError::Camera)?;
    // Shadow maps of local lights hold everything; a directional one is fitted below.
    let own = light.fitted(&bounds)?;
    let projections = match *light {
        Lighting::Directional { towards, radiance } => {
            let fitted = Light::directional_around(towards, radiance, corners)?;
            let clip_from_world = reaching_back(fitted.clip_from_world.as_dmat4(), casters);
            vec![Projection { clip_from_world, parallel: true, eye: Vec3::ZERO, face: EVERY_FACE }]
        }
        Lighting::Spot { position, .. } => {
            let clip_from_world = own.clip_from_world.as_dmat4();
            vec![Projection { clip_from_world, parallel: false, eye: position, face: EVERY_FACE }]
        }
        Lighting::Point { position, .. } => {
            let far = bounds.corners().iter().map(|corner| corner.distance(position)).fold(1e-3, f32::max);
            let cube = ShadowViews::cube(position, 1e-3 * far, 1.01 * far)?;
            let face = |face: u32| Projection {
                clip_from_world: cube.clip_from_world[face as usize].as_dmat4(),
                parallel: false,
                eye: position,
                face,
            };
            (0..cube.count).map(face).collect()
        }
    };
    let mut views = Vec::new();
    for projection in projections {
        let Some(seen) = Seen::new(&projection, &corners) else { continue };
        views.push(seen.view(&projection, own, world_from_unit, size, maps)?);
    }
    Ok(views)
}

/// A parallel projection whose near plane lies before all that casts shadows.
fn reaching_back(clip_from_world: DMat4, casters: Option<Bounds>) -> DMat4 {
    let Some(casters) = casters else { return clip_from_world };
    let depth = |corner: &Vec3| clip_from_world.transform_point3(corner.as_dvec3()).z;
    let nearest = casters.corners().iter().map(depth).fold(0.0, f64::min) - ROOM;
    let scale = (1.0 - nearest).recip();
    let depths = DMat4::from_translation(DVec3::new(0.0, 0.0, -nearest * scale))
        * DMat4::from_scale(DVec3::new(1.0, 1.0, scale));
    depths * clip_from_world
}

/// The part of a projection in which the box lies.
struct Seen {
    clip_from_world: DMat4,
    /// What gives the distance of a point of the world along the axis of the light: linear.
    distance_of: DVec4,
    nearest: f64,
    farthest: f64,
}

impl Seen {
    fn new(projection: &Projection, corners: &[Vec3; 8]) -> Option<Self> {
        let clip_from_world = projection.clip_from_world;
        let distance_of = clip_from_world.row(if projection.parallel { 2 } else { 3 });
        let points = corners.map(|corner| corner.as_dvec3().extend(1.0));
        let distances = points.map(|point| distance_of.dot(point));
        let nearest = distances.into_iter().fold(f64::INFINITY, f64::min);
        let farthest = distances.into_iter().fold(f64::NEG_INFINITY, f64::max);
        if projection.parallel {
            return Some(Self { clip_from_world, distance_of, nearest, farthest });
        }
        if farthest <= 0.0 {
            return None;
        }
        let nearest = nearest.max(0.0);
        if nearest <= 1e-3 * farthest {
            // It reaches behind the light or nearly so, and may be seen anywhere.
            return Some(Self { clip_from_world, distance_of, nearest, farthest });
        }
        let seen = points.map(|point| {
            let clip = clip_from_world * point;
            DVec2::new(clip.x, clip.y) / clip.w
        });
        let low = seen.into_iter().fold(DVec2::INFINITY, DVec2::min);
        let high = seen.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max);
        let room = (high - low) * ROOM;
        let (low, high) = ((low - room).max(DVec2::NEG_ONE), (high + room).min(DVec2::ONE));
        if !low.cmplt(high).all() {
            return None;
        }
        let (scale, middle) = ((high - low).recip() * 2.0, (low + high) * 0.5);
        // Divided by w later, so that what is moved is moved by w.
        let crop =
            DMat4::from_translation((-middle * scale).extend(0.0)) * DMat4::from_scale(scale.extend(1.0));
        Some(Self { clip_from_world: crop * clip_from_world, distance_of, nearest, farthest })
    }

    fn view(
        &self,
        projection: &Projection,
        light: Light,
        world_from_unit: Mat4,
        size: [u32; 3],
        maps: LightMaps,
    ) -> Result<LightView, InverseError> {
        let camera = Camera {
            clip_from_world: self.clip_from_world.as_mat4(),
            world_from_clip: self.clip_from_world.inverse().as_mat4(),
            eye: projection.eye,
            near_depth: 0.0,
            viewport: Vec2::splat(maps.texels as f32),
            far_depth: 1.0,
            projection: u32::from(projection.parallel),
        };
        let view = SliceView::new(&camera, world_from_unit, size, maps.layers)?;
        let scale = f64::from(maps.layers) / (self.farthest - self.nearest).max(1e-12);
        let from_first = self.distance_of - DVec4::W * self.nearest;
        let layer_of = (world_from_unit.as_dmat4().transpose() * (from_first * scale)).as_vec4();
        let layers =
            LightLayers { world_from_unit, layer_of, size: UVec3::from(size), face: projection.face };
        let light = Light {
            clip_from_world: camera.clip_from_world,
            world_from_clip: camera.world_from_clip,
            ..light
        };
        Ok(LightView { view, layers, light })
    }
}
