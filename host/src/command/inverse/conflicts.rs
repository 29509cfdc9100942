// SPDX-License-Identifier: MIT OR Apache-2.0
//! What cannot be meant with `airlight inverse`, before any file is read.

use super::error::SolveError;
use super::options::{BasisSpelling, LightFlags, MediumFlags, Property, SolveOptions, Wanted};
use super::views::ViewDescription;
use crate::command::CommandError;
use crate::command::parse::{LightSpelling, NO_AREA};
use crate::command::volumes::{Made, SEED_OF_FILES, is_array};
use glam::Vec3;

/// Checks what the flags of the medium say.
///
/// # Errors
/// Misuse.
pub fn check_medium(flags: &MediumFlags) -> Result<(), CommandError> {
    let made = Made::of(&flags.volume).is_some();
    let files = flags.of_volume.rules(
        is_array(&flags.volume),
        (made, "it is of --volume cloud, clouds, plume and smoke: leave it out, or give --resolution"),
        (made, SEED_OF_FILES),
    );
    let straight = (
        flags.refraction.is_none() && flags.refraction_step.is_some(),
        "--refraction-step",
        "rays are straight: leave it out, or give --refraction",
    );
    for (refused, flag, problem) in files.into_iter().chain([straight]) {
        if refused {
            return Err(CommandError::misuse(flag, problem));
        }
    }
    flags.of_volume.check_scale()?;
    check_light(&flags.light)?;
    colour("--emission", constant(&flags.emission), 1e4)?;
    colour("--albedo", constant(&flags.albedo), 1.0)
}

fn check_light(flags: &LightFlags) -> Result<(), CommandError> {
    let (lights, values) = (flags.light.len(), flags.radiance.len());
    for (refused, flag, problem) in [
        (
            flags.ambient.is_some() && (flags.environment.is_some() || lights > 0),
            "--ambient",
            "light is that of --environment and --light: leave it out",
        ),
        (flags.light.iter().any(|light| matches!(light, LightSpelling::Area { .. })), "--light", NO_AREA),
        (values > 0 && lights == 0, "--radiance", "it is of --light: leave it out"),
        (
            values > 1 && lights > 0 && values != lights,
            "--radiance",
            "give it once for all lights, or once a light",
        ),
    ] {
        if refused {
            return Err(CommandError::misuse(flag, problem));
        }
    }
    flags.radiance.iter().try_for_each(|radiance| colour("--radiance", Some(*radiance), 1e4))?;
    colour("--ambient", flags.ambient, 1e4)
}

/// Checks that a solve can do with the light of its views.
///
/// # Errors
/// [`SolveError::OwnLight`].
pub fn check_views(flags: &SolveOptions, views: &[ViewDescription]) -> Result<(), SolveError> {
    let own = views.iter().find(|view| view.environment.is_some());
    match own.filter(|_| flags.any(|wanted| wanted == Wanted::Light)) {
        Some(view) => Err(SolveError::OwnLight(view.name.clone())),
        None => Ok(()),
    }
}

/// Checks what all flags of a solve say.
///
/// # Errors
/// Misuse: a value, or two flags that cannot be meant together.
pub fn check(flags: &SolveOptions) -> Result<(), CommandError> {
    check_medium(&flags.medium)?;
    let extinction = flags.any(|wanted| wanted == Wanted::Extinction);
    let light = flags.any(|wanted| wanted == Wanted::Light);
    let of_light = "it is of --for light: leave it out";
    let of_frames = "there are no frames: give --frames A..B, or leave it out";
    for (refused, flag, problem) in [
        (
            extinction && flags.basis == BasisSpelling::Box,
            "--basis",
            "extinction is read straight between its voxels: leave it out, or solve for emission and albedo alone",
        ),
        (
            light && flags.basis == BasisSpelling::Box,
            "--basis",
            "light is scattered straight between voxels: leave it out, or solve for light in another run",
        ),
        (
            flags.hull && flags.medium.refraction.is_some(),
            "--hull",
            "masks are seen along straight rays and --refraction bends them: leave it out",
        ),
        (
            light && flags.frames.is_some(),
            "--frames",
            "light that is solved for is one for all views: leave it out, or solve for light in another run",
        ),
        (flags.frames.is_none() && flags.seen_from.is_some(), "--seen-from", of_frames),
        (flags.frames.is_none() && flags.rate.is_some(), "--rate", of_frames),
        (!light && flags.discs.lights.is_some(), "--lights", of_light),
        (!light && flags.discs.upper, "--upper", of_light),
        (!light && flags.discs.light_strategy.is_some(), "--light-strategy", of_light),
        (
            !extinction && flags.medium_radiance.is_some(),
            "--medium-radiance",
            "it is of --for extinction: leave it out",
        ),
        (
            !extinction && flags.most_depth.is_some(),
            "--most-depth",
            "it is of --for extinction: leave it out",
        ),
        (
            flags.emission_resolution.is_some() && !flags.any(Wanted::emission),
            "--emission-resolution",
            "emission is not solved for: leave it out, or give --for emission",
        ),
        (
            flags.albedo_resolution.is_some() && !flags.any(Wanted::albedo),
            "--albedo-resolution",
            "albedo is not solved for: leave it out, or give --for albedo",
        ),
    ] {
        if refused {
            return Err(CommandError::misuse(flag, problem));
        }
    }
    for (flag, weight) in
        [("--laplacian", flags.laplacian), ("--smallness", flags.smallness), ("--oneness", flags.oneness)]
    {
        number(flag, Some(weight), [0.0, 1e6])?;
    }
    number("--most-depth", flags.most_depth, [0.01, 80.0])?;
    colour("--medium-radiance", flags.medium_radiance, 1e4)
}

fn constant(of: &Property) -> Option<Vec3> {
    match of {
        Property::Constant(colour) => Some(*colour),
        Property::File(_) => None,
    }
}

fn number(flag: &str, value: Option<f32>, [least, most]: [f32; 2]) -> Result<(), CommandError> {
    match value.filter(|value| !(least..=most).contains(value)) {
        Some(value) => {
            Err(CommandError::misuse(flag, format!("{value} is impossible: {least} to {most} is possible")))
        }
        None => Ok(()),
    }
}

fn colour(flag: &str, colour: Option<Vec3>, most: f32) -> Result<(), CommandError> {
    let possible = |colour: Vec3| colour.min_element() >= 0.0 && colour.max_element() <= most;
    match colour.filter(|colour| !possible(*colour)) {
        Some(colour) => {
            Err(CommandError::misuse(flag, format!("{colour} is impossible: 0 to {most} is possible")))
        }
        None => Ok(()),
    }
}
