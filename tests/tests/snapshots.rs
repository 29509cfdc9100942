// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every intermediate buffer of scattering, of stylization, of paintings and of sheets, and transmittance maps, against their snapshots, on small scenes of
//! the tests' own. `make bless` replaces what has changed; look at the pictures at full size first.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;
#[path = "support/painted.rs"]
mod painted;
#[path = "support/sheet_scene.rs"]
mod sheet_scene;
#[path = "support/sheets.rs"]
mod sheets;
#[path = "support/snapshot.rs"]
mod snapshot;
#[path = "support/snapshot_checks.rs"]
mod snapshot_checks;

use airlight::Stage;
use airlight::core::{DepthRange, Light, Reading, Tonemap, VolumeTexture};
use airlight::data::{burst, cloud, sphere, torus_field};
use airlight::painterly::{Orientation, PainterlyStyle};
use airlight::scattering::{
    Along, BasisFormat, Composite, Inputs, March, Prefiltered, Settings, Visibility, Weighting,
};
use airlight::splatting::{
    LightTransport, ScatteringSettings, SheetFrame, SheetInputs, SheetLighting, SheetPicture, SheetSettings,
    SoftShadows, Surfaces,
};
use airlight::stylize::{
    Baker, Element, Form, HoleMask, HoleParameters, HolePattern, HolePicture, Holes, Operator, PickScene,
    Restyle, ShadowMaps, ShadowOperator, ShadowStyle, StylizedShadows, Transfer, TransferError, Width,
    read_transfer, shadow_map_extent,
};
use airlight::transmittance::{
    Form as MapForm, MapSettings, ParticleBuffer, Precision, Splat, SplatFixed, TransmittanceMap, Voxels,
};
use glam::Vec3;
use gpu::{TestScene, gpu, shaders};
use snapshot::{Buffer, Picture, Tolerance, assert_buffer, assert_picture, buffer, tolerance};
use std::path::Path;

const PICTURE: [u32; 2] = [64, 48];
const MAP: [u32; 2] = [48, 32];
const SHADOW: [u32; 2] = [48, 48];

fn check(scene_name: &str, scene: &TestScene) {
    let stage = scene.stage(PICTURE, SHADOW);
    let inputs = stage.inputs();
    // Half floats hold visibility and basis to 5e-4, 8 bits to 2e-3; a depth next to an edge of the map
    // may come from its other side on another adapter.
    let name = |what: &str| format!("{scene_name}_{what}");
    let sharp = tolerance(1e-4, 0.0, 0.02);
    assert_buffer(&name("shadow_map"), &buffer(&stage.pictures.shadow_map, 0, 1, sharp));
    assert_buffer(&name("depth"), &buffer(&stage.pictures.depth, 0, 1, tolerance(1e-5, 0.0, 0.02)));
    assert_buffer(&name("surface"), &buffer(&stage.pictures.surface, 0, 3, tolerance(2e-3, 0.01, 0.05)));

    let settings = Settings { map: MAP, bases: 16, format: BasisFormat::Rgba8Unorm, ..Settings::default() };
    let method = Prefiltered::new(gpu(), shaders(), settings, PICTURE).unwrap();
    let bound = method.bind(gpu(), &inputs).unwrap();
    let mut encoder = gpu().encoder();
    method.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    let map = &method.rectification;
    let frame = Buffer {
        adapter: gpu().description(),
        shape: [4, 8, 1],
        tolerance: tolerance(1e-5, 1e-5, 0.0),
        values: map.frame.read_floats(gpu()).unwrap(),
    };
    assert_buffer(&name("frame"), &frame);
    assert_buffer(&name("slices"), &buffer(&map.slices, 0, 4, tolerance(1e-5, 1e-4, 0.0)));
    assert_buffer(&name("rectified"), &buffer(&map.rectified, 0, 1, tolerance(1e-4, 0.0, 0.03)));
    for layer in [0, 3] {
        let bases = buffer(method.prefilter.stored(), layer, 4, tolerance(4e-3, 0.0, 0.05));
        assert_buffer(&name(&format!("bases_{layer}")), &bases);
    }
    let scattered = tolerance(2e-3, 0.01, 0.05);
    assert_buffer(&name("prefiltered"), &buffer(&method.scattered, 0, 4, scattered));

    for (what, along) in
        [("marched_rows", Along::Rows(map)), ("marched_shadow_map", Along::ShadowMap { steps: 64 })]
    {
        let march = March::new(gpu(), shaders(), &along, Weighting::Transmittance, PICTURE).unwrap();
        let bound = march.bind(gpu(), &inputs, &along).unwrap();
        let mut encoder = gpu().encoder();
        march.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        assert_buffer(&name(what), &buffer(&march.scattered, 0, 4, scattered));
    }

    let composite = Composite::new(gpu(), shaders()).unwrap();
    let composed = composite.run(gpu(), &inputs, &stage.pictures.surface, &method.scattered).unwrap();
    assert_buffer(&name("composed"), &buffer(&composed, 0, 3, tolerance(2e-3, 0.01, 0.05)));
    let pixels = Tonemap::new(gpu(), shaders()).unwrap().run(gpu(), &composed, 1.0).unwrap();
    let picture = Picture { size: PICTURE, pixels };
    assert_picture(&name("picture"), &gpu().description(), &picture, 0.99);
}

#[test]
fn torus_over_a_plane() {
    check("torus", &gpu::torus_over_plane());
}

#[test]
fn small_tree_with_the_light_in_the_picture() {
    check("tree", &gpu::small_tree());
}

/// The stage's shadow map, changed.
fn stylized(stage: &Stage, holes: &[HoleParameters], operators: &[ShadowOperator]) -> StylizedShadows {
    let matrices = StylizedShadows::matrices(&stage.light, None);
    let (style, over) = (ShadowStyle { holes, operators }, (&stage.camera, &matrices[..]));
    let maps = ShadowMaps::of(&stage.inputs());
    let shadows = StylizedShadows::new(gpu(), shaders(), &style, over, maps, None).unwrap();
    let mut encoder = gpu().encoder();
    shadows.record(&mut encoder);
    gpu().submit(encoder).unwrap();
    shadows
}

#[test]
fn torus_stylized() {
    let scene = gpu::torus_over_plane();
    let stage = scene.stage(PICTURE, SHADOW);
    let name = |what: &str| format!("torus_stylized_{what}");
    // As for the maps that are drawn: a texel next to an edge may be another one on another adapter.
    let sharp = tolerance(1e-4, 0.0, 0.03);
    let width = |texels| Width::new(texels).unwrap();
    let closing =
        ShadowOperator::Across { operator: Operator::Closing, element: Element::Box, width: width(9) };
    let extrusion =
        ShadowOperator::Along { operator: Operator::Dilation, form: Form::Rectified, width: width(7) };
    let closed = stylized(&stage, &[], &[closing]);
    assert_buffer(&name("closed"), &buffer(&closed.stylized, 0, 1, sharp));
    let extruded = stylized(&stage, &[], &[extrusion]);
    assert_buffer(&name("extruded"), &buffer(&extruded.stylized, 0, 1, sharp));

    let holes = Holes { size: 0.8, density: 0.25, octaves: 2, ..Holes::default() };
    let extent = shadow_map_extent(&stage.light.clip_from_world, 0.0);
    let parameters = HolePattern::new(&holes, extent, DepthRange::Forward).unwrap().at(0.0).unwrap();
    let mask = HoleMask::new(gpu(), shaders(), HolePicture::Mask, &parameters, SHADOW).unwrap();
    let mut encoder = gpu().encoder();
    mask.record(&mut encoder);
    gpu().submit(encoder).unwrap();
    assert_buffer(&name("mask"), &buffer(&mask.mask, 0, 1, sharp));
    let punched = stylized(&stage, &[parameters], &[]);
    assert_buffer(&name("punched"), &buffer(&punched.stylized, 0, 1, sharp));

    let settings = Settings {
        map: MAP,
        visibility: Visibility::Rank { bits: 8 },
        epipole_march: false,
        ..Settings::default()
    };
    let method = Prefiltered::new(gpu(), shaders(), settings, PICTURE).unwrap();
    let inputs: Inputs<'_> = punched.inputs(&stage.inputs());
    let bound = method.bind(gpu(), &inputs).unwrap();
    let mut encoder = gpu().encoder();
    method.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();

    let style = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/src/transfer/sunset.toml");
    let small = |transfer: &Transfer| Ok::<_, TransferError>(Transfer { size: 24, ..transfer.clone() });
    let style = read_transfer(style).unwrap().try_map(small).unwrap();
    let (camera, medium, movements) = (&stage.camera, &stage.medium, Default::default());
    let picked = PickScene { camera, medium, inputs, scattered: &method.scattered, movements: &movements };
    let map = Baker::new(gpu(), shaders()).unwrap().bake_frame(gpu(), &style, 0.0, Some(&picked)).unwrap();
    assert_buffer(&name("transfer"), &buffer(&map, 0, 4, tolerance(2e-3, 0.005, 0.0)));
    let function = style.function(0.0, &stage.medium);
    let restyle = Restyle::new(gpu(), shaders(), &function, &inputs, PICTURE).unwrap();
    let uniform = airlight::Buffer::uniform(gpu(), &function);
    let bound = restyle.bind(gpu(), &inputs, &method.scattered, &map, &uniform).unwrap();
    let mut encoder = gpu().encoder();
    restyle.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    assert_buffer(&name("restyled"), &buffer(&restyle.restyled, 0, 4, tolerance(4e-3, 0.02, 0.05)));

    let composite = Composite::new(gpu(), shaders()).unwrap();
    let composed = composite.run(gpu(), &inputs, &stage.pictures.surface, &restyle.restyled).unwrap();
    let pixels = Tonemap::new(gpu(), shaders()).unwrap().run(gpu(), &composed, 1.0).unwrap();
    assert_picture(&name("picture"), &gpu().description(), &Picture { size: PICTURE, pixels }, 0.99);
}

/// Layers of a map, and the intervals of a bounded one.
fn assert_map(name: &str, map: &TransmittanceMap, tolerance: Tolerance) {
    for layer in 0..map.settings.layers() as usize {
        assert_buffer(&format!("{name}_{layer}"), &buffer(&map.coefficients, layer, 4, tolerance));
    }
    if let Some(intervals) = &map.intervals {
        assert_buffer(&format!("{name}_intervals"), &buffer(intervals, 0, 2, tolerance));
    }
}

#[test]
fn maps_of_a_volume() {
    let volume = cloud([20, 12, 16], 9);
    let towards = Vec3::new(0.5, 0.8, 0.3);
    let light = Light::directional_leaning(towards, Vec3::ONE, volume.occupied_points()).unwrap();
    let uploaded = VolumeTexture::new(gpu(), &volume, 1.0, Reading::Linear).unwrap();
    // A step more or less at the rim of the volume is another sum on another adapter.
    let sums = tolerance(2e-3, 2e-3, 0.02);
    for (name, form, coefficients) in [
        ("extinction", MapForm::Extinction, 8),
        ("bounded", MapForm::Bounded, 4),
        ("opacity", MapForm::Opacity, 4),
        ("function", MapForm::Function, 4),
        ("function_periodic", MapForm::FunctionPeriodic, 4),
        ("power", MapForm::PowerMoments, 8),
        ("trigonometric", MapForm::TrigonometricMoments, 8),
    ] {
        let settings = MapSettings::new(form, coefficients, [24, 20]);
        let map = TransmittanceMap::new(gpu(), settings, &light).unwrap();
        let voxels = Voxels::new(gpu(), shaders(), settings, Reading::Linear).unwrap();
        let mut encoder = gpu().encoder();
        voxels.record(&mut encoder, &voxels.bind(gpu(), &map, &uploaded).unwrap());
        gpu().submit(encoder).unwrap();
        assert_map(&format!("cloud_map_{name}"), &map, sums);
    }
}

#[test]
fn maps_of_particles() {
    let particles = burst(60, 5);
    let light =
        Light::directional_around_balls(Vec3::new(0.5, 0.8, 0.3), Vec3::ONE, particles.balls()).unwrap();
    let uploaded = ParticleBuffer::new(gpu(), &particles).unwrap();
    for (name, form, coefficients, fixed) in [
        ("blended", MapForm::Extinction, 4, false),
        ("extinction", MapForm::Extinction, 4, true),
        ("bounded", MapForm::Bounded, 4, true),
        ("power", MapForm::PowerMoments, 8, true),
    ] {
        let precision = if fixed { Precision::Single } else { Precision::Half };
        let settings = MapSettings { precision, ..MapSettings::new(form, coefficients, [32, 28]) };
        let map = TransmittanceMap::new(gpu(), settings, &light).unwrap();
        let mut encoder = gpu().encoder();
        if fixed {
            let splat = SplatFixed::new(gpu(), shaders(), settings).unwrap();
            splat.record(&mut encoder, &splat.bind(gpu(), &map, &uploaded).unwrap()).unwrap();
        } else {
            let splat = Splat::new(gpu(), shaders(), settings).unwrap();
            splat.record(&mut encoder, &splat.bind(gpu(), &map, &uploaded).unwrap(), &map, &uploaded);
        }
        gpu().submit(encoder).unwrap();
        // Half floats of sums of some ten particles; in fixed point steps of 4e-6.
        let rounding = if fixed { tolerance(1e-4, 1e-4, 0.01) } else { tolerance(1e-3, 5e-3, 0.01) };
        assert_map(&format!("burst_map_{name}"), &map, rounding);
    }
}

#[test]
fn painterly_torus() {
    let table = [[0.2, 0.3, 0.8, 0.0], [0.9, 0.5, 0.2, 1.0]];
    let exhibit = painted::Exhibit::new(torus_field([32, 28, 24], 0.55, 0.25), Some([0.0, 1.0]), &table);
    let source = [40, 30];
    let style = painted::style([0.06, 0.09, 1.0]);
    let style = PainterlyStyle { orientation: Orientation::Curvature, ..style };
    let mut painting = exhibit.painting(painted::settings(style, source));
    for number in 0..4 {
        let mut frame = exhibit.frame(source, number);
        // The first strokes are there at once.
        frame.seconds = if number == 1 { 1.0 } else { frame.seconds };
        painted::paint(&mut painting, &frame);
    }
    let targets = painting.targets();
    let strokes = painting.strokes();
    let name = |what: &str| format!("painterly_torus_{what}");
    // A ray that grazes may hit something else on another adapter, and chance puts another stroke on it.
    let sharp = tolerance(2e-3, 2e-3, 0.03);
    assert_buffer(&name("color"), &buffer(&targets.color, 0, 4, sharp));
    assert_buffer(&name("surface"), &buffer(&targets.surface, 0, 4, sharp));
    assert_buffer(&name("flow"), &buffer(&targets.flow, 0, 2, tolerance(2e-3, 5e-3, 0.03)));
    assert_buffer(&name("distance"), &buffer(&targets.distance, 0, 1, tolerance(1e-4, 1e-4, 0.03)));
    let curvature = targets.curvature.as_ref().unwrap();
    assert_buffer(&name("curvature"), &buffer(curvature, 0, 4, tolerance(5e-3, 0.01, 0.05)));
    assert_buffer(&name("density"), &buffer(&strokes.density, 0, 3, tolerance(1e-3, 5e-3, 0.1)));

    let adapter = gpu().description();
    let list = strokes.read(gpu()).unwrap();
    let rows = list.iter().step_by(8).flat_map(|stroke| {
        let place = [stroke.position.x, stroke.position.y, stroke.orientation, stroke.opacity];
        place.into_iter().chain([stroke.size, stroke.layer as f32, stroke.state as u32 as f32])
    });
    let values: Vec<f32> = rows.collect();
    let shape = [1, values.len() / 7, 7];
    let tolerance = tolerance(1e-3, 1e-3, 0.2);
    assert_buffer(&name("strokes"), &Buffer { adapter: adapter.clone(), shape, tolerance, values });
    let order = strokes.read_order(gpu()).unwrap();
    let values: Vec<f32> = order.iter().step_by(4).map(|number| *number as f32).collect();
    let (shape, tolerance) =
        ([values.len(), 1, 1], Tolerance { absolute: 0.5, relative: 0.0, outliers: 1.0 });
    assert_buffer(&name("order"), &Buffer { adapter: adapter.clone(), shape, tolerance, values });

    let pixels = Tonemap::new(gpu(), shaders()).unwrap().run(gpu(), &painting.picture, 1.0).unwrap();
    assert_picture(&name("picture"), &adapter, &Picture { size: painted::SIZE, pixels }, 0.95);
}

#[test]
fn sheets_of_a_cloud_with_a_ball() {
    let volume = sheet_scene::small_cloud();
    let volumes = [sheets::splats(&volume)];
    let ball = sphere(0.4, 32, 16).transformed(glam::Mat4::from_translation(Vec3::new(0.5, 0.5, 0.2)));
    let surfaces = Surfaces::new(gpu(), &[ball]).unwrap();
    let transfer = sheets::colored([Vec3::ONE, Vec3::new(0.9, 0.6, 0.4)]);
    let [view, way] = sheet_scene::directions(70.0);
    let size = [40, 30];
    let (_, camera) = sheet_scene::camera(view, false, size);
    let bounds = volume.bounds();
    let (_, light) = sheet_scene::light(way, false, [6.0, 5.0, 4.0], [bounds.min - 0.5, bounds.max + 0.5]);
    let frame = SheetFrame { camera, light, lighting: SheetLighting::new(4.0) };
    let scattering = ScatteringSettings { cone: 60.0, free_path: 0.2, back: true, sweeps: 2 };
    let ways = [
        ("direct", LightTransport::Direct),
        ("scattered", LightTransport::Scattering(scattering)),
        ("soft", LightTransport::Soft(SoftShadows::new(12.0))),
    ];
    for (name, transport) in ways {
        let settings =
            SheetSettings { count: 24, light_size: [40; 2], transport, ..SheetSettings::default() };
        let inputs = SheetInputs { surfaces: Some(&surfaces), ..SheetInputs::new(&volumes, &transfer) };
        let picture = SheetPicture::new(gpu(), shaders(), inputs, settings, size).unwrap();
        picture.set(gpu(), &frame).unwrap();
        let mut encoder = gpu().encoder();
        picture.record(gpu(), &mut encoder).unwrap();
        gpu().submit(encoder).unwrap();
        // Half floats of sums of some ten sheets; at shadow edges another adapter may choose another texel.
        let rounding = tolerance(4e-3, 0.01, 0.02);
        assert_buffer(&format!("sheets_{name}_picture"), &buffer(&picture.picture, 0, 4, rounding));
        assert_buffer(&format!("sheets_{name}_shadow"), &buffer(picture.shadow(), 0, 3, rounding));
        if let Some(returned) = picture.returned() {
            assert_buffer(&format!("sheets_{name}_returned"), &buffer(returned, 0, 3, rounding));
        }
    }
}
