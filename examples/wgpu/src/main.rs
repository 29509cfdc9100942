// SPDX-License-Identifier: MIT OR Apache-2.0
//! Draws the picture: `cargo run --release -- SHADERS MESH PICTURE`, by default `shaders bunny.obj shafts.png`.

use airlight_example_wgpu::render;
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |at: usize, default| arguments.get(at).map_or(default, String::as_str);
    let (shaders, mesh) = (argument(0, "shaders"), argument(1, "bunny.obj"));
    // Four samples a pixel, for smooth edges.
    let large = render(Path::new(shaders), Path::new(mesh), [2560, 1440])?;
    let picture = image::imageops::thumbnail(&large, 1280, 720);
    picture.save(argument(2, "shafts.png"))?;
    Ok(())
}
