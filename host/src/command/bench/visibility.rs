// SPDX-License-Identifier: MIT OR Apache-2.0
//! The four ways to prefilter visibility: cost, memory and error of each over the same rectified map.

use super::scattering::{SIZE, SYSTEM, Truth, VISIBILITY, run, stage};
use super::{Quality, Row, Work, figure, interleaved, ratio, time};
use crate::command::CommandError;
use crate::scattering::{
    Along, BasisFormat, Filtering, March, Prefiltered, PrefilteredBound, Settings, Visibility, Weighting,
};
use crate::{Gpu, Shaders, Stage};
use airlight_tests::error;

/// All filtered along rows and across them; the march around the epipole reads another map than the truth does.
fn settings(gpu: &Gpu, visibility: Visibility, weighting: Weighting) -> Settings {
    Settings {
        visibility,
        weighting,
        filtering: Filtering::Linear,
        format: BasisFormat::Rgba8Unorm,
        epipole_march: false,
        ..Settings::tuned(gpu)
    }
}

/// A method, bound.
struct Contestant {
    name: &'static str,
    method: Prefiltered,
    bound: PrefilteredBound,
}

impl Contestant {
    fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        stage: &Stage,
        (name, visibility, weighting): (&'static str, Visibility, Weighting),
        size: [u32; 2],
    ) -> Result<Self, CommandError> {
        let method = Prefiltered::new(gpu, shaders, settings(gpu, visibility, weighting), size)?;
        let bound = method.bind(gpu, &stage.inputs())?;
        run(gpu, &|encoder| method.record(encoder, &bound))?;
        Ok(Self { name, method, bound })
    }

    fn build(&self, encoder: &mut wgpu::CommandEncoder) {
        self.method.record_filter(encoder, &self.bound);
    }

    fn evaluate(&self, encoder: &mut wgpu::CommandEncoder) {
        self.method.record_evaluation(encoder, &self.bound);
    }

    /// What methods differ in: the rectified map is the same for all.
    fn both(&self, encoder: &mut wgpu::CommandEncoder) {
        self.build(encoder);
        self.evaluate(encoder);
    }

    fn memory(&self) -> f64 {
        self.method.prefilter.memory() as f64
    }
}

const AVERAGE: [(&str, Visibility, Weighting); 6] = [
    ("fourier", Visibility::Fourier, Weighting::Average),
    ("rank10", Visibility::Rank { bits: 10 }, Weighting::Average),
    ("rank12", Visibility::Rank { bits: 12 }, Weighting::Average),
    ("moments", Visibility::Moments, Weighting::Average),
    ("rank12_weighted", Visibility::Rank { bits: 12 }, Weighting::Transmittance),
    ("wavelet12", Visibility::Wavelet { bits: 12 }, Weighting::Average),
];

/// Every figure of the methods.
pub fn rows(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let mut rows = costs(gpu, shaders)?;
    for name in ["foliage", "plane", "torus", "terrain"] {
        rows.extend(errors(gpu, shaders, name)?);
    }
    Ok(rows)
}

/// Cost of building and evaluating, and memory.
fn costs(gpu: &Gpu, shaders: &Shaders) -> Result<Vec<Row>, CommandError> {
    let (_, stage) = stage(gpu, shaders, "foliage", SIZE)?;
    let all = AVERAGE.iter().map(|kind| Contestant::new(gpu, shaders, &stage, *kind, SIZE));
    let all = all.collect::<Result<Vec<_>, _>>()?;
    let [fourier, rank10, rank12, moments, _, wavelet] = &all[..] else {
        return Err(CommandError::failure("six methods are compared"));
    };
    let map = &fourier.method.rectification;
    let along = Along::RowSteps { map, steps: map.rectified.size()[0] };
    let march = March::new(gpu, shaders, &along, Weighting::Average, SIZE)?;
    let march_bound = march.bind(gpu, &stage.inputs(), &along)?;
    let truth = Truth::new(gpu, &stage, &map.rectified)?;
    let exact = truth.rectified.average();
    let error = |texture: &crate::Texture| {
        truth.visibility(gpu, texture).map(|values| error::mean_absolute(&values, &exact))
    };

    let both: Vec<_> =
        all.iter().map(|one| move |encoder: &mut wgpu::CommandEncoder| one.both(encoder)).collect();
    let mut works: Vec<Work<'_>> = both.iter().map(|work| work as Work<'_>).collect();
    let marched = |encoder: &mut wgpu::CommandEncoder| march.record(encoder, &march_bound);
    works.push(&marched);
    let samples = interleaved(gpu, &works, 7)?;
    let [f, r10, r12, m, w, smallest, marching] = &samples[..] else {
        return Err(CommandError::failure("seven pieces of work are timed"));
    };
    let quality = |own: &Contestant, baseline: &crate::Texture| -> Result<_, CommandError> {
        let (error, baseline_error) = (error(&own.method.scattered)?, error(baseline)?);
        Ok(Some(Quality { metric: VISIBILITY, error, baseline_error }))
    };
    let lower =
        |name: &str, over: &[f64], under: &[f64], quality| ratio(SYSTEM, name, over, under, "lower", quality);
    let against_fourier = |own| quality(own, &fourier.method.scattered);
    let march_quality = quality(rank10, &march.scattered)?;
    let memory =
        |name: &str, own: &Contestant| figure(SYSTEM, name, own.memory() / fourier.memory(), "ratio");
    let mut rows = vec![
        lower("exact_over_fourier_cost", r10, f, against_fourier(rank10)?),
        ratio(SYSTEM, "march_over_exact", marching, r10, "higher", march_quality),
        memory("exact_over_fourier_memory", rank10),
        lower("exact12_over_fourier_cost", r12, f, against_fourier(rank12)?),
        memory("exact12_over_fourier_memory", rank12),
        lower("exact12_weighted_over_average_cost", w, r12, None),
        lower("smallest_exact_over_fourier_cost", smallest, f, against_fourier(wavelet)?),
        memory("smallest_exact_over_fourier_memory", wavelet),
        lower("moments_over_fourier_cost", m, f, against_fourier(moments)?),
        memory("moments_over_fourier_memory", moments),
    ];
    for one in &all {
        let samples =
            interleaved(gpu, &[&|encoder| one.build(encoder), &|encoder| one.evaluate(encoder)], 5)?;
        rows.push(time(SYSTEM, format!("{}_build", one.name), samples[0].clone()));
        rows.push(time(SYSTEM, format!("{}_evaluation", one.name), samples[1].clone()));
    }
    Ok(rows)
}

/// Mean and greatest error of visibility of every method, plain and weighted by transmittance.
fn errors(gpu: &Gpu, shaders: &Shaders, scene: &str) -> Result<Vec<Row>, CommandError> {
    let size = [960, 540];
    let (_, stage) = stage(gpu, shaders, scene, size)?;
    let mut rows = Vec::new();
    for (name, visibility, _) in &AVERAGE[..4] {
        for (kind, weighting) in [("", Weighting::Average), ("_weighted", Weighting::Transmittance)] {
            let one = Contestant::new(gpu, shaders, &stage, (name, *visibility, weighting), size)?;
            let truth = Truth::new(gpu, &stage, &one.method.rectification.rectified)?;
            let exact = match weighting {
                Weighting::Average => truth.rectified.average(),
                Weighting::Transmittance => truth.rectified.weighted(),
            };
            let values = truth.visibility(gpu, &one.method.scattered)?;
            let greatest =
                values.iter().zip(&exact).map(|(a, b)| (f64::from(*a) - b).abs()).fold(0.0, f64::max);
            let mean = error::mean_absolute(&values, &exact);
            rows.push(figure(SYSTEM, format!("{name}{kind}_error_{scene}"), mean, "fraction"));
            rows.push(figure(SYSTEM, format!("{name}{kind}_greatest_error_{scene}"), greatest, "fraction"));
        }
    }
    Ok(rows)
}
