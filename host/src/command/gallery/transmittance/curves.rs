// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transmittance along one light ray by every method (paper Fig. 3).

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::METHODS;
use super::setting::{build, upload};
use crate::command::CommandError;
use crate::core::Light;
use crate::data::{self, Volume};
use crate::transmittance::{MapSettings, Query};
use glam::{Mat4, Vec3};
use plotters::prelude::*;

/// Pixels of a drawing.
const SIZE: (u32, u32) = (1200, 620);
/// Columns and rows of all maps; the light ray passes the middle of a texel.
const MAP: [u32; 2] = [256, 256];
/// Places along the light ray.
const POINTS: usize = 400;
/// Steps of the exact march between two places.
const STEPS: usize = 16;
/// Of the methods, in their order.
const COLORS: [RGBColor; 7] = [
    RGBColor(240, 140, 60),
    RGBColor(245, 205, 90),
    RGBColor(90, 200, 120),
    RGBColor(70, 190, 190),
    RGBColor(90, 160, 240),
    RGBColor(200, 120, 230),
    RGBColor(235, 95, 110),
];
const BACKGROUND: RGBColor = RGBColor(21, 23, 26);
const INK: RGBColor = RGBColor(217, 214, 207);
const FAINT: RGBColor = RGBColor(52, 55, 60);
/// Slabs of the medium with sharp edges: where they begin and end, shares of the box, and their extinction, 1/m.
const SLABS: [(f32, f32, f32); 3] = [(0.20, 0.28, 2.0), (0.45, 0.50, 6.0), (0.62, 0.80, 1.5)];

/// A curve: its name, its colour, and transmittance at [`POINTS`] places.
type Curve = (String, RGBColor, Vec<f32>);

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let about = format!(
        "Transmittance from the light, along one light ray from the near to the far side of the map, {POINTS} places. The \
         exact curve is marched in 64 bits."
    );
    let title = "Transmittance along a light ray".to_owned();
    let mut album = Album::new(&studio.out, folder, title, about)?;
    let smoke = data::plume([96, 192, 96], 7);
    let edges = slabs()?;
    // Through the smoke half way up, and through the slabs.
    let media = [
        ("smoke", "Smoke", &smoke, 1.5, Vec3::new(-0.85, 0.42, -0.25), Vec3::new(0.0, 2.2, 0.0)),
        ("edges", "A medium with sharp edges", &edges, 1.0, Vec3::X, Vec3::ZERO),
    ];
    for (file, name, volume, scale, towards, through) in media {
        let light = Light::directional_leaning(towards, Vec3::ONE, volume.occupied_points())
            .map_err(CommandError::failure)?;
        let ray = ray(&light, through);
        let curves = curves(studio, volume, scale, &light, &ray)?;
        for (method, _, values) in curves.iter().skip(1) {
            let differences = || values.iter().zip(&curves[0].2).map(|(a, b)| f64::from((a - b).abs()));
            let mean = differences().sum::<f64>() / POINTS as f64;
            let greatest = differences().fold(0.0, f64::max);
            album.fact(
                format!("{name}, {method}: mean and greatest difference"),
                format!("{mean:.3}, {greatest:.3}"),
            );
        }
        let range = light.world_from_clip.z_axis.truncate().length();
        let drawing = draw(name, range, &curves).map_err(CommandError::failure)?;
        album.add_drawing(format!("{file}.svg"), name, &drawing)?;
    }
    Ok(album.finish())
}

/// Slabs in a box of 4 m, as sharp as voxels are.
fn slabs() -> Result<Volume, CommandError> {
    let size = [512, 4, 4];
    let value = |index: u32| {
        // Light comes from x, so that the first slab lies there.
        let at = 1.0 - ((index % size[0]) as f32 + 0.5) / size[0] as f32;
        SLABS.iter().find(|(begin, end, _)| (*begin..*end).contains(&at)).map_or(0.0, |slab| slab.2)
    };
    let values = (0..size.iter().product()).map(value).collect();
    let space =
        Mat4::from_translation(Vec3::new(-2.0, -0.5, -0.5)) * Mat4::from_scale(Vec3::new(4.0, 1.0, 1.0));
    Volume::new(size, values, space).map_err(CommandError::failure)
}

/// Places along the light ray of the texel that a point lies in, from the near to the far side.
fn ray(light: &Light, through: Vec3) -> Vec<Vec3> {
    let clip = light.clip_from_world.project_point3(through);
    let middle = |at: f32, side: u32| {
        let side = side as f32;
        ((0.5 * at + 0.5) * side).floor().mul_add(2.0 / side, 1.0 / side) - 1.0
    };
    let [x, y] = [middle(clip.x, MAP[0]), middle(clip.y, MAP[1])];
    let place = |i| light.world_from_clip.project_point3(Vec3::new(x, y, i as f32 / (POINTS - 1) as f32));
    (0..POINTS).map(place).collect()
}

/// The exact curve, and that of every method.
fn curves(
    studio: &Studio,
    volume: &Volume,
    scale: f32,
    light: &Light,
    ray: &[Vec3],
) -> Result<Vec<Curve>, CommandError> {
    let gpu = &studio.gpu;
    let uploaded = upload(studio, volume, scale)?;
    let mut curves = vec![("exact".to_owned(), INK, exact(volume, scale, ray))];
    for ((form, coefficients, _, name), color) in METHODS.into_iter().zip(COLORS) {
        let map = build(studio, MapSettings::new(form, coefficients, MAP), light, &uploaded)?;
        let query = Query::new(gpu, &studio.shaders, map.settings, false)?;
        let bound = query.bind(gpu, &map, ray)?;
        let mut encoder = gpu.encoder();
        query.record(&mut encoder, &bound)?;
        gpu.submit(encoder)?;
        curves.push((name.to_owned(), color, bound.read(gpu)?));
    }
    Ok(curves)
}

/// By small steps between the places.
fn exact(volume: &Volume, scale: f32, ray: &[Vec3]) -> Vec<f32> {
    let unit_from_world = volume.world_from_unit.as_dmat4().inverse();
    let mut depth = 0.0_f64;
    let mut found = vec![1.0];
    for pair in ray.windows(2) {
        let (from, to) = (pair[0].as_dvec3(), pair[1].as_dvec3());
        let length = from.distance(to) / STEPS as f64;
        for step in 0..STEPS {
            let place = unit_from_world.transform_point3(from.lerp(to, (step as f64 + 0.5) / STEPS as f64));
            depth += f64::from(scale) * length * extinction(volume, place.to_array());
        }
        found.push((-depth).exp() as f32);
    }
    found
}

/// Trilinear, 0 outside of the box 0..1.
fn extinction(volume: &Volume, unit: [f64; 3]) -> f64 {
    if unit.iter().any(|at| !(0.0..=1.0).contains(at)) {
        return 0.0;
    }
    let mut sum = 0.0;
    for corner in 0..8_usize {
        let (mut weight, mut index, mut stride) = (1.0, 0, 1);
        for (axis, at) in unit.into_iter().enumerate() {
            let side = volume.size[axis] as usize;
            let at = (at * side as f64 - 0.5).clamp(0.0, (side - 1) as f64);
            let upper = corner >> axis & 1;
            let share = at - at.floor();
            weight *= if upper == 1 { share } else { 1.0 - share };
            index += stride * (at as usize + upper).min(side - 1);
            stride *= side;
        }
        sum += weight * f64::from(volume.values[index]);
    }
    sum
}

/// A drawing of curves over `range` metres.
fn draw(title: &str, range: f32, curves: &[Curve]) -> Result<String, Box<dyn std::error::Error>> {
    let mut drawing = String::new();
    {
        let area = SVGBackend::with_string(&mut drawing, SIZE).into_drawing_area();
        area.fill(&BACKGROUND)?;
        let text = |size: u32| ("sans-serif", size).into_font().color(&INK);
        let mut chart = ChartBuilder::on(&area)
            .caption(title, text(26))
            .margin(18)
            .x_label_area_size(52)
            .y_label_area_size(64)
            .build_cartesian_2d(0.0..range, 0.0..1.02_f32)?;
        chart
            .configure_mesh()
            .axis_style(INK)
            .bold_line_style(FAINT)
            .light_line_style(TRANSPARENT)
            .label_style(text(16))
            .axis_desc_style(text(18))
            .x_desc("metres from the near side of the map")
            .y_desc("transmittance")
            .draw()?;
        for (index, (name, color, values)) in curves.iter().enumerate() {
            // The exact curve is wide and lies below the others.
            let style = color.mix(if index == 0 { 0.45 } else { 1.0 });
            let style = style.stroke_width(if index == 0 { 7 } else { 2 });
            let along = |i: usize| range * i as f32 / (values.len() - 1).max(1) as f32;
            let points = values.iter().enumerate().map(|(i, value)| (along(i), *value));
            chart
                .draw_series(LineSeries::new(points, style))?
                .label(name.as_str())
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 24, y)], style));
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .legend_area_size(32)
            .margin(14)
            .label_font(text(16))
            .background_style(BACKGROUND.mix(0.85))
            .draw()?;
        area.present()?;
    }
    Ok(drawing)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn slabs_are_marched_as_they_are() {
        let volume = slabs().unwrap();
        let light = Light::directional(Vec3::X, Vec3::ONE, volume.bounds().min, volume.bounds().max).unwrap();
        let ray = ray(&light, Vec3::ZERO);
        let found = exact(&volume, 1.0, &ray);
        // All rows of 512 voxels in 4 m are the same.
        let total: f32 = volume.values[..512].iter().map(|value| value * 4.0 / 512.0).sum();
        assert!((f64::from(-found[POINTS - 1].ln()) / f64::from(total) - 1.0).abs() < 0.01);
        assert!(found.windows(2).all(|pair| pair[1] <= pair[0]));
        // The light is at the near side, and the first slab ends where it does.
        assert!(ray[0].x > ray[POINTS - 1].x);
        let after = found[(0.40 * POINTS as f32) as usize];
        assert!((after.ln() + 4.0 * 0.08 * 2.0).abs() < 0.03, "{after}");
    }

    #[test]
    fn drawings_name_their_curves() {
        let curves =
            [("exact".to_owned(), INK, vec![1.0, 0.5]), ("other".to_owned(), COLORS[0], vec![1.0, 0.4])];
        let drawing = draw("Smoke", 3.0, &curves).unwrap();
        assert!(drawing.starts_with("<svg") && drawing.trim_end().ends_with("</svg>"));
        for word in ["Smoke", "exact", "other", "transmittance"] {
            assert!(drawing.contains(word), "{word}");
        }
        assert!(drawing.matches("<polyline").count() >= 2);
    }
}
