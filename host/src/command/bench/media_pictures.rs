// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures of a cloud and of a plume through transmittance maps, against brute force in cost and against f64 in error.

use super::light_rays::answers;
use super::transmittance::{MAP, SYSTEM, form_name};
use super::{Quality, Row, figure, interleaved, ratio, time};
use crate::command::CommandError;
use crate::core::{Bricks, Camera, DepthRange, Light, PerspectiveView, Reading, VolumeTexture};
use crate::data::{Random, Volume, cloud, plume};
use crate::transmittance::{
    Form, MapSettings, MediumLighting, MediumView, Precision, TransmittanceMap, VolumePicture,
    VolumePictureBound, Voxels,
};
use crate::{Bound, Buffer, Gpu, Shaders, Texture};
use airlight_tests::error::{max_absolute, mean_absolute, relative_rmse};
use airlight_tests::linear;
use airlight_tests::parallel;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::transmittance::{Grid, View};
use glam::{Mat4, Vec3};

/// The picture of the costs.
const SIZE: [u32; 2] = [1280, 720];
/// Every how many of its columns and rows the f64 picture is evaluated, odd: then middles of pixels are middles of coarse ones.
const STRIDE: [u32; 2] = [5, 15];
/// Samples of each piece of work.
const SAMPLES: usize = 3;
/// What errors of pictures are.
const RADIANCE: &str = "relative RMSE of radiance against f64";

/// A volume before a camera, under a light.
struct Medium {
    volume: Volume,
    uploaded: VolumeTexture,
    view: PerspectiveView,
    light: Light,
    lighting: MediumLighting,
    camera_buffer: Buffer,
    light_buffer: Buffer,
    lighting_buffer: Buffer,
    depth: Texture,
}

impl Medium {
    fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        volume: Volume,
        (eye, target): (Vec3, Vec3),
        towards: Vec3,
        size: [u32; 2],
    ) -> Result<Self, CommandError> {
        let light = Light::directional_leaning(towards, Vec3::new(3.0, 2.5, 2.0), volume.occupied_points())
            .map_err(CommandError::failure)?;
        let lighting =
            MediumLighting::new(Vec3::new(0.95, 0.9, 0.8), 0.4, 100.0).map_err(CommandError::failure)?;
        let depth_range = DepthRange::Forward;
        let view =
            PerspectiveView { eye, target, field_of_view: 40.0, near: 0.1, far: 60.0, depth: depth_range };
        let camera = Camera::perspective(&view, size).map_err(CommandError::failure)?;
        let depth = Texture::storage(gpu, size, wgpu::TextureFormat::R32Float);
        depth.write(gpu, &vec![camera.far_depth; (size[0] * size[1]) as usize])?;
        let uploaded = uploaded(gpu, shaders, &volume)?;
        Ok(Self {
            uploaded,
            camera_buffer: Buffer::uniform(gpu, &camera),
            light_buffer: Buffer::uniform(gpu, &light),
            lighting_buffer: Buffer::uniform(gpu, &lighting),
            volume,
            view,
            light,
            lighting,
            depth,
        })
    }

    fn seen(&self) -> MediumView<'_> {
        MediumView { camera: &self.camera_buffer, lighting: &self.lighting_buffer, depth: &self.depth }
    }

    /// The picture by a march in f64, steps `voxels` of a voxel: RGB of the middle pixel of each block of `stride` pixels.
    fn exact(&self, stride: [u32; 2], voxels: f64) -> Result<Vec<f64>, CommandError> {
        let wide = |v: Vec3| linear::Vec3::from(v.to_array());
        let full = self.depth.size();
        let camera = Camera::perspective(&self.view, [full[0], full[1]]).map_err(CommandError::failure)?;
        let matrix = linear::Mat4::from(camera.clip_from_world.to_cols_array());
        let far = f64::from(camera.far_depth);
        let no_inverse = || CommandError::failure("a matrix has no inverse");
        let reference = ReferenceCamera::from_matrix(matrix, far).ok_or_else(no_inverse)?;
        let [width, height] = [0, 1].map(|axis| (full[axis] / stride[axis]) as usize);
        let view = View {
            camera: &reference,
            width,
            height,
            depth: &vec![camera.far_depth; width * height],
            distance_limit: f64::from(self.lighting.distance_limit),
            light: wide(self.light.direction),
            radiance: self.light.radiance.to_array().map(f64::from),
            albedo: self.lighting.albedo.to_array().map(f64::from),
            g: f64::from(self.lighting.g),
        };
        let grid = grid(&self.volume)?;
        let bounds = self.volume.bounds();
        let centre = wide(0.5 * (bounds.min + bounds.max));
        let radius = 0.5 * f64::from((bounds.max - bounds.min).length());
        let step = voxels * f64::from(self.volume.voxel());
        Ok(colors(&view.marched(|point| grid.extinction(point), (centre, radius), step)))
    }

    /// Through a map, ready to run; or by brute force.
    fn lit(&self, gpu: &Gpu, shaders: &Shaders, settings: Option<MapSettings>) -> Result<Lit, CommandError> {
        let Some(settings) = settings else {
            let pass =
                VolumePicture::reference(gpu, shaders, Reading::Linear).map_err(CommandError::failure)?;
            let bound = pass
                .bind_reference(gpu, &self.seen(), &self.light_buffer, &self.uploaded)
                .map_err(CommandError::failure)?;
            return Ok(Lit { map: None, pass, bound });
        };
        let map = TransmittanceMap::new(gpu, settings, &self.light).map_err(CommandError::failure)?;
        let voxels = Voxels::new(gpu, shaders, settings, Reading::Linear).map_err(CommandError::failure)?;
        let built = voxels.bind(gpu, &map, &self.uploaded).map_err(CommandError::failure)?;
        let pass = VolumePicture::new(gpu, shaders, settings, false, Reading::Linear)
            .map_err(CommandError::failure)?;
        let bound = pass.bind(gpu, &self.seen(), &map, &self.uploaded).map_err(CommandError::failure)?;
        Ok(Lit { map: Some((voxels, built)), pass, bound })
    }
}

/// A picture, ready to run.
struct Lit {
    map: Option<(Voxels, Bound)>,
    pass: VolumePicture,
    bound: VolumePictureBound,
}

impl Lit {
    /// The map, and the picture.
    fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.record_map(encoder);
        self.record_picture(encoder);
    }

    fn record_map(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some((voxels, bound)) = &self.map {
            voxels.record(encoder, bound);
        }
    }

    fn record_picture(&self, encoder: &mut wgpu::CommandEncoder) {
        self.pass.record(encoder, &self.bound);
    }

    /// Runs both; RGB of every `stride`-th pixel, from the middle of the first block of pixels on.
    fn picture(&self, gpu: &Gpu, stride: [u32; 2]) -> Result<Vec<f32>, CommandError> {
        let mut encoder = gpu.encoder();
        self.record(&mut encoder);
        gpu.submit(encoder)?;
        let width = self.bound.picture.size()[0] as usize;
        let picture = self.bound.picture.read(gpu).map_err(CommandError::failure)?;
        Ok(colors(&every(&picture, width, stride.map(|side| side as usize))))
    }
}

/// A volume whose bricks are known.
pub fn uploaded(gpu: &Gpu, shaders: &Shaders, volume: &Volume) -> Result<VolumeTexture, CommandError> {
    let mut uploaded =
        VolumeTexture::new(gpu, volume, 1.0, Reading::Linear).map_err(CommandError::failure)?;
    Bricks::new(gpu, shaders)
        .and_then(|bricks| bricks.give(gpu, &mut uploaded))
        .map_err(CommandError::failure)?;
    Ok(uploaded)
}

fn grid(volume: &Volume) -> Result<Grid<'_>, CommandError> {
    let matrix = linear::Mat4::from(volume.world_from_unit.to_cols_array());
    let unit_from_world =
        matrix.inverse().ok_or_else(|| CommandError::failure("the volume has no inverse"))?;
    let size = volume.size.map(|side| side as usize);
    Ok(Grid { size, values: &volume.values, unit_from_world, linear: true })
}

/// The middle pixel, four values, of each block of `stride` pixels.
fn every(picture: &[f32], width: usize, stride: [usize; 2]) -> Vec<f32> {
    let middle = stride.map(|side| side / 2);
    let height = picture.len() / (4 * width);
    let rows = (0..height / stride[1]).map(|row| row * stride[1] + middle[1]);
    rows.flat_map(|y| {
        (0..width / stride[0]).flat_map(move |column| {
            let first = 4 * (y * width + column * stride[0] + middle[0]);
            picture[first..first + 4].to_vec()
        })
    })
    .collect()
}

/// RGB of RGBA.
fn colors<T: Copy>(picture: &[T]) -> Vec<T> {
    picture.chunks_exact(4).flat_map(|pixel| pixel[..3].to_vec()).collect()
}

/// A marched plume lit through a map, the map's building counted in, against marches to the light from every step.
pub fn brute_force(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    // Smoke fills the picture.
    let target = Vec3::new(0.0, 3.0, 0.0);
    let place = (target + Vec3::new(0.6, 0.1, 1.2), target);
    let volume = plume([192, 480, 192], 9);
    let medium = Medium::new(gpu, shaders, volume, place, Vec3::new(0.5, 0.8, 0.3), SIZE)?;
    let settings = |form, coefficients| MapSettings {
        precision: Precision::Half,
        ..MapSettings::new(form, coefficients, MAP)
    };
    let plain = medium.lit(gpu, shaders, Some(settings(Form::Extinction, 4)))?;
    let bounded = medium.lit(gpu, shaders, Some(settings(Form::Bounded, 4)))?;
    let brute = medium.lit(gpu, shaders, None)?;
    let samples = interleaved(
        gpu,
        &[
            &|encoder| brute.record(encoder),
            &|encoder| plain.record(encoder),
            &|encoder| bounded.record(encoder),
            &|encoder| plain.record_map(encoder),
            &|encoder| plain.record_picture(encoder),
        ],
        SAMPLES,
    )?;
    let exact = medium.exact(STRIDE, 0.5)?;
    let error = |lit: &Lit| lit.picture(gpu, STRIDE).map(|picture| relative_rmse(&picture, &exact));
    let baseline_error = error(&brute)?;
    let mut rows = Vec::new();
    for (name, lit, list) in
        [("brute_force_over_etm", &plain, &samples[1]), ("brute_force_over_bounded", &bounded, &samples[2])]
    {
        let quality = Quality { metric: RADIANCE, error: error(lit)?, baseline_error };
        rows.push(ratio(SYSTEM, name, &samples[0], list, "higher", Some(quality)));
    }
    for (name, list) in ["brute_force", "etm", "bounded", "etm_map", "etm_march"].iter().zip(samples) {
        rows.push(time(SYSTEM, format!("plume_{name}"), list));
    }
    Ok(rows)
}

/// Pictures of a cloud of an optical depth of 3 and of 10 under light from above, and of the dense one under a slanting light.
pub fn cloud_errors(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let size = [96, 72];
    let mut rows = Vec::new();
    for (name, density, turn, towards) in [
        ("cloud", 0.3, 0.0, Vec3::Y),
        ("dense_cloud", 1.0, 0.0, Vec3::Y),
        ("slanting_dense_cloud", 1.0, 0.6, Vec3::new(0.5, 0.8, 0.3)),
    ] {
        let mut volume = cloud([40, 24, 32], 9);
        volume.values.iter_mut().for_each(|value| *value *= density);
        volume.world_from_unit = Mat4::from_rotation_y(turn) * volume.world_from_unit;
        let medium =
            Medium::new(gpu, shaders, volume, (Vec3::new(4.0, 2.0, 8.0), Vec3::ZERO), towards, size)?;
        let exact = medium.exact([1, 1], 0.25)?;
        let brute = relative_rmse(&medium.lit(gpu, shaders, None)?.picture(gpu, [1, 1])?, &exact);
        for (form, coefficients) in [(Form::Extinction, 4), (Form::Extinction, 16), (Form::Bounded, 4)] {
            let settings = MapSettings::new(form, coefficients, [128, 128]);
            let picture = medium.lit(gpu, shaders, Some(settings))?.picture(gpu, [1, 1])?;
            let error = relative_rmse(&picture, &exact);
            let name = format!("picture_error_{name}_{}_{coefficients}", form_name(form));
            let quality = Quality { metric: RADIANCE, error, baseline_error: brute };
            rows.push(Row { quality: Some(quality), ..figure(SYSTEM, name, error, "fraction") });
        }
    }
    Ok(rows)
}

/// Mean and greatest error of transmittance at points inside a plume under a slanting light, 16 coefficients.
pub fn plume_errors(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    const POINTS: usize = 2000;
    /// Of a march to the light, in f64.
    const STEPS: usize = 400;
    /// Longer than the way to the light through the plume, metres.
    const WAY: f64 = 8.0;
    let mut volume = plume([32, 80, 32], 9);
    volume.world_from_unit = Mat4::from_rotation_y(0.6) * volume.world_from_unit;
    let light = Light::directional_leaning(Vec3::new(0.5, 0.8, 0.3), Vec3::ONE, volume.occupied_points())
        .map_err(CommandError::failure)?;
    let grid = grid(&volume)?;
    let wide = |v: Vec3| linear::Vec3::from(v.to_array());
    let mut random = Random::new(31);
    let points: Vec<Vec3> = std::iter::repeat_with(|| Vec3::new(random.unit(), random.unit(), random.unit()))
        .map(|unit| volume.world_from_unit.transform_point3(unit))
        .filter(|point| grid.extinction(wide(*point)) > 0.05)
        .take(POINTS)
        .collect();
    let direction = wide(light.direction);
    let step = WAY / STEPS as f64;
    let exact = parallel::rows(points.len(), |i| {
        let at = |k: usize| grid.extinction(wide(points[i]) + direction * ((k as f64 + 0.5) * step));
        (-(0..STEPS).map(at).sum::<f64>() * step).exp()
    });
    let uploaded = uploaded(gpu, shaders, &volume)?;
    let mut rows = Vec::new();
    for form in [Form::Extinction, Form::Bounded] {
        let settings = MapSettings::new(form, 16, [256, 256]);
        let found = answers((gpu, shaders), settings, &light, (&uploaded, Reading::Linear), &points)?;
        let name = |what: &str| format!("plume_error_{}_16_{what}", form_name(form));
        rows.push(figure(SYSTEM, name("mean"), mean_absolute(&found, &exact), "fraction"));
        rows.push(figure(SYSTEM, name("greatest"), max_absolute(&found, &exact), "fraction"));
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_pictures_are_of_the_middles_of_squares() {
        // 6 x 3 pixels whose values are their numbers.
        let picture: Vec<f32> = (0..18).flat_map(|i| [i as f32; 4]).collect();
        let middles = every(&picture, 6, [3, 3]);
        assert_eq!(middles, [[7.0_f32; 4], [10.0; 4]].concat());
        assert_eq!(every(&picture, 6, [1, 1]), picture);
        assert_eq!(every(&picture, 6, [3, 1])[..4], [1.0; 4]);
        assert_eq!(colors(&middles), [[7.0_f32; 3], [10.0; 3]].concat());
        let fits = |axis: usize| STRIDE[axis] % 2 == 1 && SIZE[axis].is_multiple_of(STRIDE[axis]);
        assert!(fits(0) && fits(1));
    }
}
