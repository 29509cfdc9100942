// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pictures of a view, as numbers a pixel.

use super::{Background, ViewDescription, ViewsError};
use crate::core::Camera;
use crate::formats::{PicturePixels, read_linear_picture, read_npy, read_picture_values};
use glam::Vec3;
use std::path::Path;

/// A view with its pictures; all have a value a pixel, rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedView {
    /// What the file says.
    pub description: ViewDescription,
    /// The camera.
    pub camera: Camera,
    /// The picture that is wanted: linear RGB radiance, finite.
    pub target: Option<Vec<Vec3>>,
    /// How much each pixel counts, 0 or more, times the alpha of the target; none where all count 1, and never all 0.
    pub weights: Option<Vec<f32>>,
    /// Where the medium may be seen.
    pub mask: Option<Vec<bool>>,
    /// Metres along each ray to where it ends, or infinity.
    pub depth: Option<Vec<f32>>,
    /// Radiance behind the medium, linear RGB, finite.
    pub background: Vec<Vec3>,
}

impl LoadedView {
    /// The target.
    ///
    /// # Errors
    /// [`ViewsError::NoTarget`].
    pub fn required_target(&self) -> Result<&[Vec3], ViewsError> {
        let (file, view) = (&self.description.file, &self.description.name);
        let missing = || ViewsError::NoTarget { file: file.clone(), view: view.clone() };
        self.target.as_deref().ok_or_else(missing)
    }
}

/// Reads the pictures of a view.
///
/// # Errors
/// [`ViewsError`]: a file that is missing, broken or of another size, numbers that are not finite, or weights of which all are zero.
pub fn load_view(description: &ViewDescription) -> Result<LoadedView, ViewsError> {
    let reader = Reader { of: description };
    let camera = description.camera()?;
    let (target, alpha) = match &description.target {
        None => (None, None),
        Some(path) => {
            let picture = reader.light("target", path)?;
            let alpha: Vec<f32> = picture.pixels.iter().map(|pixel| pixel[3]).collect();
            (Some(colors(&picture)), Some(alpha).filter(|alpha| alpha.iter().any(|alpha| *alpha != 1.0)))
        }
    };
    let given = match &description.weights {
        None => None,
        Some(path) => {
            let weights = reader.numbers("weights", path, true)?;
            let wrong = |weight: &f32| !(weight.is_finite() && *weight >= 0.0);
            reader.check("weights", path, &weights, "negative or not finite", wrong)?;
            reader.some("weights", path, &weights)?;
            Some(weights)
        }
    };
    let weights = match (given, alpha) {
        (Some(weights), Some(alpha)) => {
            Some(weights.iter().zip(&alpha).map(|(weight, alpha)| weight * alpha).collect())
        }
        (given, alpha) => given.or(alpha),
    };
    if let (Some(weights), Some(path)) = (&weights, &description.target) {
        reader.some("target", path, weights)?;
    }
    let mask = match &description.mask {
        None => None,
        Some(path) => {
            let coverage = reader.numbers("mask", path, true)?;
            reader.check("mask", path, &coverage, "not finite", |value| !value.is_finite())?;
            Some(coverage.into_iter().map(|value| value >= 0.5).collect())
        }
    };
    let depth = match &description.depth {
        None => None,
        Some(path) => {
            let depth = reader.numbers("depth", path, false)?;
            reader.check("depth", path, &depth, "negative or no number", |value| {
                value.is_nan() || *value < 0.0
            })?;
            Some(depth)
        }
    };
    let background = match &description.background {
        Background::Color(color) => vec![*color; reader.pixels()],
        Background::Picture(path) => colors(&reader.light("background", path)?),
    };
    Ok(LoadedView { description: description.clone(), camera, target, weights, mask, depth, background })
}

fn colors(picture: &PicturePixels) -> Vec<Vec3> {
    picture.pixels.iter().map(|[r, g, b, _]| Vec3::new(*r, *g, *b)).collect()
}

/// Reads what belongs to a view.
struct Reader<'a> {
    of: &'a ViewDescription,
}

impl Reader<'_> {
    fn pixels(&self) -> usize {
        self.of.size.iter().map(|side| *side as usize).product()
    }

    /// A picture of light of the view's size, finite.
    fn light(&self, key: &'static str, path: &Path) -> Result<PicturePixels, ViewsError> {
        let failed = |source| ViewsError::Picture { view: self.of.name.clone(), key, source };
        let picture = read_linear_picture(path).map_err(failed)?;
        self.fits(key, path, picture.size == self.of.size, || size_of(&picture))?;
        let wrong = |pixel: &[f32; 4]| !pixel.iter().all(|value| value.is_finite());
        self.check(key, path, &picture.pixels, "not finite", wrong)?;
        Ok(picture)
    }

    /// A number a pixel. `pictures`: whether it may be a picture of any kind, of which the mean of the channels, darkened by alpha, counts; of others the red
    /// of an .exr does.
    fn numbers(&self, key: &'static str, path: &Path, pictures: bool) -> Result<Vec<f32>, ViewsError> {
        let view = || self.of.name.clone();
        let ends = |ending: &str| path.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending));
        if ends("npy") {
            let array = read_npy(path).map_err(|source| ViewsError::Array { view: view(), key, source })?;
            let [width, height] = self.of.size.map(|side| side as usize);
            let shape = || format!("the shape {:?} instead of [HEIGHT, WIDTH]", array.shape);
            self.fits(key, path, array.shape == [height, width], shape)?;
            return Ok(array.to_f32());
        }
        if !pictures && !ends("exr") {
            let reason = "the format does not hold metres; give an .exr, or a .npy array [HEIGHT, WIDTH]";
            return Err(ViewsError::Format { view: view(), key, path: path.to_owned(), reason });
        }
        let failed = |source| ViewsError::Picture { view: view(), key, source };
        let picture = read_picture_values(path).map_err(failed)?;
        self.fits(key, path, picture.size == self.of.size, || size_of(&picture))?;
        let number = |[r, g, b, alpha]: &[f32; 4]| if pictures { (r + g + b) / 3.0 * alpha } else { *r };
        Ok(picture.pixels.iter().map(number).collect())
    }

    fn fits(
        &self,
        key: &'static str,
        path: &Path,
        fits: bool,
        found: impl Fn() -> String,
    ) -> Result<(), ViewsError> {
        if fits {
            return Ok(());
        }
        let (view, path) = (self.of.name.clone(), path.to_owned());
        Err(ViewsError::Size { view, key, path, found: found(), wanted: self.of.size })
    }

    /// That no value is wrong.
    fn check<T>(
        &self,
        key: &'static str,
        path: &Path,
        values: &[T],
        what: &'static str,
        wrong: impl Fn(&T) -> bool,
    ) -> Result<(), ViewsError> {
        let mut places = (0_u32..).zip(values).filter(|(_, value)| wrong(value)).map(|(place, _)| place);
        let Some(first) = places.next() else { return Ok(()) };
        let (x, y) = (first % self.of.size[0], first / self.of.size[0]);
        let (view, path) = (self.of.name.clone(), path.to_owned());
        Err(ViewsError::Values { view, key, path, count: 1 + places.count(), what, x, y })
    }

    /// That not all weights are zero.
    fn some(&self, key: &'static str, path: &Path, weights: &[f32]) -> Result<(), ViewsError> {
        if weights.iter().any(|weight| *weight > 0.0) {
            return Ok(());
        }
        Err(ViewsError::NoWeight { view: self.of.name.clone(), key, path: path.to_owned() })
    }
}

fn size_of(picture: &PicturePixels) -> String {
    format!("{}x{}", picture.size[0], picture.size[1])
}
