// SPDX-License-Identifier: MIT OR Apache-2.0
//! Samplers.

use crate::gpu::Gpu;

/// A sampler.
#[derive(Clone)]
pub struct Sampler {
    /// The sampler itself.
    pub raw: wgpu::Sampler,
    /// True for a comparison sampler.
    pub comparison: bool,
    /// How it was made.
    pub descriptor: wgpu::SamplerDescriptor<'static>,
}

impl Sampler {
    /// Linear, clamped to the edge in u and repeating in v: for maps whose rows may wrap.
    pub fn rows(gpu: &Gpu) -> Self {
        Self::create(
            gpu,
            &wgpu::SamplerDescriptor {
                address_mode_v: wgpu::AddressMode::Repeat,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            },
        )
    }

    /// Linear, clamped to the edge.
    pub fn linear(gpu: &Gpu) -> Self {
        Self::create(
            gpu,
            &wgpu::SamplerDescriptor {
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            },
        )
    }

    /// Linear within and between levels, repeating in u and clamped to the edge in v: for latitude-longitude maps.
    pub fn around(gpu: &Gpu) -> Self {
        Self::create(
            gpu,
            &wgpu::SamplerDescriptor {
                address_mode_u: wgpu::AddressMode::Repeat,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            },
        )
    }

    /// Linear within and between levels, clamped to the edge.
    pub fn linear_levels(gpu: &Gpu) -> Self {
        Self::create(
            gpu,
            &wgpu::SamplerDescriptor {
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            },
        )
    }

    /// A comparison sampler for shadow maps with forward depth.
    pub fn shadow(gpu: &Gpu) -> Self {
        Self::create(
            gpu,
            &wgpu::SamplerDescriptor {
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                compare: Some(wgpu::CompareFunction::LessEqual),
                ..Default::default()
            },
        )
    }

    fn create(gpu: &Gpu, descriptor: &wgpu::SamplerDescriptor<'static>) -> Self {
        let raw = gpu.device.create_sampler(descriptor);
        Self { raw, comparison: descriptor.compare.is_some(), descriptor: descriptor.clone() }
    }
}
