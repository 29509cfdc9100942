// SPDX-License-Identifier: MIT OR Apache-2.0
//! What bent cones save over looking up the light of each direction, at equal error (thesis 3.5, Fig. 3.11).

use super::ambient::{RADIUS, SAMPLES, SYSTEM, Scene};
use super::baselines::with_baselines;
use super::ssdo::{Spread, Ssdo, radiance_texture};
use super::{Quality, Row, figure, interleaved, ratio, time};
use crate::ambient::{
    AmbientError, BentForm, BentPasses, Blurring, ConeLight, ConeLightForm, Method, OcclusionSettings,
    Sampling, ShadePass,
};
use crate::command::CommandError;
use crate::command::ambient::traced::trace;
use crate::command::environments::environment;
use crate::{Gpu, Shaders, Texture};
use std::path::Path;

/// Numbers of directions that the competitor may take.
const COUNTS: [u32; 5] = [8, 12, 16, 24, 32];
/// One pixel of so many a side is traced: no multiple of the pattern's side, so that all places in the pattern are.
const STRIDE: u32 = 13;
/// Rays at each.
const RAYS: u32 = 512;
/// Texels of environments that cones can follow.
const LOW_PASS: [u32; 2] = [32, 16];

/// Every figure, for each map.
pub fn rows(gpu: &Gpu, shaders: &Shaders, scene: &Scene) -> Result<Vec<Row>, CommandError> {
    let competitors = with_baselines(shaders);
    let ssdo = Ssdo::new(gpu, &competitors, Spread::Cosine)?;
    let form = BentForm {
        sampling: Sampling::Hemisphere,
        blurring: Blurring::Difference,
        occlusion_only: false,
        halved: false,
    };
    let bent = BentPasses::new(gpu, shaders, form)?;
    let shade = ShadePass::new(gpu, shaders, Method::ExactCones, false)?;
    let (seen, albedos) = (scene.images(), &scene.geometry.albedos);
    let settings = OcclusionSettings::new(RADIUS);
    let mut rows = Vec::new();
    for map in ["forest", "sunset"] {
        let light = environment(Path::new(map))?.resized(LOW_PASS);
        let cones =
            ConeLight::new(gpu, shaders, &light, ConeLightForm::default()).map_err(CommandError::failure)?;
        let radiance = radiance_texture(gpu, &light)?;
        let truth: Vec<Option<[f32; 3]>> =
            trace(&scene.mesh, Some(&light), &scene.camera, RAYS, Some(RADIUS), STRIDE)
                .iter()
                .map(|seen| seen.as_ref().map(|seen| seen.radiance.to_array()))
                .collect();
        let by_cones = |encoder: &mut wgpu::CommandEncoder| -> Result<Texture, AmbientError> {
            let found = bent.record(gpu, encoder, seen, &settings)?;
            shade.record(gpu, encoder, seen, albedos, &found, &cones.cones)
        };
        let looked_up = |encoder: &mut wgpu::CommandEncoder, samples: u32| -> Result<Texture, AmbientError> {
            let settings = OcclusionSettings { samples, ..settings };
            ssdo.record(gpu, encoder, seen, &settings, albedos, &radiance)
        };
        let mut encoder = gpu.encoder();
        let picture = by_cones(&mut encoder)?;
        gpu.submit(encoder)?;
        let own = error(gpu, &picture, &truth)?;
        // The least number that is as good; where none is, the greatest.
        let (mut count, mut other) = (0, f64::INFINITY);
        for samples in COUNTS {
            if other <= own {
                break;
            }
            let mut encoder = gpu.encoder();
            let picture = looked_up(&mut encoder, samples)?;
            gpu.submit(encoder)?;
            (count, other) = (samples, error(gpu, &picture, &truth)?);
        }
        // The only errors are of settings, which the quality has met.
        let samples = interleaved(
            gpu,
            &[&|encoder| drop(looked_up(encoder, count)), &|encoder| drop(by_cones(encoder))],
            SAMPLES,
        )?;
        let quality = Quality { metric: "RMSE of radiance over its RMS", error: own, baseline_error: other };
        let name = format!("ssdo_over_cones_{map}");
        rows.push(ratio(SYSTEM, name, &samples[0], &samples[1], "higher", Some(quality)));
        rows.push(figure(SYSTEM, format!("ssdo_samples_{map}"), f64::from(count), "directions"));
        for (name, list) in ["ssdo", "cones"].iter().zip(samples) {
            rows.push(time(SYSTEM, format!("{name}_{map}"), list));
        }
    }
    Ok(rows)
}

/// RMSE of a picture over the RMS of what is true, where there is something: of every [`STRIDE`]'s pixel.
fn error(gpu: &Gpu, picture: &Texture, truth: &[Option<[f32; 3]>]) -> Result<f64, CommandError> {
    let texels = picture.read(gpu)?;
    let [width, height, _] = picture.size();
    let places = |side: u32| (STRIDE / 2..side).step_by(STRIDE as usize);
    let pixels = places(height).flat_map(|y| places(width).map(move |x| 4 * (y * width + x) as usize));
    let pairs = pixels.zip(truth).filter(|(at, _)| texels[at + 3] == 1.0);
    let (found, expected): (Vec<[f32; 3]>, Vec<[f32; 3]>) =
        pairs.filter_map(|(at, truth)| truth.map(|truth| ([0, 1, 2].map(|c| texels[at + c]), truth))).unzip();
    Ok(airlight_tests::error::relative_rmse(found.as_flattened(), expected.as_flattened()))
}
