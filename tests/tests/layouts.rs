// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every struct that host and shaders share lies in memory as naga says: each field is written alone
//! through encase, and its bytes are looked for at the offset that reflection reports.
#![allow(clippy::unwrap_used)]

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
use airlight_validate::{BindingKind, Library, Member, StructLayout};
use encase::{ShaderType, UniformBuffer, internal::WriteInto};
use glam::{Mat4, UVec2, UVec3, UVec4, Vec2, Vec3, Vec4};
use std::collections::{BTreeMap, BTreeSet};

/// Twins that the host keeps to itself; the tests of the systems named here would fail without them.
const PRIVATE: [(&str, &str); 1] = [("ScanParameters", "tests/tests/core.rs, scans")];

/// The same distinct numbers in every field, whatever its type.
trait Sentinel: Copy {
    /// The WGSL type.
    const TYPE: &'static str;
    fn zero() -> Self;
    fn sentinel() -> Self;
    /// Words of the sentinel, and where each lies from the field's offset.
    fn words() -> Vec<(u32, u32)>;
}

impl Sentinel for f32 {
    const TYPE: &'static str = "f32";
    fn zero() -> Self {
        0.0
    }
    fn sentinel() -> Self {
        1.25
    }
    fn words() -> Vec<(u32, u32)> {
        vec![(0, 1.25_f32.to_bits())]
    }
}

impl Sentinel for u32 {
    const TYPE: &'static str = "u32";
    fn zero() -> Self {
        0
    }
    fn sentinel() -> Self {
        0x0102_0304
    }
    fn words() -> Vec<(u32, u32)> {
        vec![(0, 0x0102_0304)]
    }
}

impl Sentinel for Vec2 {
    const TYPE: &'static str = "vec2<f32>";
    fn zero() -> Self {
        Self::ZERO
    }
    fn sentinel() -> Self {
        Self::new(1.5, 2.5)
    }
    fn words() -> Vec<(u32, u32)> {
        vec![(0, 1.5_f32.to_bits()), (4, 2.5_f32.to_bits())]
    }
}

impl Sentinel for Vec3 {
    const TYPE: &'static str = "vec3<f32>";
    fn zero() -> Self {
        Self::ZERO
    }
    fn sentinel() -> Self {
        Self::new(1.5, 2.5, 3.5)
    }
    fn words() -> Vec<(u32, u32)> {
        vec![(0, 1.5_f32.to_bits()), (4, 2.5_f32.to_bits()), (8, 3.5_f32.to_bits())]
    }
}

impl Sentinel for Vec4 {
    const TYPE: &'static str = "vec4<f32>";
    fn zero() -> Self {
        Self::ZERO
    }
    fn sentinel() -> Self {
        Self::new(1.5, 2.5, 3.5, 4.5)
    }
    fn words() -> Vec<(u32, u32)> {
        vec![(0, 1.5_f32.to_bits()), (4, 2.5_f32.to_bits()), (8, 3.5_f32.to_bits()), (12, 4.5_f32.to_bits())]
    }
}

impl Sentinel for UVec2 {
    const TYPE: &'static str = "vec2<u32>";
    fn zero() -> Self {
        Self::ZERO
    }
    fn sentinel() -> Self {
        Self::new(1, 2)
    }
    fn words() -> Vec<(u32, u32)> {
        vec![(0, 1), (4, 2)]
    }
}

impl Sentinel for UVec3 {
    const TYPE: &'static str = "vec3<u32>";
    fn zero() -> Self {
        Self::ZERO
    }
    fn sentinel() -> Self {
        Self::new(1, 2, 3)
    }
    fn words() -> Vec<(u32, u32)> {
        vec![(0, 1), (4, 2), (8, 3)]
    }
}

impl Sentinel for UVec4 {
    const TYPE: &'static str = "vec4<u32>";
    fn zero() -> Self {
        Self::ZERO
    }
    fn sentinel() -> Self {
        Self::new(1, 2, 3, 4)
    }
    fn words() -> Vec<(u32, u32)> {
        vec![(0, 1), (4, 2), (8, 3), (12, 4)]
    }
}

impl Sentinel for Mat4 {
    const TYPE: &'static str = "mat4x4<f32>";
    fn zero() -> Self {
        Self::ZERO
    }
    fn sentinel() -> Self {
        Self::from_cols_array(&std::array::from_fn(|i| i as f32 + 1.0))
    }
    // Column after column: WGSL's m[column][row], a column every 16 bytes.
    fn words() -> Vec<(u32, u32)> {
        (0..16).map(|i| (4 * i, (i as f32 + 1.0).to_bits())).collect()
    }
}

impl Sentinel for [Mat4; MAX_VIEWS] {
    const TYPE: &'static str = "array<mat4x4<f32>, 6>";
    fn zero() -> Self {
        [Mat4::ZERO; MAX_VIEWS]
    }
    fn sentinel() -> Self {
        std::array::from_fn(|view| Mat4::sentinel() * (view as f32 + 1.0))
    }
    fn words() -> Vec<(u32, u32)> {
        let of = |view: u32| (0..16).map(move |i| (64 * view + 4 * i, ((i + 1) * (view + 1)) as f32));
        (0..MAX_VIEWS as u32).flat_map(of).map(|(at, value)| (at, value.to_bits())).collect()
    }
}

impl Sentinel for [Vec4; MOST_CLIP_PLANES] {
    const TYPE: &'static str = "array<vec4<f32>, 8>";
    fn zero() -> Self {
        [Vec4::ZERO; MOST_CLIP_PLANES]
    }
    fn sentinel() -> Self {
        std::array::from_fn(|plane| Vec4::sentinel() * (plane as f32 + 1.0))
    }
    fn words() -> Vec<(u32, u32)> {
        let scaled = |plane: u32, word: u32| (f32::from_bits(word) * (plane + 1) as f32).to_bits();
        let of = |plane: u32| {
            <Vec4 as Sentinel>::words()
                .into_iter()
                .map(move |(at, word)| (16 * plane + at, scaled(plane, word)))
        };
        (0..MOST_CLIP_PLANES as u32).flat_map(of).collect()
    }
}

/// Name, WGSL type, words of its sentinel, and the whole struct's bytes with only this field set.
type Field = (&'static str, &'static str, Vec<(u32, u32)>, Vec<u8>);

/// What is known of a Rust twin.
struct Twin {
    size: u64,
    fields: Vec<Field>,
}

fn bytes<T: ShaderType + WriteInto>(value: &T) -> Vec<u8> {
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

fn twins() -> BTreeMap<&'static str, Twin> {
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

/// What is wrong with a twin; none where it fits.
fn difference(layout: &StructLayout, twin: &Twin) -> Option<String> {
    let name = &layout.name;
    if u64::from(layout.size) != twin.size {
        return Some(format!("{name} has {} bytes in WGSL and {} in Rust", layout.size, twin.size));
    }
    let shader: Vec<&str> = layout.members.iter().map(|member| member.name.as_str()).collect();
    let host: Vec<&str> = twin.fields.iter().map(|field| field.0).collect();
    if shader != host {
        return Some(format!("{name} has {shader:?} in WGSL and {host:?} in Rust"));
    }
    for (member, (field, ty, words, bytes)) in layout.members.iter().zip(&twin.fields) {
        if member.ty != *ty {
            return Some(format!("{name}.{field} is {} in WGSL and {ty} in Rust", member.ty));
        }
        let mut expected = vec![0_u8; twin.size as usize];
        for (at, word) in words {
            let at = (member.offset + at) as usize;
            expected[at..at + 4].copy_from_slice(&word.to_le_bytes());
        }
        if *bytes != expected {
            let at = bytes.iter().position(|byte| *byte != 0);
            return Some(format!("{name}.{field} is at {} in WGSL and at {at:?} in Rust", member.offset));
        }
    }
    None
}

/// Every struct of a uniform or of the storage buffer that later passes read as one, with its pass.
fn shared_structs() -> Vec<(String, StructLayout)> {
    let library = Library::builtin();
    let mut found = Vec::new();
    for pass in library.passes() {
        for permutation in library.permutations(&pass.name).unwrap() {
            let reflection = library.compose(&pass.name, &permutation.definitions).unwrap().reflect();
            for binding in &reflection.bindings {
                let (BindingKind::Uniform { ty, .. } | BindingKind::Storage { ty, .. }) = &binding.kind
                else {
                    continue;
                };
                let place = format!("{}:{} binding {}", pass.name, permutation.name, binding.name);
                match (reflection.layout(ty), &binding.kind) {
                    (Some(layout), _) => found.push((place, layout.clone())),
                    (None, BindingKind::Uniform { .. }) => {
                        panic!("{place}: uniform of {ty}, which is no struct")
                    }
                    (None, _) => {}
                }
            }
        }
    }
    found
}

#[test]
fn every_shared_struct_has_a_twin_with_the_same_layout() {
    let twins = twins();
    let mut seen = BTreeSet::new();
    for (place, layout) in shared_structs() {
        if PRIVATE.iter().any(|(name, _)| *name == layout.name) {
            seen.insert(layout.name);
            continue;
        }
        let twin = twins.get(layout.name.as_str());
        let twin =
            twin.unwrap_or_else(|| panic!("{place}: the struct {} has no Rust twin here", layout.name));
        assert_eq!(difference(&layout, twin), None, "{place}");
        // Uniforms are bound whole: WGSL's alignment of structs is 16.
        assert_eq!(twin.size % 16, 0, "{place}");
        seen.insert(layout.name);
    }
    let known: BTreeSet<String> =
        twins.keys().chain(PRIVATE.iter().map(|(name, _)| name)).map(|name| (*name).to_owned()).collect();
    assert_eq!(seen, known, "a twin whose struct no pass has any more");
}

#[test]
fn a_wrong_layout_is_noticed() {
    let twins = twins();
    let (_, right) = shared_structs().into_iter().find(|(_, layout)| layout.name == "Medium").unwrap();
    let twin = &twins["Medium"];
    assert_eq!(difference(&right, twin), None);
    let wrong = |change: fn(&mut StructLayout)| {
        let mut layout = right.clone();
        change(&mut layout);
        difference(&layout, twin)
    };
    assert!(wrong(|l| l.size += 16).unwrap().contains("48 bytes"));
    assert!(wrong(|l| l.members[1].offset = 16).unwrap().contains("Medium.extinction"));
    assert!(wrong(|l| l.members.swap(1, 2)).is_some());
    assert!(wrong(|l| l.members[2].ty = "u32".to_owned()).unwrap().contains("u32"));
    let extra = Member { name: "x".to_owned(), ty: "f32".to_owned(), offset: 28, size: 4, stride: None };
    let mut longer = right.clone();
    longer.members.push(extra);
    assert!(difference(&longer, twin).is_some());
}
