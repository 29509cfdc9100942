// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the command writes: the picture, and the buffers on the way to it.

use super::Eye;
use crate::command::CommandError;
use crate::core::Tonemap;
use crate::formats::{Array, ArrayData, create_folder, write_exr, write_npy, write_png};
use crate::scattering::{ViewPasses, ViewShafts};
use crate::{Gpu, Stage, Texture};
use std::path::Path;

/// Arrays with the names of their files.
#[derive(Default)]
pub struct Buffers {
    arrays: Vec<(String, Array)>,
}

impl Buffers {
    /// Reads a texture.
    pub fn texture(&mut self, gpu: &Gpu, name: &str, texture: &Texture) -> Result<(), CommandError> {
        let array = array(gpu, texture)?;
        self.arrays.push((name.to_owned(), array));
        Ok(())
    }

    /// Takes an array.
    pub fn array(&mut self, name: &str, array: Array) {
        self.arrays.push((name.to_owned(), array));
    }

    /// Reads what lies between inputs and radiance of a view. `prefix`: of the names.
    fn view(&mut self, gpu: &Gpu, prefix: &str, view: &ViewShafts) -> Result<(), CommandError> {
        let named = |name: &str| format!("{prefix}{name}");
        if let Some(reduced) = &view.reduced {
            self.texture(gpu, &named("reduced_depth"), &reduced.depth)?;
            self.texture(gpu, &named("reduced_scattered"), view.passes.scattered())?;
        }
        let (uniform, words) = match &view.passes {
            ViewPasses::Epipolar(passes) => {
                self.texture(gpu, &named("slices"), &passes.rectification.slices)?;
                self.texture(gpu, &named("rectified"), &passes.rectification.rectified)?;
                for (name, texture) in passes.prefilter.textures() {
                    self.texture(gpu, &named(name), texture)?;
                }
                ("frame", passes.rectification.frame.read_floats(gpu)?)
            }
            ViewPasses::Projective(passes) => {
                self.texture(gpu, &named("rectified"), &passes.map.rectified)?;
                for (name, texture) in passes.prefilter.textures() {
                    self.texture(gpu, &named(name), texture)?;
                }
                ("rows", passes.map.rows.read_floats(gpu)?)
            }
            ViewPasses::March { .. } => return self.texture(gpu, &named("scattered"), view.scattered()),
        };
        self.arrays.push((named(uniform), Array { shape: vec![words.len()], data: ArrayData::F32(words) }));
        self.texture(gpu, &named("scattered"), view.scattered())
    }

    /// Reads textures of one size as the layers of one array.
    pub fn layers(&mut self, gpu: &Gpu, name: &str, textures: &[&Texture]) -> Result<(), CommandError> {
        let [first, ..] = textures else { return Ok(()) };
        let [width, height, _] = first.size().map(|side| side as usize);
        let texels = textures.iter().map(|texture| Ok(texture.read(gpu)?));
        let texels = texels.collect::<Result<Vec<_>, CommandError>>()?.concat();
        let mut shape = vec![height, width];
        if textures.len() > 1 {
            shape.insert(0, textures.len());
        }
        self.arrays.push((name.to_owned(), Array { shape, data: ArrayData::F32(texels) }));
        Ok(())
    }

    /// Reads all that lies between the mesh and the picture of an eye. `prefix`: of the names.
    pub fn eye(
        &mut self,
        gpu: &Gpu,
        prefix: &str,
        eye: &Eye,
        view: &ViewShafts,
        composed: &Texture,
    ) -> Result<(), CommandError> {
        self.shadow_maps(gpu, prefix, &eye.stage)?;
        self.texture(gpu, &format!("{prefix}surface"), &eye.stage.pictures.surface)?;
        self.texture(gpu, &format!("{prefix}depth"), eye.inputs().depth)?;
        self.view(gpu, prefix, view)?;
        self.texture(gpu, &format!("{prefix}composed"), composed)
    }

    /// Reads the shadow maps of a stage that there are.
    fn shadow_maps(&mut self, gpu: &Gpu, prefix: &str, stage: &Stage) -> Result<(), CommandError> {
        // That of a point light is one empty texel.
        if stage.light.kind != crate::core::POINT {
            self.texture(gpu, &format!("{prefix}shadow_map"), &stage.pictures.shadow_map)?;
        }
        match &stage.pictures.shadow_maps {
            Some(maps) => self.texture(gpu, &format!("{prefix}shadow_maps"), maps),
            None => Ok(()),
        }
    }

    /// Writes all of them into a folder, which is made.
    pub fn write(&self, folder: &Path) -> Result<(), CommandError> {
        let failed = |error: &dyn std::fmt::Display| CommandError::Failure(format!("--buffers: {error}"));
        create_folder(folder).map_err(|error| failed(&error))?;
        for (name, array) in &self.arrays {
            write_npy(folder.join(format!("{name}.npy")), array).map_err(|error| failed(&error))?;
        }
        Ok(())
    }
}

/// A texture as an array: layers first where there are several, then rows, columns, channels.
fn array(gpu: &Gpu, texture: &Texture) -> Result<Array, CommandError> {
    use wgpu::TextureFormat::{R32Uint, Rg32Uint, Rgba32Uint};
    let words = matches!(texture.raw.format(), R32Uint | Rg32Uint | Rgba32Uint);
    let data =
        if words { ArrayData::U32(texture.read_words(gpu)?) } else { ArrayData::F32(texture.read(gpu)?) };
    let [width, height, layers] = texture.size().map(|side| side as usize);
    let channels = data.len() / (width * height * layers);
    let mut shape = vec![height, width];
    if layers > 1 {
        shape.insert(0, layers);
    }
    if channels > 1 {
        shape.push(channels);
    }
    Ok(Array { shape, data })
}

/// Writes radiance as .png (tone-mapped) or .exr (linear), by the ending of `path`; pictures of one size side by side.
pub fn write_pictures(
    gpu: &Gpu,
    tonemap: &Tonemap,
    radiance: &[Texture],
    exposure: f32,
    path: &Path,
) -> Result<(), CommandError> {
    let [width, height, _] = radiance.first().map_or([0; 3], |texture| texture.size());
    let whole = width * radiance.len() as u32;
    let failure = |error| CommandError::Failure(format!("--out: {error}"));
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
        let pictures = radiance.iter().map(|texture| Ok(texture.read(gpu)?));
        let pictures = pictures.collect::<Result<Vec<_>, CommandError>>()?;
        write_exr(path, whole, height, &side_by_side(&pictures, height)).map_err(failure)
    } else {
        write_png(path, whole, height, &tone_mapped(gpu, tonemap, radiance, exposure)?).map_err(failure)
    }
}

/// Radiance as a picture to look at, RGBA of 8 bits; pictures of one size side by side.
pub fn tone_mapped(
    gpu: &Gpu,
    tonemap: &Tonemap,
    radiance: &[Texture],
    exposure: f32,
) -> Result<Vec<u8>, CommandError> {
    let height = radiance.first().map_or(0, |texture| texture.size()[1]);
    let pictures = radiance.iter().map(|texture| Ok(tonemap.run(gpu, texture, exposure)?));
    Ok(side_by_side(&pictures.collect::<Result<Vec<_>, CommandError>>()?, height))
}

/// The rows of pictures of one size, one after the other.
fn side_by_side<T: Copy>(pictures: &[Vec<T>], height: u32) -> Vec<T> {
    let row = |picture: &Vec<T>| picture.len() / (height as usize).max(1);
    (0..height as usize)
        .flat_map(|y| pictures.iter().flat_map(move |p| p[y * row(p)..(y + 1) * row(p)].iter().copied()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_pictures_follow_each_other() {
        let pictures = [vec![1, 2, 3, 4], vec![5, 6, 7, 8]];
        assert_eq!(side_by_side(&pictures, 2), [1, 2, 5, 6, 3, 4, 7, 8]);
        assert_eq!(side_by_side(&pictures[..1], 2), [1, 2, 3, 4]);
    }
}
