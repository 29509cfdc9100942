// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight scattering` with flags that cannot be meant, alone or together.

use crate::command::{airlight_with, refuses};
use crate::hall::{EYE, scene};

#[test]
fn flags_that_cannot_be_meant_are_refused() {
    let at = scene();
    std::fs::write(at.path().join("no.png"), "no picture").unwrap();
    let refused = |flags: &str, code: i32, parts: &[&str]| {
        let mut arguments = vec!["scattering", "--mesh", "hall.obj", "--out", "x.exr", "--size", "32x24"];
        arguments.extend(["--map", "64x64"].into_iter().chain(flags.split(' ')));
        refuses(at.path(), &arguments, code, parts);
        // Before any GPU work: where there is no adapter it is said as well.
        let nowhere = at.path().join("no-driver.json").display().to_string();
        let none = [("VK_DRIVER_FILES", nowhere.as_str()), ("VK_ICD_FILENAMES", nowhere.as_str())];
        let ended = airlight_with(at.path(), &arguments, &none);
        assert!(ended.code == code && !ended.err.contains("no GPU adapter"), "{flags}: {}", ended.err);
    };
    let bad = |flags: &str, parts: &[&str]| refused(flags, 2, parts);
    // Values.
    bad("--light spot:0,1,0,0,0,0,90", &["--light", "80"]);
    bad("--light area:1", &["--light", "`area:1`", "area:135,40,5"]);
    for area in ["area:10,20,3", "area:0,5,0,1"] {
        bad(&format!("--light {area}"), &["--light", "`area`", "airlight splatting"]);
    }
    bad("--light environment:a.exr", &["--light", "not there yet"]);
    for count in ["0", "7", "many", "-1"] {
        bad(&format!("--cascades={count}"), &["--cascades", count]);
    }
    bad("--camera fisheye", &["--camera", "fisheye", "orthographic"]);
    bad("--depth-range backward", &["--depth-range", "backward", "infinite"]);
    bad("--samples 2", &["--samples", "`2`", "1 and 4"]);
    for metres in ["0", "-1", "nan", "wide"] {
        bad(&format!("--stereo={metres}"), &["--stereo", metres]);
    }
    for metres in ["0", "-3"] {
        bad(&format!("--camera orthographic --height={metres}"), &["--height", metres]);
    }
    bad("--camera orthographic --near 3 --far 2", &["--near, --far", "3", "2"]);
    bad("--depth-range infinite --near 3 --far 2", &["--near, --far", "3", "2"]);
    bad("--rectification polar", &["--rectification", "polar", "epipolar"]);
    bad("--splits 5", &["--splits", "5"]);
    bad("--regions 0", &["--regions", "0"]);
    bad("--regions 9", &["--regions", "9"]);
    bad("--resolution third", &["--resolution", "third", "quarter"]);
    bad("--method march --jitter white", &["--jitter", "white", "blue-noise"]);
    bad("--method march --jitter gradient --frame -1", &["--frame", "-1"]);
    bad("--start nowhere", &["--start", "nowhere", "near-plane"]);
    bad("--reference worst", &["--reference", "worst", "optimum"]);
    bad("--radiance 20000,1,1", &["--radiance", "1e4"]);
    bad("--light point:0,3,0 --radiance 1e9,1,1", &["--radiance", "1e8"]);
    refused("--light-texture none.png", 1, &["--light-texture", "none.png"]);
    refused("--light-texture no.png", 1, &["--light-texture", "no.png"]);
    // Together.
    let orthographic = "--camera orthographic";
    let (spot, point) = ("--light spot:0,4,0,0,0,0.1,30", "--light point:0,3,0");
    bad(&format!("{orthographic} --fov 30"), &["--fov", "--height"]);
    bad("--height 3", &["--height", "--fov"]);
    bad(&format!("{orthographic} --depth-range infinite"), &["--depth-range", "reversed"]);
    bad(&format!("{orthographic} --stereo 0.1"), &["--stereo", "perspective"]);
    bad(&format!("{orthographic} --start eye"), &["--start", "near plane"]);
    bad(&format!("{point} --light-texture glass.png"), &["--light-texture", "spot"]);
    bad(&format!("{spot} --cascades 2"), &["--cascades", "leave them out"]);
    bad(&format!("{point} --cascades 2"), &["--cascades", "leave them out"]);
    for flag in ["--rectification projective", "--splits 2", "--regions 2", "--reference optimum"] {
        bad(&format!("--method march {flag}"), &[flag.split(' ').next().unwrap(), "--method fourier"]);
    }
    for method in ["rank", "moments", "wavelet --average"] {
        for flag in ["--bases 16", "--half", "--regions 2"] {
            let parts = [flag.split(' ').next().unwrap(), "--method fourier"];
            bad(&format!("--method {method} {flag}"), &parts);
        }
    }
    for flag in ["--splits 2", "--rectification projective"] {
        let parts = [flag.split(' ').next().unwrap(), "--method rank"];
        bad(&format!("--method wavelet --average {flag}"), &parts);
    }
    for other in [spot, point, orthographic, "--light-texture glass.png"] {
        bad(&format!("--method wavelet --average {other}"), &["--method", "`wavelet`", "take auto"]);
    }
    for bits in ["7", "13", "ten"] {
        bad(&format!("--bits {bits}"), &["--bits", bits]);
    }
    for other in ["--method fourier", "--method march", "--half"] {
        bad(&format!("--bits 10 {other}"), &["--bits", "--method rank"]);
    }
    bad("--method wavelet", &["--method", "`wavelet`", "--average", "--method rank"]);
    bad("--method wavelet --average --bits 9", &["--bits", "8, 10 or 12"]);
    for method in ["rank", "wavelet"] {
        let mut wide = vec!["scattering", "--mesh", "hall.obj", "--out", "x.exr", "--average"];
        wide.extend(["--method", method, "--map", "2049x64"]);
        refuses(at.path(), &wide, 2, &["--map", "2048", "--method auto"]);
    }
    bad("--method march --start near-plane", &["--start", "--method fourier"]);
    bad("--jitter gradient", &["--jitter", "--method march"]);
    bad(&format!("--method march {spot} --jitter gradient"), &["--jitter", "leave it out"]);
    bad("--method march --cascades 2 --jitter blue-noise", &["--jitter", "leave it out"]);
    bad("--method march --frame 3", &["--frame", "--jitter"]);
    for light in [spot, point] {
        bad(&format!("{light} --rectification projective"), &["--rectification", "take auto"]);
        bad(&format!("{light} --regions 2"), &["--regions", "leave it out"]);
        bad(&format!("{light} --start near-plane"), &["--start", "leave it out"]);
        bad(&format!("{light} --splits 2"), &["--splits", "leave it out"]);
        bad(&format!("{light} --reference optimum"), &["--reference", "leave it out"]);
    }
    bad("--light-texture glass.png --rectification projective", &["--rectification", "take auto"]);
    bad("--light-texture glass.png --regions 2", &["--regions", "leave it out"]);
    bad("--light-texture glass.png --start near-plane", &["--start", "leave it out"]);
    bad("--cascades 2 --rectification projective", &["--rectification", "take auto"]);
    bad("--rectification epipolar --splits 2", &["--splits", "leave it out"]);
    bad("--rectification projective --reference optimum", &["--reference", "leave it out"]);
    bad(&format!("{orthographic} --rectification epipolar"), &["--rectification", "take auto"]);
    bad(&format!("{orthographic} --splits 2"), &["--splits", "leave it out"]);
    bad(&format!("{orthographic} --reference optimum"), &["--reference", "leave it out"]);
    // What only camera and light together say.
    let ahead = format!("{EYE} --light directional:185,12 --rectification projective");
    bad(&ahead, &["--rectification", "`projective`", "in the picture", "auto"]);
    let behind = format!("{EYE} --light directional:5,-2 --rectification projective");
    bad(&behind, &["--rectification", "`projective`", "opposite to the light", "auto"]);
    let along = format!("{orthographic} --eye 0,1,5 --target 0,1,0 --light directional:0,0");
    bad(&format!("{along} --rectification projective"), &["--rectification", "parallel", "auto"]);
    let lamp = "--eye 0,2,5 --light point:0,2,5 --rectification epipolar";
    bad(lamp, &["--rectification", "`epipolar`", "march"]);
}
