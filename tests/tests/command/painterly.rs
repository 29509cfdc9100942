// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight painterly`: pictures and sequences of small volumes, and what is said of them. Volumes of all kinds are tested in
//! `painterly_volumes.rs`, what cannot be meant in `painterly_refusals.rs`.

use crate::command::files;
use crate::lumps;
use crate::painting::{CANVAS, SIZE, TRANSFER, buffers, numbers, paint, painted, painting, pixels};
use image::AnimationDecoder;
use std::fs::File;
use std::io::BufReader;

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
#[test]
fn each_flag_changes_the_picture_and_nothing_else_does() {
    let at = lumps::folder();
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
    let at = lumps::folder();
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
    let at = lumps::folder();
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
    let at = lumps::folder();
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
    let at = lumps::folder();
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
    let at = lumps::folder();
    let said = paint(at.path(), "--capacity 30 --frames 0..2", "full").out;
    let counts = numbers(&said, "strokes:");
    assert!(counts[0] == 30 && counts[4] > 30, "{said}");
    assert!(painted(&pixels(&at.path().join("full/painting.0002.png"))) > 0.1);
}
