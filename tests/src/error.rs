// SPDX-License-Identifier: MIT OR Apache-2.0
//! Error measures: how far values lie from a reference. All take any mix of f32 and f64 slices of
//! equal length and panic on unequal ones. A value that is not finite makes the mean measures NaN
//! or infinite and the greatest difference infinite, so that no comparison with a budget passes.

/// A number that an error measure accepts: f32 or f64.
pub trait Value: Copy + Into<f64> + Sync {}
impl<T: Copy + Into<f64> + Sync> Value for T {}

fn differences<'a, A: Value, B: Value>(
    values: &'a [A],
    reference: &'a [B],
) -> impl Iterator<Item = f64> + 'a {
    assert_eq!(values.len(), reference.len(), "values and reference differ in number");
    values.iter().zip(reference).map(|(&x, &r)| x.into() - r.into())
}

fn mean(sum: f64, count: usize) -> f64 {
    if count == 0 { 0.0 } else { sum / count as f64 }
}

/// Mean of `|x − r|`; 0 for no values.
#[must_use]
pub fn mean_absolute<A: Value, B: Value>(values: &[A], reference: &[B]) -> f64 {
    mean(differences(values, reference).map(f64::abs).sum(), values.len())
}

/// Greatest `|x − r|`, infinite where a difference is NaN.
#[must_use]
pub fn max_absolute<A: Value, B: Value>(values: &[A], reference: &[B]) -> f64 {
    differences(values, reference).map(magnitude).fold(0.0, f64::max)
}

/// Root of the mean of `(x − r)²`.
#[must_use]
pub fn rmse<A: Value, B: Value>(values: &[A], reference: &[B]) -> f64 {
    mean(differences(values, reference).map(|d| d * d).sum(), values.len()).sqrt()
}

/// `sqrt(mean (x − r)²) / sqrt(mean r²)`; 0 for two slices of zeros.
#[must_use]
pub fn relative_rmse<A: Value, B: Value>(values: &[A], reference: &[B]) -> f64 {
    let error = rmse(values, reference);
    let norm = mean(reference.iter().map(|&r| r.into() * r.into()).sum(), reference.len()).sqrt();
    if error == 0.0 { 0.0 } else { error / norm }
}

/// Peak signal-to-noise ratio in dB for signals of the range [0, `peak`]; infinite without error.
#[must_use]
pub fn psnr<A: Value, B: Value>(values: &[A], reference: &[B], peak: f64) -> f64 {
    20.0 * (peak / rmse(values, reference)).log10()
}

/// The texel of the greatest difference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worst {
    /// Position in the slices.
    pub index: usize,
    /// Column, for rows of the stated width.
    pub x: usize,
    /// Row.
    pub y: usize,
    /// The value there.
    pub value: f64,
    /// The reference there.
    pub reference: f64,
    /// `|value − reference|`, infinite where that is NaN.
    pub difference: f64,
}

impl std::fmt::Display for Worst {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "worst at ({}, {}), element {}: {} instead of {} (difference {:.3e})",
            self.x, self.y, self.index, self.value, self.reference, self.difference
        )
    }
}

/// The first texel of the greatest difference, for rows of `width` values; none for no values.
#[must_use]
pub fn worst<A: Value, B: Value>(values: &[A], reference: &[B], width: usize) -> Option<Worst> {
    let (index, difference) = differences(values, reference)
        .map(magnitude)
        .enumerate()
        .reduce(|best, next| if next.1 > best.1 { next } else { best })?;
    Some(Worst {
        index,
        x: index % width.max(1),
        y: index / width.max(1),
        value: values[index].into(),
        reference: reference[index].into(),
        difference,
    })
}

fn magnitude(difference: f64) -> f64 {
    if difference.is_nan() { f64::INFINITY } else { difference.abs() }
}

/// Luminance of scene-linear RGB with Rec. 709 primaries.
#[must_use]
pub fn luminance<T: Value>(rgb: [T; 3]) -> f64 {
    let [r, g, b] = rgb.map(Into::into);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Mean structural similarity of two luminance pictures (Wang, Bovik, Sheikh and Simoncelli 2004):
/// Gaussian windows of 11x11 with standard deviation 1.5 at every place where they fit,
/// `C1 = (0.01 range)²`, `C2 = (0.03 range)²`; 1 for equal pictures. Perceptually sensible for
/// display-encoded values, `range` being the greatest (1 or 255). Pictures narrower than the
/// window use the greatest odd window that fits.
///
/// # Panics
/// If the lengths are not `width * height`, or that is 0.
#[must_use]
pub fn ssim<A: Value, B: Value>(
    values: &[A],
    reference: &[B],
    width: usize,
    height: usize,
    range: f64,
) -> f64 {
    assert!(width > 0 && height > 0 && values.len() == width * height);
    assert_eq!(values.len(), reference.len(), "values and reference differ in number");
    let side = 11.min(width).min(height);
    let side = if side % 2 == 0 { side - 1 } else { side };
    let middle = (side / 2) as f64;
    let kernel: Vec<f64> =
        (0..side).map(|i| (-(i as f64 - middle).powi(2) / (2.0 * 1.5 * 1.5)).exp()).collect();
    let total: f64 = kernel.iter().sum();
    let kernel: Vec<f64> = kernel.iter().map(|k| k / total).collect();
    let (columns, rows) = (width - side + 1, height - side + 1);
    // Five moments, filtered along x and then along y.
    let along_x: Vec<[f64; 5]> = crate::parallel::rows(height, |y| {
        let filtered = |x: usize| {
            let mut moments = [0.0; 5];
            for (k, weight) in kernel.iter().enumerate() {
                let at = y * width + x + k;
                let (a, b): (f64, f64) = (values[at].into(), reference[at].into());
                for (sum, moment) in moments.iter_mut().zip([a, b, a * a, b * b, a * b]) {
                    *sum += weight * moment;
                }
            }
            moments
        };
        (0..columns).map(filtered).collect::<Vec<_>>()
    })
    .concat();
    let (c1, c2) = ((0.01 * range).powi(2), (0.03 * range).powi(2));
    let mut sum = 0.0;
    for y in 0..rows {
        for x in 0..columns {
            let mut m = [0.0; 5];
            for (k, weight) in kernel.iter().enumerate() {
                for (sum, moment) in m.iter_mut().zip(along_x[(y + k) * columns + x]) {
                    *sum += weight * moment;
                }
            }
            let [a, b, aa, bb, ab] = m;
            let (variance_a, variance_b, covariance) = (aa - a * a, bb - b * b, ab - a * b);
            sum += (2.0 * a * b + c1) * (2.0 * covariance + c2)
                / ((a * a + b * b + c1) * (variance_a + variance_b + c2));
        }
    }
    sum / (columns * rows) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_of_a_known_difference() {
        let reference = [3.0, 4.0, 0.0, 0.0_f64];
        let values = [3.0, 3.0, 0.0, 2.0_f32];
        assert_eq!(mean_absolute(&values, &reference), 0.75);
        assert_eq!(max_absolute(&values, &reference), 2.0);
        assert!((rmse(&values, &reference) - 1.25_f64.sqrt()).abs() < 1e-15);
        assert!((relative_rmse(&values, &reference) - (5.0_f64 / 25.0).sqrt()).abs() < 1e-15);
        assert!((psnr(&[0.9, 1.1], &[1.0, 1.0_f64], 1.0) - 20.0).abs() < 1e-9);
        let worst = worst(&values, &reference, 2).expect("four values");
        assert_eq!((worst.index, worst.x, worst.y), (3, 1, 1));
    }

    #[test]
    fn nan_passes_no_budget() {
        let values = [1.0, f64::NAN];
        assert_eq!(max_absolute(&values, &[1.0, 1.0_f32]), f64::INFINITY);
        assert!(mean_absolute(&values, &[1.0, 1.0_f32]).is_nan());
        assert_eq!(worst(&values, &[1.0, 1.0_f32], 2).map(|w| w.index), Some(1));
    }

    #[test]
    fn similarity_is_one_for_equal_and_falls_with_noise() {
        let picture: Vec<f64> = (0..32 * 24).map(|i| f64::from(i % 32) / 31.0).collect();
        let noisy = |amount: f64| -> Vec<f64> {
            let sign = |i: usize| if (i * 7919) % 13 < 6 { 1.0 } else { -1.0 };
            picture.iter().enumerate().map(|(i, v)| v + amount * sign(i)).collect()
        };
        assert!((ssim(&picture, &picture, 32, 24, 1.0) - 1.0).abs() < 1e-12);
        let little = ssim(&noisy(0.02), &picture, 32, 24, 1.0);
        let much = ssim(&noisy(0.2), &picture, 32, 24, 1.0);
        assert!(much < little && little < 1.0, "{much} {little}");
    }
}
