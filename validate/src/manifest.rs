// SPDX-License-Identifier: MIT OR Apache-2.0
//! The manifest: everything that an engine binds, as JSON whose changes show in a diff.

mod node;

use crate::{
    Binding, BindingKind, Composed, Definition, Definitions, EntryPoint, Error, Interface, Library,
    Reflection, Stage, StructLayout,
    check::{excesses, usage},
    format_name,
};
use node::Node;
use std::collections::BTreeMap;

/// The manifest of a whole library.
///
/// It depends on the shaders alone: not on the folder they were read from, nor on their order.
///
/// # Errors
/// The first pass that does not compose.
pub fn render(library: &Library) -> Result<String, Error> {
    let mut modules: Vec<_> = library.modules().iter().collect();
    modules.sort_by(|a, b| a.path.cmp(&b.path));
    let modules = Node::list(modules, |module| {
        Node::object([
            ("path", module.path.as_str().into()),
            ("file", module.file.as_str().into()),
            ("imports", texts(&module.imports)),
        ])
    });
    let mut sources: Vec<_> = library.passes().iter().collect();
    sources.sort_by(|a, b| a.name.cmp(&b.name));
    let mut passes = Vec::new();
    for pass in sources {
        let mut permutations = Vec::new();
        for permutation in library.permutations(&pass.name)? {
            let composed = library.compose(&pass.name, &permutation.definitions)?;
            permutations.push(describe(&permutation.name, &composed));
        }
        passes.push(Node::object([
            ("name", pass.name.as_str().into()),
            ("file", pass.file.as_str().into()),
            ("imports", texts(&pass.imports)),
            ("permutations", Node::List(permutations)),
        ]));
    }
    let format = 1_u32;
    let passes = Node::List(passes);
    let document = Node::object([
        ("format", format.into()),
        ("version", env!("CARGO_PKG_VERSION").into()),
        ("modules", modules),
        ("passes", passes),
    ]);
    Ok(document.document())
}

fn texts(texts: &[String]) -> Node {
    Node::list(texts, |text| text.as_str().into())
}

fn describe(name: &str, composed: &Composed) -> Node {
    let reflection = composed.reflect();
    Node::object([
        ("name", name.into()),
        ("definitions", definitions(&composed.definitions)),
        ("needs", needs(&reflection)),
        ("entry_points", Node::list(&reflection.entry_points, |entry| entry_point(&reflection, entry))),
        ("bindings", Node::list(&reflection.bindings, binding)),
        ("structs", Node::list(&reflection.structs, layout)),
    ])
}

fn definitions(definitions: &Definitions) -> Node {
    let values = definitions.iter().map(|(name, value)| {
        let value = match value {
            Definition::Flag(value) => value.into(),
            Definition::Int(value) => value.into(),
            Definition::Unsigned(value) => value.into(),
        };
        (name.to_owned(), value)
    });
    Node::Object(values.collect())
}

fn entry_point(reflection: &Reflection, entry: &EntryPoint) -> Node {
    let usage = usage(reflection, entry);
    let uses = Node::object([
        ("uniform_buffers", usage.uniform_buffers.into()),
        ("storage_buffers", usage.storage_buffers.into()),
        ("sampled_textures", usage.sampled_textures.into()),
        ("storage_textures", usage.storage_textures.into()),
        ("samplers", usage.samplers.into()),
    ]);
    let described = Node::object([
        ("name", entry.name.as_str().into()),
        ("stage", entry.stage.to_string().into()),
        ("bindings", texts(&entry.bindings)),
    ]);
    if entry.stage == Stage::Compute {
        let uses = uses.with([
            ("workgroup_memory", usage.workgroup_memory.into()),
            ("invocations", usage.invocations.into()),
        ]);
        let size = Node::list(entry.workgroup_size, Node::from);
        described.with([("workgroup_size", size), ("uses", uses)])
    } else {
        described.with([
            ("inputs", Node::list(&entry.inputs, interface)),
            ("outputs", Node::list(&entry.outputs, interface)),
            ("uses", uses),
        ])
    }
}

fn interface(value: &Interface) -> Node {
    Node::object([
        ("location", value.location.into()),
        ("name", value.name.as_str().into()),
        ("type", value.ty.as_str().into()),
    ])
}

fn binding(binding: &Binding) -> Node {
    let described = Node::object([
        ("group", binding.group.into()),
        ("binding", binding.binding.into()),
        ("name", binding.name.as_str().into()),
    ]);
    let described = match &binding.kind {
        BindingKind::Uniform { ty, size } => described.with([
            ("kind", "uniform".into()),
            ("type", ty.as_str().into()),
            ("size", (*size).into()),
        ]),
        BindingKind::Storage { writable, ty, min_size } => described.with([
            ("kind", "storage".into()),
            ("type", ty.as_str().into()),
            ("access", if *writable { "read_write" } else { "read" }.into()),
            ("min_size", (*min_size).into()),
        ]),
        BindingKind::Texture { dimension, sample, filtered, multisampled } => described.with([
            ("kind", "texture".into()),
            ("dimension", dimension.to_string().into()),
            ("sample", sample.to_string().into()),
            ("filtered", (*filtered).into()),
            ("multisampled", (*multisampled).into()),
        ]),
        BindingKind::StorageTexture { dimension, format, access } => described.with([
            ("kind", "storage_texture".into()),
            ("dimension", dimension.to_string().into()),
            ("format", format_name(*format).into()),
            ("access", access.to_string().into()),
        ]),
        BindingKind::Sampler { comparison } => {
            described.with([("kind", "sampler".into()), ("comparison", (*comparison).into())])
        }
        BindingKind::Other { ty } => described.with([("kind", "other".into()), ("type", ty.as_str().into())]),
    };
    described.with([("entry_points", texts(&binding.entry_points))])
}

fn layout(layout: &StructLayout) -> Node {
    let members = Node::list(&layout.members, |member| {
        let described = Node::object([
            ("name", member.name.as_str().into()),
            ("type", member.ty.as_str().into()),
            ("offset", member.offset.into()),
            ("size", member.size.into()),
        ]);
        match member.stride {
            Some(stride) => described.with([("stride", stride.into())]),
            None => described,
        }
    });
    Node::object([
        ("name", layout.name.as_str().into()),
        ("size", layout.size.into()),
        ("align", layout.align.into()),
        ("members", members),
    ])
}

/// Features and limits beyond those of every WebGPU device. Composition accepts no feature.
fn needs(reflection: &Reflection) -> Node {
    let mut limits: BTreeMap<&str, u64> = BTreeMap::new();
    for excess in excesses(reflection) {
        let most = limits.entry(excess.limit).or_default();
        *most = excess.used.max(*most);
    }
    let limits = limits.into_iter().map(|(limit, used)| (limit.to_owned(), used.into()));
    Node::object([("features", Node::List(Vec::new())), ("limits", Node::Object(limits.collect()))])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use serde_json::{Value, json};

    const LEAF: &str =
        "#define_import_path airlight::core::leaf\nstruct View { size: vec2<u32>, gain: f32, pad: f32 }\n";
    const PASS: &str = "#import airlight::core::leaf::View\n@group(#{GROUP}) @binding(0) var<uniform> view: View;\n@group(#{GROUP}) @binding(1) var output: texture_storage_2d<rgba8unorm, write>;\n@compute @workgroup_size(#{WIDTH}, 8) fn main() { textureStore(output, view.size, vec4<f32>(view.gain)); }\n";
    const LISTING: &str = "pass\n+ default: WIDTH=8\n+ wide_512_invocations: WIDTH=64\n";

    #[test]
    fn it_holds_what_an_engine_binds() {
        let library = Library::from_text(
            &[("core/leaf.wgsl", LEAF)],
            &[("core/passes/pass.wgsl", PASS)],
            &[("core", LISTING)],
        );
        let text = render(&library).unwrap();
        assert_eq!(text, render(&library).unwrap());
        assert!(text.ends_with("}\n"));
        let value: Value = serde_json::from_str(&text).unwrap();
        let first = &value["passes"][0]["permutations"][0];
        assert_eq!(first["definitions"]["WIDTH"], 8);
        assert_eq!(first["bindings"][0]["type"], "View");
        assert_eq!(first["bindings"][1]["format"], "rgba8unorm");
        assert_eq!(first["bindings"][1]["access"], "write");
        assert_eq!(first["structs"][0]["members"][1]["offset"], 8);
        assert_eq!(first["entry_points"][0]["workgroup_size"], json!([8, 8, 1]));
        assert_eq!(first["needs"]["limits"], json!({}));
        let wide = &value["passes"][0]["permutations"][1];
        assert_eq!(wide["needs"]["limits"]["maxComputeInvocationsPerWorkgroup"], 512);
    }

    #[test]
    fn the_order_of_the_modules_does_not_matter() {
        let other = "#define_import_path airlight::core::other\nconst X: f32 = 1.0;\n";
        let of = |modules: &[(&str, &str)]| {
            let passes = [("core/passes/pass.wgsl", PASS)];
            render(&Library::from_text(modules, &passes, &[("core", LISTING)])).unwrap()
        };
        let (leaf, other) = (("core/leaf.wgsl", LEAF), ("core/other.wgsl", other));
        assert_eq!(of(&[leaf, other]), of(&[other, leaf]));
    }
}
