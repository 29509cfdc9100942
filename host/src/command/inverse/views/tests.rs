// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files of views, sound and broken, and their pictures.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::formats::{Array, ArrayData, write_exr, write_npy, write_png};

const FRONT: &str = "\
[[view]]
name = \"front\"
size = [3, 2]
camera = { eye = [0, 1, 5], target = [0, 1, 0], field_of_view = 40 }
";

fn written(folder: &Path, more: &str) -> Result<LoadedView, ViewsError> {
    let path = folder.join("views.toml");
    std::fs::write(&path, format!("{FRONT}{more}")).unwrap();
    load_view(&read_views(&path)?.list[0])
}

#[test]
fn every_key_is_read() {
    let text = format!(
        "{FRONT}
[[view]]
name = 'side_2'
size = [640, 480]
time = 12.5
target = 'side.png'
weights = 'w.exr'
mask = '/m.png'
depth = 'd.npy'
background = 'sky.exr'
environment = 'dusk.exr'
[view.camera]
eye = [-4, 0, 0]
target = [1, 0, 0]
up = [0, 0, 1]
height = 3
near = -1
far = 9
"
    );
    let views = parse_views("a/views.toml", &text).unwrap().list;
    let [front, side] = &views[..] else { panic!("{views:?}") };
    let View::Perspective(view) = front.view else { panic!("{front:?}") };
    assert_eq!((view.field_of_view, view.near, view.far), (40.0, 0.05, 500.0));
    assert_eq!((front.background.clone(), front.up, front.time), (Background::Color(Vec3::ZERO), None, None));
    let View::Orthographic(view) = side.view else { panic!("{side:?}") };
    assert_eq!((view.eye, view.target, view.height), (Vec3::new(-4.0, 0.0, 0.0), Vec3::X, 3.0));
    assert_eq!((view.near, view.far, side.up, side.time), (-1.0, 9.0, Some(Vec3::Z), Some(12.5)));
    assert_eq!((side.name.as_str(), side.size), ("side_2", [640, 480]));
    assert_eq!(side.target.as_deref(), Some(Path::new("a/side.png")));
    assert_eq!(side.weights.as_deref(), Some(Path::new("a/w.exr")));
    assert_eq!(side.mask.as_deref(), Some(Path::new("/m.png")));
    assert_eq!(side.depth.as_deref(), Some(Path::new("a/d.npy")));
    assert_eq!(side.background, Background::Picture("a/sky.exr".into()));
    assert_eq!((side.environment.as_deref(), &front.environment), (Some(Path::new("a/dusk.exr")), &None));
    // Up is +z: a point above the target in z is high in the picture.
    let above = side.camera().unwrap().clip_from_world.project_point3(Vec3::new(1.0, 0.0, 1.5));
    assert!((above.y - 1.0).abs() < 1e-5, "{above}");
}

#[test]
fn nonsense_is_refused_with_file_key_value_and_remedy() {
    let with = |more: &str| format!("{FRONT}{more}");
    let camera = |camera: &str| {
        format!(
            "[[view]]\nname = \"front\"\nsize = [3, 2]\ncamera = {{ eye = [0, 1, 5], target = [0, 1, 0]{camera} }}\n"
        )
    };
    for (text, said) in [
        (String::new(), "[[view]]: there is none"),
        (with("tint = 1"), "views.toml:5:1: unknown field `tint`"),
        (with("tint = 1"), "`weights`"),
        (camera(", roll = 3"), "views.toml:4:49: unknown field `roll`"),
        (format!("[[views]]\n{FRONT}"), "unknown field `views`"),
        (with(&FRONT.replace("front", "f/../x")), "view `f/../x`: name: `f/../x` is no name"),
        (with(FRONT), "view `front`: name: `front` is taken"),
        (
            FRONT.replace("[3, 2]", "[0, 2]"),
            "view `front`: size: [0, 2] pixels are impossible: give 1 to 8192",
        ),
        (FRONT.replace("[3, 2]", "[3, -2]"), "views.toml:3:12: invalid value: integer `-2`"),
        (with("time = nan"), "view `front`: time: NaN"),
        (with("background = [1, -1, 0]"), "background: [1.0, -1.0, 0.0] is impossible"),
        (with("background = '#12345'"), "background: `#12345` is no colour"),
        (with("background = 3"), "views.toml:5:14: a background is [red, green, blue]"),
        (camera(""), "camera.field_of_view or camera.height: neither is given"),
        (camera(", field_of_view = 3, height = 3"), "both are given; give field_of_view (degrees)"),
        (camera(", field_of_view = 180"), "view `front`: camera: field of view 180 degrees is impossible"),
        (camera(", height = 0"), "camera: a picture of 0 m is impossible"),
        (camera(", field_of_view = 30, near = 3, far = 2"), "near plane 3 m and far plane 2 m"),
        (camera(", field_of_view = 30, up = [0, 0, 2]"), "camera: up [0, 0, 2] is impossible"),
    ] {
        let error = parse_views("some/views.toml", &text).unwrap_err().to_string();
        assert!(error.contains(said) && error.contains("some/views.toml"), "{text}\n{error}");
    }
    let error = read_views("none/views.toml").unwrap_err().to_string();
    assert!(error.contains("none/views.toml cannot be read"), "{error}");
}

#[test]
fn pictures_become_linear_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    write_png(at("t.png"), 3, 2, &[255, 188, 0].repeat(6)).unwrap();
    write_png(at("w.png"), 3, 2, &[0, 51, 102, 153, 204, 255]).unwrap();
    write_png(at("m.png"), 3, 2, &[0, 127, 128, 255, 1, 200]).unwrap();
    let depth = vec![1.5, f32::INFINITY, 3.0, 0.0, 5.0, 6.0];
    write_npy(at("d.npy"), &Array { shape: vec![2, 3], data: ArrayData::F32(depth.clone()) }).unwrap();
    let behind: Vec<f32> = (0..18_u8).map(|i| f32::from(i) * 100.5).collect();
    write_exr(at("b.exr"), 3, 2, &behind).unwrap();
    let keys = "target = 't.png'\nweights = 'w.png'\nmask = 'm.png'\ndepth = 'd.npy'\nbackground = 'b.exr'";
    let view = written(folder.path(), keys).unwrap();
    let target = view.required_target().unwrap();
    assert!(target.iter().all(|color| color.distance(Vec3::new(1.0, 0.5029, 0.0)) < 1e-3), "{target:?}");
    let weights = view.weights.as_ref().unwrap();
    assert!(weights.iter().zip(0_u8..).all(|(w, i)| (w - 0.2 * f32::from(i)).abs() < 1e-6), "{weights:?}");
    assert_eq!(view.mask.as_deref(), Some(&[false, false, true, true, false, true][..]));
    assert_eq!(view.depth.as_ref(), Some(&depth));
    assert_eq!(view.background[4], Vec3::new(12.0, 13.0, 14.0) * 100.5);
    assert_eq!(view.camera.viewport, glam::Vec2::new(3.0, 2.0));
    // Depth from the red of an .exr; and nothing at all.
    let distances: Vec<f32> = depth.iter().flat_map(|metres| [*metres, 9.0, 9.0]).collect();
    write_exr(at("d.exr"), 3, 2, &distances).unwrap();
    assert_eq!(written(folder.path(), "depth = 'd.exr'").unwrap().depth, Some(depth));
    let bare = written(folder.path(), "background = '#ff0000'").unwrap();
    assert!(bare.target.is_none() && bare.weights.is_none() && bare.mask.is_none() && bare.depth.is_none());
    assert_eq!(bare.background, [Vec3::X; 6]);
    let error = bare.required_target().unwrap_err().to_string();
    assert!(error.contains("views.toml: view `front` has no target"), "{error}");
}

#[test]
fn transparent_parts_of_a_target_do_not_count() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let pixels: Vec<u8> = [255, 0, 0, 51, 0, 255].iter().flat_map(|alpha| [9, 9, 9, *alpha]).collect();
    write_png(at("t.png"), 3, 2, &pixels).unwrap();
    let alone = written(folder.path(), "target = 't.png'").unwrap().weights.unwrap();
    assert_eq!(alone, [1.0, 0.0, 0.0, 0.2, 0.0, 1.0]);
    write_npy(at("w.npy"), &Array { shape: vec![2, 3], data: ArrayData::U8(vec![3, 3, 0, 5, 1, 0]) })
        .unwrap();
    let both = written(folder.path(), "target = 't.png'\nweights = 'w.npy'").unwrap().weights.unwrap();
    assert_eq!(both, [3.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    // What the weights keep the target leaves out.
    write_npy(at("w.npy"), &Array { shape: vec![2, 3], data: ArrayData::U8(vec![0, 3, 1, 0, 1, 0]) })
        .unwrap();
    let error = written(folder.path(), "target = 't.png'\nweights = 'w.npy'").unwrap_err();
    assert!(matches!(error, ViewsError::NoWeight { key: "target", .. }), "{error}");
}

#[test]
fn bad_pictures_are_named_errors() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let zeros = [0.0_f32; 18];
    let with = |changes: &[(usize, f32)]| {
        let mut values = zeros;
        changes.iter().for_each(|(place, value)| values[*place] = *value);
        values
    };
    write_exr(at("nan.exr"), 3, 2, &with(&[(4, f32::NAN), (10, f32::INFINITY), (11, f32::NAN)])).unwrap();
    write_exr(at("zero.exr"), 3, 2, &zeros).unwrap();
    write_exr(at("minus.exr"), 3, 2, &with(&[(15, -1.0), (0, 1.0)])).unwrap();
    write_exr(at("wide.exr"), 2, 3, &zeros).unwrap();
    write_png(at("grey.png"), 3, 2, &[7; 6]).unwrap();
    std::fs::write(at("broken.exr"), "no picture").unwrap();
    write_npy(at("turned.npy"), &Array { shape: vec![3, 2], data: ArrayData::F32(vec![1.0; 6]) }).unwrap();
    for (key, file, said) in [
        ("target", "nan.exr", "2 pixels of"),
        ("target", "nan.exr", "not finite, the first in column 1 of row 0"),
        ("background", "nan.exr", "2 pixels of"),
        ("weights", "nan.exr", "2 pixels of"),
        ("weights", "minus.exr", "1 pixels of"),
        ("weights", "minus.exr", "negative or not finite, the first in column 2 of row 1"),
        ("weights", "zero.exr", "all weights of"),
        ("target", "wide.exr", "has 2x3 pixels, the view 3x2"),
        ("weights", "wide.exr", "has 2x3 pixels, the view 3x2"),
        ("mask", "wide.exr", "has 2x3 pixels, the view 3x2"),
        ("background", "wide.exr", "has 2x3 pixels, the view 3x2"),
        ("depth", "turned.npy", "the shape [3, 2] instead of [HEIGHT, WIDTH]"),
        ("depth", "minus.exr", "negative or no number, the first in column 2 of row 1"),
        ("depth", "grey.png", "does not hold metres"),
        ("target", "none.png", "there is no such file"),
        ("depth", "none.npy", "there is no such array file"),
        ("mask", "broken.exr", "a .png (sRGB), .exr"),
        ("target", "turned.npy", "neither .png"),
    ] {
        let error = written(folder.path(), &format!("{key} = '{file}'")).unwrap_err().to_string();
        assert!(error.starts_with(&format!("view `front`: {key}: ")), "{error}");
        assert!(error.contains(said) && error.contains(file), "{key} {file}: {error}");
    }
}

#[test]
fn what_is_written_is_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    write_png(at("mask.png"), 3, 2, &[255; 6]).unwrap();
    let text = format!(
        "{FRONT}mask = 'mask.png'\nbackground = [0.1, 0.7, 3]\ntime = 0.3\n[[view]]\nname = 'top'\nsize = [1, 2]\ncamera = {{ eye = [0.1, 7, 0.3], target = [0, 0, 0], height = 0.7, up = [1, 0.2, 0] }}"
    );
    std::fs::write(at("views.toml"), text).unwrap();
    let views = read_views(at("views.toml")).unwrap().list;
    let out = at("out");
    std::fs::create_dir(&out).unwrap();
    let front: Vec<Vec3> = (0..6).map(|i| Vec3::new(0.1, 0.3 * i as f32, 0.25)).collect();
    let top = vec![Vec3::new(-0.5, 0.5, 1e9), Vec3::ONE];
    let written = write_views(&out, &[(&views[0], &front), (&views[1], &top)], &[]).unwrap();
    assert_eq!(written.iter().map(|view| view.clipped).collect::<Vec<_>>(), [2, 1]);
    let text = std::fs::read_to_string(out.join("views.toml")).unwrap();
    let again = read_views(out.join("views.toml")).unwrap().list;
    for ((again, before), written) in again.iter().zip(&views).zip(&written) {
        assert_eq!(
            (&again.name, again.size, again.view, again.up),
            (&before.name, before.size, before.view, before.up),
            "{text}"
        );
        assert_eq!(
            (again.time, &again.background, &again.mask),
            (before.time, &before.background, &before.mask)
        );
        assert_eq!(again.target.as_ref(), Some(&written.png));
        let loaded = load_view(again).unwrap();
        assert_eq!(loaded.camera, before.camera().unwrap());
        let exact =
            load_view(&ViewDescription { target: Some(written.exr.clone()), ..again.clone() }).unwrap();
        let radiance = if again.name == "top" { &top } else { &front };
        assert_eq!(exact.target.as_ref(), Some(radiance));
        for (painted, radiance) in loaded.target.unwrap().iter().zip(radiance) {
            let clipped = radiance.clamp(Vec3::ZERO, Vec3::ONE);
            assert!(painted.distance(clipped) < 0.01, "{painted} {clipped}");
        }
    }
    // A failure leaves no file of views.
    let empty = at("empty");
    std::fs::create_dir(&empty).unwrap();
    let error = write_views(&empty, &[(&views[0], &front), (&views[1], &front)], &[]).unwrap_err();
    assert!(error.to_string().contains("1x2"), "{error}");
    assert!(!empty.join("views.toml").exists());
    assert!(matches!(write_views(at("no"), &[(&views[0], &front)], &[]), Err(ViewsError::Write(_))));
}
