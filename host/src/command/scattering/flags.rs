// SPDX-License-Identifier: MIT OR Apache-2.0
//! The flags of `airlight scattering`, and which of them cannot be meant together.

use super::conflicts;
use crate::command::CommandError;
use crate::command::parse::{self, DepthSpelling, LightSpelling, Projection};
use crate::core::{Cascades, Jitter};
use crate::scattering::{LightForm, RANK_BITS, Reference, Resolution, Visibility};
use clap::ValueEnum;
use glam::Vec3;
use std::path::PathBuf;

/// `--method`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MethodSpelling {
    /// Rank queries where they can be asked, else Fourier bases, or the march where there are no rows.
    Auto,
    /// Prefiltered Fourier bases: any light, soft edges.
    Fourier,
    /// Six prefiltered moments: half the memory of 32 bases and less exact.
    Moments,
    /// Rank queries: exact.
    Rank,
    /// A wavelet matrix: as exact, with --average only, in about a fifth of the memory and slower.
    Wavelet,
    /// One step after the other through the standard shadow map.
    March,
}

/// `--rectification`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RectificationSpelling {
    /// What gives the best picture; the march where there is neither.
    Auto,
    /// Rows around the light: any light, perspective cameras.
    Epipolar,
    /// Rows by a matrix: directional lights outside of the picture, any camera.
    Projective,
}

/// `--resolution`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ResolutionSpelling {
    /// Every pixel is evaluated.
    Full,
    /// Every second one in x and y.
    Half,
    /// Every fourth one in x and y.
    Quarter,
}

impl ResolutionSpelling {
    /// None where every pixel is evaluated.
    pub fn resolution(self) -> Option<Resolution> {
        match self {
            Self::Full => None,
            Self::Half => Some(Resolution::Half),
            Self::Quarter => Some(Resolution::Quarter),
        }
    }
}

/// `--jitter`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum JitterSpelling {
    /// Samples lie in the middle of each step.
    None,
    /// Shifted by interleaved gradient noise.
    Gradient,
    /// Shifted by blue noise.
    BlueNoise,
}

impl JitterSpelling {
    /// The library's.
    pub fn jitter(self) -> Jitter {
        match self {
            Self::None => Jitter::None,
            Self::Gradient => Jitter::Gradient,
            Self::BlueNoise => Jitter::BlueNoise,
        }
    }
}

/// `--start`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StartSpelling {
    /// Rays, and the air, begin at the eye.
    Eye,
    /// Rays, and the air, begin at the near plane.
    NearPlane,
}

/// `--reference`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ReferenceSpelling {
    /// The ray whose weights serve all rays of the row best.
    Optimum,
    /// The ray in the middle of the row.
    Bisectrix,
}

impl ReferenceSpelling {
    /// The library's.
    pub fn reference(self) -> Reference {
        match self {
            Self::Optimum => Reference::Optimum,
            Self::Bisectrix => Reference::Bisectrix,
        }
    }
}

/// Splits of projective rows where none are asked for.
pub const SPLITS: u32 = 3;

/// Flags of the command. Every flag but --mesh and --out has a default.
#[derive(clap::Args)]
pub struct Options {
    /// Mesh file, OBJ or glTF; may be given several times.
    #[arg(long, value_name = "FILE", required = true)]
    pub mesh: Vec<PathBuf>,
    /// Picture to write: .png (tone-mapped) or .exr (linear radiance).
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// How view rays run.
    #[arg(long, value_enum, default_value = "perspective")]
    pub camera: Projection,
    /// Position of the eye, metres [default: frames the mesh].
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true)]
    pub eye: Option<Vec3>,
    /// Point in the middle of the picture, metres [default: centre of the mesh].
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true)]
    pub target: Option<Vec3>,
    /// Vertical field of view of a perspective camera, degrees [default: 45].
    #[arg(long, value_name = "DEG", value_parser = parse::number, allow_hyphen_values = true)]
    pub fov: Option<f32>,
    /// Height of the picture of an orthographic camera, metres [default: frames the mesh].
    #[arg(long, value_name = "M", value_parser = parse::number, allow_hyphen_values = true)]
    pub height: Option<f32>,
    /// Distance of the near plane, metres; may be negative for an orthographic camera [default: from the mesh].
    #[arg(long, value_name = "M", value_parser = parse::number, allow_hyphen_values = true)]
    pub near: Option<f32>,
    /// Distance of the far plane, metres, where the air ends [default: from the mesh].
    #[arg(long, value_name = "M", value_parser = parse::number, allow_hyphen_values = true)]
    pub far: Option<f32>,
    /// Which way the depth buffer runs; `infinite` is reversed and has no far plane, yet the air ends at --far.
    #[arg(long, value_enum, default_value = "forward")]
    pub depth_range: DepthSpelling,
    /// Samples a pixel, 1 or 4.
    #[arg(long, value_name = "N", default_value = "1", value_parser = parse::samples)]
    pub samples: u32,
    /// Two eyes this far apart, metres: a picture of twice the width, the left eye's on the left.
    #[arg(long, value_name = "M", value_parser = parse::positive, allow_hyphen_values = true)]
    pub stereo: Option<f32>,
    /// Light: directional:AZ,EL (degrees, TOWARDS the light), spot:X,Y,Z,TX,TY,TZ,ANGLE[,INNER] or point:X,Y,Z.
    #[arg(long, value_name = "LIGHT", default_value = "directional:150,35", value_parser = parse::light)]
    pub light: LightSpelling,
    /// Linear RGB radiance of the light: irradiance of a surface that faces it, at one metre from a spot or point light
    /// [default: 12,10.5,8.4; of a spot or point light as much in the middle of the mesh].
    #[arg(long, value_name = "R,G,B", value_parser = parse::vector, allow_hyphen_values = true)]
    pub radiance: Option<Vec3>,
    /// Picture that colours a directional light or a spot, .png or .exr, over its whole shadow map.
    #[arg(long, value_name = "FILE")]
    pub light_texture: Option<PathBuf>,
    /// Shadow maps of a directional light fitted to 1 to 6 parts of the view, besides the one of the whole mesh.
    #[arg(long, value_name = "N", value_parser = parse::cascades, allow_hyphen_values = true)]
    pub cascades: Option<Cascades>,
    /// Extinction of the air, 1/m; 0 is a clear picture [default: optical depth 0.7 to the far plane].
    #[arg(long, value_name = "S", value_parser = parse::number, allow_hyphen_values = true)]
    pub extinction: Option<f32>,
    /// Single-scattering albedo, 0..1.
    #[arg(long, value_name = "A", default_value = "0.95", value_parser = parse::number, allow_hyphen_values = true)]
    pub albedo: f32,
    /// Mean cosine of the Henyey-Greenstein phase function, -0.999..0.999.
    #[arg(long, value_name = "G", default_value = "0.5", value_parser = parse::number, allow_hyphen_values = true)]
    pub g: f32,
    /// How visibility along a ray is found.
    #[arg(long, value_enum, default_value = "auto")]
    pub method: MethodSpelling,
    /// Bits of a depth for rank queries, 8 to 12, and wavelet matrices, 8, 10 or 12 [default: 12].
    #[arg(long, value_name = "B", value_parser = clap::value_parser!(u32).range(8..=12), allow_hyphen_values = true)]
    pub bits: Option<u32>,
    /// Which rows the shadow map is resampled along; those of --method wavelet are epipolar.
    #[arg(long, value_enum, default_value = "auto")]
    pub rectification: RectificationSpelling,
    /// Parts that the columns of projective rows are split into, 1 to 4 [default: 3].
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..=4), allow_hyphen_values = true)]
    pub splits: Option<u32>,
    /// Regions of a row that Fourier bases are filtered in, in parallel, 1 to 8.
    #[arg(long, value_name = "R", default_value = "1", value_parser = clap::value_parser!(u32).range(1..=8), allow_hyphen_values = true)]
    pub regions: u32,
    /// Where rays, and the air, begin [default: eye; near-plane for an orthographic camera].
    #[arg(long, value_enum)]
    pub start: Option<StartSpelling>,
    /// The ray whose weights all rays of an epipolar row share.
    #[arg(long, value_enum, default_value = "bisectrix")]
    pub reference: ReferenceSpelling,
    /// How many pixels are evaluated; the others are interpolated.
    #[arg(long, value_enum, default_value = "full")]
    pub resolution: ResolutionSpelling,
    /// Number of Fourier bases, a multiple of 4 from 4 to 128 [default: 32].
    #[arg(long, value_name = "M")]
    pub bases: Option<u32>,
    /// Plain average visibility instead of visibility weighted by transmittance.
    #[arg(long)]
    pub average: bool,
    /// Stores the filtered bases in 16 instead of 8 bits.
    #[arg(long)]
    pub half: bool,
    /// Steps a ray of the march.
    #[arg(long, value_name = "N", default_value = "512", value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub steps: u32,
    /// How the samples of the march are shifted from pixel to pixel.
    #[arg(long, value_enum, default_value = "none")]
    pub jitter: JitterSpelling,
    /// Number of the frame, which --jitter changes with [default: 0].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub frame: Option<u32>,
    /// Columns and rows of the rectified map.
    #[arg(long, value_name = "WxH", default_value = "1024x1024", value_parser = parse::size)]
    pub map: [u32; 2],
    /// Size of the standard shadow map, and of each cascade; the faces around a point light have half its side.
    #[arg(long, value_name = "WxH", default_value = "2048x2048", value_parser = parse::size)]
    pub shadow_map: [u32; 2],
    /// Size of the picture, or of each eye's.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse::size)]
    pub size: [u32; 2],
    /// Factor on the radiance before the tone curve of a .png.
    #[arg(long, value_name = "F", default_value = "1", value_parser = parse::number, allow_hyphen_values = true)]
    pub exposure: f32,
    /// Folder for every intermediate buffer as .npy.
    #[arg(long, value_name = "DIR")]
    pub buffers: Option<PathBuf>,
}

impl Options {
    /// True for a spot or a point light.
    pub fn local(&self) -> bool {
        !matches!(self.light, LightSpelling::Directional { .. })
    }

    /// Where rays begin.
    pub fn near_plane(&self) -> bool {
        self.camera == Projection::Orthographic || self.start == Some(StartSpelling::NearPlane)
    }

    /// The form of the light.
    pub fn form(&self) -> LightForm {
        let point = matches!(self.light, LightSpelling::Point { .. });
        LightForm {
            spot: matches!(self.light, LightSpelling::Spot { .. }),
            point,
            shadow_array: point || self.cascades.is_some(),
            texture: self.light_texture.is_some(),
        }
    }

    /// True where a flag says that there are Fourier bases.
    pub fn asks_for_bases(&self) -> bool {
        self.bases.is_some() || self.half || self.regions > 1
    }

    /// How visibility is prefiltered, unless it is marched.
    pub fn visibility(&self) -> Visibility {
        let rank = Visibility::Rank { bits: self.bits.unwrap_or(RANK_BITS) };
        match self.method {
            MethodSpelling::Fourier | MethodSpelling::March => Visibility::Fourier,
            MethodSpelling::Moments => Visibility::Moments,
            MethodSpelling::Rank => rank,
            MethodSpelling::Wavelet => Visibility::Wavelet { bits: self.bits.unwrap_or(RANK_BITS) },
            MethodSpelling::Auto => {
                let fits =
                    !self.asks_for_bases() && Visibility::automatic(self.map[0]) != Visibility::Fourier;
                if fits { rank } else { Visibility::Fourier }
            }
        }
    }

    /// Checks what the flags alone say. `framed`: more than jitter may change with --frame.
    ///
    /// # Errors
    /// Misuse: a value, or two flags that cannot be meant together.
    pub fn check(&self, framed: bool) -> Result<(), CommandError> {
        let refuse = |flag: &str, problem: String| Err(CommandError::misuse(flag, problem));
        let extension = self.out.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        if !matches!(extension.as_str(), "png" | "exr") {
            return refuse("--out", format!("`{}` must end in .png or .exr", self.out.display()));
        }
        if self.exposure <= 0.0 {
            return refuse("--exposure", format!("{} is impossible: it must be positive", self.exposure));
        }
        if let Some(radiance) = self.radiance {
            // Of a light at a point it is that of one metre, and halls are a hundred metres long.
            let (most, shown) = if self.local() { (1e8, "1e8") } else { (1e4, "1e4") };
            if radiance.min_element() < 0.0 || radiance.max_element() > most {
                return refuse("--radiance", format!("{radiance} is impossible: 0 to {shown} is possible"));
            }
        }
        conflicts::find(self, framed)
            .map_or(Ok(()), |conflict| refuse(conflict.flag, conflict.problem.to_owned()))
    }

    /// A directional light with one shadow map and no texture.
    pub fn plain(&self) -> bool {
        !self.local() && self.light_texture.is_none() && self.cascades.is_none()
    }
}
