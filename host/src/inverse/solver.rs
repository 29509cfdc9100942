// SPDX-License-Identifier: MIT OR Apache-2.0
//! Conjugate gradients between bounds on the GPU.

use super::projector::{BRICK, tiles};
use super::{Collected, Fields, InverseError, PictureRows, Projector, Solved, ViewImages, VoxelGrid};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, Resource};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use encase::ShaderType;
use glam::{UVec3, Vec4};
use wgpu::TextureFormat::R32Float;

/// The uniform `SolverPart` of `inverse/solver_steps`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SolverPart {
    /// Voxels along x, y and z.
    pub size: UVec3,
    /// Where its sums begin, groups.
    pub first_group: u32,
    /// Weight of the squared Laplacian.
    pub laplacian: f32,
    /// Weight of the squared value.
    pub smallness: f32,
    /// Weight of the squared difference from 1.
    pub oneness: f32,
    /// Least value.
    pub low: f32,
    /// Greatest value.
    pub high: f32,
    /// Groups of all volumes that are solved for.
    pub groups: u32,
    /// Padding.
    pub reserved_a: u32,
    /// Padding.
    pub reserved_b: u32,
}

/// The uniform `SolverSums` of `inverse/solver_steps`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SolverSums {
    /// Groups of all volumes that are solved for.
    pub groups: u32,
    /// First sum of a picture.
    pub first_picture: u32,
    /// Sums of pictures.
    pub pictures: u32,
    /// From 0.
    pub iteration: u32,
}

/// The uniform `SolverScalars` of `inverse/solver_steps`, by channel.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SolverScalars {
    /// What is kept of the direction before.
    pub kept: Vec4,
    /// Length of the step along the direction.
    pub step: Vec4,
    /// Square of the way downhill.
    pub square: Vec4,
}

/// What is known of a volume beforehand, as multiples of the mean of W'C W 1 over all voxels that are solved for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Regulariser {
    /// Weight of the squared Laplacian: how smooth it is.
    pub laplacian: f32,
    /// Weight of the squared values: how small they are.
    pub smallness: f32,
    /// Weight of the squared differences from 1.
    pub oneness: f32,
}

/// A volume that is to be solved for.
#[derive(Debug, Clone)]
pub struct Unknown {
    /// Voxels along x, y and z.
    pub size: [u32; 3],
    /// Which are solved for, x fastest; the others are 0.
    pub solved: Vec<bool>,
    /// Values to begin with: the projector's numbers a voxel.
    pub start: Vec<f32>,
    /// Greatest value; the least is 0.
    pub high: f32,
    /// What is known beforehand.
    pub regulariser: Regulariser,
}

/// A view and the picture that is wanted of it.
pub struct Target {
    /// The view.
    pub view: ViewImages,
    /// Less what does not depend on what is solved for: the projector's numbers a pixel.
    pub wanted: Vec<f32>,
    /// How much each pixel counts, from 0 up.
    pub weights: Vec<f32>,
}

/// What the solver holds of a view.
struct Sitting {
    view: ViewImages,
    difference: Texture,
    bound: Bound,
}

/// What it holds of a volume.
struct Part {
    size: [u32; 3],
    uniform: Buffer,
    held: SolverPart,
    regulariser: Regulariser,
    solved: Buffer,
    solution: Buffer,
    gradient: Buffer,
    texture: Texture,
    bound: Bound,
    /// Of the solution and of the direction.
    packs: [Bound; 2],
}

impl Part {
    fn groups(&self) -> [u32; 3] {
        [0, 1, 2].map(|axis| self.size[axis].div_ceil(BRICK[axis]))
    }
}

/// Finds volumes whose pictures are nearest to those that are wanted.
pub struct Solver {
    projector: Projector,
    pack: Pass,
    pictures: Pass,
    volume: Pass,
    scalars: Pass,
    sittings: Vec<Sitting>,
    parts: Vec<Part>,
    counts: Buffer,
    numbers: SolverSums,
    values: Buffer,
    bound: Bound,
}

/// Scalars before the residuals.
const FIRST_RESIDUAL: usize = 3;
/// Most iterations of one solver.
const MOST_ITERATIONS: u32 = 1024;

fn exact(name: &'static str, needed: usize, given: usize) -> Result<(), InverseError> {
    if needed == given { Ok(()) } else { Err(InverseError::Count { name, needed, given }) }
}

fn bytes_of<T: Copy, const N: usize>(values: &[T], bytes: impl Fn(T) -> [u8; N]) -> Vec<u8> {
    values.iter().flat_map(|value| bytes(*value)).collect()
}

impl Solver {
    /// Prepares everything. `unknowns`: emission, albedo, both in this order, or extinction, as the projector solves for.
    ///
    /// # Errors
    /// [`InverseError`]: numbers that are missing or too many, passes that cannot be made.
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        projector: Projector,
        targets: Vec<Target>,
        unknowns: &[Unknown],
    ) -> Result<Self, InverseError> {
        let wanted_parts = if projector.solved() == Solved::Both { 2 } else { 1 };
        exact("volumes that are solved for", wanted_parts, unknowns.len())?;
        let definitions = projector.definitions();
        let pass =
            |name: &str, definitions: &Definitions| Pass::compute_with(gpu, shaders, name, definitions);
        let pack = pass("inverse/pack_volume", &definitions)?;
        let pictures = pass("inverse/picture_sums", &definitions)?;
        let volume = pass("inverse/solver_volume", &definitions)?;
        let scalars = pass("inverse/solver_scalars", &Definitions::new())?;
        let count = |size: [u32; 3]| size.iter().map(|side| *side as usize).product::<usize>();
        let groups_of = |size: [u32; 3]| (0..3).map(|i| size[i].div_ceil(BRICK[i])).product::<u32>();
        let groups: u32 = unknowns.iter().map(|unknown| groups_of(unknown.size)).sum();
        let tiles_of = |view: &ViewImages| tiles(view.size()).into_iter().product::<u32>();
        let picture_sums: u32 = targets.iter().map(|target| tiles_of(&target.view)).sum();
        let numbers = SolverSums { groups, first_picture: 2 * groups, pictures: picture_sums, iteration: 0 };
        let counts = Buffer::uniform(gpu, &numbers);
        let sums = Buffer::storage(gpu, 16 * u64::from(2 * groups + picture_sums));
        let values = Buffer::storage(gpu, 16 * (FIRST_RESIDUAL as u64 + u64::from(MOST_ITERATIONS)));
        let channels = projector.channels().numbers();

        let mut first = numbers.first_picture;
        let mut sittings = Vec::new();
        for target in targets {
            let size = target.view.size();
            let pixels = size[0] as usize * size[1] as usize;
            exact("pictures that are wanted", channels * pixels, target.wanted.len())?;
            exact("weights of a picture", pixels, target.weights.len())?;
            let image = |format| Texture::storage(gpu, size, format);
            let wanted = image(projector.format());
            wanted.write(gpu, &target.wanted)?;
            let weights = image(R32Float);
            weights.write(gpu, &target.weights)?;
            let difference = image(projector.format());
            let own = tiles_of(&target.view);
            let rows = Buffer::uniform(gpu, &PictureRows { first, count: own, reserved_a: 0, reserved_b: 0 });
            first += own;
            let bound = pictures.bind_known(
                gpu,
                &[
                    ("rows", (&rows).into()),
                    ("rendered", (&target.view.rendered).into()),
                    ("wanted", (&wanted).into()),
                    ("weights", (&weights).into()),
                    ("difference", (&difference).into()),
                    ("sums", (&sums).into()),
                ],
            )?;
            sittings.push(Sitting { view: target.view, difference, bound });
        }

        let mut first_group = 0;
        let mut parts = Vec::new();
        for unknown in unknowns {
            let size = unknown.size;
            exact("voxels that are solved for", count(size), unknown.solved.len())?;
            exact("values to begin with", channels * count(size), unknown.start.len())?;
            let bytes = 4 * channels as u64 * count(size) as u64;
            let limit = gpu.limits.max_storage_buffer_binding_size;
            if bytes > limit {
                return Err(InverseError::Memory { name: "volumes that are solved for", bytes, limit });
            }
            let held = SolverPart {
                size: UVec3::from(size),
                first_group,
                laplacian: 0.0,
                smallness: 0.0,
                oneness: 0.0,
                low: 0.0,
                high: unknown.high,
                groups,
                reserved_a: 0,
                reserved_b: 0,
            };
            first_group += groups_of(size);
            let uniform = Buffer::uniform(gpu, &held);
            let usage = wgpu::BufferUsages::STORAGE;
            let solved = bytes_of(&unknown.solved, |solved| u32::from(solved).to_le_bytes());
            let solved = Buffer::with_bytes(gpu, &solved, usage);
            let known = |place: usize| unknown.solved[place / channels];
            let start = unknown.start.iter().enumerate();
            let start: Vec<f32> =
                start.map(|(place, value)| if known(place) { *value } else { 0.0 }).collect();
            let solution = Buffer::with_bytes(gpu, &bytes_of(&start, f32::to_le_bytes), usage);
            let [gradient, downward, direction, roughness] = [0; 4].map(|_| Buffer::storage(gpu, bytes));
            let texture = Texture::storage_volume(gpu, size, projector.format());
            let bound = volume.bind_known(
                gpu,
                &[
                    ("part", (&uniform).into()),
                    ("solved", (&solved).into()),
                    ("solution", (&solution).into()),
                    ("gradient", (&gradient).into()),
                    ("downward", (&downward).into()),
                    ("direction", (&direction).into()),
                    ("roughness", (&roughness).into()),
                    ("sums", (&sums).into()),
                    ("scalars", (&values).into()),
                ],
            )?;
            let grid = Buffer::uniform(gpu, &VoxelGrid { size: UVec3::from(size), reserved_a: 0 });
            let packing = |vector: &Buffer| {
                let resources: [(&str, Resource<'_>); 3] =
                    [("grid", (&grid).into()), ("vector", vector.into()), ("volume", (&texture).into())];
                pack.bind_known(gpu, &resources)
            };
            let packs = [packing(&solution)?, packing(&direction)?];
            let regulariser = unknown.regulariser;
            parts.push(Part {
                size,
                uniform,
                held,
                regulariser,
                solved,
                solution,
                gradient,
                texture,
                bound,
                packs,
            });
        }
        let bound = scalars.bind_known(
            gpu,
            &[("counts", (&counts).into()), ("sums", (&sums).into()), ("scalars", (&values).into())],
        )?;
        let mut solver = Self {
            projector,
            pack,
            pictures,
            volume,
            scalars,
            sittings,
            parts,
            counts,
            numbers,
            values,
            bound,
        };
        solver.regularise(gpu)?;
        Ok(solver)
    }

    /// Puts the solution (0) or the direction (1) where it is rendered from.
    fn pack(&self, encoder: &mut wgpu::CommandEncoder, which: usize) -> Result<(), InverseError> {
        for part in &self.parts {
            self.pack.dispatch_groups(encoder, &part.packs[which], "pack_volume", part.groups())?;
        }
        Ok(())
    }

    /// Renders what was packed, and does something with each picture.
    fn pictures(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        entry: &str,
    ) -> Result<(), InverseError> {
        let [Some(first), last] = [self.parts.first(), self.parts.last()] else { return Ok(()) };
        let last = last.unwrap_or(first);
        let fields = Fields { emission: &first.texture, albedo: &last.texture, extinction: &first.texture };
        for sitting in &self.sittings {
            self.projector.render(gpu, encoder, &sitting.view, fields)?;
            let groups = tiles(sitting.view.size());
            self.pictures.dispatch_groups(encoder, &sitting.bound, entry, groups)?;
        }
        Ok(())
    }

    /// Projects all weighed differences back.
    fn collect(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> Result<(), InverseError> {
        let collected: Vec<Collected<'_>> = self
            .parts
            .iter()
            .map(|part| Collected { grid: part.size, wanted: &part.solved, sums: &part.gradient })
            .collect();
        for sitting in &self.sittings {
            self.projector.backproject(gpu, encoder, &sitting.view, &sitting.difference, &collected)?;
        }
        Ok(())
    }

    fn voxels(&self, encoder: &mut wgpu::CommandEncoder, entry: &str) -> Result<(), InverseError> {
        for part in &self.parts {
            self.volume.dispatch_groups(encoder, &part.bound, entry, part.groups())?;
        }
        Ok(())
    }

    fn scalars(&self, encoder: &mut wgpu::CommandEncoder, entry: &str) -> Result<(), InverseError> {
        Ok(self.scalars.dispatch_groups(encoder, &self.bound, entry, [1, 1, 1])?)
    }

    /// Scales the regularisers by the mean of W'C W 1 over all voxels that are solved for.
    fn regularise(&mut self, gpu: &Gpu) -> Result<(), InverseError> {
        let channels = self.projector.channels().numbers();
        let solutions: Vec<Vec<u8>> =
            self.parts.iter().map(|part| part.solution.read(gpu)).collect::<Result<_, _>>()?;
        for part in &self.parts {
            let solved = part.solved.read_words(gpu)?;
            let ones: Vec<f32> = solved.iter().flat_map(|word| vec![(*word & 1) as f32; channels]).collect();
            gpu.queue.write_buffer(&part.solution.raw, 0, &bytes_of(&ones, f32::to_le_bytes));
        }
        // The weighed difference of W 1 and of what is wanted, less that of W 0: W'C W 1.
        let mut all = Vec::new();
        for _ in 0..2 {
            let mut encoder = gpu.encoder();
            self.pack(&mut encoder, 0)?;
            self.pictures(gpu, &mut encoder, "weigh_difference")?;
            self.collect(gpu, &mut encoder)?;
            gpu.submit(encoder)?;
            for part in &self.parts {
                all.push(part.gradient.read_floats(gpu)?);
                let empty = vec![0; part.gradient.raw.size() as usize];
                gpu.queue.write_buffer(&part.gradient.raw, 0, &empty);
                let nothing = vec![0; part.solution.raw.size() as usize];
                gpu.queue.write_buffer(&part.solution.raw, 0, &nothing);
            }
        }
        let (ones, zeros) = all.split_at(self.parts.len());
        let (mut sum, mut count) = (0.0_f64, 0.0_f64);
        for ((part, ones), zeros) in self.parts.iter().zip(ones).zip(zeros) {
            let solved = part.solved.read_words(gpu)?;
            for (place, (one, zero)) in ones.iter().zip(zeros).enumerate() {
                let used = channels == 1 || place % channels < 3;
                if used && solved.get(place / channels).is_some_and(|word| *word != 0) {
                    sum += f64::from(*one) - f64::from(*zero);
                    count += 1.0;
                }
            }
        }
        let scale = (sum / count.max(1.0)) as f32;
        for (part, solution) in self.parts.iter_mut().zip(solutions) {
            gpu.queue.write_buffer(&part.solution.raw, 0, &solution);
            part.held.laplacian = scale * part.regulariser.laplacian;
            part.held.smallness = scale * part.regulariser.smallness;
            part.held.oneness = scale * part.regulariser.oneness;
            part.uniform.write(gpu, &part.held);
        }
        Ok(())
    }

    /// One iteration.
    ///
    /// # Errors
    /// [`InverseError`].
    pub fn iterate(&mut self, gpu: &Gpu) -> Result<(), InverseError> {
        super::error::in_range(
            "number of iterations",
            (self.numbers.iteration + 1) as f32,
            1.0..=MOST_ITERATIONS as f32,
            "from 1 to 1024",
        )?;
        self.counts.write(gpu, &self.numbers);
        let mut encoder = gpu.encoder();
        self.pack(&mut encoder, 0)?;
        self.pictures(gpu, &mut encoder, "weigh_difference")?;
        self.scalars(&mut encoder, "keep_residual")?;
        self.collect(gpu, &mut encoder)?;
        self.voxels(&mut encoder, "smooth_solution")?;
        self.voxels(&mut encoder, "solver_gradient")?;
        self.scalars(&mut encoder, "choose_direction")?;
        self.voxels(&mut encoder, "solver_direction")?;
        self.voxels(&mut encoder, "smooth_direction")?;
        self.pack(&mut encoder, 1)?;
        self.pictures(gpu, &mut encoder, "sum_squares")?;
        self.voxels(&mut encoder, "solver_curvature")?;
        self.scalars(&mut encoder, "choose_step")?;
        self.voxels(&mut encoder, "solver_advance")?;
        gpu.submit(encoder)?;
        self.numbers.iteration += 1;
        Ok(())
    }

    /// The weighed sum of squares of what was wrong when each iteration began, by channel.
    ///
    /// # Errors
    /// [`InverseError::Gpu`].
    pub fn residuals(&self, gpu: &Gpu) -> Result<Vec<[f32; 3]>, InverseError> {
        let all = self.values.read_floats(gpu)?;
        let rows = all.chunks_exact(4).skip(FIRST_RESIDUAL).take(self.numbers.iteration as usize);
        Ok(rows.map(|row| [row[0], row[1], row[2]]).collect())
    }

    /// The volumes as they are: the projector's numbers a voxel.
    ///
    /// # Errors
    /// [`InverseError::Gpu`].
    pub fn solutions(&self, gpu: &Gpu) -> Result<Vec<Vec<f32>>, InverseError> {
        let channels = self.projector.channels().numbers();
        let read = |part: &Part| {
            let mut values = part.solution.read_floats(gpu)?;
            values.truncate(channels * part.size.iter().map(|side| *side as usize).product::<usize>());
            Ok(values)
        };
        self.parts.iter().map(read).collect()
    }
}
