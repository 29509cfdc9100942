// SPDX-License-Identifier: MIT OR Apache-2.0
//! Input data: meshes, volumes, particles, light textures, environment maps, their loaders, and the generators of scenes and of noise.
//!
//! Everything is right-handed, y up and in metres; albedos are linear RGB in 0..1. Generators are
//! deterministic: the same parameters give the same data.

mod blue_noise;
mod clouds;
mod environment;
mod fields;
mod lathe;
mod light_image;
#[cfg(feature = "command")]
mod load;
mod mesh;
mod models;
mod particles;
mod random;
mod shapes;
mod solids;
mod srgb;
mod terrain;
mod tree;
mod volume;

pub use blue_noise::{BLUE_NOISE_SIDE, blue_noise};
pub use clouds::{cloud_bank, smoke};
pub use environment::{DiscLights, Environment, EnvironmentError, EnvironmentLight, disc_lights};
#[cfg(feature = "command")]
pub use environment::{environment_from_bytes, load_environment};
pub use fields::{marschner_lobb, quadric_field, sphere_field, torus_field};
pub use lathe::{lathe, tube};
#[cfg(feature = "command")]
pub use light_image::load_light_image;
pub use light_image::{LightImage, LightImageError};
#[cfg(feature = "command")]
pub use load::{
    MediumFileError, MeshError, PARTICLE_COLUMNS, load_channels, load_mesh, load_particles, load_volume,
    mesh_from_bytes, volume_from_bytes,
};
pub use mesh::{Bounds, DEFAULT_ALBEDO, Mesh, MeshDefect};
pub use models::{aeroplane, dart, desk, mushrooms, teapot};
pub use particles::{Particle, Particles, burst};
pub use random::Random;
#[cfg(feature = "command")]
pub(crate) use random::{fractal_noise, turbulence};
pub use shapes::{cuboid, plane, sphere, torus};
pub use solids::{solid_plate, solid_ring};
pub(crate) use srgb::linear_from_srgb;
#[cfg(feature = "command")]
pub(crate) use srgb::{linear_from_hexadecimal, srgb_from_linear};
pub use terrain::{TerrainParameters, terrain, terrain_height};
pub use tree::{TreeParameters, tree};
pub use volume::{Volume, VolumeError, cloud, plume, value_range};
