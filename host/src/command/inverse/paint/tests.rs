// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is painted, where, and that it repeats.
#![allow(clippy::unwrap_used)]

use super::*;

#[test]
fn scratch_pictures() {
    use crate::formats::write_png;
    let out = std::path::Path::new("/tmp/ii_pictures");
    std::fs::create_dir_all(out).unwrap();
    let save = |name: &str, canvas: &Canvas| {
        let bytes: Vec<u8> = canvas
            .pixels
            .iter()
            .flat_map(|c| c.to_array())
            .map(|v| (255.0 * crate::data::srgb_from_linear(v.max(0.0)) + 0.5) as u8)
            .collect();
        write_png(out.join(name), canvas.size[0], canvas.size[1], &bytes).unwrap();
    };
    for (name, volume, height) in [
        ("cloud", crate::data::cloud([96, 56, 80], 7), 4.5f32),
        ("plume", crate::data::plume([64, 160, 64], 7), 5.6),
    ] {
        let mid = 0.5 * (volume.bounds().min + volume.bounds().max);
        let size = if name == "cloud" { [480u32, 320u32] } else { [320, 480] };
        let unit = volume.world_from_unit.inverse();
        let read = |p: Vec3| {
            let u = unit.transform_point3(p);
            if u.min_element() < 0.0 || u.max_element() >= 1.0 {
                return 0.0;
            }
            let i: Vec<usize> = (0..3).map(|a| (u[a] * volume.size[a] as f32) as usize).collect();
            volume.values[(i[2] * volume.size[1] as usize + i[1]) * volume.size[0] as usize + i[0]]
        };
        let l = Vec3::new(0.5, 0.7, 0.5).normalize();
        let mut px = vec![];
        let mut matter = vec![];
        let blank = Canvas::new(size, vec![]);
        for i in 0..(size[0] * size[1]) as usize {
            let p = blank.place(i) * 0.5 * height;
            let mut t = 1.0f32;
            let mut c = 0.0;
            for s in 0..100 {
                let z = 3.0 - 6.0 * s as f32 / 100.0;
                let x = mid + Vec3::new(p.x, p.y, z);
                let e = read(x);
                if e <= 0.0 {
                    continue;
                }
                let a = 1.0 - (-e * 0.06f32).exp();
                let mut o = 0.0;
                for k in 0..20 {
                    o += read(x + l * (0.15 * (k as f32 + 0.5))) * 0.15;
                }
                c += t * a * (0.75 * (-o * 0.5f32).exp() + 0.1);
                t *= 1.0 - a;
            }
            px.push(Vec3::splat(c) + t * Vec3::new(0.05, 0.09, 0.16));
            matter.push(1.0 - t);
        }
        let canvas = Canvas::new(size, px);
        save(&format!("{name}.png"), &canvas);
        if name == "cloud" {
            for (n, mark, radius) in [("sun", Mark::Sun, 0.5), ("leaf", Mark::Leaf, 0.55)] {
                let logo = Logo {
                    mark,
                    middle: Vec2::new(0.0, 0.05),
                    radius,
                    turn: if n == "leaf" { -0.5 } else { 0.1 },
                    shade: 0.5,
                };
                save(&format!("{n}.png"), &logo.paint(&canvas, &matter).canvas);
                let flat = Canvas::new([256, 256], vec![Vec3::splat(0.9); 65536]);
                save(
                    &format!("{n}_flat.png"),
                    &Logo { middle: Vec2::ZERO, radius: 0.9, shade: 0.0, ..logo }.paint(&flat, &[]).canvas,
                );
            }
            save(
                "grade.png",
                &Grade {
                    contrast: 1.6,
                    middle: 0.5,
                    saturation: 1.2,
                    shade: Vec3::new(0.75, 0.8, 1.5),
                    light: Vec3::new(1.2, 1.0, 0.75),
                }
                .apply(&canvas),
            );
        } else {
            for (n, azimuth) in [("lava0", 0.0), ("lava60", 1.0472)] {
                save(
                    &format!("{n}.png"),
                    &Lava { azimuth, seed: 3, radiance: 1.6, reach: 0.8 }.paint(&canvas, &matter).canvas,
                );
            }
        }
    }
    for seed in 1..4 {
        let sky = Canvas::new(
            [320, 320],
            (0..320 * 320)
                .map(|i| {
                    Vec3::new(0.9, 0.75, 0.5).lerp(Vec3::new(0.35, 0.5, 0.8), 1.0 - (i / 320) as f32 / 320.0)
                })
                .collect(),
        );
        save(
            &format!("tree{seed}.png"),
            &Tree { foot: Vec2::new(0.0, -0.9), height: 1.7, seed, color: Vec3::splat(0.01) }
                .paint(&sky)
                .canvas,
        );
    }
}
