// SPDX-License-Identifier: MIT OR Apache-2.0
//! A dispatch or a render pass in the words of WebGPU's JavaScript interface.

use super::Shader;
use crate::pass::watch::{Call, Groups, Held, Run, Shape};
use crate::pass::{ColorTarget, DepthTarget, Draw, DrawExtent};
use crate::resource::{Buffer, Sampler, Texture};
use airlight_validate::{Access, Binding, BindingKind, Sample, Stage, format_name};
use serde_json::{Value, json};

/// A buffer or a texture.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(super) enum Id {
    Buffer(wgpu::Buffer),
    Texture(wgpu::Texture),
}

impl Id {
    /// None for a sampler.
    pub(super) fn of(held: &Held) -> Option<Self> {
        match held {
            Held::Buffer(buffer) => Some(Self::Buffer(buffer.raw.clone())),
            Held::Texture(texture) => Some(Self::Texture(texture.raw.clone())),
            Held::Sampler(_) => None,
        }
    }
}

/// A case without contents.
#[derive(Default)]
pub(super) struct Described {
    /// Shaders and entry points: what is the same pass.
    pub(super) key: String,
    /// Numbers of the shaders.
    pub(super) shaders: Vec<usize>,
    /// Buffers and textures, each once.
    pub(super) resources: Vec<Id>,
    /// What they are, in the same order.
    pub(super) list: Vec<Value>,
    /// Descriptors of the samplers.
    pub(super) samplers: Vec<Value>,
    /// What is written, with its name.
    pub(super) outputs: Vec<(Id, String)>,
    /// The commands.
    pub(super) run: Value,
}

/// Describes a run. Draws whose passes were built before the device was watched are left out.
pub(super) fn describe(run: &Run<'_>, shaders: &[Shader]) -> Described {
    let mut described = Described::default();
    match run {
        Run::Compute { call, entry_point, groups } => {
            let groups = match groups {
                Groups::Direct(groups) => json!(groups),
                Groups::Indirect(buffer, offset) => {
                    json!({ "buffer": described.buffer(buffer), "offset": offset })
                }
            };
            let bindings = described.bindings(call, shaders, &[Stage::Compute]);
            described.key = format!("{} {entry_point}", name(shaders, call));
            described.run = json!({
                "kind": "compute", "shader": described.shader(call), "entryPoint": entry_point,
                "bindings": bindings, "groups": groups,
            });
        }
        Run::Render { colors, depth, draws } => described.render(colors, *depth, draws, shaders),
    }
    described
}

fn name(shaders: &[Shader], call: &Call) -> String {
    shaders.get(call.shader).map_or_else(|| call.pass.clone(), Shader::name)
}

impl Described {
    /// The outputs by the places of their resources.
    pub(super) fn named_outputs(&self) -> Vec<Value> {
        let place = |id: &Id| self.resources.iter().position(|other| other == id);
        self.outputs.iter().map(|(id, name)| json!({ "name": name, "resource": place(id) })).collect()
    }

    fn shader(&mut self, call: &Call) -> usize {
        let known = self.shaders.iter().position(|shader| *shader == call.shader);
        known.unwrap_or_else(|| {
            self.shaders.push(call.shader);
            self.shaders.len() - 1
        })
    }

    fn place(&mut self, id: Id, about: impl FnOnce() -> Value) -> usize {
        let known = self.resources.iter().position(|other| *other == id);
        known.unwrap_or_else(|| {
            self.resources.push(id);
            self.list.push(about());
            self.resources.len() - 1
        })
    }

    fn buffer(&mut self, buffer: &Buffer) -> usize {
        let raw = &buffer.raw;
        self.place(Id::Buffer(raw.clone()), || json!({ "kind": "buffer", "size": raw.size() }))
    }

    /// The texture and the part of it that a view shows.
    fn texture(&mut self, texture: &Texture) -> Value {
        let raw = &texture.raw;
        let place = self.place(Id::Texture(raw.clone()), || {
            json!({
                "kind": "texture",
                "size": [raw.width(), raw.height(), raw.depth_or_array_layers()],
                "dimension": match raw.dimension() {
                    wgpu::TextureDimension::D1 => "1d",
                    wgpu::TextureDimension::D2 => "2d",
                    wgpu::TextureDimension::D3 => "3d",
                },
                "format": lower(raw.format()),
                "levels": raw.mip_level_count(),
                "samples": raw.sample_count(),
            })
        });
        let part = texture.part;
        json!({
            "resource": place,
            "view": {
                "dimension": match texture.dimension {
                    wgpu::TextureViewDimension::D1 => "1d",
                    wgpu::TextureViewDimension::D2 => "2d",
                    wgpu::TextureViewDimension::D2Array => "2d-array",
                    wgpu::TextureViewDimension::Cube => "cube",
                    wgpu::TextureViewDimension::CubeArray => "cube-array",
                    wgpu::TextureViewDimension::D3 => "3d",
                },
                "baseMipLevel": part.levels[0], "mipLevelCount": part.levels[1],
                "baseArrayLayer": part.layers[0], "arrayLayerCount": part.layers[1],
            },
        })
    }

    fn sampler(&mut self, sampler: &Sampler) -> usize {
        let wgpu::SamplerDescriptor { mag_filter, min_filter, mipmap_filter, compare, .. } =
            sampler.descriptor;
        let made = &sampler.descriptor;
        let mut about = json!({
            "addressModeU": kebab(made.address_mode_u), "addressModeV": kebab(made.address_mode_v),
            "addressModeW": kebab(made.address_mode_w), "magFilter": kebab(mag_filter),
            "minFilter": kebab(min_filter), "mipmapFilter": kebab(mipmap_filter),
        });
        if let Some(compare) = compare {
            about["compare"] = json!(kebab(compare));
        }
        self.samplers.push(about);
        self.samplers.len() - 1
    }

    fn bindings(&mut self, call: &Call, shaders: &[Shader], stages: &[Stage]) -> Vec<Value> {
        let mut list = Vec::new();
        for (binding, held) in call.resources.iter() {
            let bound = match held {
                Held::Buffer(buffer) => json!({ "resource": self.buffer(buffer) }),
                Held::Texture(texture) => self.texture(texture),
                Held::Sampler(sampler) => json!({ "sampler": self.sampler(sampler) }),
            };
            if let Some(id) = Id::of(held).filter(|_| is_written(&binding.kind)) {
                let words = shaders.get(call.shader).and_then(|shader| shader.words.get(&binding.name));
                if let (Some(words), Some(place)) = (words, bound["resource"].as_u64()) {
                    self.list[place as usize]["words"] = words.clone();
                }
                self.output(id, &binding.name);
            }
            let mut entry = layout(binding, stages);
            entry["name"] = json!(binding.name);
            entry["bound"] = bound;
            list.push(entry);
        }
        list
    }

    fn output(&mut self, id: Id, name: &str) {
        if !self.outputs.iter().any(|(other, _)| *other == id) {
            self.outputs.push((id, name.to_owned()));
        }
    }

    fn render(
        &mut self,
        colors: &[ColorTarget],
        depth: Option<&DepthTarget>,
        draws: &[Draw],
        shaders: &[Shader],
    ) {
        let mut targets = Vec::new();
        for (location, target) in colors.iter().enumerate() {
            let mut about = self.texture(&target.texture);
            about["load"] = match target.load {
                wgpu::LoadOp::Clear(color) => json!([color.r, color.g, color.b, color.a]),
                _ => Value::Null,
            };
            let id = Id::Texture(target.texture.raw.clone());
            match &target.resolve {
                None => self.output(id, &format!("colour {location}")),
                Some(resolve) => {
                    about["resolve"] = self.texture(resolve);
                    self.output(Id::Texture(resolve.raw.clone()), &format!("colour {location}"));
                }
            }
            targets.push(about);
        }
        let depth = depth.map(|target| {
            let mut about = self.texture(&target.texture);
            about["clear"] = json!(target.far_depth);
            self.output(Id::Texture(target.texture.raw.clone()), "depth");
            about
        });
        let mut keys: Vec<String> = Vec::new();
        let mut list = Vec::new();
        for (draw, (call, shape)) in draws.iter().filter_map(|draw| Some((draw, draw.watched()?))) {
            let fragment = shape.fragment.as_deref().map_or(String::new(), |name| format!(" {name}"));
            let key = format!("{} {}{fragment}", name(shaders, call), shape.vertex);
            if !keys.contains(&key) {
                keys.push(key);
            }
            let bindings = self.bindings(call, shaders, &[Stage::Vertex, Stage::Fragment]);
            let extent = match &draw.extent {
                DrawExtent::Vertices(vertices, instances) => json!({
                    "vertices": [vertices.start, vertices.end], "instances": [instances.start, instances.end],
                }),
                DrawExtent::Indices(indices, instances) => json!({
                    "indices": [indices.start, indices.end], "instances": [instances.start, instances.end],
                }),
                DrawExtent::Indirect(buffer, offset) => {
                    json!({ "buffer": self.buffer(buffer), "offset": offset })
                }
            };
            list.push(json!({
                "shader": self.shader(call), "bindings": bindings, "pipeline": pipeline(shape),
                "vertices": draw.vertices.as_ref().map(|buffer| self.buffer(buffer)),
                "indices": draw.indices.as_ref().map(|buffer| self.buffer(buffer)),
                "viewport": draw.viewport, "scissor": draw.scissor, "extent": extent,
            }));
        }
        self.key = keys.join(" + ");
        self.run = json!({ "kind": "render", "colors": targets, "depth": depth, "draws": list });
    }
}

fn is_written(kind: &BindingKind) -> bool {
    match kind {
        BindingKind::Storage { writable, .. } => *writable,
        BindingKind::StorageTexture { access, .. } => *access != Access::Read,
        _ => false,
    }
}

/// An entry of a bind group layout, visible in those of `stages` that use it.
fn layout(binding: &Binding, stages: &[Stage]) -> Value {
    let bit = |stage: &Stage| match stage {
        Stage::Vertex => 1,
        Stage::Fragment => 2,
        Stage::Compute => 4,
    };
    let used = stages.iter().filter(|stage| binding.stages.contains(stage));
    let mut entry = json!({ "binding": binding.binding, "visibility": used.map(bit).sum::<u32>() });
    match &binding.kind {
        BindingKind::Uniform { .. } | BindingKind::Other { .. } => {
            entry["buffer"] = json!({ "type": "uniform" })
        }
        BindingKind::Storage { writable, .. } => {
            entry["buffer"] = json!({ "type": if *writable { "storage" } else { "read-only-storage" } });
        }
        BindingKind::Texture { dimension, sample, filtered, multisampled } => {
            let sample = match sample {
                Sample::Float if !*filtered => "unfilterable-float".to_owned(),
                other => other.to_string(),
            };
            entry["texture"] = json!({
                "sampleType": sample, "viewDimension": dimension.to_string(), "multisampled": multisampled,
            });
        }
        BindingKind::StorageTexture { dimension, format, access } => {
            let access = match access {
                Access::Read => "read-only",
                Access::Write => "write-only",
                Access::ReadWrite => "read-write",
            };
            entry["storageTexture"] = json!({
                "access": access, "format": format_name(*format), "viewDimension": dimension.to_string(),
            });
        }
        BindingKind::Sampler { comparison } => {
            entry["sampler"] = json!({ "type": if *comparison { "comparison" } else { "filtering" } });
        }
    }
    entry
}

fn pipeline(shape: &Shape) -> Value {
    let component = |blend: wgpu::BlendComponent| {
        json!({
            "srcFactor": kebab(blend.src_factor), "dstFactor": kebab(blend.dst_factor),
            "operation": kebab(blend.operation),
        })
    };
    let targets: Vec<Value> = shape
        .targets
        .iter()
        .flatten()
        .map(|target| {
            let mut about = json!({ "format": lower(target.format) });
            if let Some(blend) = target.blend {
                about["blend"] = json!({ "color": component(blend.color), "alpha": component(blend.alpha) });
            }
            about
        })
        .collect();
    let vertices = shape.vertices.as_ref().map(|(stride, attributes)| {
        let attribute = |attribute: &wgpu::VertexAttribute| {
            json!({
                "format": lower(attribute.format), "offset": attribute.offset,
                "shaderLocation": attribute.shader_location,
            })
        };
        json!({ "arrayStride": stride, "attributes": attributes.iter().map(attribute).collect::<Vec<_>>() })
    });
    let depth = shape.depth.map(|(compare, write)| {
        json!({ "format": "depth32float", "depthCompare": kebab(compare), "depthWriteEnabled": write })
    });
    json!({
        "vertex": shape.vertex, "fragment": shape.fragment, "targets": targets, "vertices": vertices,
        "depth": depth, "samples": shape.samples,
    })
}

/// `Rgba16Float` as `rgba16float`.
fn lower(name: impl std::fmt::Debug) -> String {
    format!("{name:?}").to_lowercase()
}

/// `OneMinusSrcAlpha` as `one-minus-src-alpha`.
fn kebab(name: impl std::fmt::Debug) -> String {
    let mut text = String::new();
    for letter in format!("{name:?}").chars() {
        if letter.is_uppercase() && !text.is_empty() {
            text.push('-');
        }
        text.extend(letter.to_lowercase());
    }
    text
}
