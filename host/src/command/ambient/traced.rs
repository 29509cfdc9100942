// SPDX-License-Identifier: MIT OR Apache-2.0
//! `--method reference`: rays against the triangles, and the map itself for light, in f64 on the CPU.

use super::shown::{Rays, Seen};
use crate::core::Camera;
use crate::data::{Environment, Mesh, Random};
use airlight_tests::linear::Vec3 as Exact;
use airlight_tests::parallel::rows;
use airlight_tests::reference::ambient::{self, Pattern, Reach, Scene, Statistics, Triangle, outgoing};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

/// Traces a picture, row by row from the top. `rays` a pixel; `radius`: metres up to which occluders count, less the farther they are;
/// without it all of them block all light. `light`: none where only numbers are shown. `stride`: 1 for every pixel; else of a square of so many
/// pixels a side the one in the middle.
pub fn trace(
    mesh: &Mesh,
    light: Option<&Environment>,
    camera: &Camera,
    rays: u32,
    radius: Option<f32>,
    stride: u32,
) -> Vec<Option<Seen>> {
    let traced = trace_under(mesh, [light], camera, rays, radius, stride);
    traced.into_iter().map(|seen| seen.map(|[seen]| seen)).collect()
}

/// Like [`trace`], under several lights at once.
pub fn trace_under<const LIGHTS: usize>(
    mesh: &Mesh,
    lights: [Option<&Environment>; LIGHTS],
    camera: &Camera,
    rays: u32,
    radius: Option<f32>,
    stride: u32,
) -> Vec<Option<[Seen; LIGHTS]>> {
    let scene = scene_of(mesh);
    let lights = lights.map(|light| light.map(light_of));
    let pattern = Pattern::new(rays);
    let views = Rays::of(camera);
    // Pixels stride/2, stride/2 + stride, ...
    let [width, height] = views.size().map(|side| side.saturating_sub(stride / 2).div_ceil(stride));
    let pixel = |x: u32, y: u32| {
        let at = [x, y].map(|at| at * stride + stride / 2);
        let [origin, direction] = views.at(at[0], at[1]).map(exact);
        let hit = scene.hit(origin, direction)?;
        let (place, normal) = (scene.position(&hit), scene.normal(&hit, direction));
        // By chance, for what is even over the picture shows as stripes.
        let turn = TAU * f64::from(Random::new(u64::from(y * width + x)).unit());
        let samples = match radius {
            None => ambient::trace(&scene, place, normal, &pattern, turn, Reach::UNLIMITED),
            Some(radius) => {
                let visible = |direction| nearest(&scene, place, direction, f64::from(radius));
                ambient::samples(normal, &pattern, turn, visible)
            }
        };
        let statistics = Statistics::of(normal, &samples);
        let corners = &mesh.indices[3 * hit.triangle..3 * hit.triangle + 3];
        let weighted = corners.iter().zip(hit.barycentric);
        let albedo: Vec3 =
            weighted.map(|(corner, weight)| mesh.albedos[*corner as usize] * weight as f32).sum();
        let mean = Vec3::from(statistics.bent_normal().to_array().map(|value| value as f32));
        Some(lights.each_ref().map(|light| {
            let radiance = light.as_ref().map_or([0.0; 3], |light| outgoing(light, normal, &samples));
            let radiance = albedo * Vec3::from(radiance.map(|value| value as f32));
            Seen { radiance, open: statistics.open as f32, mean }
        }))
    };
    let row = |y: usize| (0..width).map(|x| pixel(x, y as u32)).collect::<Vec<_>>();
    rows(height as usize, row).into_iter().flatten().collect()
}

/// What the nearest occluder within `radius` leaves visible: 1 - (1 - (d/r)²)², as the passes have it.
fn nearest(scene: &Scene, place: Exact, direction: Exact, radius: f64) -> f64 {
    scene.hit_within(place, direction, radius).map_or(1.0, |hit| {
        let part = hit.distance / radius;
        1.0 - (1.0 - part * part).max(0.0).powi(2)
    })
}

fn exact(vector: DVec3) -> Exact {
    Exact::new(vector.x, vector.y, vector.z)
}

fn scene_of(mesh: &Mesh) -> Scene {
    let corner = |list: &[Vec3], index: u32| exact(list[index as usize].as_dvec3());
    let triangle = |corners: &[u32]| Triangle {
        positions: [0, 1, 2].map(|i| corner(&mesh.positions, corners[i])),
        normals: [0, 1, 2].map(|i| corner(&mesh.normals, corners[i])),
    };
    Scene::new(mesh.indices.chunks_exact(3).map(triangle).collect())
}

/// A map of 2:1.
fn light_of(map: &Environment) -> ambient::Environment {
    let texels = map.texels().iter().map(|texel| texel.to_array().map(f64::from)).collect();
    ambient::Environment::new(map.size()[1] as usize, texels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fall_off_ends_at_the_radius() {
        let triangle = [[-9.0, 2.0, -9.0], [9.0, 2.0, -9.0], [0.0, 2.0, 9.0]].map(Exact::from);
        let scene = Scene::new(vec![Triangle::flat(triangle)]);
        let up = Exact::new(0.0, 1.0, 0.0);
        for (radius, expected) in [(1.9, 1.0), (2.0, 1.0), (4.0, 0.4375), (1e6, 0.0)] {
            let found = nearest(&scene, Exact::default(), up, radius);
            assert!((found - expected).abs() < 1e-6, "{radius}: {found}");
        }
    }
}
