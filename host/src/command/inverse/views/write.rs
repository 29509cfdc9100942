// SPDX-License-Identifier: MIT OR Apache-2.0
//! Views with their pictures, to be painted on.

use super::{
    Background, File, FileBackground, FileCamera, FileKey, FileView, KeyVolume, ViewDescription, ViewsError,
};
use crate::core::View;
use crate::data::srgb_from_linear;
use crate::formats::{WriteError, write_exr, write_png, write_whole};
use glam::Vec3;
use std::io;
use std::path::{Path, PathBuf};

/// First lines of the file.
const HEAD: &str = "\
# Views to paint on: change the .png of a view (sRGB) and solve for what looks so.
# The .exr beside it holds the radiance as it was rendered, linear and unclipped; `target` may name it instead.

";

/// What was written of a view.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenView {
    /// The picture to paint on.
    pub png: PathBuf,
    /// The radiance.
    pub exr: PathBuf,
    /// Pixels brighter than a .png holds, which are white or clipped in it.
    pub clipped: usize,
}

/// Writes `views.toml` into a folder, with a .png and an .exr a view, named after it: linear RGB radiance, a value a pixel. Each file whole
/// or not at all, and `views.toml` last, so that what it names is there. `keys`: volumes of key frames, which stay where they are. The pictures become the targets; other files of the views stay
/// where they are.
///
/// # Errors
/// [`ViewsError::Write`]; the folder is not created.
pub fn write_views(
    folder: impl AsRef<Path>,
    views: &[(&ViewDescription, &[Vec3])],
    keys: &[KeyVolume],
) -> Result<Vec<WrittenView>, ViewsError> {
    let folder = folder.as_ref();
    let file = folder.join("views.toml");
    let text = toml::to_string(&File {
        key: keys.iter().map(file_key).collect::<Result<_, _>>()?,
        view: views.iter().map(|(view, _)| file_view(view)).collect::<Result<_, _>>()?,
    });
    let text = text.map_err(|error| WriteError::Data { path: file.clone(), reason: error.to_string() })?;
    let mut written = Vec::with_capacity(views.len());
    for (view, radiance) in views {
        let (png, exr) = (folder.join(png_name(view)), folder.join(format!("{}.exr", view.name)));
        let [width, height] = view.size;
        let values: Vec<f32> = radiance.iter().flat_map(|color| color.to_array()).collect();
        write_exr(&exr, width, height, &values)?;
        // The cast saturates, and what is no number becomes 0.
        let encode = |value: &f32| (255.0 * srgb_from_linear(value.max(0.0)) + 0.5) as u8;
        write_png(&png, width, height, &values.iter().map(encode).collect::<Vec<_>>())?;
        let clipped = radiance.iter().filter(|color| color.max_element() > 1.0).count();
        written.push(WrittenView { png, exr, clipped });
    }
    write_whole(&file, |writer| {
        io::Write::write_all(writer, HEAD.as_bytes())?;
        io::Write::write_all(writer, text.as_bytes())
    })?;
    Ok(written)
}

fn png_name(view: &ViewDescription) -> String {
    format!("{}.png", view.name)
}

/// Where the folder of the new file does not matter.
fn absolute(path: &PathBuf) -> Result<PathBuf, WriteError> {
    std::path::absolute(path).map_err(|source| WriteError::File { path: path.clone(), source })
}

fn file_key(of: &KeyVolume) -> Result<FileKey, ViewsError> {
    Ok(FileKey { time: of.time, volume: absolute(&of.volume)? })
}

fn file_view(of: &ViewDescription) -> Result<FileView, ViewsError> {
    let elsewhere = |path: &Option<PathBuf>| path.as_ref().map(absolute).transpose();
    let (field_of_view, height, near, far) = match of.view {
        View::Perspective(view) => (Some(view.field_of_view), None, view.near, view.far),
        View::Orthographic(view) => (None, Some(view.height), view.near, view.far),
    };
    Ok(FileView {
        name: of.name.clone(),
        size: of.size,
        time: of.time,
        target: Some(png_name(of).into()),
        weights: elsewhere(&of.weights)?,
        mask: elsewhere(&of.mask)?,
        depth: elsewhere(&of.depth)?,
        background: Some(match &of.background {
            Background::Color(color) => FileBackground::Linear(color.to_array()),
            Background::Picture(path) => FileBackground::Text(absolute(path)?.display().to_string()),
        }),
        environment: elsewhere(&of.environment)?,
        camera: FileCamera {
            eye: of.view.eye().to_array(),
            target: of.view.target().to_array(),
            up: of.up.map(|up| up.to_array()),
            field_of_view,
            height,
            near: Some(near),
            far: Some(far),
        },
    })
}
