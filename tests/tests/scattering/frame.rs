// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frame and slices against the reference, and their layout in memory.

use crate::gpu::{self, Random, gpu, shaders};
use airlight::Buffer;
use airlight::scattering::{Frame, Inputs, Medium, Rectification};
use airlight_tests::linear;
use airlight_tests::reference::scattering as reference;
use glam::Vec3;
use std::f64::consts::PI;
use wgpu::TextureFormat::R32Float;

#[test]
fn frame_and_slices_are_those_of_the_reference() {
    const ROWS: usize = 64;
    let limit = 80.0_f64;
    let map = Rectification::new(gpu(), shaders(), [8, ROWS as u32]).unwrap();
    let (depth, shadow) = (gpu::texture([1, 1], R32Float, &[1.0]), gpu::texture([1, 1], R32Float, &[1.0]));
    let medium = Medium::new(0.1, Vec3::ONE, 0.0, limit as f32).unwrap();
    let mut random = Random(11);
    let camera = random.camera(1.5);
    let camera_buffer = Buffer::uniform(gpu(), &gpu::host_camera(&camera, [96, 64]));
    let light_buffer = Buffer::uniform(
        gpu(),
        &gpu::host_light(camera.up, gpu::light_matrix(camera.up, camera.eye, 20.0, 1.0), 1.0, Vec3::ONE),
    );
    let inputs = Inputs {
        camera: &camera_buffer,
        light: &light_buffer,
        medium: &Buffer::uniform(gpu(), &medium),
        depth: &depth,
        shadow_map: &shadow,
        shadow_views: None,
        shadow_maps: None,
        light_texture: None,
    };
    let bound = map.bind(gpu(), &inputs).unwrap();
    let (mut slices, mut skipped, mut circles, mut borders) = (0, 0, 0, 0);
    // The greatest error of each kind, in units of its budget.
    let mut worst = [0.0_f64; 4];
    for index in 0..200 {
        let aspect = random.between(0.5, 2.5);
        let camera = random.camera(aspect);
        let mut light = random.light(&camera);
        if random.unit() < 0.1 {
            // Barely outside of the picture, where some slices miss it.
            let corner = camera.corners()[random.below(4)];
            light = camera.forward + (corner - camera.forward) * random.between(1.0, 1.001);
        }
        camera_buffer.write(gpu(), &gpu::host_camera(&camera, [96, 64]));
        let matrix = gpu::light_matrix(light, camera.eye, 20.0, 1.0);
        light_buffer.write(gpu(), &gpu::host_light(light, matrix, 1.0, Vec3::ONE));
        let mut encoder = gpu().encoder();
        map.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        let frame = map.frame.read_floats(gpu()).unwrap();
        let texels = map.slices.read(gpu()).unwrap();
        let rounded = gpu::vector(gpu::host_vector(light));
        let expected = reference::Rectification::new(&camera, rounded, limit, 8, ROWS);

        // At the border of the cases f32 may choose the other one: both are right there.
        let sides = camera.side_normals().map(|n| n.dot(expected.frame.l));
        let least = sides.into_iter().fold(f64::INFINITY, f64::min);
        let greatest = sides.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let off_axis = camera.forward.without(expected.frame.l).length();
        let near = |a: f64, b: f64| (a - b).abs() < 1e-5;
        if near(least, -1e-3) || near(greatest, 1e-3) || near(off_axis, 1e-3) {
            borders += 1;
            continue;
        }
        let at = |index: usize| f64::from(frame[index]);
        let axis = |index: usize| linear::Vec3::new(at(index), at(index + 1), at(index + 2));
        assert_eq!(at(15) > 0.5, expected.full_circle, "camera {index}: wrapping; {least} {greatest}");
        circles += usize::from(expected.full_circle);
        // Axes: f32 over the length that is normalised.
        let axes = if off_axis < 1e-3 { 1e-5 } else { 1e-6 + 1e-6 / off_axis };
        for (found, wanted) in
            [(axis(0), expected.frame.l), (axis(4), expected.frame.a), (axis(8), expected.frame.b)]
        {
            worst[0] = worst[0].max((found - wanted).length() / axes);
        }
        assert!((axis(12) - camera.eye).length() < 1e-5);
        assert_eq!(at(11), ROWS as f64);
        // Rows: azimuths of corners next to the light are as good as their distance from it.
        let closest = camera
            .corners()
            .map(|d| expected.frame.polar_direction(d).theta.sin())
            .into_iter()
            .fold(1.0, f64::min);
        let turn = axes + if expected.full_circle { 1e-6 } else { 3e-6 / closest.max(1e-6) };
        let rows = expected.slices.len();
        for j in 0..rows {
            let azimuth = at(3) + j as f64 / at(7);
            worst[1] = worst[1].max((azimuth - expected.slices[j].phi).abs() / (2.0 * turn));
        }
        // Bounds.
        for (j, (slice, texel)) in expected.slices.iter().zip(texels.chunks_exact(4)).enumerate() {
            assert!(texel.iter().all(|x| x.is_finite()), "camera {index}, slice {j}: {texel:?}");
            let radial = expected.frame.radial(slice.phi);
            let planes = camera.side_normals().map(|n| n.dot(expected.frame.l).hypot(n.dot(radial)));
            let flattest = planes.into_iter().filter(|p| *p > 5e-5).fold(1.0, f64::min);
            if planes.iter().any(|p| (*p / 1e-4 - 1.0).abs() < 0.5) {
                skipped += 1;
                continue;
            }
            // A slice that misses the picture next to a light in the plane of a side: its bounds cross
            // the other way round with the sign of rounding.
            let missed = slice.theta_max - slice.theta_min < 1.01e-3;
            if missed && camera.side_normals().iter().any(|n| n.dot(expected.frame.l).abs() < 1e-4) {
                skipped += 1;
                continue;
            }
            slices += 1;
            // The convention: a slice of the least width lies inside [0, pi].
            let shift = (0.0 - slice.theta_min).max(0.0) - (slice.theta_max - PI).max(0.0);
            let angle = (2.0 * turn + 1e-6) / flattest;
            let error = (f64::from(texel[0]) - slice.theta_min - shift)
                .abs()
                .max((f64::from(texel[1]) - slice.theta_max - shift).abs());
            if error / angle > 1.0 {
                println!("camera {index}, slice {j}: {texel:?} instead of {slice:?}, budget {angle:.1e}");
            }
            worst[2] = worst[2].max(error / angle);
            if !missed {
                // The far plane as f32 matrices hold it, and the angle of the rays that reach it.
                let plane = if camera.far.is_finite() && camera.far_depth > 0.5 {
                    camera.far / camera.near
                } else {
                    1.0
                };
                let slant = camera.corners().map(|d| d.dot(camera.forward)).into_iter().fold(1.0, f64::min);
                let steep = slice.theta_min.sin().min(slice.theta_max.sin()).max(1e-3);
                let radius = 1e-6 * plane + 1e-5 + angle / slant / steep;
                worst[3] = worst[3].max((f64::from(texel[2]) / slice.r_max - 1.0).abs() / radius);
                let reference = (f64::from(texel[3]) - slice.k()).abs();
                worst[3] = worst[3].max(reference / (1e-6 + 2.0 * angle / slice.k_min.max(0.1)));
            }
        }
    }
    println!("slices: {slices} compared, {skipped} skipped, {circles} full circles, {borders} at borders");
    println!("worst error over budget: axes, rows, angles, radii and reference: {worst:?}");
    assert!(circles >= 60 && borders <= 20 && skipped < slices / 4, "the random cases are not varied enough");
    assert!(worst.iter().all(|w| *w <= 1.0), "{worst:?}");
}

#[test]
fn layout_of_the_frame_in_memory_is_the_twin() {
    // The tests above read the frame by position.
    use encase::ShaderType;
    assert_eq!(u64::from(Frame::min_size()), 128);
}
