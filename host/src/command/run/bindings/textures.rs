// SPDX-License-Identifier: MIT OR Apache-2.0
//! Textures: sampled ones, storage textures, and the target of a full-screen pass.

use super::place::{Given, Place, output_flag, shape_text};
use super::{Planned, Recipe, TARGET, TextureRecipe, Written};
use crate::command::CommandError;
use crate::command::run::spelling::{Output, Scalar};
use crate::command::run::{Options, texels};
use airlight_validate::{Sample, TextureDimension};

impl Place<'_> {
    /// Width, height and layers, and channels, of an array.
    fn extent(&self, given: &Given, dimension: TextureDimension) -> Result<([u32; 3], u32), CommandError> {
        let (flat, names) = match dimension {
            TextureDimension::D2 => (true, "(height, width) or (height, width, channels)"),
            TextureDimension::D2Array => {
                (false, "(layers, height, width) or (layers, height, width, channels)")
            }
            TextureDimension::D3 => (false, "(depth, height, width) or (depth, height, width, channels)"),
            _ => {
                return Err(self.impossible(&format!("a {dimension} texture cannot be filled from an array")));
            }
        };
        let small: Option<Vec<u32>> = given.shape.iter().map(|side| u32::try_from(*side).ok()).collect();
        let found = match (flat, small.as_deref()) {
            (true, Some(&[height, width])) => Some(([width, height, 1], 1)),
            (true, Some(&[height, width, channels])) => Some(([width, height, 1], channels)),
            (false, Some(&[layers, height, width])) => Some(([width, height, layers], 1)),
            (false, Some(&[layers, height, width, channels])) => Some(([width, height, layers], channels)),
            _ => None,
        };
        let (size, channels) = found
            .filter(|(size, channels)| (1..=4).contains(channels) && size.iter().all(|side| *side > 0))
            .ok_or_else(|| {
                let shape = shape_text(&given.shape);
                given.wrong(format!("shape {shape}; `{}` takes {names}, with 1 to 4 channels", self.name))
            })?;
        if let Some(problem) = self.too_large(size, dimension) {
            return Err(given.wrong(problem));
        }
        Ok((size, channels))
    }

    fn too_large(&self, size: [u32; 3], dimension: TextureDimension) -> Option<String> {
        let limits = self.limits;
        let (side, depth) = match dimension {
            TextureDimension::D3 => (limits.max_texture_dimension_3d, limits.max_texture_dimension_3d),
            _ => (limits.max_texture_dimension_2d, limits.max_texture_array_layers),
        };
        let [width, height, layers] = size;
        (width > side || height > side || layers > depth).then(|| match dimension {
            TextureDimension::D2 => {
                format!("height {height} and width {width}; a device takes at most {side} each")
            }
            _ => format!(
                "{layers} layers of height {height} and width {width}; a device takes at most {depth} layers of {side} each"
            ),
        })
    }

    /// A texture that is read.
    pub(super) fn sampled(
        &self,
        dimension: TextureDimension,
        sample: Sample,
        filtered: bool,
    ) -> Result<TextureRecipe, CommandError> {
        let Some(given) = self.given()? else {
            return Err(self.impossible("nothing was given"));
        };
        let (size, channels) = self.extent(&given, dimension)?;
        let format = texels::format_for(sample, filtered, channels, &given.data).map_err(|wanted| {
            given.wrong(format!("`{}` takes {wanted}, not {}", self.name, given.type_name))
        })?;
        let bytes = texels::encode(format, channels, &given.data).map_err(|problem| given.wrong(problem))?;
        Ok(TextureRecipe {
            size,
            dimension: view(dimension),
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            bytes: Some(bytes),
        })
    }

    /// A texture that is written, and what is kept of it.
    pub(super) fn storage_texture(
        &self,
        dimension: TextureDimension,
        format: wgpu::TextureFormat,
    ) -> Result<(Recipe, Option<Written>), CommandError> {
        let mut bytes = None;
        let mut size = None;
        if let Some(given) = self.given()? {
            let (extent, channels) = self.extent(&given, dimension)?;
            let components = u32::from(format.components());
            if channels != components && (channels, components) != (3, 4) {
                return Err(given.wrong(format!(
                    "{channels} channels; `{}` is {format:?} and takes {components}",
                    self.name
                )));
            }
            bytes =
                Some(texels::encode(format, channels, &given.data).map_err(|problem| given.wrong(problem))?);
            size = Some(extent);
        }
        let mut written = None;
        if let Some(output) = self.output {
            let flag = output_flag(output);
            let named = self.output_extent(output, &flag, dimension)?;
            let extent = match (size, named) {
                (Some(size), Some(named)) if size != named => {
                    return Err(CommandError::misuse(&flag, "the shape is not that of the array of --in"));
                }
                (Some(size), _) | (None, Some(size)) => size,
                (None, None) => {
                    let names = side_names(dimension);
                    let problem = format!("say how large it is, {}=FILE.npy:{names}", self.name);
                    return Err(CommandError::misuse(&flag, problem));
                }
            };
            check_copy(&flag, extent, format, self.limits)?;
            let [width, height, layers] = extent.map(|side| side as usize);
            let shape = if dimension == TextureDimension::D2 {
                vec![height, width]
            } else {
                vec![layers, height, width]
            };
            written = Some(Written { flag, file: output.file.clone(), shape, scalar: Scalar::F32 });
            size = Some(extent);
        }
        let Some(size) = size else { return Err(self.impossible("nothing was given")) };
        let usage = wgpu::TextureUsages::STORAGE_BINDING
            | wgpu::TextureUsages::COPY_DST
            | wgpu::TextureUsages::COPY_SRC;
        let recipe = TextureRecipe { size, dimension: view(dimension), format, usage, bytes };
        Ok((Recipe::Texture(recipe), written))
    }

    fn output_extent(
        &self,
        output: &Output,
        flag: &str,
        dimension: TextureDimension,
    ) -> Result<Option<[u32; 3]>, CommandError> {
        no_type(output, flag)?;
        let extent = match (dimension, output.shape.as_deref()) {
            (TextureDimension::D2, None) => match self.size {
                Some([width, height]) => [width, height, 1],
                None => return Ok(None),
            },
            (_, None) => return Ok(None),
            (TextureDimension::D2, Some(&[height, width])) => [width, height, 1],
            (TextureDimension::D2Array | TextureDimension::D3, Some(&[layers, height, width])) => {
                [width, height, layers]
            }
            (TextureDimension::D2 | TextureDimension::D2Array | TextureDimension::D3, Some(_)) => {
                let problem = format!("the shape of this texture is {}", side_names(dimension));
                return Err(CommandError::misuse(flag, problem));
            }
            (_, Some(_)) => {
                return Err(self.impossible(&format!("a {dimension} storage texture cannot be made")));
            }
        };
        match self.too_large(extent, dimension) {
            Some(problem) => Err(CommandError::misuse(flag, problem)),
            None => Ok(Some(extent)),
        }
    }
}

/// The sides of a texture in the order of an array's axes.
pub(super) fn side_names(dimension: TextureDimension) -> &'static str {
    if dimension == TextureDimension::D2 { "HEIGHT,WIDTH" } else { "LAYERS,HEIGHT,WIDTH" }
}

fn no_type(output: &Output, flag: &str) -> Result<(), CommandError> {
    match output.scalar {
        Some(scalar) => Err(CommandError::misuse(
            flag,
            format!("type {} is for buffers; that of a texture is its format's", scalar.name()),
        )),
        None => Ok(()),
    }
}

/// Texels are read back through one buffer.
fn check_copy(
    flag: &str,
    size: [u32; 3],
    format: wgpu::TextureFormat,
    limits: &wgpu::Limits,
) -> Result<(), CommandError> {
    let bytes = copy_size(size, format);
    if bytes > limits.max_buffer_size {
        let limit = limits.max_buffer_size;
        return Err(CommandError::misuse(
            flag,
            format!("{bytes} bytes; a device reads back at most {limit} at once"),
        ));
    }
    Ok(())
}

/// Bytes of a row of texels in a buffer.
pub fn copy_row(width: u32, format: wgpu::TextureFormat) -> u32 {
    (width * format.block_copy_size(None).unwrap_or(16)).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

/// Bytes of a texture in a buffer.
pub fn copy_size(size: [u32; 3], format: wgpu::TextureFormat) -> u64 {
    u64::from(copy_row(size[0], format)) * u64::from(size[1]) * u64::from(size[2])
}

fn view(dimension: TextureDimension) -> wgpu::TextureViewDimension {
    match dimension {
        TextureDimension::D2Array => wgpu::TextureViewDimension::D2Array,
        TextureDimension::D3 => wgpu::TextureViewDimension::D3,
        // The others never come this far.
        _ => wgpu::TextureViewDimension::D2,
    }
}

/// The target of a full-screen pass.
pub(super) fn target(
    options: &Options,
    format: wgpu::TextureFormat,
    [width, height]: [u32; 2],
    limits: &wgpu::Limits,
) -> Result<Planned, CommandError> {
    let output = options.output.iter().find(|output| output.name == TARGET);
    let output =
        output.ok_or_else(|| CommandError::misuse("--out", format!("{TARGET}=FILE.npy is needed")))?;
    let flag = output_flag(output);
    no_type(output, &flag)?;
    if output.shape.as_ref().is_some_and(|shape| *shape != [height, width]) {
        return Err(CommandError::misuse(
            &flag,
            format!("the target is {height},{width} (height, width) by --size"),
        ));
    }
    let size = [width, height, 1];
    check_copy(&flag, size, format, limits)?;
    let recipe = TextureRecipe {
        size,
        dimension: wgpu::TextureViewDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        bytes: None,
    };
    let shape = vec![height as usize, width as usize];
    let written = Written { flag, file: output.file.clone(), shape, scalar: Scalar::F32 };
    Ok(Planned { name: TARGET.to_owned(), recipe: Recipe::Texture(recipe), written: Some(written) })
}
