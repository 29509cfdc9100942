// SPDX-License-Identifier: MIT OR Apache-2.0
//! A shape that turns before a camera, painted in bands of known gradient magnitude, as the targets that strokes take, and
//! strokes on it.
#![allow(dead_code)]

use super::gpu::{gpu, host_camera, host_matrix, shaders};
use airlight::Texture;
use airlight::core::Camera;
use airlight::painterly::{
    BrushImage, Brushes, DensityBounds, LayerStyle, Orientation, PainterlyStyle, Rates, Stroke, StrokeCounts,
    StrokeSettings, StrokeStep, StrokeTargets, Strokes,
};
use airlight_tests::linear::{Mat4, Vec3};
use airlight_tests::parallel;
use airlight_tests::reference::camera::{self, Camera as ReferenceCamera};
use airlight_tests::reference::painterly::strokes::{Posed, Shape, Sight};
use std::f64::consts::TAU;

/// Gradient magnitudes in the middle of the layers of [`style`].
pub const MAGNITUDES: [f64; 3] = [0.05, 0.2, 0.6];

/// Layers with the same numbers, small strokes, and moderate bounds.
pub fn style() -> PainterlyStyle {
    let layer = |threshold, size| LayerStyle {
        threshold,
        probability: 0.1,
        size,
        aspect: 0.4,
        opacity: 1.0,
        density: DensityBounds { min: 0.08, max: 0.16 },
        brush: Some(0),
    };
    PainterlyStyle {
        coarse: layer(0.1, 26.0),
        medium: layer(0.3, 20.0),
        fine: layer(1.0, 14.0),
        rates: Rates::SEAMLESS,
        hysteresis: 0.1,
        gradient_scale: 1.0,
        density_unit: 0.01,
        anticipation: 1.0,
        density_margin: 0.15,
        size_variation: 0.0,
        color_variation: 0.0,
        orientation: Orientation::Gradient,
        angle: 0.0,
        occlusion_tolerance: 1.0,
    }
}

/// One brush of an even opacity.
pub fn even_brush(opacity: f32) -> Brushes {
    let image = BrushImage::new([1, 1], vec![[opacity; 4]]).unwrap();
    Brushes::new(gpu(), &[image]).unwrap()
}

/// A camera, a shape, and how it turns.
pub struct Turning {
    /// The camera.
    pub camera: ReferenceCamera,
    /// Columns and rows of the sources.
    pub size: [u32; 2],
    /// The shape.
    pub shape: Shape,
    /// Radians a frame, about the vertical axis.
    pub step: f64,
    /// Gradient magnitude of a point of the object.
    pub magnitude: fn(Vec3) -> f64,
}

/// Sectors of longitude, a layer each in turn.
pub fn sectors(point: Vec3) -> f64 {
    let turn = (point.z - 0.5).atan2(point.x - 0.5).rem_euclid(TAU) / TAU;
    MAGNITUDES[(turn * 12.0) as usize % 3]
}

/// A colour of a point of the object.
pub fn paint(point: Vec3) -> [f64; 3] {
    [0.2 + 0.6 * point.x, 0.1 + 0.5 * point.y, 0.8 - 0.5 * point.z]
}

impl Turning {
    /// A ball that covers four fifths of the height of the picture.
    pub fn ball(size: [u32; 2]) -> Self {
        Self::ball_within(size, 0.372)
    }

    /// A ball before a camera of a vertical field of view, radians.
    pub fn ball_within(size: [u32; 2], fov_y: f64) -> Self {
        let camera = ReferenceCamera::perspective(&camera::View {
            eye: Vec3::new(0.0, 0.9, 6.0),
            target: Vec3::new(0.0, 0.0, 0.0),
            up: Vec3::new(0.0, 1.0, 0.0),
            fov_y,
            aspect: f64::from(size[0]) / f64::from(size[1]),
            near: 0.1,
            far: 30.0,
            reversed: false,
        });
        let shape = Shape::Ball(Vec3::new(0.5, 0.5, 0.5), 0.45);
        Self { camera, size, shape, step: 1_f64.to_radians(), magnitude: sectors }
    }

    /// The shape in a frame: the unit cube is two metres wide, its middle in the origin.
    pub fn posed(&self, frame: u32) -> Posed {
        let (sine, cosine) = (self.step * f64::from(frame)).sin_cos();
        let (c, s) = (2.0 * cosine, 2.0 * sine);
        let pose = Mat4::from_rows([
            [c, 0.0, s, -0.5 * (c + s)],
            [0.0, 2.0, 0.0, -1.0],
            [-s, 0.0, c, -0.5 * (c - s)],
            [0.0, 0.0, 0.0, 1.0],
        ]);
        Posed::new(self.shape, pose)
    }

    /// What each pixel sees, row after row.
    pub fn sights(&self, frame: u32) -> Vec<Option<Sight>> {
        let posed = self.posed(frame);
        let [width, height] = self.size.map(|side| side as usize);
        let row = |y: usize| -> Vec<_> {
            let ndc = |x| ReferenceCamera::pixel_ndc(x, y, width, height);
            (0..width).map(|x| posed.sight(&self.camera, ndc(x))).collect()
        };
        parallel::rows(height, row).into_iter().flatten().collect()
    }

    /// The host's camera.
    pub fn host_camera(&self) -> Camera {
        let kind = u32::from(self.camera.is_orthographic());
        Camera { projection: kind, ..host_camera(&self.camera, self.size) }
    }

    /// The step to a frame, a sixtieth of a second.
    pub fn step(&self, frame: u32) -> StrokeStep {
        StrokeStep {
            camera: self.host_camera(),
            world_from_unit: host_matrix(self.posed(frame).world_from_object),
            seconds: 1.0 / 60.0,
            generation: true,
            deletion: true,
        }
    }
}

/// The targets of a ray caster.
pub struct Targets {
    /// Premultiplied linear RGB.
    pub color: Texture,
    /// Normal and magnitude.
    pub surface: Texture,
    /// Metres.
    pub distance: Texture,
    /// Curvatures.
    pub curvature: Texture,
}

impl Targets {
    /// Empty ones.
    pub fn new(size: [u32; 2]) -> Self {
        let texture = |format| Texture::storage(gpu(), size, format);
        Self {
            color: texture(wgpu::TextureFormat::Rgba16Float),
            surface: texture(wgpu::TextureFormat::Rgba16Float),
            distance: texture(wgpu::TextureFormat::R32Float),
            curvature: texture(wgpu::TextureFormat::Rgba16Float),
        }
    }

    /// Writes what is seen.
    pub fn write(&self, sights: &[Option<Sight>], magnitude: impl Fn(Vec3) -> f64) {
        let mut values = [Vec::new(), Vec::new(), Vec::new(), Vec::new()];
        for sight in sights {
            let (color, surface, distance) = match sight {
                Some(seen) => {
                    let [r, g, b] = paint(seen.point);
                    let n = seen.normal;
                    ([r, g, b, 1.0], [n.x, n.y, n.z, magnitude(seen.point)], seen.distance)
                }
                None => ([0.0; 4], [0.0; 4], -1.0),
            };
            values[0].extend(color.map(|value| value as f32));
            values[1].extend(surface.map(|value| value as f32));
            values[2].push(distance as f32);
            values[3].extend([0.0_f32; 4]);
        }
        let all = [&self.color, &self.surface, &self.distance, &self.curvature];
        for (texture, values) in all.into_iter().zip(&values) {
            texture.write(gpu(), values).unwrap();
        }
    }

    /// As strokes take them.
    pub fn all(&self) -> StrokeTargets<'_> {
        StrokeTargets {
            color: &self.color,
            surface: &self.surface,
            distance: &self.distance,
            curvature: Some(&self.curvature),
        }
    }
}

/// Strokes on a turning shape.
pub struct Show {
    /// The shape.
    pub turning: Turning,
    /// What is seen of it.
    pub targets: Targets,
    /// The strokes.
    pub strokes: Strokes,
}

impl Show {
    /// No strokes yet. `settings`: from those that the sizes have by default.
    pub fn new(
        turning: Turning,
        style: PainterlyStyle,
        brushes: Brushes,
        settings: impl Fn(StrokeSettings) -> StrokeSettings,
    ) -> Self {
        let settings = settings(StrokeSettings::new(turning.size, turning.size));
        let strokes = Strokes::new(gpu(), shaders(), style, brushes, settings)
            .unwrap_or_else(|error| panic!("{error}"));
        Self { targets: Targets::new(turning.size), turning, strokes }
    }

    /// Casts a frame and does a step that may be changed.
    pub fn frame(&mut self, frame: u32, change: impl Fn(&mut StrokeStep)) -> StrokeCounts {
        self.targets.write(&self.turning.sights(frame), self.turning.magnitude);
        self.again(frame, change)
    }

    /// Does a step with the targets as they are.
    pub fn again(&mut self, frame: u32, change: impl Fn(&mut StrokeStep)) -> StrokeCounts {
        let mut step = self.turning.step(frame);
        change(&mut step);
        let mut encoder = gpu().encoder();
        self.strokes.record(gpu(), &mut encoder, &self.targets.all(), &step).unwrap();
        gpu().submit(encoder).unwrap();
        self.strokes.read_counts(gpu()).unwrap()
    }

    /// The strokes.
    pub fn read(&self) -> Vec<Stroke> {
        self.strokes.read(gpu()).unwrap()
    }
}

/// A vector of the references.
pub fn reference(v: glam::Vec3) -> Vec3 {
    Vec3::from(v.to_array())
}
