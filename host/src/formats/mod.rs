// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files that the command reads and writes: arrays, pictures, animations and TOML. Every file is written whole or not at all.

mod animation;
mod array;
mod npy;
mod picture;
mod toml_file;
mod whole;

pub use animation::write_animation;
pub use array::{Array, ArrayData};
pub use npy::{ArrayError, read_npy, write_npy};
pub use picture::{write_exr, write_png};
pub use toml_file::TomlFileError;
pub(crate) use toml_file::{parse_toml, read_toml};
pub use whole::{WriteError, create_folder, write_whole};
