// SPDX-License-Identifier: MIT OR Apache-2.0
//! What cannot be meant with `airlight transmittance`, before any file is read.

use super::flags::{FormatSpelling, MapSpelling, Options, Source, SplatSpelling};
use super::medium::{Matter, Medium};
use crate::command::CommandError;
use crate::command::parse::LightSpelling;
use crate::command::volumes::is_array;
use crate::transmittance::Form;

/// Most pixels a side.
const MOST: u32 = 8192;
/// Most particles that the reference takes: seconds of a fast device, which gives up on longer work.
const MOST_SUMMED: usize = 200_000;

/// Checks what the flags alone say.
///
/// # Errors
/// Misuse: a value, or two flags that cannot be meant together.
pub fn check(flags: &Options) -> Result<(), CommandError> {
    let refuse = |flag: &str, problem: String| Err(CommandError::misuse(flag, problem));
    let framing = flags.view.rules();
    let rules = map(flags).into_iter().chain(medium(flags)).chain(framing);
    for (refused, flag, problem) in rules {
        if refused {
            return refuse(flag, problem.to_owned());
        }
    }
    let extension = flags.out.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if !matches!(extension.as_str(), "png" | "exr") {
        return refuse("--out", format!("`{}` must end in .png or .exr", flags.out.display()));
    }
    if let Some(given) = flags.coefficients {
        let moments = flags.map.form().is_some_and(Form::moments);
        let (offered, said): (&[u32], _) = if moments { (&[8], "8") } else { (&[4, 8, 16], "4, 8 or 16") };
        if !offered.contains(&given) {
            return refuse("--coefficients", format!("{given} are not offered with this --map: take {said}"));
        }
    }
    if flags.exposure <= 0.0 {
        return refuse("--exposure", format!("{} is impossible: it must be positive", flags.exposure));
    }
    for (flag, colour) in [("--radiance", Some(flags.radiance)), ("--background", flags.background)] {
        if let Some(colour) = colour.filter(|c| c.min_element() < 0.0 || c.max_element() > 1e4) {
            return refuse(flag, format!("{colour} is impossible: 0 to 1e4 is possible"));
        }
    }
    flags.of_volume.check_scale()?;
    if flags.size.iter().any(|side| *side > MOST) {
        let [width, height] = flags.size;
        return refuse("--size", format!("{width}x{height} is impossible: each side is from 1 to {MOST}"));
    }
    if let Some([min, max]) = flags.bounds.filter(|[min, max]| !min.cmplt(*max).all()) {
        let problem = format!(
            "from {min} to {max} the map has a range of zero: each coordinate of the second corner must exceed the first"
        );
        return refuse("--bounds", problem);
    }
    Ok(())
}

/// Checks what flags say of a medium that was read.
///
/// # Errors
/// Misuse: more particles than the reference takes.
pub fn check_medium(flags: &Options, medium: &Medium) -> Result<(), CommandError> {
    match &medium.matter {
        Matter::Particles(particles, _)
            if flags.map == MapSpelling::Reference && particles.list.len() > MOST_SUMMED =>
        {
            let problem = format!(
                "`reference` sums over all particles for each: {} are more than {MOST_SUMMED}, take bounded",
                particles.list.len()
            );
            Err(CommandError::misuse("--map", problem))
        }
        _ => Ok(()),
    }
}

/// Whether it is broken, the flag, the problem.
type Rule = (bool, &'static str, &'static str);

fn map(flags: &Options) -> Vec<Rule> {
    const NO_MAP: &str = "the reference has no map: leave it out, or take another --map";
    let particles = flags.particles.is_some();
    let blended = flags.splat == Some(SplatSpelling::Blend);
    let function = matches!(flags.map, MapSpelling::Tfm | MapSpelling::TfmFourier);
    let reference = flags.map == MapSpelling::Reference;
    vec![
        (
            particles && function,
            "--map",
            "`tfm` holds transmittance, which particles cannot add up to: take bounded or etm, or a --volume",
        ),
        (reference && flags.coefficients.is_some(), "--coefficients", NO_MAP),
        (reference && flags.map_size.is_some(), "--map-size", NO_MAP),
        (reference && flags.format.is_some(), "--format", NO_MAP),
        (reference && flags.splat.is_some(), "--splat", NO_MAP),
        (
            flags.monotone && !matches!(flags.map, MapSpelling::Etm | MapSpelling::Bounded),
            "--monotone",
            "only --map etm and bounded have it: leave it out",
        ),
        (
            flags.format == Some(FormatSpelling::Float16) && flags.map.form().is_some_and(Form::moments),
            "--format",
            "`float16` loses moments: take float32",
        ),
        (!particles && flags.splat.is_some(), "--splat", "a volume is marched: leave it out"),
        (
            blended && !matches!(flags.map, MapSpelling::Etm | MapSpelling::Fom),
            "--splat",
            "`blend` is for --map etm and fom: take fixed",
        ),
        (
            blended && flags.format == Some(FormatSpelling::Float32),
            "--format",
            "`float32` is not blended on every device: take float16, or --splat fixed",
        ),
        (
            !matches!(flags.light, LightSpelling::Directional { .. }),
            "--light",
            "only a directional light has transmittance maps: take directional:AZ,EL",
        ),
    ]
}

fn medium(flags: &Options) -> Vec<Rule> {
    let source = flags.source();
    let file = matches!(source, Source::VolumeFile(_));
    let array = matches!(source, Source::VolumeFile(path) if is_array(path));
    let particles = flags.particles.is_some();
    let mut rules = vec![
        (
            !particles && flags.bounds.is_some(),
            "--bounds",
            "a volume has its own: leave it out, or take --particles",
        ),
        (particles && flags.reading.is_some(), "--reading", "particles have no voxels: leave it out"),
        (
            !file && flags.of_volume.threshold.is_some(),
            "--threshold",
            "it is of files of --volume: leave it out",
        ),
        (
            source != Source::Burst && flags.count.is_some(),
            "--count",
            "it is of --particles burst: leave it out",
        ),
    ];
    rules.extend(flags.of_volume.rules(
        array,
        (matches!(source, Source::Made(_)), "it is of --volume cloud and plume: leave it out"),
        (
            matches!(source, Source::Made(_) | Source::Burst),
            "files are as they are: leave it out, or take cloud, plume or burst",
        ),
    ));
    rules
}
