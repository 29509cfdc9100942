// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions as TOML files.

mod fields;

use super::description::{
    NO_CONSTRAINTS, NO_LAYERS, wrong_color, wrong_cosine, wrong_factor, wrong_limit, wrong_position,
    wrong_share, wrong_size,
};
use super::{
    Blend, Color, Constraint, Keyed, Layer, Mode, Phase, Place, RayProperty, Source, Transfer, TransferError,
    TransferImage, TransferSettings,
};
use crate::data::{linear_from_hexadecimal, linear_from_srgb};
use fields::{Document, Fields};
use glam::{Vec2, Vec3, Vec4};
use std::path::Path;

const SETTINGS: [&str; 9] = ["size", "x", "y", "mode", "phase", "depth_limit", "strength", "brightness", "g"];
const PROPERTIES: [(&str, RayProperty); 5] = [
    ("visibility", RayProperty::Visibility),
    ("depth", RayProperty::Depth),
    ("light-angle", RayProperty::LightAngle),
    ("picture-angle", RayProperty::PictureAngle),
    ("visible-depth", RayProperty::VisibleDepth),
];
const MODES: [(&str, Mode); 3] =
    [("replace", Mode::Replace), ("light", Mode::Light), ("scattering", Mode::Scattering)];
const PHASES: [(&str, Phase); 2] =
    [("constant", Phase::Constant), ("henyey-greenstein", Phase::HenyeyGreenstein)];
const BLENDS: [(&str, Blend); 3] =
    [("over", Blend::Over), ("multiply", Blend::Multiply), ("add", Blend::Add)];
/// Texels a side where a file does not say.
const SIZE: u32 = 256;

/// Reads a transfer function, key-framed or not. Paths in it are relative to its own folder.
///
/// # Errors
/// [`TransferError::Unreadable`]; [`TransferError::File`] with line, column and key.
pub fn read_transfer(path: impl AsRef<Path>) -> Result<Keyed<Transfer>, TransferError> {
    let path = path.as_ref();
    let unreadable = |source| TransferError::Unreadable { path: path.to_owned(), source };
    parse_transfer(path, &std::fs::read_to_string(path).map_err(unreadable)?)
}

/// Like [`read_transfer`] for a text. `path`: where it lies, for errors and for the paths in it.
///
/// # Errors
/// [`TransferError::File`] with line, column and key.
pub fn parse_transfer(path: impl AsRef<Path>, text: &str) -> Result<Keyed<Transfer>, TransferError> {
    let document = Document { path: path.as_ref(), text };
    let root = document.parse()?;
    let top = Fields::new(&document, "", 0, root.get_ref());
    if !top.has("key") {
        let (known, settings, size) = (with(&["layer"]), TransferSettings::default(), SIZE);
        return Ok(Keyed::constant(transfer(&top, &known, settings, size)?));
    }
    top.only(&with(&["key"]))?;
    let (size, settings) = (size(&top, SIZE)?, settings(&top, TransferSettings::default())?);
    let mut keys: Vec<(f32, Transfer)> = Vec::new();
    for key in top.tables("key")? {
        let (frame, at) = key.required("frame", Fields::number)?;
        let (frame, of) = (
            frame as f32,
            if key.has("file") {
                file(&key)?
            } else {
                transfer(&key, &with(&["frame", "layer"]), settings, size)?
            },
        );
        if !frame.is_finite() || keys.last().is_some_and(|(before, _)| *before >= frame) {
            let reason = format!("frame {frame} is impossible: frames must be finite and ascend");
            return Err(key.error("frame", at, reason));
        }
        if let Some((_, first)) = keys.first().filter(|(_, first)| first.size != of.size) {
            let reason = format!(
                "{} texels a side, and {} before: key frames need the same size",
                of.size, first.size
            );
            return Err(key.error(if key.has("file") { "file" } else { "size" }, at, reason));
        }
        keys.push((frame, of));
    }
    Keyed::new(keys)
}

/// The keys of settings and some more.
fn with(more: &[&'static str]) -> Vec<&'static str> {
    SETTINGS.iter().copied().chain(more.iter().copied()).collect()
}

/// A key frame whose function is a file of its own.
fn file(key: &Fields<'_, '_>) -> Result<Transfer, TransferError> {
    key.only(&["frame", "file"])?;
    let (name, at) = key.required("file", Fields::text)?;
    let path = key.document.beside(&name);
    let text = std::fs::read_to_string(&path)
        .map_err(|error| key.error("file", at, format!("{} cannot be read: {error}", path.display())))?;
    let document = Document { path: &path, text: &text };
    let root = document.parse()?;
    let top = Fields::new(&document, "", 0, root.get_ref());
    if top.has("key") {
        let reason = format!("{} has key frames itself: a key frame needs a plain function", path.display());
        return Err(key.error("file", at, reason));
    }
    transfer(&top, &with(&["layer"]), TransferSettings::default(), SIZE)
}

fn transfer(
    of: &Fields<'_, '_>,
    known: &[&'static str],
    defaults: TransferSettings,
    default_size: u32,
) -> Result<Transfer, TransferError> {
    of.only(known)?;
    let (size, settings) = (size(of, default_size)?, settings(of, defaults)?);
    let layers = of.tables("layer")?.iter().map(layer).collect::<Result<Vec<_>, _>>()?;
    if layers.is_empty() {
        return Err(of.error("layer", of.at, NO_LAYERS.to_owned()));
    }
    Ok(Transfer { size, settings, layers })
}

fn size(of: &Fields<'_, '_>, default: u32) -> Result<u32, TransferError> {
    let Some((size, at)) = of.whole("size")? else { return Ok(default) };
    of.refuse("size", at, wrong_size(size))?;
    Ok(size as u32)
}

fn settings(of: &Fields<'_, '_>, defaults: TransferSettings) -> Result<TransferSettings, TransferError> {
    let number = |key, wrong: fn(f64) -> Option<String>| of.checked(key, wrong);
    Ok(TransferSettings {
        across: of.choice("x", &PROPERTIES)?.unwrap_or(defaults.across),
        down: of.choice("y", &PROPERTIES)?.unwrap_or(defaults.down),
        mode: of.choice("mode", &MODES)?.unwrap_or(defaults.mode),
        phase: of.choice("phase", &PHASES)?.unwrap_or(defaults.phase),
        depth_limit: number("depth_limit", wrong_limit)?.or(defaults.depth_limit),
        strength: number("strength", wrong_share)?.unwrap_or(defaults.strength),
        brightness: number("brightness", wrong_factor)?.unwrap_or(defaults.brightness),
        g: number("g", wrong_cosine)?.or(defaults.g),
    })
}

fn layer(of: &Fields<'_, '_>) -> Result<Layer, TransferError> {
    let kinds = [("solid", 0), ("gradient", 1), ("image", 2), ("diffusion", 3)];
    let kind = of.choice("kind", &kinds)?.ok_or_else(|| of.missing("kind"))?;
    let own: &[&str] = match kind {
        0 => &["color", "alpha"],
        1 => &["from", "to"],
        2 => &["file"],
        _ => &["constraint"],
    };
    of.only(&["kind", "blend", "opacity"].iter().chain(own).copied().collect::<Vec<_>>())?;
    let source = match kind {
        0 => Source::Solid(color(of)?),
        1 => Source::Gradient([end(of, "from")?, end(of, "to")?]),
        2 => Source::Image(image(of)?),
        _ => {
            let constraints =
                of.tables("constraint")?.iter().map(constraint).collect::<Result<Vec<_>, _>>()?;
            if constraints.is_empty() {
                return Err(of.error("constraint", of.at, NO_CONSTRAINTS.to_owned()));
            }
            Source::Diffusion(constraints)
        }
    };
    let blend = of.choice("blend", &BLENDS)?.unwrap_or(Blend::Over);
    Ok(Layer { source, blend, opacity: of.checked("opacity", wrong_share)?.unwrap_or(1.0) })
}

fn color(of: &Fields<'_, '_>) -> Result<Color, TransferError> {
    let alpha = of.checked("alpha", wrong_share)?.unwrap_or(1.0);
    let (rgb, at) = if of.is_text("color") {
        let (text, at) = of.required("color", Fields::text)?;
        let rgb = linear_from_hexadecimal(&text).map(|rgb| rgb.map(f64::from)).ok_or_else(|| {
            let reason = format!(
                "`{text}` is no colour: write \"#rrggbb\" (sRGB) or [red, green, blue] (linear, 0..1)"
            );
            of.error("color", at, reason)
        })?;
        (rgb, at)
    } else {
        of.required("color", Fields::numbers::<3>)?
    };
    of.refuse("color", at, wrong_color(&rgb))?;
    Ok(Color { rgb: vector(rgb), alpha })
}

fn vector(of: [f64; 3]) -> Vec3 {
    Vec3::from(of.map(|value| value as f32))
}

fn position(of: &Fields<'_, '_>) -> Result<Vec2, TransferError> {
    let (position, at) = of.required("at", Fields::numbers::<2>)?;
    of.refuse("at", at, wrong_position(&position))?;
    Ok(Vec2::from(position.map(|value| value as f32)))
}

fn end(of: &Fields<'_, '_>, key: &'static str) -> Result<(Vec2, Color), TransferError> {
    let end = of.table(key)?.ok_or_else(|| of.missing(key))?;
    end.only(&["at", "color", "alpha"])?;
    Ok((position(&end)?, color(&end)?))
}

fn constraint(of: &Fields<'_, '_>) -> Result<Constraint, TransferError> {
    of.only(&["at", "pixel", "point", "follow", "color", "alpha"])?;
    let given: Vec<_> = ["at", "pixel", "point"].into_iter().filter(|key| of.has(key)).collect();
    let place = match given[..] {
        ["at"] => Place::At(position(of)?),
        ["pixel"] => {
            let (pixel, at) = of.required("pixel", Fields::numbers::<2>)?;
            let fits = pixel.iter().all(|value| value.fract() == 0.0 && (0.0..=1e6).contains(value));
            let wrong = format!("{pixel:?} is no pixel: column and row are whole numbers from 0 on");
            of.refuse("pixel", at, (!fits).then_some(wrong))?;
            Place::Pixel(pixel.map(|value| value as u32))
        }
        ["point"] => {
            let (point, at) = of.required("point", Fields::numbers::<3>)?;
            let wrong =
                (!vector(point).is_finite()).then(|| format!("{point:?} is no point: metres must be finite"));
            of.refuse("point", at, wrong)?;
            let follow = of.text("follow")?.map(|(name, _)| name);
            return Ok(Constraint {
                place: Place::Point { point: vector(point), follow },
                color: color(of)?,
            });
        }
        _ => {
            let reason = "a constraint needs one of `at`, `pixel` and `point`, and no two of them";
            return Err(of.error(given.last().copied().unwrap_or("at"), of.at, reason.to_owned()));
        }
    };
    if of.has("follow") {
        let reason = "only a constraint with `point` can follow an object";
        return Err(of.error("follow", of.at, reason.to_owned()));
    }
    Ok(Constraint { place, color: color(of)? })
}

/// Straight alpha and sRGB in a .png; linear and premultiplied in an .exr, as these formats have it.
fn image(of: &Fields<'_, '_>) -> Result<TransferImage, TransferError> {
    let (name, at) = of.required("file", Fields::text)?;
    let path = of.document.beside(&name);
    let failed = |reason: String| {
        of.error("file", at, format!("{}: {reason}; a .png or .exr picture is needed", path.display()))
    };
    let linear = match path.extension().map(|e| e.to_string_lossy().to_lowercase()).as_deref() {
        Some("png") => false,
        Some("exr") => true,
        _ => return Err(failed("its name ends in neither .png nor .exr".to_owned())),
    };
    let picture = image::open(&path).map_err(|error| failed(error.to_string()))?.into_rgba32f();
    let clean = |value: f32, most: f32| if value.is_finite() { value.clamp(0.0, most) } else { 0.0 };
    let texels = picture.pixels().map(|pixel| {
        let [r, g, b, alpha] = pixel.0;
        let alpha = clean(alpha, 1.0);
        let channel = |value| if linear { clean(value, 65504.0) } else { linear_from_srgb(value) * alpha };
        Vec4::new(channel(r), channel(g), channel(b), alpha)
    });
    Ok(TransferImage { size: [picture.width(), picture.height()], texels: texels.collect() })
}
