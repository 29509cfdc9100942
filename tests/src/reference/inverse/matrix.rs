// SPDX-License-Identifier: MIT OR Apache-2.0
//! The matrix W, each of whose rows takes a property of the volume to a pixel, with every entry written down.

use super::grid::{Basis, Grid};
use super::steps::Sample;
use std::collections::BTreeMap;

/// What is solved for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Property {
    /// Emitted radiance.
    Emission,
    /// Albedo of single scattering.
    Albedo,
    /// Extinction, 1/m, whose pictures are optical depths.
    Extinction,
}

/// A property on a grid of its own: a block of columns of the matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// What it is.
    pub property: Property,
    /// Values along x, y and z.
    pub size: [usize; 3],
    /// How a field comes from them.
    pub basis: Basis,
}

impl Part {
    /// How many values it has.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.size.iter().product()
    }
}

/// What is known of the volume: one channel.
#[derive(Clone, Debug)]
pub struct Medium {
    /// 1/m; trilinear.
    pub extinction: Grid,
    /// Light that would be scattered to the viewer by an albedo of 1, radiance; trilinear.
    pub scattered: Grid,
}

/// What a ray's samples count for in its pixel.
#[derive(Clone, Debug)]
pub struct Weights {
    /// Transmittance up to each sample times its opacity.
    pub samples: Vec<f64>,
    /// Of the whole ray.
    pub transmittance: f64,
}

impl Weights {
    /// Of samples from front to back.
    #[must_use]
    pub fn new(samples: &[Sample], extinction: &Grid) -> Self {
        let mut transmittance = 1.0;
        let mut weights = Vec::with_capacity(samples.len());
        for sample in samples {
            let depth = extinction.at(Basis::Trilinear, sample.unit) * sample.length;
            weights.push(transmittance * -(-depth).exp_m1());
            transmittance *= (-depth).exp();
        }
        Self { samples: weights, transmittance }
    }
}

/// Rows of pixels, columns of values.
#[derive(Clone, Debug)]
pub struct Matrix {
    /// The blocks of columns, in order; emission and albedo together are two.
    pub parts: Vec<Part>,
    /// A row a pixel: the columns whose entries may differ from 0, in order, and these entries.
    pub rows: Vec<Vec<(usize, f64)>>,
    /// Of each pixel's ray.
    pub transmittance: Vec<f64>,
}

impl Matrix {
    /// Of rays, each given by its samples from front to back.
    #[must_use]
    pub fn new(rays: &[Vec<Sample>], medium: &Medium, parts: &[Part]) -> Self {
        let weights: Vec<Weights> = rays.iter().map(|ray| Weights::new(ray, &medium.extinction)).collect();
        let rows = rays.iter().zip(&weights).map(|(ray, weights)| {
            let mut row = BTreeMap::new();
            let mut first = 0;
            for part in parts {
                for (sample, weight) in ray.iter().zip(&weights.samples) {
                    let factor = match part.property {
                        Property::Emission => *weight,
                        Property::Albedo => weight * medium.scattered.at(Basis::Trilinear, sample.unit),
                        Property::Extinction => sample.length,
                    };
                    for (index, value) in part.basis.weights(part.size, sample.unit) {
                        *row.entry(first + index).or_insert(0.0) += factor * value;
                    }
                }
                first += part.columns();
            }
            row.into_iter().collect()
        });
        Self {
            parts: parts.to_vec(),
            rows: rows.collect(),
            transmittance: weights.iter().map(|weights| weights.transmittance).collect(),
        }
    }

    /// The rows of several pictures of the same parts, one after the other.
    #[must_use]
    pub fn stacked(matrices: &[Self]) -> Self {
        Self {
            parts: matrices.first().map(|first| first.parts.clone()).unwrap_or_default(),
            rows: matrices.iter().flat_map(|matrix| matrix.rows.clone()).collect(),
            transmittance: matrices.iter().flat_map(|matrix| matrix.transmittance.clone()).collect(),
        }
    }

    /// How many values all parts have.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.parts.iter().map(Part::columns).sum()
    }

    /// W a: what values add to each pixel.
    #[must_use]
    pub fn apply(&self, values: &[f64]) -> Vec<f64> {
        let pixel = |row: &Vec<(usize, f64)>| row.iter().map(|&(column, entry)| entry * values[column]).sum();
        self.rows.iter().map(pixel).collect()
    }

    /// The transposed W times a value a pixel.
    #[must_use]
    pub fn apply_transposed(&self, pixels: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; self.columns()];
        for (row, pixel) in self.rows.iter().zip(pixels) {
            for &(column, entry) in row {
                values[column] += entry * pixel;
            }
        }
        values
    }

    /// The sum of each row.
    #[must_use]
    pub fn row_sums(&self) -> Vec<f64> {
        self.apply(&vec![1.0; self.columns()])
    }

    /// W a and what comes through from behind, radiance a pixel; for emission and albedo.
    #[must_use]
    pub fn picture(&self, values: &[f64], behind: &[f64]) -> Vec<f64> {
        let added = self.apply(values);
        let through = self.transmittance.iter().zip(behind);
        added
            .iter()
            .zip(through)
            .map(|(added, (transmittance, behind))| added + transmittance * behind)
            .collect()
    }

    /// One entry.
    #[must_use]
    pub fn entry(&self, row: usize, column: usize) -> f64 {
        let found = self.rows[row].iter().find(|&&(other, _)| other == column);
        found.map_or(0.0, |&(_, entry)| entry)
    }
}

#[cfg(test)]
mod tests;
