// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::splatting::light_scattering
// summary: What a sheet scatters on and back within cones about the light, and how far that spreads across the light.
// source: Zhang and Crawfis, "Light propagation for mixed polygonal and volumetric data using splatting", 3.1, Eq. 2 to 5.
// note: Eq. 2 is read as g(s, w) = integral over all w' of r(P - s w, w, w') I(P - s w, w') dw' with r = a tau p, the
// note: source in Eq. 1. Eq. 3 and 4 keep a tau p of it and drop ds: for a sheet of optical depth 1 more light would leave than came.
// note: Integrated over the sheet, what it takes from the light is 1 - T with T = exp(-optical depth); a of that is scattered, of
// note: which f goes on within the cone gamma_A and b back within gamma_B. So a sheet lets through t = T + a (1 - T) f and sends
// note: back r = a (1 - T) b, and T + a (1 - T)(f + b) is at most 1, since f + b is.
// note: The convolution takes what each texel scatters, K * (a (1 - T) f I), not a (1 - T) f (K * I): K has the sum 1, so that energy is
// note: kept exactly where the medium varies too.
// note: Width: light scattered at the depth s of a sheet of D metres along the light goes on at the angle theta and leaves it
// note: (D - s) tan(theta) aside: D^2 / 3 on average over s, times half of the mean of tan^2 over the cone along either axis. That makes
// note: blur depend on the number of sheets: as many as n sheets scatter n times as little light each n times less
// note: far. With `free_path` light keeps its direction for up to that far, evenly spread, through as many sheets as it takes;
// note: the variance then is max(free_path, D)^2 / 3, and pictures are the same for any number of thinner sheets.
// equation: cone_share(g, γ) = 2π ∫₀^γ p_HG(cos θ) sin θ dθ = (1 + g) o / ((√q + 1 − g) √q),  o = 1 − cos γ, q = 1 + g² − 2 g cos γ
// equation: t = T + a (1 − T) f, r = a (1 − T) b, T = exp(−τ);  variance = max(free_path, D)² mean(tan² θ) / 6
// error: shares within 2e-5 relative, slopes 2e-3; test splatting/scattering/kernels::shares_and_slopes_of_cones_are_integrals.
// error: kernels: sum within 5e-7, variance 5e-6 relative; test splatting/scattering/kernels::kernels_have_their_sum_and_variance.
// error: light that is only scattered on is kept within 5e-5; test splatting/scattering/light::light_that_is_only_scattered_on_is_kept.
// parameter point: metres in the world.
// parameter variance: texels^2, from 0 up.
// parameter g: mean cosine, -0.999..0.999.
// parameter cone: radians, 0..pi.
// parameter metres: from 0 up.
// parameter optical_depth: from 0 up.

#import airlight::core::camera::{Camera, matrix_row}
#import airlight::core::phase::henyey_greenstein
#import airlight::splatting::blur::{blur_radius, blur_sums, blur_weight}
#import airlight::splatting::sheet_shading::mean_transmittance

/// Angle from which light counts as going aside no farther, radians: 75 degrees. The tangent has no bound at a right angle.
const STEEPEST: f32 = 1.3089969;

/// Which light counts as going along the light. 16 bytes.
struct Scattering {
    /// Half the angle of the cone of light that is scattered on, gamma_A, 0..pi radians.
    forward_cone: f32,
    /// Half the angle of the cone of light that is scattered back, gamma_B, 0..pi/2 radians.
    back_cone: f32,
    /// For how far scattered light keeps its direction, metres; 0 for the depth of the sheet.
    free_path: f32,
    reserved_a: f32,
}

/// A symmetric convolution along one axis of the light buffer. 64 bytes.
struct AxisKernel {
    /// Weights at the distances of 0 to 12 texels, four a vector; then two zeros and the greatest distance that has a weight.
    weights: array<vec4<f32>, 4>,
}

/// What a sheet does with light that arrives at it: shares, linear RGB where they are three.
struct SheetOptics {
    /// That goes through without being scattered.
    transmitted: f32,
    /// That is scattered on within the forward cone.
    forward: vec3<f32>,
    /// That is scattered back within the backward cone.
    back: vec3<f32>,
}

/// Share of the light that the Henyey-Greenstein phase function scatters within a cone about the light's direction. `g`: mean
/// cosine; `cone`: half its angle, radians. Free of the quotient of small numbers that the usual form has near g = 0.
fn cone_share(g: f32, cone: f32) -> f32 {
    let mean = clamp(g, -0.999, 0.999);
    let half_sine = sin(0.5 * clamp(cone, 0.0, 3.14159265));
    let opening = 2.0 * half_sine * half_sine;
    // sqrt(1 + g^2 - 2 g cos), without the cancellation at the peak on either side.
    let least = (1.0 - abs(mean)) * (1.0 - abs(mean));
    let root = sqrt(least + 2.0 * abs(mean) * select(2.0 - opening, opening, mean >= 0.0));
    return clamp((1.0 + mean) * opening / ((root + 1.0 - mean) * root), 0.0, 1.0);
}

/// Shares of scattered light that go on, f, and back, b, within the cones; both together at most 1. `g`: mean cosine.
fn cone_shares(scattering: Scattering, g: f32) -> vec2<f32> {
    let forward = cone_share(g, scattering.forward_cone);
    return vec2<f32>(forward, min(cone_share(-g, scattering.back_cone), 1.0 - forward));
}

/// Mean of the squared tangent of the scattering angle over the light within a cone; beyond STEEPEST that of STEEPEST. `g`: mean
/// cosine, of light that goes back the negative of it; `cone`: half its angle, radians.
fn mean_square_slope(g: f32, cone: f32) -> f32 {
    const STEPS: f32 = 96.0;
    let end = clamp(cone, 0.0, 3.14159265);
    var sum = 0.0;
    for (var i = 0.5; i < STEPS; i += 1.0) {
        // Midpoints that lie closer at both ends, where phase functions peak.
        let unit = i / STEPS;
        let angle = end * unit * unit * (3.0 - 2.0 * unit);
        let slope = tan(min(angle, STEEPEST));
        sum += henyey_greenstein(cos(angle), g) * sin(angle) * slope * slope * unit * (1.0 - unit);
    }
    return sum * (12.0 * 3.14159265 / STEPS) * end / max(cone_share(g, cone), 1e-12);
}

/// Variance along either axis across the light of where scattered light goes on, metres^2. `metres`: of the light's way through the
/// sheet; `square_slope`: see `mean_square_slope`.
fn spread_variance(scattering: Scattering, metres: f32, square_slope: f32) -> f32 {
    let reach = max(scattering.free_path, metres);
    return reach * reach * square_slope / 6.0;
}

/// Texels of the light buffer along x and y that a metre across the light ray through a point of the world covers there. Light buffers
/// may lie askew to their rays.
fn texels_per_metre(light_camera: Camera, point: vec3<f32>) -> vec2<f32> {
    let clip = light_camera.clip_from_world * vec4<f32>(point, 1.0);
    let w = max(abs(clip.w), 1e-6);
    let ndc = clip.xy / w;
    let last = matrix_row(light_camera.clip_from_world, 3u).xyz;
    // Gradients of the texel over the world: along a ray the texel stays, so they lie across it.
    let x = matrix_row(light_camera.clip_from_world, 0u).xyz - ndc.x * last;
    let y = matrix_row(light_camera.clip_from_world, 1u).xyz - ndc.y * last;
    return 0.5 * light_camera.viewport * vec2<f32>(length(x), length(y)) / w;
}

/// A kernel of a variance in texels^2 as of `splatting/blur`, which has a greatest one: of a greater variance that is what remains.
fn axis_kernel(variance: f32) -> AxisKernel {
    let radius = blur_radius(variance);
    let sums = blur_sums(variance);
    var weights = array<vec4<f32>, 4>(vec4<f32>(0.0), vec4<f32>(0.0), vec4<f32>(0.0), vec4<f32>(0.0));
    for (var offset = 0u; offset <= radius; offset++) {
        weights[offset >> 2u][offset & 3u] = blur_weight(variance, sums, offset);
    }
    weights[3].w = f32(radius);
    return AxisKernel(weights);
}

/// What a sheet does with light. `optical_depth`: along the light, from 0 up; `albedo`: linear RGB, above 1 counts as 1;
/// `shares`: see `cone_shares`.
fn sheet_optics(optical_depth: f32, albedo: vec3<f32>, shares: vec2<f32>) -> SheetOptics {
    let transmitted = exp(-clamp(optical_depth, 0.0, 80.0));
    let scattered = clamp(albedo, vec3<f32>(0.0), vec3<f32>(1.0)) * (1.0 - transmitted);
    return SheetOptics(transmitted, scattered * shares.x, scattered * shares.y);
}

/// Share of arriving light that a sheet has on average over its depth, linear RGB, where it lets through what `optics` say: as if
/// light decayed evenly to that.
fn mean_light(optics: SheetOptics) -> vec3<f32> {
    let through = max(optics.transmitted + optics.forward, vec3<f32>(1e-35));
    return vec3<f32>(
        mean_transmittance(-log(through.x)), mean_transmittance(-log(through.y)), mean_transmittance(-log(through.z))
    );
}
