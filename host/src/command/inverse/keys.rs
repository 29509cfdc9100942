// SPDX-License-Identifier: MIT OR Apache-2.0
//! Key frames: views of one time are of one volume, and frames lie between two of them (Klehm, thesis, section 7.5.1).

use super::options::{MediumFlags, SolveOptions};
use super::views::{ViewDescription, Views};
use super::volumes::{Matter, same_place};
use crate::command::CommandError;
use crate::command::sequence::FrameRange;
use crate::inverse::Channels;
use std::path::{Path, PathBuf};

/// Why there are no frames between those that are painted. Each message says what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum KeyError {
    /// A view of no time.
    #[error("--frames: view `{0}` has no `time`; give each view the number of the frame that it shows")]
    NoTime(String),
    /// Nothing to go to.
    #[error(
        "--frames: all views show time {0}, and frames lie between two; give views of another time, or leave it out"
    )]
    OneTime(f32),
    /// Views that are mixed.
    #[error(
        "--frames: view `{view}` shows time {time} and follows one of time {before}; give views in the order of their times"
    )]
    Order {
        /// The view.
        view: String,
        /// Its time.
        time: f32,
        /// That of the view before.
        before: f32,
    },
    /// Frames before the first or after the last key frame.
    #[error(
        "--frames: {first}..{last} leaves the times of the views; take frames from {least} to {most}, or give views of other times"
    )]
    Outside {
        /// The first that is asked for.
        first: u32,
        /// The last.
        last: u32,
        /// Time of the first key frame.
        least: f32,
        /// Time of the last.
        most: f32,
    },
    /// Volumes of key frames without frames.
    #[error(
        "--views: {0} has volumes of key frames ([[key]]), and one volume is solved for; give --frames A..B, or leave them out"
    )]
    NoFrames(PathBuf),
    /// Frames seen from nowhere.
    #[error("--seen-from: no view is called `{0}`; give the name of a view")]
    NoView(String),
}

impl From<KeyError> for CommandError {
    fn from(error: KeyError) -> Self {
        Self::Misuse(error.to_string())
    }
}

/// A volume and its views.
pub struct Key<'a> {
    /// Of its views, where there are several key frames.
    pub time: Option<f32>,
    /// Its file, or what is made.
    pub volume: &'a Path,
    /// Those that show it.
    pub views: &'a [ViewDescription],
}

impl<'a> Key<'a> {
    /// The key frames of a solve; without `--frames` all views are of one volume.
    ///
    /// # Errors
    /// [`KeyError`].
    pub fn of_solve(flags: &'a SolveOptions, views: &'a Views) -> Result<Vec<Self>, KeyError> {
        let Some(frames) = flags.frames else {
            if !views.keys.is_empty() {
                return Err(KeyError::NoFrames(flags.medium.views.clone()));
            }
            return Ok(vec![Self { time: None, volume: &flags.medium.volume, views: &views.list }]);
        };
        let seen_from = flags.seen_from.as_ref();
        if let Some(name) = seen_from.filter(|name| views.list.iter().all(|view| view.name != **name)) {
            return Err(KeyError::NoView(name.clone()));
        }
        times(&views.list, frames)?;
        Ok(Self::groups(&flags.medium, views, |one, other| one.time == other.time))
    }

    /// Views that follow each other and show the same volume.
    pub fn of_volumes(flags: &'a MediumFlags, views: &'a Views) -> Vec<Self> {
        Self::groups(flags, views, |one, other| views.volume_of(one) == views.volume_of(other))
    }

    fn groups(
        flags: &'a MediumFlags,
        views: &'a Views,
        alike: impl Fn(&ViewDescription, &ViewDescription) -> bool,
    ) -> Vec<Self> {
        let group = |own: &'a [ViewDescription]| {
            let volume = own.first().and_then(|view| views.volume_of(view)).unwrap_or(&flags.volume);
            Self { time: own.first().and_then(|view| view.time), volume, views: own }
        };
        views.list.chunk_by(alike).map(group).collect()
    }
}

/// Checks that frames lie between times that ascend.
fn times(views: &[ViewDescription], frames: FrameRange) -> Result<(), KeyError> {
    let time = |view: &ViewDescription| view.time.ok_or_else(|| KeyError::NoTime(view.name.clone()));
    let all = views.iter().map(time).collect::<Result<Vec<_>, _>>()?;
    for (pair, view) in all.windows(2).zip(views.iter().skip(1)) {
        if pair[1] < pair[0] {
            return Err(KeyError::Order { view: view.name.clone(), time: pair[1], before: pair[0] });
        }
    }
    let [least, .., most] = all[..] else {
        return Err(KeyError::OneTime(all.first().copied().unwrap_or(0.0)));
    };
    if least == most {
        return Err(KeyError::OneTime(least));
    }
    let (first, last) = (frames.first, frames.last());
    if (first as f32) < least || last as f32 > most {
        return Err(KeyError::Outside { first, last, least, most });
    }
    Ok(())
}

/// The volume of each key frame, in the box and on the grid of the first. Where no scale is said, all have that of the first, so that density
/// does not jump.
///
/// # Errors
/// As [`Matter::new`]; a failure where a volume has another box or grid.
pub fn matters(
    flags: &MediumFlags,
    keys: &[Key<'_>],
    channels: Channels,
) -> Result<Vec<Matter>, CommandError> {
    let mut all: Vec<Matter> = Vec::with_capacity(keys.len());
    for key in keys {
        let mut own = flags.clone();
        own.volume = key.volume.to_owned();
        if let Some(first) = all.first() {
            own.of_volume.extinction_scale.get_or_insert(first.scale);
        }
        let matter = Matter::new(&own, channels)?;
        if let Some(first) = all.first() {
            let (voxels, others) = (matter.extinction.size, first.extinction.size);
            if voxels != others || !same_place(matter.place, first.place) {
                return Err(CommandError::failure(format!(
                    "--views: {} has {voxels:?} voxels and {} {others:?}, or they lie elsewhere: resample volumes of key frames to the same voxels",
                    key.volume.display(),
                    keys[0].volume.display()
                )));
            }
        }
        all.push(matter);
    }
    Ok(all)
}

/// Which of the times is the last that is not after a frame, but for the very last one, and how far the frame is on the way to the next, 0 to 1.
pub fn place_of(frame: u32, times: &[f32]) -> (usize, f32) {
    let frame = frame as f32;
    let after = times.iter().skip(1).take_while(|time| **time <= frame).count();
    let first = after.min(times.len().saturating_sub(2));
    match times[first..] {
        [from, to, ..] if to > from => (first, ((frame - from) / (to - from)).clamp(0.0, 1.0)),
        _ => (first, 0.0),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::command::inverse::views::parse_views;

    #[test]
    fn frames_lie_between_two_times() {
        let times = [2.0, 4.0, 8.0];
        for (frame, first, part) in [(2, 0, 0.0), (3, 0, 0.5), (4, 1, 0.0), (5, 1, 0.25), (8, 1, 1.0)] {
            assert_eq!(place_of(frame, &times), (first, part), "{frame}");
        }
        assert_eq!(place_of(7, &[7.0]), (0, 0.0));
    }

    #[test]
    fn times_ascend_and_hold_the_frames() {
        let views = |lines: &[&str]| {
            let view = |(i, line): (usize, &&str)| {
                format!(
                    "[[view]]\nname = \"v{i}\"\nsize = [4, 3]\n{line}\n\
                     camera = {{ eye = [0, 0, 4], target = [0, 0, 0], height = 2 }}\n"
                )
            };
            let text: String = lines.iter().enumerate().map(view).collect();
            parse_views("v.toml", &text).unwrap().list
        };
        let frames = FrameRange { first: 1, count: 3 };
        let check = |lines: &[&str]| times(&views(lines), frames);
        assert_eq!(check(&["time = 1", "time = 1", "time = 2.5", "time = 3"]), Ok(()));
        assert_eq!(check(&["time = 1", ""]), Err(KeyError::NoTime("v1".to_owned())));
        assert_eq!(check(&["time = 1", "time = 1"]), Err(KeyError::OneTime(1.0)));
        assert_eq!(check(&["time = 1"]), Err(KeyError::OneTime(1.0)));
        let order = KeyError::Order { view: "v1".to_owned(), time: 1.0, before: 3.0 };
        assert_eq!(check(&["time = 3", "time = 1"]), Err(order));
        for ends in [[1.5, 3.0], [0.0, 2.5]] {
            let [least, most] = ends;
            let outside = KeyError::Outside { first: 1, last: 3, least, most };
            assert_eq!(
                check(&ends.map(|time| format!("time = {time:?}")).each_ref().map(String::as_str)),
                Err(outside)
            );
        }
    }
}
