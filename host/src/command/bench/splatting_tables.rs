// SPDX-License-Identifier: MIT OR Apache-2.0
//! The long table of the system `splatting`: a cloud from 64^3 to 256^3 voxels.

use super::splatting::{SYSTEM, run};
use super::splatting_scenes::Scene;
use super::{Row, Work, figure, interleaved, median, time};
use crate::command::{CommandError, progress};
use crate::{Gpu, Shaders};

/// Splats, time of each part of a frame, and memory.
pub fn rows(gpu: &Gpu, shaders: &Shaders, quiet: bool) -> Result<Vec<Row>, CommandError> {
    let sides = [64, 128, 256];
    let bar = progress::bar(sides.len() as u64, quiet);
    let mut rows = Vec::new();
    for side in sides {
        bar.set_message(format!("{side}^3"));
        let scene = Scene::cloud(side)?;
        let splats = scene.splats(gpu, shaders)?;
        let picture = scene.picture(gpu, shaders, &splats, scene.settings())?;
        // Parts need the order of splats; and the only errors are of entry points, which this meets.
        run(gpu, &picture)?;
        let works: [Work<'_>; 5] = [
            &|encoder| {
                let _ = picture.record_order(gpu, encoder);
            },
            &|encoder| picture.record_eye_splats(encoder),
            &|encoder| picture.record_light_splats(encoder),
            &|encoder| {
                let _ = picture.record_composites(encoder);
            },
            &|encoder| {
                let _ = picture.record(gpu, encoder);
            },
        ];
        let samples = interleaved(gpu, &works, 5)?;
        let count = splats.count() as f64;
        rows.push(figure(SYSTEM, format!("table_splats_{side}"), count, "splats"));
        let each = samples[..3].iter().map(|list| median(list)).sum::<f64>() / count;
        rows.push(figure(SYSTEM, format!("table_splat_{side}"), 1e6 * each, "ns"));
        for (part, list) in ["order", "eye_splats", "light_splats", "composites", "frame"].iter().zip(samples)
        {
            rows.push(time(SYSTEM, format!("table_{part}_{side}"), list));
        }
        let memory = (splats.memory() + picture.memory()) as f64 / 1e6;
        rows.push(figure(SYSTEM, format!("table_memory_{side}"), memory, "MB"));
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(rows)
}
