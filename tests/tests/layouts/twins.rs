// SPDX-License-Identifier: MIT OR Apache-2.0
//! The Rust twin of every struct that host and shaders share: size, fields and the bytes that encase writes.

use crate::sentinels::Sentinel;
use airlight::ambient::{BentBlur, OcclusionSettings};
use airlight::core::{
    BrickThreshold, Camera, Light, MAX_VIEWS, ResolveDepthParameters, ShadowViews, Sky, SortParameters,
    TonemapParameters, VolumeSpace,
};
use airlight::inverse::{
    LightLayers, LightNumber, PictureRows, RaySteps, SliceView, SolverPart, SolverScalars, SolverSums,
    VoxelGrid,
};
use airlight::painterly::{
    Canvas, IsoSurface, MOST_CLIP_PLANES, RidgeParameters, StreakParameters, StrokeCounts, StrokeFrame,
    StrokeStyle, SurfaceLighting,
};
use airlight::scattering::{Frame, MarchParameters, Medium, ProjectiveRows, ProjectiveSplit, Reduction};
use airlight::splatting::{
    Kernel, Scattering, SheetLighting, SheetNumber, SheetTargets, Sheets, SoftLight, SplatBatch, SplatVolume,
};
use airlight::stylize::{
    DiffusionLevel, Disc, EpipolarKernel, Epipole, HoleParameters, TransferFunction, TransferLayer,
    TransferShare, Window,
};
use airlight::transmittance::{MediumLighting, SplatTarget};
use encase::{ShaderType, UniformBuffer, internal::WriteInto};
use glam::{Mat4, UVec2, UVec3, UVec4, Vec2, Vec3, Vec4};
use std::collections::BTreeMap;

/// Name, WGSL type, words of its sentinel, and the whole struct's bytes with only this field set.
type Field = (&'static str, &'static str, Vec<(u32, u32)>, Vec<u8>);

/// What is known of a Rust twin.
pub struct Twin {
    pub size: u64,
    pub fields: Vec<Field>,
}

pub fn bytes<T: ShaderType + WriteInto>(value: &T) -> Vec<u8> {
    let mut buffer = UniformBuffer::new(Vec::<u8>::new());
    buffer.write(value).unwrap();
    buffer.into_inner()
}

/// A twin from its fields in order: the literal fails to compile with one missing.
macro_rules! twin {
    ($twins:ident: $name:ident { $($field:ident: $ty:ty),* $(,)? }) => {{
        let zero = || $name { $($field: <$ty as Sentinel>::zero()),* };
        let mut fields = Vec::new();
        $({
            let mut value = zero();
            value.$field = <$ty as Sentinel>::sentinel();
            fields.push((stringify!($field), <$ty as Sentinel>::TYPE, <$ty as Sentinel>::words(), bytes(&value)));
        })*
        $twins.insert(stringify!($name), Twin { size: $name::min_size().get(), fields });
    }};
}

pub fn twins() -> BTreeMap<&'static str, Twin> {
    let mut twins = BTreeMap::new();
    twin!(twins: Camera {
        clip_from_world: Mat4, world_from_clip: Mat4, eye: Vec3, near_depth: f32,
        viewport: Vec2, far_depth: f32, projection: u32,
    });
    twin!(twins: Light {
        clip_from_world: Mat4, world_from_clip: Mat4, direction: Vec3, far_depth: f32,
        radiance: Vec3, kind: u32, position: Vec3, radius: f32, spot_cosines: Vec2,
        reserved_a: f32, reserved_b: f32,
    });
    twin!(twins: ShadowViews {
        clip_from_world: [Mat4; MAX_VIEWS], world_from_clip: [Mat4; MAX_VIEWS], count: u32,
        reserved_a: u32, reserved_b: u32, reserved_c: u32,
    });
    twin!(twins: Sky {
        zenith: Vec3, reserved_a: f32, horizon: Vec3, reserved_b: f32, ground: Vec3, reserved_c: f32,
    });
    twin!(twins: TonemapParameters { exposure: f32, dither: f32, reserved_a: f32, reserved_b: f32 });
    twin!(twins: Medium {
        albedo: Vec3, extinction: f32, g: f32, distance_limit: f32, reserved_a: f32, reserved_b: f32,
    });
    twin!(twins: Frame {
        light: Vec3, azimuth_min: f32, axis_a: Vec3, rows_per_radian: f32,
        axis_b: Vec3, rows: f32, eye: Vec3, wraps: f32,
        ray_light: Vec3, reserved_a: f32, ray_a: Vec3, reserved_b: f32, ray_b: Vec3, reserved_c: f32, ray_scale: Vec4,
    });
    twin!(twins: ProjectiveRows {
        origin: Vec3, near: f32, along: Vec3, tilt: f32, across: Vec3, row_min: f32, away: Vec3, row_span: f32,
        bounds: Vec4, depth_min: f32, depth_span: f32, splits: u32, projection: u32,
    });
    twin!(twins: ProjectiveSplit { clip_from_world: Mat4 });
    twin!(twins: MarchParameters { steps: u32, offset: f32, frame: u32, reserved: u32 });
    twin!(twins: Reduction { factor: u32, tolerance: f32, reserved_a: u32, reserved_b: u32 });
    twin!(twins: Window {
        before: u32, after: u32, stride: u32, reserved_a: u32, sign: f32, far_depth: f32, reserved_b: f32,
        reserved_c: f32,
    });
    twin!(twins: Disc {
        radius: u32, level: u32, first_row: u32, end_row: u32, sign: f32, far_depth: f32, begins: u32, ends: u32,
    });
    twin!(twins: Epipole { position: Vec2, depth: f32, weight: f32 });
    twin!(twins: EpipolarKernel {
        reach: u32, away: u32, sign: f32, far_depth: f32, first: u32, finish: u32, keep: f32, reserved: u32,
    });
    twin!(twins: TransferFunction {
        across: u32, down: u32, mode: u32, phase: u32, depth_limit: f32, strength: f32, brightness: f32, g: f32,
    });
    twin!(twins: TransferLayer {
        first: Vec4, second: Vec4, from_position: Vec2, to_position: Vec2, kind: u32, blend: u32, opacity: f32,
        reserved: f32,
    });
    twin!(twins: TransferShare { second: f32, reserved_a: f32, reserved_b: f32, reserved_c: f32 });
    twin!(twins: DiffusionLevel {
        size: u32, first: u32, coarse_size: u32, coarse_first: u32, parity: u32, count: u32, radius: f32,
        reserved: f32,
    });
    twin!(twins: ResolveDepthParameters {
        extinction: f32, distance_limit: f32, reserved_a: f32, reserved_b: f32,
    });
    twin!(twins: SortParameters { count: u32, shift: u32, reserved_a: u32, reserved_b: u32 });
    twin!(twins: BrickThreshold { value: f32, reserved_a: f32, reserved_b: f32, reserved_c: f32 });
    twin!(twins: VolumeSpace {
        unit_from_world: Mat4, world_from_unit: Mat4, value_scale: f32, step_length: f32,
        reserved_a: f32, reserved_b: f32,
    });
    twin!(twins: MediumLighting {
        albedo: Vec3, g: f32, distance_limit: f32, reserved_a: f32, reserved_b: f32, reserved_c: f32,
    });
    twin!(twins: IsoSurface {
        previous_world_from_unit: Mat4, clip_planes: [Vec4; MOST_CLIP_PLANES], iso_value: f32, value_offset: f32,
        voxel: f32, distance_limit: f32, clip_count: u32, refinements: u32, frame: u32, reserved: u32,
    });
    twin!(twins: SurfaceLighting {
        direction: Vec3, diffuse: f32, radiance: Vec3, specular: f32, ambient: Vec3, shininess: f32,
    });
    twin!(twins: StreakParameters { steps: u32, step_length: f32, seed: u32, contrast: f32 });
    twin!(twins: RidgeParameters { range: f32, streak_strength: f32, reserved_a: f32, reserved_b: f32 });
    twin!(twins: Canvas { color: Vec3, underpainting: f32, picture_size: Vec2, reserved: Vec2 });
    twin!(twins: SplatTarget { size: Vec2, count: u32, reserved: u32 });
    twin!(twins: HoleParameters {
        cells: Vec2, threshold: f32, persistence: f32, octaves: u32, seed: u32, travel: u32, travel_part: f32,
        displacement: f32, turn: f32, far_depth: f32, reserved: f32,
    });
    twin!(twins: StrokeFrame {
        world_from_unit: Mat4, unit_from_world: Mat4, picture_size: Vec2, seconds: f32, frame: u32,
        areas: Vec3, seed: u32, capacity: u32, generation: f32, deletion: f32, reserved: f32,
    });
    twin!(twins: StrokeStyle {
        thresholds: Vec3, hysteresis: f32, probability: Vec3, gradient_scale: f32, size: Vec3, size_variation: f32,
        aspect: Vec3, color_variation: f32, opacity: Vec3, density_unit: f32, density_min: Vec3, anticipation: f32,
        density_max: Vec3, occlusion_tolerance: f32, brush: Vec3, orientation: u32, angle: f32, color_rate: f32,
        orientation_rate: f32, size_rate: f32, opacity_rate: f32, fade_out_rate: f32, hidden_rate: f32, reserved: f32,
    });
    twin!(twins: StrokeCounts {
        vertices: u32, draws: u32, first_vertex: u32, first_instance: u32, born: u32, dropped: u32,
        dropped_in_all: u32, instances: u32, coarse: u32, medium: u32, fine: u32, frames: u32,
        density_draw: UVec4,
    });
    twin!(twins: SliceView {
        origin: Vec3, slices: u32, direction: Vec3, reserved_a: u32, origin_right: Vec3, width: u32,
        direction_right: Vec3, height: u32, origin_down: Vec3, reserved_b: u32, direction_down: Vec3,
        reserved_c: u32, axis: Vec3, margin: f32, column_of: Vec4, row_of: Vec4, divisor_of: Vec4,
        edge_x: Vec3, reserved_e: u32, edge_y: Vec3, reserved_f: u32, edge_z: Vec3, reserved_g: u32,
    });
    twin!(twins: PictureRows { first: u32, count: u32, reserved_a: u32, reserved_b: u32 });
    twin!(twins: RaySteps { metres: f32, most: u32, reserved_a: u32, reserved_b: u32 });
    twin!(twins: OcclusionSettings {
        radius: f32, thickness: f32, bias: f32, samples: u32, steps: u32, side: u32, frame: u32, reserved_a: u32,
    });
    twin!(twins: BentBlur {
        axis: UVec2, taps: u32, reach: f32, least_cosine: f32, reserved_a: f32, reserved_b: f32, reserved_c: f32,
    });
    twin!(twins: VoxelGrid { size: UVec3, reserved_a: u32 });
    twin!(twins: SolverPart {
        size: UVec3, first_group: u32, laplacian: f32, smallness: f32, oneness: f32, low: f32, high: f32,
        groups: u32, steepest: f32, reserved_a: u32,
    });
    twin!(twins: LightLayers { world_from_unit: Mat4, layer_of: Vec4, size: UVec3, face: u32 });
    twin!(twins: LightNumber { index: u32, count: u32, groups: u32, reserved_a: u32 });
    twin!(twins: SolverScalars { kept: Vec4, step: Vec4, square: Vec4 });
    twin!(twins: SolverSums { groups: u32, first_picture: u32, pictures: u32, iteration: u32 });
    twin!(twins: Sheets {
        normal: Vec3, first: f32, thickness: f32, count: u32, span: u32, front_to_back: u32,
    });
    twin!(twins: SheetTargets { picture: UVec2, shadow: UVec2 });
    twin!(twins: SheetNumber { index: u32, reserved_a: u32, reserved_b: u32, reserved_c: u32 });
    twin!(twins: Kernel { sigma: f32, radius: f32, scale: f32, edge: f32 });
    twin!(twins: SplatVolume { world_from_voxel: Mat4, voxel_from_world: Mat4, size: UVec3, threshold: f32 });
    twin!(twins: SplatBatch { first: u32, count: u32, reserved_a: u32, reserved_b: u32 });
    twin!(twins: Scattering { forward_cone: f32, back_cone: f32, free_path: f32, reserved_a: f32 });
    twin!(twins: SheetLighting {
        ambient: Vec3, extinction: f32, g: f32, diffuse: f32, specular: f32, shininess: f32,
    });
    twin!(twins: SoftLight {
        size: UVec2, texel: Vec2, height: f32, local: u32, filling: f32, deepest: f32,
    });
    twins
}
