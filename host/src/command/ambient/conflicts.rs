// SPDX-License-Identifier: MIT OR Apache-2.0
//! What cannot be meant with `airlight ambient`, before any file is read.

use super::flags::{MOST_TRACED, MethodSpelling, Options, SamplerSpelling, ShowSpelling};
use crate::ambient::OcclusionSettings;
use crate::command::CommandError;

/// Most pixels a side.
const MOST: u32 = 8192;

/// Checks what the flags alone say.
///
/// # Errors
/// Misuse: a value, or two flags that cannot be meant together.
pub fn check(flags: &Options) -> Result<(), CommandError> {
    let refuse = |flag: &str, problem: String| Err(CommandError::misuse(flag, problem));
    let rules = traced(flags).into_iter().chain(unlit(flags)).chain(shown(flags)).chain(flags.view.rules());
    for (refused, flag, problem) in rules {
        if refused {
            return refuse(flag, problem.to_owned());
        }
    }
    if !(flags.linear() || flags.out.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"))) {
        return refuse("--out", format!("`{}` must end in .png or .exr", flags.out.display()));
    }
    if let Some(exposure) = flags.exposure.filter(|exposure| *exposure <= 0.0) {
        return refuse("--exposure", format!("{exposure} is impossible: it must be positive"));
    }
    if flags.size.iter().any(|side| *side > MOST) {
        let [width, height] = flags.size;
        return refuse("--size", format!("{width}x{height} is impossible: each side is from 1 to {MOST}"));
    }
    if flags.method != MethodSpelling::Reference {
        return Ok(flags.settings(1.0).check()?);
    }
    let rays = flags.rays();
    if !(1..=MOST_TRACED).contains(&rays) {
        return refuse("--samples", format!("{rays} rays are impossible: 1 to {MOST_TRACED} are possible"));
    }
    Ok(OcclusionSettings::new(flags.radius.unwrap_or(1.0)).check()?)
}

/// Whether it is broken, the flag, the problem.
type Rule = (bool, &'static str, &'static str);

/// Flags that rays have no use for.
fn traced(flags: &Options) -> Vec<Rule> {
    let problem = "--method reference traces rays instead: leave it out, or take another --method";
    let given = [
        (flags.sampler.is_some(), "--sampler"),
        (flags.steps.is_some(), "--steps"),
        (flags.thickness.is_some(), "--thickness"),
        (flags.frame.is_some(), "--frame"),
        (flags.interleave.is_some(), "--interleave"),
        (flags.half, "--half"),
        (flags.no_blur, "--no-blur"),
        (flags.plain_blur, "--plain-blur"),
        (flags.printed, "--printed"),
    ];
    let traced = flags.method == MethodSpelling::Reference;
    given.into_iter().map(|(given, flag)| (traced && given, flag, problem)).collect()
}

/// Flags of light where none is shown.
fn unlit(flags: &Options) -> Vec<Rule> {
    let problem = "only --show shaded has light: leave it out";
    let given = [
        (flags.environment.is_some(), "--environment"),
        (flags.low_pass, "--low-pass"),
        (flags.printed, "--printed"),
        (flags.exposure.is_some(), "--exposure"),
    ];
    given.into_iter().map(|(given, flag)| (flags.numbers() && given, flag, problem)).collect()
}

fn shown(flags: &Options) -> [Rule; 3] {
    let flat = matches!(flags.sampler, Some(SamplerSpelling::Disc | SamplerSpelling::Horizon));
    let coneless = matches!(flags.method, MethodSpelling::Ao | MethodSpelling::Normals);
    [
        (
            flags.printed && flags.method == MethodSpelling::Ao,
            "--printed",
            "the brightness of --method ao is as printed: leave it out",
        ),
        (
            flags.thickness.is_some() && flat,
            "--thickness",
            "--sampler disc and horizon know none: leave it out, or give --sampler hemisphere or bitmask",
        ),
        (
            flags.show == ShowSpelling::Angles && coneless,
            "--show",
            "--method ao and normals have no cones: give --method cones, exact-cones or reference",
        ),
    ]
}
