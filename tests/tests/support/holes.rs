// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the tests of holes measure masks with, and a small scene that is drawn with and without discarding.

use crate::gpu::{copy_of_wgsl, gpu};
use airlight::stylize::HoleParameters;
use airlight::validate::{Definitions, Library};
use airlight::{Buffer, Pass, RenderStages, Shaders, Texture};
use std::fmt::{Display, Formatter};
use wgpu::TextureFormat::Depth32Float;

/// Of masks.
pub struct Measured {
    /// Share of the area.
    pub area: f64,
    /// Mean length of the runs of holes along rows and columns, texels.
    pub chord: f64,
}

impl Display for Measured {
    fn fmt(&self, to: &mut Formatter<'_>) -> std::fmt::Result {
        write!(to, "area {:.4}, mean chord {:.2}", self.area, self.chord)
    }
}

/// Area and mean run over all masks. Runs are counted where they begin: the texels of all but the first column or row, over
/// the places where a hole follows none, so that runs that the border cuts distort nothing.
pub fn measure(masks: &[Vec<f32>], side: usize) -> Measured {
    let [mut area, mut texels, mut runs] = [0_u64; 3];
    for mask in masks {
        let hole = |x: usize, y: usize| mask[y * side + x] == 1.0;
        for y in 0..side {
            for x in 0..side {
                area += u64::from(hole(x, y));
                if x > 0 && hole(x, y) {
                    texels += 1;
                    runs += u64::from(!hole(x - 1, y));
                }
                if y > 0 && hole(x, y) {
                    texels += 1;
                    runs += u64::from(!hole(x, y - 1));
                }
            }
        }
    }
    Measured { area: area as f64 / (masks.len() * side * side) as f64, chord: texels as f64 / runs as f64 }
}

/// Pearson's correlation.
pub fn correlation(a: &[f32], b: &[f32]) -> f64 {
    correlation_of(a.iter().zip(b).map(|(a, b)| [f64::from(*a), f64::from(*b)]))
}

fn correlation_of(pairs: impl Iterator<Item = [f64; 2]>) -> f64 {
    let [mut n, mut a, mut b, mut aa, mut bb, mut ab] = [0.0; 6];
    for [x, y] in pairs {
        n += 1.0;
        a += x;
        b += y;
        aa += x * x;
        bb += y * y;
        ab += x * y;
    }
    (n * ab - a * b) / ((n * aa - a * a) * (n * bb - b * b)).sqrt()
}

/// The greatest correlation of `b` with `a` moved by up to `reach` texels, and the way.
pub fn most_like(a: &[f32], b: &[f32], side: usize, reach: i32) -> (f64, [i32; 2]) {
    let all = (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| [x, y]));
    let moved = |[x, y]: [i32; 2]| {
        let range = |by: i32| by.max(0) as usize..(side as i32 + by.min(0)) as usize;
        let pairs =
            range(y).flat_map(|row| range(x).map(move |column| [column, row])).map(|[column, row]| {
                let from = (row as i32 - y) as usize * side + (column as i32 - x) as usize;
                [f64::from(a[from]), f64::from(b[row * side + column])]
            });
        (correlation_of(pairs), [x, y])
    };
    all.map(moved).fold((-1.0, [0, 0]), |best, next| if next.0 > best.0 { next } else { best })
}

/// Two triangles as shadow maps, each with 1 where it is not.
pub struct HoleScene {
    /// The object alone, whole.
    pub object: Texture,
    /// What it stands before and behind.
    pub rest: Texture,
    /// Both, and the object with what falls into holes discarded.
    pub discarded: Texture,
}

const SHADER: &str = "// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#import airlight::stylize::perlin_holes::{HoleParameters, discards_hole}
@group(#{GROUP}) @binding(0) var<uniform> holes: HoleParameters;
@group(#{GROUP}) @binding(1) var map: texture_2d<f32>;
@vertex
fn vertex_object(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let x = select(-0.9, 0.9, index == 1u);
    let y = select(-0.9, 0.9, index == 2u);
    return vec4<f32>(x, y, 0.2 + 0.25 * f32(index), 1.0);
}
@vertex
fn vertex_rest(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(select(-1.0, 3.0, index == 1u), select(-1.0, 3.0, index == 2u), 0.6, 1.0);
}
@fragment
fn fragment_discard(@builtin(position) position: vec4<f32>) {
    if discards_hole(holes, position.xy / vec2<f32>(textureDimensions(map))) {
        discard;
    }
}
";

/// Draws the scene.
pub fn draw_scene(size: [u32; 2], parameters: &HoleParameters) -> HoleScene {
    let folder = copy_of_wgsl();
    std::fs::write(folder.path().join("stylize/passes/discard_probe.wgsl"), SHADER).unwrap();
    let shaders = Shaders::from_library(Library::from_directory(folder.path()).unwrap());
    let composed = shaders.compose_with("stylize/discard_probe", &Definitions::new()).unwrap();
    let pass = |vertex, fragment| {
        let depth = Some((wgpu::CompareFunction::Less, true));
        let stages = RenderStages { vertex, fragment, vertices: None, target: None, depth, samples: 1 };
        Pass::render(gpu(), &composed, &stages).unwrap()
    };
    let (whole, rest) = (pass("vertex_object", None), pass("vertex_rest", None));
    let open = pass("vertex_object", Some("fragment_discard"));
    let uniform = Buffer::uniform(gpu(), parameters);
    let sized = Texture::storage(gpu(), size, wgpu::TextureFormat::R32Float);
    let draw = |passes: &[&Pass]| {
        let target = Texture::target(gpu(), size, Depth32Float);
        let bound: Vec<_> = passes
            .iter()
            .map(|pass| {
                pass.bind_known(gpu(), &[("holes", (&uniform).into()), ("map", (&sized).into())]).unwrap()
            })
            .collect();
        let mut encoder = gpu().encoder();
        {
            let mut render = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &target.view,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(1.0),
                        store: wgpu::StoreOp::Store,
                    }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            for (pass, bound) in passes.iter().zip(&bound) {
                pass.set(&mut render, bound);
                render.draw(0..3, 0..1);
            }
        }
        gpu().submit(encoder).unwrap();
        target
    };
    HoleScene { object: draw(&[&whole]), rest: draw(&[&rest]), discarded: draw(&[&open, &rest]) }
}
