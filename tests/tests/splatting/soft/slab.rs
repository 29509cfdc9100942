// SPDX-License-Identifier: MIT OR Apache-2.0
//! The penumbra of a slab of splats, in whole pictures.

use super::half_planes::place_on_light;
use super::lights::{lamp, sun};
use crate::gpu::{gpu, shaders};
use crate::probing::f;
use crate::sheets::{colored, metres, parallel, splats};
use crate::soft_light::{Lit, crossings};
use airlight::splatting::{
    LightTransport, SheetFrame, SheetInputs, SheetLighting, SheetPicture, SheetSettings, SoftPlane,
    SoftShadows,
};
use airlight_tests::reference::splatting::Kernel;
use glam::Vec3;

#[test]
fn a_slab_of_splats_has_the_same_penumbra() {
    let kernel = Kernel::new(0.7, 2.25);
    let step = 2.25 / 4000.0;
    let fourth = |i: u32| {
        let r = (f64::from(i) + 0.5) * step;
        r.powi(4) * kernel.value(r * r) * step
    };
    let own = 4.0 / 3.0 * std::f64::consts::PI * (0..4000).map(fourth).sum::<f64>();
    let transfer = colored([Vec3::ONE; 2]);
    let settings = SheetSettings { count: 64, light_size: [128; 2], ..SheetSettings::default() };
    for (light, size) in [(sun(Vec3::Y), 14.0_f32), (lamp(Vec3::new(0.0, 60.0, 0.0)), 16.0)] {
        for layer in [30.0_f32, 14.0] {
            // One layer of voxels up to x = 0.
            let volume = metres([40, 40, 24], |place| {
                let inside = place.x < 0.0 && (place.y + 20.0 - layer - 0.5).abs() < 0.1;
                f32::from(u8::from(inside)) * 0.5
            });
            let splats = splats(&volume);
            let height = f64::from(layer) + 0.5 - 20.0;
            for angle in [0.0_f32, 60.0, 120.0] {
                for (thick, dense) in [(0.4_f32, false), (12.0, true)] {
                    let (sine, cosine) = angle.to_radians().sin_cos();
                    let view = Vec3::new(0.0, -cosine, sine);
                    let soft = SoftShadows::new(size);
                    let settings = SheetSettings { transport: LightTransport::Soft(soft), ..settings };
                    let lighting = SheetLighting::new(thick);
                    let frame = SheetFrame { camera: parallel(view, 30.0, 8), light, lighting };
                    let size = [8; 2];
                    let inputs = SheetInputs::new(std::slice::from_ref(&splats), &transfer);
                    let picture = SheetPicture::new(gpu(), shaders(), inputs, settings, size).unwrap();
                    let sheets = picture.set(gpu(), &frame).unwrap();
                    let mut encoder = gpu().encoder();
                    picture.record(gpu(), &mut encoder).unwrap();
                    gpu().submit(encoder).unwrap();
                    let shadow = picture.shadow().read(gpu()).unwrap();
                    let hull: Vec<Vec3> = (0..8)
                        .map(|i| {
                            let side = |bit: i32, half: f32| if i >> bit & 1 == 1 { half } else { -half };
                            Vec3::new(side(0, 21.75), side(1, 21.75), side(2, 13.75))
                        })
                        .collect();
                    let plane = SoftPlane::new(&soft, &frame, &sheets, &hull, [128; 2]).unwrap();
                    let lit = Lit { light, sheets, plane };
                    let points = lit.points(lit.middle(64));
                    // Shares of what the slab takes where it is whole.
                    let whole = 1.0 - f64::from(-0.5 * thick).exp();
                    // The tilted end of the sheets under the slab's edge.
                    let target = points
                        .iter()
                        .map(|p| (p.x.hypot(p.z), p.y))
                        .reduce(|a, b| if a.0 < b.0 { a } else { b });
                    let target = target.unwrap().1;
                    let own_depth = height - target;
                    let profile: Vec<(f64, f64)> = points
                        .iter()
                        .zip(shadow.chunks_exact(4))
                        .filter(|(point, _)| {
                            (point.y - target).abs() < 9.0 && point.z.abs() < 6.0 && point.x.abs() < 14.0
                        })
                        .map(|(point, texel)| {
                            (place_on_light(&light, *point, height, 0.0), 1.0 - (1.0 - f(texel[0])) / whole)
                        })
                        .collect();
                    let way = light.position.as_dvec3().y;
                    // The kernel's own blur, seen on the light.
                    let (width, seen) = if light.kind == 0 {
                        (2.0 * (f64::from(soft.size).to_radians() / 2.0).tan(), own.sqrt() / own_depth)
                    } else {
                        (f64::from(soft.size), own.sqrt() * (way - target) / own_depth)
                    };
                    let [low, middle, high] = crossings(&profile, width);
                    let expected = 2.563 * ((0.312 * width).powi(2) + seen * seen).sqrt();
                    let (found, shift) = ((high - low) / expected, middle / width);
                    println!(
                        "light {}, slab {own_depth} m before, eye at {angle}, extinction {thick}: width {found:.3}, off by {shift:.3}",
                        light.kind
                    );
                    // Sheets of a dense slab shade each other's edge as if by chance, and where they are tilted light leaks
                    // where layers meet: a known failure, which fails here once it is none.
                    let right = (found - 1.0).abs() < 0.1 && shift.abs() < 0.1;
                    assert!(right != dense, "{layer} {angle} {thick}");
                }
            }
        }
    }
}
