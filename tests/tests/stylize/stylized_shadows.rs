// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every map of a light is changed as that map would be by itself, and parts of a scene come together again.

use crate::gpu::{self, gpu, shaders};
use airlight::core::{Cascades, DepthRange, Raster, ShadowViews, Sky};
use airlight::data::{Mesh, sphere, torus};
use airlight::stylize::{
    Element, EpipolarMorphology, EpipolarSettings, Epipole, Form, HoleParameters, HolePattern, Holes,
    Morphology, MorphologySettings, Operator, PunchHoles, ShadowMaps, ShadowOperator, ShadowStyle,
    StylizeError, StylizedShadows, Width, shadow_map_extent,
};
use airlight::{Lighting, Setting, Stage, Texture};
use glam::{Mat4, Vec3};
use wgpu::TextureFormat::R32Float;

const MAP: [u32; 2] = [96, 64];
const DEPTH: DepthRange = DepthRange::Forward;

fn raster() -> Raster {
    Raster::new(gpu(), shaders()).unwrap()
}

/// A ring with a ball in it, lit as asked.
fn stage(raster: &Raster, mesh: &Mesh, light: Lighting, cascades: Option<Cascades>) -> Stage {
    let scene = gpu::small_tree();
    let setting = Setting {
        mesh,
        view: scene.view.into(),
        light,
        light_texture: None,
        cascades,
        sky: Sky::new(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO),
        medium: scene.medium,
        samples: 1,
    };
    Stage::new(gpu(), raster, &setting, [64, 48], MAP).unwrap()
}

fn ring() -> Mesh {
    torus(2.0, 0.5, 40, 20).transformed(Mat4::from_translation(Vec3::new(0.3, 2.0, 0.5)))
}

fn ball() -> Mesh {
    sphere(0.7, 24, 16).transformed(Mat4::from_translation(Vec3::new(1.0, 3.5, -0.5)))
}

fn both() -> Mesh {
    let mut mesh = ring();
    mesh.append(&ball());
    mesh
}

fn point() -> Lighting {
    Lighting::Point { position: Vec3::new(0.5, 2.2, 0.4), intensity: Vec3::ONE, radius: 0.05 }
}

fn sun() -> Lighting {
    Lighting::directional(Vec3::new(0.3, 0.8, -0.5), Vec3::ONE)
}

fn run(record: impl FnOnce(&mut wgpu::CommandEncoder)) {
    let mut encoder = gpu().encoder();
    record(&mut encoder);
    gpu().submit(encoder).unwrap();
}

/// The layers of what the stage drew, as maps of their own.
fn layers(maps: &Texture) -> Vec<Texture> {
    let [width, height, _] = maps.size();
    let texels = maps.read(gpu()).unwrap();
    let layer = |values: &[f32]| {
        let texture = Texture::storage(gpu(), [width, height], R32Float);
        texture.write(gpu(), values).unwrap();
        texture
    };
    texels.chunks_exact((width * height) as usize).map(layer).collect()
}

fn across(width: u32) -> ShadowOperator {
    let width = Width::new(width).unwrap();
    ShadowOperator::Across { operator: Operator::Closing, element: Element::Disc, width }
}

fn along(width: u32) -> ShadowOperator {
    let width = Width::new(width).unwrap();
    ShadowOperator::Along { operator: Operator::Dilation, form: Form::Direct, width }
}

/// A map through a closing, then an extrusion, by the passes themselves.
fn by_hand(stage: &Stage, matrix: &Mat4, map: &Texture) -> Vec<f32> {
    let [width, height, _] = map.size();
    let settings = MorphologySettings {
        operator: Operator::Closing,
        element: Element::Disc,
        width: Width::new(7).unwrap(),
        depth: DEPTH,
    };
    let closing = Morphology::new(gpu(), shaders(), settings, [width, height]).unwrap();
    let closed = closing.bind(gpu(), map).unwrap();
    let settings = EpipolarSettings {
        operator: Operator::Dilation,
        form: Form::Direct,
        width: Width::new(9).unwrap(),
        depth: DEPTH,
    };
    let eye = stage.camera.eye.as_dvec3().extend(1.0);
    let epipole = Epipole::in_map(matrix.as_dmat4(), eye, [width, height]).unwrap();
    let extrusion = EpipolarMorphology::new(gpu(), shaders(), settings, &epipole, [width, height]).unwrap();
    let extruded = extrusion.bind(gpu(), &closing.morphed).unwrap();
    run(|encoder| {
        closing.record(encoder, &closed);
        extrusion.record(encoder, &extruded);
    });
    extrusion.morphed.read(gpu()).unwrap()
}

fn styled(
    stage: &Stage,
    style: &ShadowStyle<'_>,
    maps: ShadowMaps<'_>,
    rest: Option<ShadowMaps<'_>>,
) -> StylizedShadows {
    let matrices = StylizedShadows::matrices(&stage.light, stage.views.as_ref());
    let made = StylizedShadows::new(gpu(), shaders(), style, (&stage.camera, &matrices), maps, rest).unwrap();
    run(|encoder| made.record(encoder));
    made
}

#[test]
fn every_view_is_changed_as_it_would_be_alone() {
    let raster = raster();
    for (light, cascades, count) in [(point(), None, 6), (sun(), Some(Cascades::new(3)), 3)] {
        let stage = stage(&raster, &both(), light, cascades);
        let drawn = stage.pictures.shadow_maps.as_ref().unwrap();
        let views: ShadowViews = stage.views.unwrap();
        let style = ShadowStyle { holes: &[], operators: &[across(7), along(9)] };
        let made = styled(&stage, &style, ShadowMaps::of(&stage.inputs()), None);
        assert_eq!(made.stylized.size(), drawn.size());
        let inputs = stage.inputs();
        assert!(std::ptr::eq(made.inputs(&inputs).shadow_map, inputs.shadow_map));
        let maps = layers(made.inputs(&inputs).shadow_maps.unwrap());
        let mut changed = 0;
        for (layer, (map, alone)) in maps.iter().zip(layers(drawn)).enumerate() {
            let expected = by_hand(&stage, &views.clip_from_world[layer], &alone);
            assert!(map.read(gpu()).unwrap() == expected, "layer {layer} of {count}");
            changed += usize::from(expected != alone.read(gpu()).unwrap());
        }
        assert_eq!(maps.len(), count);
        assert!(changed >= 2, "{changed} layers of {count} changed");
    }
}

fn pattern(matrix: &Mat4, seed: u32) -> HoleParameters {
    let holes = Holes { size: 0.2, density: 0.4, octaves: 1, seed, ..Holes::default() };
    let pattern = HolePattern::new(&holes, shadow_map_extent(matrix, 2.0), DEPTH).unwrap();
    pattern.at(0.0).unwrap()
}

#[test]
fn holes_are_made_in_one_object_alone() {
    let raster = raster();
    for light in [point(), sun()] {
        let stage = stage(&raster, &both(), light, None);
        let parts = [ring(), ball()].map(|mesh| stage.shadows_of(gpu(), &raster, &mesh).unwrap());
        let [object, rest] = [ShadowMaps::of_part(&parts[0]), ShadowMaps::of_part(&parts[1])];
        let matrices = StylizedShadows::matrices(&stage.light, stage.views.as_ref());
        let holes: Vec<_> = matrices.iter().zip(3..).map(|(matrix, seed)| pattern(matrix, seed)).collect();
        let none: Vec<_> = holes.iter().map(|holes| HoleParameters { threshold: -1.0, ..*holes }).collect();
        let read = |made: &StylizedShadows| made.stylized.read(gpu()).unwrap();
        let style = |holes| ShadowStyle { holes, operators: &[] };

        let made = styled(&stage, &style(&none), object, Some(rest));
        let whole = stage.pictures.shadow_maps.as_ref().unwrap_or(&stage.pictures.shadow_map);
        assert!(read(&made) == whole.read(gpu()).unwrap(), "ring and ball come together");
        made.set_holes(gpu(), &holes).unwrap();
        run(|encoder| made.record(encoder));
        let punched = read(&made);

        // The same, one map at a time.
        let alone = |shadows: &airlight::PartShadows| match &shadows.shadow_maps {
            Some(maps) => layers(maps),
            None => layers(&shadows.shadow_map),
        };
        let mut expected = Vec::new();
        for ((object, rest), holes) in alone(&parts[0]).iter().zip(alone(&parts[1])).zip(&holes) {
            let [width, height, _] = object.size();
            let pass = PunchHoles::new(gpu(), shaders(), holes, [width, height]).unwrap();
            let bound = pass.bind(gpu(), object, Some(&rest)).unwrap();
            run(|encoder| pass.record(encoder, &bound));
            expected.extend(pass.punched.read(gpu()).unwrap());
        }
        assert!(punched == expected);
        let opened = punched.iter().zip(whole.read(gpu()).unwrap()).filter(|(a, b)| **a > *b).count();
        assert!(opened > 20, "{opened} texels are open");
        // Where the ball was first it still is.
        let ball = stage.shadows_of(gpu(), &raster, &ball()).unwrap();
        let ball = ball.shadow_maps.as_ref().unwrap_or(&ball.shadow_map).read(gpu()).unwrap();
        assert!(punched.iter().zip(&ball).all(|(all, ball)| all <= ball));
    }
}

#[test]
fn a_matrix_and_a_set_of_holes_is_wanted_for_each_map() {
    let raster = raster();
    let stage = stage(&raster, &both(), point(), None);
    let matrices = StylizedShadows::matrices(&stage.light, stage.views.as_ref());
    let holes = [pattern(&matrices[0], 1)];
    let maps = || ShadowMaps::of(&stage.inputs());
    let make = |style: &ShadowStyle<'_>, matrices: &[Mat4]| {
        StylizedShadows::new(gpu(), shaders(), style, (&stage.camera, matrices), maps(), None).map(|_| ())
    };
    let one = make(&ShadowStyle { holes: &holes, operators: &[] }, &matrices);
    assert!(matches!(one, Err(StylizeError::Maps { matrices: 6, holes: 1, expected: 6 })));
    let few = make(&ShadowStyle { holes: &[], operators: &[] }, &matrices[..2]);
    assert!(matches!(few, Err(StylizeError::Maps { matrices: 2, holes: 0, expected: 6 })));
}
