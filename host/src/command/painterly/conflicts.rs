// SPDX-License-Identifier: MIT OR Apache-2.0
//! What cannot be meant with `airlight painterly`, before any file is read.

use super::flags::Options;
use crate::command::CommandError;
use crate::command::parse::LightSpelling;

/// Most pixels a side.
const MOST: u32 = 8192;

/// Checks what the flags alone say.
///
/// # Errors
/// Misuse: a value, or two flags that cannot be meant together.
pub fn check(flags: &Options) -> Result<(), CommandError> {
    let array = flags.volume.extension().is_some_and(|e| e.eq_ignore_ascii_case("npy"));
    let still = flags.frames.is_none();
    let own = [
        (
            !matches!(flags.light, LightSpelling::Directional { .. }),
            "--light",
            "only a directional light shines on surfaces: take directional:AZ,EL",
        ),
        (!array && flags.voxel.is_some(), "--voxel", "it is of .npy files of --volume: leave it out"),
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
    let framing = flags.view.rules();
    for (refused, flag, problem) in own.into_iter().chain(framing) {
        if refused {
            return Err(CommandError::misuse(flag, problem));
        }
    }
    if flags.size.iter().any(|side| *side > MOST) {
        let [width, height] = flags.size;
        let problem = format!("{width}x{height} is impossible: each side is from 1 to {MOST}");
        return Err(CommandError::misuse("--size", problem));
    }
    Ok(flags.surface(1.0).check()?)
}
