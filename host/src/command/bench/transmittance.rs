// SPDX-License-Identifier: MIT OR Apache-2.0
//! The named figures of the system `transmittance`: errors of the forms of map against f64, pictures of media, costs.

use super::light_rays::LightRays;
use super::{Quality, Row, figure, interleaved, media_pictures, ratio, time};
use crate::command::{CommandError, progress};
use crate::core::{Light, Reading};
use crate::data::{Particles, burst, plume};
use crate::transmittance::{
    Form, MapSettings, ParticleBuffer, Precision, Splat, SplatFixed, TransmittanceMap, Voxels,
};
use crate::{Gpu, Shaders};
use airlight_tests::media::{Medium, STEPS, Uniform, medium};
use glam::Vec3;

/// Name of the system in its rows.
pub const SYSTEM: &str = "transmittance";
/// The map of the costs.
pub const MAP: [u32; 2] = [1024, 1024];
const SAMPLES: usize = 5;
/// Optical depths of the named ratios.
const DENSE: [f64; 4] = [4.0, 8.0, 12.0, 16.0];
/// Rays at each of them.
const RAYS: usize = 32;

/// Every named figure.
pub fn rows(gpu: &Gpu, shaders: &Shaders, quiet: bool) -> Result<Vec<Row>, CommandError> {
    let bar = progress::bar(5, quiet);
    let mut rows = Vec::new();
    bar.set_message("errors along light rays");
    rows.extend(errors(gpu, shaders)?);
    bar.inc(1);
    bar.set_message("plume of 16 coefficients");
    rows.extend(media_pictures::plume_errors(gpu, shaders)?);
    bar.inc(1);
    bar.set_message("pictures of a cloud");
    rows.extend(media_pictures::cloud_errors(gpu, shaders)?);
    bar.inc(1);
    bar.set_message("marched plume 1280x720");
    rows.extend(media_pictures::brute_force(gpu, shaders)?);
    bar.inc(1);
    bar.set_message("maps of voxels and of particles");
    rows.extend(builds(gpu, shaders)?);
    rows.extend(particles(gpu, shaders, &[10_000, 100_000])?);
    bar.finish_and_clear();
    Ok(rows)
}

/// Rays of a kind, `RAYS` at each of [`DENSE`].
fn rays(kinds: &[Medium]) -> LightRays {
    let mut random = Uniform(77);
    let mut all = Vec::new();
    for total in DENSE {
        for i in 0..RAYS {
            all.push(medium(kinds[i % kinds.len()], STEPS, total, &mut || random.unit()));
        }
    }
    LightRays::new(all)
}

/// What errors of transmittance are.
const ERROR: &str = "mean absolute error of transmittance";

/// The mean of `over` over that of `under`; samples pair by pair.
fn error_ratio(name: &str, over: &[f64], under: &[f64]) -> Row {
    let mean = airlight_tests::statistics::mean;
    let (error, baseline_error) = (mean(over), mean(under));
    let quality = Quality { metric: ERROR, error, baseline_error };
    let row = ratio(SYSTEM, name, over, under, "lower", Some(quality));
    Row { value: error / baseline_error, ..row }
}

/// Four coefficients each, optical depth 4 to 16, read in the middles of texels and between them.
fn errors(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let cases: [(&str, &[Medium], Form, Form); 4] = [
        ("etm_error_over_tfm_smooth", &[Medium::Smooth], Form::Extinction, Form::Function),
        ("etm_error_over_tfm_fourier", &[Medium::Smoke], Form::Extinction, Form::FunctionPeriodic),
        ("etm_error_over_tfm_smoke", &[Medium::Smoke], Form::Extinction, Form::Function),
        (
            "bounded_error_over_etm",
            &[Medium::ShortBoxes, Medium::ShortBursts],
            Form::Bounded,
            Form::Extinction,
        ),
    ];
    let mut rows = Vec::new();
    for (name, kinds, own, baseline) in cases {
        let rays = rays(kinds);
        let of = |form| rays.filtered_errors(gpu, shaders, (form, 4), RAYS);
        rows.push(error_ratio(name, &of(own)?, &of(baseline)?));
    }
    Ok(rows)
}

/// Cost of building from voxels, by form.
fn builds(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let volume = plume([64, 160, 64], 9);
    let light = Light::directional_leaning(Vec3::new(0.5, 0.8, 0.3), Vec3::ONE, volume.occupied_points())
        .map_err(CommandError::failure)?;
    let uploaded = media_pictures::uploaded(gpu, shaders, &volume)?;
    let forms = [(Form::Extinction, 4), (Form::Function, 4), (Form::Bounded, 4), (Form::Extinction, 16)];
    let mut built = Vec::new();
    for (form, coefficients) in forms {
        let settings =
            MapSettings { precision: Precision::Half, ..MapSettings::new(form, coefficients, MAP) };
        let map = TransmittanceMap::new(gpu, settings, &light).map_err(CommandError::failure)?;
        let voxels = Voxels::new(gpu, shaders, settings, Reading::Linear).map_err(CommandError::failure)?;
        let bound = voxels.bind(gpu, &map, &uploaded).map_err(CommandError::failure)?;
        built.push((voxels, bound, map));
    }
    let records: Vec<_> = built
        .iter()
        .map(|(voxels, bound, _)| move |encoder: &mut wgpu::CommandEncoder| voxels.record(encoder, bound))
        .collect();
    let works: Vec<super::Work<'_>> = records.iter().map(|record| record as super::Work<'_>).collect();
    let samples = interleaved(gpu, &works, SAMPLES)?;
    let mut rows = vec![ratio(SYSTEM, "etm_build_over_tfm", &samples[0], &samples[1], "lower", None)];
    for ((form, coefficients), list) in forms.iter().zip(samples) {
        rows.push(time(SYSTEM, format!("build_{}_{coefficients}", form_name(*form)), list));
    }
    Ok(rows)
}

/// Name of a form in rows.
pub fn form_name(form: Form) -> &'static str {
    match form {
        Form::Extinction => "etm",
        Form::Bounded => "bounded",
        Form::Opacity => "fom",
        Form::Function => "tfm",
        Form::FunctionPeriodic => "tfm_fourier",
        Form::PowerMoments => "power_moments",
        Form::TrigonometricMoments => "trigonometric_moments",
    }
}

/// Particles of a burst that keep their size, whatever their number.
fn even_burst(count: usize) -> Particles {
    let mut particles = burst(count, 9);
    for particle in &mut particles.list {
        particle.radius = 0.02;
        particle.extinction *= 1e4 / count as f32;
    }
    particles
}

/// Cost of a map of particles of one size by their number, blended and in fixed point; and that of a particle
/// by the most of them over that by the fewest.
pub fn particles(gpu: &Gpu, shaders: &Shaders, counts: &[usize]) -> Result<Vec<Row>, CommandError> {
    let half = MapSettings { precision: Precision::Half, ..MapSettings::new(Form::Extinction, 4, MAP) };
    let light = Light::directional(Vec3::new(0.5, 0.8, 0.3), Vec3::ONE, Vec3::splat(-2.5), Vec3::splat(2.5))
        .map_err(CommandError::failure)?;
    let map = TransmittanceMap::new(gpu, half, &light).map_err(CommandError::failure)?;
    let single_settings = MapSettings::new(Form::Extinction, 4, MAP);
    let single = TransmittanceMap::new(gpu, single_settings, &light).map_err(CommandError::failure)?;
    let splat = Splat::new(gpu, shaders, half).map_err(CommandError::failure)?;
    let fixed = SplatFixed::new(gpu, shaders, single_settings).map_err(CommandError::failure)?;
    let mut rows = Vec::new();
    let mut each: [Vec<f64>; 2] = Default::default();
    for count in counts {
        let buffer = ParticleBuffer::new(gpu, &even_burst(*count)).map_err(CommandError::failure)?;
        let bound = splat.bind(gpu, &map, &buffer).map_err(CommandError::failure)?;
        let bound_fixed = fixed.bind(gpu, &single, &buffer).map_err(CommandError::failure)?;
        let samples = interleaved(
            gpu,
            &[&|encoder| splat.record(encoder, &bound, &map, &buffer), &|encoder| {
                // The only error is a missing entry point, which its other calls would have found.
                let _ = fixed.record(encoder, &bound_fixed);
            }],
            3,
        )?;
        for ((name, list), each) in ["splat", "splat_fixed"].iter().zip(samples).zip(&mut each) {
            each.push(super::median(&list) / *count as f64);
            rows.push(time(SYSTEM, format!("{name}_{count}"), list));
        }
    }
    for (name, each) in ["splat", "splat_fixed"].iter().zip(&each) {
        if let (Some(first), Some(last)) = (each.first(), each.last()) {
            let name = format!("{name}_particle_cost_most_over_fewest");
            rows.push(figure(SYSTEM, name, last / first, "ratio"));
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_of_errors_are_of_their_means() {
        let row = error_ratio("x", &[1.0, 2.0], &[2.0, 8.0]);
        assert!((row.value - 0.3).abs() < 1e-12);
        assert_eq!(row.samples, [0.5, 0.25]);
        assert_eq!(row.quality.map(|q| (q.error, q.baseline_error)), Some((1.5, 5.0)));
    }

    #[test]
    fn even_bursts_keep_the_size_of_particles_and_thin_them() {
        let total = |count| {
            let list = even_burst(count).list;
            assert!(list.iter().all(|p| p.radius == 0.02));
            list.iter().map(|p| p.extinction).sum::<f32>()
        };
        assert!((total(1000) / total(10_000) - 1.0).abs() < 0.05);
    }
}
