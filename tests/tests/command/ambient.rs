// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight ambient`: every method and sampler against closed forms and against rays, flags by what they change, and what cannot be
//! meant.

use crate::command::{folder, refuses_first, succeeds, words};
use airlight::formats::write_exr;
use std::path::Path;
use tempfile::TempDir;

const SIZE: [u32; 2] = [48, 32];
const SAMPLERS: [&str; 4] = ["disc", "hemisphere", "horizon", "bitmask"];
const METHODS: [&str; 5] = ["ao", "normals", "cones", "exact-cones", "reference"];
/// From straight above, where the floor fills the picture.
const ABOVE: &str = "--camera orthographic --eye 0,5,0.01 --target 0,0,0 --height 1.6";
/// The albedo of meshes without colours.
const ALBEDO: f32 = 0.7;

/// A folder with a floor of 10 x 10 m, a trench in one, and constant white light.
fn workplace() -> TempDir {
    let at = folder();
    let floor = "v -5 0 -5\nv -5 0 5\nv 5 0 5\nv 5 0 -5\nf 1 2 3 4\n";
    std::fs::write(at.path().join("floor.obj"), floor).unwrap();
    // Along x a floor of 0.4 m between walls that rise to 0.6 m, over all of z, and roofs beyond.
    let mut trench = String::new();
    for [x, y] in [[-5.0, 0.6], [-0.2, 0.6], [-0.2, 0.0], [0.2, 0.0], [0.2, 0.6], [5.0, 0.6]] {
        trench += &format!("v {x} {y} -5\nv {x} {y} 5\n");
    }
    for normal in ["0 1 0", "1 0 0", "0 1 0", "-1 0 0", "0 1 0"] {
        trench += &format!("vn {normal}\n");
    }
    for face in 1..=5 {
        let corners = [-1, 0, 2, 1].map(|corner| format!("{}//{face}", 2 * face + corner));
        trench += &format!("f {}\n", corners.join(" "));
    }
    std::fs::write(at.path().join("trench.obj"), trench).unwrap();
    write_exr(at.path().join("white.exr"), 32, 16, &[1.0; 3 * 512]).unwrap();
    at
}

/// The first three channels of what the command writes, rows from the top.
#[track_caller]
fn picture(at: &Path, flags: &str) -> Vec<[f32; 3]> {
    let folder = tempfile::tempdir_in(at).unwrap();
    let out = folder.path().join("picture.exr");
    let size = format!("{}x{}", SIZE[0], SIZE[1]);
    let mut arguments = vec!["ambient", "--size", &size, "--out", out.to_str().unwrap()];
    arguments.extend(words(flags));
    succeeds(at, &arguments);
    let picture = image::open(&out).unwrap().into_rgb32f();
    assert_eq!([picture.width(), picture.height()], SIZE);
    let pixels: Vec<[f32; 3]> = picture.pixels().map(|pixel| pixel.0).collect();
    assert!(pixels.iter().flatten().all(|value| value.is_finite()), "{flags}");
    pixels
}

/// Mean of a channel over a rectangle of columns, away from the picture's upper and lower edge.
fn mean(picture: &[[f32; 3]], columns: std::ops::Range<usize>, channel: usize) -> f32 {
    let rows = SIZE[1] as usize / 4..3 * SIZE[1] as usize / 4;
    let places = rows.flat_map(|y| columns.clone().map(move |x| y * SIZE[0] as usize + x));
    let values: Vec<f32> = places.map(|place| picture[place][channel]).collect();
    values.iter().sum::<f32>() / values.len() as f32
}

/// The bottom of the trench, 0.4 m of 2.4 m in 48 columns, without its edges, and a roof.
const BOTTOM: std::ops::Range<usize> = 22..26;
const ROOF: std::ops::Range<usize> = 2..8;

#[test]
fn a_lone_plane_is_open() {
    let at = workplace();
    for sampler in SAMPLERS {
        for more in ["", "--half", "--no-blur", "--plain-blur"] {
            let flags = format!("--mesh floor.obj {ABOVE} --show openness --sampler {sampler} {more}");
            let least = picture(at.path(), &flags).iter().fold(1.0, |least: f32, pixel| least.min(pixel[0]));
            println!("{sampler} {more}: {least}");
            assert!(least > 0.999, "{flags}: {least}");
        }
    }
    let plane = |flags: &str| picture(at.path(), &format!("--mesh floor.obj {ABOVE} {flags}"));
    for method in ["--method reference", "--sampler bitmask --samples 16 --steps 8"] {
        for [x, y, z] in plane(&format!("--show bent-normals {method}")) {
            assert!(y > 0.999 && x.abs() < 0.03 && z.abs() < 0.03, "{method}: {x} {y} {z}");
        }
    }
    for [degrees, ..] in plane("--show angles --method reference") {
        assert!((89.0..=90.0).contains(&degrees), "{degrees}");
    }
}

#[test]
fn constant_light_on_a_plane_is_its_albedo() {
    let at = workplace();
    for method in METHODS {
        let flags =
            format!("--mesh floor.obj {ABOVE} --environment white.exr --method {method} --samples 64");
        let picture = picture(at.path(), &flags);
        let worst = picture.iter().flatten().map(|value| (value - ALBEDO).abs()).fold(0.0, f32::max);
        println!("{method}: worst {worst}");
        assert!(worst < 0.01, "{method}: {worst}");
    }
}

/// The floor of a trench sees the sky between the rims: (1/π) ∫ is sin of the half angle in its middle.
#[test]
fn a_trench_is_darker_at_its_bottom() {
    let at = workplace();
    let trench = |flags: &str| picture(at.path(), &format!("--mesh trench.obj {ABOVE} {flags}"));
    let lit = |flags: &str| trench(&format!("--environment white.exr {flags}"));
    let traced = lit("--method reference --samples 1024");
    let sine = 0.2 / 0.2_f32.hypot(0.6);
    let [bottom, roof] = [BOTTOM, ROOF].map(|columns| mean(&traced, columns, 0));
    println!("reference: bottom {bottom}, roof {roof}; {} expected", ALBEDO * sine);
    assert!((bottom - ALBEDO * sine).abs() < 0.02 && (roof - ALBEDO).abs() < 1e-3);
    let cones = lit("--radius 3 --samples 16 --steps 12");
    let printed = lit("--radius 3 --samples 16 --steps 12 --printed");
    let [found, open] = [BOTTOM, ROOF].map(|columns| mean(&cones, columns, 0));
    let dark = mean(&printed, BOTTOM, 0);
    println!("cones: bottom {found}, roof {open}; printed {dark}");
    assert!(found < 0.7 * open && (open - ALBEDO).abs() < 0.02);
    assert!(dark < 0.9 * found, "Eq. 3.10 is too dark by the length of the mean: {dark} {found}");
    for sampler in SAMPLERS {
        let open = |radius: f32| {
            trench(&format!("--show openness --samples 16 --steps 12 --sampler {sampler} --radius {radius}"))
        };
        let [narrow, wide] = [0.05, 3.0].map(|radius| mean(&open(radius), BOTTOM, 0));
        println!("{sampler}: openness {narrow} within 0.05 m, {wide} within 3 m");
        // Most points of a disc's pattern lie near its rim, where occluders count little.
        let most = if sampler == "disc" { 0.98 } else { 0.5 };
        assert!(narrow > 0.999 && wide < most, "{sampler}: {wide} {narrow}");
    }
    // Cones are narrower where less is open, and the exact ones wider than those of Eq. 3.6.
    let angle = |flags: &str, columns| {
        mean(&trench(&format!("--show angles --radius 3 --samples 16 --steps 12 {flags}")), columns, 0)
    };
    let [thesis, exact] = ["--method cones", "--method exact-cones"].map(|flags| angle(flags, BOTTOM));
    println!("angles: {thesis} by Eq. 3.6, {exact} exactly, {} on the roof", angle("", ROOF));
    assert!(thesis + 3.0 < exact && exact + 5.0 < angle("", ROOF));
}

#[test]
fn the_environment_is_behind_and_can_be_reduced() {
    let at = workplace();
    // Red on the left of -z and blue on the right, by texels of 1/64 of the width.
    let texel = |x: usize| if x.is_multiple_of(2) { [2.0, 0.0, 0.0] } else { [0.0, 0.0, 4.0] };
    let stripes: Vec<f32> = (0..64 * 32).flat_map(|i| texel(i % 64)).collect();
    write_exr(at.path().join("stripes.exr"), 64, 32, &stripes).unwrap();
    let away = "--mesh floor.obj --method reference --samples 1 --eye 0,30,0 --target 0,30,-9 --fov 40";
    let behind = |flags: &str| picture(at.path(), &format!("{away} --environment stripes.exr {flags}"));
    let sharp = behind("");
    assert!(sharp.iter().any(|pixel| pixel[0] > 1.7) && sharp.iter().any(|pixel| pixel[0] < 0.3));
    assert!(sharp.iter().all(|[red, _, blue]| (red / 2.0 + blue / 4.0 - 1.0).abs() < 1e-3));
    assert!(behind("--low-pass").iter().all(|[r, g, b]| (r - 1.0).abs() + g.abs() + (b - 2.0).abs() < 1e-3));
}

#[test]
fn pictures_to_look_at_are_written_and_empty_ones_are_warned_of() {
    let at = folder();
    let show = |flags: &str| {
        let mut arguments = vec!["ambient", "--size", "40x30", "--out", "a.png"];
        arguments.extend(words(flags));
        let ended = succeeds(at.path(), &arguments);
        (image::open(at.path().join("a.png")).unwrap().into_rgb8(), ended)
    };
    for (flags, middle) in [
        ("--mesh suzanne --environment sunset --method reference --samples 16", 20..=255),
        ("--mesh suzanne --show openness", 60..=255),
        ("--mesh suzanne --show bent-normals", 60..=255),
        ("--mesh suzanne --show angles --method exact-cones", 60..=255),
    ] {
        let (picture, ended) = show(flags);
        let brightest = picture.get_pixel(20, 15).0.into_iter().max().unwrap();
        assert!(middle.contains(&brightest), "{flags}: {brightest}");
        assert!(!ended.err.contains("warning") && ended.out.contains("surfaces: in "), "{flags}");
    }
    let (picture, ended) = show("--mesh teapot --show openness --eye 0,99,0 --target 0,200,1");
    assert!(picture.pixels().all(|pixel| pixel.0 == [0; 3]));
    assert!(ended.err.contains("warning: --eye, --target: no surface"), "{}", ended.err);
}

/// Refused, and before any GPU work: where there is no adapter it is said as well.
#[track_caller]
fn refused(at: &Path, flags: &str, code: i32, parts: &[&str]) {
    let mut arguments = vec!["ambient", "--size", "32x24"];
    if !flags.contains("--out") {
        arguments.extend(["--out", "x.png"]);
    }
    arguments.extend(words(flags));
    refuses_first(at, &arguments, code, parts);
}

#[test]
fn numbers_and_names_that_cannot_be_meant_are_refused() {
    let at = folder();
    let bad = |flags: &str, parts: &[&str]| refused(at.path(), flags, 2, parts);
    bad("--mesh bunnny", &["--mesh", "`bunnny`", "bunny, suzanne", ".gltf"]);
    bad("--mesh bunny@1,2", &["--mesh", "1,2"]);
    bad("--environment wood", &["--environment", "`wood`", "forest, sunset", ".exr"]);
    bad("--method gtao", &["--method", "exact-cones"]);
    bad("--sampler cube", &["--sampler", "bitmask"]);
    bad("--show normals", &["--show", "bent-normals"]);
    for (flags, parts) in [
        ("--samples 0", ["--samples", "from 1 to 256"]),
        ("--samples 257", ["--samples", "from 1 to 256"]),
        ("--samples -1", ["--samples", "-1"]),
        ("--steps 0", ["--steps", "from 1 to 256"]),
        ("--steps 300", ["--steps", "from 1 to 256"]),
        ("--interleave 0", ["--interleave", "from 1 to 16"]),
        ("--interleave 17", ["--interleave", "from 1 to 16"]),
        ("--radius 0", ["--radius", "above 0"]),
        ("--radius -2", ["--radius", "above 0"]),
        ("--radius nan", ["--radius", "finite"]),
        ("--thickness 0", ["--thickness", "above 0"]),
        ("--thickness 2e15", ["--thickness", "1e15"]),
        ("--frame -1", ["--frame", "-1"]),
        ("--method reference --samples 0", ["--samples", "1 to 65536"]),
        ("--method reference --samples 65537", ["--samples", "1 to 65536"]),
        ("--method reference --radius 0", ["--radius", "above 0"]),
        ("--exposure 0", ["--exposure", "positive"]),
        ("--out x.jpg", ["--out", ".png or .exr"]),
        ("--fov 200", ["--fov", "200"]),
    ] {
        bad(flags, &parts);
    }
}

#[test]
fn flags_that_do_not_go_together_are_refused() {
    let at = folder();
    for flag in [
        "--sampler disc",
        "--steps 3",
        "--thickness 2",
        "--frame 3",
        "--interleave 4",
        "--half",
        "--no-blur",
        "--plain-blur",
        "--printed",
    ] {
        let name = flag.split(' ').next().unwrap();
        refused(at.path(), &format!("--method reference {flag}"), 2, &[name, "traces rays"]);
    }
    for flag in ["--environment forest", "--low-pass", "--printed", "--exposure 2"] {
        let name = flag.split(' ').next().unwrap();
        refused(at.path(), &format!("--show openness {flag}"), 2, &[name, "--show shaded"]);
    }
    for (flags, parts) in [
        ("--no-blur --plain-blur", ["--no-blur", "--plain-blur"]),
        ("--method ao --printed", ["--printed", "ao"]),
        ("--sampler disc --thickness 1", ["--thickness", "bitmask"]),
        ("--sampler horizon --thickness 1", ["--thickness", "bitmask"]),
        ("--show angles --method normals", ["--show", "exact-cones"]),
        ("--height 2", ["--height", "orthographic"]),
        ("--camera orthographic --fov 30", ["--fov", "--height"]),
    ] {
        refused(at.path(), flags, 2, &parts);
    }
}

#[test]
fn files_that_cannot_be_used_are_refused() {
    let at = folder();
    let write = |name: &str, width: u32, height: u32, texels: &[f32]| {
        write_exr(at.path().join(name), width, height, texels).unwrap();
    };
    write("square.exr", 4, 4, &[1.0; 48]);
    let mut wild = [1.0; 24];
    wild[3 * 6 + 1] = f32::NAN;
    write("wild.exr", 4, 2, &wild);
    std::fs::write(at.path().join("empty.obj"), "v 0 0 0\n").unwrap();
    std::fs::write(at.path().join("text.exr"), "no picture").unwrap();
    let bad = |flags: &str, parts: &[&str]| refused(at.path(), flags, 1, parts);
    bad("--mesh none.obj", &["--mesh", "none.obj"]);
    bad("--mesh bunny --mesh empty.obj", &["--mesh", "empty.obj", "no triangles"]);
    bad("--environment none.exr", &["--environment", "none.exr", "no such file"]);
    bad("--environment text.exr", &["--environment", "text.exr"]);
    bad("--environment square.exr", &["--environment", "4x4", "2:1"]);
    bad("--environment square.exr --low-pass --method reference", &["--environment", "4x4", "2:1"]);
    bad("--environment wild.exr", &["--environment", "wild.exr", "column 2 of row 1"]);
    bad("--out none/x.png", &["--out", "none"]);
}
