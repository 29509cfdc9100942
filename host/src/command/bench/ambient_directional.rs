// SPDX-License-Identifier: MIT OR Apache-2.0
//! What bent cones save over looking up the light of each direction (thesis 3.5, Fig. 3.11): at equal error against rays, most of which is of
//! the screen and of both, and at equal noise, the difference to what each becomes with very many directions.

use super::ambient::{RADIUS, SAMPLES, SYSTEM, Scene};
use super::baselines::with_baselines;
use super::ssdo::{Spread, Ssdo};
use super::{Quality, Row, figure, interleaved, ratio, time};
use crate::ambient::{
    AmbientError, BentForm, BentPasses, Blurring, ConeLight, ConeLightForm, Method, OcclusionSettings,
    Sampling, ShadePass, environment_texture,
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
/// Directions of what has no noise.
const MANY: u32 = 256;
/// Texels of environments that cones can follow.
const LOW_PASS: [u32; 2] = [32, 16];

/// Colours of some pixels; none where there is no surface.
type Colours = Vec<Option<[f32; 3]>>;

/// Every figure, for each map.
pub fn rows(gpu: &Gpu, shaders: &Shaders, scene: &Scene) -> Result<Vec<Row>, CommandError> {
    let ssdo = Ssdo::new(gpu, &with_baselines(shaders), Spread::Cosine)?;
    let form = BentForm {
        sampling: Sampling::Hemisphere,
        blurring: Blurring::Difference,
        occlusion_only: false,
        halved: false,
    };
    let bent = BentPasses::new(gpu, shaders, form)?;
    let shade = ShadePass::new(gpu, shaders, Method::Cones, false)?;
    let (seen, albedos) = (scene.images(), &scene.geometry.albedos);
    let settings = OcclusionSettings::new(RADIUS);
    let of = |samples: u32| OcclusionSettings { samples, ..settings };
    let mut encoder = gpu.encoder();
    let [few, many] =
        [bent.record(gpu, &mut encoder, seen, &settings)?, bent.record(gpu, &mut encoder, seen, &of(MANY))?];
    gpu.submit(encoder)?;
    let mut rows = Vec::new();
    for map in ["forest", "sunset"] {
        let light = environment(Path::new(map))?.resized(LOW_PASS);
        let cones =
            ConeLight::new(gpu, shaders, &light, ConeLightForm::default()).map_err(CommandError::failure)?;
        let radiance = environment_texture(gpu, &light)?;
        let truth: Colours = trace(&scene.mesh, Some(&light), &scene.camera, RAYS, Some(RADIUS), STRIDE)
            .iter()
            .map(|seen| seen.as_ref().map(|seen| seen.radiance.to_array()))
            .collect();
        let shaded = |encoder: &mut wgpu::CommandEncoder, found: &Texture| {
            shade.record(gpu, encoder, seen, albedos, found, &cones.cones)
        };
        let by_cones = |encoder: &mut wgpu::CommandEncoder| -> Result<Texture, AmbientError> {
            let found = bent.record(gpu, encoder, seen, &settings)?;
            shaded(encoder, &found)
        };
        let looked_up = |encoder: &mut wgpu::CommandEncoder, samples: u32| {
            ssdo.record(gpu, encoder, seen, &of(samples), albedos, &radiance)
        };
        let own = drawn(gpu, |encoder| shaded(encoder, &few))?;
        let own_noise = error(&own, &drawn(gpu, |encoder| shaded(encoder, &many))?);
        let own = error(&own, &truth);
        let limit = drawn(gpu, |encoder| looked_up(encoder, MANY))?;
        let mut tried = Vec::new();
        for samples in COUNTS {
            let picture = drawn(gpu, |encoder| looked_up(encoder, samples))?;
            tried.push((samples, error(&picture, &truth), error(&picture, &limit)));
        }
        // The least number that is as good; where none is, the greatest.
        let last = tried[tried.len() - 1];
        let equal = tried.iter().find(|(_, error, _)| *error <= own).unwrap_or(&last);
        let quiet = tried.iter().find(|(.., noise)| *noise <= own_noise).unwrap_or(&last);
        // The only errors are of settings, which the quality has met.
        let times = interleaved(
            gpu,
            &[&|encoder| drop(by_cones(encoder)), &|encoder| drop(looked_up(encoder, equal.0)), &|encoder| {
                drop(looked_up(encoder, quiet.0))
            }],
            SAMPLES,
        )?;
        let compared = [
            ("", equal, &times[1], "RMSE of radiance over its RMS", own, equal.1),
            ("_equal_noise", quiet, &times[2], "RMS noise of radiance over its RMS", own_noise, quiet.2),
        ];
        rows.push(time(SYSTEM, format!("cones_{map}"), times[0].clone()));
        for (kind, (count, ..), list, metric, error, baseline_error) in compared {
            let quality = Quality { metric, error, baseline_error };
            let name = format!("ssdo_over_cones{kind}_{map}");
            rows.push(ratio(SYSTEM, name, list, &times[0], "higher", Some(quality)));
            rows.push(time(SYSTEM, format!("ssdo{kind}_{map}"), list.clone()));
            rows.push(figure(SYSTEM, format!("ssdo_samples{kind}_{map}"), f64::from(*count), "directions"));
        }
    }
    Ok(rows)
}

/// Colours of every [`STRIDE`]'s pixel of a picture that is recorded.
fn drawn(
    gpu: &Gpu,
    record: impl Fn(&mut wgpu::CommandEncoder) -> Result<Texture, AmbientError>,
) -> Result<Colours, CommandError> {
    let mut encoder = gpu.encoder();
    let picture = record(&mut encoder)?;
    gpu.submit(encoder)?;
    let texels = picture.read(gpu)?;
    let [width, height, _] = picture.size();
    let places = |side: u32| (STRIDE / 2..side).step_by(STRIDE as usize);
    let pixels = places(height).flat_map(|y| places(width).map(move |x| 4 * (y * width + x) as usize));
    let colour = |at: usize| (texels[at + 3] == 1.0).then(|| [0, 1, 2].map(|c| texels[at + c]));
    Ok(pixels.map(colour).collect())
}

/// RMSE over the RMS of what is expected, where both have a surface.
fn error(found: &Colours, expected: &Colours) -> f64 {
    let pairs = found.iter().zip(expected).filter_map(|(found, expected)| found.zip(*expected));
    let (found, expected): (Vec<[f32; 3]>, Vec<[f32; 3]>) = pairs.unzip();
    airlight_tests::error::relative_rmse(found.as_flattened(), expected.as_flattened())
}
