// SPDX-License-Identifier: MIT OR Apache-2.0
//! Adaptive quadrature: Gauss and Kronrod's rule of 7 and 15 points, halved where both differ.

const NODES: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_47,
    0.0,
];
const KRONROD: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_56,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
    0.209_482_141_084_727_82,
];
/// Of every second node.
const GAUSS: [f64; 4] =
    [0.129_484_966_168_869_7, 0.279_705_391_489_276_64, 0.381_830_050_505_118_9, 0.417_959_183_673_469_4];
const DEEPEST: u32 = 40;

/// The integrals of `N` functions between two places, each to about `tolerance` times the sum of the
/// magnitudes over the pieces that were looked at. 0 for an empty interval.
#[must_use]
pub fn integrate<const N: usize>(
    function: impl Fn(f64) -> [f64; N],
    from: f64,
    to: f64,
    tolerance: f64,
) -> [f64; N] {
    if to <= from {
        return [0.0; N];
    }
    let (whole, _) = rule(&function, from, to);
    let scale = whole.iter().fold(f64::MIN_POSITIVE, |a, b| a.max(b.abs()));
    refine(&function, from, to, tolerance * scale, DEEPEST)
}

fn refine<const N: usize>(
    function: &impl Fn(f64) -> [f64; N],
    from: f64,
    to: f64,
    allowed: f64,
    deeper: u32,
) -> [f64; N] {
    let (value, error) = rule(function, from, to);
    let magnitude = value.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    // Below the rounding of the rule itself nothing is gained.
    if deeper == 0 || error <= allowed.max(1e-15 * magnitude) {
        return value;
    }
    let middle = 0.5 * (from + to);
    let left = refine(function, from, middle, 0.5 * allowed, deeper - 1);
    let right = refine(function, middle, to, 0.5 * allowed, deeper - 1);
    std::array::from_fn(|i| left[i] + right[i])
}

/// Kronrod's value and the greatest difference from Gauss'.
fn rule<const N: usize>(function: &impl Fn(f64) -> [f64; N], from: f64, to: f64) -> ([f64; N], f64) {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (mut kronrod, mut gauss) = ([0.0; N], [0.0; N]);
    for (i, (&node, &weight)) in NODES.iter().zip(&KRONROD).enumerate() {
        let signs: &[f64] = if node == 0.0 { &[1.0] } else { &[-1.0, 1.0] };
        for sign in signs {
            let value = function(middle + sign * half * node);
            for channel in 0..N {
                kronrod[channel] += weight * half * value[channel];
                if i % 2 == 1 {
                    gauss[channel] += GAUSS[i / 2] * half * value[channel];
                }
            }
        }
    }
    let error = (0..N).map(|i| (kronrod[i] - gauss[i]).abs()).fold(0.0, f64::max);
    (kronrod, error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_rules_are_exact_for_polynomials() {
        for degree in 0..=13 {
            let ([value], error) = rule(&|x: f64| [x.powi(degree)], -0.5, 2.0);
            let expected = (2.0_f64.powi(degree + 1) - (-0.5_f64).powi(degree + 1)) / f64::from(degree + 1);
            assert!((value / expected - 1.0).abs() < 1e-13, "{degree}");
            assert!(error < 1e-12 * expected, "{degree}: {error}");
        }
        // Kronrod's alone holds to degree 22.
        let ([value], error) = rule(&|x: f64| [x.powi(22)], 0.0, 1.0);
        assert!((value * 23.0 - 1.0).abs() < 1e-13 && error > 1e-10);
    }

    #[test]
    fn narrow_peaks_and_jumps_are_found() {
        let [peak, jump] =
            integrate(|x| [1e-4 / (x * x + 1e-8), f64::from(u8::from(x > 0.3))], -1.0, 1.0, 1e-12);
        assert!((peak - 2.0 * 1e4_f64.atan()).abs() < 1e-9);
        assert!((jump - 0.7).abs() < 1e-9);
        assert_eq!(integrate(|x| [x], 1.0, 0.5, 1e-9), [0.0]);
    }
}
