// SPDX-License-Identifier: MIT OR Apache-2.0
//! Soft shadows of surfaces that are given as heights along light rays, and profiles of penumbras.
#![allow(dead_code, clippy::unwrap_used)]

use crate::gpu::{gpu, shaders};
use crate::sheets::{colored, parallel};
use airlight::core::{Camera, Light};
use airlight::splatting::{SheetFrame, SheetLighting, SheetNumber, Sheets, SoftPlane, SoftShadows};
use airlight::{Buffer, Pass, Sampler, Texture};
use airlight_tests::linear;
use glam::{DVec2, DVec3, DVec4, Vec3};

/// Where the light ray through a texel's middle begins, and its unit direction.
pub fn texel_ray(camera: &Camera, texel: [u32; 2]) -> (DVec3, DVec3) {
    let at = DVec2::new(f64::from(texel[0]), f64::from(texel[1])) + 0.5;
    let ndc = at / camera.viewport.as_dvec2() * DVec2::new(2.0, -2.0) + DVec2::new(-1.0, 1.0);
    let matrix = camera.clip_from_world.as_dmat4().inverse();
    let [near, far] = [0.0, 1.0].map(|depth| {
        let point = matrix * DVec4::new(ndc.x, ndc.y, depth, 1.0);
        point.truncate() / point.w
    });
    (near, (far - near).normalize())
}

/// A light on sheets.
pub struct Lit {
    pub light: Light,
    pub sheets: Sheets,
    pub plane: SoftPlane,
}

impl Lit {
    /// Sheets of a view in direction `view` over `points`, and a buffer of `side` texels squared.
    pub fn new(
        light: Light,
        view: Vec3,
        count: u32,
        points: &[Vec3],
        side: u32,
        settings: &SoftShadows,
    ) -> Self {
        let camera = SheetFrame { camera: parallel(view, 10.0, 8), light, lighting: SheetLighting::new(1.0) };
        let middle = points.iter().sum::<Vec3>() / points.len() as f32;
        let way = if light.kind == 0 { -light.direction } else { middle - light.position };
        let sheets = Sheets::between(view, way, count, points, |_| 0.0).unwrap();
        let plane = SoftPlane::new(settings, &camera, &sheets, points, [side; 2]).unwrap();
        Self { light, sheets, plane }
    }

    /// Height of the middle of a sheet, metres.
    pub fn middle(&self, sheet: u32) -> f64 {
        f64::from(self.sheets.first) + (f64::from(sheet) + 0.5) * f64::from(self.sheets.thickness)
    }

    /// The sheet whose middle is nearest to that of a point.
    pub fn sheet_of(&self, point: Vec3) -> u32 {
        ((self.sheets.normal.dot(point) - self.sheets.first) / self.sheets.thickness) as u32
    }

    /// Of all texels, where their light rays meet a height.
    pub fn points(&self, height: f64) -> Vec<DVec3> {
        let normal = self.sheets.normal.as_dvec3();
        let side = self.plane.light.size.x;
        let texels =
            (0..side * side).map(|index| texel_ray(&self.plane.camera, [index % side, index / side]));
        texels.map(|(origin, way)| origin + way * ((height - normal.dot(origin)) / normal.dot(way))).collect()
    }

    /// Heights at which each light ray enters and leaves the first solid; `surfaces` gives distances from a point on the ray.
    pub fn heights(&self, surfaces: impl Fn(DVec3, DVec3) -> Option<[f64; 2]>) -> [Vec<f32>; 2] {
        let normal = self.sheets.normal.as_dvec3();
        let side = self.plane.light.size.x;
        let mut all = [Vec::new(), Vec::new()];
        for index in 0..side * side {
            let (origin, way) = texel_ray(&self.plane.camera, [index % side, index / side]);
            let heights = match surfaces(origin, way) {
                Some(places) => places.map(|place| normal.dot(origin + way * place) as f32),
                None => [1e30; 2],
            };
            all[0].push(heights[0]);
            all[1].push(heights[1]);
        }
        all
    }

    /// Shares of the light that arrive at a sheet, and what surfaces have kept by then.
    pub fn shadows(&self, heights: &[Vec<f32>; 2], at: &[u32]) -> Vec<[Vec<f32>; 2]> {
        let size = self.plane.light.size;
        let texels = u64::from(size.x * size.y);
        let gpu = gpu();
        let light = Pass::compute(gpu, shaders(), "splatting/soft_light", "polygons").unwrap();
        let soften = Pass::compute(gpu, shaders(), "splatting/soften_sheet", "default").unwrap();
        let sides = size.to_array();
        let [first, last] = heights.each_ref().map(|values| {
            let texture = Texture::storage(gpu, sides, wgpu::TextureFormat::R32Float);
            texture.write(gpu, values).unwrap();
            texture
        });
        let rgba = wgpu::TextureFormat::Rgba16Float;
        let [shadow, held, means] = [0; 3].map(|_| Texture::storage(gpu, sides, rgba));
        let sets = [0; 3].map(|_| Buffer::storage(gpu, 64 * texels));
        let softened = Buffer::storage(gpu, 64 * texels);
        let words = |words: Vec<u32>| {
            let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
            Buffer::with_bytes(gpu, &bytes, wgpu::BufferUsages::STORAGE)
        };
        let schedule = &self.plane.schedule;
        let merges = words(schedule.merges.iter().flat_map(|merge| [merge.open, merge.into]).collect());
        let blur = |blur: &airlight::splatting::LayerBlur| {
            let [x, y] = blur.variance.to_array().map(f32::to_bits);
            [x, y, blur.distance.x, blur.distance.y]
        };
        let blurs = words(schedule.blurs.iter().flat_map(blur).collect());
        let transfer = colored([Vec3::ONE; 2]);
        let sampler = Sampler::linear(gpu);
        let soft = Buffer::uniform(gpu, &self.plane.light);
        let camera = Buffer::uniform(gpu, &self.plane.camera);
        let lamp = Buffer::uniform(gpu, &self.light);
        let sheets = Buffer::uniform(gpu, &self.sheets);
        let lighting = Buffer::uniform(gpu, &SheetLighting::new(1.0));
        let groups = [size.x.div_ceil(16), size.y.div_ceil(8), 1];
        let mut found = Vec::new();
        for index in 0..=at.iter().copied().max().unwrap() {
            let number = Buffer::uniform(gpu, &SheetNumber::new(index));
            let mut encoder = gpu.encoder();
            let bound = light
                .bind(
                    gpu,
                    &[
                        ("number", (&number).into()),
                        ("soft", (&soft).into()),
                        ("light_camera", (&camera).into()),
                        ("light", (&lamp).into()),
                        ("sheets", (&sheets).into()),
                        ("lighting", (&lighting).into()),
                        ("light_sheet", (&means).into()),
                        ("transfer", (&transfer.texture).into()),
                        ("linear_sampler", (&sampler).into()),
                        ("merges", (&merges).into()),
                        ("layers", (&sets[0]).into()),
                        ("shadow", (&shadow).into()),
                        ("kept", (&sets[1]).into()),
                        ("filled", (&sets[2]).into()),
                        ("light_heights", (&first).into()),
                        ("light_exit_heights", (&last).into()),
                        ("held", (&held).into()),
                    ],
                )
                .unwrap();
            light.dispatch_groups(&mut encoder, &bound, "soft_light", groups).unwrap();
            for layers in &sets {
                let bound = soften
                    .bind(
                        gpu,
                        &[
                            ("number", (&number).into()),
                            ("soft", (&soft).into()),
                            ("blurs", (&blurs).into()),
                            ("layers", layers.into()),
                            ("softened", (&softened).into()),
                        ],
                    )
                    .unwrap();
                for entry in ["soften_across", "soften_down"] {
                    soften.dispatch_groups(&mut encoder, &bound, entry, groups).unwrap();
                }
            }
            gpu.submit(encoder).unwrap();
            if at.contains(&index) {
                let share = |texture: &Texture| -> Vec<f32> {
                    let texels = texture.read(gpu).unwrap();
                    texels.chunks_exact(4).map(|texel| texel[0] / self.light.radiance.x).collect()
                };
                found.push([share(&shadow), share(&held)]);
            }
        }
        found
    }
}

/// Where a profile of (place, share) crosses 10, 50 and 90 percent: means of samples within a twelfth of `width`, between which the
/// logarithm of share / (1 - share) is taken as straight.
pub fn crossings(profile: &[(f64, f64)], width: f64) -> [f64; 3] {
    let mut bins = std::collections::BTreeMap::<i64, [f64; 3]>::new();
    for (place, share) in profile {
        let bin = bins.entry((place / width * 12.0).floor() as i64).or_default();
        for (sum, value) in bin.iter_mut().zip([*place, *share, 1.0]) {
            *sum += value;
        }
    }
    let odds = |share: f64| (share / (1.0 - share)).ln();
    let means =
        bins.values().map(|[place, share, count]| (place / count, (share / count).clamp(1e-4, 0.9999)));
    let means: Vec<(f64, f64)> = means.collect();
    [0.1, 0.5, 0.9].map(|level| {
        let crosses = |pair: &&[(f64, f64)]| (pair[0].1 - level) * (pair[1].1 - level) <= 0.0;
        let pair = means.windows(2).find(crosses).unwrap_or_else(|| panic!("never {level}: {means:?}"));
        let part = (odds(level) - odds(pair[0].1)) / (odds(pair[1].1) - odds(pair[0].1));
        pair[0].0 + part * (pair[1].0 - pair[0].0)
    })
}

/// A vector of the references.
pub fn vector(v: DVec3) -> linear::Vec3 {
    linear::Vec3::from(v.to_array())
}
