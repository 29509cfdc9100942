// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions (stylized scattering 4.2, thesis 6.2.2): diffusion of constraints to convergence, layers with straight
//! alpha as W3C's "Compositing and blending" prints them, properties of rays by projecting points.

use crate::linear::Vec3;
use crate::parallel;
use crate::reference::camera::Camera;
use crate::reference::phase::{henyey_greenstein, isotropic};

/// Radius of a constraint's disc, in units of the square's side.
pub const RADIUS: f64 = 0.03;

/// A colour, straight or premultiplied as the context says: red, green, blue, alpha.
pub type Rgba = [f64; 4];

/// The value that a texel is held at, none where it is free: within a disc, or with a constraint's middle in it, it has the
/// colour of the constraint nearest to its centre.
fn held(constraints: &[([f64; 2], Rgba)], x: usize, y: usize, size: usize) -> Option<Rgba> {
    let centre = [x, y].map(|i| (i as f64 + 0.5) / size as f64);
    let away = |at: &[f64; 2]| ((at[0] - centre[0]).powi(2) + (at[1] - centre[1]).powi(2)).sqrt();
    let texel = |at: f64| ((at * size as f64) as usize).min(size - 1);
    let within =
        constraints.iter().any(|(at, _)| away(at) <= RADIUS || [texel(at[0]), texel(at[1])] == [x, y]);
    let nearest = constraints.iter().min_by(|a, b| away(&a.0).total_cmp(&away(&b.0)))?;
    within.then_some(nearest.1)
}

/// Premultiplied colours of constraints at positions 0..1, diffused over a square of `size` texels: every free texel is the
/// mean of its neighbours inside the square. Conjugate gradients until the residual is 1e-13 of what it was.
///
/// # Panics
/// If there is no constraint.
#[must_use]
pub fn diffused(constraints: &[([f64; 2], Rgba)], size: usize) -> Vec<Rgba> {
    assert!(!constraints.is_empty());
    let fixed: Vec<Option<Rgba>> =
        (0..size * size).map(|i| held(constraints, i % size, i / size, size)).collect();
    let channels = parallel::rows(4, |channel| {
        let values: Vec<Option<f64>> = fixed.iter().map(|of| of.map(|rgba| rgba[channel])).collect();
        harmonic(&values, size)
    });
    (0..size * size).map(|i| std::array::from_fn(|channel| channels[channel][i])).collect()
}

/// Indices of the neighbours of a texel.
fn neighbours(i: usize, size: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (i % size, i / size);
    let all = [
        (x > 0).then(|| i - 1),
        (x + 1 < size).then_some(i + 1),
        (y > 0).then(|| i - size),
        (y + 1 < size).then_some(i + size),
    ];
    all.into_iter().flatten()
}

fn harmonic(fixed: &[Option<f64>], size: usize) -> Vec<f64> {
    let held: Vec<f64> = fixed.iter().flatten().copied().collect();
    let mean = held.iter().sum::<f64>() / held.len() as f64;
    let mut u: Vec<f64> = fixed.iter().map(|value| value.unwrap_or(mean)).collect();
    // Rows of free texels only: the change of fixed ones is zero throughout.
    let apply = |v: &[f64], i: usize| -> f64 {
        if fixed[i].is_some() { 0.0 } else { neighbours(i, size).map(|j| v[i] - v[j]).sum() }
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let mut r: Vec<f64> = (0..u.len()).map(|i| -apply(&u, i)).collect();
    let mut p = r.clone();
    let mut square = dot(&r, &r);
    let enough = square * 1e-26;
    while square > enough && square > 0.0 {
        let q: Vec<f64> = (0..p.len()).map(|i| apply(&p, i)).collect();
        let alpha = square / dot(&p, &q);
        for i in 0..u.len() {
            u[i] += alpha * p[i];
            r[i] -= alpha * q[i];
        }
        let next = dot(&r, &r);
        for i in 0..p.len() {
            p[i] = r[i] + next / square * p[i];
        }
        square = next;
    }
    u
}

/// How a layer lies over those below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blend {
    /// Source-over, normal.
    Over,
    /// Source-over, multiply.
    Multiply,
    /// Plus.
    Add,
}

/// A straight colour over a straight colour; the result has straight colour too, black where it is transparent.
#[must_use]
pub fn blend(how: Blend, source: Rgba, backdrop: Rgba) -> Rgba {
    let (a, b) = (source[3], backdrop[3]);
    if how == Blend::Add {
        // Colours may exceed one.
        let alpha = (a + b).min(1.0);
        let sum = |i: usize| if alpha > 0.0 { (a * source[i] + b * backdrop[i]) / alpha } else { 0.0 };
        return [sum(0), sum(1), sum(2), alpha];
    }
    let alpha = a + b - a * b;
    let channel = |i: usize| {
        let mixed = if how == Blend::Multiply { source[i] * backdrop[i] } else { source[i] };
        let source = (1.0 - b) * source[i] + b * mixed;
        if alpha > 0.0 { (a * source + (1.0 - a) * b * backdrop[i]) / alpha } else { 0.0 }
    };
    [channel(0), channel(1), channel(2), alpha]
}

/// What is asked of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Property {
    /// Mean visibility.
    Visibility,
    /// Length over the limit.
    Depth,
    /// Angle to the light over pi.
    LightAngle,
    /// Angle in the picture to the direction towards the light over two pi.
    PictureAngle,
}

/// Where the light is: at a point, or infinitely far in a direction.
#[derive(Clone, Copy, Debug)]
pub enum Source {
    /// Direction towards it.
    Towards(Vec3),
    /// Position.
    At(Vec3),
}

impl Source {
    /// The direction towards it from a point.
    #[must_use]
    pub fn from(self, point: Vec3) -> Vec3 {
        match self {
            Self::Towards(direction) => direction.normalised(),
            Self::At(place) => (place - point).normalised(),
        }
    }
}

/// A property of the ray through a place of the picture. `distance`: of the surface; `aspect`: width over height.
#[must_use]
pub fn property(
    of: Property,
    camera: &Camera,
    aspect: f64,
    ndc: [f64; 2],
    light: Source,
    [visibility, distance, limit]: [f64; 3],
) -> f64 {
    let (origin, ray) = (camera.origin(ndc), camera.ray(ndc));
    match of {
        Property::Visibility => visibility.clamp(0.0, 1.0),
        Property::Depth => (distance / limit).clamp(0.0, 1.0),
        Property::LightAngle => ray.dot(light.from(origin)).clamp(-1.0, 1.0).acos() / std::f64::consts::PI,
        Property::PictureAngle => {
            // A point of the ray moved a little towards the light, and the way it moves in the picture.
            let point = origin + ray * (2.0 * camera.near + 1.0);
            let small = 1e-6;
            let towards = light.from(point);
            let (Some(a), Some(b)) =
                (camera.project(point - towards * small), camera.project(point + towards * small))
            else {
                return f64::NAN;
            };
            let angle = (b[1] - a[1]).atan2((b[0] - a[0]) * aspect);
            (angle / std::f64::consts::TAU).rem_euclid(1.0)
        }
    }
}

/// A texture of `size` x `size` premultiplied texels at a position 0..1, bilinear, clamped to the edge.
#[must_use]
pub fn lookup(texels: &[Rgba], size: usize, position: [f64; 2]) -> Rgba {
    let at = position.map(|p| (p * size as f64 - 0.5).clamp(0.0, size as f64 - 1.0));
    let [x, y] = at.map(|p| p.floor() as usize);
    let [s, t] = [at[0] - x as f64, at[1] - y as f64];
    let texel = |dx: usize, dy: usize| texels[(y + dy).min(size - 1) * size + (x + dx).min(size - 1)];
    std::array::from_fn(|i| {
        let upper = texel(0, 0)[i] * (1.0 - s) + texel(1, 0)[i] * s;
        let lower = texel(0, 1)[i] * (1.0 - s) + texel(1, 1)[i] * s;
        upper * (1.0 - t) + lower * t
    })
}

/// What the function's colour stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The scattered light.
    Replace,
    /// Albedo and visibility.
    Light,
    /// A factor on the scattered light.
    Scattering,
}

/// Scattered radiance with a function's premultiplied colour shown by `strength`, brightened by `brightness`. `g`: mean cosine,
/// none for a constant phase function.
#[must_use]
pub fn restyled(
    mode: Mode,
    g: Option<f64>,
    color: Rgba,
    [strength, brightness, cosine]: [f64; 3],
    radiance: [f64; 3],
    light: [f64; 3],
) -> [f64; 3] {
    let phase = g.map_or(isotropic(), |g| henyey_greenstein(cosine, g));
    std::array::from_fn(|i| {
        let factor = match mode {
            Mode::Replace => phase / isotropic(),
            Mode::Light => phase * light[i],
            Mode::Scattering => radiance[i],
        };
        let shown = color[i] * brightness * factor + (1.0 - color[3]) * radiance[i];
        radiance[i] * (1.0 - strength) + strength * shown
    })
}
