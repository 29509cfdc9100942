// SPDX-License-Identifier: MIT OR Apache-2.0
//! Airlight's modules as shader assets of Bevy: air as a material, light shafts through Bevy's own shadow map.
//!
//! `cargo run --release -- shafts.png` draws one picture without a window.

use bevy::app::ScheduleRunnerPlugin;
use bevy::asset::{RenderAssetUsages, embedded_asset};
use bevy::camera::RenderTarget;
use bevy::core_pipeline::{prepass::DepthPrepass, tonemapping::Tonemapping};
use bevy::light::{
    CascadeShadowConfigBuilder, DirectionalLightShadowMap, NotShadowCaster, NotShadowReceiver,
};
use bevy::mesh::{Indices, MeshVertexBufferLayoutRef, PrimitiveTopology};
use bevy::pbr::{MaterialPipeline, MaterialPipelineKey};
use bevy::prelude::*;
use bevy::render::render_resource::{
    AsBindGroup, CompareFunction, Face, RenderPipelineDescriptor, ShaderType, SpecializedMeshPipelineError,
    TextureFormat,
};
use bevy::render::view::Hdr;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};
use bevy::shader::ShaderRef;
use bevy::window::ExitCondition;
use std::time::Duration;

fn main() {
    let mut app = App::new();
    app.add_plugins((
        DefaultPlugins.set(WindowPlugin {
            primary_window: None,
            exit_condition: ExitCondition::DontExit,
            ..default()
        }),
        ScheduleRunnerPlugin::run_loop(Duration::ZERO),
        AirPlugin,
    ));
    app.insert_resource(ClearColor(Color::linear_rgb(0.10, 0.12, 0.16)));
    app.insert_resource(GlobalAmbientLight {
        color: Color::srgb(0.55, 0.65, 0.9),
        brightness: 500.0,
        ..default()
    });
    app.insert_resource(DirectionalLightShadowMap { size: 4096 });
    app.add_systems(Startup, scene);
    app.add_systems(Update, photograph);
    app.run();
}

/// Airlight for Bevy: every module becomes a shader asset, so that `#import airlight::…` works in any shader of the app.
struct AirPlugin;

/// Keeps the modules loaded.
#[derive(Resource)]
struct Modules(#[allow(dead_code)] Vec<Handle<Shader>>);

impl Plugin for AirPlugin {
    fn build(&self, app: &mut App) {
        embedded_asset!(app, "air.wgsl");
        app.add_plugins(MaterialPlugin::<Air>::default());
        let mut shaders = app.world_mut().resource_mut::<Assets<Shader>>();
        let modules = airlight_wgsl::MODULES
            .iter()
            .map(|module| shaders.add(Shader::from_wgsl(module.source, module.file)))
            .collect();
        app.insert_resource(Modules(modules));
    }
}

/// `Medium` of `scattering/single_scatter`.
#[derive(Clone, Copy, Debug, ShaderType)]
struct Medium {
    /// Share of the extinction that is scattering, 0..1.
    albedo: Vec3,
    /// 1/m.
    extinction: f32,
    /// Mean cosine of the phase function.
    g: f32,
    /// Rays that meet nothing end here, metres.
    distance_limit: f32,
    reserved_a: f32,
    reserved_b: f32,
}

/// Air, as the material of a box that holds the whole scene.
#[derive(Asset, AsBindGroup, Clone, Debug, TypePath)]
struct Air {
    #[uniform(0)]
    medium: Medium,
}

impl Material for Air {
    fn fragment_shader() -> ShaderRef {
        "embedded://airlight_example_bevy/air.wgsl".into()
    }

    fn alpha_mode(&self) -> AlphaMode {
        AlphaMode::Premultiplied
    }

    fn enable_prepass() -> bool {
        false
    }

    /// The far sides of the box, whatever stands before them: each pixel once, also with the camera inside.
    fn specialize(
        _: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        _: &MeshVertexBufferLayoutRef,
        _: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        descriptor.primitive.cull_mode = Some(Face::Front);
        if let Some(depth) = &mut descriptor.depth_stencil {
            depth.depth_compare = CompareFunction::Always;
        }
        Ok(())
    }
}

#[derive(Resource)]
struct Picture(Handle<Image>);

/// Suzanne in an arcade, before a low sun.
fn scene(
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut airs: ResMut<Assets<Air>>,
) -> Result {
    let mut matte = |r, g, b| {
        let base_color = Color::linear_rgb(r, g, b);
        materials.add(StandardMaterial {
            base_color,
            perceptual_roughness: 1.0,
            reflectance: 0.1,
            ..default()
        })
    };
    let (stone, ground, skin) = (matte(0.42, 0.38, 0.34), matte(0.30, 0.26, 0.22), matte(0.70, 0.32, 0.16));

    let mut block = |low: Vec3, high: Vec3, material: &Handle<StandardMaterial>| {
        let cuboid = meshes.add(Cuboid::from_size(high - low));
        commands.spawn((
            Mesh3d(cuboid),
            MeshMaterial3d(material.clone()),
            Transform::from_translation(0.5 * (low + high)),
        ));
    };
    block(vec3(-5.4, -0.3, -9.0), vec3(5.0, 0.0, 9.0), &ground);
    block(vec3(-5.4, 5.2, -9.0), vec3(5.0, 5.5, 9.0), &stone); // ceiling
    block(vec3(-5.4, 4.3, -9.0), vec3(-4.8, 5.2, 9.0), &stone); // what the columns carry
    block(vec3(-5.4, 0.0, -9.0), vec3(-4.8, 0.35, 9.0), &stone); // what they stand on
    block(vec3(-5.4, 0.0, -9.3), vec3(5.0, 5.2, -9.0), &stone); // behind the mesh
    block(vec3(-5.4, 0.0, 9.0), vec3(5.0, 5.2, 9.3), &stone); // behind the camera
    block(vec3(5.0, 0.0, -9.0), vec3(5.3, 5.2, 9.0), &stone); // right
    block(vec3(-1.2, 0.0, -1.5), vec3(0.6, 0.7, 0.3), &stone); // what the mesh stands on
    let column = meshes.add(Cylinder::new(0.32, 4.0));
    for at in 0..12 {
        let place = Transform::from_xyz(-5.1, 2.3, -8.4 + 1.5 * at as f32);
        commands.spawn((Mesh3d(column.clone()), MeshMaterial3d(stone.clone()), place));
    }
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../host/assets/suzanne.obj");
    let place = Transform::from_xyz(-0.3, 1.55, -0.6)
        .with_rotation(Quat::from_rotation_y(-0.2))
        .with_scale(Vec3::splat(0.9));
    commands.spawn((Mesh3d(meshes.add(mesh(file)?)), MeshMaterial3d(skin), place));

    let medium = Medium {
        albedo: Vec3::splat(0.95),
        extinction: 0.05,
        g: 0.35,
        distance_limit: 30.0,
        reserved_a: 0.0,
        reserved_b: 0.0,
    };
    commands.spawn((
        Mesh3d(meshes.add(Cuboid::from_length(60.0))),
        MeshMaterial3d(airs.add(Air { medium })),
        NotShadowCaster,
        NotShadowReceiver,
    ));
    let (azimuth, elevation) = (262f32.to_radians(), 27f32.to_radians());
    let towards = vec3(elevation.cos() * azimuth.sin(), elevation.sin(), elevation.cos() * azimuth.cos());
    commands.spawn((
        DirectionalLight {
            illuminance: 15_000.0,
            color: Color::linear_rgb(1.0, 0.70, 0.42),
            shadows_enabled: true,
            ..default()
        },
        // One cascade over everything that a view ray crosses.
        CascadeShadowConfigBuilder { num_cascades: 1, maximum_distance: 24.0, ..default() }.build(),
        Transform::default().looking_to(-towards, Vec3::Y),
    ));
    let picture = images.add(Image::new_target_texture(1280, 720, TextureFormat::Rgba8UnormSrgb, None));
    commands.spawn((
        Camera3d::default(),
        RenderTarget::Image(picture.clone().into()),
        Projection::Perspective(PerspectiveProjection { fov: 50f32.to_radians(), ..default() }),
        Transform::from_xyz(3.2, 1.5, 5.2).looking_at(vec3(-1.0, 1.8, -0.8), Vec3::Y),
        // Radiance beyond 1 until the tone curve, and the depth that the air ends at.
        (Hdr, Tonemapping::AcesFitted, DepthPrepass, Msaa::Off),
    ));
    commands.insert_resource(Picture(picture));
    Ok(())
}

/// The triangles of an .obj file with normals.
fn mesh(file: &str) -> Result<Mesh> {
    let (models, _) = tobj::load_obj(file, &tobj::GPU_LOAD_OPTIONS)?;
    let tobj::Model { mesh, .. } = models.into_iter().next().ok_or("an empty file")?;
    let points = |numbers: &[f32]| numbers.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect::<Vec<_>>();
    Ok(Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::RENDER_WORLD)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, points(&mesh.positions))
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, points(&mesh.normals))
        .with_inserted_indices(Indices::U32(mesh.indices)))
}

/// Saves a picture once all pipelines have had time to be made, and ends.
fn photograph(mut commands: Commands, picture: Res<Picture>, mut frame: Local<u32>) {
    *frame += 1;
    if *frame == 20 {
        let file = std::env::args().nth(1).unwrap_or_else(|| "shafts.png".into());
        commands.spawn(Screenshot::image(picture.0.clone())).observe(save_to_disk(file)).observe(
            |_: On<ScreenshotCaptured>, mut exit: MessageWriter<AppExit>| {
                exit.write(AppExit::Success);
            },
        );
    }
}
