// SPDX-License-Identifier: MIT OR Apache-2.0
//! From what reflection says of a binding to what wgpu wants to hear.

use crate::pass::Resource;
use airlight_validate::{Access, Binding, BindingKind, Sample, TextureDimension, format_name, naga};

/// A binding in one phrase, as errors and `airlight list` show it.
pub fn kind_text(kind: &BindingKind) -> String {
    match kind {
        BindingKind::Uniform { ty, size } => format!("uniform {ty}, {size} bytes"),
        BindingKind::Storage { writable, ty, .. } => {
            format!("storage {ty}, {}", if *writable { "read and written" } else { "read" })
        }
        BindingKind::Texture { dimension, sample, filtered, multisampled } => {
            let several = if *multisampled { "multisampled " } else { "" };
            format!("{several}{dimension} texture of {sample}{}", if *filtered { ", filtered" } else { "" })
        }
        BindingKind::StorageTexture { dimension, format, .. } => {
            format!("{dimension} storage texture {}", format_name(*format))
        }
        BindingKind::Sampler { comparison } => {
            if *comparison { "comparison sampler" } else { "sampler" }.to_owned()
        }
        BindingKind::Other { ty } => ty.clone(),
    }
}

fn view_dimension(dimension: TextureDimension) -> wgpu::TextureViewDimension {
    match dimension {
        TextureDimension::D1 => wgpu::TextureViewDimension::D1,
        TextureDimension::D2 => wgpu::TextureViewDimension::D2,
        TextureDimension::D2Array => wgpu::TextureViewDimension::D2Array,
        TextureDimension::D3 => wgpu::TextureViewDimension::D3,
        TextureDimension::Cube => wgpu::TextureViewDimension::Cube,
        TextureDimension::CubeArray => wgpu::TextureViewDimension::CubeArray,
    }
}

/// The wgpu format of a storage texture; WebGPU's core formats only.
pub fn texture_format(format: naga::StorageFormat) -> Option<wgpu::TextureFormat> {
    use naga::StorageFormat as S;
    use wgpu::TextureFormat as F;
    Some(match format {
        S::Rgba8Unorm => F::Rgba8Unorm,
        S::Rgba8Snorm => F::Rgba8Snorm,
        S::Rgba8Uint => F::Rgba8Uint,
        S::Rgba8Sint => F::Rgba8Sint,
        S::Rgba16Uint => F::Rgba16Uint,
        S::Rgba16Sint => F::Rgba16Sint,
        S::Rgba16Float => F::Rgba16Float,
        S::R32Uint => F::R32Uint,
        S::R32Sint => F::R32Sint,
        S::R32Float => F::R32Float,
        S::Rg32Uint => F::Rg32Uint,
        S::Rg32Sint => F::Rg32Sint,
        S::Rg32Float => F::Rg32Float,
        S::Rgba32Uint => F::Rgba32Uint,
        S::Rgba32Sint => F::Rgba32Sint,
        S::Rgba32Float => F::Rgba32Float,
        _ => return None,
    })
}

/// The layout entry of a binding. A format outside core WebGPU becomes one that pipeline creation refuses.
pub(crate) fn layout_entry(binding: &Binding, visibility: wgpu::ShaderStages) -> wgpu::BindGroupLayoutEntry {
    let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    let ty = match &binding.kind {
        BindingKind::Uniform { .. } | BindingKind::Other { .. } => buffer(wgpu::BufferBindingType::Uniform),
        BindingKind::Storage { writable, .. } => {
            buffer(wgpu::BufferBindingType::Storage { read_only: !writable })
        }
        BindingKind::Texture { dimension, sample, filtered, multisampled } => wgpu::BindingType::Texture {
            sample_type: match sample {
                Sample::Float => wgpu::TextureSampleType::Float { filterable: *filtered },
                Sample::Depth => wgpu::TextureSampleType::Depth,
                Sample::Sint => wgpu::TextureSampleType::Sint,
                Sample::Uint => wgpu::TextureSampleType::Uint,
            },
            view_dimension: view_dimension(*dimension),
            multisampled: *multisampled,
        },
        BindingKind::StorageTexture { dimension, format, access } => wgpu::BindingType::StorageTexture {
            access: match access {
                Access::Read => wgpu::StorageTextureAccess::ReadOnly,
                Access::Write => wgpu::StorageTextureAccess::WriteOnly,
                Access::ReadWrite => wgpu::StorageTextureAccess::ReadWrite,
            },
            format: texture_format(*format).unwrap_or(wgpu::TextureFormat::Depth32Float),
            view_dimension: view_dimension(*dimension),
        },
        BindingKind::Sampler { comparison } => wgpu::BindingType::Sampler(if *comparison {
            wgpu::SamplerBindingType::Comparison
        } else {
            wgpu::SamplerBindingType::Filtering
        }),
    };
    wgpu::BindGroupLayoutEntry { binding: binding.binding, visibility, ty, count: None }
}

/// What is wrong with a resource for a binding, described; none where it fits.
pub(crate) fn mismatch(kind: &BindingKind, resource: Resource<'_>) -> Option<String> {
    match (kind, resource) {
        (BindingKind::Uniform { size, .. }, Resource::Buffer(buffer)) => {
            let given = buffer.raw.size();
            if !buffer.raw.usage().contains(wgpu::BufferUsages::UNIFORM) {
                return Some("a buffer without uniform usage".to_owned());
            }
            (given < *size).then(|| format!("a buffer of {given} bytes"))
        }
        (BindingKind::Storage { min_size, .. }, Resource::Buffer(buffer)) => {
            let given = buffer.raw.size();
            if !buffer.raw.usage().contains(wgpu::BufferUsages::STORAGE) {
                return Some("a buffer without storage usage".to_owned());
            }
            (given < *min_size).then(|| format!("a buffer of {given} bytes"))
        }
        (BindingKind::Texture { dimension, sample, filtered, multisampled }, Resource::Texture(texture)) => {
            let format = texture.raw.format();
            let fits = match format.sample_type(Some(wgpu::TextureAspect::All), None) {
                Some(wgpu::TextureSampleType::Float { filterable }) => {
                    *sample == Sample::Float && (filterable || !filtered)
                }
                Some(wgpu::TextureSampleType::Depth) => {
                    *sample == Sample::Depth || (*sample == Sample::Float && !filtered)
                }
                Some(wgpu::TextureSampleType::Sint) => *sample == Sample::Sint,
                Some(wgpu::TextureSampleType::Uint) => *sample == Sample::Uint,
                None => false,
            };
            let whole = texture.dimension == view_dimension(*dimension)
                && *multisampled == (texture.raw.sample_count() > 1)
                && texture.raw.usage().contains(wgpu::TextureUsages::TEXTURE_BINDING);
            (!(fits && whole)).then(|| described(texture))
        }
        (BindingKind::StorageTexture { dimension, format, .. }, Resource::Texture(texture)) => {
            let fits = texture_format(*format) == Some(texture.raw.format())
                && texture.dimension == view_dimension(*dimension)
                && texture.raw.usage().contains(wgpu::TextureUsages::STORAGE_BINDING);
            (!fits).then(|| described(texture))
        }
        (BindingKind::Sampler { comparison }, Resource::Sampler(sampler)) => (sampler.comparison
            != *comparison)
            .then(|| if sampler.comparison { "a comparison sampler" } else { "a sampler" }.to_owned()),
        (_, Resource::Buffer(_)) => Some("a buffer".to_owned()),
        (_, Resource::Texture(texture)) => Some(described(texture)),
        (_, Resource::Sampler(_)) => Some("a sampler".to_owned()),
    }
}

fn described(texture: &crate::resource::Texture) -> String {
    let samples = texture.raw.sample_count();
    let several = if samples > 1 { format!(", {samples} samples a pixel") } else { String::new() };
    format!(
        "a {:?} texture of {:?} with {:?}{several}",
        texture.dimension,
        texture.raw.format(),
        texture.raw.usage()
    )
}
