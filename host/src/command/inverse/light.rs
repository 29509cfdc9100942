// SPDX-License-Identifier: MIT OR Apache-2.0
//! What light the medium has to scatter.

use super::discs::LitDiscs;
use super::field::reduced;
use super::options::LightFlags;
use super::views::{ViewDescription, ViewsError};
use crate::Lighting;
use crate::command::CommandError;
use crate::data::{Bounds, Environment, load_environment};
use crate::inverse::Channels;
use glam::Vec3;
use std::path::Path;
use std::sync::Arc;

/// Lights that stand for a map where no number is asked for.
const ENVIRONMENT_LIGHTS: u32 = 64;
/// Which of the sets of lights that stand for a map.
const SEED: u64 = 1;
/// Irradiance of a light of which none is said: all around of an albedo of 1, about as bright as an ambient radiance of 1.
const IRRADIANCE: Vec3 = Vec3::new(12.0, 10.5, 8.4);

/// Where light comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Illumination {
    /// The same from all around, of which the medium takes nothing away: linear RGB radiance.
    Ambient(Vec3),
    /// Lights, whose way goes through the medium.
    Lights(Vec<Lighting>),
    /// Light that was solved for, whose way goes through the medium too.
    Discs(LitDiscs),
}

impl Illumination {
    /// None at all.
    pub fn dark() -> Arc<Self> {
        Arc::new(Self::Ambient(Vec3::ZERO))
    }

    /// What the flags say. `bounds`: those of the volume.
    ///
    /// # Errors
    /// A failure: a map that cannot be read.
    pub fn of(flags: &LightFlags, bounds: &Bounds) -> Result<Self, CommandError> {
        if flags.environment.is_none() && flags.light.is_empty() {
            return Ok(Self::Ambient(flags.ambient.unwrap_or(Vec3::ONE)));
        }
        let mut lights = Vec::new();
        if let Some(path) = &flags.environment {
            let map = load_environment(path)
                .map_err(|error| CommandError::failure(format!("--environment: {error}")))?;
            lights = sampled(&map, flags);
        }
        for (place, light) in flags.light.iter().enumerate() {
            let own = flags.radiance.get(place).or(flags.radiance.first()).copied();
            lights.push(light.lighting(own.unwrap_or_else(|| light.radiance_as(IRRADIANCE, bounds))));
        }
        Ok(Self::Lights(lights))
    }
}

fn sampled(map: &Environment, flags: &LightFlags) -> Vec<Lighting> {
    let count = flags.environment_lights.unwrap_or(ENVIRONMENT_LIGHTS);
    map.sample_lights(count, SEED).into_iter().map(Lighting::from).collect()
}

/// The light of every view.
pub struct Lights {
    /// That of the flags first.
    pub all: Vec<Arc<Illumination>>,
    /// Which of them each view has.
    pub of_views: Vec<usize>,
}

impl Lights {
    /// What the flags and the views say. `bounds`: those of the volume.
    ///
    /// # Errors
    /// A failure: a map that cannot be read.
    pub fn new(flags: &LightFlags, views: &[ViewDescription], bounds: &Bounds) -> Result<Self, CommandError> {
        let mut all = vec![Arc::new(Illumination::of(flags, bounds)?)];
        let mut maps: Vec<&Path> = Vec::new();
        let mut of_views = Vec::with_capacity(views.len());
        for view in views {
            let Some(path) = view.environment.as_deref() else {
                of_views.push(0);
                continue;
            };
            let place = match maps.iter().position(|map| *map == path) {
                Some(place) => place,
                None => {
                    let failed = |source| ViewsError::Environment { view: view.name.clone(), source };
                    let map = load_environment(path).map_err(failed)?;
                    all.push(Arc::new(Illumination::Lights(sampled(&map, flags))));
                    maps.push(path);
                    maps.len() - 1
                }
            };
            of_views.push(1 + place);
        }
        Ok(Self { all, of_views })
    }
}

/// Lights whose colours are what the channels have of them.
pub fn as_channels(lights: &[Lighting], channels: Channels) -> Vec<Lighting> {
    let mut lights = lights.to_vec();
    for light in &mut lights {
        match light {
            Lighting::Directional { radiance: colour, .. }
            | Lighting::Spot { intensity: colour, .. }
            | Lighting::Point { intensity: colour, .. } => *colour = reduced(*colour, channels),
        }
    }
    lights
}
