// SPDX-License-Identifier: MIT OR Apache-2.0
//! Multisampled depth that is resolved to one.

use super::cameras::{any_camera, distance};
use super::case::submit;
use crate::gpu::{self, Random, gpu, shaders};
use airlight::core::{ResolveDepth, SampleChoice};
use airlight::validate::Definitions;
use airlight::{Buffer, Pass, Texture};
use wgpu::TextureFormat::R32Float;

/// A multisampled depth buffer of four samples a pixel: `depths`, four values a pixel.
fn multisampled([width, height]: [u32; 2], depths: &[f32]) -> Texture {
    let source = gpu::texture([4 * width, height], R32Float, depths);
    let device = &gpu().device;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(
            "@group(0) @binding(0) var source: texture_2d<f32>;
             struct Varyings { @builtin(position) position: vec4<f32>, @location(0) @interpolate(flat) index: u32 }
             struct Sample { @builtin(frag_depth) depth: f32, @builtin(sample_mask) mask: u32 }
             @vertex fn vertex(
                 @builtin(vertex_index) v: u32, @builtin(instance_index) index: u32
             ) -> Varyings {
                 let corner = vec2<f32>(f32(v & 1u), f32(v >> 1u)) * 4.0 - 1.0;
                 return Varyings(vec4<f32>(corner, 0.0, 1.0), index);
             }
             @fragment fn fragment(in: Varyings) -> Sample {
                 let pixel = vec2<u32>(in.position.xy);
                 let depth = textureLoad(source, vec2<u32>(4u * pixel.x + in.index, pixel.y), 0).x;
                 return Sample(depth, 1u << in.index);
             }"
            .into(),
        ),
    });
    let samples = 4;
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: wgpu::TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    });
    let raw = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: samples,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Depth32Float,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let view = raw.create_view(&wgpu::TextureViewDescriptor::default());
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::TextureView(&source.view),
        }],
    });
    submit(|encoder| {
        let mut render = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.5),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        render.set_pipeline(&pipeline);
        render.set_bind_group(0, &group, &[]);
        render.draw(0..3, 0..4);
    });
    Texture::whole(raw, wgpu::TextureViewDimension::D2)
}

#[test]
fn resolved_depths_scatter_what_their_samples_scatter() {
    const LIMIT: f64 = 60.0;
    let size = [16_u32, 12];
    let mut random = Random(31);
    let (mut radiance, mut means, mut mixed) = (0.0_f64, 0.0_f64, 0);
    for index in 0..30 {
        let camera = any_camera(&mut random, size);
        let forward = camera.far_depth > 0.5;
        let extinction = [0.0, 1e-5, 0.02, 0.3][index % 4];
        let depths: Vec<f32> = (0..16 * 12)
            .flat_map(|_| {
                let kind = random.below(4);
                let mut one = || match random.below(5) {
                    0 => camera.far_depth,
                    _ if camera.projection == 1 => random.unit() as f32,
                    _ => {
                        let near = random.magnitude(2e-3, 0.3) as f32;
                        if forward { 1.0 - near } else { near }
                    }
                };
                let first = one();
                // All alike, one of another depth, all different.
                match kind {
                    0 => [first; 4],
                    1 => [one(), first, first, first],
                    _ => [first, one(), one(), one()],
                }
            })
            .collect();
        let samples = multisampled(size, &depths);
        let buffer = Buffer::uniform(gpu(), &camera);
        let resolve = |choice| {
            let pass = ResolveDepth::new(gpu(), shaders(), choice, size).unwrap();
            let bound = pass.bind(gpu(), &buffer, &samples).unwrap();
            submit(|encoder| pass.record(encoder, &bound));
            pass.depth.read(gpu()).unwrap()
        };
        let mean =
            resolve(SampleChoice::Mean { extinction: extinction as f32, distance_limit: LIMIT as f32 });
        let (nearest, farthest) = (resolve(SampleChoice::Nearest), resolve(SampleChoice::Farthest));
        for (i, four) in depths.chunks_exact(4).enumerate() {
            let least = four.iter().copied().fold(1.0, f32::min);
            let greatest = four.iter().copied().fold(0.0, f32::max);
            let ends = if forward { [least, greatest] } else { [greatest, least] };
            assert_eq!([nearest[i], farthest[i]], ends);
            if least == greatest {
                assert_eq!(mean[i], least);
                continue;
            }
            mixed += 1;
            let at = [i % 16, i / 16];
            let lengths: Vec<f64> = four.iter().map(|d| distance(&camera, at, *d, LIMIT)).collect();
            let found = distance(&camera, at, mean[i], LIMIT);
            // As far as f32 resolves depths.
            let step =
                (distance(&camera, at, f32::from_bits(mean[i].to_bits() + 4), LIMIT) - found).abs().max(
                    (distance(&camera, at, f32::from_bits(mean[i].to_bits().saturating_sub(4)), LIMIT)
                        - found)
                        .abs(),
                );
            let spread = lengths.iter().copied().fold(0.0, f64::max)
                - lengths.iter().copied().fold(f64::INFINITY, f64::min);
            let slack = step + 1e-5 * (found + gpu::vector(camera.eye).length()) + 3e-4 * spread;
            if extinction == 0.0 {
                let expected = lengths.iter().sum::<f64>() / 4.0;
                means = means.max((found - expected).abs() / slack);
            } else {
                let lit = |s: f64| -(-extinction * s).exp_m1();
                let expected = lengths.iter().map(|s| lit(*s)).sum::<f64>() / 4.0;
                // The slope of the radiance over the distance is that of the transmittance.
                let slope = extinction * (-extinction * (found - slack).max(0.0)).exp();
                radiance = radiance.max((lit(found) - expected).abs() / (slope * slack));
            }
        }
    }
    println!(
        "resolved depth: radiance {radiance:.2}, mean distance {means:.2} of their budgets; {mixed} mixed"
    );
    assert!(radiance <= 1.0 && means <= 1.0 && mixed > 3000, "{radiance} {means} {mixed}");
}

#[test]
fn depth_textures_resolve_like_floats() {
    let size = [16_u32, 12];
    let mut random = Random(3);
    let camera = gpu::host_camera(&random.camera(4.0 / 3.0), size);
    let depths: Vec<f32> = (0..16 * 12 * 4).map(|_| random.unit() as f32).collect();
    let samples = multisampled(size, &depths);
    let buffer = Buffer::uniform(gpu(), &camera);
    let choice = SampleChoice::Mean { extinction: 0.1, distance_limit: 50.0 };
    let floats = ResolveDepth::new(gpu(), shaders(), choice, size).unwrap();
    let bound = floats.bind(gpu(), &buffer, &samples).unwrap();
    submit(|encoder| floats.record(encoder, &bound));
    let parameters = airlight::core::ResolveDepthParameters {
        extinction: 0.1,
        distance_limit: 50.0,
        reserved_a: 0.0,
        reserved_b: 0.0,
    };
    let parameters = Buffer::uniform(gpu(), &parameters);
    let definitions = Definitions::new().flag("DEPTH_TEXTURE");
    let pass = Pass::compute_with(gpu(), shaders(), "core/resolve_depth", &definitions).unwrap();
    let resolved = Texture::storage(gpu(), size, R32Float);
    let bound = pass.bind(
        gpu(),
        &[
            ("camera", (&buffer).into()),
            ("parameters", (&parameters).into()),
            ("samples", (&samples).into()),
            ("resolved", (&resolved).into()),
        ],
    );
    let bound = bound.unwrap();
    submit(|encoder| pass.dispatch(encoder, &bound, [size[0], size[1], 1]));
    assert_eq!(resolved.read(gpu()).unwrap(), floats.depth.read(gpu()).unwrap());
}
