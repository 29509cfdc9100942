// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light shafts in plain wgpu, from Airlight's flat shader files, without Airlight's host.
//!
//! The picture takes seven steps. Steps 1 and 2 are what an engine draws anyway; here the pass `core/raster` stands in.
//!
//! 1. shadow map of a directional light
//! 2. picture and depth from the camera
//! 3. `slices`, `rectify`: the shadow map resampled so that every view ray lies in one row, at one depth
//! 4. `rank`: each row sorted once, so that it answers how many of its first texels are lit
//! 5. `evaluate`: the light scattered towards the eye: two such questions a pixel, no marching
//! 6. `composite`: the picture dimmed by the air, plus that light
//! 7. `tonemap`: linear radiance to sRGB

mod scene;
pub use scene::*;

use std::error::Error;
use std::path::Path;
use wgpu::TextureFormat::{
    Depth32Float, R32Float, R32Uint, Rg32Uint, Rgba8Unorm, Rgba16Float, Rgba32Float, Rgba32Uint,
};
use wgpu::util::DeviceExt;

/// Columns and rows of the rectified map: a row is a slice of the picture through the sun, a column a distance.
const RECTIFIED: [u32; 2] = [1024, 1024];
/// Bits of a depth that `rank` and `evaluate` were composed for.
const RANK_BITS: u32 = 12;
const SHADOW_MAP: [u32; 2] = [2048, 2048];

/// Draws the scene around the mesh in an .obj file: RGBA, 8 bits, row by row. `shaders`: the folder with `core/` and
/// `scattering/`, the flat files.
pub fn render(shaders: &Path, mesh: &Path, size: [u32; 2]) -> Result<Vec<u8>, Box<dyn Error>> {
    let scene = scene(mesh, size)?;
    let gpu = Gpu::new(shaders)?;

    // What is uploaded: a mesh and five uniforms, in the layouts that the shaders declare.
    let vertices = gpu.buffer(bytemuck::cast_slice(&scene.mesh.vertices), wgpu::BufferUsages::VERTEX);
    let indices = gpu.buffer(bytemuck::cast_slice(&scene.mesh.indices), wgpu::BufferUsages::INDEX);
    let uniform = |bytes: &[u8]| gpu.buffer(bytes, wgpu::BufferUsages::UNIFORM);
    let camera = uniform(bytemuck::bytes_of(&scene.camera));
    let light = uniform(bytemuck::bytes_of(&scene.light));
    let medium = uniform(bytemuck::bytes_of(&scene.medium));
    let sky = uniform(bytemuck::bytes_of(&scene.sky));
    // Exposure, and a dither of one step of 8 bits against banding in the smooth light.
    let tone = uniform(bytemuck::bytes_of(&[scene.exposure, 1.0, 0.0, 0.0f32]));
    // `slices` writes it, the passes after it read it as a uniform; 128 bytes, see `Frame` in the shaders.
    let frame = gpu.buffer(&[0; 128], wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE);

    let (drawn, stored) = (wgpu::TextureUsages::RENDER_ATTACHMENT, wgpu::TextureUsages::STORAGE_BINDING);
    let shadow_map = gpu.texture(SHADOW_MAP, 1, Depth32Float, drawn);
    let depth = gpu.texture(size, 1, Depth32Float, drawn);
    let surface = gpu.texture(size, 1, Rgba16Float, drawn);
    let slices = gpu.texture([RECTIFIED[1], 1], 1, Rgba32Float, stored);
    let rectified = gpu.texture(RECTIFIED, 1, R32Float, stored);
    // Cells of 32 ranks by 32 columns, how many texels lie before each depth, and four bits of a depth a layer.
    let [columns, rows] = RECTIFIED;
    let blocks = columns.div_ceil(32);
    let rank_cells = gpu.texture([blocks * blocks, rows], 1, Rg32Uint, stored);
    let rank_starts = gpu.texture([1 << (RANK_BITS - 1), rows], 1, R32Uint, stored);
    let rank_planes = gpu.texture([blocks, rows], RANK_BITS.div_ceil(4), Rgba32Uint, stored);
    let scattered = gpu.texture(size, 1, Rgba16Float, stored);
    let composed = gpu.texture(size, 1, Rgba16Float, stored);
    let picture = gpu.texture(size, 1, Rgba8Unorm, stored | wgpu::TextureUsages::COPY_SRC);
    let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
    let [shadow_map, depth, surface] = [&shadow_map, &depth, &surface].map(view);
    let [slices, rectified, scattered, composed] = [&slices, &rectified, &scattered, &composed].map(view);
    let [rank_cells, rank_starts, rank_planes] = [&rank_cells, &rank_starts, &rank_planes].map(view);
    let picture_view = view(&picture);

    let shadow_sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        compare: Some(wgpu::CompareFunction::LessEqual),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    });

    let (tex, samp) = (wgpu::BindingResource::TextureView, wgpu::BindingResource::Sampler);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let triangles = 0..scene.mesh.indices.len() as u32;

    // 1. The shadow map: depth alone, seen from the sun.
    let raster = gpu.module("core/raster")?;
    let pipeline = gpu.drawing(&raster, "vertex_shadow", None);
    let bound = gpu.bind(&pipeline.get_bind_group_layout(0), &[(1, light.as_entire_binding())]);
    let mut pass = begin(&mut encoder, None, &shadow_map);
    pass.set_vertex_buffer(0, vertices.slice(..));
    pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &bound, &[]);
    pass.draw_indexed(triangles.clone(), 0, 0..1);
    drop(pass);

    // 2. The picture: the sky, then lit surfaces with their depth.
    let background = gpu.drawing(&raster, "vertex_background", Some("fragment_background"));
    let behind = gpu.bind(
        &background.get_bind_group_layout(0),
        &[(0, camera.as_entire_binding()), (2, sky.as_entire_binding())],
    );
    let pipeline = gpu.drawing(&raster, "vertex_surface", Some("fragment_surface"));
    let bound = gpu.bind(
        &pipeline.get_bind_group_layout(0),
        &[
            (0, camera.as_entire_binding()),
            (1, light.as_entire_binding()),
            (2, sky.as_entire_binding()),
            (3, tex(&shadow_map)),
            (4, samp(&shadow_sampler)),
        ],
    );
    let mut pass = begin(&mut encoder, Some(&surface), &depth);
    pass.set_vertex_buffer(0, vertices.slice(..));
    pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
    pass.set_pipeline(&background);
    pass.set_bind_group(0, &behind, &[]);
    pass.draw(0..3, 0..1);
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &bound, &[]);
    pass.draw_indexed(triangles, 0, 0..1);
    drop(pass);

    // 3. One thread a slice: where the rows lie. Then the rows, four texels a thread in workgroups of 16 x 8.
    let camera = || camera.as_entire_binding();
    let light = || light.as_entire_binding();
    let medium = || medium.as_entire_binding();
    let frame = || frame.as_entire_binding();
    let bindings = [(0, camera()), (1, light()), (2, medium()), (3, frame()), (4, tex(&slices))];
    gpu.dispatch(&mut encoder, "scattering/slices", &bindings, [rows.div_ceil(64), 1, 1])?;
    let bindings =
        [(0, light()), (1, frame()), (2, tex(&slices)), (3, tex(&shadow_map)), (4, tex(&rectified))];
    gpu.dispatch(&mut encoder, "scattering/rectify", &bindings, [columns.div_ceil(64), rows.div_ceil(8), 1])?;

    // 4. One workgroup a row. What it made is read by `evaluate` under the same names, in part by other numbers.
    let bindings = [
        (0, medium()),
        (1, tex(&slices)),
        (2, tex(&rectified)),
        (3, tex(&rank_cells)),
        (9, tex(&rank_starts)),
        (10, tex(&rank_planes)),
    ];
    gpu.dispatch(&mut encoder, "scattering/rank", &bindings, [rows, 1, 1])?;

    // 5, 6 and 7. One thread a pixel, in workgroups of 16 x 8.
    let groups = [size[0].div_ceil(16), size[1].div_ceil(8), 1];
    let bindings = [
        (0, camera()),
        (1, light()),
        (2, medium()),
        (3, frame()),
        (4, tex(&slices)),
        (5, tex(&depth)),
        (6, tex(&shadow_map)),
        (7, tex(&rank_cells)),
        (8, tex(&rank_starts)),
        (9, tex(&scattered)),
        (13, tex(&rank_planes)),
        (14, tex(&rectified)),
    ];
    gpu.dispatch(&mut encoder, "scattering/evaluate.rank", &bindings, groups)?;
    let bindings = [
        (0, camera()),
        (1, medium()),
        (2, tex(&depth)),
        (3, tex(&surface)),
        (4, tex(&scattered)),
        (5, tex(&composed)),
    ];
    gpu.dispatch(&mut encoder, "scattering/composite", &bindings, groups)?;
    let bindings = [(0, tone.as_entire_binding()), (1, tex(&composed)), (2, tex(&picture_view))];
    gpu.dispatch(&mut encoder, "core/tonemap", &bindings, groups)?;

    gpu.queue.submit([encoder.finish()]);
    gpu.read(&picture)
}

/// A device with WebGPU's default limits and no feature, and where the shaders are.
struct Gpu<'a> {
    device: wgpu::Device,
    queue: wgpu::Queue,
    shaders: &'a Path,
}

impl<'a> Gpu<'a> {
    fn new(shaders: &'a Path) -> Result<Self, Box<dyn Error>> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = pollster::block_on(instance.request_adapter(&Default::default()))?;
        let (device, queue) = pollster::block_on(adapter.request_device(&Default::default()))?;
        Ok(Self { device, queue, shaders })
    }

    fn buffer(&self, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    }

    /// A texture that later passes read.
    fn texture(
        &self,
        [width, height]: [u32; 2],
        layers: u32,
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width, height, depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        })
    }

    /// The flat file of a pass.
    fn module(&self, pass: &str) -> Result<wgpu::ShaderModule, Box<dyn Error>> {
        let file = self.shaders.join(format!("{pass}.wgsl"));
        let source =
            std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
        Ok(self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(pass),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        }))
    }

    fn bind(
        &self,
        layout: &wgpu::BindGroupLayout,
        bindings: &[(u32, wgpu::BindingResource)],
    ) -> wgpu::BindGroup {
        let entries: Vec<_> = bindings
            .iter()
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding: *binding, resource: resource.clone() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    /// A pipeline that draws triangles with depth; without a fragment stage depth alone.
    fn drawing(
        &self,
        module: &wgpu::ShaderModule,
        vertex: &str,
        fragment: Option<&str>,
    ) -> wgpu::RenderPipeline {
        let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3];
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(vertex),
            layout: None,
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: 36,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &attributes,
                })],
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: Depth32Float,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::LessEqual),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: fragment.map(|fragment| wgpu::FragmentState {
                module,
                entry_point: Some(fragment),
                compilation_options: Default::default(),
                targets: const {
                    &[Some(wgpu::ColorTargetState {
                        format: Rgba16Float,
                        blend: None,
                        write_mask: wgpu::ColorWrites::ALL,
                    })]
                },
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    /// Runs the compute pass of a flat file with its bindings by number. The layout is the shader's own.
    fn dispatch(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &str,
        bindings: &[(u32, wgpu::BindingResource)],
        [x, y, z]: [u32; 3],
    ) -> Result<(), Box<dyn Error>> {
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(pass),
            layout: None,
            module: &self.module(pass)?,
            entry_point: None,
            compilation_options: Default::default(),
            cache: None,
        });
        let bound = self.bind(&pipeline.get_bind_group_layout(0), bindings);
        let mut compute = encoder.begin_compute_pass(&Default::default());
        compute.set_pipeline(&pipeline);
        compute.set_bind_group(0, &bound, &[]);
        compute.dispatch_workgroups(x, y, z);
        Ok(())
    }

    /// The texels of an 8-bit texture.
    fn read(&self, texture: &wgpu::Texture) -> Result<Vec<u8>, Box<dyn Error>> {
        let size = texture.size();
        // Rows of a copy begin at multiples of 256 bytes.
        let stride = (4 * size.width).next_multiple_of(256);
        let bytes = vec![0; (stride * size.height) as usize];
        let buffer = self.buffer(&bytes, wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride), rows_per_image: None };
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
            size,
        );
        self.queue.submit([encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., |_| {});
        self.device.poll(wgpu::PollType::wait_indefinitely())?;
        let mapped = buffer.get_mapped_range(..)?;
        let rows = mapped.chunks_exact(stride as usize);
        Ok(rows.flat_map(|row| &row[..4 * size.width as usize]).copied().collect())
    }
}

/// A render pass that clears what it draws into.
fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    color: Option<&wgpu::TextureView>,
    depth: &wgpu::TextureView,
) -> wgpu::RenderPass<'a> {
    let color = color.map(|view| wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: Default::default(),
    });
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: if color.is_some() { std::slice::from_ref(&color) } else { &[] },
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
