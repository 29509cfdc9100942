// SPDX-License-Identifier: MIT OR Apache-2.0
//! Meshes from OBJ and glTF files, and media from NIfTI and .npy files.
//!
//! Both loaders of meshes take triangles, normals and a base colour, and nothing else: no textures, no animation.

mod gltf;
mod medium;
mod nifti;
mod obj;
mod particles;
#[cfg(test)]
mod tests;
mod volume;

pub use medium::MediumFileError;
pub use particles::{PARTICLE_COLUMNS, load_particles};
pub use volume::{load_channels, load_volume, volume_from_bytes};

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::mesh::{DEFAULT_ALBEDO, Mesh, MeshDefect};

/// Why a mesh file could not be loaded. Each message names the file, and what to do where that is known.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// There is no such file.
    #[error("{path}: there is no such mesh file; check the path")]
    Missing {
        /// The file.
        path: PathBuf,
    },
    /// The file, or one that it refers to, cannot be read.
    #[error("{path}: the mesh file cannot be read: {source}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// The name does not tell the format.
    #[error(
        "{path}: the mesh format {extension:?} is not known; give a file that ends in .obj, .gltf or .glb"
    )]
    UnknownExtension {
        /// The file.
        path: PathBuf,
        /// What follows the last dot of its name, if anything.
        extension: String,
    },
    /// The file is not what its name says.
    #[error("{path}{}: the file is no valid {format}: {reason}; export the mesh again", at_line(*line))]
    Broken {
        /// The file.
        path: PathBuf,
        /// Name of the format.
        format: &'static str,
        /// The line at fault, counted from 1, where it is known.
        line: Option<usize>,
        /// What is wrong.
        reason: String,
    },
    /// The file is valid but needs what the loader does not do.
    #[error("{path}: {reason}")]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What is not supported, and the remedy.
        reason: String,
    },
    /// The file could be read but does not hold a mesh that can be drawn.
    #[error("{path}: the mesh cannot be used: {defect}")]
    Defect {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        defect: MeshDefect,
    },
    /// More vertices than the loader takes.
    #[error("{path}: the mesh has more than {limit} vertices; simplify it first")]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The most vertices that are taken.
        limit: usize,
    },
}

fn at_line(line: Option<usize>) -> String {
    line.map(|line| format!(", line {line}")).unwrap_or_default()
}

/// The most vertices of a mesh file.
const MAX_VERTICES: usize = 1 << 26;

/// Loads all triangles of an OBJ, glTF or GLB file into one mesh.
///
/// Polygons are triangulated, node transforms applied, missing normals computed. Albedos are the diffuse
/// colour of an OBJ material (a missing material file is no error), the colours of OBJ vertices, or the base
/// colour factor of a glTF material times the colours of its vertices.
///
/// # Errors
/// [`MeshError`], for anything but a mesh that passes [`Mesh::validate`].
pub fn load_mesh(path: impl AsRef<Path>) -> Result<Mesh, MeshError> {
    let path = path.as_ref();
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let load = match extension.as_str() {
        "obj" => obj::load,
        "gltf" | "glb" => gltf::load,
        _ => return Err(MeshError::UnknownExtension { path: path.to_owned(), extension }),
    };
    let bytes = std::fs::read(path).map_err(|source| match source.kind() {
        io::ErrorKind::NotFound => MeshError::Missing { path: path.to_owned() },
        _ => MeshError::Unreadable { path: path.to_owned(), source },
    })?;
    finish(path, format_name(&extension), || load(path, &bytes))
}

/// A mesh from the text of an OBJ file that is part of the program. `name` stands for its path in errors.
///
/// # Errors
/// As [`load_mesh`].
pub fn mesh_from_bytes(name: &str, bytes: &[u8]) -> Result<Mesh, MeshError> {
    let path = Path::new(name);
    finish(path, "OBJ", || obj::load(path, bytes))
}

fn finish(
    path: &Path,
    format: &'static str,
    load: impl FnOnce() -> Result<Mesh, MeshError>,
) -> Result<Mesh, MeshError> {
    // The parsers are not ours; a panic in one is a broken file like any other.
    let mut mesh = catch_unwind(AssertUnwindSafe(load))
        .unwrap_or_else(|_| Err(broken(path, format, "its parser gave up")))?;
    let defect = |defect| MeshError::Defect { path: path.to_owned(), defect };
    // Normals of a file may be anything; what they are computed from must be sound first.
    let normals = std::mem::replace(&mut mesh.normals, vec![Vec3::Y; mesh.positions.len()]);
    mesh.validate().map_err(defect)?;
    mesh.normals = normals;
    mesh.repair_normals();
    mesh.validate().map_err(defect)?;
    Ok(mesh)
}

fn format_name(extension: &str) -> &'static str {
    if extension == "obj" { "OBJ" } else { "glTF" }
}

fn broken(path: &Path, format: &'static str, reason: impl Into<String>) -> MeshError {
    MeshError::Broken { path: path.to_owned(), format, line: None, reason: reason.into() }
}

fn check_size(path: &Path, have: usize, more: usize) -> Result<(), MeshError> {
    if have.saturating_add(more) > MAX_VERTICES {
        return Err(MeshError::TooLarge { path: path.to_owned(), limit: MAX_VERTICES });
    }
    Ok(())
}

fn clean_albedo(albedo: Vec3) -> Vec3 {
    if albedo.is_finite() { albedo.clamp(Vec3::ZERO, Vec3::ONE) } else { DEFAULT_ALBEDO }
}
