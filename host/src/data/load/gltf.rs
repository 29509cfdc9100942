// SPDX-License-Identifier: MIT OR Apache-2.0
//! Meshes from glTF and GLB files.

use std::path::Path;

use glam::{Mat4, Vec3};

use super::{MAX_VERTICES, MeshError, broken, check_size, clean_albedo};
use crate::data::mesh::{DEFAULT_ALBEDO, Mesh};

/// All triangles of a glTF or GLB file, under the transforms of its nodes.
pub(super) fn load(path: &Path, bytes: &[u8]) -> Result<Mesh, MeshError> {
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
