// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight run`: any compute or full-screen pass on arrays, by binding name.

mod bindings;
mod fields;
mod plan;
mod spelling;
mod texels;

use super::CommandError;
use super::error::{named, one_line};
use super::list::shaders;
use crate::formats::{Array, ArrayData, write_npy};
use crate::{Bound, Buffer, Gpu, Pass, RenderStages, Resource, Sampler, Texture};
use airlight_validate::Definitions;
use bindings::{Planned, Recipe, TARGET, TextureRecipe, Written};
use plan::{Plan, Work};
use spelling::{Input, Output, Scalar, Setting, Subject};
use std::path::{Path, PathBuf};

/// What the flags mean, at length.
const GRAMMAR: &str = "\
Every binding is named as in the shader; `airlight list SYSTEM/PASS` shows them.

Arrays given (--in NAME=FILE.npy):
  texture           (height, width) or (height, width, channels); for texture arrays and 3D textures (layers, height,
                    width) or (layers, height, width, channels); 1 to 4 channels, 3 are padded to 4 by 1.
                    f32 becomes a 32-bit float format, or a 16-bit one where the pass filters; u8 stands for 0..1;
                    integer textures take u32 or i32
  storage buffer    any shape, f32, u32 or i32: its 32-bit words as they are (a vec3 takes four words)
  uniform           all words of the struct, in place of zeros; --set is applied afterwards

Fields (--set NAME.FIELD=V): NAME is the binding or its struct; V one number, a vector x,y,z, a matrix by columns.
  Uniforms are zero but for what is set. Fields nest (a.b), arrays take an index (a[2]).

What is written (--out NAME=FILE.npy[:SHAPE[:TYPE]]), where SHAPE is
  storage texture   HEIGHT,WIDTH, or LAYERS,HEIGHT,WIDTH for arrays and 3D; without it --size. The file gets several
                    channels as a last axis: f32, u8 for 8-bit unorm, u32 or i32 for integers
  storage buffer    COUNT or any shape, in 32-bit numbers; TYPE is f32, u32 or i32, without it that of the shader
  render target     named `color`, as large as --size
  SHAPE is not needed where --in gives the same binding an array, nor for a struct.

Samplers are made: linear, clamped in u, repeating in v; comparison samplers for forward depth.

Examples:
  airlight run core/tonemap --in radiance=hdr.npy --set parameters.exposure=1 --over 1280,720 \\
      --out picture=ldr.npy:720,1280
  airlight run core/scan --entry scan_blocks --set ScanParameters.count=5000 --in values=v.npy --dispatch 5 \\
      --out values=sums.npy --out block_sums=blocks.npy:5
  airlight run core/raster --entry fragment_background --vertex vertex_background --size 640x360 \\
      --in camera=camera.npy --set sky.zenith=0.2,0.4,0.9 --out color=sky.npy";

/// Runs a pass.
#[derive(clap::Args)]
#[command(after_long_help = GRAMMAR)]
pub struct Options {
    /// The pass, and its permutation where that is not `default`.
    #[arg(value_name = "SYSTEM/PASS[:PERMUTATION]", value_parser = spelling::subject)]
    subject: Subject,
    /// An array for a binding.
    #[arg(long = "in", value_name = "NAME=FILE.npy", value_parser = spelling::input)]
    input: Vec<Input>,
    /// A field of a uniform; all others are zero.
    #[arg(long, value_name = "NAME.FIELD=V", value_parser = spelling::setting)]
    set: Vec<Setting>,
    /// A definition, on top of those of the permutation.
    #[arg(long, value_name = "NAME[=VALUE]", value_parser = spelling::definition)]
    define: Vec<Definitions>,
    /// Workgroups of a compute entry point.
    #[arg(long, value_name = "X,Y,Z", value_parser = spelling::counts)]
    dispatch: Option<[u32; 3]>,
    /// Invocations of a compute entry point, rounded up to whole workgroups.
    #[arg(long, value_name = "X,Y,Z", value_parser = spelling::counts, conflicts_with = "dispatch")]
    over: Option<[u32; 3]>,
    /// Where the contents of a binding, or the render target `color`, go afterwards.
    #[arg(long = "out", value_name = "NAME=FILE.npy[:SHAPE[:TYPE]]", value_parser = spelling::output)]
    output: Vec<Output>,
    /// The compute or fragment entry point, where there are several.
    #[arg(long, value_name = "NAME")]
    entry: Option<String>,
    /// The vertex entry point that goes with a fragment entry point, where there are several.
    #[arg(long, value_name = "NAME")]
    vertex: Option<String>,
    /// Size of the render target, and of storage textures without a SHAPE.
    #[arg(long, value_name = "WxH", value_parser = super::parse::size)]
    size: Option<[u32; 2]>,
    /// A folder laid out like `wgsl/`, in place of the built-in shaders.
    #[arg(long, value_name = "DIR")]
    shaders: Option<PathBuf>,
}

/// A resource on the GPU.
enum Made {
    Buffer(Buffer),
    Texture(Texture),
    Sampler(Sampler),
}

impl Made {
    fn resource(&self) -> Resource<'_> {
        match self {
            Self::Buffer(buffer) => buffer.into(),
            Self::Texture(texture) => texture.into(),
            Self::Sampler(sampler) => sampler.into(),
        }
    }
}

/// Runs a pass. Whatever can be refused is refused before a GPU is asked for.
pub fn run(options: &Options) -> Result<(), CommandError> {
    let shaders = shaders(options.shaders.as_deref())?;
    let limits = wgpu::Limits::default();
    let plan = Plan::new(options, &shaders, &limits)?;
    let resources = bindings::resources(options, &plan, &limits)?;
    for written in resources.iter().filter_map(|planned| planned.written.as_ref()) {
        check_writable(&written.flag, &written.file)?;
    }

    let gpu = pollster::block_on(Gpu::new())?;
    let failed = |error: &dyn std::fmt::Display| {
        CommandError::failure(format!("{}: {}", plan.name(), one_line(error)))
    };
    let made: Vec<(Made, Planned)> =
        resources.into_iter().map(|planned| (make(&gpu, &planned.recipe), planned)).collect();
    gpu.check().map_err(|error| failed(&error))?;
    let named: Vec<(&str, Resource<'_>)> = made
        .iter()
        .filter(|(_, planned)| plan.bindings.iter().any(|binding| binding.name == planned.name))
        .map(|(made, planned)| (planned.name.as_str(), made.resource()))
        .collect();
    match &plan.work {
        Work::Compute { entry, groups } => {
            let pass = Pass::compute_from(&gpu, &plan.composed).map_err(|error| failed(&error))?;
            let bound = pass.bind(&gpu, &named).map_err(|error| failed(&error))?;
            let mut encoder = gpu.encoder();
            pass.dispatch_groups(&mut encoder, &bound, entry, *groups).map_err(|error| failed(&error))?;
            gpu.submit(encoder).map_err(|error| failed(&error))?;
        }
        Work::Screen { vertex, fragment, target, .. } => {
            let stages = RenderStages {
                vertex,
                fragment: Some(fragment),
                vertices: None,
                target: Some(*target),
                depth: None,
                samples: 1,
            };
            let pass = Pass::render(&gpu, &plan.composed, &stages).map_err(|error| failed(&error))?;
            let bound = pass.bind(&gpu, &named).map_err(|error| failed(&error))?;
            if let Some((Made::Texture(target), _)) = made.last() {
                draw(&gpu, &pass, &bound, target).map_err(|error| failed(&error))?;
            }
        }
    }

    // Everything is read before anything is written.
    let mut arrays = Vec::new();
    for (made, planned) in &made {
        if let Some(written) = &planned.written {
            arrays.push((written, read(&gpu, made, written).map_err(|error| failed(&error))?));
        }
    }
    for (written, array) in arrays {
        write_npy(&written.file, &array)
            .map_err(|error| CommandError::failure(format!("{}: {}", written.flag, one_line(error))))?;
    }
    Ok(())
}

fn make(gpu: &Gpu, recipe: &Recipe) -> Made {
    match recipe {
        Recipe::Uniform(bytes) => Made::Buffer(Buffer::with_bytes(gpu, bytes, wgpu::BufferUsages::UNIFORM)),
        Recipe::Storage(bytes) => {
            // Not padded: shaders ask for the length.
            let raw = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: bytes.len() as u64,
                usage: wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::COPY_SRC
                    | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            gpu.queue.write_buffer(&raw, 0, bytes);
            Made::Buffer(Buffer { raw })
        }
        Recipe::Texture(recipe) => Made::Texture(make_texture(gpu, recipe)),
        Recipe::Sampler { comparison: true } => Made::Sampler(Sampler::shadow(gpu)),
        Recipe::Sampler { comparison: false } => Made::Sampler(Sampler::rows(gpu)),
    }
}

fn make_texture(gpu: &Gpu, recipe: &TextureRecipe) -> Texture {
    let [width, height, layers] = recipe.size;
    let raw = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: match recipe.dimension {
            wgpu::TextureViewDimension::D3 => wgpu::TextureDimension::D3,
            _ => wgpu::TextureDimension::D2,
        },
        format: recipe.format,
        usage: recipe.usage,
        view_formats: &[],
    });
    if let Some(bytes) = &recipe.bytes {
        let row = width * recipe.format.block_copy_size(None).unwrap_or(16);
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: Some(height) };
        gpu.queue.write_texture(raw.as_image_copy(), bytes, layout, raw.size());
    }
    Texture::whole(raw, recipe.dimension)
}

fn draw(gpu: &Gpu, pass: &Pass, bound: &Bound, target: &Texture) -> Result<(), crate::GpuError> {
    let mut encoder = gpu.encoder();
    {
        let mut render = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(TARGET),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        pass.set(&mut render, bound);
        render.draw(0..3, 0..1);
    }
    gpu.submit(encoder)
}

fn read(gpu: &Gpu, made: &Made, written: &Written) -> Result<Array, String> {
    let text = |error: crate::GpuError| error.to_string();
    let mut shape = written.shape.clone();
    match made {
        Made::Sampler(_) => Err("a sampler has no contents".to_owned()),
        Made::Buffer(buffer) => {
            let words = buffer.read_words(gpu).map_err(text)?;
            let data = match written.scalar {
                Scalar::F32 => ArrayData::F32(words.into_iter().map(f32::from_bits).collect()),
                Scalar::U32 => ArrayData::U32(words),
                Scalar::I32 => ArrayData::I32(words.into_iter().map(u32::cast_signed).collect()),
            };
            Ok(Array { shape, data })
        }
        Made::Texture(texture) => {
            let format = texture.raw.format();
            let [width, height, _] = texture.size();
            let padded = bindings::copy_row(width, format);
            let copy = Buffer::storage(gpu, bindings::copy_size(texture.size(), format));
            let mut encoder = gpu.encoder();
            encoder.copy_texture_to_buffer(
                texture.raw.as_image_copy(),
                wgpu::TexelCopyBufferInfo {
                    buffer: &copy.raw,
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(padded),
                        rows_per_image: Some(height),
                    },
                },
                texture.raw.size(),
            );
            gpu.submit(encoder).map_err(text)?;
            let bytes = copy.read(gpu).map_err(text)?;
            let tight = (width * format.block_copy_size(None).unwrap_or(16)) as usize;
            let rows: Vec<u8> =
                bytes.chunks_exact(padded as usize).flat_map(|row| &row[..tight]).copied().collect();
            if format.components() > 1 {
                shape.push(usize::from(format.components()));
            }
            Ok(Array { shape, data: texels::decode(format, &rows)? })
        }
    }
}

/// Fails where `file` cannot be made, before anything is computed for it; leaves nothing behind.
pub(super) fn check_writable(flag: &str, file: &Path) -> Result<(), CommandError> {
    let failed = |problem: String| CommandError::failure(format!("{flag}: {problem}"));
    if file.is_dir() {
        return Err(failed(named(file, "is a folder; give the name of a file".to_owned())));
    }
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match tempfile::tempfile_in(folder) {
        Ok(_) => Ok(()),
        Err(error) => Err(failed(format!("cannot write into {}", named(folder, one_line(error))))),
    }
}
