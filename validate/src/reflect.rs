// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a host has to know of a composed module: entry points, bindings, struct layouts.

use naga::{
    AddressSpace, ArraySize, Handle, ImageClass, ImageDimension, Module, Scalar, ScalarKind, StorageAccess,
    Type, TypeInner, proc::Layouter, valid::ModuleInfo,
};
use std::collections::BTreeSet;

mod types;

pub use types::{
    Access, Binding, BindingKind, EntryPoint, Interface, Member, Reflection, Sample, Stage, StructLayout,
    TextureDimension, format_name,
};

impl Reflection {
    /// Of a module and what validation found out about it.
    pub fn new(module: &Module, info: &ModuleInfo) -> Self {
        let mut layouter = Layouter::default();
        // A validated module has a layout.
        if layouter.update(module.to_ctx()).is_err() {
            return Self::default();
        }
        let mut bindings: Vec<Binding> = Vec::new();
        let mut structs = BTreeSet::new();
        for (handle, variable) in module.global_variables.iter() {
            let Some(place) = variable.binding else { continue };
            let filtered = (0..module.entry_points.len()).any(|index| {
                let pairs = &info.get_entry_point(index).sampling_set;
                pairs.iter().any(|pair| pair.image == handle && filters(module, pair.sampler))
            });
            if matches!(variable.space, AddressSpace::Uniform | AddressSpace::Storage { .. }) {
                collect_structs(module, variable.ty, &mut structs);
            }
            let users = (0..module.entry_points.len())
                .filter(|&index| !info.get_entry_point(index)[handle].is_empty())
                .map(|index| &module.entry_points[index]);
            let stages: BTreeSet<Stage> = users.clone().map(|entry| stage(entry.stage)).collect();
            bindings.push(Binding {
                group: place.group,
                binding: place.binding,
                name: variable.name.clone().unwrap_or_default(),
                kind: kind(module, &layouter, variable, filtered),
                stages: stages.into_iter().collect(),
                entry_points: users.map(|entry| entry.name.clone()).collect(),
            });
        }
        bindings.sort_by_key(|binding| (binding.group, binding.binding));
        let entry_points = (0..module.entry_points.len())
            .map(|index| entry_point(module, info, &layouter, index, &bindings))
            .collect();
        let mut structs: Vec<StructLayout> =
            structs.into_iter().map(|handle| layout(module, &layouter, handle)).collect();
        structs.sort_by(|a, b| a.name.cmp(&b.name));
        Self { entry_points, bindings, structs }
    }

    /// A binding by its name.
    pub fn binding(&self, name: &str) -> Option<&Binding> {
        self.bindings.iter().find(|binding| binding.name == name)
    }

    /// An entry point by its name.
    pub fn entry_point(&self, name: &str) -> Option<&EntryPoint> {
        self.entry_points.iter().find(|entry| entry.name == name)
    }

    /// A struct by its name.
    pub fn layout(&self, name: &str) -> Option<&StructLayout> {
        self.structs.iter().find(|layout| layout.name == name)
    }
}

/// Whether a global is a sampler that may filter: a comparison sampler reads depth only.
fn filters(module: &Module, sampler: Handle<naga::GlobalVariable>) -> bool {
    let ty = module.global_variables[sampler].ty;
    matches!(module.types[ty].inner, TypeInner::Sampler { comparison: false })
}

fn stage(stage: naga::ShaderStage) -> Stage {
    match stage {
        naga::ShaderStage::Vertex => Stage::Vertex,
        naga::ShaderStage::Fragment => Stage::Fragment,
        // Mesh, task and ray stages need capabilities that validation does not grant.
        _ => Stage::Compute,
    }
}

fn kind(
    module: &Module,
    layouter: &Layouter,
    variable: &naga::GlobalVariable,
    filtered: bool,
) -> BindingKind {
    let size = u64::from(layouter[variable.ty].size);
    let ty = || spell(module, variable.ty);
    match (variable.space, &module.types[variable.ty].inner) {
        (AddressSpace::Uniform, _) => BindingKind::Uniform { ty: ty(), size },
        (AddressSpace::Storage { access }, _) => {
            BindingKind::Storage { writable: access.contains(StorageAccess::STORE), ty: ty(), min_size: size }
        }
        (_, TypeInner::Sampler { comparison }) => BindingKind::Sampler { comparison: *comparison },
        (_, TypeInner::Image { dim, arrayed, class }) => {
            let dimension = match (dim, arrayed) {
                (ImageDimension::D1, _) => TextureDimension::D1,
                (ImageDimension::D2, false) => TextureDimension::D2,
                (ImageDimension::D2, true) => TextureDimension::D2Array,
                (ImageDimension::D3, _) => TextureDimension::D3,
                (ImageDimension::Cube, false) => TextureDimension::Cube,
                (ImageDimension::Cube, true) => TextureDimension::CubeArray,
            };
            let texture =
                |sample, multisampled| BindingKind::Texture { dimension, sample, filtered, multisampled };
            match *class {
                ImageClass::Sampled { kind: ScalarKind::Sint, multi } => texture(Sample::Sint, multi),
                ImageClass::Sampled { kind: ScalarKind::Uint, multi } => texture(Sample::Uint, multi),
                ImageClass::Sampled { multi, .. } => texture(Sample::Float, multi),
                ImageClass::Depth { multi } => texture(Sample::Depth, multi),
                ImageClass::Storage { format, access } => {
                    let load = access.contains(StorageAccess::LOAD);
                    let store = access.contains(StorageAccess::STORE);
                    let access = match (load, store) {
                        (true, false) => Access::Read,
                        (false, _) => Access::Write,
                        (true, true) => Access::ReadWrite,
                    };
                    BindingKind::StorageTexture { dimension, format, access }
                }
                ImageClass::External => BindingKind::Other { ty: ty() },
            }
        }
        _ => BindingKind::Other { ty: ty() },
    }
}

fn entry_point(
    module: &Module,
    info: &ModuleInfo,
    layouter: &Layouter,
    index: usize,
    bindings: &[Binding],
) -> EntryPoint {
    let entry = &module.entry_points[index];
    let uses = info.get_entry_point(index);
    let mut inputs = Vec::new();
    for argument in &entry.function.arguments {
        let name = argument.name.as_deref().unwrap_or_default();
        interface(module, name, argument.binding.as_ref(), argument.ty, &mut inputs);
    }
    let mut outputs = Vec::new();
    if let Some(result) = &entry.function.result {
        interface(module, "", result.binding.as_ref(), result.ty, &mut outputs);
    }
    let workgroup = module
        .global_variables
        .iter()
        .filter(|(handle, variable)| variable.space == AddressSpace::WorkGroup && !uses[*handle].is_empty());
    let used = bindings.iter().filter(|binding| binding.entry_points.contains(&entry.name));
    EntryPoint {
        name: entry.name.clone(),
        stage: stage(entry.stage),
        workgroup_size: entry.workgroup_size,
        bindings: used.map(|binding| binding.name.clone()).collect(),
        inputs,
        outputs,
        workgroup_memory: workgroup
            .map(|(_, variable)| {
                let layout = &layouter[variable.ty];
                // WebGPU counts each variable rounded up to 16 bytes.
                u64::from(layout.size).next_multiple_of(16)
            })
            .sum(),
    }
}

fn interface(
    module: &Module,
    name: &str,
    binding: Option<&naga::Binding>,
    ty: Handle<Type>,
    output: &mut Vec<Interface>,
) {
    match binding {
        Some(naga::Binding::Location { location, .. }) => {
            output.push(Interface { location: *location, name: name.to_owned(), ty: spell(module, ty) })
        }
        Some(naga::Binding::BuiltIn(_)) => {}
        None => {
            if let TypeInner::Struct { members, .. } = &module.types[ty].inner {
                for member in members {
                    let name = member.name.as_deref().unwrap_or_default();
                    interface(module, name, member.binding.as_ref(), member.ty, output);
                }
            }
        }
    }
}

fn collect_structs(module: &Module, ty: Handle<Type>, output: &mut BTreeSet<Handle<Type>>) {
    match &module.types[ty].inner {
        TypeInner::Struct { members, .. } if output.insert(ty) => {
            for member in members {
                collect_structs(module, member.ty, output);
            }
        }
        TypeInner::Array { base, .. } => collect_structs(module, *base, output),
        _ => {}
    }
}

fn layout(module: &Module, layouter: &Layouter, handle: Handle<Type>) -> StructLayout {
    let ty = &module.types[handle];
    let members = match &ty.inner {
        TypeInner::Struct { members, .. } => members.as_slice(),
        _ => &[],
    };
    let members = members.iter().map(|member| Member {
        name: member.name.clone().unwrap_or_default(),
        ty: spell(module, member.ty),
        offset: member.offset,
        size: layouter[member.ty].size,
        stride: match module.types[member.ty].inner {
            TypeInner::Array { stride, .. } => Some(stride),
            _ => None,
        },
    });
    StructLayout {
        name: ty.name.clone().unwrap_or_default(),
        size: layouter[handle].size,
        align: layouter[handle].alignment.round_up(1),
        members: members.collect(),
    }
}

/// The layout of a struct by its name; none of one that memory cannot hold.
// Only pages of the book ask for structs that no resource has.
#[cfg_attr(not(feature = "command"), allow(dead_code))]
pub(crate) fn layout_of(module: &Module, name: &str) -> Option<StructLayout> {
    let mut layouter = Layouter::default();
    layouter.update(module.to_ctx()).ok()?;
    let (handle, _) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name))?;
    let layout = layout(module, &layouter, handle);
    (!layout.members.is_empty() && layout.members.iter().all(|member| member.ty != "bool")).then_some(layout)
}

/// A type as WGSL spells it.
fn spell(module: &Module, handle: Handle<Type>) -> String {
    let ty = &module.types[handle];
    if let Some(name) = &ty.name {
        return name.clone();
    }
    match &ty.inner {
        TypeInner::Scalar(scalar) => spell_scalar(*scalar),
        TypeInner::Vector { size, scalar } => {
            format!("vec{}<{}>", *size as u32, spell_scalar(*scalar))
        }
        TypeInner::Matrix { columns, rows, scalar } => {
            format!("mat{}x{}<{}>", *columns as u32, *rows as u32, spell_scalar(*scalar))
        }
        TypeInner::Atomic(scalar) => format!("atomic<{}>", spell_scalar(*scalar)),
        TypeInner::Array { base, size: ArraySize::Constant(count), .. } => {
            format!("array<{}, {count}>", spell(module, *base))
        }
        TypeInner::Array { base, .. } => format!("array<{}>", spell(module, *base)),
        other => format!("{other:?}"),
    }
}

fn spell_scalar(scalar: Scalar) -> String {
    let bits = u32::from(scalar.width) * 8;
    match scalar.kind {
        ScalarKind::Sint => format!("i{bits}"),
        ScalarKind::Uint => format!("u{bits}"),
        ScalarKind::Float => format!("f{bits}"),
        ScalarKind::Bool => "bool".to_owned(),
        ScalarKind::AbstractInt | ScalarKind::AbstractFloat => "abstract".to_owned(),
    }
}

#[cfg(test)]
mod tests;
