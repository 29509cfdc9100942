// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/project, permutation default
// summary: Draws meshes straight into the columns of one split of a projectively rectified map: no resampling.
// source: thesis 4.4.2.
// note: Viewport and scissor cover the columns of the split. Blockers between the light and the view frustum must be
// note: clamped into the guard of the depth range. The thesis asks for depth clamping, which core WebGPU lacks: the vertex
// note: therefore lies in the middle of the clip volume's depth, and the fragment writes the depth.
// note: With the feature depth-clip-control the matrix alone, in a pass without fragments, does the same.
// note: Depth is the quotient of two interpolated numbers and not a product with the fragment position's w, whose
// note: reciprocal some back ends give.
// binding split: the matrix of the split.

/// One split of the map. 64 bytes.
struct ProjectiveSplit {
    /// World to clip space: x over the columns of the split, y over all rows, z / w the depth in the map before clamping.
    clip_from_world: mat4x4<f32>,
}

struct Varyings {
    @builtin(position) position: vec4<f32>,
    @location(0) depth_over_w: vec2<f32>,
}

@group(0) @binding(0) var<uniform> split: ProjectiveSplit;

@vertex
fn vertex_project(@location(0) position: vec3<f32>) -> Varyings {
    let clip = split.clip_from_world * vec4<f32>(position, 1.0);
    return Varyings(vec4<f32>(clip.xy, 0.5 * clip.w, clip.w), clip.zw);
}

@fragment
fn fragment_project(varyings: Varyings) -> @builtin(frag_depth) f32 {
    // Inside the clip volume w is positive.
    return clamp(varyings.depth_over_w.x / max(varyings.depth_over_w.y, 1e-30), 0.0, 1.0);
}
