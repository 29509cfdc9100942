// SPDX-License-Identifier: MIT OR Apache-2.0
//! A row that is lit up to a column, in closed form.

use super::stage::{PICTURE, Stage, scattered};
use crate::gpu::{self, Random, gpu, shaders};
use airlight::core::{DepthRange, PerspectiveView};
use airlight::data::plane;
use airlight::scattering::{Medium, ProjectiveMap, ProjectivePrefiltered, Settings, Visibility, Weighting};
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use glam::{Vec2, Vec3};
use wgpu::TextureFormat::R32Float;

#[test]
fn a_row_lit_up_to_a_column_has_its_closed_form() {
    // A narrow view, so that all rays of a row are nearly as long as its reference ray.
    let view = PerspectiveView {
        eye: Vec3::new(1.0, 2.0, -3.0),
        target: Vec3::new(2.0, 2.2, -9.0),
        field_of_view: 12.0,
        near: 0.1,
        far: 100.0,
        depth: DepthRange::Reversed,
    };
    const SIZE: [u32; 2] = [516, 16];
    let mesh = plane(Vec2::splat(9.0), 1);
    for (splits, lit, extinction) in
        [(1, 200, 0.02), (2, 300, 0.05), (3, 340, 0.01), (4, 400, 0.1), (4, 256, 0.0)]
    {
        let medium = Medium::new(extinction, Vec3::ONE, 0.0, 200.0).unwrap();
        let camera = gpu::reference_camera(&view, PICTURE);
        let light = Vec3::new(0.2, 1.0, 0.1).normalize();
        let mut stage = Stage::new(&mesh, camera, light, medium, PICTURE, 64);
        let mut random = Random(9);
        let depths: Vec<f32> =
            (0..PICTURE[0] * PICTURE[1]).map(|_| random.magnitude(1e-3, 1e-1) as f32).collect();
        stage.pictures.depth = gpu::texture(PICTURE, R32Float, &depths);
        let row: Vec<f32> = (0..SIZE[0]).map(|column| if column < lit { 1.0 } else { 0.0 }).collect();
        let rows = stage.reference_rows(SIZE, splits);
        let edge = rows.x_of(f64::from(lit));
        let mut worst = [0.0_f64; 4];
        for weighting in [Weighting::Average, Weighting::Transmittance] {
            let map = stage.map(SIZE, splits);
            map.rectified.write(gpu(), &row.repeat(SIZE[1] as usize)).unwrap();
            let marched = stage.marched(&map, weighting);
            let settings = Settings { weighting, bases: 128, epipole_march: false, ..Settings::default() };
            let evaluated = |map: ProjectiveMap, settings: Settings| {
                map.rectified.write(gpu(), &row.repeat(SIZE[1] as usize)).unwrap();
                let method = ProjectivePrefiltered::new(gpu(), shaders(), map, settings, PICTURE).unwrap();
                let bound = method.bind(gpu(), &stage.inputs()).unwrap();
                let mut encoder = gpu().encoder();
                method.record_filter(&mut encoder, &bound);
                method.record_evaluation(&mut encoder, &bound);
                gpu().submit(encoder).unwrap();
                scattered(&method.scattered)
            };
            let found = evaluated(map, settings);
            let rank = Settings { visibility: Visibility::Rank { bits: 8 }, ..settings };
            let ranked = evaluated(stage.map(SIZE, splits), rank);
            let sigma = if weighting == Weighting::Average { 0.0 } else { f64::from(extinction) };
            let weight = |t: f64| if sigma == 0.0 { t } else { -(-sigma * t).exp_m1() / sigma };
            for (i, depth) in depths.iter().enumerate() {
                let (x, y) = (i % PICTURE[0] as usize, i / PICTURE[0] as usize);
                let ndc = ReferenceCamera::pixel_ndc(x, y, PICTURE[0] as usize, PICTURE[1] as usize);
                let distance = stage.reference.distance(ndc, f64::from(*depth));
                let cosine = rows.axes[0].dot(stage.reference.ray(ndc));
                let expected = weight(distance.min(edge / cosine)) / weight(distance);
                worst[0] = worst[0].max((f64::from(marched.visibility[i]) - expected).abs());
                worst[1] = worst[1].max((f64::from(found.visibility[i]) - expected).abs());
                let of_ranks = if weighting == Weighting::Average { 2 } else { 3 };
                worst[of_ranks] = worst[of_ranks].max((f64::from(ranked.visibility[i]) - expected).abs());
            }
        }
        println!(
            "{splits} splits, lit up to {edge:.2} m, extinction {extinction}: march {:.1e}, bases {:.1e}, \
             rank queries {:.1e}, weighted {:.1e}",
            worst[0], worst[1], worst[2], worst[3]
        );
        // f16 of the picture and f32 of the sums; 8 bits and 128 bases at the ends of the depth range.
        assert!(worst[0] < 1.5e-3 && worst[1] < 0.01, "{splits}: {worst:?}");
        // Rays weigh a little otherwise than the reference ray of their row.
        assert!(worst[2] < 1.0e-3 && worst[3] < 4e-3, "{splits}: {worst:?}");
    }
}
