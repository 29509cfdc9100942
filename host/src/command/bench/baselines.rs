// SPDX-License-Identifier: MIT OR Apache-2.0
//! The competitors of `airlight-tests` over the same rectified map, and what prefiltering gains on them.

use super::scattering::{SIZE, Truth, run, stage};
use super::{Quality, Row, Work, figure, interleaved, ratio, time};
use crate::command::{CommandError, progress};
use crate::pass::{Bound, Pass, PassError, Resource};
use crate::scattering::{
    BasisFormat, Inputs, Prefiltered, Rectification, Settings, Weighting, epipole_near_picture,
};
use crate::{Gpu, Shaders, Texture};
use airlight_tests::baselines::{self, minmax};
use airlight_tests::error;
use airlight_validate::Definitions;
use wgpu::TextureFormat;

const SYSTEM: &str = "scattering";

/// A competitor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Competitor {
    /// Min-max mipmaps along rows, eight children a node: exact.
    MinMax,
    /// Min-max mipmaps along rows as published, two children a node: exact.
    BinaryMinMax,
    /// A variance shadow map prefiltered along rows.
    Variance,
    /// An exponential variance shadow map prefiltered along rows.
    ExponentialVariance,
}

impl Competitor {
    /// Every competitor.
    pub const ALL: [Self; 4] = [Self::MinMax, Self::BinaryMinMax, Self::Variance, Self::ExponentialVariance];

    /// Its name in the benchmark's rows.
    pub fn name(self) -> &'static str {
        match self {
            Self::MinMax => "minmax",
            Self::BinaryMinMax => "minmax_binary",
            Self::Variance => "variance",
            Self::ExponentialVariance => "exponential_variance",
        }
    }

    /// Names of the pass that builds and of the one that evaluates, and their definitions.
    fn passes(self) -> (&'static str, &'static str, Definitions) {
        let none = Definitions::new();
        match self {
            Self::MinMax => ("baselines/minmax_build", "baselines/minmax", none),
            Self::BinaryMinMax => ("baselines/minmax_binary_build", "baselines/minmax_binary", none),
            Self::Variance => ("baselines/variance_filter", "baselines/variance", none),
            Self::ExponentialVariance => {
                ("baselines/variance_filter", "baselines/variance", none.flag("EXPONENTIAL"))
            }
        }
    }

    /// Size and format of what the one pass builds for the other from a map of so many columns and rows.
    fn texture(self, map: [u32; 2]) -> ([u32; 2], TextureFormat) {
        match self {
            Self::MinMax => (minmax::size(map), TextureFormat::Rgba32Uint),
            Self::BinaryMinMax => (minmax::binary_size(map), TextureFormat::Rg32Float),
            Self::Variance => (map, TextureFormat::Rg32Float),
            Self::ExponentialVariance => (map, TextureFormat::Rgba32Float),
        }
    }

    /// Invocations of the pass that builds.
    fn threads(self, [columns, rows]: [u32; 2]) -> [u32; 3] {
        match self {
            Self::MinMax => [rows, columns.div_ceil(minmax::GROUP_COLUMNS), 1],
            Self::BinaryMinMax => [columns.div_ceil(minmax::BINARY_COLUMNS), rows, 1],
            Self::Variance | Self::ExponentialVariance => [rows, 1, 1],
        }
    }
}

/// The shaders with the competitors' passes among them.
pub fn with_baselines(shaders: &Shaders) -> Shaders {
    let library = baselines::PASSES.iter().fold(shaders.library().clone(), |library, pass| {
        library.with_pass(baselines::SYSTEM, pass.name, pass.text)
    });
    Shaders::from_library(library)
}

/// A competitor over a rectified map, ready to run.
pub struct Baseline {
    build: Pass,
    evaluate: Pass,
    bound: [Bound; 2],
    threads: [u32; 3],
    built: Texture,
    /// Radiance, and average visibility in alpha, rgba16float.
    pub scattered: Texture,
}

impl Baseline {
    /// Builds the passes and binds them to `inputs` and `map`; `shaders` are of [`with_baselines`].
    ///
    /// # Errors
    /// [`PassError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        competitor: Competitor,
        inputs: &Inputs<'_>,
        map: &Rectification,
        viewport: [u32; 2],
    ) -> Result<Self, PassError> {
        let (build, evaluate, definitions) = competitor.passes();
        let build = Pass::compute_with(gpu, shaders, build, &definitions)?;
        let format = TextureFormat::Rgba16Float;
        let evaluate = Pass::picture(gpu, shaders, evaluate, &definitions, "fragment_evaluate", format)?;
        let [columns, rows, _] = map.rectified.size();
        let (size, built_format) = competitor.texture([columns, rows]);
        let built = Texture::storage(gpu, size, built_format);
        let resources: [(&str, Resource<'_>); 9] = [
            ("camera", inputs.camera.into()),
            ("light", inputs.light.into()),
            ("medium", inputs.medium.into()),
            ("depth", inputs.depth.into()),
            ("frame", (&map.frame).into()),
            ("slices", (&map.slices).into()),
            ("rectified", (&map.rectified).into()),
            ("nodes", (&built).into()),
            ("moments", (&built).into()),
        ];
        let bound = [build.bind_known(gpu, &resources)?, evaluate.bind_known(gpu, &resources)?];
        Ok(Self {
            build,
            evaluate,
            bound,
            threads: competitor.threads([columns, rows]),
            built,
            scattered: Texture::target(gpu, viewport, format),
        })
    }

    /// Records both passes.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.record_build(encoder);
        self.record_evaluation(encoder);
    }

    /// Records what is built from the rectified map.
    pub fn record_build(&self, encoder: &mut wgpu::CommandEncoder) {
        self.build.dispatch(encoder, &self.bound[0], self.threads);
    }

    /// Records the evaluation of every pixel.
    pub fn record_evaluation(&self, encoder: &mut wgpu::CommandEncoder) {
        self.evaluate.fill(encoder, &self.bound[1], &self.scattered);
    }

    /// Bytes of what is built from the rectified map.
    pub fn memory(&self) -> u64 {
        self.built.memory()
    }
}

/// The light that a competitor scatters into a picture of `viewport` pixels: radiance, and average visibility
/// in alpha. `shaders` are the shipped ones.
///
/// # Errors
/// [`CommandError`].
pub fn scattered(
    gpu: &Gpu,
    shaders: &Shaders,
    competitor: Competitor,
    inputs: &Inputs<'_>,
    map: &Rectification,
    viewport: [u32; 2],
) -> Result<Texture, CommandError> {
    let baseline = Baseline::new(gpu, &with_baselines(shaders), competitor, inputs, map, viewport)?;
    let mut encoder = gpu.encoder();
    baseline.record(&mut encoder);
    gpu.submit(encoder)?;
    Ok(baseline.scattered)
}

/// Every figure against the competitors.
pub(super) fn rows(gpu: &Gpu, shaders: &Shaders, quiet: bool) -> Result<Vec<Row>, CommandError> {
    let shaders = with_baselines(shaders);
    let bar = progress::bar(4, quiet);
    let mut rows = Vec::new();
    for name in ["foliage", "terrain"] {
        bar.set_message(format!("min-max mipmaps over prefiltered, {name} 1920x1080"));
        rows.extend(minmax_over_prefiltered(gpu, &shaders, name)?);
        bar.inc(1);
    }
    for name in ["foliage", "plane"] {
        bar.set_message(format!("variance shadow maps, {name}"));
        rows.extend(statistical(gpu, &shaders, name)?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(rows)
}

const VISIBILITY: &str = "mean absolute error of visibility";

/// Cost of min-max mipmaps over that of everything that prefiltering does, rectification counted in on both sides.
fn minmax_over_prefiltered(gpu: &Gpu, shaders: &Shaders, name: &str) -> Result<Vec<Row>, CommandError> {
    let (_, stage) = stage(gpu, shaders, name, SIZE)?;
    let epipole_march = epipole_near_picture(&stage.camera, stage.light.direction);
    let settings = Settings { weighting: Weighting::Average, epipole_march, ..Settings::tuned(gpu) };
    let prefiltered = Prefiltered::new(gpu, shaders, settings, SIZE)?;
    let bound = prefiltered.bind(gpu, &stage.inputs())?;
    let map = &prefiltered.rectification;
    let new = |competitor| Baseline::new(gpu, shaders, competitor, &stage.inputs(), map, SIZE);
    let minmax = new(Competitor::MinMax)?;
    let binary = new(Competitor::BinaryMinMax)?;
    let whole = |baseline: &Baseline, encoder: &mut wgpu::CommandEncoder| {
        prefiltered.record_rectification(encoder, &bound);
        baseline.record(encoder);
    };
    let samples = interleaved(
        gpu,
        &[
            &|encoder| prefiltered.record(encoder, &bound),
            &|encoder| whole(&minmax, encoder),
            &|encoder| whole(&binary, encoder),
            &|encoder| minmax.record_build(encoder),
            &|encoder| minmax.record_evaluation(encoder),
        ],
        7,
    )?;
    let truth = Truth::new(gpu, &stage, &map.rectified)?;
    let exact = truth.rectified.average();
    let error = |texture: &Texture| {
        truth.visibility(gpu, texture).map(|values| error::mean_absolute(&values, &exact))
    };
    let own = error(&prefiltered.scattered)?;
    let mut rows = Vec::new();
    for (competitor, baseline, list) in
        [(Competitor::MinMax, &minmax, &samples[1]), (Competitor::BinaryMinMax, &binary, &samples[2])]
    {
        let quality = Quality { metric: VISIBILITY, error: own, baseline_error: error(&baseline.scattered)? };
        let row = format!("{}_over_prefiltered_{name}", competitor.name());
        rows.push(ratio(SYSTEM, row, list, &samples[0], "higher", Some(quality)));
    }
    rows.push(time(SYSTEM, format!("minmax_build_{name}"), samples[3].clone()));
    rows.push(time(SYSTEM, format!("minmax_traversal_{name}"), samples[4].clone()));
    rows.push(figure(SYSTEM, format!("minmax_memory_{name}"), minmax.memory() as f64 / 1e6, "MB"));
    Ok(rows)
}

/// Error of variance shadow maps against the exact answer over the same map, and their cost over that of prefiltering.
fn statistical(gpu: &Gpu, shaders: &Shaders, name: &str) -> Result<Vec<Row>, CommandError> {
    let size = [960, 540];
    let (_, stage) = stage(gpu, shaders, name, size)?;
    // The march around the epipole reads another map than the truth does: it is left out.
    let settings = Settings {
        format: BasisFormat::Rgba8Unorm,
        weighting: Weighting::Average,
        epipole_march: false,
        ..Settings::tuned(gpu)
    };
    let prefiltered = Prefiltered::new(gpu, shaders, settings, size)?;
    let bound = prefiltered.bind(gpu, &stage.inputs())?;
    run(gpu, &|encoder| prefiltered.record(encoder, &bound))?;
    let map = &prefiltered.rectification;
    let truth = Truth::new(gpu, &stage, &map.rectified)?;
    let exact = truth.rectified.average();
    let error = |texture: &Texture| {
        truth.visibility(gpu, texture).map(|values| error::mean_absolute(&values, &exact))
    };
    let own = error(&prefiltered.scattered)?;
    let mut rows = Vec::new();
    for competitor in [Competitor::Variance, Competitor::ExponentialVariance] {
        let baseline = Baseline::new(gpu, shaders, competitor, &stage.inputs(), map, size)?;
        let whole: Work<'_> = &|encoder| {
            prefiltered.record_rectification(encoder, &bound);
            baseline.record(encoder);
        };
        let samples = interleaved(gpu, &[&|encoder| prefiltered.record(encoder, &bound), whole], 5)?;
        let baseline_error = error(&baseline.scattered)?;
        let quality = Quality { metric: VISIBILITY, error: own, baseline_error };
        let competitor = competitor.name();
        rows.push(figure(
            SYSTEM,
            format!("{competitor}_visibility_error_{name}"),
            baseline_error,
            "fraction",
        ));
        rows.push(ratio(
            SYSTEM,
            format!("{competitor}_over_prefiltered_{name}"),
            &samples[1],
            &samples[0],
            "higher",
            Some(quality),
        ));
    }
    Ok(rows)
}
