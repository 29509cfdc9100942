// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Chance deletes strokes where they lie too densely, and puts new ones on pixels where they lie too thinly.
// source: Ramalhao (2010), 4.2.1, 4.2.4, 4.2.5.
// note: `marks` is filled with 1 for each stroke that is kept, then for each pixel that gives birth, in the order of the frame's
// note: queue, and a 0 at the end; `core/scan` of capacity + pixels + 1 of them gives each its place in the next buffer.
// note: What is deleted fades out. Density is read at the nearest texel.
// binding surface: unit normal in the world, 0 where there is no surface, and gradient magnitude; rgba16float.
// binding distances: metres along the view ray, negative where there is no surface; r32float.
// binding frame: the frame.
// binding style: the style.
// binding density: density of the strokes, a layer a channel; rgba16float.
// binding strokes: the strokes: their states change.
// binding counts: how many there are.
// binding marks: out, 1 or 0.

#import airlight::painterly::stroke::{
    Stroke, StrokeFrame, StrokeStyle, StrokeCounts, STROKE_GONE, STROKE_STAYS, STROKE_LEAVES, LAYERS, of_layer
}
#import airlight::painterly::stroke_density::{birth_probability, deletion_probability}
#import airlight::painterly::stroke_placement::{
    layer_of, placement_hashes, thinning_hash, chance, first_in_queue, place_in_queue
}
#import airlight::painterly::stroke_targets::{magnitude_at, source_size}

@group(#{GROUP}) @binding(4) var<uniform> frame: StrokeFrame;
@group(#{GROUP}) @binding(5) var<uniform> style: StrokeStyle;
@group(#{GROUP}) @binding(6) var density: texture_2d<f32>;
@group(#{GROUP}) @binding(7) var<storage, read_write> strokes: array<Stroke>;
@group(#{GROUP}) @binding(8) var<storage, read> counts: StrokeCounts;
@group(#{GROUP}) @binding(9) var<storage, read_write> marks: array<u32>;

/// Density of a layer at a position of the picture, 0..1.
fn density_at(position: vec2<f32>, layer: u32) -> f32 {
    let size = textureDimensions(density);
    let texel = vec2<u32>(clamp(position * vec2<f32>(size), vec2<f32>(0.0), vec2<f32>(size) - 1.0));
    return of_layer(textureLoad(density, texel, 0).xyz, layer);
}

@compute @workgroup_size(64)
fn thin_strokes(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x;
    if index >= min(frame.capacity, min(arrayLength(&strokes), arrayLength(&marks))) {
        return;
    }
    let present = index < counts.instances;
    let stroke = strokes[index];
    let most = of_layer(style.density_max, stroke.layer);
    let probability = deletion_probability(density_at(stroke.position, stroke.layer), most) * frame.deletion;
    let drawn = chance(thinning_hash(stroke.hash, frame.frame, frame.seed), probability);
    let state = select(stroke.state, STROKE_LEAVES, stroke.state == STROKE_STAYS && drawn);
    if present {
        strokes[index].state = state;
    }
    marks[index] = select(0u, 1u, present && state != STROKE_GONE);
}

@compute @workgroup_size(16, 8)
fn place_strokes(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = source_size();
    if any(id.xy >= size) {
        return;
    }
    let layer = layer_of(magnitude_at(id.xy) * style.gradient_scale, style.thresholds);
    let held = min(layer, LAYERS - 1u);
    let position = (vec2<f32>(id.xy) + 0.5) / vec2<f32>(size);
    let probability = birth_probability(
        density_at(position, held), of_layer(style.density_min, held), style.density_unit,
        of_layer(style.opacity, held), of_layer(frame.areas, held), of_layer(style.probability, held)
    );
    let hash = placement_hashes(id.xy, layer, frame.frame, frame.seed).x;
    let born = layer < LAYERS && chance(hash, probability * frame.generation);
    let pixels = size.x * size.y;
    let pixel = id.y * size.x + id.x;
    let place = place_in_queue(pixel, first_in_queue(pixels, frame.frame, frame.seed), pixels);
    let end = arrayLength(&marks);
    if frame.capacity + place < end {
        marks[frame.capacity + place] = select(0u, 1u, born);
    }
    if pixel == 0u && frame.capacity + pixels < end {
        marks[frame.capacity + pixels] = 0u;
    }
}
