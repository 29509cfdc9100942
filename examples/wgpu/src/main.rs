// SPDX-License-Identifier: MIT OR Apache-2.0
//! Draws the picture: `cargo run --release -- SHADERS MESH PICTURE`, by default `shaders bunny.obj shafts.png`.

use airlight_example_wgpu::render;
use std::path::Path;

const WIDTH: u32 = 1280;
const HEIGHT: u32 = 720;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |at: usize, default| arguments.get(at).map_or(default, String::as_str);
    let (shaders, mesh) = (argument(0, "shaders"), argument(1, "bunny.obj"));
    // Four samples a pixel, for smooth edges.
    let large = render(Path::new(shaders), Path::new(mesh), [2 * WIDTH, 2 * HEIGHT])?;
    let stride = 8 * WIDTH as usize;
    let sample = |at: usize| u32::from(large[at]);
    let pixels: Vec<u8> = (0..4 * (WIDTH * HEIGHT) as usize)
        .map(|value| {
            let (row, column, channel) = (value / (stride / 2), value % (stride / 2) / 4, value % 4);
            let first = 2 * row * stride + 8 * column + channel;
            ((sample(first) + sample(first + 4) + sample(first + stride) + sample(first + stride + 4) + 2)
                / 4) as u8
        })
        .collect();

    let file = std::fs::File::create(argument(2, "shafts.png"))?;
    let mut encoder = png::Encoder::new(std::io::BufWriter::new(file), WIDTH, HEIGHT);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.write_header()?.write_image_data(&pixels)?;
    Ok(())
}
