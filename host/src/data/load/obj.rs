// SPDX-License-Identifier: MIT OR Apache-2.0
//! Meshes from OBJ files.

use std::io::{self, BufRead, Read};
use std::path::Path;

use glam::Vec3;

use super::{MeshError, check_size, clean_albedo};
use crate::data::mesh::{DEFAULT_ALBEDO, Mesh};

/// A reader over bytes that counts the lines it has handed out, because `tobj` does not say where it failed.
struct CountLines<'a> {
    rest: &'a [u8],
    lines: usize,
}

impl Read for CountLines<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.rest.len().min(buffer.len());
        buffer[..count].copy_from_slice(&self.rest[..count]);
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for CountLines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        Ok(self.rest)
    }

    fn consume(&mut self, count: usize) {
        let (taken, rest) = self.rest.split_at(count.min(self.rest.len()));
        self.lines += taken.iter().filter(|byte| **byte == b'\n').count();
        // A last line without its end is a line too.
        self.lines += usize::from(rest.is_empty() && taken.last().is_some_and(|byte| *byte != b'\n'));
        self.rest = rest;
    }
}

/// All triangles of an OBJ file, and the colours of the material files beside it.
pub(super) fn load(path: &Path, bytes: &[u8]) -> Result<Mesh, MeshError> {
    let options =
        tobj::LoadOptions { triangulate: true, single_index: true, ignore_points: true, ignore_lines: true };
    let mut reader = CountLines { rest: bytes, lines: 0 };
    let folder = path.parent().unwrap_or(Path::new(""));
    let loaded = tobj::load_obj_buf(&mut reader, &options, |name| tobj::load_mtl(folder.join(name)));
    let (models, materials) = loaded.map_err(|error| {
        use tobj::LoadError as E;
        // Indices are checked only at the end of an object, far from the line that has them.
        let line = match error {
            E::FaceVertexOutOfBounds => line_out_of_bounds(bytes, b"v", 0),
            E::FaceTexCoordOutOfBounds => line_out_of_bounds(bytes, b"vt", 1),
            E::FaceNormalOutOfBounds => line_out_of_bounds(bytes, b"vn", 2),
            E::FaceColorOutOfBounds => None,
            _ => Some(reader.lines.max(1)),
        };
        MeshError::Broken { path: path.to_owned(), format: "OBJ", line, reason: error.to_string() }
    })?;
    // A missing or broken material file costs its colours, not the mesh.
    let materials = materials.unwrap_or_default();
    let mut mesh = Mesh::default();
    for model in models {
        let part = model.mesh;
        let triples = |values: &[f32]| -> Vec<Vec3> {
            values.chunks_exact(3).map(|c| Vec3::new(c[0], c[1], c[2])).collect()
        };
        let positions = triples(&part.positions);
        check_size(path, mesh.vertex_count(), positions.len())?;
        let diffuse = part.material_id.and_then(|id| materials.get(id)).and_then(|m| m.diffuse);
        let colours = triples(&part.vertex_color);
        let albedos = if colours.len() == positions.len() && diffuse.is_none() {
            colours.into_iter().map(clean_albedo).collect()
        } else {
            let albedo = diffuse.map_or(DEFAULT_ALBEDO, |kd| clean_albedo(Vec3::from_array(kd)));
            vec![albedo; positions.len()]
        };
        let mut normals = triples(&part.normals);
        if normals.len() != positions.len() {
            // Zero asks for a computed one.
            normals = vec![Vec3::ZERO; positions.len()];
        }
        // What is left of a line or a point is no triangle.
        let whole = part.indices.len() / 3 * 3;
        let indices = part.indices[..whole].to_vec();
        mesh.append(&Mesh { positions, normals, albedos, indices });
    }
    Ok(mesh)
}

/// The first line of a face whose index number `place` (of position/texture/normal) has no `keyword` line.
/// A face may only use what stands before it if its indices are negative; others may stand anywhere.
fn line_out_of_bounds(bytes: &[u8], keyword: &[u8], place: usize) -> Option<usize> {
    let words = |line: &[u8]| -> Vec<Vec<u8>> {
        line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).map(<[u8]>::to_vec).collect()
    };
    let lines: Vec<_> = bytes.split(|byte| *byte == b'\n').map(words).collect();
    let is = |line: &[Vec<u8>], key: &[u8]| line.first().is_some_and(|first| first == key);
    let total = lines.iter().filter(|line| is(line, keyword)).count() as i128;
    let mut before = 0;
    for (number, line) in lines.iter().enumerate() {
        before += i128::from(is(line, keyword));
        let outside = |corner: &Vec<u8>| {
            let index = corner.split(|byte| *byte == b'/').nth(place)?;
            let index: i128 = std::str::from_utf8(index).ok()?.parse().ok()?;
            Some(index == 0 || index > total || -index > before)
        };
        if is(line, b"f") && line[1..].iter().any(|corner| outside(corner) == Some(true)) {
            return Some(number + 1);
        }
    }
    None
}
