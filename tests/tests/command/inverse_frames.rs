// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight inverse solve --frames`: key frames that are solved for and blended, and times that cannot be meant.

use crate::command::{files, folder, refuses, succeeds, words};
use crate::npy;
use crate::painted_views::{SIZE, read, view, volume};
use airlight::data::load_channels;
use std::path::Path;

const EYES: [[f32; 3]; 2] = [[0.0, 1.0, 9.0], [9.0, 0.5, 0.5]];
const SOLVE: &str =
    "solve --volume left.npy --extinction-scale 2 --views v.toml --for emission,albedo --keep-empty";

/// A puff to the left and one to the right, which glow, and views of both from two sides, painted in two colours.
fn painted() -> tempfile::TempDir {
    let folder = folder();
    let at = folder.path();
    for (name, middle) in [("left", -0.45_f32), ("right", 0.45)] {
        volume(&at.join(format!("{name}.npy")), |[x, y, z]| {
            [(1.0 - ((x - middle).powi(2) + y * y + z * z) / 0.16).max(0.0)]
        });
    }
    for (name, colour) in [("red", [190, 60, 40]), ("blue", [40, 90, 180])] {
        let picture = image::RgbImage::from_pixel(SIZE[0], SIZE[1], image::Rgb(colour));
        picture.save(at.join(format!("{name}.png"))).unwrap();
    }
    folder
}

/// Views of both key frames, in the first of the times from both sides, and what they are painted like.
fn views(times: [&str; 3], keys: &str) -> String {
    let views = [(0, "red"), (1, "red"), (0, "blue")].into_iter().zip(times).enumerate();
    let views = views.map(|(i, ((eye, target), time))| {
        view(&format!("v{i}"), EYES[eye], &format!("target = \"{target}.png\"\n{time}"))
    });
    keys.to_owned() + &views.collect::<String>()
}

const KEYS: &str = "[[key]]\ntime = 2\nvolume = \"left.npy\"\n[[key]]\ntime = 6\nvolume = \"right.npy\"\n";
const TIMES: [&str; 3] = ["time = 2", "time = 2", "time = 6"];

fn radiance(path: &Path) -> Vec<f32> {
    image::open(path).unwrap().into_rgb32f().into_raw()
}

fn apart(one: &[f32], other: &[f32]) -> f32 {
    assert_eq!(one.len(), other.len());
    one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn frames_are_blends_of_the_key_frames_about_them() {
    let folder = painted();
    let at = folder.path();
    std::fs::write(at.join("v.toml"), views(TIMES, KEYS)).unwrap();
    let told =
        succeeds(at, &words(&format!("inverse {SOLVE} --frames 2..6 --seen-from v1 --rate 8 --out out"))).out;
    assert!(told.contains("time 2\n") && told.contains("time 6\n"), "{told}");
    let out = at.join("out");
    let names: Vec<String> =
        files(&out).into_keys().map(|path| path.file_name().unwrap().to_str().unwrap().to_owned()).collect();
    let mut expected: Vec<String> =
        ["between_v0_v1.png", "frame.png", "report.json"].map(str::to_owned).to_vec();
    for frame in 2..=6 {
        expected.extend(["png", "exr"].map(|end| format!("frame.{frame:04}.{end}")));
        for name in ["extinction", "emission", "albedo"] {
            expected.extend(["npy", "nii.gz"].map(|end| format!("{name}.{frame:04}.{end}")));
        }
    }
    expected.extend((0..3).flat_map(|i| ["png", "exr"].map(|end| format!("solved_v{i}.{end}"))));
    expected.sort();
    assert_eq!(names, expected);
    let own = |name: &str, frame: u32| read(&out.join(format!("{name}.{frame:04}.npy"))).1;
    for name in ["extinction", "emission", "albedo"] {
        let [first, last] = [2, 6].map(|frame| own(name, frame));
        assert!(apart(&first, &last) > 0.1, "{name} does not change");
        for (frame, part) in [(3, 0.25_f32), (4, 0.5), (5, 0.75)] {
            let blend: Vec<f32> = first.iter().zip(&last).map(|(a, b)| a + part * (b - a)).collect();
            let off = apart(&own(name, frame), &blend);
            println!("{name} {frame}: {off:e}");
            assert!(off < 1e-5, "{name} {frame}: {off}");
        }
        let placed = load_channels(out.join(format!("{name}.0004.nii.gz")), 1.0).unwrap();
        assert!(placed[1].values.iter().eq(own(name, 4).iter().skip(1).step_by(3)), "the same in both");
    }
    // Extinction of the key frames is that of their files.
    for (frame, name) in [(2, "left.npy"), (6, "right.npy")] {
        let given: Vec<f32> = read(&at.join(name)).1.iter().flat_map(|value| [2.0 * value; 3]).collect();
        assert!(apart(&own("extinction", frame), &given) < 1e-6, "{name}");
    }
    // A key frame is what it would be alone, and looks as its view does.
    std::fs::write(at.join("v.toml"), views(TIMES, "").rsplit_once("[[view]]").unwrap().0).unwrap();
    succeeds(at, &words(&format!("inverse {SOLVE} --out alone")));
    for name in ["emission", "albedo"] {
        assert_eq!(own(name, 2), read(&at.join(format!("alone/{name}.npy"))).1, "{name}");
    }
    assert!(apart(&radiance(&out.join("frame.0002.exr")), &radiance(&out.join("solved_v1.exr"))) < 1e-6);
    // A frame shows its volumes.
    std::fs::write(at.join("one.toml"), view("one", EYES[1], "")).unwrap();
    succeeds(
        at,
        &words(
            "inverse render --volume out/extinction.0004.npy --extinction-scale 1 --views one.toml \
             --emission out/emission.0004.npy --albedo out/albedo.0004.npy --out again",
        ),
    );
    let shown = radiance(&out.join("frame.0004.exr"));
    let off = apart(&shown, &radiance(&at.join("again/one.exr")));
    println!("a frame is {off:e} from what its volumes look like");
    assert!(off < 1e-5 && shown.iter().any(|value| *value > 0.05), "{off}");
    // Played in the order of the frames.
    let file = std::io::BufReader::new(std::fs::File::open(out.join("frame.png")).unwrap());
    let decoder = image::codecs::png::PngDecoder::new(file).unwrap().apng().unwrap();
    let played = image::AnimationDecoder::into_frames(decoder).collect_frames().unwrap();
    assert_eq!(played.len(), 5);
    for (frame, played) in (2..).zip(&played) {
        assert_eq!(played.delay().numer_denom_ms(), (125, 1));
        let still = image::open(out.join(format!("frame.{frame:04}.png"))).unwrap().into_rgba8();
        assert!(*played.buffer() == still, "frame {frame}");
    }
}

/// The Laplacian goes on into what is empty, so that matter which gets there has colours.
#[test]
fn empty_voxels_have_colours_where_they_are_kept() {
    let folder = painted();
    let at = folder.path();
    std::fs::write(at.join("v.toml"), views(TIMES, KEYS)).unwrap();
    let halfway = |flags: &str| {
        let line = SOLVE.replace("--keep-empty", flags);
        succeeds(at, &words(&format!("inverse {line} --iterations 12 --frames 4..4 --out out")));
        read(&at.join("out/emission.0004.npy")).1
    };
    let dense = |name: &str| read(&at.join(name)).1;
    let (left, right) = (dense("left.npy"), dense("right.npy"));
    // Empty in both, as are all about them, and between the puffs.
    let bare = |i: usize| {
        let about = |i: usize, side: usize| [i - side, i, i + side];
        let cube = about(i, 1).into_iter().flat_map(|i| about(i, 24)).flat_map(|i| about(i, 576));
        cube.into_iter().all(|i| left[i] == 0.0 && right[i] == 0.0)
    };
    let between = |i: usize| {
        let [x, y, z] = [i % 24, i / 24 % 24, i / 576];
        (9..15).contains(&x) && (4..20).contains(&y) && (4..20).contains(&z)
    };
    let empty: Vec<usize> = (0..left.len()).filter(|i| between(*i) && bare(*i)).collect();
    let [kept, bare] = ["--keep-empty --laplacian 0.02", "--laplacian 0.02"].map(|flags| {
        let found = halfway(flags);
        empty.iter().filter(|i| found[3 * **i] > 1e-3).count() as f64 / empty.len() as f64
    });
    println!("of empty voxels between the puffs {kept:.3} have a colour, {bare:.3} where they are left out");
    assert!(empty.len() > 200 && kept > 0.5 && bare == 0.0, "{kept} {bare}");
}

/// What is rendered to be painted on has the volumes of its key frames.
#[test]
fn views_of_key_frames_show_their_volumes() {
    let folder = painted();
    let at = folder.path();
    std::fs::write(at.join("v.toml"), views(TIMES, KEYS)).unwrap();
    succeeds(at, &words("inverse render --volume plume --extinction-scale 2 --views v.toml --out painted"));
    let alone = |name: &str, file: &str| {
        std::fs::write(at.join("one.toml"), view("one", EYES[0], "")).unwrap();
        succeeds(
            at,
            &words(&format!(
                "inverse render --volume {file} --extinction-scale 2 --views one.toml --out {name}"
            )),
        );
        radiance(&at.join(name).join("one.exr"))
    };
    let [first, last] = [("l", "left.npy"), ("r", "right.npy")].map(|(name, file)| alone(name, file));
    assert!(apart(&first, &last) > 0.1);
    assert_eq!(radiance(&at.join("painted/v0.exr")), first);
    assert_eq!(radiance(&at.join("painted/v2.exr")), last);
    // The file that is written is one to solve with.
    let line = "inverse solve --volume plume --extinction-scale 2 --views painted/views.toml --for emission --iterations 1 --frames 2..3 --out out";
    succeeds(at, &words(line));
    assert!(at.join("out/emission.0003.npy").exists());
}

#[test]
fn times_that_cannot_be_meant_are_refused() {
    let folder = painted();
    let at = folder.path();
    let refused = |text: &str, flags: &str, code: i32, parts: &[&str]| {
        std::fs::write(at.join("v.toml"), text).unwrap();
        refuses(at, &words(&format!("inverse {SOLVE} --out out {flags}")), code, parts);
    };
    let none = views(["", "", ""], "");
    refused(&none, "--frames 2..6", 2, &["--frames", "`v0` has no `time`"]);
    refused(&views(["time = 2"; 3], ""), "--frames 2..6", 2, &["--frames", "all views show time 2"]);
    let mixed = views(["time = 2", "time = 6", "time = 2"], "");
    refused(&mixed, "--frames 2..6", 2, &["--frames", "`v2` shows time 2", "one of time 6", "order"]);
    let sound = views(TIMES, KEYS);
    for frames in ["0..4", "4..7", "7..9"] {
        refused(&sound, &format!("--frames {frames}"), 2, &["--frames", frames, "from 2 to 6"]);
    }
    refused(&sound, "--frames 4..2", 2, &["--frames", "before it begins"]);
    refused(&sound, "--frames 2..6 --seen-from side", 2, &["--seen-from", "`side`"]);
    refused(&sound, "", 2, &["--views", "[[key]]", "--frames A..B"]);
    refused(&none, "--seen-from v0", 2, &["--seen-from", "--frames A..B"]);
    refused(&none, "--rate 8", 2, &["--rate", "--frames A..B"]);
    refused(&sound, "--frames 2..6 --for light", 2, &["--frames", "light"]);
    // Volumes of key frames.
    let missing = views(TIMES, &KEYS.replace("right", "none"));
    refused(&missing, "--frames 2..6", 1, &["--volume", "none.npy", "check the path"]);
    let nobody = views(TIMES, &KEYS.replace('6', "5"));
    refused(&nobody, "--frames 2..6", 1, &["--views", "[[key]] time", "no view shows 5"]);
    let twice = views(TIMES, &KEYS.replace('6', "2"));
    refused(&twice, "--frames 2..6", 1, &["--views", "[[key]] time", "2 has two volumes"]);
    npy::write_f32(&at.join("small.npy"), &[2, 2, 2], &[1.0; 8]);
    let smaller = views(TIMES, &KEYS.replace("right", "small"));
    refused(&smaller, "--frames 2..6", 1, &["--views", "small.npy", "[2, 2, 2]", "[24, 24, 24]", "resample"]);
    // What is read stays.
    std::fs::create_dir(at.join("job")).unwrap();
    std::fs::copy(at.join("right.npy"), at.join("job/emission.0004.npy")).unwrap();
    std::fs::write(at.join("v.toml"), views(TIMES, &KEYS.replace("right", "job/emission.0004"))).unwrap();
    refuses(
        at,
        &words(&format!("inverse {SOLVE} --frames 2..6 --out job")),
        1,
        &["--out", "emission.0004.npy"],
    );
}
