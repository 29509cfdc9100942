// SPDX-License-Identifier: MIT OR Apache-2.0
//! A pass with pipelines of all its entry points, and one run of them.

use crate::gpu::{Random, gpu};
use crate::resources::{Resources, Written, texels};
use crate::values::{Content, extreme_float};
use airlight::validate::naga::{Binding as Place, BuiltIn, TypeInner};
use airlight::validate::{Composed, EntryPoint, Reflection, Stage};
use airlight::{Buffer, Pass, RenderStages, Texture};
use std::time::{Duration, Instant};
use wgpu::{TextureFormat, VertexFormat};

/// Vertices and instances of a draw that is no picture.
const DRAWN: [u32; 2] = [24, 5];
/// A submission that takes longer than this hangs.
const PATIENCE: Duration = Duration::from_secs(60);

struct Draw {
    pass: Pass,
    formats: Vec<TextureFormat>,
    depth: bool,
    vertex_floats: usize,
    picture: bool,
    name: String,
}

/// An entry point's name and its workgroup's size.
type Entry = (String, [u32; 3]);

/// The pipelines of one composed pass.
pub struct Pipelines {
    compute: Option<(Pass, Vec<Entry>)>,
    draws: Vec<Draw>,
}

/// What one run left behind.
pub struct Ran {
    /// All that may have been written.
    pub written: Vec<Written>,
    /// From submission to its end; in the first run the driver compiles besides.
    pub took: Duration,
}

impl Pipelines {
    /// Of every entry point.
    pub fn new(composed: &Composed) -> Result<Self, String> {
        let reflection = composed.reflect();
        let of = |stage| reflection.entry_points.iter().filter(move |entry| entry.stage == stage);
        let names: Vec<Entry> =
            of(Stage::Compute).map(|entry| (entry.name.clone(), entry.workgroup_size)).collect();
        let compute = if names.is_empty() {
            None
        } else {
            Some((Pass::compute_from(gpu(), composed).map_err(|error| error.to_string())?, names))
        };
        let mut draws = Vec::new();
        for (vertex, fragment) in pairs(&reflection) {
            draws.push(draw(composed, vertex, fragment).map_err(|error| error.to_string())?);
        }
        Ok(Self { compute, draws })
    }

    /// Runs all entry points, each on what the one before left. A hang ends the process.
    pub fn run(&self, resources: &Resources, content: Content, seed: u64, case: &str) -> Result<Ran, String> {
        let random = &mut Random(seed.rotate_left(17) | 1);
        let scope = gpu().device.push_error_scope(wgpu::ErrorFilter::Validation);
        let named = resources.named();
        let mut encoder = gpu().encoder();
        if let Some((pass, entries)) = &self.compute {
            let bound = pass.bind_known(gpu(), &named).map_err(|error| error.to_string())?;
            for (entry, workgroup) in entries {
                let mut groups = [[1, 1, 1], [2, 1, 1], [3, 2, 1], [2, 2, 2]][random.below(4)];
                // Groups beside each other along an axis that an entry point does not know would do the same work twice, and
                // one that works in place has then no certain result.
                for axis in (1..3).filter(|axis| content.is_sane() && workgroup[*axis] == 1) {
                    groups[axis] = 1;
                }
                pass.dispatch_groups(&mut encoder, &bound, entry, groups)
                    .map_err(|error| error.to_string())?;
            }
        }
        let mut targets = Vec::new();
        for draw in &self.draws {
            let bound = draw.pass.bind_known(gpu(), &named).map_err(|error| error.to_string())?;
            let size = [[1, 1], [17, 9], [33, 5]][random.below(3)];
            let colours: Vec<_> =
                draw.formats.iter().map(|format| Texture::target(gpu(), size, *format)).collect();
            let depth = draw.depth.then(|| Texture::target(gpu(), size, TextureFormat::Depth32Float));
            let vertices = vertex_buffer(draw.vertex_floats, content, random);
            let mut render = begin(&mut encoder, &colours, depth.as_ref());
            draw.pass.set(&mut render, &bound);
            render.set_vertex_buffer(0, vertices.raw.slice(..));
            let [vertices, instances] = if draw.picture { [3, 1] } else { DRAWN };
            render.draw(0..vertices, 0..instances);
            drop(render);
            targets.extend(colours.into_iter().map(|colour| (draw.name.clone(), colour)));
        }
        let begun = Instant::now();
        let submission = gpu().queue.submit([encoder.finish()]);
        let waited = gpu()
            .device
            .poll(wgpu::PollType::Wait { submission_index: Some(submission), timeout: Some(PATIENCE) });
        if let Err(error) = waited {
            // The driver cannot be stopped, so no test can go on.
            eprintln!("{case} hangs: {error}\n  {}", resources.described());
            std::process::abort();
        }
        let took = begun.elapsed();
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(error.to_string());
        }
        let mut written = resources.written();
        written.extend(targets.into_iter().map(|(name, target)| texels(name, &target)));
        Ok(Ran { written, took })
    }
}

/// Fragment entry points with the vertex entry points that feed them, and those that draw depth alone.
fn pairs(reflection: &Reflection) -> Vec<(&EntryPoint, Option<&EntryPoint>)> {
    let of = |stage| reflection.entry_points.iter().filter(move |entry| entry.stage == stage);
    let suffix = |entry: &EntryPoint| entry.name.split_once('_').map(|(_, rest)| rest.to_owned());
    let fits = |vertex: &EntryPoint, fragment: &EntryPoint| {
        vertex.outputs.len() == fragment.inputs.len()
            && vertex.outputs.iter().zip(&fragment.inputs).all(|(a, b)| a.ty == b.ty)
    };
    let mut pairs = Vec::new();
    for fragment in of(Stage::Fragment) {
        let mut fitting: Vec<_> = of(Stage::Vertex).filter(|vertex| fits(vertex, fragment)).collect();
        fitting.sort_by_key(|vertex| suffix(vertex) != suffix(fragment));
        pairs.push((
            *fitting.first().expect("a vertex entry point for each fragment entry point"),
            Some(fragment),
        ));
    }
    for vertex in of(Stage::Vertex) {
        if !pairs.iter().any(|(paired, _)| paired.name == vertex.name) {
            pairs.push((vertex, None));
        }
    }
    pairs
}

fn draw(
    composed: &Composed,
    vertex: &EntryPoint,
    fragment: Option<&EntryPoint>,
) -> Result<Draw, airlight::PassError> {
    let floats: Vec<usize> = vertex.inputs.iter().map(|input| floats_of(&input.ty)).collect();
    let mut offset = 0;
    let attributes: Vec<_> = vertex
        .inputs
        .iter()
        .zip(&floats)
        .map(|(input, floats)| {
            let format =
                [VertexFormat::Float32, VertexFormat::Float32x2, VertexFormat::Float32x3][floats - 1];
            let attribute = wgpu::VertexAttribute { format, offset, shader_location: input.location };
            offset += 4 * *floats as u64;
            attribute
        })
        .collect();
    let outputs = fragment.map_or(&[][..], |fragment| &fragment.outputs);
    // A pixel has 32 bytes.
    let narrow = outputs.len() > 2;
    let formats: Vec<_> = outputs
        .iter()
        .map(|output| match (floats_of(&output.ty), narrow) {
            (4, true) => TextureFormat::Rgba16Float,
            (4, false) => TextureFormat::Rgba32Float,
            (2, true) => TextureFormat::Rg16Float,
            (2, false) => TextureFormat::Rg32Float,
            _ => TextureFormat::R32Float,
        })
        .collect();
    let targets: Vec<_> = formats.iter().map(|format| Some(wgpu::ColorTargetState::from(*format))).collect();
    let depth = formats.is_empty() || fragment.is_some_and(|fragment| writes_depth(composed, &fragment.name));
    let stages = RenderStages {
        vertex: &vertex.name,
        fragment: fragment.map(|fragment| fragment.name.as_str()),
        vertices: (!attributes.is_empty()).then_some(wgpu::VertexBufferLayout {
            array_stride: offset,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &attributes,
        }),
        target: None,
        depth: depth.then_some((wgpu::CompareFunction::Always, true)),
        samples: 1,
    };
    Ok(Draw {
        pass: Pass::render_to(gpu(), composed, &stages, &targets)?,
        formats,
        depth,
        vertex_floats: floats.iter().sum(),
        picture: vertex.name == "vertex_picture",
        name: fragment.unwrap_or(vertex).name.clone(),
    })
}

fn floats_of(ty: &str) -> usize {
    ty.strip_prefix("vec").map_or(1, |rest| usize::from(rest.as_bytes()[0] - b'0'))
}

fn writes_depth(composed: &Composed, fragment: &str) -> bool {
    let depth = |place: &Option<Place>| matches!(place, Some(Place::BuiltIn(BuiltIn::FragDepth)));
    let entry = composed.module.entry_points.iter().find(|entry| entry.name == fragment);
    entry.and_then(|entry| entry.function.result.as_ref()).is_some_and(|result| {
        depth(&result.binding)
            || matches!(&composed.module.types[result.ty].inner,
                TypeInner::Struct { members, .. } if members.iter().any(|member| depth(&member.binding)))
    })
}

fn vertex_buffer(floats: usize, content: Content, random: &mut Random) -> Buffer {
    let values: Vec<f32> = (0..floats.max(1) * DRAWN[0] as usize)
        .map(|_| {
            if random.unit() < content.extreme_share() {
                extreme_float(random)
            } else {
                random.between(-2.0, 2.0) as f32
            }
        })
        .collect();
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    Buffer::with_bytes(gpu(), &bytes, wgpu::BufferUsages::VERTEX)
}

fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    colours: &[Texture],
    depth: Option<&Texture>,
) -> wgpu::RenderPass<'e> {
    let store = wgpu::StoreOp::Store;
    let attachments: Vec<_> = colours
        .iter()
        .map(|colour| {
            Some(wgpu::RenderPassColorAttachment {
                view: &colour.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store },
            })
        })
        .collect();
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &attachments,
        depth_stencil_attachment: depth.map(|depth| wgpu::RenderPassDepthStencilAttachment {
            view: &depth.view,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
