// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files that the command reads and writes: arrays, volumes, pictures, animations and TOML. Every file is written whole or not at all.

mod animation;
mod array;
mod linear_picture;
mod nifti;
mod npy;
mod picture;
mod toml_file;
mod volume;
mod whole;

pub use animation::write_animation;
pub use array::{Array, ArrayData};
pub use linear_picture::{
    PictureError, PicturePixels, linear_picture_from_bytes, read_linear_picture, read_picture_values,
};
pub use npy::{ArrayError, read_npy, write_npy};
pub use picture::{write_exr, write_png};
pub use toml_file::TomlFileError;
pub(crate) use toml_file::{parse_toml, read_toml};
pub use volume::write_volumes;
pub use whole::{WriteError, create_folder, write_whole};
