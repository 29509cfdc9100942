// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a reflection is made of.

use naga::{StorageFormat, common::wgsl::ToWgsl};
use std::fmt;

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
