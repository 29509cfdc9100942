// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::fourier_basis
// summary: Visibility as a Fourier series of the depth difference, four bases at a time.
// source: thesis 4.3.1, Eq. 4.7, after Annen et al., "Convolution shadow maps" (2007).
// note: lit if and only if z_ray <= z_stored. The series of the step is
// note:   V = 1/2 + sum over k = 1..M/2 of a(2k-1) B(2k-1) + a(2k) B(2k), c_k = pi (2k - 1).
// note: The thesis prints the sum from k = 0 and to M: k starts at 1, and M scalars are M/2 frequencies.
// note: It adds 0.5 to the unnormalised sum over s texels: that must be 0.5 s. Sums are normalised here.
// note: The series has period 2 in z_ray - z_stored, so that it jumps a second time at a difference
// note: of 1: `guarded` therefore maps view rays to GUARD .. 1 - GUARD and leaves the rest of 0..1 to blockers.
// note: Group g, 0 .. M/4 - 1, holds the bases 4g+1 .. 4g+4: (sin, cos) of c_(2g+1) z and of c_(2g+2) z.
// equation: V(z_ray, z) = ½ + Σ_(k=1..M/2) (2 / c_k) sin(c_k (z − z_ray)),  c_k = π (2k − 1)
// equation:              = ½ + Σ_k (2 / c_k) (cos(c_k z_ray) sin(c_k z) − sin(c_k z_ray) cos(c_k z))
// equation: bases of texel z: sin(c_k z), cos(c_k z);  coefficients of a ray: (2 / c_k) cos(c_k z_ray), −(2 / c_k) sin(c_k z_ray)
// equation: Lanczos window: coefficients times sinc((2k − 1) / M), sinc(x) = sin(π x) / (π x)
// equation: guarded(u) = GUARD + (1 − 2 GUARD) u
// error: bases within 1e-6 + 8e-7 c_k, by the step from group to group or at once; test core/fourier::bases_are_sines_and_cosines.
// error: coefficients within 1e-6, the whole series 1e-5; test core/fourier::coefficients_and_series_are_those_of_the_reference.
// error: guarded within 1.5e-7; test core/fourier::the_guard_keeps_rays_from_both_ends.
// parameter a, b: (sin, cos) of an angle.
// parameter group: number of four bases, 0 .. M/4 - 1.
// parameter bases: M, a multiple of 4.
// parameter basis: sines and cosines, -1..1.
// parameter stored: texel, 0..1.
// parameter z: depth 0..1.
// parameter half_turns: angle over pi, any.

const PI: f32 = 3.141592653589793;

/// Part of the depth range at either end that is kept free of view rays.
const GUARD: f32 = 0.05;

/// Depth in the guarded range. `unit`: depth over the bounds of the view rays, where rays lie in
/// 0..1 and blockers may lie outside; the result is clamped to 0..1.
fn guarded(unit: f32) -> f32 {
    return clamp(GUARD + (1.0 - 2.0 * GUARD) * unit, 0.0, 1.0);
}

/// What is added to the depth of a blocker before its bases are taken, up to 1: about half the width
/// of the softened edge. Without it a lit surface shades the end of every ray that meets it, because
/// the series is 1/2, not 1, at the depth of the blocker itself. `bases`: M.
fn surface_bias(bases: u32) -> f32 {
    return min(0.6 / f32(bases), 0.8 * GUARD);
}

/// Four bases and the rotation that leads to the next four.
struct Series {
    /// sin, cos of the first frequency, sin, cos of the second.
    basis: vec4<f32>,
    /// sin and cos of 4 pi z, the angle from one group to the next.
    turn: vec2<f32>,
}

/// (sin, cos) of pi times `half_turns`, exact reduction for large arguments.
fn sine_cosine(half_turns: f32) -> vec2<f32> {
    let angle = PI * (half_turns - 2.0 * round(0.5 * half_turns));
    return vec2<f32>(sin(angle), cos(angle));
}

/// (sin, cos) of the sum of two angles given by (sin, cos).
fn rotate(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(a.x * b.y + a.y * b.x, a.y * b.y - a.x * b.x);
}

/// The bases of `group` at depth `z`, 0..1, ready to step on.
fn series_at(z: f32, group: u32) -> Series {
    let first = sine_cosine(f32(4u * group + 1u) * z);
    let double = sine_cosine(2.0 * z);
    return Series(vec4<f32>(first, rotate(first, double)), rotate(double, double));
}

/// The bases of group 0 at depth `z`, 0..1: one sine and cosine instead of two, and of an angle up to
/// pi, which needs no reduction.
fn series_first(z: f32) -> Series {
    let first = vec2<f32>(sin(PI * z), cos(PI * z));
    let double = rotate(first, first);
    return Series(vec4<f32>(first, rotate(first, double)), rotate(double, double));
}

/// The next group, by a rotation instead of new sines. The error grows by about 1e-7 a step.
fn series_next(series: Series) -> Series {
    return Series(
        vec4<f32>(rotate(series.basis.xy, series.turn), rotate(series.basis.zw, series.turn)),
        series.turn
    );
}

/// Coefficients of `group` from the series of the ray's depth (Eq. 4.7), to be multiplied with the
/// filtered bases. Plain truncation: sharpest, overshoots by 9 %.
fn coefficients(ray: Series, group: u32) -> vec4<f32> {
    let scale = coefficient_scale(group);
    return vec4<f32>(ray.basis.y, -ray.basis.x, ray.basis.w, -ray.basis.z) * scale.xxyy;
}

/// Like `coefficients` with the Lanczos window, sinc(n / M): overshoot 1.2 %, an edge about 1.3
/// times as wide. `window`: the series at depth 1 / M, stepped along with `ray`.
fn coefficients_lanczos(ray: Series, window: Series, group: u32, bases: u32) -> vec4<f32> {
    let scale = coefficient_scale(group);
    // sinc(n / M) = sin(pi n / M) M / (pi n); pi n = 2 / scale.
    let sinc = window.basis.xz * scale * (0.5 * f32(bases));
    return vec4<f32>(ray.basis.y, -ray.basis.x, ray.basis.w, -ray.basis.z) * (scale * sinc).xxyy;
}

/// 2 / c of the two frequencies of `group`.
fn coefficient_scale(group: u32) -> vec2<f32> {
    let n = f32(4u * group);
    return (2.0 / PI) / vec2<f32>(n + 1.0, n + 3.0);
}

/// Bases -1..1 to the range 0..1 in which textures store them.
fn stored_from_basis(basis: vec4<f32>) -> vec4<f32> {
    return 0.5 + 0.5 * basis;
}

/// What `stored_from_basis` did, undone.
fn basis_from_stored(stored: vec4<f32>) -> vec4<f32> {
    return 2.0 * stored - 1.0;
}
