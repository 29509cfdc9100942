// SPDX-License-Identifier: MIT OR Apache-2.0
//! Snapshots of buffers and pictures through insta, with a stated tolerance.
//!
//! A buffer is text: a header (what it is, adapter, driver, shape, tolerance), then a line a row. On
//! the adapter that blessed it every value must be within the tolerance; on another one a stated share
//! of texels may be off (silhouettes fall on other pixels there). A picture is a PNG, compared by
//! structural similarity and
//! mean difference.
//!
//! `INSTA_UPDATE=always AIRLIGHT_BLESS=1` blesses whatever differs at all, and is refused where a
//! snapshot was blessed on another adapter or driver: delete the snapshots to move them.
#![allow(dead_code, clippy::unwrap_used)]

use crate::gpu::{gpu, note_snapshot};
use airlight::Texture;
use airlight_tests::error;
use insta::{Comparator, Settings, Snapshot, internals::SnapshotContents};
use std::fmt::Write;
use std::path::Path;

/// How much a buffer may differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Greatest difference of a value …
    pub absolute: f64,
    /// … plus this times the blessed value.
    pub relative: f64,
    /// Share of texels that may be further off on another adapter than the one that blessed.
    pub outliers: f64,
}

/// A buffer to be compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Buffer {
    /// Adapter and driver.
    pub adapter: String,
    /// Columns, rows, channels of a texel.
    pub shape: [usize; 3],
    /// What may differ.
    pub tolerance: Tolerance,
    /// Row-major, the channels of a texel together.
    pub values: Vec<f32>,
}

impl Buffer {
    /// As text. Values are written to a tenth of the tolerance.
    pub fn to_text(&self) -> String {
        let [columns, rows, channels] = self.shape;
        assert_eq!(self.values.len(), columns * rows * channels);
        let Tolerance { absolute, relative, outliers } = self.tolerance;
        let mut text = format!(
            "adapter: {}\nshape: {columns} columns, {rows} rows, {channels} channels\n\
             tolerance: {absolute} + {relative} of the value; outliers on another adapter: {outliers}\n",
            self.adapter
        );
        for row in self.values.chunks(columns * channels) {
            for (i, value) in row.iter().enumerate() {
                let space = if i == 0 { "" } else { " " };
                write!(text, "{space}{}", self.number(f64::from(*value))).unwrap();
            }
            text.push('\n');
        }
        text
    }

    /// The shortest number within a tenth of the tolerance.
    fn number(&self, value: f64) -> String {
        if !value.is_finite() {
            return value.to_string();
        }
        let fine = 0.1 * (self.tolerance.absolute + self.tolerance.relative * value.abs());
        let decimals = (0..12).find(|d| 0.5 * 10_f64.powi(-d) <= fine).unwrap_or(12) as usize;
        let text = format!("{value:.decimals$}");
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        match text {
            "-0" => "0".to_owned(),
            text => text.replacen("0.", ".", usize::from(text.starts_with("0.") || text.starts_with("-0."))),
        }
    }

    /// What [`Buffer::to_text`] wrote.
    pub fn from_text(text: &str) -> Option<Self> {
        let mut lines = text.lines();
        let adapter = lines.next()?.strip_prefix("adapter: ")?.to_owned();
        let numbers = |line: &str| -> Vec<f64> {
            line.split(|c: char| c.is_whitespace() || c == ';' || c == ',')
                .filter_map(|w| w.parse().ok())
                .collect()
        };
        let shape = numbers(lines.next()?.strip_prefix("shape: ")?);
        let tolerance = numbers(lines.next()?.strip_prefix("tolerance: ")?);
        let ([columns, rows, channels], [absolute, relative, outliers]) = (&shape[..], &tolerance[..]) else {
            return None;
        };
        let values: Option<Vec<f32>> =
            lines.flat_map(str::split_whitespace).map(|w| w.parse().ok()).collect();
        Some(Self {
            adapter,
            shape: [*columns as usize, *rows as usize, *channels as usize],
            tolerance: Tolerance { absolute: *absolute, relative: *relative, outliers: *outliers },
            values: values?,
        })
    }

    /// What is wrong with `self` where `blessed` is right: the worst texel. None within the tolerance
    /// that `self` states.
    pub fn difference(&self, blessed: &Self) -> Option<String> {
        if self.shape != blessed.shape || self.values.len() != blessed.values.len() {
            return Some(format!("the shape is {:?} instead of {:?}", self.shape, blessed.shape));
        }
        let [columns, _, channels] = self.shape;
        // In units of the tolerance; rounding of the text takes up to a tenth on either side.
        let excess: Vec<f64> = self
            .values
            .iter()
            .zip(&blessed.values)
            .map(|(new, old)| {
                let (new, old) = (f64::from(*new), f64::from(*old));
                if new == old || (new.is_nan() && old.is_nan()) {
                    return 0.0;
                }
                let budget = self.tolerance.absolute + self.tolerance.relative * old.abs();
                let excess = (new - old).abs() / (1.2 * budget);
                if excess.is_nan() { f64::INFINITY } else { excess }
            })
            .collect();
        let off = excess.chunks(channels).filter(|texel| texel.iter().any(|e| *e > 1.0)).count();
        let texels = self.values.len() / channels;
        let allowed = if self.adapter == blessed.adapter { 0.0 } else { self.tolerance.outliers };
        if off as f64 <= allowed * texels as f64 {
            return None;
        }
        let worst = (0..excess.len()).max_by(|a, b| excess[*a].total_cmp(&excess[*b]))?;
        let texel = worst / channels;
        let at = [texel % columns, texel / columns];
        let range = texel * channels..(texel + 1) * channels;
        Some(format!(
            "{off} of {texels} texels are off ({:.3} allowed); the worst is ({}, {}), channel {}: {:?} instead of {:?}, \
             {:.1} times the tolerance",
            allowed,
            at[0],
            at[1],
            worst % channels,
            &self.values[range.clone()],
            &blessed.values[range],
            excess[worst]
        ))
    }
}

/// A picture, 8 bits, RGBA.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height.
    pub size: [u32; 2],
    /// Row-major.
    pub pixels: Vec<u8>,
}

impl Picture {
    /// As a PNG.
    pub fn to_png(&self) -> Vec<u8> {
        let image = image::RgbaImage::from_raw(self.size[0], self.size[1], self.pixels.clone()).unwrap();
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    /// What [`Picture::to_png`] wrote.
    pub fn from_png(bytes: &[u8]) -> Option<Self> {
        let image = image::load_from_memory_with_format(bytes, image::ImageFormat::Png).ok()?.into_rgba8();
        Some(Self { size: [image.width(), image.height()], pixels: image.into_raw() })
    }

    /// Structural similarity of the luminance of the encoded values, and the mean difference of all
    /// values in steps of 1/255: a picture that is brighter throughout keeps its structure.
    pub fn similarity(&self, other: &Self) -> (f64, f64) {
        if self.size != other.size {
            return (0.0, 255.0);
        }
        let grey = |picture: &Self| -> Vec<f64> {
            picture.pixels.chunks_exact(4).map(|p| error::luminance([p[0], p[1], p[2]])).collect()
        };
        let [width, height] = self.size.map(|side| side as usize);
        let structure = error::ssim(&grey(self), &grey(other), width, height, 255.0);
        (structure, error::mean_absolute(&self.pixels, &other.pixels))
    }
}

/// What a run may do with snapshots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Compare with tolerance.
    Compare,
    /// Replace whatever differs at all.
    Bless,
}

/// The mode from the environment, or why it is refused. `update`: `INSTA_UPDATE`; `bless`:
/// `AIRLIGHT_BLESS`; `recorded`: the adapter of the blessed snapshot, if there is one.
pub fn mode(
    update: Option<&str>,
    bless: Option<&str>,
    recorded: Option<&str>,
    adapter: &str,
) -> Result<Mode, String> {
    let writes = matches!(update, Some("always" | "1" | "force" | "unseen"));
    let blesses = bless.is_some_and(|value| !value.is_empty() && value != "0");
    match (writes, blesses) {
        (false, false) => Ok(Mode::Compare),
        (true, false) => {
            Err("INSTA_UPDATE alone would bless within no tolerance: run `make bless`".to_owned())
        }
        (false, true) => Err("AIRLIGHT_BLESS needs INSTA_UPDATE=always: run `make bless`".to_owned()),
        (true, true) => match recorded {
            Some(recorded) if recorded != adapter => Err(format!(
                "refused: blessed on {recorded}, and this is {adapter}; delete tests/tests/snapshots to move all of them"
            )),
            _ => Ok(Mode::Bless),
        },
    }
}

#[derive(Clone)]
struct Tolerant {
    mode: Mode,
    /// Least structural similarity of pictures.
    similarity: f64,
}

impl Comparator for Tolerant {
    fn matches(&self, blessed: &Snapshot, new: &Snapshot) -> bool {
        let difference = match (blessed.contents(), new.contents()) {
            (SnapshotContents::Text(old), SnapshotContents::Text(text)) => {
                let (old, text) = (old.to_string(), text.to_string());
                if self.mode == Mode::Bless {
                    return old == text;
                }
                match (Buffer::from_text(&old), Buffer::from_text(&text)) {
                    (Some(old), Some(new)) => new.difference(&old),
                    _ => Some("the snapshot cannot be read".to_owned()),
                }
            }
            (SnapshotContents::Binary(Some(old)), SnapshotContents::Binary(Some(new))) => {
                if self.mode == Mode::Bless {
                    return old == new;
                }
                match (Picture::from_png(old), Picture::from_png(new)) {
                    (Some(old), Some(new)) => {
                        let (structure, mean) = new.similarity(&old);
                        (structure < self.similarity || mean > 1.0).then(|| {
                            format!(
                                "structural similarity {structure:.4} (at least {}), mean difference {mean:.2} of 255 (at \
                                 most 1)",
                                self.similarity
                            )
                        })
                    }
                    _ => Some("the picture cannot be read".to_owned()),
                }
            }
            _ => Some("there is no blessed snapshot of this kind".to_owned()),
        };
        if let Some(difference) = &difference {
            eprintln!("{}: {difference}", new.snapshot_name().unwrap_or("snapshot"));
        }
        difference.is_none()
    }

    fn dyn_clone(&self) -> Box<dyn Comparator> {
        Box::new(self.clone())
    }
}

/// The adapter that a blessed snapshot was made on: a buffer's header or a picture's description.
fn recorded(name: &str) -> Option<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots").join(format!("{name}.snap"));
    let text = std::fs::read_to_string(path).ok()?;
    let line = text.lines().find_map(|line| {
        line.strip_prefix("adapter: ")
            .or_else(|| line.strip_prefix("description: "))
            .map(|l| l.trim_matches('"'))
    });
    line.map(str::to_owned)
}

fn bound(name: &str, adapter: &str, similarity: f64, check: impl FnOnce()) {
    let variable = |name: &str| std::env::var(name).ok();
    let (update, bless) = (variable("INSTA_UPDATE"), variable("AIRLIGHT_BLESS"));
    let mode = match mode(update.as_deref(), bless.as_deref(), recorded(name).as_deref(), adapter) {
        Ok(mode) => mode,
        Err(message) => panic!("{name}: {message}"),
    };
    let mut settings = Settings::new();
    settings.set_snapshot_path(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_description(adapter);
    settings.set_comparator(Box::new(Tolerant { mode, similarity }));
    settings.bind(check);
}

/// A tolerance of these parts.
pub fn tolerance(absolute: f64, relative: f64, outliers: f64) -> Tolerance {
    Tolerance { absolute, relative, outliers }
}

/// Layer `layer` of a texture, the first `keep` channels of each texel.
pub fn buffer(texture: &Texture, layer: usize, keep: usize, tolerance: Tolerance) -> Buffer {
    let values = texture.read(gpu()).unwrap();
    let [columns, rows, layers] = texture.size().map(|side| side as usize);
    let channels = values.len() / (columns * rows * layers);
    let values = values[layer * columns * rows * channels..][..columns * rows * channels]
        .chunks_exact(channels)
        .flat_map(|texel| texel[..keep].to_vec())
        .collect();
    Buffer { adapter: gpu().description(), shape: [columns, rows, keep], tolerance, values }
}

/// Compares a buffer with its snapshot.
pub fn assert_buffer(name: &str, buffer: &Buffer) {
    let text = buffer.to_text();
    note_snapshot(name);
    bound(name, &buffer.adapter, 1.0, || insta::assert_snapshot!(name, text));
}

/// Compares a picture with its snapshot: at least the stated structural similarity.
pub fn assert_picture(name: &str, adapter: &str, picture: &Picture, similarity: f64) {
    let file = format!("{name}.png");
    let bytes = picture.to_png();
    note_snapshot(name);
    bound(name, adapter, similarity, || insta::assert_binary_snapshot!(&file, bytes));
}
