// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Air between the camera and what it sees: marched through Bevy's own shadow map, scattered by Airlight's functions.

#import bevy_pbr::{
    forward_io::VertexOutput,
    mesh_view_bindings::{lights, view},
    prepass_utils::prepass_depth,
    shadows::fetch_directional_shadow,
    view_transformations::{frag_coord_to_ndc, position_ndc_to_world, position_world_to_view},
}
#import airlight::core::jitter::gradient_noise_offset
#import airlight::scattering::single_scatter::{Medium, in_scattered, transmittance}

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> medium: Medium;

const STEPS: u32 = 96u;

@fragment
fn fragment(in: VertexOutput) -> @location(0) vec4<f32> {
    // The view ray, up to the surface that the depth prepass saw; the sky has depth 0.
    let depth = prepass_depth(in.position, 0u);
    let ndc = frag_coord_to_ndc(in.position).xy;
    let surface = position_ndc_to_world(vec3<f32>(ndc, max(depth, 1e-6)));
    let eye = view.world_position;
    let direction = normalize(surface - eye);
    let distance = min(length(surface - eye), medium.distance_limit);

    // Mean visibility of the sun along it, weighted by transmittance.
    let offset = gradient_noise_offset(vec2<u32>(in.position.xy), 0u);
    var seen = 0.0;
    var weights = 0.0;
    for (var step = 0u; step < STEPS; step++) {
        let along = distance * (f32(step) + offset) / f32(STEPS);
        let point = vec4<f32>(eye + along * direction, 1.0);
        let view_z = position_world_to_view(point.xyz).z;
        let weight = transmittance(medium.extinction * along);
        seen += weight * fetch_directional_shadow(0u, point, vec3<f32>(0.0), view_z);
        weights += weight;
    }
    let sun = lights.directional_lights[0];
    let irradiance = sun.color.rgb * view.exposure;
    let cosine = dot(direction, sun.direction_to_light);
    let radiance = in_scattered(medium, irradiance, cosine, distance, seen / max(weights, 1e-6));
    // Premultiplied: what lies behind is dimmed by one minus alpha.
    return vec4<f32>(radiance, 1.0 - transmittance(medium.extinction * distance));
}
