// SPDX-License-Identifier: MIT OR Apache-2.0
//! Constraints that are picked from a picture.

use super::baking::{at, baker, color, diffusion, texels, transfer};
use super::marched::{PICTURE, marched, scene};
use crate::gpu::{self, gpu, shaders};
use crate::probing::{f, hold, worst};
use airlight::Buffer;
use airlight::stylize::{Constraint, Place, RayProperty, Restyle, TransferError, TransferSettings};
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use glam::Vec3;
use std::collections::BTreeMap;

#[test]
fn a_picked_pixel_has_its_colour_and_a_point_that_of_its_pixel() {
    let of = gpu::torus_over_plane();
    let stage = of.stage(PICTURE, [512, 512]);
    let scattered = marched(&stage);
    let movements = BTreeMap::from([("torus".to_owned(), Vec3::new(0.4, -0.3, 0.2))]);
    let scene = scene(&stage, &scattered, &movements);
    let camera = gpu::reference_camera(&of.view, PICTURE);
    let point = Vec3::new(-0.3, 2.2, 0.5);
    let pixel_of = |point: Vec3| {
        let [x, y, _] = camera.project(gpu::vector(point)).unwrap();
        [((x + 1.0) / 2.0 * 96.0) as u32, ((1.0 - y) / 2.0 * 72.0) as u32]
    };
    let followed = Place::Point { point, follow: Some("torus".to_owned()) };
    let moved = point + movements["torus"];
    let places = [
        Place::Point { point, follow: None },
        Place::Pixel(pixel_of(point)),
        followed.clone(),
        Place::Pixel(pixel_of(moved)),
    ];
    let settings = TransferSettings { depth_limit: Some(12.0), ..TransferSettings::default() };
    let found = baker().positions(gpu(), &settings, &places, &scene).unwrap();
    assert_eq!((found[0], found[2]), (found[1], found[3]));
    assert!(found[0].distance(found[2]) > 1e-3, "the object moved: {found:?}");
    // What a pick says is what the picture holds.
    let [x, y] = pixel_of(point);
    let (visibility, depth) = (
        texels(&scattered)[(y * 96 + x) as usize][3],
        f(stage.pictures.depth.read(gpu()).unwrap()[(y * 96 + x) as usize]),
    );
    let distance = camera.distance(ReferenceCamera::pixel_ndc(x as usize, y as usize, 96, 72), depth);
    hold("visibility of a pick", (f(found[0].x) - visibility).abs(), 1e-6);
    hold("depth of a pick", (f(found[0].y) - (distance / 12.0).min(1.0)).abs(), 1e-4);

    // The picked pixel, and all that are like it, have the constraint's colour.
    let red = color([0.9, 0.1, 0.2], 1.0);
    let mut style = transfer(
        256,
        vec![diffusion(vec![
            Constraint { place: followed, color: red },
            at(0.0, 0.0, color([0.0, 0.0, 1.0], 1.0)),
            at(1.0, 1.0, color([0.0, 1.0, 0.0], 1.0)),
        ])],
    );
    style.settings = settings;
    let map = baker().bake(gpu(), &style, Some(&scene)).unwrap();
    let function = settings.function(&stage.medium);
    let restyle = Restyle::new(gpu(), shaders(), &function, &stage.inputs(), PICTURE).unwrap();
    let bound =
        restyle.bind(gpu(), &stage.inputs(), &scattered, &map, &Buffer::uniform(gpu(), &function)).unwrap();
    let mut encoder = gpu().encoder();
    restyle.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    let [x, y] = pixel_of(moved);
    let found = texels(&restyle.restyled)[(y * 96 + x) as usize];
    hold("the picked pixel", worst([(found[0], 0.9), (found[1], 0.1), (found[2], 0.2)].into_iter()), 1e-3);
}

#[test]
fn impossible_picks_are_errors() {
    let stage = gpu::torus_over_plane().stage(PICTURE, [64, 64]);
    let scattered = marched(&stage);
    let movements = BTreeMap::from([("torus".to_owned(), Vec3::ZERO)]);
    let scene = scene(&stage, &scattered, &movements);
    let settings = TransferSettings::default();
    let refused = |place: Place| baker().positions(gpu(), &settings, &[place], &scene).unwrap_err();
    let point = |point: Vec3, follow: Option<&str>| Place::Point { point, follow: follow.map(str::to_owned) };
    for (place, message) in [
        (Place::Pixel([96, 0]), "pick 1: pixel 96, 0 lies outside the picture of 96x72"),
        (Place::Pixel([0, 72]), "pick 1: pixel 0, 72 lies outside the picture of 96x72"),
        (point(Vec3::new(-2.5, 1.8, 9.0), None), "pick 1: the point [-2.5, 1.8, 9] lies outside the picture"),
        (point(Vec3::new(50.0, 1.0, 0.0), None), "pick 1: the point [50, 1, 0] lies outside the picture"),
        (point(Vec3::NAN, None), "pick 1: the point [NaN, NaN, NaN] lies outside the picture"),
        (point(Vec3::ZERO, Some("tree")), "pick 1: the scene has no object `tree` to follow; it has `torus`"),
    ] {
        assert_eq!(refused(place).to_string(), message);
    }
    let style = transfer(
        8,
        vec![diffusion(vec![Constraint { place: Place::Pixel([1, 1]), color: color([1.0; 3], 1.0) }])],
    );
    let error = baker().bake(gpu(), &style, None).err().unwrap();
    assert!(
        matches!(&error, TransferError::NeedsScene { key } if key == "layer[0].constraint[0]"),
        "{error}"
    );
}

#[test]
fn the_mean_place_of_lit_points_is_found_by_marching() {
    let of = gpu::torus_over_plane();
    let stage = of.stage(PICTURE, [512, 512]);
    let scattered = marched(&stage);
    let movements = BTreeMap::new();
    let settings = TransferSettings {
        across: RayProperty::VisibleDepth,
        down: RayProperty::Depth,
        depth_limit: Some(10.0),
        ..TransferSettings::default()
    };
    let pixels: Vec<[u32; 2]> = (0..300).map(|i| [i * 37 % 96, i * 11 % 72]).collect();
    let places: Vec<_> = pixels.iter().map(|pixel| Place::Pixel(*pixel)).collect();
    let found = baker().positions(gpu(), &settings, &places, &scene(&stage, &scattered, &movements)).unwrap();
    // By brute force in f64.
    let camera = gpu::reference_camera(&of.view, PICTURE);
    let map = stage.pictures.shadow_map.read(gpu()).unwrap();
    let depth = stage.pictures.depth.read(gpu()).unwrap();
    let matrix = gpu::matrix(stage.light.clip_from_world);
    let mut shadowed = 0;
    let mut errors: Vec<f64> = Vec::new();
    for ([x, y], found) in pixels.iter().zip(&found) {
        let ndc = ReferenceCamera::pixel_ndc(*x as usize, *y as usize, 96, 72);
        let distance = camera.distance(ndc, f(depth[(y * 96 + x) as usize])).min(10.0);
        let lit: Vec<f64> = (0..4000)
            .map(|i| distance * (f64::from(i) + 0.5) / 4000.0)
            .filter(|along| {
                let [u, v, z, _] = matrix.apply_point(camera.eye + camera.ray(ndc) * *along);
                let [u, v] = [(0.5 + 0.5 * u) * 512.0, (0.5 - 0.5 * v) * 512.0];
                let inside = (0.0..512.0).contains(&u) && (0.0..512.0).contains(&v);
                !inside || z <= f(map[v as usize * 512 + u as usize])
            })
            .collect();
        let mean = if lit.is_empty() { distance / 2.0 } else { lit.iter().sum::<f64>() / lit.len() as f64 };
        shadowed += usize::from((mean - distance / 2.0).abs() > 0.05);
        errors.push((f(found.x) * 10.0 - mean).abs() / distance);
    }
    errors.sort_by(f64::total_cmp);
    assert!(shadowed > 60, "{shadowed} rays pass through shadow");
    hold("mean place of lit points, median", errors[errors.len() / 2], 2e-3);
    // One of 96 samples more or less is half a hundredth of the ray.
    hold("mean place of lit points, 95 of 100", errors[errors.len() * 95 / 100], 1e-2);
}
