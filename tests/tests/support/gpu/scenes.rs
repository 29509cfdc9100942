// SPDX-License-Identifier: MIT OR Apache-2.0
//! Small scenes of the tests' own, which no change of the gallery's art touches, their exact pictures, and lights.

use super::{
    gpu, host_matrix, host_vector, read_back, reference_camera, reference_light, reference_medium, shaders,
};
use airlight::core::{DepthRange, Light, PerspectiveView, Raster, Sky};
use airlight::data::{Mesh, TreeParameters, plane, torus, tree};
use airlight::scattering::{Medium, Rectification};
use airlight::{Lighting, Setting, Stage};
use airlight_tests::linear;
use airlight_tests::reference::scattering as reference;
use glam::{Mat4, Vec2, Vec3};
use std::sync::OnceLock;

/// The passes that draw meshes.
pub fn raster() -> &'static Raster {
    static RASTER: OnceLock<Raster> = OnceLock::new();
    RASTER.get_or_init(|| Raster::new(gpu(), shaders()).unwrap())
}

/// A scene of the tests.
pub struct TestScene {
    /// What is drawn.
    pub mesh: Mesh,
    /// The camera.
    pub view: PerspectiveView,
    /// Unit vector TOWARDS the light.
    pub light: Vec3,
    /// Radiance of the light.
    pub radiance: Vec3,
    /// The air.
    pub medium: Medium,
}

impl TestScene {
    /// The scene on the GPU.
    pub fn stage(&self, viewport: [u32; 2], shadow_map: [u32; 2]) -> Stage {
        let sky = Sky::new(Vec3::new(0.2, 0.3, 0.5), Vec3::splat(0.4), Vec3::splat(0.1));
        let setting = Setting {
            mesh: &self.mesh,
            view: self.view.into(),
            light: Lighting::directional(self.light, self.radiance),
            light_texture: None,
            cascades: None,
            sky,
            medium: self.medium,
            samples: 1,
        };
        Stage::new(gpu(), raster(), &setting, viewport, shadow_map).unwrap()
    }
}

/// A torus over a plane; the light stands beside the picture.
pub fn torus_over_plane() -> TestScene {
    let mut mesh = plane(Vec2::splat(12.0), 2).with_albedo(Vec3::new(0.4, 0.4, 0.35));
    let ring = torus(1.2, 0.4, 48, 20).with_albedo(Vec3::new(0.7, 0.25, 0.15));
    mesh.append(&ring.transformed(Mat4::from_translation(Vec3::Y * 1.8) * Mat4::from_rotation_x(1.0)));
    TestScene {
        mesh,
        view: PerspectiveView {
            eye: Vec3::new(-2.5, 1.8, 5.0),
            target: Vec3::new(0.1, 1.5, 0.0),
            field_of_view: 45.0,
            near: 0.1,
            far: 20.0,
            depth: DepthRange::Forward,
        },
        light: Vec3::new(0.55, 0.75, -0.4).normalize(),
        radiance: Vec3::new(12.0, 11.0, 10.0),
        medium: Medium::new(0.08, Vec3::splat(0.95), 0.3, 20.0).unwrap(),
    }
}

/// A small tree with 600 leaves; the light stands behind it, in the picture.
pub fn small_tree() -> TestScene {
    let mut mesh = plane(Vec2::splat(16.0), 2).with_albedo(Vec3::new(0.2, 0.25, 0.1));
    mesh.append(&tree(&TreeParameters {
        seed: 7,
        leaves: 600,
        leaf_length: 0.4,
        ..TreeParameters::default()
    }));
    TestScene {
        mesh,
        view: PerspectiveView {
            eye: Vec3::new(0.4, 1.4, 8.0),
            target: Vec3::new(0.0, 3.2, 0.0),
            field_of_view: 60.0,
            near: 0.1,
            far: 30.0,
            depth: DepthRange::Forward,
        },
        light: Vec3::new(0.12, 0.5, -0.86).normalize(),
        radiance: Vec3::new(14.0, 12.0, 9.0),
        medium: Medium::new(0.05, Vec3::splat(0.95), 0.5, 30.0).unwrap(),
    }
}

/// Gives the reference's view of a scene, and the rectification that the GPU made.
fn with_scene<T>(
    stage: &Stage,
    view: &PerspectiveView,
    map: &Rectification,
    of: impl FnOnce(&reference::Scene<'_>, &reference::Rectification) -> T,
) -> T {
    let [width, height, _] = stage.pictures.depth.size();
    let camera = reference_camera(view, [width, height]);
    let rectification = read_back(&camera, stage.light.direction, stage.medium.distance_limit, map);
    let depth = stage.pictures.depth.read(gpu()).unwrap();
    let scene = reference::Scene {
        camera: &camera,
        light: reference_light(&stage.light),
        medium: reference_medium(&stage.medium),
        depth: &depth,
        width: width as usize,
        height: height as usize,
    };
    of(&scene, &rectification)
}

/// The exact f64 picture of a scene over the rectified map that the GPU made.
pub fn exact_picture(
    stage: &Stage,
    view: &PerspectiveView,
    map: &Rectification,
    stride: usize,
) -> reference::Picture {
    let rectified = map.rectified.read(gpu()).unwrap();
    with_scene(stage, view, map, |scene, rectification| {
        reference::picture(scene, rectification, &rectified, stride)
    })
}

/// The view ray of a pixel.
pub struct PixelRay {
    /// Unit vector.
    pub direction: linear::Vec3,
    /// Metres to the surface or the limit.
    pub distance: f64,
    /// The rows on both sides of it.
    pub rows: [usize; 2],
    /// Share of the second of them.
    pub share: f64,
}

impl PixelRay {
    /// The row next to it.
    pub fn nearest(&self) -> usize {
        self.rows[usize::from(self.share >= 0.5)]
    }

    /// Where it ends in row `j`. `extinction`: 1/m.
    pub fn end(&self, map: &reference::Rectification, j: usize, extinction: f64) -> reference::RowEnd {
        map.row_end(j, self.direction, self.distance, extinction)
    }
}

/// What `of` says of every pixel's ray and of the rectification that the GPU made, row after row.
pub fn of_pixels<T: Send>(
    stage: &Stage,
    view: &PerspectiveView,
    map: &Rectification,
    of: impl Fn(&reference::Rectification, &PixelRay) -> T + Sync,
) -> Vec<T> {
    with_scene(stage, view, map, |scene, rectification| {
        let pixel = |x: usize, y: usize| {
            let (direction, distance) = scene.view_ray(x, y);
            let (first, second, share) =
                rectification.rows(rectification.frame.polar_direction(direction).phi);
            of(rectification, &PixelRay { direction, distance, rows: [first, second], share })
        };
        let row = |y: usize| (0..scene.width).map(|x| pixel(x, y)).collect::<Vec<_>>();
        airlight_tests::parallel::rows(scene.height, row).into_iter().flatten().collect()
    })
}

/// The clip matrix of an orthographic light: `half` metres to every side of `centre`.
pub fn light_matrix(towards: linear::Vec3, centre: linear::Vec3, half: f64, far_depth: f64) -> linear::Mat4 {
    let l = towards.normalised();
    let other = linear::Vec3::from(if l.y.abs() > 0.9 { [0.0, 0.0, -1.0] } else { [0.0, 1.0, 0.0] });
    let right = other.cross(l).normalised();
    let up = l.cross(right);
    let row = |d: linear::Vec3, s: f64, shift: f64| [s * d.x, s * d.y, s * d.z, shift - s * d.dot(centre)];
    let along = if far_depth > 0.5 { -0.5 } else { 0.5 };
    linear::Mat4::from_rows([
        row(right, 1.0 / half, 0.0),
        row(up, 1.0 / half, 0.0),
        row(l, along / half, 0.5),
        [0.0, 0.0, 0.0, 1.0],
    ])
}

/// The uniform of a light of that matrix.
pub fn host_light(
    towards: linear::Vec3,
    clip_from_world: linear::Mat4,
    far_depth: f64,
    radiance: Vec3,
) -> Light {
    Light {
        clip_from_world: host_matrix(clip_from_world),
        world_from_clip: host_matrix(clip_from_world.inverse().unwrap()),
        direction: host_vector(towards.normalised()),
        far_depth: far_depth as f32,
        radiance,
        kind: 0,
        position: Vec3::ZERO,
        radius: 0.0,
        spot_cosines: Vec2::ZERO,
        reserved_a: 0.0,
        reserved_b: 0.0,
    }
}

/// A spot beside the picture that shines through the torus.
pub fn spot() -> Lighting {
    Lighting::Spot {
        position: Vec3::new(3.5, 4.5, -2.0),
        target: Vec3::new(0.0, 1.2, 0.2),
        outer_degrees: 32.0,
        inner_degrees: 20.0,
        intensity: Vec3::new(120.0, 100.0, 80.0),
        radius: 0.05,
    }
}

/// A point light inside the ring, in the picture.
pub fn point() -> Lighting {
    Lighting::Point {
        position: Vec3::new(0.3, 2.2, -1.2),
        intensity: Vec3::new(60.0, 50.0, 40.0),
        radius: 0.05,
    }
}
