// SPDX-License-Identifier: MIT OR Apache-2.0
//! Reflection against layouts worked out by hand from WGSL's rules.

#![allow(clippy::unwrap_used)]
use super::*;
use crate::compose::validate;

fn reflect(source: &str) -> Reflection {
    let module = naga::front::wgsl::parse_str(source).unwrap();
    let info = validate(&module).unwrap();
    Reflection::new(&module, &info)
}

#[test]
fn layouts_follow_wgsl() {
    let reflection = reflect(
        "struct Inner { a: f32, b: vec3<f32>, c: f32 }
         struct Outer { m: mat3x3<f32>, i: Inner, v: vec2<u32>, t: array<Inner, 3>, n: atomic<u32>, r: array<vec2<f32>> }
         @group(1) @binding(3) var<storage, read_write> outer: Outer;
         @compute @workgroup_size(4, 2) fn main() { outer.r[0] = vec2<f32>(outer.i.a); }",
    );
    let inner = reflection.layout("Inner").unwrap();
    assert_eq!((inner.size, inner.align), (32, 16));
    let offsets: Vec<u32> = inner.members.iter().map(|member| member.offset).collect();
    assert_eq!(offsets, [0, 16, 28]);
    let outer = reflection.layout("Outer").unwrap();
    let rows: Vec<(&str, &str, u32, u32, Option<u32>)> =
        outer.members.iter().map(|m| (m.name.as_str(), m.ty.as_str(), m.offset, m.size, m.stride)).collect();
    assert_eq!(
        rows,
        [
            ("m", "mat3x3<f32>", 0, 48, None),
            ("i", "Inner", 48, 32, None),
            ("v", "vec2<u32>", 80, 8, None),
            ("t", "array<Inner, 3>", 96, 96, Some(32)),
            ("n", "atomic<u32>", 192, 4, None),
            ("r", "array<vec2<f32>>", 200, 8, Some(8)),
        ]
    );
    assert_eq!(outer.size, 208);
    let binding = reflection.binding("outer").unwrap();
    assert_eq!((binding.group, binding.binding), (1, 3));
    let kind = BindingKind::Storage { writable: true, ty: "Outer".to_owned(), min_size: 208 };
    assert_eq!(binding.kind, kind);
    assert_eq!(reflection.entry_points[0].workgroup_size, [4, 2, 1]);
}

#[test]
fn filtering_is_seen_through_parameters() {
    let reflection = reflect(
        "@group(0) @binding(0) var loaded: texture_2d<f32>;
         @group(0) @binding(1) var sampled: texture_2d_array<f32>;
         @group(0) @binding(2) var shadow: texture_depth_2d;
         @group(0) @binding(3) var linear: sampler;
         @group(0) @binding(4) var compare: sampler_comparison;
         @group(0) @binding(5) var unused: texture_3d<u32>;
         @group(0) @binding(6) var cells: texture_storage_2d<r32uint, read_write>;
         fn look(t: texture_2d_array<f32>, s: sampler) -> vec4<f32> { return textureSampleLevel(t, s, vec2<f32>(0.5), 0, 0.0); }
         var<workgroup> shared_: array<f32, 5>;
         struct Input { @location(2) uv: vec2<f32>, @builtin(position) position: vec4<f32> }
         @fragment fn draw(input: Input) -> @location(0) vec4<f32> {
             return look(sampled, linear) + textureLoad(loaded, vec2<i32>(input.uv), 0)
                 + textureSampleCompareLevel(shadow, compare, input.uv, 0.5);
         }
         @compute @workgroup_size(1) fn count() { shared_[0] = 1.0; textureStore(cells, vec2<u32>(0), vec4<u32>(1)); }",
    );
    let filtered = |name: &str| match reflection.binding(name).unwrap().kind {
        BindingKind::Texture { filtered, .. } => filtered,
        ref other => panic!("{other:?}"),
    };
    assert!(filtered("sampled"));
    assert!(!filtered("loaded"));
    assert!(!filtered("shadow"));
    assert_eq!(
        reflection.binding("cells").unwrap().kind,
        BindingKind::StorageTexture {
            dimension: TextureDimension::D2,
            format: naga::StorageFormat::R32Uint,
            access: Access::ReadWrite
        }
    );
    assert_eq!(reflection.binding("unused").unwrap().entry_points, Vec::<String>::new());
    assert_eq!(reflection.binding("linear").unwrap().stages, [Stage::Fragment]);
    assert_eq!(reflection.binding("compare").unwrap().kind, BindingKind::Sampler { comparison: true });
    let draw = reflection.entry_point("draw").unwrap();
    assert_eq!(draw.bindings, ["loaded", "sampled", "shadow", "linear", "compare"]);
    assert_eq!(draw.inputs.len(), 1);
    assert_eq!((draw.inputs[0].location, draw.inputs[0].ty.as_str()), (2, "vec2<f32>"));
    assert_eq!(draw.outputs[0].location, 0);
    // 20 bytes, rounded up to 16.
    assert_eq!(reflection.entry_point("count").unwrap().workgroup_memory, 32);
}
