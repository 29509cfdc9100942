// SPDX-License-Identifier: MIT OR Apache-2.0
//! WebGPU's default limits and core storage formats, by entry point.

use crate::{Access, Binding, BindingKind, EntryPoint, Reflection, Stage, StructLayout, format_name};
use naga::StorageFormat;

/// Something that an entry point uses more of than WebGPU grants by default.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excess {
    /// The limit as WebGPU spells it.
    pub limit: &'static str,
    /// What is used.
    pub used: u64,
    /// What is granted.
    pub granted: u64,
    /// The entry point.
    pub entry_point: String,
}

impl std::fmt::Display for Excess {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { limit, used, granted, entry_point } = self;
        write!(f, "`{entry_point}` needs {limit} = {used}; WebGPU grants {granted}")
    }
}

/// What one entry point uses of what is limited by stage.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Usage {
    /// Uniform buffers.
    pub uniform_buffers: u64,
    /// Storage buffers.
    pub storage_buffers: u64,
    /// Sampled textures.
    pub sampled_textures: u64,
    /// Storage textures.
    pub storage_textures: u64,
    /// Samplers.
    pub samplers: u64,
    /// Bytes of workgroup memory.
    pub workgroup_memory: u64,
    /// Invocations of a workgroup.
    pub invocations: u64,
}

/// Counts what an entry point uses.
pub fn usage(reflection: &Reflection, entry: &EntryPoint) -> Usage {
    let mut usage = Usage { workgroup_memory: entry.workgroup_memory, ..Usage::default() };
    if entry.stage == Stage::Compute {
        usage.invocations = entry.workgroup_size.iter().map(|&size| u64::from(size)).product();
    }
    for binding in used(reflection, entry) {
        match binding.kind {
            BindingKind::Uniform { .. } => usage.uniform_buffers += 1,
            BindingKind::Storage { .. } => usage.storage_buffers += 1,
            BindingKind::Texture { .. } => usage.sampled_textures += 1,
            BindingKind::StorageTexture { .. } => usage.storage_textures += 1,
            BindingKind::Sampler { .. } => usage.samplers += 1,
            BindingKind::Other { .. } => {}
        }
    }
    usage
}

fn used<'a>(reflection: &'a Reflection, entry: &'a EntryPoint) -> impl Iterator<Item = &'a Binding> {
    reflection.bindings.iter().filter(|binding| binding.entry_points.contains(&entry.name))
}

/// What a composed module uses beyond WebGPU's default limits; a device may grant it on request.
pub fn excesses(reflection: &Reflection) -> Vec<Excess> {
    let mut found = Vec::new();
    for entry in &reflection.entry_points {
        let mut test = |limit, used: u64, granted: u64| {
            if used > granted {
                let entry_point = entry.name.clone();
                found.push(Excess { limit, used, granted, entry_point });
            }
        };
        let usage = usage(reflection, entry);
        test("maxUniformBuffersPerShaderStage", usage.uniform_buffers, 12);
        test("maxStorageBuffersPerShaderStage", usage.storage_buffers, 8);
        test("maxSampledTexturesPerShaderStage", usage.sampled_textures, 16);
        test("maxStorageTexturesPerShaderStage", usage.storage_textures, 4);
        test("maxSamplersPerShaderStage", usage.samplers, 16);
        test("maxComputeWorkgroupStorageSize", usage.workgroup_memory, 16384);
        test("maxComputeInvocationsPerWorkgroup", usage.invocations, 256);
        let [x, y, z] = entry.workgroup_size.map(u64::from);
        test("maxComputeWorkgroupSizeX", x, 256);
        test("maxComputeWorkgroupSizeY", y, 256);
        test("maxComputeWorkgroupSizeZ", z, 64);
        for binding in used(reflection, entry) {
            test("maxBindGroups", u64::from(binding.group) + 1, 4);
            test("maxBindingsPerBindGroup", u64::from(binding.binding) + 1, 1000);
            match binding.kind {
                BindingKind::Uniform { size, .. } => {
                    test("maxUniformBufferBindingSize", size, 64 << 10);
                }
                BindingKind::Storage { min_size, .. } => {
                    test("maxStorageBufferBindingSize", min_size, 128 << 20);
                }
                _ => {}
            }
        }
        let locations = |interfaces: &[crate::Interface]| {
            interfaces.iter().map(|value| u64::from(value.location) + 1).max().unwrap_or(0)
        };
        match entry.stage {
            Stage::Vertex => {
                test("maxVertexAttributes", locations(&entry.inputs), 16);
                test("maxInterStageShaderVariables", locations(&entry.outputs), 16);
            }
            Stage::Fragment => {
                test("maxInterStageShaderVariables", locations(&entry.inputs), 16);
                test("maxColorAttachments", locations(&entry.outputs), 8);
            }
            Stage::Compute => {}
        }
    }
    found
}

/// Uses that core WebGPU has under no limits: formats, accesses, writes from the vertex stage. Each with the
/// name of the binding.
pub fn violations(reflection: &Reflection) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for binding in &reflection.bindings {
        let name = &binding.name;
        let mut report = |message| found.push((name.clone(), message));
        let mut writes = false;
        match &binding.kind {
            BindingKind::StorageTexture { format, access, .. } => {
                let text = format_name(*format);
                if !is_core_storage_format(*format) {
                    report(format!("`{name}`: {text} is no storage format of core WebGPU"));
                } else if *access == Access::ReadWrite && !may_read_write(*format) {
                    report(format!(
                        "`{name}`: {text} cannot be read_write in core WebGPU; only r32float, \
                         r32uint and r32sint can"
                    ));
                }
                writes = *access != Access::Read;
            }
            BindingKind::Storage { writable, .. } => writes = *writable,
            BindingKind::Other { ty } => {
                report(format!("`{name}`: core WebGPU has no {ty}"));
            }
            _ => {}
        }
        if writes && binding.stages.contains(&Stage::Vertex) {
            report(format!("`{name}`: the vertex stage cannot have writable storage"));
        }
    }
    found
}

fn is_core_storage_format(format: StorageFormat) -> bool {
    use StorageFormat as F;
    matches!(
        format,
        F::Rgba8Unorm
            | F::Rgba8Snorm
            | F::Rgba8Uint
            | F::Rgba8Sint
            | F::Rgba16Uint
            | F::Rgba16Sint
            | F::Rgba16Float
            | F::R32Uint
            | F::R32Sint
            | F::R32Float
            | F::Rg32Uint
            | F::Rg32Sint
            | F::Rg32Float
            | F::Rgba32Uint
            | F::Rgba32Sint
            | F::Rgba32Float
    )
}

fn may_read_write(format: StorageFormat) -> bool {
    matches!(format, StorageFormat::R32Uint | StorageFormat::R32Sint | StorageFormat::R32Float)
}

/// Uniform structs with holes: a host that writes members one after the other gets them wrong.
pub fn implicit_padding(layout: &StructLayout) -> Option<String> {
    let mut end = 0;
    for member in &layout.members {
        if member.offset > end {
            return Some(format!(
                "struct `{}` has {} bytes of implicit padding before `{}`; write it as a member",
                layout.name,
                member.offset - end,
                member.name
            ));
        }
        end = member.offset + member.size;
    }
    (layout.size > end).then(|| {
        let bytes = layout.size - end;
        format!(
            "struct `{}` has {bytes} bytes of implicit padding at its end; write it as a member",
            layout.name
        )
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::compose::validate;

    fn reflect(source: &str) -> Reflection {
        let module = naga::front::wgsl::parse_str(source).unwrap();
        Reflection::new(&module, &validate(&module).unwrap())
    }

    fn limits(source: &str) -> Vec<&'static str> {
        excesses(&reflect(source)).iter().map(|excess| excess.limit).collect()
    }

    fn storage(count: usize) -> String {
        let declarations: String = (0..count)
            .map(|i| format!("@group(0) @binding({i}) var<storage, read_write> b{i}_: array<u32>;\n"))
            .collect();
        let uses: String = (0..count).map(|i| format!("b{i}_[0] = 1u;")).collect();
        format!("{declarations}@compute @workgroup_size(1) fn main() {{ {uses} }}")
    }

    #[test]
    fn storage_buffers_are_counted_by_entry_point() {
        assert!(limits(&storage(8)).is_empty());
        assert_eq!(limits(&storage(9)), ["maxStorageBuffersPerShaderStage"]);
        // Declared but not used by the entry point.
        let unused = format!("{}\n@group(0) @binding(99) var<storage> more: array<u32>;", storage(8));
        assert!(limits(&unused).is_empty());
    }

    #[test]
    fn storage_textures_are_counted() {
        let source = |count: usize| {
            let declarations: String = (0..count)
                .map(|i| {
                    format!("@group(0) @binding({i}) var t{i}_: texture_storage_2d<rgba8unorm, write>;\n")
                })
                .collect();
            let uses: String =
                (0..count).map(|i| format!("textureStore(t{i}_, vec2<u32>(0), vec4<f32>(0.0));")).collect();
            format!("{declarations}@compute @workgroup_size(1) fn main() {{ {uses} }}")
        };
        assert!(limits(&source(4)).is_empty());
        assert_eq!(limits(&source(5)), ["maxStorageTexturesPerShaderStage"]);
    }

    #[test]
    fn workgroups_are_measured() {
        let source = |size: &str, words: u32| {
            format!(
                "var<workgroup> w: array<u32, {words}>; @compute @workgroup_size({size}) fn main() {{ w[0] = 1u; }}"
            )
        };
        assert!(limits(&source("256", 4096)).is_empty());
        assert_eq!(
            limits(&source("257", 4096)),
            ["maxComputeInvocationsPerWorkgroup", "maxComputeWorkgroupSizeX"]
        );
        assert_eq!(limits(&source("1, 1, 65", 4096)), ["maxComputeWorkgroupSizeZ"]);
        assert_eq!(limits(&source("16, 17", 4096)), ["maxComputeInvocationsPerWorkgroup"]);
        assert_eq!(limits(&source("64", 4097)), ["maxComputeWorkgroupStorageSize"]);
    }

    #[test]
    fn groups_and_locations_are_measured() {
        let source = "@group(4) @binding(0) var<uniform> u: vec4<f32>; @compute @workgroup_size(1) fn main() { let x = u; }";
        assert_eq!(limits(source), ["maxBindGroups"]);
        let source = "struct V { @builtin(position) p: vec4<f32>, @location(16) a: f32 } @vertex fn v() -> V { return V(); }";
        assert_eq!(limits(source), ["maxInterStageShaderVariables"]);
    }

    #[test]
    fn formats_and_accesses_are_core() {
        let source = |format: &str, access: &str| {
            let load = if access == "write" {
                "textureStore(t, vec2<u32>(0), vec4<f32>(0.0));"
            } else {
                "let x = textureLoad(t, vec2<u32>(0));"
            };
            violations(&reflect(&format!(
                "@group(0) @binding(0) var t: texture_storage_2d<{format}, {access}>; @compute @workgroup_size(1) fn main() {{ {load} }}"
            )))
        };
        assert!(source("rgba16float", "write").is_empty());
        assert!(source("rgba16float", "read").is_empty());
        assert!(source("r32float", "read_write").is_empty());
        assert!(source("rgba16float", "read_write")[0].1.contains("read_write"));
        assert!(source("rg16float", "write")[0].1.contains("rg16float"));
        assert!(source("bgra8unorm", "write")[0].1.contains("bgra8unorm"));
    }

    #[test]
    fn holes_in_structs_are_found() {
        let padding = |members: &str| {
            let source = format!(
                "struct S {{ {members} }} @group(0) @binding(0) var<uniform> s: S; @compute @workgroup_size(1) fn main() {{ let x = s; }}"
            );
            implicit_padding(reflect(&source).layout("S").unwrap())
        };
        assert_eq!(padding("a: vec3<f32>, b: f32"), None);
        assert!(padding("a: f32, b: vec2<f32>").unwrap().contains("4 bytes of implicit padding before `b`"));
        assert!(padding("a: vec3<f32>").unwrap().contains("at its end"));
    }
}
