// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pictures of a section on disk, and the contact sheet of them.

use crate::command::CommandError;
use crate::formats::{create_folder, write_animation, write_png, write_whole};
use image::RgbaImage;
use image::imageops::{FilterType, replace, resize};
use std::path::{Path, PathBuf};

/// Width of a picture in a contact sheet, pixels.
const TILE: u32 = 476;
/// Pixels between the pictures of a contact sheet.
const GAP: u32 = 4;

/// A section of the page.
pub struct Section {
    /// Folder of its pictures, relative to the page.
    pub folder: String,
    /// Its heading.
    pub title: String,
    /// A paragraph below.
    pub about: String,
    /// Pictures side by side; none leaves that to the page.
    pub columns: Option<u32>,
    /// File name in the folder and caption; the first picture is shown large.
    pub pictures: Vec<(String, String)>,
    /// Lines of a table: what, and its value.
    pub facts: Vec<(String, String)>,
}

/// A section while its pictures are made.
pub struct Album {
    path: PathBuf,
    section: Section,
    tiles: Vec<RgbaImage>,
}

impl Album {
    /// An album without pictures in `folder` of the gallery at `out`.
    pub fn new(out: &Path, folder: &str, title: String, about: String) -> Result<Self, CommandError> {
        let path = out.join(folder);
        create_folder(&path).map_err(|error| CommandError::Failure(format!("--out: {error}")))?;
        let section = Section {
            folder: folder.to_owned(),
            title,
            about,
            columns: None,
            pictures: Vec::new(),
            facts: Vec::new(),
        };
        Ok(Self { path, section, tiles: Vec::new() })
    }

    /// Writes a picture, 1 or 4 bytes a pixel.
    pub fn add(
        &mut self,
        file: impl Into<String>,
        caption: impl Into<String>,
        [width, height]: [u32; 2],
        pixels: &[u8],
    ) -> Result<(), CommandError> {
        let file = file.into();
        write_png(self.path.join(&file), width, height, pixels).map_err(CommandError::failure)?;
        self.section.pictures.push((file, caption.into()));
        Ok(())
    }

    /// Writes a picture, 4 bytes a pixel, which the contact sheet shows too.
    pub fn add_tile(
        &mut self,
        file: impl Into<String>,
        caption: impl Into<String>,
        size: [u32; 2],
        pixels: &[u8],
    ) -> Result<(), CommandError> {
        self.add(file, caption, size, pixels)?;
        let [width, height] = size;
        if let Some(picture) = RgbaImage::from_raw(width, height, pixels.to_vec()) {
            let tile = [TILE, (TILE * height).div_ceil(width).max(1)];
            self.tiles.push(resize(&picture, tile[0], tile[1], FilterType::CatmullRom));
        }
        Ok(())
    }

    /// Writes a drawing, the text of an SVG file.
    pub fn add_drawing(
        &mut self,
        file: impl Into<String>,
        caption: impl Into<String>,
        drawing: &str,
    ) -> Result<(), CommandError> {
        let file = file.into();
        write_whole(self.path.join(&file), |writer| writer.write_all(drawing.as_bytes()))
            .map_err(CommandError::failure)?;
        self.section.pictures.push((file, caption.into()));
        Ok(())
    }

    /// Writes an animated picture, 4 bytes a pixel and `rate` frames a second.
    pub fn add_animation(
        &mut self,
        file: impl Into<String>,
        caption: impl Into<String>,
        [width, height]: [u32; 2],
        frames: &[Vec<u8>],
        rate: u16,
    ) -> Result<(), CommandError> {
        let file = file.into();
        write_animation(self.path.join(&file), width, height, frames.iter().map(Ok), [1, rate])
            .map_err(CommandError::failure)?;
        self.section.pictures.push((file, caption.into()));
        Ok(())
    }

    /// Adds a line to the table.
    pub fn fact(&mut self, what: impl Into<String>, value: impl Into<String>) {
        self.section.facts.push((what.into(), value.into()));
    }

    /// The section.
    pub fn finish(self) -> Section {
        self.section
    }

    /// The section, led by a contact sheet of its tiles, `columns` to a row.
    pub fn finish_with_sheet(mut self, columns: u32, caption: &str) -> Result<Section, CommandError> {
        let sheet = contact_sheet(&self.tiles, columns);
        let size = [sheet.width(), sheet.height()];
        self.add("sheet.png", caption, size, sheet.as_raw())?;
        self.section.pictures.rotate_right(1);
        self.section.columns = Some(columns);
        Ok(self.section)
    }
}

/// Tiles of one size in rows, from the top left on.
fn contact_sheet(tiles: &[RgbaImage], columns: u32) -> RgbaImage {
    let (width, height) = tiles.first().map_or((1, 1), RgbaImage::dimensions);
    let rows = (tiles.len() as u32).div_ceil(columns).max(1);
    let background = image::Rgba([21, 23, 26, 255]);
    let mut sheet =
        RgbaImage::from_pixel(columns * (width + GAP) - GAP, rows * (height + GAP) - GAP, background);
    for (index, tile) in tiles.iter().enumerate() {
        let (column, row) = (index as u32 % columns, index as u32 / columns);
        replace(&mut sheet, tile, i64::from(column * (width + GAP)), i64::from(row * (height + GAP)));
    }
    sheet
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_lie_in_rows() {
        let tile = |value| RgbaImage::from_pixel(6, 4, image::Rgba([value, value, value, 255]));
        let sheet = contact_sheet(&[tile(1), tile(2), tile(3)], 2);
        assert_eq!(sheet.dimensions(), (12 + GAP, 8 + GAP));
        assert_eq!(sheet.get_pixel(0, 0).0[0], 1);
        assert_eq!(sheet.get_pixel(6 + GAP, 3).0[0], 2);
        assert_eq!(sheet.get_pixel(5, 4 + GAP).0[0], 3);
        assert_eq!(sheet.get_pixel(6 + GAP, 4 + GAP).0, [21, 23, 26, 255]);
        assert_eq!(contact_sheet(&[], 4).height(), 1);
    }
}
