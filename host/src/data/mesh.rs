// SPDX-License-Identifier: MIT OR Apache-2.0
//! Indexed triangle meshes with a normal and an albedo per vertex.

use glam::{Mat3, Mat4, Vec3};

/// Linear RGB albedo of meshes that bring none.
pub const DEFAULT_ALBEDO: Vec3 = Vec3::splat(0.7);

/// An axis-aligned box in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The corner with the least coordinates.
    pub min: Vec3,
    /// The corner with the greatest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// The least box around all points; `None` without points.
    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Option<Self> {
        let mut points = points.into_iter();
        let first = points.next()?;
        Some(
            points
                .fold(Self { min: first, max: first }, |b, p| Self { min: b.min.min(p), max: b.max.max(p) }),
        )
    }

    /// The middle of the box.
    pub fn center(&self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Edge lengths of the box.
    pub fn size(&self) -> Vec3 {
        self.max - self.min
    }

    /// Radius of the sphere through the corners, half of the diagonal.
    pub fn radius(&self) -> f32 {
        (self.max * 0.5 - self.min * 0.5).length()
    }

    /// The least box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The eight corners.
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
            Vec3::new(
                pick(0, self.min.x, self.max.x),
                pick(1, self.min.y, self.max.y),
                pick(2, self.min.z, self.max.z),
            )
        })
    }

    /// The least box around the eight transformed corners of an affine `transform`.
    pub fn transformed(&self, transform: Mat4) -> Self {
        let corners = self.corners().map(|corner| transform.transform_point3(corner));
        let mut bounds = Self { min: corners[0], max: corners[0] };
        for corner in corners {
            bounds = Self { min: bounds.min.min(corner), max: bounds.max.max(corner) };
        }
        bounds
    }
}

/// What is wrong with the arrays of a [`Mesh`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MeshDefect {
    /// No triangle.
    #[error("it has no triangles")]
    Empty,
    /// All vertices lie in one point.
    #[error("it has no extent: all its vertices lie in one point")]
    NoExtent,
    /// More vertices than a 32-bit index can tell apart.
    #[error("it has {0} vertices, more than 32-bit indices can address")]
    TooManyVertices(usize),
    /// A last triangle with fewer than three corners.
    #[error("it has {0} indices, which is no multiple of three")]
    IndexCount(usize),
    /// One array per vertex is shorter or longer than the positions.
    #[error("it has {positions} positions but {found} {what}")]
    ArrayLength {
        /// The array at fault.
        what: &'static str,
        /// Number of positions.
        positions: usize,
        /// Length of the array at fault.
        found: usize,
    },
    /// An index without a vertex.
    #[error("index {index} of triangle {triangle} is out of range: it has {vertices} vertices")]
    IndexOutOfRange {
        /// Triangle, counted from 0.
        triangle: usize,
        /// The index.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A value that is NaN, infinite or too large for the distances between vertices to be finite.
    #[error("the {what} of vertex {vertex} is not finite or too large")]
    NotFinite {
        /// The array at fault.
        what: &'static str,
        /// Vertex, counted from 0.
        vertex: usize,
    },
}

/// An indexed triangle mesh; front faces are counter-clockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Positions in metres.
    pub positions: Vec<Vec3>,
    /// Unit normals, one per vertex.
    pub normals: Vec<Vec3>,
    /// Linear RGB albedos in 0..1, one per vertex.
    pub albedos: Vec<Vec3>,
    /// Three indices per triangle.
    pub indices: Vec<u32>,
}

impl Mesh {
    /// The largest magnitude of a coordinate, so that squared distances stay finite in `f32`.
    pub const LARGEST_COORDINATE: f32 = 1e15;

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// The least box around all vertices; `None` without vertices.
    pub fn bounds(&self) -> Option<Bounds> {
        Bounds::of(self.positions.iter().copied())
    }

    /// The mesh under an affine `transform`. Normals go through the inverse transpose; a mirroring transform
    /// turns the winding so that front faces stay counter-clockwise.
    #[must_use]
    pub fn transformed(mut self, transform: Mat4) -> Self {
        let linear = Mat3::from_mat4(transform);
        // The cofactor matrix is the inverse transpose times the determinant and exists for singular ones too.
        let cofactors = Mat3::from_cols(
            linear.y_axis.cross(linear.z_axis),
            linear.z_axis.cross(linear.x_axis),
            linear.x_axis.cross(linear.y_axis),
        );
        let mirrored = linear.determinant() < 0.0;
        let side = if mirrored { -1.0 } else { 1.0 };
        for position in &mut self.positions {
            *position = transform.transform_point3(*position);
        }
        for normal in &mut self.normals {
            *normal = (cofactors * *normal * side).try_normalize().unwrap_or(*normal);
        }
        if mirrored {
            for triangle in self.indices.chunks_exact_mut(3) {
                triangle.swap(1, 2);
            }
        }
        self
    }

    /// The mesh with one albedo everywhere.
    #[must_use]
    pub fn with_albedo(mut self, albedo: Vec3) -> Self {
        self.albedos.clear();
        self.albedos.resize(self.positions.len(), albedo);
        self
    }

    /// Adds the triangles of `other`. Indices beyond 32 bits saturate, which [`Mesh::validate`] reports.
    pub fn append(&mut self, other: &Self) {
        let first = u32::try_from(self.positions.len()).unwrap_or(u32::MAX);
        self.positions.extend_from_slice(&other.positions);
        self.normals.extend_from_slice(&other.normals);
        self.albedos.extend_from_slice(&other.albedos);
        self.indices.extend(other.indices.iter().map(|index| index.saturating_add(first)));
    }

    /// Adds one vertex and returns its index.
    pub(crate) fn push(&mut self, position: Vec3, normal: Vec3, albedo: Vec3) -> u32 {
        let index = u32::try_from(self.positions.len()).unwrap_or(u32::MAX);
        self.positions.push(position);
        self.normals.push(normal);
        self.albedos.push(albedo);
        index
    }

    /// Replaces all normals by the area-weighted mean of the adjacent triangles' normals. Vertices without
    /// a triangle of positive area get +y.
    pub fn compute_normals(&mut self) {
        self.normals = self.area_normals();
    }

    /// Normalises the normals and replaces those that are missing, zero or not finite by computed ones.
    pub fn repair_normals(&mut self) {
        if self.normals.len() != self.positions.len() {
            self.compute_normals();
            return;
        }
        let unit = |normal: Vec3| (normal / normal.abs().max_element()).try_normalize();
        if self.normals.iter().all(|normal| unit(*normal).is_some()) {
            for normal in &mut self.normals {
                *normal = unit(*normal).unwrap_or(Vec3::Y);
            }
        } else {
            let computed = self.area_normals();
            for (normal, computed) in self.normals.iter_mut().zip(computed) {
                *normal = unit(*normal).unwrap_or(computed);
            }
        }
    }

    fn area_normals(&self) -> Vec<Vec3> {
        let mut sums = vec![glam::DVec3::ZERO; self.positions.len()];
        for triangle in self.indices.chunks_exact(3) {
            let corner = |i: usize| self.positions.get(triangle[i] as usize).map(|p| p.as_dvec3());
            if let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) {
                let area = (b - a).cross(c - a);
                for index in triangle {
                    sums[*index as usize] += area;
                }
            }
        }
        sums.into_iter().map(|sum| sum.try_normalize().map_or(Vec3::Y, |n| n.as_vec3())).collect()
    }

    /// Checks that the mesh can be drawn: triangles, indices in range, arrays of one length, finite values.
    ///
    /// # Errors
    /// The first defect.
    pub fn validate(&self) -> Result<(), MeshDefect> {
        let vertices = self.positions.len();
        if self.indices.len() < 3 {
            return Err(MeshDefect::Empty);
        }
        if u32::try_from(vertices).is_err() {
            return Err(MeshDefect::TooManyVertices(vertices));
        }
        if !self.indices.len().is_multiple_of(3) {
            return Err(MeshDefect::IndexCount(self.indices.len()));
        }
        for (what, found) in [("normals", self.normals.len()), ("albedos", self.albedos.len())] {
            if found != vertices {
                return Err(MeshDefect::ArrayLength { what, positions: vertices, found });
            }
        }
        for (place, &index) in self.indices.iter().enumerate() {
            if index as usize >= vertices {
                return Err(MeshDefect::IndexOutOfRange { triangle: place / 3, index, vertices });
            }
        }
        for (what, values) in
            [("position", &self.positions), ("normal", &self.normals), ("albedo", &self.albedos)]
        {
            let fits = |v: &Vec3| v.is_finite() && v.abs().max_element() <= Self::LARGEST_COORDINATE;
            if let Some(vertex) = values.iter().position(|v| !fits(v)) {
                return Err(MeshDefect::NotFinite { what, vertex });
            }
        }
        let bounds = Bounds::of(self.indices.iter().map(|i| self.positions[*i as usize]));
        if bounds.is_none_or(|b| b.min == b.max) {
            return Err(MeshDefect::NoExtent);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> Mesh {
        Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::Z; 3],
            albedos: vec![DEFAULT_ALBEDO; 3],
            indices: vec![0, 1, 2],
        }
    }

    #[test]
    fn bounds_and_their_transforms() {
        assert_eq!(Mesh::default().bounds(), None);
        let bounds = triangle().bounds().expect("three vertices");
        assert_eq!(bounds, Bounds { min: Vec3::ZERO, max: Vec3::new(1.0, 1.0, 0.0) });
        assert_eq!(bounds.center(), Vec3::new(0.5, 0.5, 0.0));
        assert!((bounds.radius() - 0.5f32.sqrt()).abs() < 1e-6);
        let moved = bounds.transformed(Mat4::from_translation(Vec3::Z));
        assert_eq!(bounds.union(&moved).max, Vec3::ONE);
    }

    #[test]
    fn a_mirror_keeps_front_faces_and_a_shear_keeps_normals_perpendicular() {
        let mirrored = triangle().transformed(Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0)));
        let mut computed = mirrored.clone();
        computed.compute_normals();
        assert_eq!(mirrored.normals, computed.normals);

        let shear = Mat4::from_cols_array(&[1., 0., 2., 0., 0., 3., 1., 0., 0., 0., 1., 0., 5., 6., 7., 1.]);
        let sheared = triangle().transformed(shear);
        let edge = sheared.positions[1] - sheared.positions[0];
        assert!(edge.dot(sheared.normals[0]).abs() < 1e-6);
        assert!(sheared.normals[0].is_normalized());
    }

    #[test]
    fn append_moves_indices() {
        let mut two = triangle();
        two.append(&triangle().with_albedo(Vec3::X));
        assert_eq!(two.indices, [0, 1, 2, 3, 4, 5]);
        assert_eq!(two.triangle_count(), 2);
        assert_eq!(two.albedos[3], Vec3::X);
        assert_eq!(two.validate(), Ok(()));
    }

    #[test]
    fn normals_are_repaired_where_they_are_bad() {
        let mut mesh = triangle();
        mesh.normals = vec![Vec3::ZERO, Vec3::splat(f32::NAN), Vec3::X * 1e30];
        mesh.repair_normals();
        assert_eq!(mesh.normals, [Vec3::Z, Vec3::Z, Vec3::X]);
    }

    #[test]
    fn every_defect_is_named() {
        assert_eq!(Mesh::default().validate(), Err(MeshDefect::Empty));
        let broken = |change: fn(&mut Mesh)| {
            let mut mesh = triangle();
            change(&mut mesh);
            mesh.validate()
        };
        assert_eq!(broken(|_| ()), Ok(()));
        assert_eq!(broken(|m| m.indices.push(0)), Err(MeshDefect::IndexCount(4)));
        assert_eq!(
            broken(|m| m.indices[2] = 3),
            Err(MeshDefect::IndexOutOfRange { triangle: 0, index: 3, vertices: 3 })
        );
        assert!(matches!(
            broken(|m| m.normals.clear()),
            Err(MeshDefect::ArrayLength { what: "normals", found: 0, .. })
        ));
        assert_eq!(
            broken(|m| m.positions[1].y = f32::NAN),
            Err(MeshDefect::NotFinite { what: "position", vertex: 1 })
        );
        assert_eq!(
            broken(|m| m.positions[2].x = f32::MAX),
            Err(MeshDefect::NotFinite { what: "position", vertex: 2 })
        );
        assert_eq!(broken(|m| m.positions.fill(Vec3::ONE)), Err(MeshDefect::NoExtent));
    }
}
