// SPDX-License-Identifier: MIT OR Apache-2.0
//! Surfaces of volumes before a camera, on the GPU and in f64.
#![allow(dead_code, clippy::unwrap_used)]

use crate::gpu::{gpu, matrix, shaders, vector};
use crate::probing::hold;
use airlight::core::{Camera, DepthRange, Jitter, OrthographicView, PerspectiveView, Transfer, View};
use airlight::data::{Volume, load_volume};
use airlight::painterly::{
    BrickRanges, IsoForm, IsoFrame, IsoRaycast, IsoSettings, IsoVolume, Shade, SolidBricks, SurfaceLighting,
};
use airlight_tests::linear;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::painterly::{Crossing, Solid, classify, trilinear};
use glam::{Mat4, Vec3};
use std::path::Path;

/// Columns and rows of all pictures.
pub const SIZE: [u32; 2] = [64, 48];
/// Their pixels.
pub const PIXELS: usize = 64 * 48;

/// Opacity is the value.
pub const RAMP: [[f32; 4]; 2] = [[0.5, 0.25, 0.125, 0.0], [1.0, 0.75, 0.5, 1.0]];

/// All targets, steps from where rays enter.
pub const PLAIN: IsoForm = IsoForm {
    jitter: Jitter::None,
    skipping: false,
    deferred: false,
    distance_only: false,
    curvature: false,
};

/// What was read back.
#[derive(Debug, Clone, PartialEq)]
pub struct Seen {
    pub color: Vec<f32>,
    pub surface: Vec<f32>,
    pub flow: Vec<f32>,
    pub distance: Vec<f32>,
    /// Empty without [`IsoForm::curvature`].
    pub curvature: Vec<f32>,
}

impl Seen {
    /// Pixels where something is seen.
    pub fn hits(&self) -> usize {
        self.distance.iter().filter(|distance| **distance >= 0.0).count()
    }

    /// Everything is finite, and nothing is written where nothing is seen.
    pub fn check(&self) {
        let all = [&self.color, &self.surface, &self.flow, &self.distance, &self.curvature];
        assert!(all.iter().all(|values| values.iter().all(|value| value.is_finite())));
        for (i, distance) in self.distance.iter().enumerate() {
            let (color, surface) = (&self.color[4 * i..4 * i + 4], &self.surface[4 * i..4 * i + 4]);
            let flow = &self.flow[2 * i..2 * i + 2];
            if *distance < 0.0 {
                assert!(
                    *distance == -1.0 && [color, surface, flow].iter().all(|v| v.iter().all(|x| *x == 0.0))
                );
                let curvature = self.curvature.get(4 * i..4 * i + 4);
                assert!(curvature.is_none_or(|texel| texel.iter().all(|x| *x == 0.0)));
            } else {
                assert_eq!(color[3], 1.0);
                let length = Vec3::from_slice(surface).length();
                assert!((length - 1.0).abs() < 2e-3, "a normal of length {length}");
            }
        }
    }
}

/// A volume before a camera.
pub struct Setting {
    pub volume: Volume,
    pub range: Option<[f32; 2]>,
    pub table: Vec<[f32; 4]>,
    pub settings: IsoSettings,
    pub lighting: SurfaceLighting,
    pub frame: IsoFrame,
}

/// What a ray meets in f64.
pub struct Ray {
    pub origin: linear::Vec3,
    pub direction: linear::Vec3,
    pub crossings: Vec<Crossing>,
}

impl Setting {
    /// Nothing moves, opacity is the value, the iso-value is 0.5.
    pub fn new(volume: Volume, view: &View) -> Self {
        let frame = IsoFrame::still(Camera::new(view, SIZE).unwrap(), volume.world_from_unit);
        let lighting = SurfaceLighting::towards(Vec3::new(0.4, 0.8, 0.5)).unwrap();
        let (range, table, settings) = (Some([0.0, 1.0]), RAMP.to_vec(), IsoSettings::default());
        Self { volume, range, table, settings, lighting, frame }
    }

    /// The volume on the GPU.
    pub fn uploaded(&self) -> IsoVolume {
        IsoVolume::new(gpu(), &self.volume, self.range).unwrap()
    }

    /// All targets.
    pub fn seen(&self, form: IsoForm) -> Seen {
        self.seen_of(&self.uploaded(), form)
    }

    /// All targets of a volume that was uploaded.
    pub fn seen_of(&self, volume: &IsoVolume, form: IsoForm) -> Seen {
        self.seen_with(volume, form, None).0
    }

    /// All targets of a volume that was uploaded, skipping by the ranges of its bricks if they are given; and the distances
    /// of its bricks.
    pub fn seen_with(
        &self,
        volume: &IsoVolume,
        form: IsoForm,
        ranges: Option<&BrickRanges>,
    ) -> (Seen, Vec<u32>) {
        let transfer = Transfer::new(gpu(), &self.table).unwrap();
        let pass = IsoRaycast::new(gpu(), shaders(), form).unwrap();
        let bound = pass.bind(gpu(), volume, &transfer, SIZE).unwrap();
        pass.set(gpu(), &bound, volume, &self.frame, &self.settings, &self.lighting).unwrap();
        let mut encoder = gpu().encoder();
        if let Some(ranges) = ranges {
            let solid = SolidBricks::new(gpu(), shaders()).unwrap();
            solid.record(gpu(), &mut encoder, ranges, &transfer, &bound).unwrap();
        }
        pass.record(&mut encoder, &bound);
        let shade = form.deferred.then(|| {
            let shade = Shade::new(gpu(), shaders()).unwrap();
            let shaded = shade.bind(gpu(), &bound).unwrap();
            shade.record(&mut encoder, &shaded);
            shaded
        });
        gpu().submit(encoder).unwrap();
        let targets = &bound.targets;
        let color = shade.as_ref().map_or(&targets.color, |shaded| &shaded.picture);
        let [color, surface, flow, distance] =
            [color, &targets.surface, &targets.flow, &targets.distance].map(|t| t.read(gpu()).unwrap());
        let curvature = targets.curvature.as_ref().map(|t| t.read(gpu()).unwrap()).unwrap_or_default();
        (
            Seen { color, surface, flow, distance, curvature },
            bound.brick_distances().read_words(gpu()).unwrap(),
        )
    }

    /// The camera in f64.
    pub fn camera(&self) -> ReferenceCamera {
        reference_camera(&self.frame.camera)
    }

    /// What is solid in f64, of the texels that the GPU has.
    pub fn solid<T>(&self, of: impl FnOnce(&Solid<'_>) -> T) -> T {
        let volume = self.uploaded();
        let (scale, offset) = (f64::from(volume.scale), f64::from(volume.offset));
        let texels = volume.texture.read(gpu()).unwrap();
        let values: Vec<f64> = texels.iter().map(|texel| f64::from(*texel) * scale + offset).collect();
        let size = self.volume.size.map(|side| side as usize);
        let table: Vec<_> = self.table.iter().map(|entry| entry.map(f64::from)).collect();
        let clip_planes: Vec<_> =
            self.settings.clip_planes.iter().map(|plane| plane.to_array().map(f64::from)).collect();
        of(&Solid {
            unit_from_world: matrix(self.frame.world_from_unit).inverse().unwrap(),
            value: &|unit| trilinear(size, &values, unit).clamp(0.0, 1.0),
            table: &table,
            iso_value: f64::from(self.settings.iso_value),
            clip_planes: &clip_planes,
        })
    }

    /// Metres of the shortest side of a voxel.
    pub fn voxel(&self) -> f64 {
        f64::from(self.volume.voxel())
    }

    /// All crossings of all rays, by samples a 16th of a voxel apart.
    pub fn rays(&self, solid: &Solid<'_>) -> Vec<Ray> {
        let camera = self.camera();
        let bounds = self.volume.bounds();
        let reach = vector(bounds.max - bounds.min).length();
        let centre = vector(0.5 * (bounds.max + bounds.min));
        let [width, height] = SIZE.map(|side| side as usize);
        let rows = airlight_tests::parallel::rows(height, |y| {
            let ray = |x: usize| {
                let ndc = ReferenceCamera::pixel_ndc(x, y, width, height);
                let (origin, direction) = (camera.origin(ndc), camera.ray(ndc));
                let end = ((centre - origin).length() + reach).min(f64::from(self.settings.distance_limit));
                let crossings = solid.crossings(origin, direction, end, self.voxel() / 16.0);
                Ray { origin, direction, crossings }
            };
            (0..width).map(ray).collect::<Vec<_>>()
        });
        rows.into_iter().flatten().collect()
    }
}

/// A camera in f64.
pub fn reference_camera(camera: &Camera) -> ReferenceCamera {
    ReferenceCamera::from_matrix(matrix(camera.clip_from_world), f64::from(camera.far_depth)).unwrap()
}

/// A view of a volume from a direction, most of its box in the picture.
pub fn view_of(volume: &Volume, towards_eye: Vec3) -> View {
    let bounds = volume.bounds();
    let (target, size) = (0.5 * (bounds.min + bounds.max), (bounds.max - bounds.min).length());
    let eye = target + 0.95 * size * towards_eye.normalize();
    let depth = DepthRange::Forward;
    PerspectiveView { eye, target, field_of_view: 36.0, near: 0.01 * size, far: 10.0 * size, depth }.into()
}

/// Parallel rays at a volume.
pub fn parallel_view_of(volume: &Volume, towards_eye: Vec3, depth: DepthRange) -> View {
    let bounds = volume.bounds();
    let (target, size) = (0.5 * (bounds.min + bounds.max), (bounds.max - bounds.min).length());
    let eye = target + 0.95 * size * towards_eye.normalize();
    OrthographicView { eye, target, height: 0.6 * size, near: 0.0, far: 4.0 * size, depth }.into()
}

/// A rotation about the middle of a volume, after its own matrix.
pub fn turned(volume: &Volume, rotation: Mat4) -> Mat4 {
    let bounds = volume.bounds();
    let middle = 0.5 * (bounds.min + bounds.max);
    Mat4::from_translation(middle) * rotation * Mat4::from_translation(-middle) * volume.world_from_unit
}

/// The head of the repository's magnetic resonance.
pub fn head() -> Volume {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/assets/head_mri.nii.gz");
    load_volume(path, 1e-3).unwrap()
}

/// A head whose skin is solid.
pub fn head_setting(towards_eye: Vec3) -> Setting {
    let volume = head();
    let view = view_of(&volume, towards_eye);
    let mut setting = Setting::new(volume, &view);
    setting.range = None;
    setting.table = vec![[0.2, 0.1, 0.1, 0.0], [0.9, 0.7, 0.6, 0.25], [1.0, 0.9, 0.8, 1.0], [1.0; 4]];
    setting
}

/// Every hit is a crossing to 0.1 voxels, unless the ray grazes it, and no crossing that lasts a step was passed.
pub fn hits_are_crossings(what: &str, setting: &Setting, seen: &Seen) {
    seen.check();
    let step = setting.voxel() / f64::from(setting.settings.steps_per_voxel);
    let (mut worst, mut compared, mut grazing, mut slivers) = (0.0_f64, 0, 0, 0);
    setting.solid(|solid| {
        for (i, ray) in setting.rays(solid).iter().enumerate() {
            let found = f64::from(seen.distance[i]);
            let lasting = ray.crossings.iter().find(|crossing| crossing.lasts > 1.01 * step);
            if found < 0.0 {
                assert!(lasting.is_none(), "{what}: pixel {i} misses {:?}", ray.crossings);
                continue;
            }
            let nearest = ray
                .crossings
                .iter()
                .min_by(|a, b| (a.distance - found).abs().total_cmp(&(b.distance - found).abs()));
            // The samples may all lie beside an edge of the box or of a cut that the ray meets: then the hit is on a face, and
            // what is there is solid.
            let near = nearest.filter(|crossing| (crossing.distance - found).abs() < setting.voxel());
            let Some(nearest) = near else {
                let point = ray.origin + ray.direction * found;
                let [x, y, z, _] = solid.unit_from_world.apply_point(point);
                let opacity = classify(solid.table, (solid.value)([x, y, z]))[3];
                let side = setting.volume.size.map(f64::from);
                let face = |(u, side): (f64, f64)| u.min(1.0 - u).abs() * side < 0.0625;
                let cut = |[a, b, c, d]: &[f64; 4]| {
                    let normal = linear::Vec3::new(*a, *b, *c);
                    ((normal.dot(point) + d) / normal.length()).abs() < 0.0625 * setting.voxel()
                };
                let beside = [x, y, z].into_iter().zip(side).any(face) || solid.clip_planes.iter().any(cut);
                assert!(
                    beside && opacity >= solid.iso_value - 1e-3,
                    "{what}: pixel {i} hits nothing at {found}"
                );
                slivers += 1;
                continue;
            };
            let gradient =
                solid.gradient(ray.origin + ray.direction * nearest.distance, 1e-3 * setting.voxel());
            let cosine = gradient.dot(ray.direction) / gradient.length();
            if !nearest.entered && cosine.abs() <= 0.1 {
                grazing += 1;
                continue;
            }
            compared += 1;
            worst = worst.max((found - nearest.distance).abs() / setting.voxel());
            if let Some(lasting) = lasting {
                assert!(found < lasting.distance + setting.voxel(), "{what}: pixel {i} passes {lasting:?}");
            }
        }
    });
    println!("{what}: {compared} hits compared, {grazing} grazing");
    assert!(
        compared > PIXELS / 12 && grazing < compared / 5 && slivers < compared / 50,
        "{what}: {slivers} slivers"
    );
    hold(&format!("{what}, hits in voxels"), worst, 0.1);
}
