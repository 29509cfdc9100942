// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes as sums of kernels, and rays through them: single scattering by marching, with a second march towards the light
//! from every sample, and every sample classified by itself. No sheets, no footprints.

pub mod adding;
pub mod polygons;

pub mod area_light;

use super::camera::Camera;
use super::light::Light;
use super::phase::henyey_greenstein;
use crate::linear::{Mat4, Vec3};
use crate::parallel;

/// A Gaussian of voxels less its tangent in the squared distance at a radius, where it ends; it holds 1.
#[derive(Clone, Copy, Debug)]
pub struct Kernel {
    /// Standard deviation, voxels.
    pub sigma: f64,
    /// Where it ends, voxels.
    pub radius: f64,
    /// Factor that makes it hold 1.
    pub scale: f64,
}

impl Kernel {
    /// Scaled by the sum over the middles of small cubes.
    #[must_use]
    pub fn new(sigma: f64, radius: f64) -> Self {
        const CUBES: i32 = 160;
        let unscaled = Self { sigma, radius, scale: 1.0 };
        let side = radius / f64::from(CUBES);
        let square = |i: i32| ((f64::from(i) + 0.5) * side).powi(2);
        let plane = |z: i32| -> f64 {
            let line = |y: i32| -> f64 {
                (0..CUBES).map(|x| unscaled.value(square(x) + square(y) + square(z))).sum()
            };
            (0..CUBES).map(line).sum()
        };
        let octant: f64 = (0..CUBES).map(plane).sum();
        Self { scale: (8.0 * octant * side.powi(3)).recip(), ..unscaled }
    }

    /// At a squared distance, voxels; 1/voxel^3.
    #[must_use]
    pub fn value(&self, square: f64) -> f64 {
        if square >= self.radius * self.radius {
            return 0.0;
        }
        let variance = self.sigma * self.sigma;
        let gaussian = |square: f64| (-0.5 * square / variance).exp();
        let end = self.radius * self.radius;
        let slope = -0.5 / variance * gaussian(end);
        self.scale * (gaussian(square) - gaussian(end) - slope * (square - end))
    }

    /// Integral along a line that passes at a distance of the middle, from `begin` to `end` from where it is nearest, by the
    /// midpoint rule; voxels.
    #[must_use]
    pub fn section(&self, distance: f64, begin: f64, end: f64) -> f64 {
        const STEPS: u32 = 4000;
        let reach = (self.radius * self.radius - distance * distance).max(0.0).sqrt();
        let (begin, end) = (begin.clamp(-reach, reach), end.clamp(-reach, reach));
        let step = (end - begin) / f64::from(STEPS);
        let value = |i: u32| self.value(distance.powi(2) + (begin + (f64::from(i) + 0.5) * step).powi(2));
        (0..STEPS).map(value).sum::<f64>() * step
    }
}

/// A volume as the sum of a kernel about each voxel.
#[derive(Clone, Debug)]
pub struct Field {
    /// Voxels along x, y and z.
    pub size: [usize; 3],
    /// One a voxel, x fastest, then y; values that are not finite or not above 0 count as 0.
    pub values: Vec<f64>,
    /// Voxel space, in which the middle of voxel (i, j, k) is (i, j, k), to the world; affine.
    pub world_from_voxel: Mat4,
    /// Its inverse.
    pub voxel_from_world: Mat4,
    /// Of every voxel.
    pub kernel: Kernel,
}

fn components([x, y, z, _]: [f64; 4]) -> Vec3 {
    Vec3::new(x, y, z)
}

impl Field {
    /// At a point of the world.
    #[must_use]
    pub fn at(&self, point: Vec3) -> f64 {
        let place = components(self.voxel_from_world.apply_point(point)).to_array();
        let radius = self.kernel.radius;
        let range = |axis: usize| {
            let last = self.size[axis] as f64 - 1.0;
            let first = (place[axis] - radius).ceil().max(0.0);
            first as usize..((place[axis] + radius).floor().min(last) + 1.0).max(0.0) as usize
        };
        let mut sum = 0.0;
        for z in range(2) {
            for y in range(1) {
                let across = (y as f64 - place[1]).powi(2) + (z as f64 - place[2]).powi(2);
                for x in range(0) {
                    let value = self.values[(z * self.size[1] + y) * self.size[0] + x];
                    if value.is_finite() && value > 0.0 {
                        sum += value * self.kernel.value(across + (x as f64 - place[0]).powi(2));
                    }
                }
            }
        }
        sum
    }

    /// Where a ray of unit direction is within reach of any voxel, metres from its origin and ahead of it.
    #[must_use]
    pub fn stretch(&self, origin: Vec3, direction: Vec3) -> Option<[f64; 2]> {
        let from = components(self.voxel_from_world.apply_point(origin)).to_array();
        let along = components(self.voxel_from_world.apply_direction(direction)).to_array();
        let (mut begin, mut end) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let sides = [-self.kernel.radius, self.size[axis] as f64 - 1.0 + self.kernel.radius];
            if along[axis].abs() < 1e-12 {
                if from[axis] < sides[0] || from[axis] > sides[1] {
                    return None;
                }
                continue;
            }
            let [a, b] = sides.map(|side| (side - from[axis]) / along[axis]);
            begin = begin.max(a.min(b));
            end = end.min(a.max(b));
        }
        (begin < end && end.is_finite()).then_some([begin, end])
    }
}

/// Values in space, and how opaque they are.
pub trait Matter: Sync {
    /// Value at a point of the world.
    fn at(&self, point: Vec3) -> f64;

    /// Where a ray of unit direction may meet values above 0, metres from its origin and ahead of it.
    fn stretch(&self, origin: Vec3, direction: Vec3) -> Option<[f64; 2]>;

    /// Opacity of a value; the value itself, up to 1, unless said otherwise.
    fn opacity(&self, value: f64) -> f64 {
        value.min(1.0)
    }
}

impl Matter for Field {
    fn at(&self, point: Vec3) -> f64 {
        Self::at(self, point)
    }

    fn stretch(&self, origin: Vec3, direction: Vec3) -> Option<[f64; 2]> {
        Self::stretch(self, origin, direction)
    }
}

/// The sum of all fields.
impl Matter for [Field] {
    fn at(&self, point: Vec3) -> f64 {
        self.iter().map(|field| field.at(point)).sum()
    }

    fn stretch(&self, origin: Vec3, direction: Vec3) -> Option<[f64; 2]> {
        let stretches = self.iter().filter_map(|field| field.stretch(origin, direction));
        stretches.reduce(|[a, b], [begin, end]| [a.min(begin), b.max(end)])
    }
}

/// Matter that is clear up to one value and opaque from another on, straight in between.
#[derive(Clone, Copy, Debug)]
pub struct Ramp<'a, M: ?Sized = Field> {
    /// What has the values.
    pub matter: &'a M,
    /// The last value of opacity 0 and the first of opacity 1.
    pub values: [f64; 2],
}

impl<M: Matter + ?Sized> Matter for Ramp<'_, M> {
    fn at(&self, point: Vec3) -> f64 {
        self.matter.at(point)
    }

    fn stretch(&self, origin: Vec3, direction: Vec3) -> Option<[f64; 2]> {
        self.matter.stretch(origin, direction)
    }

    fn opacity(&self, value: f64) -> f64 {
        let [clear, opaque] = self.values;
        ((value - clear) / (opaque - clear)).clamp(0.0, 1.0)
    }
}

/// What a medium of a field does with light.
#[derive(Clone, Copy, Debug)]
pub struct Medium {
    /// Albedo, linear RGB, of value 0 and of value 1, straight between.
    pub albedo: [[f64; 3]; 2],
    /// Extinction of opacity 1, 1/m.
    pub extinction: f64,
    /// Radiance from all around, linear RGB.
    pub ambient: [f64; 3],
    /// Mean cosine of the phase function.
    pub g: f64,
}

/// A field, or other matter, in a light.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a, M: ?Sized = Field> {
    /// What is seen.
    pub field: &'a M,
    /// What it does with light.
    pub medium: Medium,
    /// Where the light is.
    pub light: Light,
    /// Irradiance or intensity, linear RGB.
    pub radiance: [f64; 3],
    /// Distance of samples, metres.
    pub step: f64,
}

impl<M: Matter + ?Sized> Scene<'_, M> {
    fn extinction(&self, value: f64) -> f64 {
        self.medium.extinction * self.field.opacity(value)
    }

    /// Optical depth from a point up to a distance.
    #[must_use]
    pub fn optical_depth(&self, origin: Vec3, direction: Vec3, limit: f64) -> f64 {
        let Some([begin, end]) = self.field.stretch(origin, direction) else { return 0.0 };
        let end = end.min(limit);
        if end <= begin {
            return 0.0;
        }
        let steps = ((end - begin) / self.step).ceil();
        let step = (end - begin) / steps;
        let sample = |i: u32| {
            let distance = begin + (f64::from(i) + 0.5) * step;
            self.extinction(self.field.at(origin + direction * distance))
        };
        (0..steps as u32).map(sample).sum::<f64>() * step
    }

    /// Radiance, linear RGB, and transmittance along a ray.
    #[must_use]
    pub fn ray(&self, origin: Vec3, direction: Vec3) -> [f64; 4] {
        let mut sum = [0.0; 3];
        let Some([begin, end]) = self.field.stretch(origin, direction) else { return [0.0, 0.0, 0.0, 1.0] };
        let steps = ((end - begin) / self.step).ceil();
        let step = (end - begin) / steps;
        let mut transmittance = 1.0_f64;
        for i in 0..steps as u32 {
            let point = origin + direction * (begin + (f64::from(i) + 0.5) * step);
            let value = self.field.at(point).min(1.0);
            if self.extinction(value) <= 0.0 {
                continue;
            }
            let through = (-self.extinction(value) * step).exp();
            let towards = self.light.towards(point);
            let limit = match self.light {
                Light::Directional { .. } => f64::INFINITY,
                Light::Spot { position, .. } | Light::Point { position, .. } => (position - point).length(),
            };
            let clear = self.light.irradiance(point);
            let arriving =
                if clear > 0.0 { clear * (-self.optical_depth(point, towards, limit)).exp() } else { 0.0 };
            let phase = henyey_greenstein(towards.dot(direction), self.medium.g);
            for (channel, sum) in sum.iter_mut().enumerate() {
                let [none, full] = self.medium.albedo.map(|albedo| albedo[channel]);
                let albedo = none + (full - none) * value;
                let source = self.medium.ambient[channel] + self.radiance[channel] * arriving * phase;
                *sum += transmittance * (1.0 - through) * albedo * source;
            }
            transmittance *= through;
        }
        [sum[0], sum[1], sum[2], transmittance]
    }

    /// All pixels, row after row.
    #[must_use]
    pub fn picture(&self, camera: &Camera, [width, height]: [usize; 2]) -> Vec<[f64; 4]> {
        let row = |y: usize| -> Vec<[f64; 4]> {
            let pixel = |x: usize| {
                let ndc = Camera::pixel_ndc(x, y, width, height);
                self.ray(camera.origin(ndc), camera.ray(ndc))
            };
            (0..width).map(pixel).collect()
        };
        parallel::rows(height, row).into_iter().flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity() -> Mat4 {
        Mat4::from_rows([
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ])
    }

    #[test]
    fn kernels_hold_one_and_end_without_a_kink() {
        for (sigma, radius) in [(0.7, 2.25), (0.6, 2.0), (1.5, 4.0)] {
            let kernel = Kernel::new(sigma, radius);
            // Over spheres instead of cubes.
            let shells = 20_000;
            let step = radius / f64::from(shells);
            let shell = |i: u32| {
                let r = (f64::from(i) + 0.5) * step;
                4.0 * std::f64::consts::PI * r * r * kernel.value(r * r) * step
            };
            let held: f64 = (0..shells).map(shell).sum();
            assert!((held - 1.0).abs() < 1e-5, "{held}");
            let near = radius - 1e-4;
            assert!(kernel.value(near * near) / kernel.value(0.0) < 1e-7 && kernel.value(near * near) > 0.0);
        }
    }

    #[test]
    fn a_constant_field_is_constant_and_absorbs_by_the_law_of_beer_and_lambert() {
        let size = [9, 12, 9];
        let kernel = Kernel::new(0.7, 2.25);
        let (world_from_voxel, voxel_from_world) = (identity(), identity());
        let field = Field { size, values: vec![0.5; 9 * 12 * 9], world_from_voxel, voxel_from_world, kernel };
        for place in [Vec3::new(4.0, 5.0, 4.0), Vec3::new(4.5, 5.5, 3.6)] {
            assert!((field.at(place) / 0.5 - 1.0).abs() < 5e-3, "{}", field.at(place));
        }
        let medium = Medium { albedo: [[1.0; 3]; 2], extinction: 0.4, ambient: [1.0; 3], g: 0.0 };
        let light = Light::Directional { towards: Vec3::new(0.0, 1.0, 0.0) };
        let scene = Scene { field: &field, medium, light, radiance: [0.0; 3], step: 0.1 };
        let [red, _, _, transmittance] = scene.ray(Vec3::new(4.0, 30.0, 4.0), Vec3::new(0.0, -1.0, 0.0));
        let expected = (-0.2_f64 * 12.0).exp();
        assert!((transmittance / expected - 1.0).abs() < 5e-3, "{transmittance}");
        // What is not let through is scattered ambient light.
        assert!((red + transmittance - 1.0).abs() < 1e-9);
        assert_eq!(scene.ray(Vec3::new(40.0, 30.0, 4.0), Vec3::new(0.0, -1.0, 0.0)), [0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn fields_add_up_and_ramps_classify_their_sum() {
        let size = [5, 5, 5];
        let kernel = Kernel::new(0.7, 2.25);
        let field = |place: f64| {
            let mut world_from_voxel = identity();
            world_from_voxel.columns[3][0] = place;
            let voxel_from_world = world_from_voxel.inverse().unwrap();
            Field { size, values: vec![0.2; 125], world_from_voxel, voxel_from_world, kernel }
        };
        let fields = [field(0.0), field(3.0), field(100.0)];
        let place = Vec3::new(2.5, 2.0, 2.0);
        let sum: f64 = fields.iter().map(|field| field.at(place)).sum();
        assert!((fields[..].at(place) - sum).abs() < 1e-15 && sum > 0.3);
        let along = Vec3::new(1.0, 0.0, 0.0);
        let all = fields[..].stretch(Vec3::new(-10.0, 2.0, 2.0), along);
        assert_eq!(all, Some([7.75, 116.25]));
        assert_eq!(fields[..].stretch(Vec3::new(-10.0, 20.0, 2.0), along), None);
        let ramp = Ramp { matter: &fields[..], values: [0.1, 0.3] };
        assert_eq!(
            [0.0, 0.1, 0.2, 0.3, 5.0].map(|value| (ramp.opacity(value) * 1e9).round()),
            [0.0, 0.0, 5e8, 1e9, 1e9]
        );
        assert_eq!(fields[..].opacity(5.0), 1.0);
    }
}
