// SPDX-License-Identifier: MIT OR Apache-2.0
//! Resources for every binding of a pass, by its reflected kind.

use crate::gpu::{Random, gpu};
use crate::inside::is_made_inside;
use crate::structs::{Word, contents};
use crate::values::{Content, Spread, extreme_word, texel_float, texel_half};
use airlight::validate::{Binding, BindingKind, Reflection, Sample, TextureDimension};
use airlight::{Buffer, Resource, Sampler, Texture};
use wgpu::{TextureFormat, TextureUsages};

/// Elements of arrays without a length where parameters are sane: enough for every texel and voxel of a case. In shorter ones what
/// lies beyond the end shares the last element, and who comes first is left to chance.
const LONG: usize = 4096;

/// From a single texel to beyond a workgroup.
const SIZES: [[u32; 2]; 6] = [[1, 1], [3, 2], [17, 9], [33, 1], [1, 19], [8, 8]];
const VOLUMES: [[u32; 3]; 5] = [[1, 1, 1], [3, 2, 5], [9, 8, 7], [17, 3, 2], [4, 4, 4]];
const LENGTHS: [usize; 8] = [1, 2, 3, 7, 16, 65, 300, 16];

enum Held {
    Buffer(Buffer, Vec<Word>),
    Texture(Texture),
    Sampler(Sampler),
}

/// All resources of a pass.
pub struct Resources {
    held: Vec<(Binding, Held)>,
}

/// What a pass has written somewhere.
pub struct Written {
    /// Of the binding or target.
    pub name: String,
    /// 32 bits a number; halves and unorms as the floats that they are.
    pub words: Vec<u32>,
    /// What each of them holds; the last goes for all beyond.
    pub kinds: Vec<Word>,
}

impl Resources {
    /// Made anew from a seed: the same every time.
    pub fn new(pass: &str, reflection: &Reflection, content: Content, seed: u64) -> Self {
        let random = &mut Random(seed | 1);
        // Most resources of a case have one size.
        let size = SIZES[random.below(SIZES.len())];
        let volume = VOLUMES[random.below(VOLUMES.len())];
        let sampler = random.below(2);
        let mut held = |binding: &Binding| {
            let odd = random.below(4) == 0;
            let size = if odd { SIZES[random.below(SIZES.len())] } else { size };
            let volume = if odd { VOLUMES[random.below(VOLUMES.len())] } else { volume };
            match &binding.kind {
                BindingKind::Uniform { ty, .. } | BindingKind::Storage { ty, .. } => {
                    let short = LENGTHS[random.below(LENGTHS.len())];
                    let elements = if content.is_sane() { LONG } else { short };
                    let (words, kinds) = contents(reflection, (ty, &binding.name), elements, content, random);
                    Held::Buffer(buffer(&words), kinds)
                }
                BindingKind::Sampler { comparison: true } => Held::Sampler(Sampler::shadow(gpu())),
                BindingKind::Sampler { .. } => Held::Sampler(match sampler {
                    0 => Sampler::linear(gpu()),
                    _ => Sampler::rows(gpu()),
                }),
                BindingKind::Texture { multisampled: true, dimension, .. } => {
                    Held::Texture(depth_texture([size[0], size[1], 1], *dimension, 4, random))
                }
                BindingKind::Texture { sample: Sample::Depth, dimension, .. } => Held::Texture(
                    depth_texture(extent(*dimension, size, volume, random), *dimension, 1, random),
                ),
                BindingKind::Texture { sample, dimension, filtered, .. } => {
                    let format = sampled_format(*sample, *filtered, &binding.name, random);
                    let extent = extent(*dimension, size, volume, random);
                    let inside = content == Content::NonFinite && is_made_inside(pass, &binding.name);
                    let content = if inside { Content::Finite } else { content };
                    Held::Texture(texture(extent, format, *dimension, false, content, random))
                }
                BindingKind::StorageTexture { dimension, format, .. } => {
                    let format = airlight::layout::texture_format(*format).expect("core formats only");
                    let extent = extent(*dimension, size, volume, random);
                    Held::Texture(texture(extent, format, *dimension, true, Content::Finite, random))
                }
                BindingKind::Other { ty } => panic!("{ty} is no binding of WebGPU"),
            }
        };
        Self { held: reflection.bindings.iter().map(|binding| (binding.clone(), held(binding))).collect() }
    }

    /// By name, as passes take them.
    pub fn named<'a>(&'a self) -> Vec<(&'a str, Resource<'a>)> {
        let resource = |(binding, held): &'a (Binding, Held)| {
            let resource: Resource<'a> = match held {
                Held::Buffer(buffer, _) => buffer.into(),
                Held::Texture(texture) => texture.into(),
                Held::Sampler(sampler) => sampler.into(),
            };
            (binding.name.as_str(), resource)
        };
        self.held.iter().map(resource).collect()
    }

    /// What a pass may have written.
    pub fn written(&self) -> Vec<Written> {
        let written = |(binding, held): &(Binding, Held)| {
            let name = binding.name.clone();
            match (&binding.kind, held) {
                (BindingKind::Storage { writable: true, .. }, Held::Buffer(buffer, kinds)) => {
                    let words = buffer.read_words(gpu()).expect("the device answers");
                    // What is beyond the contents is padding of the host.
                    let mut kinds = kinds.clone();
                    kinds.push(Word::Padding);
                    Some(Written { name, words, kinds })
                }
                (BindingKind::StorageTexture { .. }, Held::Texture(texture)) => Some(texels(name, texture)),
                _ => None,
            }
        };
        self.held.iter().filter_map(written).collect()
    }

    /// Sizes and lengths, for messages.
    pub fn described(&self) -> String {
        let one = |(binding, held): &(Binding, Held)| match held {
            Held::Buffer(buffer, _) => format!("{} {} bytes", binding.name, buffer.raw.size()),
            Held::Texture(texture) => {
                format!("{} {:?} {:?}", binding.name, texture.size(), texture.raw.format())
            }
            Held::Sampler(_) => binding.name.clone(),
        };
        self.held.iter().map(one).collect::<Vec<_>>().join(", ")
    }
}

/// The texels of a texture that was written.
pub fn texels(name: String, texture: &Texture) -> Written {
    use TextureFormat as F;
    let wide = |kind| (texture.read_words(gpu()).expect("the device answers"), vec![kind]);
    let (words, kinds) = match texture.raw.format() {
        F::R32Uint | F::Rg32Uint | F::Rgba32Uint => wide(Word::Whole),
        F::R32Float | F::Rg32Float | F::Rgba32Float => wide(Word::Float),
        _ => {
            let values = texture.read(gpu()).expect("the device answers");
            (values.into_iter().map(f32::to_bits).collect(), vec![Word::Float])
        }
    };
    Written { name, words, kinds }
}

fn buffer(words: &[u32]) -> Buffer {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    Buffer::with_bytes(gpu(), &bytes, wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE)
}

fn extent(dimension: TextureDimension, size: [u32; 2], volume: [u32; 3], random: &mut Random) -> [u32; 3] {
    match dimension {
        TextureDimension::D3 => volume,
        TextureDimension::D2Array => [size[0], size[1], 1 + random.below(9) as u32],
        _ => [size[0], size[1], 1],
    }
}

fn view_dimension(dimension: TextureDimension) -> wgpu::TextureViewDimension {
    match dimension {
        TextureDimension::D3 => wgpu::TextureViewDimension::D3,
        TextureDimension::D2Array => wgpu::TextureViewDimension::D2Array,
        TextureDimension::D2 => wgpu::TextureViewDimension::D2,
        other => panic!("no pass has a {other} texture"),
    }
}

fn sampled_format(sample: Sample, filtered: bool, name: &str, random: &mut Random) -> TextureFormat {
    use TextureFormat as F;
    match (sample, filtered) {
        (Sample::Uint, _) if name == "distances" => F::R32Uint,
        (Sample::Uint, _) => [F::Rgba32Uint, F::Rg32Uint, F::R32Uint, F::Rgba32Uint][random.below(4)],
        (_, true) => [F::Rgba16Float, F::Rgba16Float, F::R16Float, F::Rgba8Unorm][random.below(4)],
        (_, false) => [F::Rgba32Float, F::Rgba32Float, F::R32Float, F::Rgba16Float][random.below(4)],
    }
}

fn create(
    extent: [u32; 3],
    format: TextureFormat,
    dimension: TextureDimension,
    usage: TextureUsages,
    samples: u32,
) -> Texture {
    let raw = gpu().device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: extent[0], height: extent[1], depth_or_array_layers: extent[2] },
        mip_level_count: 1,
        sample_count: samples,
        dimension: match dimension {
            TextureDimension::D3 => wgpu::TextureDimension::D3,
            _ => wgpu::TextureDimension::D2,
        },
        format,
        usage: usage | TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    Texture::whole(raw, view_dimension(dimension))
}

fn texture(
    extent: [u32; 3],
    format: TextureFormat,
    dimension: TextureDimension,
    storage: bool,
    content: Content,
    random: &mut Random,
) -> Texture {
    let usage = if storage { TextureUsages::STORAGE_BINDING } else { TextureUsages::empty() };
    let copies = TextureUsages::COPY_DST | TextureUsages::COPY_SRC;
    let texture = create(extent, format, dimension, usage | copies, 1);
    let numbers = extent.iter().product::<u32>() as usize * usize::from(format.components());
    let size = format.block_copy_size(None).expect("a format of one plane");
    let spread = Spread::any(random);
    let any_bits = random.below(2) == 0;
    let bytes: Vec<u8> = match size / u32::from(format.components()) {
        1 => (0..numbers).map(|_| random.bits() as u8).collect(),
        2 => (0..numbers).flat_map(|_| texel_half(random, content, spread).to_le_bytes()).collect(),
        _ if matches!(
            format,
            TextureFormat::R32Uint | TextureFormat::Rg32Uint | TextureFormat::Rgba32Uint
        ) =>
        {
            let word = |random: &mut Random| match content {
                _ if content.is_sane() && !any_bits => random.below(8) as u32,
                Content::Extreme => extreme_word(random),
                _ => random.bits(),
            };
            (0..numbers).flat_map(|_| word(random).to_le_bytes()).collect()
        }
        _ => (0..numbers).flat_map(|_| texel_float(random, content, spread).to_le_bytes()).collect(),
    };
    gpu().queue.write_texture(
        texture.raw.as_image_copy(),
        &bytes,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(extent[0] * size),
            rows_per_image: Some(extent[1]),
        },
        texture.raw.size(),
    );
    texture
}

/// A depth texture of one depth a layer: only draws write to it.
fn depth_texture(
    extent: [u32; 3],
    dimension: TextureDimension,
    samples: u32,
    random: &mut Random,
) -> Texture {
    let format = TextureFormat::Depth32Float;
    let texture = create(extent, format, dimension, TextureUsages::RENDER_ATTACHMENT, samples);
    let mut encoder = gpu().encoder();
    for layer in 0..extent[2] {
        let view = texture.of_layer(layer).view;
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear([0.0, 1.0, random.unit() as f32][random.below(3)]),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
    }
    gpu().queue.submit([encoder.finish()]);
    texture
}
