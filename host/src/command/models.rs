// SPDX-License-Identifier: MIT OR Apache-2.0
//! Meshes by name, or from files, where they are placed.

use super::CommandError;
use super::parse::Placed;
use crate::data::{Mesh, MeshError, desk, load_mesh, mesh_from_bytes, mushrooms, teapot};
use crate::scenes::{BUNNY, SUZANNE};

/// Names of the meshes that are part of the program.
const KNOWN: [&str; 5] = ["bunny", "suzanne", "teapot", "mushrooms", "desk"];

/// The meshes of `--mesh` as one.
///
/// # Errors
/// Misuse: an unknown name. A failure: a file that cannot be read, or that has no triangles.
pub fn meshes(list: &[Placed]) -> Result<Mesh, CommandError> {
    let mut whole = Mesh::default();
    for placed in list {
        whole.append(&mesh(placed)?.transformed(placed.transform()));
    }
    Ok(whole)
}

fn mesh(placed: &Placed) -> Result<Mesh, CommandError> {
    let of_program = |(name, bytes): (&str, &[u8])| mesh_from_bytes(name, bytes);
    let read = match placed.source.to_str() {
        Some("bunny") => of_program(BUNNY),
        Some("suzanne") => of_program(SUZANNE),
        Some("teapot") => Ok(teapot()),
        Some("mushrooms") => Ok(mushrooms()),
        Some("desk") => Ok(desk()),
        _ => load_mesh(&placed.source),
    };
    read.map_err(|error| match error {
        MeshError::UnknownExtension { path, .. } => {
            let known = KNOWN.join(", ");
            let problem = format!(
                "`{}` is unknown: give {known}, or a file that ends in .obj, .gltf or .glb",
                path.display()
            );
            CommandError::misuse("--mesh", problem)
        }
        error => CommandError::failure(format!("--mesh: {error}")),
    })
}
