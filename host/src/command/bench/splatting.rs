// SPDX-License-Identifier: MIT OR Apache-2.0
//! The named figures of the system `splatting`: what a splat costs, and what sorting and leaving out empty voxels save.

use super::splatting_scenes::{ERROR, Scene};
use super::{Quality, Row, Work, figure, interleaved, median, ratio, time};
use crate::command::{CommandError, progress};
use crate::splatting::{LightTransport, ScatteringSettings, SheetPicture, SheetSettings};
use crate::{Gpu, Shaders};

/// Name of the system in its rows.
pub(super) const SYSTEM: &str = "splatting";
/// Samples of each piece of work.
const SAMPLES: usize = 5;
/// Ways of light whose frames are measured over one of direct light, by the name of the row.
const TRANSPORTS: [(&str, LightTransport); 2] = [
    // As in the paper: light spreads by the thickness of a sheet.
    (
        "forward_scatter_overhead",
        LightTransport::Scattering(ScatteringSettings { cone: 60.0, free_path: 0.0, back: false, sweeps: 1 }),
    ),
    // The widest kernel that there is.
    (
        "forward_scatter_overhead_widest",
        LightTransport::Scattering(ScatteringSettings { cone: 60.0, free_path: 0.5, back: false, sweeps: 1 }),
    ),
];

/// Every named figure.
pub fn rows(gpu: &Gpu, shaders: &Shaders, quiet: bool) -> Result<Vec<Row>, CommandError> {
    let bar = progress::bar(3 + TRANSPORTS.len() as u64, quiet);
    let mut rows = Vec::new();
    bar.set_message("a splat, 256^3 and 64^3");
    rows.extend(splat_times(gpu, shaders)?);
    bar.inc(1);
    bar.set_message("sorted and scanning");
    rows.extend(sorted(gpu, shaders)?);
    bar.inc(1);
    bar.set_message("the stent, sparse and filled");
    rows.extend(sparse(gpu, shaders)?);
    bar.inc(1);
    for (name, transport) in TRANSPORTS {
        bar.set_message(name);
        rows.extend(overhead(gpu, shaders, name, transport)?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(rows)
}

/// Records all of a picture.
fn record(gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, picture: &SheetPicture<'_>) {
    // The only error is a missing entry point; it would leave the picture empty, which its own error shows.
    let _ = picture.record(gpu, encoder);
}

/// Draws a picture.
pub(super) fn run(gpu: &Gpu, picture: &SheetPicture<'_>) -> Result<(), CommandError> {
    let mut encoder = gpu.encoder();
    picture.record(gpu, &mut encoder).map_err(CommandError::failure)?;
    Ok(gpu.submit(encoder)?)
}

/// Records what is done for each splat: the sort, and the splats of all sheets for the eye and for the light.
fn record_splats(gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, picture: &SheetPicture<'_>) {
    let _ = picture.record_order(gpu, encoder);
    picture.record_eye_splats(encoder);
    picture.record_light_splats(encoder);
}

/// Time a splat of a cloud of 256^3 voxels over that of 64^3, by the time of what is done for each splat. The whole frame would say
/// less: what is done for each sheet over all pixels does not depend on the number of splats. Both have as many pixels, texels of
/// the shadow buffer and sheets a voxel, for a splat of fewer pixels and sheets is less work, and none of it due to the number of
/// splats: pictures of 512 x 512 and 128 x 128, 128 and 32 sheets.
fn splat_times(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let sides = [256, 64];
    let scenes = [Scene::cloud(sides[0])?, Scene::cloud(sides[1])?];
    let splats = [scenes[0].splats(gpu, shaders)?, scenes[1].splats(gpu, shaders)?];
    let [large, small] = [0, 1].map(|i| scenes[i].picture(gpu, shaders, &splats[i], scenes[i].settings()));
    let (large, small) = (large?, small?);
    run(gpu, &large)?;
    run(gpu, &small)?;
    let quality = Quality {
        metric: ERROR,
        error: scenes[0].error(gpu, &large, &scenes[0].exact()?)?,
        baseline_error: scenes[1].error(gpu, &small, &scenes[1].exact()?)?,
    };
    let works: [Work<'_>; 2] = [&|encoder| record_splats(gpu, encoder, &large), &|encoder| {
        record_splats(gpu, encoder, &small);
    }];
    let samples = interleaved(gpu, &works, SAMPLES)?;
    let mut rows = Vec::new();
    let mut each = Vec::new();
    for ((side, splats), list) in sides.iter().zip(&splats).zip(samples) {
        let count = splats.count() as f64;
        rows.push(figure(SYSTEM, format!("splats_{side}"), count, "splats"));
        rows.push(figure(SYSTEM, format!("splat_{side}"), 1e6 * median(&list) / count, "ns"));
        each.push(list.iter().map(|milliseconds| milliseconds / count).collect::<Vec<_>>());
        rows.push(time(SYSTEM, format!("order_and_splats_{side}"), list));
    }
    rows.insert(0, ratio(SYSTEM, "splat_time_256_over_64", &each[0], &each[1], "lower", Some(quality)));
    Ok(rows)
}

/// A frame of 128 sheets each of which looks at all splats, over one of sorted splats; the same bits come out.
fn sorted(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let mut scene = Scene::cloud(176)?;
    scene.sheets = 128;
    let splats = scene.splats(gpu, shaders)?;
    let settings = scene.settings();
    let sorted = scene.picture(gpu, shaders, &splats, settings)?;
    let scanning = scene.picture(gpu, shaders, &splats, SheetSettings { scanning: true, ..settings })?;
    let works: [Work<'_>; 2] =
        [&|encoder| record(gpu, encoder, &scanning), &|encoder| record(gpu, encoder, &sorted)];
    let samples = interleaved(gpu, &works, SAMPLES)?;
    let exact = scene.exact()?;
    let quality = Quality {
        metric: ERROR,
        error: scene.error(gpu, &sorted, &exact)?,
        baseline_error: scene.error(gpu, &scanning, &exact)?,
    };
    let (one, other) = (sorted.picture.read(gpu)?, scanning.picture.read(gpu)?);
    let unlike = one.iter().zip(&other).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
    let differs = unlike as f64 / one.len() as f64;
    let mut rows = vec![
        ratio(SYSTEM, "sorted_over_scanning", &samples[0], &samples[1], "higher", Some(quality)),
        figure(SYSTEM, "sorting_differs", differs, "fraction"),
    ];
    for (name, list) in ["frame_scanning", "frame_sorted"].iter().zip(samples) {
        rows.push(time(SYSTEM, *name, list));
    }
    Ok(rows)
}

/// A frame of the stent with every voxel drawn over one of the voxels above a threshold; the same picture comes out.
fn sparse(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let sparse = Scene::stent()?;
    let filled = sparse.filled();
    let splats = [sparse.splats(gpu, shaders)?, filled.splats(gpu, shaders)?];
    let few = sparse.picture(gpu, shaders, &splats[0], sparse.settings())?;
    let all = filled.picture(gpu, shaders, &splats[1], sparse.settings())?;
    let works: [Work<'_>; 2] = [&|encoder| record(gpu, encoder, &all), &|encoder| record(gpu, encoder, &few)];
    let samples = interleaved(gpu, &works, SAMPLES)?;
    let exact = sparse.exact()?;
    let quality = Quality {
        metric: ERROR,
        error: sparse.error(gpu, &few, &exact)?,
        baseline_error: sparse.error(gpu, &all, &exact)?,
    };
    let mut rows = vec![
        ratio(SYSTEM, "sparse_speedup", &samples[0], &samples[1], "higher", Some(quality)),
        figure(SYSTEM, "stent_occupied", sparse.occupied(), "fraction"),
    ];
    for (name, list) in ["frame_stent_filled", "frame_stent"].iter().zip(samples) {
        rows.push(time(SYSTEM, *name, list));
    }
    Ok(rows)
}

/// A frame of a cloud with `transport` over one of direct light. Their pictures are meant to differ, so that they have no truth in
/// common.
fn overhead(
    gpu: &Gpu,
    shaders: &Shaders,
    name: &str,
    transport: LightTransport,
) -> Result<Vec<Row>, CommandError> {
    let scene = Scene::cloud(128)?;
    let splats = scene.splats(gpu, shaders)?;
    let direct = scene.picture(gpu, shaders, &splats, scene.settings())?;
    let other = scene.picture(gpu, shaders, &splats, SheetSettings { transport, ..scene.settings() })?;
    let works: [Work<'_>; 2] =
        [&|encoder| record(gpu, encoder, &other), &|encoder| record(gpu, encoder, &direct)];
    let samples = interleaved(gpu, &works, SAMPLES)?;
    let mut rows = vec![ratio(SYSTEM, name, &samples[0], &samples[1], "lower", None)];
    for (frame, list) in ["frame", "direct_frame"].iter().zip(samples) {
        rows.push(time(SYSTEM, format!("{name}_{frame}"), list));
    }
    Ok(rows)
}
