// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight info`: the machine.

use super::CommandError;
use super::error::one_line;
use super::text::{line, print};
use crate::Gpu;

/// Says which adapter there is and what may be asked of it.
pub fn run() -> Result<(), CommandError> {
    let gpu = pollster::block_on(Gpu::new())?;
    let adapter = &gpu.adapter;
    let limits = &gpu.limits;
    let mut text = String::new();
    let driver = one_line(format!("{} {}", adapter.driver, adapter.driver_info));
    for (name, value) in [
        ("adapter", adapter.name.clone()),
        ("type", format!("{:?}", adapter.device_type)),
        ("back end", adapter.backend.to_string()),
        ("driver", driver),
        ("airlight", env!("CARGO_PKG_VERSION").to_owned()),
    ] {
        line(&mut text, format_args!("{name:10}{value}"));
    }
    line(&mut text, format_args!("\nLimits in force: WebGPU's defaults, no optional feature"));
    let [x, y, z] = [
        limits.max_compute_workgroup_size_x,
        limits.max_compute_workgroup_size_y,
        limits.max_compute_workgroup_size_z,
    ];
    let mebibytes = |bytes: u64| format!("{} MiB", bytes >> 20);
    for (name, value) in [
        ("width and height of a texture", limits.max_texture_dimension_2d.to_string()),
        ("layers of a texture", limits.max_texture_array_layers.to_string()),
        ("sides of a 3D texture", limits.max_texture_dimension_3d.to_string()),
        ("buffer", mebibytes(limits.max_buffer_size)),
        ("storage buffer", mebibytes(limits.max_storage_buffer_binding_size)),
        ("uniform buffer", format!("{} KiB", limits.max_uniform_buffer_binding_size >> 10)),
        ("workgroup", format!("{x},{y},{z}, {} in all", limits.max_compute_invocations_per_workgroup)),
        ("workgroup memory", format!("{} KiB", limits.max_compute_workgroup_storage_size >> 10)),
        ("workgroups a dimension", limits.max_compute_workgroups_per_dimension.to_string()),
        ("storage textures a stage", limits.max_storage_textures_per_shader_stage.to_string()),
        ("storage buffers a stage", limits.max_storage_buffers_per_shader_stage.to_string()),
        ("sampled textures a stage", limits.max_sampled_textures_per_shader_stage.to_string()),
    ] {
        line(&mut text, format_args!("  {name:31}{value}"));
    }
    print(&text);
    Ok(())
}
