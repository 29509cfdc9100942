// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight painterly`: pictures and sequences of small volumes, and what is said of them. What cannot be meant is tested in
//! `command_painterly_refusals.rs`.
#![allow(clippy::unwrap_used)]

#[path = "support/command.rs"]
mod command;
#[path = "support/lumps.rs"]
mod lumps;
#[path = "support/npy.rs"]
mod npy;

use command::{Ended, files, folder, succeeds, words};
use image::AnimationDecoder;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

const SIZE: [u32; 2] = [200, 125];
/// What strokes are put on, so that it is told apart from all that is painted.
const CANVAS: [u8; 3] = [0x20, 0x40, 0x60];

/// A folder with the volume `lumps.npy`.
fn lumps() -> tempfile::TempDir {
    let at = folder();
    lumps::write(&at.path().join("lumps.npy"));
    at
}

/// Paints the lumps, or another volume that `flags` name, into the folder `out`.
#[track_caller]
fn paint(at: &Path, flags: &str, out: &str) -> Ended {
    let mut line = format!("painterly {flags} --out {out}");
    for (flag, given) in
        [("--volume", "lumps.npy"), ("--size", "200x125"), ("--canvas", "#204060"), ("--settle", "4")]
    {
        if !line.contains(flag) {
            line.push_str(&format!(" {flag} {given}"));
        }
    }
    succeeds(at, &words(&line))
}

#[track_caller]
fn pixels(path: &Path) -> Vec<[u8; 3]> {
    let picture = image::open(path).unwrap().into_rgb8();
    picture.pixels().map(|pixel| pixel.0).collect()
}

/// The painting of one run.
#[track_caller]
fn painting(at: &Path, flags: &str) -> Vec<[u8; 3]> {
    paint(at, flags, "one");
    let found = pixels(&at.join("one/painting.png"));
    let names: Vec<_> = files(&at.join("one")).into_keys().collect();
    assert_eq!(names, [at.join("one/painting.png")], "{flags}");
    std::fs::remove_dir_all(at.join("one")).unwrap();
    found
}

fn painted(picture: &[[u8; 3]]) -> f64 {
    picture.iter().filter(|pixel| **pixel != CANVAS).count() as f64 / picture.len() as f64
}

fn buffers(folder: &Path) -> BTreeMap<String, (Vec<usize>, Vec<f32>)> {
    let files = files(folder).into_keys();
    files.map(|path| (path.file_stem().unwrap().to_str().unwrap().to_owned(), npy::read_f32(&path))).collect()
}

/// Numbers of a line of the report that begins so, in their order.
#[track_caller]
fn numbers(said: &str, begin: &str) -> Vec<usize> {
    let line = said.lines().find(|line| line.starts_with(begin)).unwrap_or_else(|| panic!("{said}"));
    line.split(|c: char| !c.is_ascii_digit()).filter_map(|word| word.parse().ok()).collect()
}

const STYLE: &str = "
    orientation = 'fixed'
    angle = 30.0
    [coarse]
    threshold = 0.02
    probability = 0.05
    size = 30
    density = { min = 0.05, max = 0.2 }
    [medium]
    threshold = 0.05
    probability = 0.05
    size = 16
    density = { min = 0.05, max = 0.2 }
    [fine]
    threshold = 1.0
    probability = 0.1
    size = 8
    density = { min = 0.05, max = 0.2 }";
const TRANSFER: &str = "
    range = [0.1, 0.9]
    [[point]]
    value = 0.2
    color = '#0000ff'
    opacity = 0
    [[point]]
    value = 0.6
    color = '#00ff00'
    opacity = 1";

#[test]
fn each_flag_changes_the_picture_and_nothing_else_does() {
    let at = lumps();
    let at = at.path();
    std::fs::write(at.join("style.toml"), STYLE).unwrap();
    std::fs::write(at.join("transfer.toml"), TRANSFER).unwrap();
    let brush = image::RgbaImage::from_fn(20, 9, |x, y| image::Rgba([200, 100, 50, (x * y) as u8]));
    brush.save(at.join("brush.png")).unwrap();
    let plain = painting(at, "");
    let share = painted(&plain);
    println!("{share:.3} of the picture is painted");
    assert!((0.1..0.6).contains(&share), "{share} of the picture is painted");
    assert!(painting(at, "") == plain, "the same flags give another picture");
    let mut seen = vec![plain];
    for flags in [
        "--style a",
        "--style b",
        "--style c",
        "--style style.toml",
        "--orientation fixed",
        "--orientation curvature",
        "--transfer transfer.toml",
        "--transfer transfer.toml --brush brush.png",
        "--brush brush.png",
        "--iso 0.8",
        "--source-scale 0.5",
        "--downsample 2",
        "--light directional:90,10",
        "--exposure 1.7",
        "--camera orthographic",
        "--camera orthographic --height 9",
        "--eye 2,1,7",
        "--target 0.5,0,0",
        "--fov 50",
        "--clip 1,0,0,0",
        "--clip 1,0,0,0 --clip 0,-1,0,0",
        "--steps 0.5",
        "--jitter blue-noise --steps 0.5",
        "--settle 0",
        "--seed 2",
        // Strokes that have settled hide what lies under them.
        "--settle 1",
        "--settle 1 --underpainting 0",
        "--settle 1 --underpainting 1",
        "--voxel 0.2 --eye 2,1,7",
    ] {
        let found = painting(at, flags);
        let share = painted(&found);
        assert!(share > 0.02 && share < 0.95, "{flags}: {share} of the picture is painted");
        assert!(!seen.contains(&found), "{flags} gives a picture that was there before");
        seen.push(found);
    }
    // The canvas is what was said, but for the faintest rims of strokes where the other one shows no paint.
    let other = painting(at, "--canvas #ffffff");
    assert_eq!((seen[0][0], other[0]), (CANVAS, [255; 3]));
    let bare = seen[0].iter().zip(&other).filter(|(pixel, _)| **pixel == CANVAS).map(|(_, white)| white);
    assert!(bare.flatten().all(|channel| *channel >= 252));
}

/// With colours as they are, in full light from everywhere.
#[test]
fn colours_are_those_of_the_transfer_function_in_the_light() {
    let at = lumps();
    let at = at.path();
    std::fs::write(at.join("blue.toml"), "[[point]]\nvalue = 0.5\ncolor = '#2040ff'\nopacity = 1\n").unwrap();
    let mean = |flags: &str| {
        let found = painting(at, &format!("--transfer blue.toml --underpainting 1 --settle 0 {flags}"));
        let seen: Vec<_> = found.iter().filter(|pixel| **pixel != CANVAS).collect();
        [0, 1, 2].map(|c| seen.iter().map(|pixel| f64::from(pixel[c])).sum::<f64>() / seen.len() as f64)
    };
    let [red, green, blue] = mean("");
    assert!(blue > 1.4 * green && green > 1.2 * red && blue > 80.0, "{red} {green} {blue}");
    let dark = mean("--exposure 0.2");
    assert!(dark[2] < 0.7 * blue, "{dark:?} is not much darker than {blue}");
}

#[test]
fn sequences_are_numbered_and_animated_and_turn() {
    let at = lumps();
    let at = at.path();
    paint(at, "--frames 2..5 --turn 30 --rate 8", "walk");
    let names: Vec<String> = files(&at.join("walk"))
        .into_keys()
        .map(|path| path.file_name().unwrap().to_str().unwrap().to_owned())
        .collect();
    let mut expected: Vec<String> = (2..=5).map(|frame| format!("painting.{frame:04}.png")).collect();
    let pictures: Vec<_> = expected.iter().map(|name| pixels(&at.join("walk").join(name))).collect();
    expected.push("painting.png".to_owned());
    assert_eq!(names, expected);
    let file = BufReader::new(File::open(at.join("walk/painting.png")).unwrap());
    let decoder = image::codecs::png::PngDecoder::new(file).unwrap().apng().unwrap();
    let shown = decoder.into_frames().collect_frames().unwrap();
    assert_eq!(shown.len(), 4);
    for (frame, picture) in shown.iter().zip(&pictures) {
        let (numerator, denominator) = frame.delay().numer_denom_ms();
        assert_eq!(numerator, 125 * denominator);
        assert!(frame.buffer().pixels().zip(picture).all(|(a, b)| a.0[..3] == b[..]), "another picture");
    }
    assert!(pictures.windows(2).all(|pair| pair[0] != pair[1]), "nothing moves");
    // A whole turn is none; a frame is turned by its number.
    let first = |flags: &str| {
        paint(at, flags, "first");
        let name =
            files(&at.join("first")).into_keys().find(|path| path.to_str().unwrap().contains(".0")).unwrap();
        let found = pixels(&name);
        std::fs::remove_dir_all(at.join("first")).unwrap();
        found
    };
    let still = first("--frames 0..0");
    assert!(first("--frames 3..3 --turn 0") == still && first("--frames 3..3 --turn -120") == still);
    assert!(first("--frames 3..3 --turn 20") == first("--frames 1..1 --turn 60"));
    assert!(
        first("--frames 3..3 --turn 20") != still
            && first("--frames 3..3") == first("--frames 1..1 --turn 9")
    );
    assert!(painting(at, "") == still);
    // A second time over what is there.
    paint(at, "--frames 2..2", "walk");
    assert_eq!(files(&at.join("walk")).len(), 5);
}

/// The great lump, in front, goes to the right where the volume turns by 90 degrees, and to the left by -90.
#[test]
fn turning_is_about_the_upright_axis() {
    let at = lumps();
    let at = at.path();
    let halves = |turn: &str| {
        let flags =
            format!("--frames 1..1 --turn {turn} --eye 0,0,12 --target 0,0,0 --settle 0 --buffers found");
        paint(at, &flags, "turned");
        let (shape, distance) = buffers(&at.join("found")).remove("distance").unwrap();
        let mut halves = [0; 2];
        for (index, _) in distance.iter().enumerate().filter(|(_, distance)| **distance >= 0.0) {
            halves[2 * (index % shape[1]) / shape[1]] += 1;
        }
        halves
    };
    let ([right, wrong], [also, left]) = (halves("90"), halves("-90"));
    assert!(wrong > 2 * right && also > 2 * left, "{right} {wrong}, {also} {left}");
}

#[test]
fn the_report_says_what_there_is() {
    let at = lumps();
    let at = at.path();
    for (flags, rays) in [("", SIZE), ("--source-scale 0.5", [100, 63]), ("--orientation curvature", SIZE)] {
        let said = paint(at, &format!("{flags} --frames 1..3 --buffers found"), "out");
        assert!(said.err.is_empty(), "{}", said.err);
        assert_eq!(said.out.lines().last(), Some("out/painting.png"));
        assert!(said.out.starts_with("frames: 1 to 3, after 4 to settle\n"), "{}", said.out);
        let found = buffers(&at.join("found"));
        for (name, (_, values)) in &found {
            assert!(values.iter().all(|value| value.is_finite()), "{flags}: {name} is not finite");
        }
        let [width, height] = rays.map(|side| side as usize);
        assert_eq!(found["distance"].0, [height, width]);
        assert_eq!(found["picture"].0, [125, 200, 4]);
        assert_eq!(found.contains_key("curvature"), flags.contains("curvature"));
        let hit = found["distance"].1.iter().filter(|distance| **distance >= 0.0).count();
        assert_eq!(numbers(&said.out, "rays:"), [hit, width * height]);
        assert!(hit > width * height / 10);
        let (shape, strokes) = &found["strokes"];
        let counts = numbers(&said.out, "strokes:");
        assert_eq!(shape, &[counts[0], 11]);
        let mut layers = [0; 3];
        strokes.chunks_exact(11).for_each(|stroke| layers[stroke[9] as usize] += 1);
        assert_eq!(counts[1..], [layers[0], layers[1], layers[2], 0], "{}", said.out);
        assert!(counts[0] > 20, "{}", said.out);
        assert!(
            strokes.chunks_exact(11).is_sorted_by_key(|stroke| stroke[9]),
            "fine strokes lie below coarse ones"
        );
    }
    assert_eq!(paint(at, "--quiet", "quiet").out, "");
}

#[test]
fn a_full_buffer_keeps_working_and_says_so() {
    let at = lumps();
    let said = paint(at.path(), "--capacity 30 --frames 0..2", "full").out;
    let counts = numbers(&said, "strokes:");
    assert!(counts[0] == 30 && counts[4] > 30, "{said}");
    assert!(painted(&pixels(&at.path().join("full/painting.0002.png"))) > 0.1);
}

#[test]
fn voxels_that_are_not_finite_are_the_least_and_are_counted() {
    let at = lumps();
    let at = at.path();
    let (mut wild, mut clean) = (lumps::values(), lumps::values());
    let least = clean.iter().copied().fold(f32::INFINITY, f32::min);
    for (index, value) in [(11 + 24 * (9 + 20 * 18), f32::NAN), (6000, f32::INFINITY), (0, f32::NEG_INFINITY)]
    {
        wild[index] = value;
        clean[index] = least;
    }
    npy::write_f32(&at.join("wild.npy"), &lumps::SHAPE, &wild);
    npy::write_f32(&at.join("clean.npy"), &lumps::SHAPE, &clean);
    let said = paint(at, "--volume wild.npy", "wild");
    assert!(said.err.is_empty(), "{}", said.err);
    assert_eq!(numbers(&said.out, "voxels:"), [28 * 20 * 24, 3]);
    let said = paint(at, "--volume clean.npy", "clean").out;
    assert_eq!(numbers(&said, "voxels:"), [28 * 20 * 24, 0]);
    let [wild, clean] = ["wild", "clean"].map(|name| pixels(&at.join(name).join("painting.png")));
    assert!(wild == clean);
}

#[test]
fn nothing_to_see_is_a_bare_canvas_and_a_warning() {
    let at = lumps();
    let at = at.path();
    std::fs::write(at.join("thin.toml"), TRANSFER.replace("opacity = 1", "opacity = 0.3")).unwrap();
    std::fs::write(at.join("far.toml"), TRANSFER.replace("[0.1, 0.9]", "[0.1, 900]").replace("0.6", "600"))
        .unwrap();
    npy::write_f32(&at.join("even.npy"), &[3, 3, 3], &[7.0; 27]);
    npy::write_f32(&at.join("none.npy"), &[3, 3, 3], &[f32::NAN; 27]);
    for (flags, said) in [
        ("--transfer thin.toml", "--transfer: it is nowhere as opaque as --iso 0.5, 0.3 at most"),
        ("--transfer far.toml", "--volume: none of its values, from 0"),
        ("--volume even.npy", "from 7 to 7, is as opaque as --iso 0.5"),
        ("--volume none.npy", "--volume: none of its values"),
        ("--target 0,90,0 --eye 0,80,0", "--eye and --target"),
        ("--clip 0,1,0,-90", "--clip"),
    ] {
        for more in ["", "--frames 0..1"] {
            let ended = paint(at, &format!("{flags} {more}"), "empty");
            assert!(
                ended.err.starts_with("airlight: warning: ") && ended.err.contains(said),
                "{flags}: {}",
                ended.err
            );
            assert_eq!(ended.err.trim_end().lines().count(), 1, "{}", ended.err);
            assert_eq!(numbers(&ended.out, "rays:")[0], 0);
            let picture = pixels(&at.join("empty/painting.png"));
            assert!(picture.len() == 25000 && painted(&picture) == 0.0, "{flags}");
        }
    }
}

#[test]
fn cameras_inside_see_the_surface_around_them() {
    let at = lumps();
    let at = at.path();
    // A shell of radius 0.7 about the middle, empty within.
    let side = 24;
    let values: Vec<f32> = (0..side * side * side)
        .map(|index| {
            let voxel = [index % side, index / side % side, index / side / side];
            let square: f32 =
                voxel.iter().map(|i| (2.0 * (*i as f32 + 0.5) / side as f32 - 1.0).powi(2)).sum();
            (1.0 - 5.0 * (square.sqrt() - 0.7).abs()).max(0.0)
        })
        .collect();
    npy::write_f32(&at.join("shell.npy"), &[side; 3], &values);
    for (flags, least) in [
        ("--volume shell.npy --eye 0,0,0 --target 0,0.3,1", 1.0),
        ("--volume shell.npy --eye 0,0,1.4 --target 0,0,-1", 0.99),
        ("--eye 0,0,1.9 --target 0,0,0", 0.05),
    ] {
        let said = paint(at, &format!("{flags} --fov 60"), "inside").out;
        let [hit, all] = numbers(&said, "rays:")[..] else { panic!("{said}") };
        let share = hit as f64 / all as f64;
        assert!(share >= least, "{flags}: {share} of the rays hit");
    }
}

#[test]
fn awkward_volumes_and_sizes_are_painted() {
    let at = lumps();
    let at = at.path();
    let value = |index: usize| ((index * 7) % 11) as f32;
    for shape in [[1, 9, 9], [9, 1, 9], [9, 9, 1], [1, 1, 9], [9, 1, 1]] {
        let values: Vec<f32> = (0..shape.iter().product()).map(value).collect();
        npy::write_f32(&at.join("thin.npy"), &shape, &values);
        let said = paint(at, "--volume thin.npy --iso 0.3", "thin").out;
        assert!(numbers(&said, "rays:")[0] > 0, "{shape:?}: {said}");
    }
    npy::write_f32(&at.join("one.npy"), &[1, 1, 1], &[3.0]);
    let ended = paint(at, "--volume one.npy", "thin");
    assert!(ended.err.contains("warning"), "{}", ended.err);
    for flags in ["--size 1x1", "--size 3x200", "--size 7x5 --source-scale 0.01", "--capacity 1"] {
        paint(at, flags, "small");
    }
    // Longer than a 3D texture may be, but not when it is averaged.
    let long: Vec<f32> = (0..2 * 2049).map(value).collect();
    npy::write_f32(&at.join("long.npy"), &[2049, 1, 2], &long);
    let said = paint(at, "--volume long.npy --downsample 2", "long").out;
    assert_eq!(numbers(&said, "voxels:"), [1025, 0]);
    // The other order of bytes.
    let big: Vec<u8> = lumps::values().iter().flat_map(|value| value.to_be_bytes()).collect();
    std::fs::write(at.join("big.npy"), npy::encoded(">f4", &lumps::SHAPE, &big)).unwrap();
    assert!(painting(at, "--volume big.npy") == painting(at, ""));
}

/// The head has a fourth axis of length one.
#[test]
fn scans_that_are_shipped_are_painted() {
    let at = folder();
    let assets = concat!(env!("CARGO_MANIFEST_DIR"), "/../host/assets");
    for (file, flags) in [("head_mri", "--transfer head"), ("stent_ct", "--iso 0.35")] {
        let said =
            paint(at.path(), &format!("--volume {assets}/{file}.nii.gz {flags} --downsample 2"), file).out;
        let [hit, all] = numbers(&said, "rays:")[..] else { panic!("{said}") };
        assert!(hit > all / 50 && hit < all / 2, "{file}: {said}");
        assert!(numbers(&said, "strokes:")[0] > 50, "{file}: {said}");
    }
}
