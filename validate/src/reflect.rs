// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a host has to know of a composed module: entry points, bindings, struct layouts.

use naga::{
    AddressSpace, ArraySize, Handle, ImageClass, ImageDimension, Module, Scalar, ScalarKind, StorageAccess,
    StorageFormat, Type, TypeInner, common::wgsl::ToWgsl, proc::Layouter, valid::ModuleInfo,
};
use std::{collections::BTreeSet, fmt};

/// A shader stage of WebGPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// `@vertex`
    Vertex,
    /// `@fragment`
    Fragment,
    /// `@compute`
    Compute,
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Vertex => "vertex",
            Self::Fragment => "fragment",
            Self::Compute => "compute",
        })
    }
}

/// Everything that a host has to know of a composed module.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Reflection {
    /// Entry points in the order of the source.
    pub entry_points: Vec<EntryPoint>,
    /// Bindings by group, then number.
    pub bindings: Vec<Binding>,
    /// The structs of uniform and storage buffers, and those inside them, by name.
    pub structs: Vec<StructLayout>,
}

/// An entry point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EntryPoint {
    /// Its name.
    pub name: String,
    /// Its stage.
    pub stage: Stage,
    /// Invocations of a workgroup in x, y, z; zero but for compute.
    pub workgroup_size: [u32; 3],
    /// Names of the bindings that it uses, in the order of [`Reflection::bindings`].
    pub bindings: Vec<String>,
    /// What it takes at `@location`s.
    pub inputs: Vec<Interface>,
    /// What it returns at `@location`s.
    pub outputs: Vec<Interface>,
    /// Bytes of the workgroup variables that it uses.
    pub workgroup_memory: u64,
}

/// A value at a `@location`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Interface {
    /// The number of the location.
    pub location: u32,
    /// The name of the argument or struct member; empty for a plain result.
    pub name: String,
    /// The type as WGSL spells it.
    pub ty: String,
}

/// A resource that a host binds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Binding {
    /// `@group`
    pub group: u32,
    /// `@binding`
    pub binding: u32,
    /// Its name in the pass.
    pub name: String,
    /// What may be bound.
    pub kind: BindingKind,
    /// Stages of the entry points that use it.
    pub stages: Vec<Stage>,
    /// Names of the entry points that use it.
    pub entry_points: Vec<String>,
}

/// What may be bound.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BindingKind {
    /// `var<uniform>`
    Uniform {
        /// The type as WGSL spells it.
        ty: String,
        /// Its size in bytes.
        size: u64,
    },
    /// `var<storage>`
    Storage {
        /// Whether it is `read_write`.
        writable: bool,
        /// The type as WGSL spells it.
        ty: String,
        /// The smallest size in bytes: with one element of an array without a length.
        min_size: u64,
    },
    /// A sampled texture.
    Texture {
        /// Its dimension.
        dimension: TextureDimension,
        /// What reading it gives.
        sample: Sample,
        /// Whether an entry point samples it through a `sampler`, so that its format must be
        /// filterable unless that sampler does not filter.
        filtered: bool,
        /// Whether it is multisampled.
        multisampled: bool,
    },
    /// A storage texture.
    StorageTexture {
        /// Its dimension.
        dimension: TextureDimension,
        /// Its format; [`format_name`] spells it.
        format: StorageFormat,
        /// How it may be used.
        access: Access,
    },
    /// A sampler.
    Sampler {
        /// Whether it is a `sampler_comparison`.
        comparison: bool,
    },
    /// Something that core WebGPU does not have; [`Library::compose`](crate::Library::compose)
    /// rejects it.
    Other {
        /// The type as naga prints it.
        ty: String,
    },
}

/// The dimension of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TextureDimension {
    /// `texture_1d`
    D1,
    /// `texture_2d`
    D2,
    /// `texture_2d_array`
    D2Array,
    /// `texture_3d`
    D3,
    /// `texture_cube`
    Cube,
    /// `texture_cube_array`
    CubeArray,
}

impl fmt::Display for TextureDimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::D1 => "1d",
            Self::D2 => "2d",
            Self::D2Array => "2d-array",
            Self::D3 => "3d",
            Self::Cube => "cube",
            Self::CubeArray => "cube-array",
        })
    }
}

/// What reading a texture gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sample {
    /// `f32`
    Float,
    /// A depth texture.
    Depth,
    /// `i32`
    Sint,
    /// `u32`
    Uint,
}

impl fmt::Display for Sample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Float => "float",
            Self::Depth => "depth",
            Self::Sint => "sint",
            Self::Uint => "uint",
        })
    }
}

/// How a storage texture may be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Access {
    /// `read`
    Read,
    /// `write`
    Write,
    /// `read_write`
    ReadWrite,
}

impl fmt::Display for Access {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Read => "read",
            Self::Write => "write",
            Self::ReadWrite => "read_write",
        })
    }
}

/// The layout of a struct in memory that host and shader share.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StructLayout {
    /// Its name.
    pub name: String,
    /// Its size in bytes, with one element of an array without a length.
    pub size: u32,
    /// Its alignment in bytes.
    pub align: u32,
    /// Its members in order.
    pub members: Vec<Member>,
}

/// A member of a struct.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    /// Its name.
    pub name: String,
    /// Its type as WGSL spells it, `mat4x4<f32>`.
    pub ty: String,
    /// Its offset in bytes.
    pub offset: u32,
    /// Its size in bytes.
    pub size: u32,
    /// Bytes from one element to the next, for an array.
    pub stride: Option<u32>,
}

/// How WGSL spells a storage format, `rgba8unorm`.
pub fn format_name(format: StorageFormat) -> &'static str {
    format.to_wgsl()
}

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
