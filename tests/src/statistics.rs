// SPDX-License-Identifier: MIT OR Apache-2.0
//! Means, and tests of samples against an expectation with the confidence stated.

/// The arithmetic mean; NaN for no values.
#[must_use]
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The median, for an even number the mean of the two in the middle; NaN for no values.
#[must_use]
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    match sorted.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => sorted[n / 2],
        n => 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]),
    }
}

/// The unbiased variance of a sample; NaN for fewer than two values.
#[must_use]
pub fn variance(values: &[f64]) -> f64 {
    let mean = mean(values);
    let sum: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    if values.len() < 2 { f64::NAN } else { sum / (values.len() - 1) as f64 }
}

/// Outcome of a two-sided test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Test {
    /// Deviation from the expectation in standard deviations.
    pub z: f64,
    /// Probability of a deviation at least as great, were the expectation true.
    pub p: f64,
}

impl Test {
    /// Whether the sample agrees with the expectation at `confidence` in (0, 1): a true expectation
    /// is rejected with the probability `1 − confidence`. Never for a deviation that is NaN.
    #[must_use]
    pub fn accepts(&self, confidence: f64) -> bool {
        self.p >= 1.0 - confidence
    }

    fn of(deviation: f64, sigma: f64) -> Self {
        let z = if deviation == 0.0 { 0.0 } else { deviation / sigma };
        Self { z, p: two_sided(z) }
    }
}

/// `successes` of `trials` against the probability `expected`, by the normal approximation with
/// continuity correction: fit for `trials * expected * (1 − expected)` of ten and more.
#[must_use]
pub fn binomial(successes: u64, trials: u64, expected: f64) -> Test {
    let n = trials as f64;
    let deviation = successes as f64 - n * expected;
    let corrected = deviation.signum() * (deviation.abs() - 0.5).max(0.0);
    Test::of(corrected, (n * expected * (1.0 - expected)).sqrt())
}

/// The mean of a sample against `expected`, by the normal approximation with the sample's own
/// variance: fit for thirty values and more.
#[must_use]
pub fn sample_mean(values: &[f64], expected: f64) -> Test {
    let sigma = (variance(values) / values.len() as f64).sqrt();
    Test::of(mean(values) - expected, sigma)
}

/// Probability that a standard normal variable deviates from 0 by at least `|z|`.
#[must_use]
pub fn two_sided(z: f64) -> f64 {
    let x = z.abs() / std::f64::consts::SQRT_2;
    if x < 2.5 {
        // erf by its series, all terms positive.
        let (mut term, mut sum, mut n) = (x, x, 0.0);
        while term > 1e-17 * sum {
            n += 1.0;
            term *= 2.0 * x * x / (2.0 * n + 1.0);
            sum += term;
        }
        1.0 - 2.0 / std::f64::consts::PI.sqrt() * (-x * x).exp() * sum
    } else {
        // erfc by its continued fraction; NaN stays NaN.
        let fraction = (1..=80).rev().fold(x, |tail, k| x + 0.5 * f64::from(k) / tail);
        (-x * x).exp() / (std::f64::consts::PI.sqrt() * fraction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_tails_are_those_of_the_tables() {
        for (z, p) in [
            (0.0, 1.0),
            (1.0, 0.317_310_507_862_914),
            (1.959_963_984_540_054, 0.05),
            (3.0, 0.002_699_796_063_260_19),
            (4.0, 6.334_248_366_623_98e-5),
            (6.0, 1.973_175_290_075_4e-9),
        ] {
            assert!((two_sided(z) / p - 1.0).abs() < 1e-9, "{z}: {}", two_sided(z));
            assert_eq!(two_sided(-z), two_sided(z));
        }
        assert!(two_sided(f64::NAN).is_nan());
    }

    #[test]
    fn fair_and_unfair_coins() {
        assert!(binomial(5040, 10_000, 0.5).accepts(0.95));
        assert!(!binomial(5200, 10_000, 0.5).accepts(0.999));
    }

    #[test]
    fn middle_values() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), 2.5);
        assert_eq!(variance(&[1.0, 3.0]), 2.0);
        let sample: Vec<f64> = (0..100).map(f64::from).collect();
        assert!(sample_mean(&sample, 50.0).accepts(0.95));
        assert!(!sample_mean(&sample, 70.0).accepts(0.99));
    }
}
