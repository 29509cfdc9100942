// SPDX-License-Identifier: MIT OR Apache-2.0
//! Flags of `airlight scattering` that cannot be meant together.

use super::flags::{
    JitterSpelling, MethodSpelling, Options, RectificationSpelling, ReferenceSpelling, StartSpelling,
};
use crate::command::parse::{DepthSpelling, LightSpelling, NO_AREA, Projection};
use crate::scattering::{RANK_COLUMNS, Visibility};

/// What cannot be meant.
pub struct Conflict {
    /// The flag to change.
    pub flag: &'static str,
    /// What is wrong with it, and the remedy.
    pub problem: &'static str,
}

/// The first conflict among the flags. `framed`: more than jitter may change with --frame.
pub fn find(flags: &Options, framed: bool) -> Option<Conflict> {
    let rules = camera(flags).into_iter().chain(light(flags)).chain(march(flags, framed));
    let rules = rules.chain(methods(flags)).chain(rows(flags));
    rules.into_iter().find(|(refused, ..)| *refused).map(|(_, flag, problem)| Conflict { flag, problem })
}

/// Whether it is broken, the flag, the problem.
type Rule = (bool, &'static str, &'static str);

fn camera(flags: &Options) -> Vec<Rule> {
    let orthographic = flags.camera == Projection::Orthographic;
    let framing = flags.camera.framing_rules(flags.fov.is_some(), flags.height.is_some());
    let mut rules = framing.to_vec();
    rules.extend([
        (
            orthographic && flags.depth_range == DepthSpelling::Infinite,
            "--depth-range",
            "`infinite` is impossible for an orthographic camera: take reversed",
        ),
        (
            orthographic && flags.stereo.is_some(),
            "--stereo",
            "an orthographic camera shows both eyes the same: take --camera perspective",
        ),
        (
            orthographic && flags.start == Some(StartSpelling::Eye),
            "--start",
            "`eye` is impossible for an orthographic camera, whose rays begin at the near plane: leave it out",
        ),
    ]);
    rules
}

fn light(flags: &Options) -> Vec<Rule> {
    vec![
        (matches!(flags.light, LightSpelling::Area { .. }), "--light", NO_AREA),
        (
            matches!(flags.light, LightSpelling::Point { .. }) && flags.light_texture.is_some(),
            "--light-texture",
            "a point light takes none: take a spot, or several",
        ),
        (
            flags.local() && flags.cascades.is_some(),
            "--cascades",
            "they are for directional lights: leave them out for a spot or a point light",
        ),
    ]
}

fn march(flags: &Options, framed: bool) -> Vec<Rule> {
    const NO_ROWS: &str = "a march has no rows: leave it out, or take --method fourier";
    let march = flags.method == MethodSpelling::March;
    let jitter = flags.jitter != JitterSpelling::None;
    vec![
        (march && flags.rectification != RectificationSpelling::Auto, "--rectification", NO_ROWS),
        (march && flags.splits.is_some(), "--splits", NO_ROWS),
        (march && flags.regions > 1, "--regions", NO_ROWS),
        (march && flags.reference == ReferenceSpelling::Optimum, "--reference", NO_ROWS),
        (
            march && flags.camera == Projection::Perspective && flags.near_plane(),
            "--start",
            "the march begins at the eye: leave it out, or take --method fourier",
        ),
        (jitter && !march, "--jitter", "prefiltering takes no samples: leave it out, or take --method march"),
        (
            jitter && !flags.plain(),
            "--jitter",
            "only a directional light without --cascades and --light-texture is marched with it: leave it out",
        ),
        (
            !jitter && !framed && flags.frame.is_some(),
            "--frame",
            "nothing changes with it: give --jitter gradient or blue-noise as well",
        ),
    ]
}

fn methods(flags: &Options) -> Vec<Rule> {
    let moments = flags.method == MethodSpelling::Moments;
    let wavelet = flags.method == MethodSpelling::Wavelet;
    let exact = wavelet || flags.method == MethodSpelling::Rank;
    let other = exact || moments;
    let rank = matches!(flags.visibility(), Visibility::Rank { .. } | Visibility::Wavelet { .. });
    const BASES: &str = "it is of Fourier bases: leave it out, or take --method fourier";
    const EPIPOLAR: &str =
        "wavelet matrices are of epipolar rows: leave it out, or take --method rank or fourier";
    vec![
        (
            wavelet && (flags.local() || flags.light_texture.is_some()),
            "--method",
            "`wavelet` is for directional lights without --light-texture: take auto",
        ),
        (
            wavelet && flags.camera == Projection::Orthographic,
            "--method",
            "`wavelet` needs a perspective camera: take auto",
        ),
        (other && flags.bases.is_some(), "--bases", BASES),
        (other && flags.half, "--half", BASES),
        (other && flags.regions > 1, "--regions", BASES),
        (wavelet && flags.splits.is_some(), "--splits", EPIPOLAR),
        (wavelet && flags.rectification == RectificationSpelling::Projective, "--rectification", EPIPOLAR),
        (
            flags.bits.is_some() && !rank,
            "--bits",
            "only rank queries and wavelet matrices have them: leave it out, or take --method rank",
        ),
        (
            exact && flags.map[0] > RANK_COLUMNS,
            "--map",
            "`--method rank` and `wavelet` take at most 2048 columns: take fewer, or --method auto",
        ),
        (
            wavelet && flags.bits.is_some_and(|bits| bits % 2 != 0),
            "--bits",
            "a wavelet matrix has 8, 10 or 12: take one of these, or --method rank",
        ),
        (
            wavelet && !flags.average,
            "--method",
            "`wavelet` counts texels and has no weights: give --average as well, or take --method rank",
        ),
    ]
}

fn rows(flags: &Options) -> Vec<Rule> {
    let orthographic = flags.camera == Projection::Orthographic;
    let projective = flags.rectification == RectificationSpelling::Projective;
    let epipolar = flags.rectification == RectificationSpelling::Epipolar;
    let optimum = flags.reference == ReferenceSpelling::Optimum;
    let weighted = flags.local() || flags.light_texture.is_some();
    let filtered = flags.method != MethodSpelling::March;
    vec![
        (projective && flags.local(), "--rectification", "`projective` is for directional lights: take auto"),
        (
            projective && flags.light_texture.is_some(),
            "--rectification",
            "`projective` rows take no --light-texture: take auto",
        ),
        (
            projective && flags.cascades.is_some(),
            "--rectification",
            "`projective` rows take no --cascades: take auto",
        ),
        (epipolar && orthographic, "--rectification", "`epipolar` rows need a perspective camera: take auto"),
        (
            flags.regions > 1 && weighted,
            "--regions",
            "rows of a spot, a point light or a light texture are filtered in one region: leave it out",
        ),
        (
            filtered && !orthographic && flags.near_plane() && weighted,
            "--start",
            "rays begin at the eye for a spot, a point light or a light texture: leave it out",
        ),
        (
            flags.splits.is_some() && (epipolar || !flags.plain()),
            "--splits",
            "only projective rows are split, and these are epipolar: leave it out",
        ),
        (
            flags.splits.is_some_and(|splits| splits > 1) && orthographic,
            "--splits",
            "rows of an orthographic camera are not split: leave it out",
        ),
        (
            optimum && (projective || orthographic || flags.local()),
            "--reference",
            "`optimum` is for epipolar rows of a directional light: leave it out",
        ),
    ]
}
