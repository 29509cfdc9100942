// SPDX-License-Identifier: MIT OR Apache-2.0
//! Meshes from OBJ and glTF files.
//!
//! Both loaders take triangles, normals and a base colour, and nothing else: no textures, no animation.

use std::io::{self, BufRead, Read};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use glam::{Mat4, Vec3};

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
        "obj" => load_obj,
        "gltf" | "glb" => load_gltf,
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
    finish(path, "OBJ", || load_obj(path, bytes))
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

fn load_obj(path: &Path, bytes: &[u8]) -> Result<Mesh, MeshError> {
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

fn check_size(path: &Path, have: usize, more: usize) -> Result<(), MeshError> {
    if have.saturating_add(more) > MAX_VERTICES {
        return Err(MeshError::TooLarge { path: path.to_owned(), limit: MAX_VERTICES });
    }
    Ok(())
}

fn clean_albedo(albedo: Vec3) -> Vec3 {
    if albedo.is_finite() { albedo.clamp(Vec3::ZERO, Vec3::ONE) } else { DEFAULT_ALBEDO }
}

fn load_gltf(path: &Path, bytes: &[u8]) -> Result<Mesh, MeshError> {
    let fail = |reason: String| broken(path, "glTF", reason);
    let unsupported = |reason: String| MeshError::Unsupported { path: path.to_owned(), reason };
    let gltf::Gltf { document, blob } = match gltf::Gltf::from_slice(bytes) {
        Ok(gltf) => gltf,
        Err(gltf::Error::Validation(errors)) => {
            let places: Vec<_> = errors.iter().map(|(place, error)| format!("{place}: {error}")).collect();
            if places.iter().any(|place| place.starts_with("extensionsRequired")) {
                return Err(unsupported(
                    "the glTF file requires an extension that is not supported (compressed or quantised \
                     geometry); export it without compression"
                        .into(),
                ));
            }
            return Err(fail(places.first().cloned().unwrap_or_else(|| "it fails validation".into())));
        }
        Err(error) => return Err(fail(error.to_string())),
    };
    let base = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let buffers = gltf::import_buffers(&document, Some(base), blob).map_err(|error| match error {
        gltf::Error::Io(source) => {
            fail(format!("a buffer file beside it cannot be read ({source}); keep both in one folder"))
        }
        error => fail(error.to_string()),
    })?;

    // Nodes form trees; a node that turns up twice would be a cycle or belong to two scenes.
    let mut seen = vec![false; document.nodes().len()];
    let mut stack: Vec<(gltf::Node, Mat4)> = Vec::new();
    for scene in document.scenes() {
        stack.extend(scene.nodes().map(|node| (node, Mat4::IDENTITY)));
    }
    if document.scenes().len() == 0 {
        let mut child = vec![false; document.nodes().len()];
        for node in document.nodes() {
            node.children().for_each(|c| child[c.index()] = true);
        }
        stack.extend(document.nodes().filter(|n| !child[n.index()]).map(|n| (n, Mat4::IDENTITY)));
    }
    stack.reverse();
    let mut mesh = Mesh::default();
    while let Some((node, parent)) = stack.pop() {
        if std::mem::replace(&mut seen[node.index()], true) {
            continue;
        }
        let transform = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        if let Some(content) = node.mesh() {
            for primitive in content.primitives() {
                let part = read_primitive(path, &primitive, &buffers, mesh.vertex_count())?;
                mesh.append(&part.transformed(transform));
            }
        }
        stack.extend(node.children().map(|child| (child, transform)));
    }
    if document.nodes().len() == 0 {
        for primitive in document.meshes().flat_map(|content| content.primitives().collect::<Vec<_>>()) {
            mesh.append(&read_primitive(path, &primitive, &buffers, mesh.vertex_count())?);
        }
    }
    Ok(mesh)
}

fn read_primitive(
    path: &Path,
    primitive: &gltf::Primitive,
    buffers: &[gltf::buffer::Data],
    have: usize,
) -> Result<Mesh, MeshError> {
    use gltf::Semantic;
    use gltf::mesh::Mode;
    let fail = |reason: String| broken(path, "glTF", reason);
    let mode = primitive.mode();
    if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        return Ok(Mesh::default());
    }
    let Some(accessor) = primitive.get(&Semantic::Positions) else {
        return Ok(Mesh::default());
    };
    check_size(path, have, accessor.count())?;
    let positions = read_triples(&accessor, buffers).map_err(|e| fail(format!("POSITION: {e}")))?;
    let normals = match primitive.get(&Semantic::Normals) {
        Some(accessor) => {
            let normals = read_triples(&accessor, buffers).map_err(|e| fail(format!("NORMAL: {e}")))?;
            if normals.len() != positions.len() {
                return Err(fail(format!("{} normals for {} positions", normals.len(), positions.len())));
            }
            normals
        }
        None => vec![Vec3::ZERO; positions.len()],
    };
    let [r, g, b, _] = primitive.material().pbr_metallic_roughness().base_color_factor();
    let factor = clean_albedo(if primitive.material().index().is_some() {
        Vec3::new(r, g, b)
    } else {
        DEFAULT_ALBEDO
    });
    let albedos = match primitive.get(&Semantic::Colors(0)) {
        Some(accessor) => {
            let colours = read_triples(&accessor, buffers).map_err(|e| fail(format!("COLOR_0: {e}")))?;
            if colours.len() != positions.len() {
                return Err(fail(format!("{} colours for {} positions", colours.len(), positions.len())));
            }
            let base = if primitive.material().index().is_some() { factor } else { Vec3::ONE };
            colours.into_iter().map(|colour| clean_albedo(colour * base)).collect()
        }
        None => vec![factor; positions.len()],
    };
    let order: Vec<u32> = match primitive.indices() {
        Some(accessor) => {
            if accessor.count() > 6 * MAX_VERTICES {
                return Err(MeshError::TooLarge { path: path.to_owned(), limit: MAX_VERTICES });
            }
            read_indices(&accessor, buffers).map_err(|e| fail(format!("indices: {e}")))?
        }
        None => (0..positions.len()).filter_map(|i| u32::try_from(i).ok()).collect(),
    };
    if let Some(index) = order.iter().find(|index| **index as usize >= positions.len()) {
        return Err(fail(format!("index {index} is out of range: there are {} vertices", positions.len())));
    }
    let indices = match mode {
        Mode::TriangleStrip => order
            .windows(3)
            .enumerate()
            .flat_map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] })
            .collect(),
        Mode::TriangleFan => {
            order.get(1..).unwrap_or_default().windows(2).flat_map(|w| [order[0], w[0], w[1]]).collect()
        }
        _ => order[..order.len() / 3 * 3].to_vec(),
    };
    Ok(Mesh { positions, normals, albedos, indices })
}

/// Bytes of the elements of an accessor: `at(i)` checks every bound.
struct Elements<'a> {
    bytes: Option<&'a [u8]>,
    stride: usize,
    size: usize,
}

impl<'a> Elements<'a> {
    fn new(
        view: Option<gltf::buffer::View>,
        offset: usize,
        size: usize,
        count: usize,
        buffers: &'a [gltf::buffer::Data],
    ) -> Result<Self, String> {
        let Some(view) = view else {
            return Ok(Self { bytes: None, stride: size, size });
        };
        let stride = view.stride().unwrap_or(size);
        let outside = || "the data is shorter than the accessor says".to_owned();
        let buffer: &[u8] = buffers.get(view.buffer().index()).ok_or_else(outside)?;
        let end = view.offset().checked_add(view.length()).ok_or_else(outside)?;
        let bytes = buffer.get(view.offset()..end).and_then(|b| b.get(offset..)).ok_or_else(outside)?;
        let last = count.checked_sub(1).and_then(|n| n.checked_mul(stride)).and_then(|n| n.checked_add(size));
        if last.is_none_or(|last| last > bytes.len()) {
            return Err(outside());
        }
        Ok(Self { bytes: Some(bytes), stride, size })
    }

    fn at(&self, index: usize) -> Option<&'a [u8]> {
        let start = index.checked_mul(self.stride)?;
        self.bytes?.get(start..start.checked_add(self.size)?)
    }
}

/// All elements of an accessor through `decode`, with its sparse replacements.
fn read_elements<T: Clone + Default>(
    accessor: &gltf::Accessor,
    buffers: &[gltf::buffer::Data],
    decode: impl Fn(&[u8]) -> Option<T>,
) -> Result<Vec<T>, String> {
    let (count, size) = (accessor.count(), accessor.size());
    if accessor.view().is_none() && accessor.sparse().is_none() {
        return Err("the accessor has no data; export the file without compression".into());
    }
    let missing = || "the data is shorter than the accessor says".to_owned();
    let mut values = if accessor.view().is_some() {
        let base = Elements::new(accessor.view(), accessor.offset(), size, count, buffers)?;
        (0..count).map(|i| base.at(i).and_then(&decode).ok_or_else(missing)).collect::<Result<Vec<_>, _>>()?
    } else {
        vec![T::default(); count]
    };
    if let Some(sparse) = accessor.sparse() {
        let (places, replacements) = (sparse.indices(), sparse.values());
        let width = places.index_type().size();
        let place = Elements::new(Some(places.view()), places.offset(), width, sparse.count(), buffers)?;
        let value =
            Elements::new(Some(replacements.view()), replacements.offset(), size, sparse.count(), buffers)?;
        for i in 0..sparse.count() {
            let index = place.at(i).and_then(little_endian).ok_or_else(missing)? as usize;
            let slot =
                values.get_mut(index).ok_or_else(|| format!("sparse index {index} is out of range"))?;
            *slot = value.at(i).and_then(&decode).ok_or_else(missing)?;
        }
    }
    Ok(values)
}

/// One to four bytes as an unsigned number.
fn little_endian(bytes: &[u8]) -> Option<u32> {
    let mut word = [0; 4];
    word.get_mut(..bytes.len())?.copy_from_slice(bytes);
    Some(u32::from_le_bytes(word))
}

fn read_triples(accessor: &gltf::Accessor, buffers: &[gltf::buffer::Data]) -> Result<Vec<Vec3>, String> {
    use gltf::accessor::{DataType, Dimensions};
    if !matches!(accessor.dimensions(), Dimensions::Vec3 | Dimensions::Vec4) {
        return Err(format!("{:?} elements, where Vec3 is expected", accessor.dimensions()));
    }
    // The normalised types stand for fractions (of colours).
    let (width, kind) = (accessor.data_type().size(), accessor.data_type());
    let is_fraction = accessor.normalized() && matches!(kind, DataType::U8 | DataType::U16);
    if kind != DataType::F32 && !is_fraction {
        return Err(format!("components of type {kind:?}, where F32 is expected"));
    }
    let component = |bytes: &[u8], i: usize| -> Option<f32> {
        let word = little_endian(bytes.get(i * width..(i + 1) * width)?)?;
        Some(match kind {
            DataType::F32 => f32::from_bits(word),
            DataType::U8 => word as f32 / 255.0,
            _ => word as f32 / 65535.0,
        })
    };
    read_elements(accessor, buffers, |bytes| {
        Some(Vec3::new(component(bytes, 0)?, component(bytes, 1)?, component(bytes, 2)?))
    })
}

fn read_indices(accessor: &gltf::Accessor, buffers: &[gltf::buffer::Data]) -> Result<Vec<u32>, String> {
    use gltf::accessor::{DataType, Dimensions};
    let kind = accessor.data_type();
    if accessor.dimensions() != Dimensions::Scalar
        || !matches!(kind, DataType::U8 | DataType::U16 | DataType::U32)
    {
        return Err(format!(
            "{:?} elements of type {kind:?}, where unsigned scalars are expected",
            accessor.dimensions()
        ));
    }
    read_elements(accessor, buffers, little_endian)
}

#[cfg(test)]
mod tests {
    use super::super::random::Random;
    use super::*;

    const SQUARE: &str =
        "mtllib nowhere.mtl\no square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl gone\nf 1 2 3 4\n";

    fn load(name: &str, bytes: &[u8]) -> Result<Mesh, MeshError> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("a file");
        load_mesh(&path)
    }

    fn message(name: &str, bytes: &[u8]) -> String {
        load(name, bytes).expect_err("a broken file").to_string()
    }

    /// A glTF file with two triangles as a strip, moved and mirrored by two nested nodes.
    fn gltf(change: impl Fn(String) -> String, bytes: &[u8]) -> Vec<u8> {
        let text = format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
            "nodes":[{{"children":[1],"translation":[0,0,5]}},{{"mesh":0,"scale":[-1,1,1]}}],
            "materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[0.25,0.5,1,1]}}}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"mode":5,"material":0}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
            {{"bufferView":1,"componentType":5123,"count":4,"type":"SCALAR"}}],
            "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":8}}],
            "buffers":[{{"byteLength":{}}}]}}"#,
            bytes.len()
        );
        glb(&change(text), bytes)
    }

    fn glb(text: &str, bytes: &[u8]) -> Vec<u8> {
        let mut text = text.as_bytes().to_vec();
        text.resize(text.len().next_multiple_of(4), b' ');
        let word = |n: usize| u32::try_from(n).expect("small").to_le_bytes();
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend(word(28 + text.len() + bytes.len()));
        file.extend(word(text.len()));
        file.extend(b"JSON");
        file.extend(text);
        file.extend(word(bytes.len()));
        file.extend(b"BIN\0");
        file.extend(bytes);
        file
    }

    fn strip() -> Vec<u8> {
        let mut bytes = Vec::new();
        for value in [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.0f32] {
            bytes.extend(value.to_le_bytes());
        }
        for index in [0u16, 1, 2, 3] {
            bytes.extend(index.to_le_bytes());
        }
        bytes
    }

    #[test]
    fn an_obj_polygon_without_its_material_file() {
        let mesh = load("a.obj", SQUARE.as_bytes()).expect("a square");
        assert_eq!(mesh.triangle_count(), 2);
        assert!(mesh.normals.iter().all(|n| *n == Vec3::Z));
        assert!(mesh.albedos.iter().all(|a| *a == DEFAULT_ALBEDO));
    }

    #[test]
    fn obj_materials_and_vertex_colours_become_albedos() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("a.mtl"), "newmtl red\nKd 0.8 0.1 0.2\n").expect("a file");
        let path = folder.path().join("a.obj");
        std::fs::write(&path, SQUARE.replace("nowhere", "a").replace("gone", "red")).expect("a file");
        let mesh = load_mesh(&path).expect("a square");
        assert!(mesh.albedos.iter().all(|a| *a == Vec3::new(0.8, 0.1, 0.2)));

        let coloured = b"v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n";
        assert_eq!(load("b.obj", coloured).expect("a triangle").albedos, [Vec3::X, Vec3::Y, Vec3::Z]);
    }

    #[test]
    fn a_gltf_strip_under_two_nodes() {
        let mesh = load("a.glb", &gltf(|t| t, &strip())).expect("two triangles");
        assert_eq!(mesh.triangle_count(), 2);
        let bounds = mesh.bounds().expect("vertices");
        assert_eq!((bounds.min, bounds.max), (Vec3::new(-1., 0., 5.), Vec3::new(0., 1., 5.)));
        assert!(mesh.normals.iter().all(|n| (*n - Vec3::Z).length() < 1e-6), "the mirror keeps the front");
        assert_eq!(mesh.albedos[0], Vec3::new(0.25, 0.5, 1.0));
        let fan = load("a.glb", &gltf(|t| t.replace("\"mode\":5", "\"mode\":6"), &strip())).expect("a fan");
        assert_eq!(fan.triangle_count(), 2);
        let points = message("a.glb", &gltf(|t| t.replace("\"mode\":5", "\"mode\":0"), &strip()));
        assert!(points.contains("no triangles"), "{points}");
    }

    #[test]
    fn a_gltf_cycle_of_nodes_ends() {
        let cycle = gltf(|t| t.replace("\"mesh\":0,", "\"mesh\":0,\"children\":[0],"), &strip());
        assert_eq!(load("a.glb", &cycle).expect("each node once").triangle_count(), 2);
    }

    #[test]
    fn errors_name_the_file_and_the_fault() {
        let missing = load_mesh("no/such/file.obj").expect_err("nothing there").to_string();
        assert!(missing.contains("no/such/file.obj") && missing.contains("no such"), "{missing}");
        let cases: &[(&str, &[u8], &[&str])] = &[
            ("a.stl", b"solid", &["a.stl", "\"stl\"", ".glb"]),
            ("noextension", b"solid", &["noextension", ".obj"]),
            ("a.obj", b"", &["a.obj", "no triangles"]),
            ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", &["no triangles"]),
            ("a.obj", b"v 0 0 0\nv 1 zero 0\nv 0 1 0\nf 1 2 3\n", &["line 2", "position"]),
            ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 x", &["line 5", "face"]),
            ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n", &["line 5", "out of bounds"]),
            ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999\n", &["line 4"]),
            ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n", &["a.obj"]),
            ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", &["a.obj"]),
            ("a.obj", b"v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", &["vertex 1", "not finite"]),
            ("a.obj", b"v 0 0 0\nv 1e39 0 0\nv 0 1 0\nf 1 2 3\n", &["vertex 1", "not finite"]),
            ("a.obj", b"v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", &["no extent"]),
            ("a.gltf", b"{", &["a.gltf", "no valid glTF"]),
            ("a.glb", b"glTF", &["a.glb", "no valid glTF"]),
            ("a.gltf", b"{\"asset\":{\"version\":\"2.0\"}}", &["no triangles"]),
        ];
        for (name, bytes, parts) in cases {
            let message = message(name, bytes);
            for part in *parts {
                assert!(message.contains(part), "{message:?} lacks {part:?}");
            }
            assert_eq!(message.lines().count(), 1, "{message}");
        }
        let broken = |from: &str, to: &str| message("a.glb", &gltf(|t| t.replace(from, to), &strip()));
        let mut far = strip();
        far[50] = 9;
        let far = message("a.glb", &gltf(|t| t, &far));
        assert!(far.contains("index 9 is out of range"), "{far}");
        let cases = [
            ("\"byteLength\":48", "\"byteLength\":40", "shorter"),
            ("\"byteOffset\":48", "\"byteOffset\":4800000000", "shorter"),
            ("\"count\":4,\"type\":\"VEC3\"", "\"count\":40000000,\"type\":\"VEC3\"", "shorter"),
            ("\"count\":4,\"type\":\"VEC3\"", "\"count\":18446744073709551615,\"type\":\"VEC3\"", "vertices"),
            ("5126", "5121", "a.glb"),
            ("\"mesh\":0", "\"mesh\":7", "a.glb"),
            (
                "\"scene\":0",
                "\"scene\":0,\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]",
                "without compression",
            ),
        ];
        for (from, to, part) in cases {
            let message = broken(from, to);
            assert!(message.contains(part), "{to}: {message}");
        }
        let other = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"gone.bin","byteLength":4}]}"#;
        assert!(message("a.gltf", other.as_bytes()).contains("one folder"));
    }

    #[test]
    fn garbage_never_panics() {
        let mut random = Random::new(11);
        let obj = "mtllib x.mtl\nv 0 0 0 1 1 1\nv 1 0 0\nvt 0 1\nvn 0 0 1\nv 1 1 0\ng a\nusemtl b\n\
                   f 1/1/1 2/1/1 3//1\ns off\nf -1 -2 -3\nl 1 2\np 1\nv 0 1\nf 1 2 3 4 5\n";
        let binary = gltf(|t| t, &strip());
        let folder = tempfile::tempdir().expect("a temporary folder");
        for round in 0..2000 {
            let (name, seed): (&str, &[u8]) =
                if round % 2 == 0 { ("a.obj", obj.as_bytes()) } else { ("a.glb", &binary) };
            let mut bytes = seed.to_vec();
            match round / 2 % 3 {
                0 => bytes.truncate(random.below(seed.len())),
                1 => bytes.iter_mut().for_each(|b| *b = random.next_u32() as u8),
                _ => {}
            }
            for _ in 0..random.below(6) {
                if !bytes.is_empty() {
                    let place = random.below(bytes.len());
                    let digits = b"0123456789-./ \nfv\xff{}";
                    bytes[place] = digits[random.below(digits.len())];
                }
            }
            let path = folder.path().join(name);
            std::fs::write(&path, &bytes).expect("a file");
            if let Ok(mesh) = load_mesh(&path) {
                assert_eq!(mesh.validate(), Ok(()));
            }
        }
    }
}
