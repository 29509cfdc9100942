// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::splatting::footprint
// summary: What a ray passes of a splat's kernel between two places, a section of its footprint.
// source: Zhang and Crawfis, 2.1 and 4.1; Mueller et al., "Splatting without the blur" (1999).
// note: The kernel is a Gaussian of voxels that ends at a radius, scaled so that it holds 1. Where sheets are tilted against the
// note: ray, the section depends on the pixel: a table of offset and depth would be off by up to a factor of 3 at 30 degrees. The
// note: integral is taken in closed form instead. Sections of neighbouring sheets add up to the whole but for rounding, since
// note: they end and begin at the same value of the same function.

/// The kernel of all splats. 16 bytes.
struct Kernel {
    /// Standard deviation, voxels; 0.6 to 0.7 keeps the ripple of a constant volume below half a percent.
    sigma: f32,
    /// Where the kernel ends, voxels; at most 3.5 sigma.
    radius: f32,
    /// Factor on sections, so that the kernel's integral is 1.
    scale: f32,
    reserved: f32,
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

/// Integral of the kernel over voxels along a ray from `from` to `to`, both measured from where the ray comes nearest to the
/// splat's middle. `square`: of the distance there, voxels; 0 beyond the radius. 1/voxel^2.
fn footprint_section(kernel: Kernel, square: f32, from: f32, to: f32) -> f32 {
    let reach = sqrt(max(kernel.radius * kernel.radius - square, 0.0));
    let spread = 0.70710678 / kernel.sigma;
    let ends = clamp(vec2<f32>(from, to), vec2<f32>(-reach), vec2<f32>(reach)) * spread;
    return kernel.scale * exp(-square * spread * spread) * (error_function(ends.y) - error_function(ends.x));
}
