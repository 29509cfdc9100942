// SPDX-License-Identifier: MIT OR Apache-2.0
//! What an engine has anyway: meshes, a camera, a sun, air. The structs have the layouts of those in the shaders: every
//! vector of three is followed by a number, so that plain memory is right.

use bytemuck::{Pod, Zeroable};
use glam::camera::rh::{proj::directx, view::look_at_mat4};
use glam::{Mat4, Vec2, Vec3};
use std::path::Path;

/// `Camera` of `core/camera`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Camera {
    /// World to clip space, depth 0..1.
    pub clip_from_world: Mat4,
    /// Its inverse.
    pub world_from_clip: Mat4,
    /// Where it is, metres.
    pub eye: Vec3,
    /// Depth of the near plane: 0, or 1 with reversed depth.
    pub near_depth: f32,
    /// Size of the picture, pixels.
    pub viewport: Vec2,
    /// Depth of the far plane: 1, or 0 with reversed depth.
    pub far_depth: f32,
    /// 0: perspective.
    pub projection: u32,
}

/// `Light` of `core/light`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Light {
    /// World to the clip space of the shadow map.
    pub clip_from_world: Mat4,
    /// Its inverse.
    pub world_from_clip: Mat4,
    /// Unit vector TOWARDS the light.
    pub direction: Vec3,
    /// Depth of an empty texel of the shadow map.
    pub far_depth: f32,
    /// Irradiance at normal incidence, linear RGB.
    pub radiance: Vec3,
    /// 0: at infinity.
    pub kind: u32,
    /// What only lights at a point have.
    pub unused: [f32; 8],
}

/// `Medium` of `scattering/single_scatter`: the air.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Medium {
    /// Share of the extinction that is scattering, 0..1.
    pub albedo: Vec3,
    /// 1/m.
    pub extinction: f32,
    /// Mean cosine of the phase function, -0.999..0.999: towards 1 the air glows around the sun.
    pub g: f32,
    /// Rays that meet nothing end here, metres.
    pub distance_limit: f32,
    /// Padding.
    pub unused: [f32; 2],
}

/// `Sky` of `core/raster`: linear RGB radiance, each with padding.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Sky {
    /// Straight up.
    pub zenith: [f32; 4],
    /// At the horizon.
    pub horizon: [f32; 4],
    /// From below.
    pub ground: [f32; 4],
}

/// Triangles.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Position in metres, normal, albedo.
    pub vertices: Vec<[Vec3; 3]>,
    /// Three a triangle.
    pub indices: Vec<u32>,
}

/// A picture's worth of world.
#[derive(Clone, Debug)]
pub struct Scene {
    /// What is drawn.
    pub mesh: Mesh,
    /// From where.
    pub camera: Camera,
    /// By whose light.
    pub light: Light,
    /// Through what.
    pub medium: Medium,
    /// Before what.
    pub sky: Sky,
    /// Factor on the radiance before the tone curve.
    pub exposure: f32,
}

/// Where the camera stands, metres.
pub const EYE: Vec3 = Vec3::new(3.2, 1.5, 5.2);
/// Where it looks.
pub const TARGET: Vec3 = Vec3::new(-1.0, 1.7, -0.8);
/// From the lower to the upper edge of the picture, degrees.
pub const FIELD_OF_VIEW: f32 = 50.0;
/// Distance of the near plane, metres.
pub const NEAR: f32 = 0.1;
/// Distance of the far plane, metres.
pub const FAR: f32 = 60.0;
/// Ball that holds everything that casts a shadow.
const CASTERS: (Vec3, f32) = (Vec3::new(0.0, 2.6, 1.0), 9.6);

/// The mesh in the file, in a hall whose windows look into the sun.
pub fn scene(file: &Path, [width, height]: [u32; 2]) -> Result<Scene, tobj::LoadError> {
    let mut mesh = Mesh::default();
    hall(&mut mesh);
    let turned = Mat4::from_translation(Vec3::new(-0.6, 0.69, -0.8)) * Mat4::from_rotation_y(-0.35);
    mesh.add_file(file, turned, 1.7, Vec3::new(0.80, 0.70, 0.60))?;

    let clip_from_world =
        directx::perspective(FIELD_OF_VIEW.to_radians(), width as f32 / height as f32, NEAR, FAR)
            * look_at_mat4(EYE, TARGET, Vec3::Y);
    let camera = Camera {
        clip_from_world,
        world_from_clip: clip_from_world.inverse(),
        eye: EYE,
        near_depth: 0.0,
        viewport: Vec2::new(width as f32, height as f32),
        far_depth: 1.0,
        projection: 0,
    };
    Ok(Scene {
        mesh,
        camera,
        light: sun(268.0, 26.0, Vec3::new(15.0, 10.6, 6.4)),
        medium: Medium {
            albedo: Vec3::splat(0.95),
            extinction: 0.05,
            g: 0.35,
            distance_limit: 30.0,
            unused: [0.0; 2],
        },
        sky: Sky {
            zenith: [0.05, 0.09, 0.17, 0.0],
            horizon: [0.09, 0.11, 0.15, 0.0],
            ground: [0.06, 0.045, 0.03, 0.0],
        },
        exposure: 1.0,
    })
}

/// A sun by its azimuth from +z towards +x and its elevation above the horizon, degrees, with a shadow map around all
/// that casts shadows.
pub fn sun(azimuth: f32, elevation: f32, radiance: Vec3) -> Light {
    let (azimuth, elevation) = (azimuth.to_radians(), elevation.to_radians());
    let direction =
        Vec3::new(elevation.cos() * azimuth.sin(), elevation.sin(), elevation.cos() * azimuth.cos());
    let (middle, radius) = CASTERS;
    let clip_from_world = directx::orthographic(-radius, radius, -radius, radius, 0.0, 2.0 * radius)
        * look_at_mat4(middle + radius * direction, middle, Vec3::Y);
    let world_from_clip = clip_from_world.inverse();
    Light { clip_from_world, world_from_clip, direction, far_depth: 1.0, radiance, kind: 0, unused: [0.0; 8] }
}

/// A hall with windows to the left, from boxes by their least and greatest corners.
fn hall(mesh: &mut Mesh) {
    let stone = Vec3::new(0.42, 0.38, 0.34);
    let mut block = |low: [f32; 3], high: [f32; 3], albedo| {
        let (low, high) = (Vec3::from(low), Vec3::from(high));
        mesh.add_box(Mat4::from_translation(0.5 * (low + high)), high - low, albedo);
    };
    block([-5.4, -0.3, -6.0], [5.0, 0.0, 8.0], Vec3::new(0.30, 0.26, 0.22)); // floor
    block([-5.4, 5.2, -6.0], [5.0, 5.5, 8.0], stone); // ceiling
    block([-5.4, 0.0, -6.3], [5.0, 5.2, -6.0], stone); // behind the mesh
    block([-5.4, 0.0, 8.0], [5.0, 5.2, 8.3], stone); // behind the camera
    block([5.0, 0.0, -6.0], [5.3, 5.2, 8.0], stone); // right
    block([-5.4, 0.0, -6.0], [-5.0, 0.9, 8.0], stone); // below the windows
    block([-5.4, 4.3, -6.0], [-5.0, 5.2, 8.0], stone); // above them
    block([-5.4, 0.9, -6.0], [-5.0, 4.3, -5.0], stone); // before the first
    for window in 0..6 {
        let begin = -5.0 + 2.4 * window as f32;
        block([-5.4, 0.9, begin], [-5.0, 4.3, begin + 1.2], stone); // the pillar beside it
        block([-5.24, 0.9, begin + 1.77], [-5.16, 4.3, begin + 1.83], stone); // its bars
        block([-5.24, 2.0, begin + 1.2], [-5.16, 2.06, begin + 2.4], stone);
        block([-5.24, 3.15, begin + 1.2], [-5.16, 3.21, begin + 2.4], stone);
    }
    block([-1.5, 0.0, -1.5], [0.3, 0.6, -0.1], stone); // what the mesh stands on
    block([-1.6, 0.6, -1.6], [0.4, 0.7, 0.0], stone);
}

impl Mesh {
    /// A box of the given size around the origin, placed by `at`.
    fn add_box(&mut self, at: Mat4, size: Vec3, albedo: Vec3) {
        for (axis, side) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0f32)] {
            let normal = Vec3::AXES[axis] * side;
            let (u, v) = (Vec3::AXES[(axis + 1) % 3], Vec3::AXES[(axis + 2) % 3] * side);
            let first = self.vertices.len() as u32;
            for corner in [-u - v, u - v, u + v, v - u] {
                let position = at.transform_point3(0.5 * size * (normal + corner));
                self.vertices.push([position, at.transform_vector3(normal), albedo]);
            }
            self.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
        }
    }

    /// An .obj file with normals, scaled to a height and stood at the origin, then placed by `at`.
    fn add_file(&mut self, file: &Path, at: Mat4, height: f32, albedo: Vec3) -> Result<(), tobj::LoadError> {
        let (models, _) = tobj::load_obj(file, &tobj::GPU_LOAD_OPTIONS)?;
        for tobj::Model { mesh, .. } in models {
            let points = |numbers: &[f32]| numbers.chunks_exact(3).map(Vec3::from_slice).collect::<Vec<_>>();
            let (positions, normals) = (points(&mesh.positions), points(&mesh.normals));
            let low = positions.iter().copied().fold(Vec3::INFINITY, Vec3::min);
            let high = positions.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
            let foot = Vec3::new(0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z));
            let first = self.vertices.len() as u32;
            for (position, normal) in positions.iter().zip(normals) {
                let placed = at.transform_point3((position - foot) * (height / (high.y - low.y)));
                self.vertices.push([placed, at.transform_vector3(normal), albedo]);
            }
            self.indices.extend(mesh.indices.iter().map(|index| first + index));
        }
        Ok(())
    }
}
