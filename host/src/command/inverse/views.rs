// SPDX-License-Identifier: MIT OR Apache-2.0
//! Views of a volume as a TOML file: cameras, and the pictures that are wanted.
//!
//! A file is a list of `[[view]]`, each with these keys; paths are relative to the file.
//!
//! - `name`: of letters, digits, `-` and `_`, no other view's; files of results are called so.
//! - `size = [WIDTH, HEIGHT]`: pixels.
//! - `camera`: a table with `eye = [X, Y, Z]` and `target = [X, Y, Z]`, metres; either `field_of_view`, vertical, degrees, for a perspective
//!   camera or `height` of the picture, metres, for parallel rays; optionally `up = [X, Y, Z]`, the direction that is up in the picture
//!   (+y), `near` and `far`, metres from the eye (0.01 and 100 times the distance of the target).
//! - `target`: the picture that is wanted, .png (sRGB) or .exr or .hdr (linear radiance), of the view's size. Its alpha multiplies the weights, so that
//!   only what is painted counts.
//! - `weights`: how much each pixel counts, 0 or more: .png (grey, white is 1), .exr, .hdr or .npy [HEIGHT, WIDTH]; all 1 without it.
//! - `mask`: where the medium may be seen, for its visual hull: half and more is inside; the same formats.
//! - `depth`: metres along each ray to the surface that ends it, infinity without one: .npy [HEIGHT, WIDTH], or the red of an .exr.
//! - `background`: radiance behind the medium: `[R, G, B]` (linear), `"#rrggbb"` (sRGB) or a picture like `target`; black without it.
//! - `environment`: the map of surroundings in whose light the view was seen, latitude-longitude, .png (sRGB), .exr or .hdr (linear radiance):
//!   the only light of that view. The volume is the same in all views, so that those of several lightings are solved for together.
//! - `time`: the frame that the view shows, a number.
//!
//! Views of one time may have a volume of their own: a `[[key]]` with that `time` and `volume`, the path of a file.

mod error;
mod load;
mod write;

pub use error::ViewsError;
pub use load::{LoadedView, load_view};
pub use write::write_views;

use crate::core::{Camera, DepthRange, OrthographicView, PerspectiveView, View};
use crate::data::linear_from_hexadecimal;
use crate::formats::{parse_toml, read_toml};
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Longest side of a picture, pixels.
const MAX_SIDE: u32 = 8192;
/// The distance of the target over that of the near plane where none is given, and that of the far plane over it.
const PLANES: f32 = 100.0;

/// What lies behind the medium.
#[derive(Debug, Clone, PartialEq)]
pub enum Background {
    /// The same radiance everywhere, linear RGB.
    Color(Vec3),
    /// A picture.
    Picture(PathBuf),
}

/// What a file says.
#[derive(Debug, Clone, PartialEq)]
pub struct Views {
    /// The views, at least one.
    pub list: Vec<ViewDescription>,
    /// Volumes of key frames.
    pub keys: Vec<KeyVolume>,
}

impl Views {
    /// The volume that a view shows, where its key frame has one of its own.
    pub fn volume_of(&self, view: &ViewDescription) -> Option<&Path> {
        let own = self.keys.iter().find(|key| Some(key.time) == view.time);
        own.map(|key| key.volume.as_path())
    }
}

/// The volume of a key frame.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyVolume {
    /// That of the views that show it.
    pub time: f32,
    /// Its file.
    pub volume: PathBuf,
}

/// A view as a file says it. Paths are those to open.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewDescription {
    /// The file that says it, for errors.
    pub file: PathBuf,
    /// Unique in its file.
    pub name: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Where it is seen from.
    pub view: View,
    /// The direction that is up in the picture; +y where there is none.
    pub up: Option<Vec3>,
    /// The frame that it shows.
    pub time: Option<f32>,
    /// The picture that is wanted.
    pub target: Option<PathBuf>,
    /// How much each pixel counts.
    pub weights: Option<PathBuf>,
    /// Where the medium may be seen.
    pub mask: Option<PathBuf>,
    /// Where rays end.
    pub depth: Option<PathBuf>,
    /// What lies behind.
    pub background: Background,
    /// The surroundings that light the volume, if not those of all views.
    pub environment: Option<PathBuf>,
}

impl ViewDescription {
    /// The camera.
    ///
    /// # Errors
    /// [`ViewsError::Camera`].
    pub fn camera(&self) -> Result<Camera, ViewsError> {
        let camera = match self.up {
            Some(up) => Camera::with_up(&self.view, up, self.size),
            None => Camera::new(&self.view, self.size),
        };
        camera.map_err(|source| ViewsError::Camera {
            file: self.file.clone(),
            view: self.name.clone(),
            source,
        })
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    key: Vec<FileKey>,
    #[serde(default)]
    view: Vec<FileView>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FileKey {
    time: f32,
    volume: PathBuf,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FileView {
    name: String,
    size: [u32; 2],
    time: Option<f32>,
    target: Option<PathBuf>,
    weights: Option<PathBuf>,
    mask: Option<PathBuf>,
    depth: Option<PathBuf>,
    background: Option<FileBackground>,
    environment: Option<PathBuf>,
    camera: FileCamera,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FileCamera {
    eye: [f32; 3],
    target: [f32; 3],
    up: Option<[f32; 3]>,
    field_of_view: Option<f32>,
    height: Option<f32>,
    near: Option<f32>,
    far: Option<f32>,
}

#[derive(Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "a background is [red, green, blue] (linear), \"#rrggbb\" (sRGB) or the path of a picture"
)]
enum FileBackground {
    Linear([f32; 3]),
    Text(String),
}

/// Reads a file of views; the pictures in it are read by [`load_view`].
///
/// # Errors
/// [`ViewsError::File`] with line and column, also for unknown keys; [`ViewsError::Impossible`] with the view and the key; [`ViewsError::Camera`].
pub fn read_views(path: impl AsRef<Path>) -> Result<Views, ViewsError> {
    let path = path.as_ref();
    parse_views(path, &read_toml(path)?)
}

/// Like [`read_views`] for a text. `path`: where it lies, for errors and for the paths in it.
///
/// # Errors
/// As [`read_views`].
pub fn parse_views(path: impl AsRef<Path>, text: &str) -> Result<Views, ViewsError> {
    let path = path.as_ref();
    let File { key: keys, view: views } = parse_toml(path, text)?;
    if views.is_empty() {
        let (view, key) = (String::new(), "[[view]]");
        let reason = "there is none; give at least one".to_owned();
        return Err(ViewsError::Impossible { file: path.to_owned(), view, key, reason });
    }
    let mut described: Vec<ViewDescription> = Vec::with_capacity(views.len());
    for view in views {
        let view = describe(path, view)?;
        if described.iter().any(|other| other.name == view.name) {
            let reason = format!("`{}` is taken by a view above; give it a name of its own", view.name);
            return Err(impossible(path, &view.name, "name", reason));
        }
        described.push(view);
    }
    let keys = keys_of(path, keys, &described)?;
    Ok(Views { list: described, keys })
}

/// Volumes of key frames that views show.
fn keys_of(path: &Path, keys: Vec<FileKey>, views: &[ViewDescription]) -> Result<Vec<KeyVolume>, ViewsError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut all: Vec<KeyVolume> = Vec::with_capacity(keys.len());
    for FileKey { time, volume } in keys {
        let wrong = |reason: String| impossible(path, "", "[[key]] time", reason);
        if all.iter().any(|key| key.time == time) {
            return Err(wrong(format!("{time} has two volumes; give one")));
        }
        if views.iter().all(|view| view.time != Some(time)) {
            return Err(wrong(format!(
                "no view shows {time}; give a view this time, or leave the volume out"
            )));
        }
        all.push(KeyVolume { time, volume: folder.join(volume) });
    }
    Ok(all)
}

fn impossible(file: &Path, view: &str, key: &'static str, reason: impl Into<String>) -> ViewsError {
    ViewsError::Impossible { file: file.to_owned(), view: view.to_owned(), key, reason: reason.into() }
}

fn describe(path: &Path, of: FileView) -> Result<ViewDescription, ViewsError> {
    let FileView { name, size, time, target, weights, mask, depth, background, environment, camera } = of;
    let wrong = |key, reason: String| impossible(path, &name, key, reason);
    let plain = |letter: char| letter.is_ascii_alphanumeric() || letter == '-' || letter == '_';
    if name.is_empty() || !name.chars().all(plain) {
        return Err(wrong("name", format!("`{name}` is no name: give letters, digits, `-` and `_`")));
    }
    if !size.iter().all(|side| (1..=MAX_SIDE).contains(side)) {
        return Err(wrong("size", format!("{size:?} pixels are impossible: give 1 to {MAX_SIDE} a side")));
    }
    if let Some(time) = time.filter(|time| !time.is_finite()) {
        return Err(wrong("time", format!("{time} is impossible: give a finite number")));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let beside = |file: Option<PathBuf>| file.map(|file| folder.join(file));
    let background = match background {
        None => Background::Color(Vec3::ZERO),
        Some(FileBackground::Linear(color)) => {
            if !color.iter().all(|channel| channel.is_finite() && *channel >= 0.0) {
                let reason = format!("{color:?} is impossible: radiance must be finite and 0 or more");
                return Err(wrong("background", reason));
            }
            Background::Color(Vec3::from(color))
        }
        Some(FileBackground::Text(text)) if text.starts_with('#') => {
            let color = linear_from_hexadecimal(&text).ok_or_else(|| {
                wrong("background", format!("`{text}` is no colour: write \"#rrggbb\", or [R, G, B]"))
            })?;
            Background::Color(Vec3::from(color))
        }
        Some(FileBackground::Text(text)) => Background::Picture(folder.join(text)),
    };
    let view = view(path, &name, &camera)?;
    let described = ViewDescription {
        file: path.to_owned(),
        size,
        view,
        up: camera.up.map(Vec3::from),
        time,
        target: beside(target),
        weights: beside(weights),
        mask: beside(mask),
        depth: beside(depth),
        background,
        environment: beside(environment),
        name,
    };
    described.camera()?;
    Ok(described)
}

fn view(path: &Path, name: &str, camera: &FileCamera) -> Result<View, ViewsError> {
    let (eye, target) = (Vec3::from(camera.eye), Vec3::from(camera.target));
    let distance = eye.distance(target);
    let near = camera.near.unwrap_or(distance / PLANES);
    let far = camera.far.unwrap_or(distance * PLANES);
    let depth = DepthRange::Forward;
    match (camera.field_of_view, camera.height) {
        (Some(field_of_view), None) => {
            Ok(PerspectiveView { eye, target, field_of_view, near, far, depth }.into())
        }
        (None, Some(height)) => Ok(OrthographicView { eye, target, height, near, far, depth }.into()),
        (given, _) => {
            let both = if given.is_some() { "both are given" } else { "neither is given" };
            let reason = format!(
                "{both}; give field_of_view (degrees) for a perspective camera or height (metres) for parallel rays"
            );
            Err(impossible(path, name, "camera.field_of_view or camera.height", reason))
        }
    }
}

#[cfg(test)]
mod tests;
