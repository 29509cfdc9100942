// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::splatting::blur
// summary: Kernels of separable blurs whose weights add up to 1 and whose variance is exactly what was asked for.
// source: Variances of blurs one after the other add up; so a blur that runs for many sheets needs each to be exact.
// note: Up to half a square step three taps; beyond that a sampled Gaussian that ends at three standard deviations or 12 taps to each
// note: side, mended by a parabola for what cutting and sampling miss of the variance. Variances beyond MOST_VARIANCE count as that.
// equation: up to ½: (½ v, 1 − v, ½ v);  beyond: w_k ∝ exp(−k² / 2v) (1 + s (k² − v₀)), s so that Σ w_k k² = v, Σ w_k = 1
// error: sums of weights within 5e-7, variances 2e-6 relative;
// error: test splatting/soft/blur::kernels_of_blurs_have_the_variance_that_was_asked_for.
// parameter variance: in squares of the distance between taps, from 0 up; counts up to 16.
// parameter offset: 0..12.

/// Greatest variance of one blur, in squares of the distance between its taps.
const MOST_VARIANCE: f32 = 16.0;
/// Weights of a kernel: of offsets 0 to 12.
const BLUR_WEIGHTS: u32 = 13u;

/// Offset of the last tap to each side, 0..12. `variance`: in squares of the distance between taps.
fn blur_radius(variance: f32) -> u32 {
    let reach = u32(clamp(ceil(3.0 * sqrt(max(variance, 0.0))), 1.0, f32(BLUR_WEIGHTS - 1u)));
    return select(select(reach, 1u, variance <= 0.5), 0u, variance <= 0.0);
}

/// The Gaussian at an offset, 1 in the middle; a variance below 0.5 counts as that.
fn blur_bell(variance: f32, offset: u32) -> f32 {
    return exp(-0.5 * f32(offset * offset) / max(variance, 0.5));
}

/// What `blur_weight` needs to know of a variance: the sum of the taps of `blur_bell`, their own variance, and how much the parabola bends.
fn blur_sums(variance: f32) -> vec3<f32> {
    let asked = clamp(variance, 0.0, MOST_VARIANCE);
    var moments = vec3<f32>(1.0, 0.0, 0.0);
    for (var offset = 1u; offset <= blur_radius(asked); offset++) {
        let square = f32(offset * offset);
        moments += 2.0 * blur_bell(asked, offset) * vec3<f32>(1.0, square, square * square);
    }
    let own = moments.y / moments.x;
    return vec3<f32>(moments.x, own, (asked - own) / max(moments.z / moments.x - own * own, 1e-6));
}

/// Weight of the tap at an offset of 0 to 12 to either side, of a kernel with `sums` by `blur_sums`; 0 beyond its radius.
fn blur_weight(variance: f32, sums: vec3<f32>, offset: u32) -> f32 {
    let asked = clamp(variance, 0.0, MOST_VARIANCE);
    let three = select(select(0.0, 0.5 * asked, offset == 1u), 1.0 - asked, offset == 0u);
    let mended = blur_bell(asked, offset) / sums.x * (1.0 + sums.z * (f32(offset * offset) - sums.y));
    return select(select(0.0, mended, offset <= blur_radius(asked)), three, asked <= 0.5);
}
