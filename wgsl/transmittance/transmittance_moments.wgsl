// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::transmittance::transmittance_moments
// summary: Transmittance from moments of optical depth along a light ray: six of powers, or two complex trigonometric ones.
// source: Muenstermann, Krumpen, Klein, Peters, "Moment-based order-independent transparency" (PACMCGIT 1(1), 2018).
// note: Optical depth is a distribution over depth: its total b_0 is the transmittance of the whole ray, and moments bound the
// note: share that lies before a depth. T = exp(-b_0 (share before + OVERESTIMATION of what can lie right at the depth)).
// note: Stored are sums over stretches of optical depth times (1, T_1..T_6 of 2 x - 1), Chebyshev polynomials, of which
// note: the powers are combinations and which core/moment_bounds solves for; or times (1, cos and sin of phase, cos
// note: and sin of twice the phase), phase = x (2 pi - GAP). Sums are added in any order, and mix between texels.
// note: Bias: powers are mixed with MOMENT_BIAS of a density (core/moment_bounds), trigonometric ones with
// note: TRIGONOMETRIC_BIAS of an even one. Both are far below the rounding of half floats: layers must be rgba32float.
// note: Trigonometric: with C the 3x3 Toeplitz matrix of the moments, e(s) = (1, exp(i s), exp(2 i s)), K(r, s) = e(r)* C^-1 e(s),
// note: the distribution with most weight at the phase s has it at s and at the two roots r of K(r, s), on the
// note: circle, 1 / K(r, r) each. A root in the gap counts as before s by the share of the gap that lies before the root:
// note: where the gap ends the range begins again. The paper moves a zone's weight too; its bounds are not sharp either.
// note: Two thin sheets are exact by either kind. An even medium is not: both are for media of few dense parts.
// equation: b_j = Σ τ_i mean of T_j(2x − 1), j = 0..6;  T(x) = exp(−b₀ (share before x + OVERESTIMATION weight at x))
// equation: trigonometric: b_j = Σ τ_i mean of exp(i j φ), φ = x (2π − GAP), j = 0..2;  nodes: roots of K(r, s) on the circle
// error: two thin sheets within 5e-3 by either kind; test transmittance/forms::two_thin_sheets_are_exact_with_moments_alone.
// error: within the budgets of its form against the reference;
// error: test transmittance/forms::every_form_is_its_reference_and_reaches_what_it_can.
// parameter middle: depth of the middle of a stretch, 0..1.
// parameter half: half its length, 0..0.5.
// parameter layer: 0 or 1.
// parameter depth: 0..1 over the range.
// parameter x: radians.
// parameter a, b: complex numbers, real and imaginary part.
// parameter once, twice: complex moments, absolute value up to 1.
// parameter unit: cosine and sine of an angle.
// parameter node, phase: angle on the circle, radians.

#import airlight::core::arc_cosine::arc_cosine
#import airlight::core::fourier_basis::PI
#import airlight::core::moment_bounds::{Moments, moments_at, share_bounds}

/// Part of the optical depth right at a depth that counts as before it.
const OVERESTIMATION: f32 = 0.25;
/// Arc of the circle that no depth maps to, radians.
const GAP: f32 = 0.3141592653589793;
/// Part of an even density over the circle that is mixed in.
const TRIGONOMETRIC_BIAS: f32 = 1e-5;
/// Least optical depth that has a distribution.
const LEAST_DEPTH: f32 = 1e-20;
/// Nodes and weights of Gauss and Legendre on -1..1, exact to degree 7.
const GAUSS_NODES: vec2<f32> = vec2<f32>(0.3399810435848563, 0.8611363115940526);
const GAUSS_WEIGHTS: vec2<f32> = vec2<f32>(0.3260725774312731, 0.1739274225687269);

/// The six moments of a stretch of optical depth 1 around `middle`, `half` to both sides, 0..1 over the range.
fn stretch_moments(middle: f32, half: f32) -> Moments {
    var sum = Moments(vec3<f32>(0.0), vec3<f32>(0.0));
    for (var node = 0u; node < 4u; node++) {
        let offset = select(GAUSS_NODES.x, GAUSS_NODES.y, node > 1u) * select(1.0, -1.0, (node & 1u) == 1u);
        let weight = select(GAUSS_WEIGHTS.x, GAUSS_WEIGHTS.y, node > 1u);
        let own = moments_at(clamp(2.0 * (middle + half * offset) - 1.0, -1.0, 1.0));
        sum = Moments(sum.low + weight * own.low, sum.high + weight * own.high);
    }
    return sum;
}

/// What a stretch of optical depth 1 adds to one of two layers: 1, moments 1 to 3; moments 4 to 6.
fn power_layer(middle: f32, half: f32, layer: u32) -> vec4<f32> {
    let moments = stretch_moments(middle, half);
    return select(vec4<f32>(1.0, moments.low), vec4<f32>(moments.high, 0.0), layer == 1u);
}

/// The same of trigonometric moments: 1, cosine and sine, cosine of twice the phase; its sine.
fn trigonometric_layer(middle: f32, half: f32, layer: u32) -> vec4<f32> {
    let phase = (2.0 * PI - GAP) * middle;
    let reach = (2.0 * PI - GAP) * half;
    let once = sine_quotient(reach) * vec2<f32>(cos(phase), sin(phase));
    let twice = sine_quotient(2.0 * reach) * vec2<f32>(cos(2.0 * phase), sin(2.0 * phase));
    return select(vec4<f32>(1.0, once, twice.x), vec4<f32>(twice.y, 0.0, 0.0, 0.0), layer == 1u);
}

/// sin(x) / x.
fn sine_quotient(x: f32) -> f32 {
    const third: f32 = 1.0 / 6.0;
    let square = x * x;
    let near = 1.0 - third * square * (1.0 - 0.05 * square * (1.0 - square / 42.0));
    return select(near, sin(x) / max(abs(x), 0.5) * sign(x), abs(x) > 0.5);
}

/// Transmittance 0..1 from the near side to `depth` 0..1. `first`, `second`: the layers.
fn power_transmittance(first: vec4<f32>, second: vec4<f32>, depth: f32) -> f32 {
    let total = max(first.x, 0.0);
    let scale = 1.0 / max(total, LEAST_DEPTH);
    let moments = Moments(first.yzw * scale, second.xyz * scale);
    let beyond = share_bounds(moments, clamp(2.0 * depth - 1.0, -1.0, 1.0));
    let before = 1.0 - beyond.y + OVERESTIMATION * (beyond.y - beyond.x);
    return exp(-total * clamp(before, 0.0, 1.0));
}

/// The product of complex numbers.
fn complex_product(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}

/// The conjugate of `a`.
fn conjugate(a: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(a.x, -a.y);
}

/// C = L D L* of trigonometric moments.
struct CircleFactors {
    /// Entries of L in the first column: the moments.
    once: vec2<f32>,
    /// Of row 2.
    twice: vec2<f32>,
    /// The entry of row 2 at column 1.
    lower: vec2<f32>,
    /// D_1 and D_2; D_0 is 1.
    pivots: vec2<f32>,
}

/// Factors of the matrix of biased moments, complex numbers with an absolute value up to 1.
fn circle_factors(once: vec2<f32>, twice: vec2<f32>) -> CircleFactors {
    let keep = 1.0 - TRIGONOMETRIC_BIAS;
    let a = keep * once / max(1.0, length(once));
    let b = keep * twice / max(1.0, length(twice));
    let first = max(1.0 - dot(a, a), TRIGONOMETRIC_BIAS);
    let lower = (a - complex_product(b, conjugate(a))) / first;
    let second = max(1.0 - dot(b, b) - dot(lower, lower) * first, 0.1 * TRIGONOMETRIC_BIAS);
    return CircleFactors(a, b, lower, vec2<f32>(first, second));
}

/// L^-1 e at the angle of which `unit` is (cosine, sine); the first entry is 1. Two complex numbers.
fn circle_polynomials(factors: CircleFactors, unit: vec2<f32>) -> vec4<f32> {
    let first = unit - factors.once;
    let second = complex_product(unit, unit) - factors.twice - complex_product(factors.lower, first);
    return vec4<f32>(first, second);
}

/// The most that can lie where `polynomials` are: 1 / K, 0..1.
fn circle_weight(factors: CircleFactors, polynomials: vec4<f32>) -> f32 {
    let first = dot(polynomials.xy, polynomials.xy) / factors.pivots.x;
    return 1.0 / (1.0 + first + dot(polynomials.zw, polynomials.zw) / factors.pivots.y);
}

/// How much of what lies at the angle `node` is before `phase`, 0..2 pi - GAP: 0..1.
fn before_phase(node: f32, phase: f32) -> f32 {
    let around = node - 2.0 * PI * floor(node / (2.0 * PI));
    let last = 2.0 * PI - GAP;
    return select(select(0.0, 1.0, around < phase), clamp((around - last) / GAP, 0.0, 1.0), around > last);
}

/// Transmittance 0..1 from the near side to `depth` 0..1. `first`, `second`: the layers.
fn trigonometric_transmittance(first: vec4<f32>, second: vec4<f32>, depth: f32) -> f32 {
    let total = max(first.x, 0.0);
    let scale = 1.0 / max(total, LEAST_DEPTH);
    let factors = circle_factors(first.yz * scale, vec2<f32>(first.w, second.x) * scale);
    let phase = (2.0 * PI - GAP) * clamp(depth, 0.0, 1.0);
    let here = circle_polynomials(factors, vec2<f32>(cos(phase), sin(phase)));
    let own = circle_weight(factors, here);
    // q = C^-1 e times D_2, of which the greatest entry may else overflow; K has the entries of q as coefficients.
    let last = here.zw;
    let ratio = factors.pivots.y / factors.pivots.x;
    let middle = here.xy * ratio - complex_product(conjugate(factors.lower), last);
    let start = vec2<f32>(factors.pivots.y, 0.0) - complex_product(conjugate(factors.once), middle)
        - complex_product(conjugate(factors.twice), last);
    // Roots of start w^2 + middle w + last, both on the circle: w = exp(i (turn / 2 +- arc)).
    let product = complex_product(last, conjugate(start));
    let turn = atan2(product.y, product.x);
    let across = complex_product(middle, conjugate(start));
    let real = dot(across, vec2<f32>(cos(0.5 * turn), sin(0.5 * turn)));
    let arc = arc_cosine(-0.5 * real / max(dot(start, start), 1e-30));
    var before = OVERESTIMATION * own;
    var left = 1.0 - own;
    for (var root = 0u; root < 2u; root++) {
        let node = 0.5 * turn + select(arc, -arc, root == 1u);
        let weight = min(circle_weight(factors, circle_polynomials(factors, vec2<f32>(cos(node), sin(node)))), left);
        before += weight * before_phase(node, phase);
        left -= weight;
    }
    return exp(-total * clamp(before, 0.0, 1.0));
}
