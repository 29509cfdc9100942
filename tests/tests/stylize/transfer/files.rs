// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files of transfer functions: what they mean, and what is said of bad ones, with line, column and key.

use airlight::stylize::{
    Blend, Keyed, Mode, Phase, Place, RayProperty, Source, Transfer, TransferError, parse_transfer,
    read_transfer,
};
use glam::{Vec2, Vec3, Vec4};
use std::path::Path;

fn parsed(text: &str) -> Result<Keyed<Transfer>, TransferError> {
    parse_transfer("style.toml", text)
}

fn one(text: &str) -> Transfer {
    let keyed = parsed(text).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(keyed.keys().len(), 1);
    keyed.keys()[0].1.clone()
}

#[test]
fn every_key_is_read() {
    let style = one(r##"
        size = 0x40
        x = "light-angle"
        y = "visible-depth"
        mode = "scattering"
        phase = "henyey-greenstein"
        depth_limit = 25
        strength = 0.5
        brightness = 2.5
        g = -0.25
        [[layer]]
        kind = "solid"
        color = "#ff8000"
        alpha = 0.25
        blend = "multiply"
        opacity = 0.75
        [[layer]]
        kind = "gradient"
        from = { at = [0, 1], color = [0.25, 0.5, 1] }
        to = { at = [0.5, 0.5], color = "#000000", alpha = 0 }
        blend = "add"
        [[layer]]
        kind = "diffusion"
        constraint = [{ at = [0.1, 0.2], color = "#ffffff" }]
        [[layer]]
        kind = "diffusion"
        [[layer.constraint]]
        pixel = [3, 400]
        color = [0, 0, 0]
        [[layer.constraint]]
        point = [1.5, -2, 0.25]
        follow = "boat"
        color = [0, 0, 1.0]
        alpha = 0.5
    "##);
    let settings = style.settings;
    assert_eq!((style.size, settings.mode, settings.phase), (64, Mode::Scattering, Phase::HenyeyGreenstein));
    assert_eq!((settings.across, settings.down), (RayProperty::LightAngle, RayProperty::VisibleDepth));
    assert_eq!((settings.depth_limit, settings.strength), (Some(25.0), 0.5));
    assert_eq!((settings.brightness, settings.g), (2.5, Some(-0.25)));
    let [solid, gradient, short, long] = &style.layers[..] else { panic!("{:?}", style.layers) };
    assert_eq!((solid.blend, solid.opacity), (Blend::Multiply, 0.75));
    let Source::Solid(color) = &solid.source else { panic!() };
    assert!(
        (color.rgb - Vec3::new(1.0, 0.215_860_5, 0.0)).length() < 1e-5 && color.alpha == 0.25,
        "{color:?}"
    );
    let Source::Gradient([from, to]) = &gradient.source else { panic!() };
    assert_eq!((from.0, from.1.rgb, from.1.alpha), (Vec2::Y, Vec3::new(0.25, 0.5, 1.0), 1.0));
    assert_eq!((to.0, to.1.alpha, gradient.blend), (Vec2::splat(0.5), 0.0, Blend::Add));
    let Source::Diffusion(constraints) = &short.source else { panic!() };
    assert_eq!(constraints[0].place, Place::At(Vec2::new(0.1, 0.2)));
    let Source::Diffusion(constraints) = &long.source else { panic!() };
    assert_eq!(constraints[0].place, Place::Pixel([3, 400]));
    let point = Place::Point { point: Vec3::new(1.5, -2.0, 0.25), follow: Some("boat".to_owned()) };
    assert_eq!((&constraints[1].place, constraints[1].color.alpha), (&point, 0.5));
}

#[test]
fn what_is_left_out_has_defaults() {
    let style = one("layer = [{ kind = \"solid\", color = [1, 1, 1] }]");
    assert_eq!((style.size, style.settings), (256, Default::default()));
    assert_eq!((style.layers[0].blend, style.layers[0].opacity), (Blend::Over, 1.0));
    assert_eq!((style.settings.across, style.settings.down), (RayProperty::Visibility, RayProperty::Depth));
}

/// The error of a text: its message without the file, `LINE:COLUMN: KEY: …`.
fn refusal(text: &str) -> String {
    let error = parsed(text).expect_err(text).to_string();
    error.strip_prefix("style.toml:").unwrap_or_else(|| panic!("{error}")).to_owned()
}

#[test]
fn bad_files_are_refused_where_they_are_wrong() {
    let layer = "[[layer]]\nkind = \"solid\"\n";
    let white = "[[layer]]\nkind = \"solid\"\ncolor = [1, 1, 1]\n";
    let diffusion = "[[layer]]\nkind = \"diffusion\"\n";
    let cases = [
        // Unknown keys.
        (format!("colour = 1\n{white}"), "1:1: colour: the key is unknown here; known are size, x, y, mode"),
        (format!("{white}alpa = 0.5"), "4:1: layer[0].alpa: the key is unknown here; known are kind, blend, opacity, color, alpha"),
        (format!("{white}{diffusion}radius = 1"), "6:1: layer[1].radius: the key is unknown here; known are kind, blend, opacity, constraint"),
        (
            format!("{diffusion}[[layer.constraint]]\nat = [0, 0]\ncolor = [0, 0, 0]\nweight = 2"),
            "6:1: layer[0].constraint[0].weight: the key is unknown here",
        ),
        (
            "[[layer]]\nkind = \"gradient\"\nfrom = { at = [0, 0], color = \"#000000\", to = 1 }".into(),
            "3:42: layer[0].from.to: the key is unknown here; known are at, color, alpha",
        ),
        // No layers, no constraints.
        (String::new(), "1:1: layer: a transfer function needs at least one layer"),
        ("strength = 1\nlayer = []".into(), "1:1: layer: a transfer function needs at least one layer"),
        (diffusion.into(), "1:1: layer[0].constraint: a diffusion layer needs at least one constraint"),
        ("layer = 3".into(), "1:9: layer: tables are needed, each headed [[layer]]"),
        // Missing keys.
        (layer.into(), "1:1: layer[0].color: the key is missing"),
        ("[[layer]]\ncolor = [1, 1, 1]".into(), "1:1: layer[0].kind: the key is missing"),
        ("[[layer]]\nkind = \"gradient\"\nfrom = { at = [0, 0], color = [0, 0, 0] }".into(), "1:1: layer[0].to: the key is missing"),
        // Colours.
        (format!("{layer}color = [1, 1.5, 0]"), "3:9: layer[0].color: 1.5 is out of range: linear red, green and blue must lie between 0 and 1"),
        (format!("{layer}color = [1, -0.1, 0]"), "3:9: layer[0].color: -0.1 is out of range"),
        (format!("{layer}color = [1, nan, 0]"), "3:9: layer[0].color: NaN is out of range"),
        (format!("{layer}color = [1, 1]"), "3:9: layer[0].color: a list of 3 numbers is needed"),
        (format!("{layer}color = \"#ff80\""), "3:9: layer[0].color: `#ff80` is no colour: write \"#rrggbb\" (sRGB) or [red, green, blue]"),
        (format!("{layer}color = \"#+f80é\""), "3:9: layer[0].color: `#+f80é` is no colour"),
        (format!("{layer}color = \"#+f+f+f\""), "3:9: layer[0].color: `#+f+f+f` is no colour"),
        (format!("{layer}color = \"#ffffff\"\nalpha = 2"), "4:9: layer[0].alpha: 2 is out of range: it must lie between 0 and 1"),
        (format!("{white}opacity = -1"), "4:11: layer[0].opacity: -1 is out of range"),
        // Places.
        (
            format!("{diffusion}[[layer.constraint]]\nat = [0.5, 1.25]\ncolor = \"#ffffff\""),
            "4:6: layer[0].constraint[0].at: [0.5, 1.25] lies outside the square of 0 to 1 in x and y",
        ),
        (
            format!("{diffusion}[[layer.constraint]]\nat = [0.5, inf]\ncolor = \"#ffffff\""),
            "4:6: layer[0].constraint[0].at: [0.5, inf] lies outside the square",
        ),
        (
            format!("{diffusion}[[layer.constraint]]\ncolor = \"#ffffff\""),
            "3:1: layer[0].constraint[0].at: a constraint needs one of `at`, `pixel` and `point`",
        ),
        (
            format!("{diffusion}[[layer.constraint]]\nat = [0, 0]\npixel = [1, 1]\ncolor = \"#ffffff\""),
            "3:1: layer[0].constraint[0].pixel: a constraint needs one of `at`, `pixel` and `point`, and no two",
        ),
        (
            format!("{diffusion}[[layer.constraint]]\npixel = [1.5, 1]\ncolor = \"#ffffff\""),
            "4:9: layer[0].constraint[0].pixel: [1.5, 1.0] is no pixel",
        ),
        (
            format!("{diffusion}[[layer.constraint]]\npixel = [-1, 1]\ncolor = \"#ffffff\""),
            "4:9: layer[0].constraint[0].pixel: [-1.0, 1.0] is no pixel",
        ),
        (
            format!("{diffusion}[[layer.constraint]]\npoint = [1, nan, 0]\ncolor = \"#ffffff\""),
            "4:9: layer[0].constraint[0].point: [1.0, NaN, 0.0] is no point",
        ),
        (
            format!("{diffusion}[[layer.constraint]]\nat = [0, 0]\nfollow = \"boat\"\ncolor = \"#ffffff\""),
            "3:1: layer[0].constraint[0].follow: only a constraint with `point` can follow an object",
        ),
        (
            "[[layer]]\nkind = \"gradient\"\nfrom = { at = [0, 2], color = [0, 0, 0] }\nto = 1".into(),
            "3:15: layer[0].from.at: [0.0, 2.0] lies outside the square",
        ),
        // Settings.
        (format!("size = 0\n{white}"), "1:8: size: 0 texels are impossible: the size must be a whole number from 1 to 1024"),
        (format!("size = 1025\n{white}"), "1:8: size: 1025 texels are impossible"),
        (format!("size = 2.5\n{white}"), "1:8: size: 2.5 is no whole number"),
        (format!("size = \"big\"\n{white}"), "1:8: size: a number is needed"),
        (format!("x = \"distance\"\n{white}"), "1:5: x: `distance` is unknown; known are visibility, depth, light-angle"),
        (format!("mode = 3\n{white}"), "1:8: mode: a text in quotes is needed"),
        (format!("phase = \"mie\"\n{white}"), "1:9: phase: `mie` is unknown; known are constant, henyey-greenstein"),
        (format!("depth_limit = 0\n{white}"), "1:15: depth_limit: 0 m is impossible: it must be positive and finite"),
        (format!("depth_limit = 1e39\n{white}"), "1:15: depth_limit: 1"),
        (format!("strength = 1.5\n{white}"), "1:12: strength: 1.5 is out of range"),
        (format!("brightness = -1\n{white}"), "1:14: brightness: -1 is out of range"),
        (format!("g = 1\n{white}"), "1:5: g: 1 is out of range: a mean cosine must lie between"),
        (format!("{white}blend = \"screen\""), "4:9: layer[0].blend: `screen` is unknown; known are over, multiply, add"),
        ("[[layer]]\nkind = \"noise\"".into(), "2:8: layer[0].kind: `noise` is unknown; known are solid, gradient, image, diffusion"),
        // Key frames.
        (format!("{white}[[key]]\nframe = 0"), "1:3: layer: the key is unknown here"),
        ("[[key]]\nframe = 0".into(), "1:1: key[0].layer: a transfer function needs at least one layer"),
        ("[[key]]\nfile = \"a.toml\"".into(), "1:1: key[0].frame: the key is missing"),
        ("[[key]]\nframe = inf\n[[key.layer]]\nkind = \"solid\"\ncolor = [1, 1, 1]".into(), "2:9: key[0].frame: frame inf is impossible"),
        (
            "[[key]]\nframe = 5\n[[key.layer]]\nkind = \"solid\"\ncolor = [1, 1, 1]\n[[key]]\nframe = 5\n[[key.layer]]\nkind = \"solid\"\ncolor = [1, 1, 1]".into(),
            "7:9: key[1].frame: frame 5 is impossible: frames must be finite and ascend",
        ),
        (
            "[[key]]\nframe = 5\n[[key.layer]]\nkind = \"solid\"\ncolor = [1, 1, 1]\n[[key]]\nframe = 6\nsize = 8\n[[key.layer]]\nkind = \"solid\"\ncolor = [1, 1, 1]".into(),
            "7:9: key[1].size: 8 texels a side, and 256 before",
        ),
        ("[[key]]\nframe = 0\nfile = \"a.toml\"\nstrength = 0".into(), "4:1: key[0].strength: the key is unknown here; known are frame, file"),
        ("[[key]]\nframe = 0\nfile = \"nowhere.toml\"".into(), "3:8: key[0].file: nowhere.toml cannot be read"),
        // No TOML.
        ("x = \n".into(), "1:"),
        (format!("size = 8\nsize = 9\n{white}"), "2:1: TOML: duplicate key"),
        ("[[layer\n".into(), "1:"),
    ];
    let wrong: Vec<String> = cases
        .iter()
        .map(|(text, expected)| (text, refusal(text), expected))
        .filter(|(_, found, expected)| !found.starts_with(*expected))
        .map(|(text, found, expected)| format!("{text}\n  gives  {found}\n  not    {expected}"))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn images_lie_beside_their_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("pictures")).unwrap();
    let (png, exr) = (folder.path().join("pictures/ramp.png"), folder.path().join("ramp.exr"));
    airlight::formats::write_png(&png, 2, 1, &[255, 188, 0, 255, 255, 255, 255, 0]).unwrap();
    airlight::formats::write_exr(&exr, 1, 1, &[0.5, 0.25, 2.0, 0.5]).unwrap();
    let style = folder.path().join("style.toml");
    let layer = |file: &str| format!("[[layer]]\nkind = \"image\"\nfile = \"{file}\"\n");
    std::fs::write(&style, layer("pictures/ramp.png") + &layer("ramp.exr")).unwrap();
    let read = read_transfer(&style).unwrap();
    let [Source::Image(png), Source::Image(exr)] = [0, 1].map(|i| read.keys()[0].1.layers[i].source.clone())
    else {
        panic!()
    };
    assert_eq!((png.size, exr.size), ([2, 1], [1, 1]));
    assert!(
        (png.texels[0] - Vec4::new(1.0, 0.5029, 0.0, 1.0)).length() < 1e-3 && png.texels[1] == Vec4::ZERO
    );
    assert_eq!(exr.texels, [Vec4::new(0.5, 0.25, 2.0, 0.5)]);

    std::fs::write(folder.path().join("text.png"), "no picture").unwrap();
    for (file, reason) in [
        ("missing.png", "missing.png: "),
        ("text.png", "text.png: "),
        ("a.jpg", "its name ends in neither .png nor .exr"),
    ] {
        std::fs::write(&style, layer(file)).unwrap();
        let error = read_transfer(&style).unwrap_err();
        let TransferError::File { path, line, column, key, reason: found } = &error else {
            panic!("{error}")
        };
        assert_eq!((path.as_path(), *line, *column, key.as_str()), (style.as_path(), 3, 8, "layer[0].file"));
        assert!(found.contains(reason) && found.contains("a .png or .exr picture is needed"), "{found}");
    }
    let error = read_transfer(folder.path().join("none.toml")).unwrap_err();
    assert!(
        matches!(&error, TransferError::Unreadable { path, .. } if path.ends_with("none.toml")),
        "{error}"
    );
}

#[test]
fn keys_are_files_or_layers_with_settings_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let white = "[[layer]]\nkind = \"solid\"\ncolor = [1, 1, 1]\n";
    std::fs::write(folder.path().join("calm.toml"), format!("brightness = 3\n{white}")).unwrap();
    let text = "depth_limit = 9\n[[key]]\nframe = -2\nfile = \"calm.toml\"\n[[key]]\nframe = 10.5\nstrength = 0.5\n\
        [[key.layer]]\nkind = \"solid\"\ncolor = [0, 0, 0]\n";
    let style = folder.path().join("style.toml");
    std::fs::write(&style, text).unwrap();
    let read = read_transfer(&style).unwrap();
    let [(first, calm), (second, own)] = read.keys() else { panic!("{read:?}") };
    assert_eq!((*first, *second), (-2.0, 10.5));
    assert_eq!(
        (calm.settings.brightness, calm.settings.depth_limit),
        (3.0, None),
        "a file has its own settings"
    );
    assert_eq!(
        (own.settings.strength, own.settings.depth_limit),
        (0.5, Some(9.0)),
        "those at the top are for its keys"
    );
    // An error in a key's file names that file; a key's file has no keys.
    std::fs::write(folder.path().join("calm.toml"), format!("bright = 3\n{white}")).unwrap();
    let error = read_transfer(&style).unwrap_err().to_string();
    assert!(error.contains("calm.toml:1:1: bright: the key is unknown here"), "{error}");
    std::fs::write(folder.path().join("calm.toml"), "[[key]]\nframe = 0\nfile = \"style.toml\"\n").unwrap();
    let error = read_transfer(&style).unwrap_err().to_string();
    assert!(
        error.contains("style.toml:4:8: key[0].file: ") && error.contains("has key frames itself"),
        "{error}"
    );
}

#[test]
fn descriptions_made_in_code_are_checked_as_well() {
    let good = one(
        "size = 4\n[[layer]]\nkind = \"diffusion\"\nconstraint = [{ at = [0.1, 0.2], color = \"#ffffff\" }]",
    );
    good.check().unwrap();
    let refused = |change: &dyn Fn(&mut Transfer)| {
        let mut wrong = good.clone();
        change(&mut wrong);
        wrong.check().unwrap_err().to_string()
    };
    let constraint = |of: &mut Transfer, change: &dyn Fn(&mut airlight::stylize::Constraint)| {
        let Source::Diffusion(constraints) = &mut of.layers[0].source else { panic!() };
        change(&mut constraints[0]);
    };
    for (found, expected) in [
        (refused(&|of| of.layers.clear()), "layer: a transfer function needs at least one layer"),
        (refused(&|of| of.size = 0), "size: 0 texels are impossible"),
        (refused(&|of| of.settings.strength = f32::NAN), "strength: NaN is out of range"),
        (refused(&|of| of.settings.depth_limit = Some(f32::INFINITY)), "depth_limit: inf m is impossible"),
        (refused(&|of| of.layers[0].opacity = 1.5), "layer[0].opacity: 1.5 is out of range"),
        (
            refused(&|of| of.layers[0].source = Source::Diffusion(Vec::new())),
            "layer[0].constraint: a diffusion layer",
        ),
        (
            refused(&|of| constraint(of, &|c| c.place = Place::At(Vec2::splat(2.0)))),
            "layer[0].constraint[0].at: [2.0, 2.0] lies",
        ),
        (
            refused(&|of| constraint(of, &|c| c.color.rgb.y = -1.0)),
            "layer[0].constraint[0].color: -1 is out of range",
        ),
    ] {
        assert!(found.starts_with(expected), "{found}");
    }
}

#[test]
fn the_examples_of_the_book_are_transfer_functions() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/src/transfer");
    let mut names: Vec<_> = std::fs::read_dir(examples).unwrap().map(|entry| entry.unwrap().path()).collect();
    names.sort();
    assert!(names.len() >= 2);
    for name in names {
        read_transfer(&name).unwrap_or_else(|error| panic!("{error}"));
    }
}
