// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a filter stores of every row, and the pass that does it: the part that methods differ in.

use super::{BasisFormat, Settings, SettingsError, Weighting};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, PassError, Resource};
use crate::resource::{Sampler, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use wgpu::{TextureFormat, TextureUsages};

/// How visibility is prefiltered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Visibility {
    /// Fourier bases: any light, any rows; edges as soft as the bases are few.
    #[default]
    Fourier,
    /// Six moments: the least memory of the soft ones; any light, any rows in one region.
    Moments,
    /// Rank queries: exact for depths of so many bits, 8 to 12; any light, any rows of at most 2048 columns in one region.
    Rank {
        /// Bits of a depth.
        bits: u32,
    },
    /// A wavelet matrix: exact as rank queries of the same 8, 10 or 12 bits, in about a fifth of their memory, for plain
    /// means ([`Weighting::Average`]) over the epipolar rows of a plain directional light only; more reads.
    Wavelet {
        /// Bits of a depth, an even number.
        bits: u32,
    },
}

impl Visibility {
    /// What is best for a map of `columns`: rank queries where they can be asked, else Fourier bases.
    pub fn automatic(columns: u32) -> Self {
        if columns <= RANK_COLUMNS { Self::Rank { bits: RANK_BITS } } else { Self::Fourier }
    }

    /// Its name at the command.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fourier => "fourier",
            Self::Moments => "moments",
            Self::Rank { .. } => "rank",
            Self::Wavelet { .. } => "wavelet",
        }
    }
}

/// Bits of a depth that suit most: an error next to nothing.
pub const RANK_BITS: u32 = 12;
/// Columns of the widest row that a rank structure takes.
pub const RANK_COLUMNS: u32 = 2048;

impl Settings {
    /// Checks that there is a filter for these settings.
    pub(super) fn validate_visibility(&self) -> Result<(), SettingsError> {
        if self.visibility == Visibility::Fourier {
            return Ok(());
        }
        let method = self.visibility.name();
        let wavelet = matches!(self.visibility, Visibility::Wavelet { .. });
        if wavelet && (self.light.colors().is_some() || self.light.local()) {
            return Err(SettingsError::Visibility { method, reason: "a plain directional light" });
        }
        if self.regions > 1 {
            return Err(SettingsError::Visibility { method, reason: "rows in one region" });
        }
        if let Visibility::Wavelet { bits } = self.visibility {
            if !matches!(bits, 8 | 10 | 12) {
                return Err(SettingsError::WaveletBits(bits));
            }
            if self.weighting != Weighting::Average {
                return Err(SettingsError::WaveletWeighting);
            }
        }
        if let Visibility::Rank { bits } | Visibility::Wavelet { bits } = self.visibility {
            if !(8..=12).contains(&bits) {
                return Err(SettingsError::RankBits(bits));
            }
            if self.map[0] > RANK_COLUMNS {
                return Err(SettingsError::Visibility { method, reason: "maps of at most 2048 columns" });
            }
        }
        Ok(())
    }

    /// What the callback `scattering/prefiltered` reads of the settings.
    pub(super) fn prefiltered_definitions(&self, definitions: Definitions) -> Definitions {
        match self.visibility {
            Visibility::Fourier => {
                // Below 8 bases the window widens the edge by more than the ringing that it takes away.
                let window = self.window && self.bases >= 8;
                let definitions = if window { definitions.flag("LANCZOS") } else { definitions };
                definitions.set("BASES", self.bases as i32)
            }
            Visibility::Moments => definitions.flag("MOMENTS"),
            Visibility::Wavelet { bits } => definitions.set("RANK", bits as i32).flag("WAVELET"),
            Visibility::Rank { bits } => {
                let definitions = definitions.set("RANK", bits as i32);
                self.weight_definitions(definitions, self.weight_bits(false))
            }
        }
    }

    /// Bits in which a rank structure stores the weights of columns, where these have weights of their own. Those of
    /// `projective` rows span far more than those of a light's fall-off.
    pub(super) fn weight_bits(&self, projective: bool) -> Option<u32> {
        match self.visibility {
            Visibility::Rank { .. } if projective => Some(16),
            Visibility::Rank { .. } if self.light.local() || self.light.texture => Some(8),
            _ => None,
        }
    }

    pub(super) fn weight_definitions(&self, definitions: Definitions, bits: Option<u32>) -> Definitions {
        match bits {
            Some(bits) => definitions.set("WEIGHT_BITS", bits as i32),
            None => definitions,
        }
    }

    /// What the callback `scattering/column_weights` reads of the settings.
    fn weighing_definitions(&self, definitions: Definitions, projective: bool) -> Definitions {
        let definitions = self.average(definitions);
        let definitions = if projective { definitions.flag("PROJECTIVE") } else { definitions };
        self.light.color_definitions(self.light.local_definitions(definitions))
    }

    fn average(&self, definitions: Definitions) -> Definitions {
        if self.weighting == Weighting::Average { definitions.flag("AVERAGE") } else { definitions }
    }
}

/// Layers of the weights of a rank structure: three of steps and sums, then the planes of the columns of each channel and
/// of the ranks of each colour.
fn weight_layers(colors: Option<u32>, weight_bits: u32) -> u32 {
    let channels = colors.map_or(1, |colors| colors + 1);
    3 + (channels + colors.unwrap_or(1)) * weight_bits / 4
}

/// The filter of a rectified map.
pub struct Prefilter {
    pass: Pass,
    sampler: Sampler,
    textures: Vec<(&'static str, Texture)>,
    threads: [u32; 3],
}

impl Prefilter {
    /// Builds the pass and the textures. `projective`: over projective rows.
    pub(super) fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        settings: &Settings,
        projective: bool,
    ) -> Result<Self, PassError> {
        let [width, height] = settings.map;
        let usage = TextureUsages::STORAGE_BINDING | TextureUsages::TEXTURE_BINDING;
        let flat = |size, format| Texture::storage(gpu, size, format);
        let compute = |pass, definitions| Pass::compute_with(gpu, shaders, pass, &definitions);
        let (pass, textures, threads) = match settings.visibility {
            Visibility::Fourier => {
                let definitions = settings.filter_definitions();
                let definitions = if projective { definitions.flag("PROJECTIVE") } else { definitions };
                let layers = settings.light.layers(settings.bases);
                let format = settings.format.texture_format();
                let chunks = settings.bases.div_ceil(settings.bases_per_thread.min(settings.bases));
                (
                    compute("scattering/filter", definitions)?,
                    vec![("bases", Texture::array(gpu, [width, height, layers], format, usage))],
                    [height, chunks, settings.regions],
                )
            }
            Visibility::Moments => {
                let definitions = settings.weighing_definitions(Definitions::new(), projective);
                let format = TextureFormat::Rgba32Uint;
                let moments = match settings.light.colors() {
                    Some(colors) => Texture::array(gpu, [width, height, colors + 1], format, usage),
                    None => flat([width, height], format),
                };
                (
                    compute("scattering/filter_moments", definitions)?,
                    vec![("moments", moments)],
                    [1, height, 1],
                )
            }
            Visibility::Rank { bits } => {
                let definitions = settings.average(Definitions::new()).set("RANK", bits as i32);
                let blocks = width.div_ceil(32);
                let planes = [blocks, height, bits.div_ceil(4)];
                let weight_bits = settings.weight_bits(projective);
                let three = settings.light.colors() == Some(3);
                let cells = if three { TextureFormat::Rgba32Uint } else { TextureFormat::Rg32Uint };
                let mut textures = vec![
                    ("rank_cells", flat([blocks * blocks, height], cells)),
                    ("rank_starts", flat([1 << (bits - 1), height], TextureFormat::R32Uint)),
                    ("rank_planes", Texture::array(gpu, planes, TextureFormat::Rgba32Uint, usage)),
                ];
                let pass = if let Some(weight_bits) = weight_bits {
                    let definitions = settings.weight_definitions(definitions, Some(weight_bits));
                    let definitions = settings.weighing_definitions(definitions, projective);
                    let layers = weight_layers(settings.light.colors(), weight_bits);
                    let size = [blocks, height, layers];
                    let weights = Texture::array(gpu, size, TextureFormat::Rgba32Uint, usage);
                    textures.push(("rank_weights", weights));
                    compute("scattering/rank_weights", definitions)?
                } else {
                    compute("scattering/rank", definitions)?
                };
                (pass, textures, [64 * height, 1, 1])
            }
            Visibility::Wavelet { bits } => {
                let size = [bits / 2 * width.div_ceil(32), height];
                (
                    compute("scattering/wavelet", Definitions::new().set("RANK", bits as i32))?,
                    vec![("wavelet", flat(size, TextureFormat::Rgba32Uint))],
                    [64 * height, 1, 1],
                )
            }
        };
        Ok(Self { pass, sampler: Sampler::rows(gpu), textures, threads })
    }

    /// What the filter writes and an evaluation reads, by name.
    pub(super) fn resources(&self) -> Vec<(&'static str, Resource<'_>)> {
        let textures = self.textures.iter().map(|(name, texture)| (*name, texture.into()));
        textures.chain([("bases_sampler", (&self.sampler).into())]).collect()
    }

    /// Binds the filter.
    pub(super) fn bind(&self, gpu: &Gpu, resources: &[(&str, Resource<'_>)]) -> Result<Bound, PassError> {
        self.pass.bind_known(gpu, resources)
    }

    /// Records the filter.
    pub(super) fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &Bound) {
        self.pass.dispatch(encoder, bound, self.threads);
    }

    /// The texture that the others go with: filtered bases, M/4 layers (with a fall-off those of each colour, and one of
    /// the mean fall-off), moments, cells, or the wavelet matrix.
    pub fn stored(&self) -> &Texture {
        &self.textures[0].1
    }

    /// All textures by the names of their bindings.
    pub fn textures(&self) -> &[(&'static str, Texture)] {
        &self.textures
    }

    /// Bytes of its textures.
    pub fn memory(&self) -> u64 {
        self.textures.iter().map(|(_, texture)| texture.memory()).sum()
    }
}

impl BasisFormat {
    pub(super) fn texture_format(self) -> TextureFormat {
        match self {
            Self::Rgba8Unorm => TextureFormat::Rgba8Unorm,
            Self::Rgba16Float => TextureFormat::Rgba16Float,
        }
    }
}
