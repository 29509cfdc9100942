// SPDX-License-Identifier: MIT OR Apache-2.0
//! Projectors of the system `inverse` against matrices in f64, for several files.
#![allow(dead_code, clippy::unwrap_used)]

use crate::gpu::{self, Random, gpu, shaders};
use airlight::core::Camera;
use airlight::inverse::{
    Basis, Channels, Collected, Fields, Medium, Projector, ProjectorForm, SliceView, Solved, Transpose,
};
use airlight::{Buffer, Texture};
use airlight_tests::linear::Vec3;
use airlight_tests::reference::camera::{Camera as ReferenceCamera, OrthographicView, View as Perspective};
use airlight_tests::reference::inverse::{
    Basis as ReferenceBasis, Grid, Matrix, Medium as ReferenceMedium, Part, Property, Slices, View,
    VolumeBox, bent, straight,
};
use glam::{Mat4, Quat};

pub const EXTINCTION: [u32; 3] = [12, 9, 10];
pub const SCATTERED: [u32; 3] = [6, 5, 7];
/// Of what is solved for: coarser and finer than the extinction.
pub const GRIDS: [[u32; 3]; 2] = [[12, 9, 10], [7, 11, 5]];
pub const SIZE: [u32; 2] = [36, 28];

pub fn count(size: [u32; 3]) -> usize {
    size.iter().map(|side| *side as usize).product()
}

pub fn random(random: &mut Random, count: usize, high: f64) -> Vec<f32> {
    (0..count).map(|_| random.between(0.0, high) as f32).collect()
}

/// One channel, or all of four numbers of which three are used.
pub fn spread(values: &[f32], channels: Channels) -> Vec<f32> {
    match channels {
        Channels::One => values.to_vec(),
        // Three multiples, so that a channel mistaken for another shows.
        Channels::Rgb => values.iter().flat_map(|v| [*v, 0.5 * v, 2.0 * v, 0.0]).collect(),
    }
}

/// What channels are multiplied by.
pub fn factors(channels: Channels) -> Vec<f64> {
    if channels == Channels::One { vec![1.0] } else { vec![1.0, 0.5, 2.0] }
}

pub fn volume(size: [u32; 3], values: &[f32], channels: Channels) -> Texture {
    let format = match channels {
        Channels::One => wgpu::TextureFormat::R32Float,
        Channels::Rgb => wgpu::TextureFormat::Rgba32Float,
    };
    let texture = Texture::volume(gpu(), size, format);
    texture.write(gpu(), &spread(values, channels)).unwrap();
    texture
}

pub fn grid(size: [u32; 3], values: &[f32], factor: f64) -> Grid {
    Grid {
        size: size.map(|side| side as usize),
        values: values.iter().map(|v| factor * f64::from(*v)).collect(),
    }
}

/// Cameras about a box: far and near, parallel, one within it, and one close to a face, askew, so that part of the box is behind it.
pub fn cameras() -> Vec<(&'static str, ReferenceCamera, Camera)> {
    let up = Vec3::new(0.1, 1.0, 0.0);
    let target = Vec3::new(0.1, 0.0, -0.2);
    let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
    let towards = |eye: Vec3, target: Vec3, fov_y: f64, reversed: bool| {
        // Bent rays of the reference begin on the near plane, those of the host in the eye.
        let view = Perspective { eye, target, up, fov_y, aspect, near: 1e-7, far: 30.0, reversed };
        ReferenceCamera::perspective(&view)
    };
    let perspective = |eye: Vec3, fov_y: f64, reversed: bool| towards(eye, target, fov_y, reversed);
    let close = Vec3::new(0.39, -0.2, 0.92);
    let within = Vec3::new(-0.2, 0.1, -0.15);
    let parallel = OrthographicView {
        eye: Vec3::new(-2.0, 1.5, 3.0),
        target,
        up,
        half_height: 1.3,
        aspect,
        depth: 12.0,
        reversed: false,
    };
    let all = [
        ("along z", perspective(Vec3::new(0.4, 0.5, 4.0), 0.7, false), false),
        ("along x, wide", perspective(Vec3::new(-2.2, 0.4, 0.6), 1.5, true), false),
        ("from above", perspective(Vec3::new(0.7, 3.0, 0.9), 0.9, true), false),
        ("parallel", ReferenceCamera::orthographic(&parallel), true),
        ("close, askew", towards(close, close + Vec3::new(0.3, 0.15, -0.94), 1.2, false), false),
        ("within", perspective(Vec3::new(0.2, -0.1, 0.3), 1.2, false), false),
        // Halfway between two axes, so that planes of slices go on behind it.
        ("within, diagonal", towards(within, within + Vec3::new(1.0, 0.3, 0.6), 1.9, false), false),
    ];
    let host = |(name, camera, parallel): (&'static str, ReferenceCamera, bool)| {
        let seen = Camera { projection: u32::from(parallel), ..gpu::host_camera(&camera, SIZE) };
        (name, camera, seen)
    };
    all.into_iter().map(host).collect()
}

/// Cameras with reversed depth that look at the middle, upright, from several eyes (metres). `fov_y`: radians; `size`: pixels.
pub fn cameras_about(eyes: &[[f64; 3]], fov_y: f64, size: [u32; 2]) -> Vec<(ReferenceCamera, Camera)> {
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let camera = |[x, y, z]: &[f64; 3]| {
        let (target, up) = (Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0));
        let (eye, near, far, reversed) = (Vec3::new(*x, *y, *z), 0.01, 30.0, true);
        let view = Perspective { eye, target, up, fov_y, aspect, near, far, reversed };
        let camera = ReferenceCamera::perspective(&view);
        (camera, gpu::host_camera(&camera, size))
    };
    eyes.iter().map(camera).collect()
}

pub fn placed() -> Mat4 {
    Mat4::from_rotation_translation(Quat::from_rotation_y(0.4) * Quat::from_rotation_x(0.2), glam::Vec3::ZERO)
        * Mat4::from_scale(glam::Vec3::new(2.0, 1.6, 1.8))
        * Mat4::from_translation(glam::Vec3::splat(-0.5))
}

/// A projector and what its views are like.
#[derive(Clone, Copy)]
pub struct Case {
    /// What the projector does.
    pub form: ProjectorForm,
    /// Of straight rays.
    pub slices: u32,
    /// Whether rays end at surfaces.
    pub surfaces: bool,
    /// Greatest extinction, 1/m.
    pub extinction: f64,
}

/// What a projector does with straight rays.
pub fn form(solved: Solved, basis: Basis, channels: Channels, transpose: Transpose) -> ProjectorForm {
    ProjectorForm { solved, channels, basis, transpose, refraction: None }
}

/// The index of refraction of tests of bent rays.
pub const INDEX: [u32; 3] = [5, 6, 4];

/// Values of an index that varies by a third.
pub fn index(random_: &mut Random) -> Vec<f32> {
    (0..count(INDEX)).map(|_| random_.between(1.0, 1.35) as f32).collect()
}

/// An index of refraction on the device.
pub fn index_volume(size: [u32; 3], values: &[f32]) -> Texture {
    volume(size, values, Channels::One)
}

/// Greatest error of a picture of the greatest value, and |<Wx, y> - <x, W'y>| of |Wx| |y|.
pub fn errors(case: &Case, reference: &ReferenceCamera, camera: &Camera, random_: &mut Random) -> [f64; 2] {
    let ProjectorForm { solved, channels, basis, refraction, .. } = case.form;
    let [extinction, scattered] = [(EXTINCTION, case.extinction), (SCATTERED, 1.5)]
        .map(|(size, high)| random(random_, count(size), high));
    let unknown = GRIDS.map(|size| random(random_, count(size), 1.0));
    let pixels = SIZE[0] as usize * SIZE[1] as usize;
    let index = index(random_);
    let depths: Vec<f32> = random(random_, pixels, 6.0);
    let sent = random(random_, pixels, 1.0);
    let textures = [0, 1].map(|i| volume(GRIDS[i], &unknown[i], channels));
    let medium = Medium {
        extinction: volume(EXTINCTION, &extinction, channels),
        scattered: volume(SCATTERED, &scattered, channels),
        index: refraction.map(|_| index_volume(INDEX, &index)),
    };
    let projector = Projector::new(gpu(), shaders(), case.form).unwrap();
    let view = SliceView::new(camera, placed(), EXTINCTION, case.slices).unwrap();
    let images = projector.view(gpu(), &view, case.surfaces.then_some(&depths)).unwrap();
    let picture = Texture::storage(gpu(), SIZE, images.rendered.raw.format());
    picture.write(gpu(), &spread(&sent, channels)).unwrap();
    // Of both, emission has the first grid and albedo the second.
    let own = if solved == Solved::Albedo { 1 } else { 0 };
    let fields = Fields { emission: &textures[0], albedo: &textures[1], extinction: &textures[0] };
    let collected = GRIDS.map(|size| {
        Buffer::with_bytes(
            gpu(),
            &vec![0; 4 * channels.numbers() * count(size)],
            wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        )
    });
    let wanted = GRIDS.map(|size| {
        let words: Vec<u8> = (0..count(size)).flat_map(|_| 1_f32.to_le_bytes()).collect();
        Buffer::with_bytes(gpu(), &words, wgpu::BufferUsages::STORAGE)
    });
    let part = |i: usize| Collected { grid: GRIDS[i], wanted: &wanted[i], sums: &collected[i] };
    let mut encoder = gpu().encoder();
    projector.render(gpu(), &mut encoder, &images, &medium, fields).unwrap();
    let parts = match solved {
        Solved::Both => vec![part(0), part(1)],
        _ => vec![part(own)],
    };
    projector.backproject(gpu(), &mut encoder, &images, &medium, &picture, &parts).unwrap();
    gpu().submit(encoder).unwrap();
    let rendered = images.rendered.read(gpu()).unwrap();
    let back = collected.each_ref().map(|buffer| buffer.read_floats(gpu()).unwrap());

    let volume_box = VolumeBox::new(gpu::matrix(placed())).unwrap();
    let mut seen = View::new(reference, SIZE.map(|side| side as usize));
    // The reference counts from the near plane.
    let near = |pixel: usize| {
        let begin = seen.ray(pixel % seen.size[0], pixel / seen.size[0]).origin;
        if camera.projection == 1 { 0.0 } else { (begin - gpu::vector(camera.eye)).length() }
    };
    let limits = depths.iter().enumerate().map(|(pixel, depth)| (f64::from(*depth) - near(pixel)).max(0.0));
    let limits: Vec<f64> = limits.collect();
    seen.depth = case.surfaces.then_some(limits);
    let cut = Slices::of_view(&volume_box, &seen, EXTINCTION.map(|n| n as usize), case.slices as usize);
    let slow = grid(INDEX, &index, 1.0);
    let samples = seen.rays(|ray| match refraction {
        Some(step) => bent(&volume_box, &slow, f64::from(step), ray),
        None => straight(&volume_box, &cut, ray),
    });
    let reference_basis = match basis {
        Basis::Triangle => ReferenceBasis::Trilinear,
        Basis::Box => ReferenceBasis::Box,
    };
    let part =
        |property, i: usize| Part { property, size: GRIDS[i].map(|n| n as usize), basis: reference_basis };
    let parts = match solved {
        Solved::Emission => vec![part(Property::Emission, 0)],
        Solved::Albedo => vec![part(Property::Albedo, 1)],
        Solved::Both => vec![part(Property::Emission, 0), part(Property::Albedo, 1)],
        Solved::Extinction => vec![part(Property::Extinction, 0)],
    };
    let numbers = channels.numbers();
    let (mut off, mut most, mut forth, mut and_back, mut squares) = (Vec::new(), 0.0_f64, 0.0, 0.0, [0.0; 2]);
    for (channel, factor) in factors(channels).into_iter().enumerate() {
        let known = ReferenceMedium {
            extinction: grid(EXTINCTION, &extinction, factor),
            scattered: grid(SCATTERED, &scattered, factor),
        };
        let matrix = Matrix::new(&samples, &known, &parts);
        let values: Vec<f64> = match solved {
            Solved::Both => [&unknown[0][..], &unknown[1][..]].concat(),
            _ => unknown[own].clone(),
        }
        .into_iter()
        .map(|v| factor * f64::from(v))
        .collect();
        for (pixel, expected) in matrix.apply(&values).into_iter().enumerate() {
            let found = f64::from(rendered[numbers * pixel + channel]);
            off.push((found - expected).abs());
            most = most.max(expected);
            let y = factor * f64::from(sent[pixel]);
            forth += found * y;
            squares[0] += found * found;
            squares[1] += y * y;
        }
        let own_parts = if solved == Solved::Both { vec![0, 1] } else { vec![own] };
        for i in own_parts {
            for (voxel, value) in unknown[i].iter().enumerate() {
                and_back += factor * f64::from(*value) * f64::from(back[i][numbers * voxel + channel]);
            }
        }
    }
    off.sort_by(f64::total_cmp);
    // A sample on the border of two boxes may count for either.
    let ties = if basis == Basis::Box { 3 * factors(channels).len() } else { 0 };
    let worst = off[off.len() - 1 - ties];
    [worst / most, (forth - and_back).abs() / (squares[0] * squares[1]).sqrt()]
}
