// SPDX-License-Identifier: MIT OR Apache-2.0
//! What `airlight bench splatting` draws, and how far its pictures are from rays marched in f64.

use crate::command::{CommandError, scans};
use crate::core::{Camera, DepthRange, Light, PerspectiveView, Transfer};
use crate::data::{Volume, cloud};
use crate::splatting::{SheetFrame, SheetInputs, SheetLighting, SheetPicture, SheetSettings, Splats};
use crate::{Gpu, Shaders};
use airlight_tests::error::relative_rmse;
use airlight_tests::linear;
use airlight_tests::parallel;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::light::Light as ReferenceLight;
use airlight_tests::reference::splatting::{Field, Kernel, Medium, Ramp, Scene as ReferenceScene};
use glam::{Mat4, Vec3};

const RADIANCE: Vec3 = Vec3::new(9.0, 8.0, 7.0);
const ALBEDO: [f32; 3] = [0.9, 0.8, 0.7];
/// What errors of pictures are.
pub(super) const ERROR: &str = "relative RMSE of radiance from f64";

/// A volume before a camera in the light of the sun.
pub(super) struct Scene {
    pub(super) volume: Volume,
    /// Voxels of no greater value are left out.
    threshold: f32,
    /// The last value of opacity 0 and the first of opacity 1.
    ramp: [f32; 2],
    /// Where the opacity is 1, 1/m.
    extinction: f32,
    /// Columns and rows of the picture; the shadow buffer has as many.
    size: [u32; 2],
    /// How many sheets.
    pub(super) sheets: u32,
    /// Rows and columns of pixels that are marched in f64.
    grid: usize,
}

impl Scene {
    /// A cloud in a cube of 2 m of `side`^3 voxels, empty around it. Resolutions differ in nothing but the size of a voxel: all are made from one
    /// field, and a voxel has as many pixels, texels of the shadow buffer, and sheets. At 256^3 they are 512 x 512 and 128.
    pub(super) fn cloud(side: u32) -> Result<Self, CommandError> {
        let volume = resampled(&cloud([COARSE; 3], 5), side).map_err(CommandError::failure)?;
        Ok(Self {
            volume,
            threshold: 0.25,
            ramp: [0.0, 1.0],
            extinction: 12.0,
            size: [2 * side; 2],
            sheets: side / 2,
            grid: 6,
        })
    }

    /// The abdomen with a stent, values 0 to 1, in a box 2 m long: bones and the stent, less than 5 % of its voxels.
    pub(super) fn stent() -> Result<Self, CommandError> {
        let mut volume = scans::stent()?;
        let longest = volume.size.into_iter().max().unwrap_or(1) as f32;
        let sides = Vec3::from(volume.size.map(|side| side as f32)) * (2.0 / longest);
        volume.world_from_unit = Mat4::from_translation(-0.5 * sides) * Mat4::from_scale(sides);
        volume.values.iter_mut().for_each(|value| *value /= 32.0);
        let threshold = 3.0 / 32.0;
        let ramp = [threshold, 0.5];
        // Most pixels show nothing, so that more of them have to be compared.
        Ok(Self { volume, threshold, ramp, extinction: 40.0, size: [192; 2], sheets: 64, grid: 64 })
    }

    /// The same picture with every voxel drawn: what was left out has the least value that a half float holds.
    pub(super) fn filled(&self) -> Self {
        let mut volume = self.volume.clone();
        for value in &mut volume.values {
            if *value <= self.threshold {
                *value = f32::exp2(-24.0);
            }
        }
        Self { volume, threshold: 0.0, ..*self }
    }

    /// Share of voxels that are drawn.
    pub(super) fn occupied(&self) -> f64 {
        let drawn = self.volume.values.iter().filter(|value| **value > self.threshold).count();
        drawn as f64 / self.volume.values.len() as f64
    }

    pub(super) fn splats(&self, gpu: &Gpu, shaders: &Shaders) -> Result<Splats, CommandError> {
        Splats::new(gpu, shaders, &self.volume, self.threshold, None).map_err(CommandError::failure)
    }

    /// Of as many sheets and texels as the scene says.
    pub(super) fn settings(&self) -> SheetSettings {
        SheetSettings { count: self.sheets, light_size: self.size, ..SheetSettings::default() }
    }

    fn camera(&self) -> Result<Camera, CommandError> {
        let view = PerspectiveView {
            eye: Vec3::new(2.0, 1.4, 4.0),
            target: Vec3::ZERO,
            field_of_view: 36.0,
            near: 0.1,
            far: 20.0,
            depth: DepthRange::Forward,
        };
        Camera::perspective(&view, self.size).map_err(CommandError::failure)
    }

    fn light(&self) -> Result<Light, CommandError> {
        // Some 70 degrees from the way in which the eye looks; room for what splats reach beyond the box.
        let bounds = self.volume.bounds();
        let room = 2.25 * self.volume.voxel();
        Light::directional(Vec3::new(-0.7, 0.8, 0.4), RADIANCE, bounds.min - room, bounds.max + room)
            .map_err(CommandError::failure)
    }

    /// A picture of these splats, ready to be recorded.
    pub(super) fn picture<'s>(
        &self,
        gpu: &Gpu,
        shaders: &Shaders,
        splats: &'s Splats,
        settings: SheetSettings,
    ) -> Result<SheetPicture<'s>, CommandError> {
        let [clear, opaque] = self.ramp;
        let opacity = |i: u32| ((i as f32 / 1024.0 - clear) / (opaque - clear)).clamp(0.0, 1.0);
        let [r, g, b] = ALBEDO;
        let table: Vec<_> = (0..=1024).map(|i| [r, g, b, opacity(i)]).collect();
        let transfer = Transfer::new(gpu, &table).map_err(CommandError::failure)?;
        let inputs = SheetInputs::new(std::slice::from_ref(splats), &transfer);
        let picture =
            SheetPicture::new(gpu, shaders, inputs, settings, self.size).map_err(CommandError::failure)?;
        let lighting = SheetLighting::new(self.extinction);
        let frame = SheetFrame { camera: self.camera()?, light: self.light()?, lighting };
        picture.set(gpu, &frame).map_err(CommandError::failure)?;
        Ok(picture)
    }

    /// Pixels of the grid.
    fn pixels(&self) -> Vec<[usize; 2]> {
        let [width, height] = self.size.map(|side| side as usize);
        let grid = self.grid;
        let place = |i: usize, side: usize| (2 * i + 1) * side / (2 * grid);
        (0..grid * grid).map(|i| [place(i % grid, width), place(i / grid, height)]).collect()
    }

    /// Radiance of the pixels of the grid, marched in f64 through the voxels that are drawn.
    pub(super) fn exact(&self) -> Result<Vec<f64>, CommandError> {
        let no_inverse = || CommandError::failure("a matrix has no inverse");
        let matrix = |m: Mat4| linear::Mat4::from(m.to_cols_array());
        let camera = matrix(self.camera()?.clip_from_world);
        let camera = ReferenceCamera::from_matrix(camera, 1.0).ok_or_else(no_inverse)?;
        let size = Vec3::from(self.volume.size.map(|side| side as f32));
        let world_from_voxel = self.volume.world_from_unit
            * Mat4::from_scale(size.recip())
            * Mat4::from_translation(Vec3::splat(0.5));
        let drawn = |value: &f32| if *value > self.threshold { f64::from(*value) } else { 0.0 };
        let field = Field {
            size: self.volume.size.map(|side| side as usize),
            values: self.volume.values.iter().map(drawn).collect(),
            world_from_voxel: matrix(world_from_voxel),
            voxel_from_world: matrix(world_from_voxel).inverse().ok_or_else(no_inverse)?,
            kernel: Kernel::new(0.7, 2.25),
        };
        let albedo = ALBEDO.map(f64::from);
        let medium =
            Medium { albedo: [albedo; 2], extinction: f64::from(self.extinction), ambient: [0.0; 3], g: 0.0 };
        let towards = self.light()?.direction.as_dvec3().normalize();
        let towards = linear::Vec3::from(towards.to_array());
        let scene = ReferenceScene {
            field: &Ramp { matter: &field, values: self.ramp.map(f64::from) },
            medium,
            light: ReferenceLight::Directional { towards },
            radiance: RADIANCE.to_array().map(f64::from),
            step: f64::from(self.volume.voxel()),
        };
        let [width, height] = self.size.map(|side| side as usize);
        let pixels = self.pixels();
        let radiance = parallel::rows(pixels.len(), |i| {
            let ndc = ReferenceCamera::pixel_ndc(pixels[i][0], pixels[i][1], width, height);
            scene.ray(camera.origin(ndc), camera.ray(ndc))
        });
        Ok(radiance.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect())
    }

    /// [`ERROR`] of a picture that was drawn.
    pub(super) fn error(
        &self,
        gpu: &Gpu,
        picture: &SheetPicture<'_>,
        exact: &[f64],
    ) -> Result<f64, CommandError> {
        let texels = picture.picture.read(gpu)?;
        let start = |[x, y]: [usize; 2]| 4 * (y * self.size[0] as usize + x);
        let found: Vec<f32> =
            self.pixels().into_iter().flat_map(|pixel| texels[start(pixel)..][..3].to_vec()).collect();
        Ok(relative_rmse(&found, exact))
    }
}

/// Voxels along each side of the field that clouds are made from.
const COARSE: u32 = 128;

/// Share of the sides of the cube that the cloud fills.
const FILLED: f32 = 0.6;

/// A field of [`COARSE`]^3 voxels in the middle of a cube of 2 m of `side`^3, values 0 to 1, straight between voxels.
fn resampled(coarse: &Volume, side: u32) -> Result<Volume, crate::data::VolumeError> {
    let last = COARSE as usize - 1;
    // The voxels below and above a place, the share of the second, and whether the place is in the field.
    let between = |i: usize| {
        let unit = ((i as f32 + 0.5) / side as f32 - 0.5) / FILLED + 0.5;
        let below = (unit * COARSE as f32 - 0.5).clamp(0.0, last as f32);
        let first = below as usize;
        (first, (first + 1).min(last), below - first as f32, (0.0..=1.0).contains(&unit))
    };
    let side = side as usize;
    let places: Vec<_> = (0..side).map(between).collect();
    let value = |x: usize, y: usize, z: usize| coarse.values[(z * (last + 1) + y) * (last + 1) + x];
    let slices = parallel::rows(side, |z| {
        let (near, far, depth, deep) = places[z];
        let mut values = Vec::with_capacity(side * side);
        for (low, high, up, high_enough) in &places {
            for (left, right, along, inside) in &places {
                if !(deep && *high_enough && *inside) {
                    values.push(0.0);
                    continue;
                }
                let line = |y: usize, z: usize| {
                    value(*left, y, z) + along * (value(*right, y, z) - value(*left, y, z))
                };
                let plane = |z: usize| line(*low, z) + up * (line(*high, z) - line(*low, z));
                values.push((plane(near) + depth * (plane(far) - plane(near))) / 3.0);
            }
        }
        values
    });
    let space = Mat4::from_translation(Vec3::NEG_ONE) * Mat4::from_scale(Vec3::splat(2.0));
    Volume::new([side as u32; 3], slices.concat(), space)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn clouds_of_any_resolution_are_one() {
        let [coarse, fine] = [16, 32].map(|side| Scene::cloud(side).unwrap());
        let mean = |scene: &Scene| scene.volume.values.iter().sum::<f32>() / scene.volume.values.len() as f32;
        assert!((mean(&coarse) / mean(&fine) - 1.0).abs() < 0.05, "{} {}", mean(&coarse), mean(&fine));
        let (coarse, fine) = (coarse.occupied(), fine.occupied());
        assert!((coarse / fine - 1.0).abs() < 0.2 && fine > 0.01, "{coarse} {fine}");
    }

    #[test]
    fn pictures_are_what_rays_make_of_them() {
        let gpu = pollster::block_on(Gpu::new()).unwrap();
        let shaders = Shaders::builtin();
        let mut scene = Scene::cloud(32).unwrap();
        scene.sheets = 64;
        let splats = scene.splats(&gpu, &shaders).unwrap();
        let picture = scene.picture(&gpu, &shaders, &splats, scene.settings()).unwrap();
        let mut encoder = gpu.encoder();
        picture.record(&gpu, &mut encoder).unwrap();
        gpu.submit(encoder).unwrap();
        let exact = scene.exact().unwrap();
        assert!(exact.iter().any(|radiance| *radiance > 0.05));
        let error = scene.error(&gpu, &picture, &exact).unwrap();
        assert!(error < 0.03, "{error}");
    }

    #[test]
    fn the_stent_is_sparse_and_filled_up_it_is_the_same() {
        let stent = Scene::stent().unwrap();
        assert!((0.02..0.05).contains(&stent.occupied()), "{}", stent.occupied());
        let filled = stent.filled();
        assert_eq!(filled.occupied(), 1.0);
        for (value, full) in stent.volume.values.iter().zip(&filled.volume.values) {
            assert!(value == full || (*value <= stent.threshold && *full < 1e-7));
        }
    }
}
