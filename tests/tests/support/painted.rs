// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes that turn before a camera and are painted.
#![allow(dead_code, clippy::unwrap_used)]

use crate::gpu::{gpu, shaders};
use airlight::core::{Camera, DepthRange, Jitter, PerspectiveView, Transfer};
use airlight::data::Volume;
use airlight::painterly::{
    BrushImage, Brushes, Canvas, DensityBounds, IsoSettings, IsoVolume, LayerStyle, Orientation,
    PainterlyStyle, Painting, PaintingFrame, PaintingSettings, Rates, StrokeSettings, StrokeState,
    SurfaceLighting,
};
use airlight_tests::linear;
use glam::{Mat4, Vec3};

/// The picture, and the rays where nothing else is said.
pub const SIZE: [u32; 2] = [160, 120];

/// Small strokes, of one brush, in layers that all have some of a volume of moderate gradients.
pub fn style(thresholds: [f32; 3]) -> PainterlyStyle {
    let layer = |threshold, size| LayerStyle {
        threshold,
        probability: 0.2,
        size,
        aspect: 0.5,
        opacity: 1.0,
        density: DensityBounds { min: 0.03, max: 0.08 },
        brush: Some(0),
    };
    let [coarse, medium, fine] = thresholds;
    PainterlyStyle {
        coarse: layer(coarse, 12.0),
        medium: layer(medium, 10.0),
        fine: layer(fine, 8.0),
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

/// An even brush.
pub fn brush() -> Brushes {
    Brushes::new(gpu(), &[BrushImage::new([1, 1], vec![[0.8; 4]]).unwrap()]).unwrap()
}

/// A volume before a camera.
pub struct Exhibit {
    pub volume: Volume,
    pub uploaded: IsoVolume,
    pub table: Vec<[f32; 4]>,
    pub transfer: Transfer,
    pub surface: IsoSettings,
    pub lighting: SurfaceLighting,
    pub view: PerspectiveView,
    /// Radians a frame, about the vertical.
    pub turn: f32,
}

impl Exhibit {
    /// `table`: colours and opacities from value 0 to 1.
    pub fn new(volume: Volume, range: Option<[f32; 2]>, table: &[[f32; 4]]) -> Self {
        let bounds = volume.bounds();
        let (target, size) = (0.5 * (bounds.min + bounds.max), (bounds.max - bounds.min).length());
        let view = PerspectiveView {
            eye: target + 0.95 * size * Vec3::new(0.4, 0.3, 1.0).normalize(),
            target,
            field_of_view: 36.0,
            near: 0.01 * size,
            far: 10.0 * size,
            depth: DepthRange::Forward,
        };
        Self {
            uploaded: IsoVolume::new(gpu(), &volume, range).unwrap(),
            transfer: Transfer::new(gpu(), table).unwrap(),
            table: table.to_vec(),
            surface: IsoSettings::default(),
            lighting: SurfaceLighting::towards(Vec3::new(0.4, 0.8, 0.5)).unwrap(),
            volume,
            view,
            turn: 2_f32.to_radians(),
        }
    }

    /// Where the volume is in a frame.
    pub fn posed(&self, frame: u32) -> Mat4 {
        let middle = self.view.target;
        let turn = Mat4::from_rotation_y(self.turn * frame as f32);
        Mat4::from_translation(middle) * turn * Mat4::from_translation(-middle) * self.volume.world_from_unit
    }

    /// A painting of it.
    pub fn painting(&self, settings: PaintingSettings) -> Painting<'_> {
        Painting::new(gpu(), shaders(), &self.uploaded, &self.transfer, brush(), settings).unwrap()
    }

    /// A frame that may be changed, for rays of as many pixels as `size`.
    pub fn frame(&self, size: [u32; 2], number: u32) -> PaintingFrame<'_> {
        PaintingFrame {
            camera: Camera::perspective(&self.view, size).unwrap(),
            world_from_unit: self.posed(number),
            surface: &self.surface,
            lighting: &self.lighting,
            seconds: 1.0 / 60.0,
            generation: true,
            deletion: true,
        }
    }
}

/// Settings of a painting of a style.
pub fn settings(style: PainterlyStyle, source_size: [u32; 2]) -> PaintingSettings {
    PaintingSettings {
        strokes: StrokeSettings {
            capacity: 20_000,
            density_step: 2,
            ..StrokeSettings::new(source_size, SIZE)
        },
        style,
        jitter: Jitter::None,
        canvas: Canvas::new(Vec3::new(0.9, 0.8, 0.7), 0.5),
    }
}

/// Does a frame.
pub fn paint(painting: &mut Painting<'_>, frame: &PaintingFrame<'_>) {
    let mut encoder = gpu().encoder();
    painting.record(gpu(), &mut encoder, frame).unwrap();
    gpu().submit(encoder).unwrap();
}

/// A point in the picture in f64, (0, 0) top left to (1, 1); none behind the eye.
pub fn place(camera: &airlight_tests::reference::camera::Camera, world: linear::Vec3) -> Option<[f64; 2]> {
    let [x, y, _] = camera.project(world)?;
    Some([0.5 + 0.5 * x, 0.5 - 0.5 * y])
}

/// Strokes that stay.
pub fn staying(painting: &Painting<'_>) -> Vec<airlight::painterly::Stroke> {
    let all = painting.strokes().read(gpu()).unwrap();
    all.into_iter().filter(|stroke| stroke.state == StrokeState::Stays).collect()
}
