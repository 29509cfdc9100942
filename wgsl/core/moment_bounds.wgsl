// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::moment_bounds
// summary: Six moments of a distribution on -1..1, and the bounds that they give of its share beyond a place.
// source: Algorithm 1 of Peters et al., "Improved moment shadow maps for translucent occluders, soft shadows and single scattering" (2017).
// note: C. Peters, C. Muenstermann, N. Wetzstein and R. Klein, JCGT 6(1), with six moments.
// note: The paper takes powers of z and looks for an affine transform of them that survives
// note: quantisation; here the moments are means of the Chebyshev polynomials T_1(z)..T_6(z), which is such a transform:
// note: each fills -1..1, and the determinant against powers is 2^15. They are also better to compute with, since
// note: T_j T_k = (T_(j+k) + T_|j-k|) / 2 makes the matrix G, G_jk = mean of T_j T_k, j and k from 0 to 3, of them directly.
// note: Derivation. Let K(x, z) = T(x)' G^-1 T(z), with T = (T_0..T_3). Of all distributions with these moments the one
// note: that puts most weight at z has it at z and the three roots x of K(x, z), the weight at any of these nodes y being
// note: 1 / K(y, y). The shares below and up to z of this distribution bound those of every other (Chebyshev, Markov).
// note: With G = L D L', p = L^-1 T holds the orthogonal polynomials at z, K(x, z) the sum of p_j(x) p_j(z) / D_j,
// note: and as many of the roots lie above z as p_0..p_3 change sign. Where all three lie on one side the weight at z
// note: tells the bounds. Else one root lies alone on its side, and its weight is the only one that is needed.
// note: It is the extreme root of the cubic in t = 1 / (x - z), whose first coefficient K(z, z) never vanishes.
// note: Bias. Rounding may leave no distribution with the stored moments. They are mixed with MOMENT_BIAS of those of the
// note: density 1 / (pi sqrt(1 - z^2)), which are all 0: multiplied by 1 - MOMENT_BIAS. That adds MOMENT_BIAS / 2 to the
// note: least eigenvalue of G.
// note: Values, not branches: around this much arithmetic a branch in a fragment shader ends lavapipe of Mesa 22.3.
// equation: T₁ = z, T₂ = 2z² − 1, T₃ = 4z³ − 3z;  moments m_j = mean of T_j, j = 1..6
// equation: G_jk = ½ (m_(j+k) + m_|j−k|), j, k = 0..3, G = L D L';  K(x, z) = T(x)' G⁻¹ T(z)
// equation: greatest weight at z = 1 / K(z, z);  bounds from the weights at z and at the roots x of K(x, z) = 0
// equation: biased moments: m_j (1 − MOMENT_BIAS)
// error: bounds within 6e-3, in the mean 5e-5; the truth outside of them by at most 1e-4;
// error: test scattering/moments/bounds::bounds_are_those_of_the_reference.
// error: cosine_of_third from -1.2e-7 to 3e-6; test scattering/moments/bounds::cosine_of_a_third_is_never_too_small.
// parameter polynomials: of degree 1, 2 and 3, from `orthogonal_polynomials`.
// parameter x: -1..1.
// parameter z: place, -1..1.
// parameter moments: means of Chebyshev polynomials, -1..1 each.

/// Share of the density 1 / (pi sqrt(1 - z^2)) that is mixed in.
const MOMENT_BIAS: f32 = 1e-5;
/// Values below this break the factorisation off; the bias keeps those of real moments above it.
const LEAST_PIVOT: f32 = 0.1 * MOMENT_BIAS;
/// Roots farther away than this carry less than 1e-5.
const FARTHEST_ROOT: f32 = 8.0;

/// Means of the Chebyshev polynomials T_1 to T_6.
struct Moments {
    /// Of degree 1, 2 and 3, -1..1.
    low: vec3<f32>,
    /// Of degree 4, 5 and 6, -1..1.
    high: vec3<f32>,
}

/// G = L D L' and the first row of G.
struct Factors {
    /// Means of T_1, T_2, T_3, which is the first column of L.
    mean: vec3<f32>,
    /// The other entries of L: of rows 2 and 3 at column 1, and of row 3 at column 2.
    lower: vec3<f32>,
    /// 1 / D_1, 1 / D_2, 1 / D_3; D_0 is 1. Zero from where the factorisation breaks off.
    inverse: vec3<f32>,
}

/// T_1, T_2, T_3 at `z`.
fn chebyshev(z: f32) -> vec3<f32> {
    return vec3<f32>(z, 2.0 * z * z - 1.0, z * (4.0 * z * z - 3.0));
}

/// Moments of a single place `z`, -1..1.
fn moments_at(z: f32) -> Moments {
    let low = chebyshev(z);
    let high = vec3<f32>(2.0 * low.y * low.y, 2.0 * low.y * low.z, 2.0 * low.z * low.z);
    return Moments(low, high - vec3<f32>(1.0, low.x, 1.0));
}

/// Moments of a mixture: `share` 0..1 of `b`, the rest of `a`.
fn mix_moments(a: Moments, b: Moments, share: f32) -> Moments {
    return Moments(mix(a.low, b.low, share), mix(a.high, b.high, share));
}

/// Factors of the matrix G of biased moments.
fn moment_factors(moments: Moments) -> Factors {
    let keep = 1.0 - MOMENT_BIAS;
    let low = keep * clamp(moments.low, vec3<f32>(-1.0), vec3<f32>(1.0));
    let high = keep * clamp(moments.high, vec3<f32>(-1.0), vec3<f32>(1.0));
    // Entries of G, less what the first column takes: rows and columns 1 to 3.
    let diagonal = 0.5 + 0.5 * vec3<f32>(low.y, high.x, high.z) - low * low;
    let side = 0.5 * vec3<f32>(low.x + low.z, low.y + high.x, low.x + high.y) - low.xxy * low.yzz;
    let inverse_a = select(0.0, 1.0 / max(diagonal.x, LEAST_PIVOT), diagonal.x > LEAST_PIVOT);
    let row_b = side.x * inverse_a;
    let row_c = side.y * inverse_a;
    let pivot_b = diagonal.y - row_b * side.x;
    let inverse_b = select(0.0, 1.0 / max(pivot_b, LEAST_PIVOT), pivot_b > LEAST_PIVOT && inverse_a > 0.0);
    let rest = side.z - row_b * side.y;
    let row_d = rest * inverse_b;
    let pivot_c = diagonal.z - row_c * side.y - row_d * rest;
    let inverse_c = select(0.0, 1.0 / max(pivot_c, LEAST_PIVOT), pivot_c > LEAST_PIVOT && inverse_b > 0.0);
    return Factors(low, vec3<f32>(row_b, row_c, row_d), vec3<f32>(inverse_a, inverse_b, inverse_c));
}

/// The orthogonal polynomials of degree 1, 2 and 3 at `z`; that of degree 0 is 1.
fn orthogonal_polynomials(factors: Factors, z: f32) -> vec3<f32> {
    let centred = chebyshev(z) - factors.mean;
    let second = centred.y - factors.lower.x * centred.x;
    let third = centred.z - factors.lower.y * centred.x - factors.lower.z * second;
    return vec3<f32>(centred.x, second, third);
}

/// The most that can lie where the orthogonal polynomials have these values: 1 / K, 0..1.
fn greatest_weight(factors: Factors, polynomials: vec3<f32>) -> f32 {
    return 1.0 / (1.0 + dot(polynomials * polynomials, factors.inverse));
}

/// cos(acos(x) / 3) for x from -1 to 1, and at most 3e-6 more: a polynomial in cos(acos(x) / 2).
fn cosine_of_third(x: f32) -> f32 {
    let half = sqrt(0.5 * x + 0.5);
    let last = 0.04763451 + half * (half * 0.00412080 - 0.01912183);
    return 0.5000028 + half * (0.57725041 + half * (half * last - 0.10988446));
}

/// One step of Newton's method from `root` towards a root of t^3 + a t^2 + b t + c, `coefficients` a, b, c.
fn newton_step(coefficients: vec3<f32>, root: f32) -> f32 {
    let slope = (3.0 * root + 2.0 * coefficients.x) * root + coefficients.y;
    let value = ((root + coefficients.x) * root + coefficients.y) * root + coefficients.z;
    return root - select(0.0, value / max(slope, 1e-30), slope > 1e-30);
}

/// The greatest root of t^3 + a t^2 + b t + c, `coefficients` a, b, c, of which all roots are real.
fn greatest_cubic_root(coefficients: vec3<f32>) -> f32 {
    let a = coefficients.x;
    let b = coefficients.y;
    let c = coefficients.z;
    // Roots -a/3 + 2 sqrt(p) cos: those of the cubic moved to have no square.
    let p = max(a * a - 3.0 * b, 0.0) / 9.0;
    let half_width = sqrt(p);
    let r = (a * (2.0 * a * a - 9.0 * b) + 27.0 * c) / 54.0;
    let cosine = cosine_of_third(clamp(-r / max(p * half_width, 1e-30), -1.0, 1.0));
    // From above, Newton's steps come nearer without passing it. They recover a root that is small next to the others.
    return newton_step(coefficients, newton_step(coefficients, 2.0 * half_width * cosine - a / 3.0));
}

/// Least and greatest share, 0..1, at or beyond `z`, -1..1, that are possible with these moments. Their difference is the
/// most that can lie at `z` itself.
fn share_bounds(moments: Moments, z: f32) -> vec2<f32> {
    let factors = moment_factors(moments);
    let at_ray = orthogonal_polynomials(factors, z);
    let own = greatest_weight(factors, at_ray);
    let changes = select(vec3<u32>(0u), vec3<u32>(1u), at_ray * vec3<f32>(1.0, at_ray.xy) < vec3<f32>(0.0));
    let above = changes.x + changes.y + changes.z;
    // G^-1 T(z): K(x, z) as a sum of T_0..T_3 at x, then its derivatives at x = z over K(z, z).
    let scaled = at_ray * factors.inverse;
    let third = scaled.z;
    let second = scaled.y - factors.lower.z * third;
    let first = scaled.x - factors.lower.x * second - factors.lower.y * third;
    let slope = first - 3.0 * third + z * (4.0 * second + 12.0 * z * third);
    let cubic = own * vec3<f32>(slope, 2.0 * second + 12.0 * z * third, 4.0 * third);
    // The root that lies alone on its side is the greatest in t, or the least, which is the greatest of the mirrored cubic.
    // Where all lie on the other side that root is negative, and no weight is alone.
    let side = select(-1.0, 1.0, above < 2u);
    let root = greatest_cubic_root(cubic * vec3<f32>(side, 1.0, side));
    let nearest = z + side / max(root, 1.0 / FARTHEST_ROOT);
    let weight = min(greatest_weight(factors, orthogonal_polynomials(factors, nearest)), 1.0 - own);
    let alone = select(0.0, weight, root > 1.0 / FARTHEST_ROOT);
    let upper = select(1.0 - alone, own + alone, above < 2u);
    return vec2<f32>(max(upper - own, 0.0), min(upper, 1.0));
}
