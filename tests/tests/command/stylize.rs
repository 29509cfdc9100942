// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight stylize`: each flag does what it says, to scattered light and to nothing else. Sequences and transfer functions
//! are in `stylize_frames.rs`, what is refused in `stylize_refusals.rs`.

use crate::command::draws_finite;
use crate::stylized::{POINT, Run, SPOT, SUN, halls, mean};

#[test]
fn an_empty_style_is_scattering_bit_for_bit() {
    let at = halls();
    for setup in [
        SUN,
        &format!("{SUN} --method fourier --resolution half"),
        &format!("{SUN} --method moments --samples 4 --start near-plane"),
        &format!("{SUN} --method march --jitter gradient --frame 3"),
        &format!("{SUN} --cascades 2 --stereo 0.3"),
        &format!("{SUN} --light-texture glass.png --depth-range reversed"),
        &format!("{SPOT} --resolution quarter"),
        POINT,
    ] {
        let scattering = Run::new(at.path(), "scattering", setup);
        let stylize = Run::new(at.path(), "stylize", setup);
        assert!(scattering.picture == stylize.picture, "{setup}: other pictures");
        assert!(scattering.buffers == stylize.buffers, "{setup}: other buffers");
        // Kernels of one texel do nothing, and say so by the same bits.
        let one = "--close-box 1 --close-disc 1 --close-epipolar 1 --extrude 1 --holes density=0";
        if !setup.contains("--cascades") {
            let idle = Run::new(at.path(), "stylize", &format!("{setup} {one}"));
            assert!(scattering.picture == idle.picture, "{setup} {one}: other pictures");
            assert!(idle.has("stylized_shadow_map"), "{setup}: {:?}", idle.buffers.keys());
        }
    }
}

#[test]
fn operators_take_light_and_leave_surfaces_and_their_shadows() {
    let at = halls();
    for setup in [SUN, SPOT, POINT] {
        let plain = Run::new(at.path(), "stylize", setup);
        for flag in ["--close-box", "--close-disc", "--close-epipolar", "--extrude"] {
            let mut before = mean(&plain.visibility("scattered"));
            for width in [5, 61] {
                let flags = format!("{setup} {flag} {width}");
                let run = Run::new(at.path(), "stylize", &flags);
                let maps = if setup == POINT { "shadow_maps" } else { "shadow_map" };
                let [drawn, changed] = [&plain.buffers[maps].1, &run.buffers[&format!("stylized_{maps}")].1];
                assert!(
                    drawn.iter().zip(changed).all(|(drawn, changed)| changed <= drawn),
                    "{flags}: added light"
                );
                // What was drawn is as it was, and so are the surfaces that were lit by it.
                for kept in [maps, "surface", "depth"] {
                    assert!(run.buffers[kept] == plain.buffers[kept], "{flags}: {kept} changed");
                }
                let lit = mean(&run.visibility("scattered"));
                println!("{flags}: mean visibility {lit:.4} after {before:.4}");
                assert!(lit <= before + 1e-4, "{flags}: lighter with a wider kernel");
                before = lit;
            }
            let whole = mean(&plain.visibility("scattered"));
            assert!(before < 0.99 * whole, "{flag} does nothing: {before} of {whole}");
        }
    }
}

#[test]
fn both_forms_of_lines_agree_and_differ() {
    let at = halls();
    let run = |form: &str| Run::new(at.path(), "stylize", &format!("{SUN} --extrude 15{form}")).buffers;
    let [default, direct, rectified] = ["", " --epipolar direct", " --epipolar rectified"].map(run);
    let map = "stylized_shadow_map";
    assert!(default[map] == direct[map] && direct[map] != rectified[map]);
    let pairs = direct[map].1.iter().zip(&rectified[map].1);
    let same = pairs.filter(|(a, b)| (**a - **b).abs() < 0.02).count() as f64;
    let share = same / direct[map].1.len() as f64;
    println!("{share} of the texels of both forms agree");
    assert!(share > 0.97, "{share}");
}

#[test]
fn an_eye_at_infinity_has_parallel_lines() {
    let at = halls();
    let setup = "--camera orthographic --eye 0.5,2,6 --target 0,1.1,0 --height 5 --near 1 --far 14 \
                 --light directional:95,35";
    let lit = |flags: &str| {
        mean(&Run::new(at.path(), "stylize", &format!("{setup}{flags}")).visibility("scattered"))
    };
    let [plain, direct, rectified] = ["", " --extrude 25", " --extrude 25 --epipolar rectified"].map(lit);
    assert!(direct < 0.99 * plain && rectified < 0.99 * plain, "{plain} {direct} {rectified}");
    // Where the camera looks along the light what is extruded is hidden behind the blocker.
    let ahead = "--camera orthographic --eye 0,6,0.001 --target 0,0,0 --light directional:0,90 --height 9";
    let lit = |flags: &str| {
        mean(&Run::new(at.path(), "stylize", &format!("{ahead}{flags}")).visibility("scattered"))
    };
    let [plain, extruded] = ["", " --extrude 25"].map(lit);
    assert!((extruded / plain - 1.0).abs() < 0.01, "{plain} {extruded}");
}

#[test]
fn holes_let_light_in() {
    let at = halls();
    for setup in [SUN, SPOT, POINT] {
        let mut before = mean(&Run::new(at.path(), "stylize", setup).visibility("scattered"));
        for density in [0.2, 0.6, 1.0] {
            let flags = format!("{setup} --holes size=0.3,density={density},octaves=2");
            let run = Run::new(at.path(), "stylize", &flags);
            let maps = if setup == POINT { "shadow_maps" } else { "shadow_map" };
            let mask = &run.buffers["hole_mask"];
            let [drawn, changed] = [&run.buffers[maps], &run.buffers[&format!("stylized_{maps}")]];
            assert_eq!((&mask.0, &changed.0), (&drawn.0, &drawn.0), "{flags}");
            for (i, hole) in mask.1.iter().enumerate() {
                let expected = if *hole == 1.0 { 1.0 } else { drawn.1[i] };
                assert!(changed.1[i] == expected, "{flags}: texel {i}");
            }
            let (share, lit) = (mean(&mask.1), mean(&run.visibility("scattered")));
            println!("{flags}: {share:.3} hole, mean visibility {lit:.4} after {before:.4}");
            assert!((share - density).abs() < 0.1, "{flags}: {share} of the map is hole");
            assert!(lit > before, "{flags}: not lighter");
            before = lit;
        }
        // Without a shadow the whole air is lit, of a spot all of its cone.
        assert!(setup == SPOT || (before - 1.0).abs() < 1e-3, "{setup}: all is hole, and {before} is lit");
    }
}

#[test]
fn faces_around_a_light_have_holes_of_their_own() {
    let at = halls();
    let run = Run::new(at.path(), "stylize", &format!("{POINT} --holes size=0.4,density=0.5"));
    let (shape, mask) = &run.buffers["hole_mask"];
    assert_eq!(shape[0], 6);
    let faces: Vec<&[f32]> = mask.chunks_exact(shape[1] * shape[2]).collect();
    for (a, first) in faces.iter().enumerate() {
        for second in &faces[a + 1..] {
            let same = first.iter().zip(*second).filter(|(a, b)| a == b).count() as f64;
            let share = same / first.len() as f64;
            assert!((0.3..0.7).contains(&share), "two faces share {share} of their texels");
        }
    }
}

#[test]
fn one_object_has_the_holes_and_the_rest_has_none() {
    let at = halls();
    for setup in [SUN, POINT] {
        let maps = if setup == POINT { "shadow_maps" } else { "shadow_map" };
        let run = |flags: &str| Run::new(at.path(), "stylize", &format!("{setup} --holes {flags}")).buffers;
        let all = "--holes-on plate.obj --holes-on room.obj";
        let none = run("density=0 --holes-on plate.obj");
        let (drawn, stylized) = (&none[maps].1, format!("stylized_{maps}"));
        assert!(none[&stylized].1 == *drawn, "{setup}: parts are not the whole");
        let plate = run("density=1 --holes-on plate.obj");
        let room = run("density=1 --holes-on room.obj");
        let both = run(&format!("density=1 {all}"));
        assert!(both[&stylized].1.iter().all(|depth| *depth == 1.0), "{setup}: something is left");
        // What is left without the plate is the room, and the other way round; the nearer of both was drawn.
        let mut pairs = plate[&stylized].1.iter().zip(&room[&stylized].1).zip(drawn);
        assert!(pairs.all(|((room, plate), drawn)| room.min(*plate) == *drawn), "{setup}");
        let blocked = |part: &[f32]| part.iter().filter(|depth| **depth < 1.0).count();
        let [room, plate] = [&plate, &room].map(|left| blocked(&left[&stylized].1));
        assert!(room > 500 && plate > 500, "{setup}: {room} texels of the room, {plate} of the plate");
        assert!(both["surface"] == none["surface"], "{setup}: surfaces changed");
        let part = run("size=0.3,density=0.4 --holes-on plate.obj");
        let whole = run("size=0.3,density=0.4");
        assert!(part[&stylized] != whole[&stylized], "{setup}: --holes-on does nothing");
    }
}

#[test]
fn holes_come_before_closings() {
    let at = halls();
    let open = |flags: &str| {
        let run = Run::new(at.path(), "stylize", &format!("{SUN}{flags}"));
        run.buffers["stylized_shadow_map"].1.iter().filter(|depth| **depth == 1.0).count()
    };
    let holes = " --holes size=0.2,density=0.15,octaves=1";
    let [punched, closed] = [open(holes), open(&format!("{holes} --close-box 41"))];
    let plain = open(" --close-box 41");
    println!("empty texels: {punched} with holes, {closed} closed, {plain} without holes");
    assert!(punched > plain + 500, "{punched} empty texels with holes, {plain} without");
    assert!(closed < plain + (punched - plain) / 5, "{closed} empty texels are left of {punched}");
}

#[test]
fn eyes_have_epipoles_of_their_own() {
    let at = halls();
    let run = |flags: &str| Run::new(at.path(), "stylize", &format!("{SUN} --stereo 0.8 {flags}")).buffers;
    let maps = ["left_stylized_shadow_map", "right_stylized_shadow_map"];
    let extruded = run("--extrude 15");
    assert!(extruded[maps[0]] != extruded[maps[1]], "both eyes extrude alike");
    let closed = run("--close-disc 15");
    assert!(closed[maps[0]] == closed[maps[1]], "the eyes close differently");
    let punched = run("--holes size=0.3,density=0.3");
    assert!(punched[maps[0]] == punched[maps[1]], "the eyes see other holes");
}

#[test]
fn every_way_to_scatter_reads_the_changed_maps() {
    let at = halls();
    for setup in [
        format!("{SUN} --method fourier"),
        format!("{SUN} --method moments"),
        format!("{SUN} --method rank"),
        format!("{SUN} --method wavelet --average"),
        format!("{SUN} --method march"),
        format!("{SUN} --rectification projective"),
        format!("{SUN} --cascades 3"),
        format!("{SUN} --light-texture glass.png"),
        format!("{SUN} --resolution quarter"),
        format!("{SUN} --samples 4 --depth-range reversed"),
        format!("{SPOT} --light-texture glass.png"),
        format!("{POINT} --method moments"),
    ] {
        let lit = |flags: &str| {
            mean(&Run::new(at.path(), "stylize", &format!("{setup}{flags}")).visibility("scattered"))
        };
        let [plain, extruded] = [lit(""), lit(" --extrude 41")];
        println!("{setup}: {plain:.4}, extruded {extruded:.4}");
        assert!(extruded < 0.99 * plain, "{setup}: {extruded} is not darker than {plain}");
    }
}

#[test]
fn awkward_sizes_draw() {
    let at = halls();
    let style = "--close-box 9 --close-disc 9 --close-epipolar 9 --extrude 9 --holes density=0.3 --holes-on plate.obj";
    for flags in [
        "--size 1x1 --map 1x1 --shadow-map 1x1",
        "--size 5x3 --map 33x2 --shadow-map 2x3 --resolution quarter --epipolar rectified",
        "--size 3x2 --map 9x2 --shadow-map 1x2 --light point:0,3,0",
        "--size 3x2 --map 9x2 --shadow-map 3x1 --light spot:0,4,0,0,0,0.1,30 --stereo 0.1",
    ] {
        let line = format!("stylize --mesh room.obj --mesh plate.obj --out x.exr {style} {flags}");
        draws_finite(at.path(), &line);
    }
}
