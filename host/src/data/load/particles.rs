// SPDX-License-Identifier: MIT OR Apache-2.0
//! Particles from .npy files.

use super::medium::MediumFileError;
use crate::data::{Particle, Particles};
use crate::formats::read_npy;
use glam::Vec3;
use std::path::Path;

/// The columns of a particle file.
pub const PARTICLE_COLUMNS: &str = "x, y, z, radius (metres) and extinction (1/m)";

/// Loads an array of shape [n, 5], a row a particle, with the columns of [`PARTICLE_COLUMNS`], y up. The numbers may be
/// anything; what a map cannot take is dropped there.
///
/// # Errors
/// [`MediumFileError`].
pub fn load_particles(path: impl AsRef<Path>) -> Result<Particles, MediumFileError> {
    let path = path.as_ref();
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("npy")) {
        return Err(MediumFileError::UnknownExtension { path: path.to_owned(), wanted: ".npy" });
    }
    let array = read_npy(path)?;
    let [_, 5] = array.shape[..] else {
        let wanted = "particles want [n, 5], a row each, with the columns \
                      x, y, z, radius (metres) and extinction (1/m)";
        return Err(MediumFileError::Shape { path: path.to_owned(), shape: array.shape, wanted });
    };
    let particle = |row: &[f32]| Particle {
        position: Vec3::new(row[0], row[1], row[2]),
        radius: row[3],
        extinction: row[4],
    };
    Ok(Particles { list: array.to_f32().chunks_exact(5).map(particle).collect() })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::formats::{Array, ArrayData, write_npy};

    #[test]
    fn rows_are_particles_and_other_shapes_name_the_columns() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.npy");
        let values: Vec<f64> = (0..10).map(f64::from).collect();
        write_npy(&path, &Array { shape: vec![2, 5], data: ArrayData::F64(values.clone()) }).unwrap();
        let read = load_particles(&path).unwrap().list;
        let last = Particle { position: Vec3::new(5.0, 6.0, 7.0), radius: 8.0, extinction: 9.0 };
        assert_eq!((read.len(), read[1]), (2, last));
        write_npy(&path, &Array { shape: vec![0, 5], data: ArrayData::F32(vec![]) }).unwrap();
        assert!(load_particles(&path).unwrap().list.is_empty());
        for shape in [vec![5, 2], vec![10], vec![1, 2, 5]] {
            write_npy(&path, &Array { shape, data: ArrayData::F64(values.clone()) }).unwrap();
            let error = load_particles(&path).unwrap_err().to_string();
            assert!(error.contains("p.npy") && error.contains(PARTICLE_COLUMNS), "{error}");
        }
        assert!(matches!(load_particles("a.csv"), Err(MediumFileError::UnknownExtension { .. })));
        assert!(load_particles("none.npy").unwrap_err().to_string().contains("no such"));
        std::fs::write(&path, "nothing").unwrap();
        assert!(matches!(load_particles(&path), Err(MediumFileError::Array(_))));
    }
}
