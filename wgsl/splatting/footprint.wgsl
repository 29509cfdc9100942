// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::splatting::footprint
// summary: What a ray passes of a splat's kernel between two places, a section of its footprint.
// source: Zhang and Crawfis, 2.1 and 4.1; Mueller et al., "Splatting without the blur" (1999).
// note: The kernel is a Gaussian of voxels less its tangent in the squared distance at a radius, so that it ends there without step
// note: or kink, scaled so that it holds 1. A Gaussian that is merely cut there ripples five times as much. Where sheets are tilted against the
// note: ray, the section depends on the pixel: a table of offset and depth would be off by up to a factor of 3 at 30 degrees. The
// note: integral is taken in closed form instead. Sections of neighbouring sheets add up to the whole but for rounding, since
// note: they end and begin at the same value of the same function.
// equation: k(r²) = scale (exp(−r² / 2σ²) − edge (1 + (R² − r²) / 2σ²)), 0 beyond R;  ∫ k dV = 1
// equation: section = ∫ from begin to end of k(square + t²) dt, by erf and a cubic
// error: error function within 4.3e-6; test splatting/functions::the_error_function_is_that.
// error: sections within 1.5e-5 of the peak; test splatting/functions::sections_of_footprints_are_integrals_of_the_kernel.
// parameter x: any number.
// parameter begin, end: voxels along the ray, from where it comes nearest.

/// The kernel of all splats. 16 bytes.
struct Kernel {
    /// Standard deviation of the Gaussian, voxels.
    sigma: f32,
    /// Where the kernel ends, voxels; at most 3.5 sigma.
    radius: f32,
    /// Factor on sections, so that the kernel's integral is 1.
    scale: f32,
    /// The Gaussian at the radius.
    edge: f32,
}

/// The error function of -2.5 to 2.5, within 4e-6; beyond that the value there.
fn error_function(x: f32) -> f32 {
    let a = clamp(x, -2.5, 2.5);
    let y = a * a;
    // Minimax over the odd polynomials of degree 17.
    let high = (((1.12805427e-7 * y - 4.04915563e-6) * y + 6.64965259e-5) * y - 6.74895497e-4) * y + 4.83849545e-3;
    let low = ((high * y - 2.63637015e-2) * y + 1.12475873e-1) * y - 3.76006461e-1;
    return a * (low * y + 1.12836745);
}

/// Integral of the kernel over voxels along a ray from `begin` to `end`, both measured from where the ray comes nearest to the
/// splat's middle. `square`: of the distance there, voxels; 0 beyond the radius. 1/voxel^2.
fn footprint_section(kernel: Kernel, square: f32, begin: f32, end: f32) -> f32 {
    let inner = max(kernel.radius * kernel.radius - square, 0.0);
    let reach = sqrt(inner);
    let ends = clamp(vec2<f32>(begin, end), vec2<f32>(-reach), vec2<f32>(reach));
    let spread = 0.70710678 / kernel.sigma;
    let whole = error_function(ends.y * spread) - error_function(ends.x * spread);
    let bell = 0.88622693 / spread * exp(-square * spread * spread) * whole;
    // The tangent: edge (1 + (radius^2 - square - t^2) / (2 sigma^2)), integrated over t.
    let cubes = ends * ends * ends;
    let halved = spread * spread;
    let tangent = (1.0 + inner * halved) * (ends.y - ends.x) - halved / 3.0 * (cubes.y - cubes.x);
    return kernel.scale * max(bell - kernel.edge * tangent, 0.0);
}
