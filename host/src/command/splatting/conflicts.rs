// SPDX-License-Identifier: MIT OR Apache-2.0
//! What cannot be meant with `airlight splatting`, before any file is read.

use super::flags::{Options, ShadingSpelling};
use crate::command::CommandError;
use crate::command::volumes::{Made, SEED_OF_FILES, is_array};
use glam::Vec3;

/// Most pixels a side.
const MOST: u32 = 8192;

/// Checks what the flags alone say.
///
/// # Errors
/// Misuse: a value, or two flags that cannot be meant together.
pub fn check(flags: &Options) -> Result<(), CommandError> {
    let refuse = |flag: &str, problem: String| Err(CommandError::misuse(flag, problem));
    let rules = own(flags).into_iter().chain(flags.transport.rules(flags.light)).chain(flags.view.rules());
    for (refused, flag, problem) in rules {
        if refused {
            return refuse(flag, problem.to_owned());
        }
    }
    let extension = flags.out.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if !(extension == "png" || extension == "exr" && flags.frames.is_none()) {
        let ends = if flags.frames.is_none() { ".png or .exr" } else { ".png with --frames" };
        return refuse("--out", format!("`{}` must end in {ends}", flags.out.display()));
    }
    if flags.exposure <= 0.0 {
        return refuse("--exposure", format!("{} is impossible: it must be positive", flags.exposure));
    }
    for (flag, colour, most) in [
        ("--radiance", flags.radiance, 60_000.0),
        ("--background", flags.background, 1e4),
        ("--ambient", Some(flags.ambient), 1e4),
        ("--albedo", Some(flags.albedo), 1.0),
    ] {
        let possible = |colour: Vec3| colour.min_element() >= 0.0 && colour.max_element() <= most;
        if let Some(colour) = colour.filter(|colour| !possible(*colour)) {
            return refuse(flag, format!("{colour} is impossible: 0 to {most} is possible"));
        }
    }
    if let Some(g) = flags.g.filter(|g| !(-0.99..=0.99).contains(g)) {
        return refuse("--g", format!("{g} is impossible: it must be from -0.99 to 0.99"));
    }
    flags.of_volume.check_scale()?;
    if flags.size.iter().any(|side| *side > MOST) {
        let [width, height] = flags.size;
        return refuse("--size", format!("{width}x{height} is impossible: each side is from 1 to {MOST}"));
    }
    Ok(())
}

/// Whether it is broken, the flag, the problem.
type Rule = (bool, &'static str, &'static str);

fn own(flags: &Options) -> Vec<Rule> {
    let made = flags.volume.iter().any(|placed| Made::of(&placed.source).is_some());
    let array = flags.volume.iter().any(|placed| is_array(&placed.source));
    let still = flags.frames.is_none();
    let mut rules = vec![
        (
            flags.g.is_some() && flags.shading == ShadingSpelling::Phong,
            "--g",
            "surfaces have no phase function: leave it out, or --shading phong",
        ),
        (
            flags.light_texture.is_some() && (flags.transport.soft || flags.transport.scatters()),
            "--light-texture",
            "light that spreads has none: leave it out, or --forward, --back and --soft",
        ),
        (
            still && flags.turn.is_some(),
            "--turn",
            "nothing turns in a single picture: give --frames A..B, or leave it out",
        ),
        (
            still && flags.rate.is_some(),
            "--rate",
            "a single picture has none: give --frames A..B, or leave it out",
        ),
    ];
    rules.extend(flags.of_volume.rules(
        array,
        (made, "it is of --volume cloud, clouds, plume and smoke: leave it out"),
        (made, SEED_OF_FILES),
    ));
    rules
}
