// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight stylize`: sequences, transfer functions and picks.

use crate::command::{self, succeeds, words};
use crate::stylized::{POINT, Run, SIZE, SPOT, SUN, halls, own};
use image::AnimationDecoder;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Draws a .png without buffers; what was said.
fn draw(at: &Path, flags: &str, out: &str) -> String {
    let line = format!("stylize --mesh room.obj --mesh plate.obj {} --out {out}", own(flags));
    succeeds(at, &words(&line)).out
}

fn pixels(at: &Path, name: &str) -> Vec<u8> {
    image::open(at.join(name)).unwrap().into_rgba8().into_raw()
}

/// The frames of an animated PNG, and the milliseconds that each is shown.
fn animation(at: &Path, name: &str) -> Vec<(Vec<u8>, f64)> {
    let file = BufReader::new(File::open(at.join(name)).unwrap());
    let decoder = image::codecs::png::PngDecoder::new(file).unwrap().apng().unwrap();
    let frames = decoder.into_frames().collect_frames().unwrap();
    let delay = |frame: &image::Frame| {
        let (numerator, denominator) = frame.delay().numer_denom_ms();
        f64::from(numerator) / f64::from(denominator)
    };
    frames.into_iter().map(|frame| (frame.buffer().as_raw().clone(), delay(&frame))).collect()
}

#[test]
fn a_sequence_begins_and_ends_with_the_stills_of_its_key_frames() {
    let at = halls();
    let at = at.path();
    let keyed = "--close-disc 2:1,4:9 --extrude 0:5,5:11 --rate 8 \
                 --holes size=2:0.2/5:0.5,density=0.3,distance=0.03,time=1";
    let setup = format!("{SUN} {keyed}");
    draw(at, &format!("{setup} --frames 2..5"), "walk.png");
    let names: Vec<String> = (2..=5).map(|frame| format!("walk.{frame:04}.png")).collect();
    let written = std::fs::read_dir(at).unwrap();
    let written =
        written.filter(|file| file.as_ref().unwrap().file_name().to_string_lossy().starts_with("walk"));
    assert_eq!(written.count(), 5);
    let pictures: Vec<Vec<u8>> = names.iter().map(|name| pixels(at, name)).collect();
    let shown = animation(at, "walk.png");
    assert_eq!(shown.len(), 4);
    for (index, (shown, picture)) in shown.iter().zip(&pictures).enumerate() {
        assert!(shown.0 == *picture && shown.1 == 125.0, "frame {index} of the animation, {} ms", shown.1);
        // Every frame is the still of that frame.
        draw(at, &format!("{setup} --frame {}", index + 2), "still.png");
        assert!(pixels(at, "still.png") == *picture, "the still of frame {}", index + 2);
    }
    assert!(pictures.windows(2).all(|pair| pair[0] != pair[1]), "nothing moves");
    // The numbers that key frames have, without key frames. Frame 5 lies between none but those of --extrude.
    let holes = |size, time| format!("--holes size={size},density=0.3,distance=0.03,time={time} --rate 8");
    draw(at, &format!("{SUN} --close-disc 1 --extrude 7 {}", holes(0.2, 1.25)), "first.png");
    draw(at, &format!("{SUN} --close-disc 9 --extrude 11 {}", holes(0.5, 1.625)), "last.png");
    assert!(pixels(at, "first.png") == pictures[0], "the first frame is not that of its numbers");
    assert!(pixels(at, "last.png") == pictures[3], "the last frame is not that of its numbers");
}

#[test]
fn jitter_and_time_run_through_a_sequence() {
    let at = halls();
    let at = at.path();
    let jitter = format!("{SUN} --method march --steps 8 --jitter blue-noise");
    draw(at, &format!("{jitter} --frames 7..8"), "a.png");
    draw(at, &format!("{jitter} --frame 8"), "b.png");
    assert!(
        pixels(at, "a.0008.png") == pixels(at, "b.png") && pixels(at, "a.0007.png") != pixels(at, "b.png")
    );
    // Holes of constant widths, whose passes serve all frames.
    let wind = format!("{SUN} --holes size=0:0.3/9:0.6,density=0.3,distance=0.05 --close-box 3 --rate 8");
    draw(at, &format!("{wind} --frames 4..6"), "w.png");
    for frame in 4..=6 {
        draw(at, &format!("{wind} --frame {frame}"), "v.png");
        assert!(pixels(at, &format!("w.{frame:04}.png")) == pixels(at, "v.png"), "holes of frame {frame}");
    }
    assert!(pixels(at, "w.0004.png") != pixels(at, "w.0006.png"), "no wind");
    // Still holes stand still; time with key frames runs by these.
    draw(at, &format!("{SUN} --holes size=0.4,density=0.3 --frames 0..1"), "c.png");
    assert!(pixels(at, "c.0000.png") == pixels(at, "c.0001.png"));
    let moving = format!("{SUN} --holes size=0.4,density=0.3,distance=0.1,time=");
    draw(at, &format!("{moving}0:3/10:1 --frames 5..5"), "d.png");
    draw(at, &format!("{moving}2"), "e.png");
    assert!(pixels(at, "d.0005.png") == pixels(at, "e.png"));
    assert_eq!(animation(at, "d.png").len(), 1);
    draw(at, &format!("{moving}2.1"), "f.png");
    assert!(pixels(at, "f.png") != pixels(at, "e.png"), "holes with a distance stand still");
}

/// An opaque function whose red, green and blue are visibility, depth and 0.
const COORDINATES: &str = "
    depth_limit = 20.0
    [[layer]]
    kind = 'gradient'
    from = { at = [0.0, 0.0], color = [0.0, 0.0, 0.0] }
    to = { at = [1.0, 0.0], color = [1.0, 0.0, 0.0] }
    [[layer]]
    kind = 'gradient'
    blend = 'add'
    from = { at = [0.0, 0.0], color = [0.0, 0.0, 0.0] }
    to = { at = [0.0, 1.0], color = [0.0, 1.0, 0.0] }";

/// Positions that were printed, with their pixels.
fn picked(said: &str) -> Vec<([f64; 2], [usize; 2])> {
    let lines = said.lines().filter_map(|line| line.strip_prefix("at = ["));
    let parse = |line: &str| {
        let (at, pixel) = line.split_once("] # pixel ").unwrap();
        let (x, y) = at.split_once(", ").unwrap();
        let (column, row) = pixel.split_once(',').unwrap();
        ([x, y].map(|n| n.parse().unwrap()), [column, row].map(|n| n.parse().unwrap()))
    };
    lines.map(parse).collect()
}

/// The length of a pixel's ray, metres, from the depth buffer.
fn ray_length(run: &Run, prefix: &str, [x, y]: [usize; 2], near: f64, far: f64) -> f64 {
    let z = f64::from(run.buffers[&format!("{prefix}depth")].1[y * SIZE[0] + x]);
    let forward = near * far / (far - z * (far - near));
    let tangent = (0.5 * 45f64.to_radians()).tan();
    let across = (2.0 * (x as f64 + 0.5) / SIZE[0] as f64 - 1.0) * tangent * SIZE[0] as f64 / SIZE[1] as f64;
    let down = (2.0 * (y as f64 + 0.5) / SIZE[1] as f64 - 1.0) * tangent;
    forward * (1.0 + across * across + down * down).sqrt()
}

#[test]
fn picks_are_where_the_light_is_looked_up() {
    let at = halls();
    std::fs::write(at.path().join("coordinates.toml"), COORDINATES).unwrap();
    let own = "--near 0.5 --far 14 --fov 45 --pick 20,30 --pick 40,10 --pick 33,40";
    for setup in
        [SUN, SPOT, POINT, &format!("{SUN} --resolution half"), &format!("{SUN} --extrude 15 --samples 4")]
    {
        let run = Run::new(at.path(), "stylize", &format!("{setup} {own} --transfer coordinates.toml"));
        let plain = Run::new(at.path(), "stylize", &format!("{setup} {own}"));
        let (found, without) = (picked(&run.said), picked(&plain.said));
        assert_eq!((found.len(), without.len()), (3, 3), "{}", run.said);
        for ((at, [x, y]), (default, _)) in found.iter().zip(&without) {
            let texel = |name: &str| -> Vec<f64> {
                let first = 4 * (y * SIZE[0] + x);
                run.buffers[name].1[first..first + 4].iter().map(|value| f64::from(*value)).collect()
            };
            let visibility = texel("scattered")[3];
            assert!((at[0] - visibility).abs() < 1e-4, "{setup}: {at:?}, visibility {visibility}");
            let length = ray_length(&run, "", [*x, *y], 0.5, 14.0);
            if !setup.contains("samples") {
                let (limited, whole) = ((length / 20.0).min(1.0), length / 56.0);
                assert!((at[1] - limited).abs() < 1e-3, "{setup}: {at:?}, {length} m of 20");
                assert!((default[1] - whole).abs() < 1e-3, "{setup}: {default:?}, {length} m of 56");
            }
            // What is seen is the colour of that place.
            let seen = texel("restyled");
            for (channel, expected) in [at[0], at[1], 0.0].iter().enumerate() {
                let off = (seen[channel] - expected).abs();
                assert!(off < 5e-3, "{setup}: pixel {x},{y} is {seen:?} at {at:?}");
            }
        }
        assert!(run.buffers["scattered"] == plain.buffers["scattered"], "{setup}: scattering changed");
        assert!(run.picture != plain.picture, "{setup}");
        assert_eq!(run.buffers["transfer"].0, [256, 256, 4]);
    }
}

#[test]
fn picks_of_two_eyes_are_those_of_each() {
    let at = halls();
    let run = Run::new(
        at.path(),
        "stylize",
        &format!("{SUN} --stereo 1 --near 0.5 --far 14 --pick 20,30 --pick 84,30"),
    );
    let found = picked(&run.said);
    for ((at, _), prefix) in found.iter().zip(["left_", "right_"]) {
        let visibility = run.visibility(&format!("{prefix}scattered"))[30 * SIZE[0] + 20];
        assert!((at[0] - f64::from(visibility)).abs() < 1e-4, "{prefix}: {at:?}, {visibility}");
        let whole = ray_length(&run, prefix, [20, 30], 0.5, 14.0) / 56.0;
        assert!((at[1] - whole).abs() < 1e-3, "{prefix}: {at:?}, {whole}");
    }
    assert!(found.len() == 2 && found[0].0 != found[1].0, "{}", run.said);
    // They are asked for: --quiet does not hide them.
    let line = format!("--quiet stylize --mesh room.obj --out q.png {} --pick 1,2", own(SUN));
    let said = succeeds(at.path(), &words(&line)).out;
    assert!(said.lines().count() == 1 && picked(&said).len() == 1, "{said}");
}

#[test]
fn a_picked_line_is_a_constraint() {
    let at = halls();
    let write = |name: &str, place: &str| {
        let text = format!(
            "[[layer]]\nkind = 'diffusion'\n[[layer.constraint]]\n{place}\ncolor = '#ff0000'\n\
             [[layer.constraint]]\nat = [0.0, 1.0]\ncolor = '#0000ff'\n"
        );
        std::fs::write(at.path().join(name), text).unwrap();
    };
    let line = Run::new(at.path(), "stylize", &format!("{SUN} --pick 33,40")).said;
    let line = line.lines().find(|line| line.starts_with("at =")).unwrap().to_owned();
    write("pasted.toml", &line);
    write("pixel.toml", "pixel = [33, 40]");
    // A point that lies where it was modelled, on a mesh by its name.
    write("point.toml", "point = [0.0, 0.0, 2.0]\nfollow = 'room'");
    let run = |file: &str| Run::new(at.path(), "stylize", &format!("{SUN} --transfer {file}")).buffers;
    let [pasted, pixel, point] = ["pasted.toml", "pixel.toml", "point.toml"].map(run);
    let pairs = pasted["transfer"].1.iter().zip(&pixel["transfer"].1);
    let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    println!("pasted and picked functions differ by {off}");
    assert!(off < 0.03, "pasted and picked functions differ by {off}");
    assert!(point["transfer"] != pixel["transfer"]);
}

#[test]
fn functions_change_from_key_frame_to_key_frame() {
    let at = halls();
    let at = at.path();
    std::fs::write(at.join("coordinates.toml"), COORDINATES).unwrap();
    let keyed = "
        [[key]]
        frame = 0
        file = 'coordinates.toml'
        [[key]]
        frame = 4
        x = 'visible-depth'
        depth_limit = 20.0
        [[key.layer]]
        kind = 'solid'
        color = [0.5, 0.25, 1.0]";
    std::fs::write(at.join("keyed.toml"), keyed).unwrap();
    draw(at, &format!("{SUN} --transfer keyed.toml --frames 0..4"), "k.png");
    draw(at, &format!("{SUN} --transfer coordinates.toml"), "first.png");
    assert!(pixels(at, "first.png") == pixels(at, "k.0000.png"), "the first frame");
    std::fs::write(at.join("solid.toml"), "[[layer]]\nkind = 'solid'\ncolor = [0.5, 0.25, 1.0]").unwrap();
    draw(at, &format!("{SUN} --transfer solid.toml"), "last.png");
    assert!(pixels(at, "last.png") == pixels(at, "k.0004.png"), "the last frame");
    let [first, half, last] = [0, 2, 4].map(|frame| {
        let flags = format!("{SUN} --transfer keyed.toml --frame {frame}");
        Run::new(at, "stylize", &flags).buffers.remove("transfer").unwrap().1
    });
    for ((first, half), last) in first.iter().zip(&half).zip(&last) {
        assert!((0.5 * (first + last) - half).abs() < 2e-3, "{first} {half} {last}");
    }
}

#[test]
fn the_buffers_of_a_sequence_are_those_of_its_last_frame() {
    let at = halls();
    let at = at.path();
    let setup = format!("{SUN} --extrude 0:1,4:21 --holes size=0.3,density=0.2,distance=0.05 --pick 33,40");
    let of_sequence = draw(at, &format!("{setup} --frames 0..4 --buffers sequence"), "s.png");
    let of_still = draw(at, &format!("{setup} --frame 4 --buffers still"), "t.png");
    assert!(picked(&of_sequence) == picked(&of_still) && of_sequence.ends_with("s.png\n"), "{of_sequence}");
    let [sequence, still] = ["sequence", "still"].map(|folder| {
        let files = command::files(&at.join(folder)).into_iter();
        files.map(|(path, bytes)| (path.file_name().unwrap().to_owned(), bytes)).collect::<Vec<_>>()
    });
    assert!(sequence == still && sequence.len() > 8, "{} files", sequence.len());
}
