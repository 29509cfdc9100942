// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scenes on the GPU, and what the passes make of them.

use super::cameras::host_camera;
use crate::gpu::{self, gpu, shaders};
use airlight::core::{Camera, Light, MeshBuffers, Pictures, Sky, direction_from_angles};
use airlight::data::Mesh;
use airlight::scattering::{
    Along, Inputs, March, Medium, Projective, ProjectiveMap, ProjectivePrefiltered, ProjectiveRaster,
    Settings, Start, Weighting, projective_rows,
};
use airlight::{Buffer, Lighting, Texture, scenes};
use airlight_tests::linear;
use airlight_tests::reference::camera::{Camera as ReferenceCamera, OrthographicView};
use airlight_tests::reference::scattering as reference;
use glam::Vec3;

pub const PICTURE: [u32; 2] = [480, 270];

/// A scene on the GPU, for a camera of either kind.
pub struct Stage {
    pub reference: ReferenceCamera,
    pub camera: Camera,
    pub light: Light,
    pub medium: Medium,
    pub meshes: Vec<MeshBuffers>,
    pub pictures: Pictures,
    pub buffers: [Buffer; 3],
}

impl Stage {
    pub fn new(
        mesh: &Mesh,
        reference: ReferenceCamera,
        towards: Vec3,
        medium: Medium,
        picture: [u32; 2],
        shadow: u32,
    ) -> Self {
        let camera = host_camera(&reference, picture);
        let bounds = mesh.bounds().unwrap();
        let light = Light::directional(towards, Vec3::new(9.0, 7.0, 5.0), bounds.min, bounds.max).unwrap();
        let meshes = vec![MeshBuffers::new(gpu(), mesh)];
        let sky = Sky::new(Vec3::splat(0.3), Vec3::splat(0.3), Vec3::splat(0.1));
        let pictures = gpu::raster().render(gpu(), &camera, &light, &sky, &meshes, [shadow, shadow]).unwrap();
        let buffers = [
            Buffer::uniform(gpu(), &camera),
            Buffer::uniform(gpu(), &light),
            Buffer::uniform(gpu(), &medium),
        ];
        Self { reference, camera, light, medium, meshes, pictures, buffers }
    }

    pub fn inputs(&self) -> Inputs<'_> {
        let [camera, light, medium] = &self.buffers;
        let Pictures { depth, shadow_map, .. } = &self.pictures;
        Inputs {
            camera,
            light,
            medium,
            depth,
            shadow_map,
            shadow_views: None,
            shadow_maps: None,
            light_texture: None,
        }
    }

    pub fn projective(&self, splits: u32) -> Projective {
        projective_rows(&self.camera, self.light.direction, self.medium.distance_limit, splits).unwrap()
    }

    /// The reference's rows.
    pub fn reference_rows(&self, map: [u32; 2], splits: u32) -> reference::Projective {
        let size = map.map(|side| side as usize);
        let limit = f64::from(self.medium.distance_limit);
        let splits = if self.reference.is_orthographic() { 1 } else { splits as usize };
        reference::Projective::new(&self.reference, gpu::vector(self.light.direction), limit, size, splits)
            .unwrap()
    }

    /// The exact picture over the map that the GPU made.
    pub fn exact(&self, map: &Texture, splits: u32) -> reference::Picture {
        self.exact_from(map, splits, reference::Start::Eye, 1)
    }

    /// Of every `stride`-th pixel in x and y.
    pub fn exact_from(
        &self,
        map: &Texture,
        splits: u32,
        start: reference::Start,
        stride: usize,
    ) -> reference::Picture {
        let depth = self.pictures.depth.read(gpu()).unwrap();
        let [width, height, _] = self.pictures.depth.size();
        let scene = reference::Scene {
            camera: &self.reference,
            light: gpu::reference_light(&self.light),
            medium: gpu::reference_medium(&self.medium),
            depth: &depth,
            width: width as usize,
            height: height as usize,
        };
        let [columns, rows, _] = map.size();
        let rows = self.reference_rows([columns, rows], splits);
        reference::projective_picture(&scene, &rows, &map.read(gpu()).unwrap(), start, stride)
    }

    pub fn map(&self, map: [u32; 2], splits: u32) -> ProjectiveMap {
        let made = ProjectiveMap::resampled(gpu(), shaders(), map).unwrap();
        made.write(gpu(), &self.projective(splits));
        let bound = made.bind(gpu(), &self.inputs()).unwrap();
        let mut encoder = gpu().encoder();
        made.record(&mut encoder, bound.as_ref());
        gpu().submit(encoder).unwrap();
        made
    }

    pub fn drawn(&self, map: [u32; 2], splits: u32) -> ProjectiveMap {
        let made = ProjectiveMap::drawn(gpu(), map).unwrap();
        let projective = self.projective(splits);
        made.write(gpu(), &projective);
        let raster = ProjectiveRaster::new(gpu(), shaders()).unwrap();
        let bound = raster.bind(gpu(), &projective).unwrap();
        let mut encoder = gpu().encoder();
        raster.record(&mut encoder, &bound, &self.meshes, &made.rectified);
        gpu().submit(encoder).unwrap();
        made
    }

    pub fn prefiltered(&self, map: ProjectiveMap, settings: Settings) -> (Scattered, ProjectivePrefiltered) {
        let [width, height, _] = self.pictures.depth.size();
        let level = self.reference.is_orthographic();
        let settings = Settings { start: if level { Start::NearPlane } else { settings.start }, ..settings };
        let method = ProjectivePrefiltered::new(gpu(), shaders(), map, settings, [width, height]).unwrap();
        let bound = method.bind(gpu(), &self.inputs()).unwrap();
        let mut encoder = gpu().encoder();
        method.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        (scattered(&method.scattered), method)
    }

    /// What a method that is there makes of this scene.
    pub fn evaluated(&self, method: &ProjectivePrefiltered, splits: u32) -> Scattered {
        method.write(gpu(), &self.projective(splits)).unwrap();
        let bound = method.bind(gpu(), &self.inputs()).unwrap();
        let mut encoder = gpu().encoder();
        method.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        scattered(&method.scattered)
    }

    pub fn marched(&self, map: &ProjectiveMap, weighting: Weighting) -> Scattered {
        let [width, height, _] = self.pictures.depth.size();
        let along = Along::Projective(map);
        let method = March::new(gpu(), shaders(), &along, weighting, [width, height]).unwrap();
        let bound = method.bind(gpu(), &self.inputs(), &along).unwrap();
        let mut encoder = gpu().encoder();
        method.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        scattered(&method.scattered)
    }
}

pub struct Scattered {
    pub visibility: Vec<f32>,
    pub radiance: Vec<f32>,
}

pub fn scattered(texture: &Texture) -> Scattered {
    let values = texture.read(gpu()).unwrap();
    Scattered {
        visibility: values.chunks_exact(4).map(|texel| texel[3]).collect(),
        radiance: values.chunks_exact(4).flat_map(|texel| texel[..3].to_vec()).collect(),
    }
}

/// The direction towards the light of a scene of the gallery.
pub fn towards(scene: &scenes::Scene) -> Vec3 {
    match scene.light {
        Lighting::Directional { towards, .. } => towards,
        _ => panic!("{} has a light at a point", scene.name),
    }
}

/// A scene of the gallery with the light beside the picture.
pub fn gallery(name: &str) -> Stage {
    let scene = scenes::scene(name).unwrap().unwrap();
    let light = match name {
        "foliage" => direction_from_angles(105.0, 48.0),
        "torus" => direction_from_angles(75.0, 40.0),
        _ => towards(&scene),
    };
    let camera = gpu::reference_camera(&scene.view.perspective().unwrap(), PICTURE);
    Stage::new(&scene.mesh, camera, light, scene.medium, PICTURE, 1024)
}

/// A foliage scene as an orthographic camera sees it.
pub fn level_foliage() -> Stage {
    let scene = scenes::scene("foliage").unwrap().unwrap();
    let camera = ReferenceCamera::orthographic(&OrthographicView {
        eye: linear::Vec3::new(-3.0, 4.0, 9.0),
        target: linear::Vec3::new(0.0, 3.0, 0.0),
        up: linear::Vec3::new(0.0, 1.0, 0.0),
        half_height: 4.0,
        aspect: f64::from(PICTURE[0]) / f64::from(PICTURE[1]),
        depth: 25.0,
        reversed: false,
    });
    Stage::new(&scene.mesh, camera, direction_from_angles(105.0, 48.0), scene.medium, PICTURE, 1024)
}
