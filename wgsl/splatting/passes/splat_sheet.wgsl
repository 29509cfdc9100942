// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Adds up the splats of a sheet: the mean value of the volume along each ray's way through it.
// source: Zhang and Crawfis, 4.1, steps 12 to 15 and Fig. 7.
// note: Drawn indirectly, an instance of six vertices a splat, added to a cleared rgba16float target; with the
// note: eye's camera for the picture and with the light's for its shadows. Depth does not clip. Splats around the eye are left out.
// note: Values are added in parts that half floats hold exactly: software adapters cut half floats off when they blend, which
// note: would lose up to three percent.
// note: With POLYGONS sections end at a surface, and the mean stays that of the whole way through the sheet.
// definition POLYGONS: what lies behind a surface is left out.
// definition SCANNING: every sheet draws all splats in any order, for comparison.
// binding camera: the eye's camera or the light's.
// binding volume: the volume.
// binding sheets: the sheets.
// binding kernel: the kernel.
// binding number: which sheet.
// binding splats: the splats.
// binding order: numbers of splats, sorted by the first sheet that they reach; not with SCANNING.
// binding ranges: of each sheet its stretch of the order; not with SCANNING.
// binding heights: of the first surface along each ray, along the normal of the sheets, metres, NO_SURFACE where there is none, r32float; with
// binding heights: POLYGONS only.

#import airlight::core::camera::{Camera, ORTHOGRAPHIC, towards_viewer}
#import airlight::splatting::footprint::{Kernel, footprint_section}
#import airlight::splatting::sheets::{Sheets, SheetNumber, LEAST_COSINE, sheet_heights, height_of, in_exact_parts}
#ifdef POLYGONS
#import airlight::splatting::surface_shadow::heights_before_surface
#endif
#import airlight::splatting::splat::{Splat, SplatVolume, voxel_place, linear_part, reach_along, quad_around}

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> volume: SplatVolume;
@group(#{GROUP}) @binding(2) var<uniform> sheets: Sheets;
@group(#{GROUP}) @binding(3) var<uniform> kernel: Kernel;
@group(#{GROUP}) @binding(4) var<uniform> number: SheetNumber;
@group(#{GROUP}) @binding(5) var<storage, read> splats: array<Splat>;
#ifndef SCANNING
@group(#{GROUP}) @binding(6) var<storage, read> order: array<u32>;
@group(#{GROUP}) @binding(7) var<storage, read> ranges: array<vec2<u32>>;
#endif
#ifdef POLYGONS
@group(#{GROUP}) @binding(8) var heights: texture_2d<f32>;
#endif

struct Corner {
    @builtin(position) clip: vec4<f32>,
    /// From the splat's middle, voxels.
    @location(0) offset: vec3<f32>,
    /// Along the ray, voxels, of any length.
    @location(1) along: vec3<f32>,
    /// Heights of the sheet's ends above the splat's middle, metres; its value; height of the middle.
    @location(2) @interpolate(flat) section: vec4<f32>,
}

/// The splat that instance `instance` draws.
fn drawn_splat(instance: u32) -> Splat {
#ifdef SCANNING
    return splats[min(instance, arrayLength(&splats) - 1u)];
#else
    let range = ranges[min(number.index, arrayLength(&ranges) - 1u)];
    let place = min(range.x + instance, arrayLength(&order) - 1u);
    return splats[min(order[place], arrayLength(&splats) - 1u)];
#endif
}

@vertex
fn vertex_splat(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Corner {
    let splat = drawn_splat(instance);
    let middle = (volume.world_from_voxel * vec4<f32>(voxel_place(volume, splat.voxel), 1.0)).xyz;
    let height = height_of(sheets, middle);
    let ends = sheet_heights(sheets, number.index) - height;
    let reach = reach_along(volume, sheets.normal, kernel.radius);
    let quad = quad_around(camera, volume, middle, kernel.radius, vertex);
    let touches = quad.visible && ends.x < reach && ends.y > -reach;
    let clip = camera.clip_from_world * vec4<f32>(quad.point, 1.0);
    // Anywhere between the planes: depth does not clip, and a quad beside the picture draws nothing.
    let shown = vec4<f32>(clip.xy, 0.5 * clip.w, clip.w);
    let linear = linear_part(volume.voxel_from_world);
    return Corner(
        select(vec4<f32>(2.0, 2.0, 0.5, 1.0), shown, touches),
        linear * (quad.point - middle),
        linear * -towards_viewer(camera, quad.point),
        vec4<f32>(ends, splat.value, height)
    );
}

@fragment
fn fragment_splat(corner: Corner) -> @location(0) vec4<f32> {
    let direction = corner.along * inverseSqrt(max(dot(corner.along, corner.along), 1e-30));
    let nearest = corner.offset - direction * dot(corner.offset, direction);
    let slope = sheets.normal * linear_part(volume.world_from_voxel);
    let climb = dot(slope, direction);
    let least = LEAST_COSINE * length(slope);
    let steep = select(min(climb, -least), max(climb, least), climb >= 0.0);
    var ends = corner.section.xy;
    // What lies behind the eye is not seen.
    let beyond = dot(corner.offset, direction) - length(corner.along);
    let eye = select(beyond, -1e30, camera.projection == ORTHOGRAPHIC);
#ifdef POLYGONS
    let surface = textureLoad(heights, vec2<u32>(corner.clip.xy), 0).x;
    let seen = heights_before_surface(sheets, number.index, climb >= 0.0, surface);
    ends = seen - corner.section.w;
#endif
    let places = (ends - dot(slope, nearest)) / steep;
    let section = footprint_section(
        kernel, dot(nearest, nearest), max(min(places.x, places.y), eye), max(max(places.x, places.y), eye)
    );
    return in_exact_parts(min(corner.section.z * section * abs(steep) / sheets.thickness, 4.0));
}
