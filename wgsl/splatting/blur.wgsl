// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::splatting::blur
// summary: Kernels of separable blurs whose weights add up to 1 and whose variance is exactly what was asked for.
// source: Variances of blurs one after the other add up; so a blur that runs for many sheets needs each to be exact.
// note: Up to half a square step three taps; beyond that a sampled Gaussian that ends at 3.5 standard deviations or 12 taps to each side,
// note: whose last taps take what cutting and sampling miss of the variance. Variances beyond MOST_VARIANCE count as that.

/// Greatest variance of one blur, in squares of the distance between its taps.
const MOST_VARIANCE: f32 = 16.0;
/// Weights of a kernel: of offsets 0 to 12.
const BLUR_WEIGHTS: u32 = 13u;

/// Offset of the last tap to each side, 1..12. `variance`: in squares of the distance between taps, from 0 up.
fn blur_radius(variance: f32) -> u32 {
    let reach = clamp(ceil(3.5 * sqrt(max(variance, 0.0))), 1.0, f32(BLUR_WEIGHTS - 1u));
    return select(u32(reach), 1u, variance <= 0.5);
}

/// Weight of the taps at an offset to both sides before it is divided by the sum of all; `variance` above 0.5.
fn blur_bell(variance: f32, offset: u32) -> f32 {
    return exp(-0.5 * f32(offset * offset) / max(variance, 0.5));
}

/// Sum and variance of the taps of `blur_bell` up to the radius.
fn blur_sums(variance: f32) -> vec2<f32> {
    var sums = vec2<f32>(1.0, 0.0);
    for (var offset = 1u; offset <= blur_radius(variance); offset++) {
        let both = 2.0 * blur_bell(variance, offset);
        sums += both * vec2<f32>(1.0, f32(offset * offset));
    }
    return vec2<f32>(sums.x, sums.y / sums.x);
}

/// Weight of the tap at an offset of 0 to 12 to either side, of a kernel with `sums` by `blur_sums`; 0 beyond its radius.
fn blur_weight(variance: f32, sums: vec2<f32>, offset: u32) -> f32 {
    let asked = clamp(variance, 0.0, MOST_VARIANCE);
    let radius = blur_radius(asked);
    let three = select(select(0.0, 0.5 * asked, offset == 1u), 1.0 - asked, offset == 0u);
    let missing = (asked - sums.y) / f32(radius * radius);
    let bell = blur_bell(asked, offset) / sums.x
        + select(select(0.0, 0.5 * missing, offset == radius), -missing, offset == 0u);
    return select(select(0.0, bell, offset <= radius), three, asked <= 0.5);
}
