// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the host says to wrong resources and broken shaders.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;

use airlight::core::{Tonemap, TonemapParameters};
use airlight::validate::{Definitions, Library};
use airlight::{Buffer, Pass, PassError, RenderStages, Resource, Sampler, Shaders, Texture};
use gpu::{gpu, shaders};
use wgpu::TextureFormat::{R32Float, R32Uint, Rgba8Unorm, Rgba16Float, Rgba32Float};

/// The pass that the tests bind, and resources that fit it.
struct Fixture {
    pass: Pass,
    parameters: Buffer,
    radiance: Texture,
    picture: Texture,
}

impl Fixture {
    fn new() -> Self {
        let parameters = TonemapParameters { exposure: 1.0, dither: 0.0, reserved_a: 0.0, reserved_b: 0.0 };
        Self {
            pass: Pass::compute(gpu(), shaders(), "core/tonemap", "default").unwrap(),
            parameters: Buffer::uniform(gpu(), &parameters),
            radiance: Texture::storage(gpu(), [8, 8], Rgba16Float),
            picture: Texture::storage(gpu(), [8, 8], Rgba8Unorm),
        }
    }

    fn fitting(&self) -> Vec<(&str, Resource<'_>)> {
        vec![
            ("parameters", (&self.parameters).into()),
            ("radiance", (&self.radiance).into()),
            ("picture", (&self.picture).into()),
        ]
    }

    /// The error with one resource replaced.
    fn with<'a>(&'a self, name: &'static str, resource: Resource<'a>) -> PassError {
        let mut resources = self.fitting();
        resources.retain(|(other, _)| *other != name);
        resources.push((name, resource));
        self.pass.bind(gpu(), &resources).err().unwrap()
    }
}

#[test]
fn fitting_resources_bind() {
    let fixture = Fixture::new();
    assert!(fixture.pass.bind(gpu(), &fixture.fitting()).is_ok());
    // `bind_known` takes names of other passes; a depth texture may be read as floats.
    let mut more = fixture.fitting();
    more.push(("camera", (&fixture.parameters).into()));
    assert!(fixture.pass.bind_known(gpu(), &more).is_ok());
}

#[test]
fn an_unknown_name_lists_what_the_pass_expects() {
    let fixture = Fixture::new();
    let mut resources = fixture.fitting();
    resources.push(("radiancy", (&fixture.radiance).into()));
    let error = fixture.pass.bind(gpu(), &resources).err().unwrap();
    assert!(matches!(&error, PassError::UnknownBinding { name, .. } if name == "radiancy"));
    let text = error.to_string();
    for part in [
        "core/tonemap",
        "`radiancy`",
        "`parameters`",
        "TonemapParameters",
        "16 bytes",
        "`radiance`",
        "rgba8unorm",
    ] {
        assert!(text.contains(part), "{text} lacks {part}");
    }
}

#[test]
fn a_missing_name_lists_what_the_pass_expects() {
    let fixture = Fixture::new();
    for name in ["parameters", "radiance", "picture"] {
        let mut resources = fixture.fitting();
        resources.retain(|(other, _)| *other != name);
        for error in [fixture.pass.bind(gpu(), &resources), fixture.pass.bind_known(gpu(), &resources)] {
            let error = error.err().unwrap();
            assert!(matches!(&error, PassError::MissingBinding { name: missing, .. } if missing == name));
            let text = error.to_string();
            assert!(
                text.contains(&format!("needs the binding `{name}`")) && text.contains("TonemapParameters"),
                "{text}"
            );
        }
    }
}

#[test]
fn an_ill_typed_resource_names_both_types() {
    let fixture = Fixture::new();
    let storage = Buffer::storage(gpu(), 16);
    let vertices = Buffer::with_bytes(gpu(), &[0; 64], wgpu::BufferUsages::VERTEX);
    let sampler = Sampler::rows(gpu());
    let whole = Texture::storage(gpu(), [8, 8], Rgba32Float);
    let array = Texture::array(gpu(), [8, 8, 2], Rgba16Float, wgpu::TextureUsages::TEXTURE_BINDING);
    let numbers = Texture::storage(gpu(), [8, 8], R32Uint);
    let sampled = Texture::new(gpu(), [8, 8], Rgba8Unorm, wgpu::TextureUsages::TEXTURE_BINDING);
    let cases: [(&'static str, Resource<'_>, &str, &str); 8] = [
        ("parameters", (&vertices).into(), "uniform TonemapParameters", "without uniform usage"),
        ("parameters", (&fixture.radiance).into(), "uniform", "Rgba16Float"),
        ("parameters", (&sampler).into(), "uniform", "a sampler"),
        ("radiance", (&storage).into(), "texture of float", "a buffer"),
        ("radiance", (&array).into(), "2d texture", "D2Array"),
        ("radiance", (&numbers).into(), "float", "R32Uint"),
        ("picture", (&whole).into(), "rgba8unorm", "Rgba32Float"),
        ("picture", (&sampled).into(), "storage texture", "TEXTURE_BINDING"),
    ];
    for (name, resource, wanted, given) in cases {
        let error = fixture.with(name, resource);
        assert!(matches!(&error, PassError::WrongResource { name: wrong, .. } if wrong == name), "{error:?}");
        let text = error.to_string();
        assert!(text.contains(wanted) && text.contains(given) && text.contains("core/tonemap"), "{text}");
    }
}

#[test]
fn a_buffer_that_is_too_small_is_refused() {
    let camera = Buffer::storage(gpu(), 16);
    let pass = Pass::compute(gpu(), shaders(), "scattering/composite", "default").unwrap();
    let texture = Texture::storage(gpu(), [8, 8], Rgba16Float);
    let resources: [(&str, Resource<'_>); 6] = [
        ("camera", (&camera).into()),
        ("medium", (&camera).into()),
        ("depth", (&texture).into()),
        ("surface", (&texture).into()),
        ("scattered", (&texture).into()),
        ("composed", (&texture).into()),
    ];
    let text = pass.bind(gpu(), &resources).err().unwrap().to_string();
    assert!(text.contains("160 bytes") && text.contains("a buffer of 16 bytes"), "{text}");
    let rectified = Texture::storage(gpu(), [8, 8], R32Float);
    let slices = Pass::compute(gpu(), shaders(), "scattering/slices", "default").unwrap();
    let big = Buffer::storage(gpu(), 192);
    let resources: [(&str, Resource<'_>); 5] = [
        ("camera", (&big).into()),
        ("light", (&big).into()),
        ("medium", (&big).into()),
        ("frame", (&camera).into()),
        ("slices", (&rectified).into()),
    ];
    let error = slices.bind(gpu(), &resources).err().unwrap();
    assert!(matches!(&error, PassError::WrongResource { name, .. } if name == "frame"), "{error}");
}

#[test]
fn samplers_are_told_apart() {
    let composed = shaders().compose("core/raster", "default").unwrap();
    let stages = RenderStages {
        vertex: "vertex_surface",
        fragment: Some("fragment_surface"),
        vertices: Some(wgpu::VertexBufferLayout {
            array_stride: 36,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3],
        }),
        target: Some(Rgba16Float),
        depth: None,
        samples: 1,
    };
    let pass = Pass::render(gpu(), &composed, &stages).unwrap();
    let uniform = Buffer::storage(gpu(), 192);
    let map = Texture::target(gpu(), [8, 8], wgpu::TextureFormat::Depth32Float);
    let rows = Sampler::rows(gpu());
    let resources: [(&str, Resource<'_>); 5] = [
        ("camera", (&uniform).into()),
        ("light", (&uniform).into()),
        ("sky", (&uniform).into()),
        ("shadow_map", (&map).into()),
        ("shadow_sampler", (&rows).into()),
    ];
    let text = pass.bind(gpu(), &resources).err().unwrap().to_string();
    assert!(text.contains("comparison sampler"), "{text}");
    let wrong = RenderStages { fragment: Some("fragment_sky"), ..stages };
    let error = Pass::render(gpu(), &composed, &wrong).err().unwrap();
    let text = error.to_string();
    assert!(
        matches!(error, PassError::UnknownEntryPoint { .. }) && text.contains("fragment_background"),
        "{text}"
    );
}

#[test]
fn an_unknown_entry_point_pass_or_permutation_lists_the_known_ones() {
    let fixture = Fixture::new();
    let bound = fixture.pass.bind(gpu(), &fixture.fitting()).unwrap();
    let mut encoder = gpu().encoder();
    let error = fixture.pass.dispatch_groups(&mut encoder, &bound, "tonemapping", [1, 1, 1]).err().unwrap();
    assert!(
        error.to_string().contains("`tonemapping`") && error.to_string().contains("has tonemap"),
        "{error}"
    );
    let error = Pass::compute(gpu(), shaders(), "core/tonemapping", "default").err().unwrap().to_string();
    assert!(error.contains("core/tonemapping") && error.contains("scattering/filter"), "{error}");
    let error = Pass::compute(gpu(), shaders(), "scattering/filter", "huge").err().unwrap().to_string();
    assert!(error.contains("huge") && error.contains("average"), "{error}");
}

#[test]
fn a_broken_shader_names_its_own_file_and_line() {
    for (file, old, new, line_of) in [
        // In a module that the pass imports, and in the pass itself.
        ("core/color.wgsl", "return dot(color,", "return dott(color,", "dott"),
        (
            "core/color.wgsl",
            "let x = clamp(color, vec3<f32>(0.0), vec3<f32>(1e4));",
            "let x = 1u;",
            "x * (2.51",
        ),
        (
            "core/passes/tonemap.wgsl",
            "textureStore(picture, id.xy,",
            "textureStore(picture, id.x,",
            "textureStore",
        ),
        ("core/passes/tonemap.wgsl", "core::finite::finite_or_rgb", "core::finit::finite_or_rgb", "finit::"),
    ] {
        let folder = gpu::copy_of_wgsl();
        let path = folder.path().join(file);
        let source = std::fs::read_to_string(&path).unwrap();
        assert!(source.contains(old), "{file} has no `{old}`");
        let source = source.replace(old, new);
        std::fs::write(&path, &source).unwrap();
        let line = 1 + source.lines().position(|line| line.contains(line_of)).unwrap();
        let shaders = Shaders::from_library(Library::from_directory(folder.path()).unwrap());
        let error = Pass::compute(gpu(), &shaders, "core/tonemap", "default").err().unwrap();
        let place = format!("{file}:{line}");
        assert!(error.to_string().starts_with(&place), "{error} does not start with {place}");
        assert!(matches!(error, PassError::Shader(_)));
    }
}

#[test]
fn what_the_device_refuses_is_an_error() {
    // A storage format outside core WebGPU: naga lets it pass, the device does not.
    let folder = gpu::copy_of_wgsl();
    let path = folder.path().join("core/passes/tonemap.wgsl");
    let source = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, source.replace("<rgba8unorm, write>", "<r8unorm, write>")).unwrap();
    let shaders = Shaders::from_library(Library::from_directory(folder.path()).unwrap());
    let error = Pass::compute_with(gpu(), &shaders, "core/tonemap", &Definitions::new()).err().unwrap();
    assert!(matches!(error, PassError::Gpu(_)), "{error}");
    assert!(gpu().check().is_ok(), "the error was reported twice");
}

#[test]
fn the_binding_of_the_host_itself_fits() {
    let tonemap = Tonemap::new(gpu(), shaders()).unwrap();
    let radiance = gpu::texture([2, 1], Rgba16Float, &[0.0, 0.0, 0.0, 1.0, 1e4, 1e4, 1e4, 1.0]);
    let picture = tonemap.run(gpu(), &radiance, 1.0).unwrap();
    assert_eq!(picture, [0, 0, 0, 255, 255, 255, 255, 255]);
    assert!(tonemap.run(gpu(), &Texture::storage(gpu(), [2, 2], R32Uint), 1.0).is_err());
}
