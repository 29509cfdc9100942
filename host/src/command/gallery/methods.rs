// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every method on one scene: series of all lengths, what others do, and what a march does in the same time.

use super::album::{Album, Section};
use super::plates;
use super::studio::{AMPLIFIED, Studio, parameters};
use crate::command::CommandError;
use crate::command::bench::baselines::{Baseline, Competitor, with_baselines};
use crate::core::Jitter;
use crate::scattering::{Along, March, Prefiltered, Rectification, Settings, Visibility, Weighting};
use crate::{Stage, Texture};

/// Methods side by side.
const COLUMNS: usize = 4;
/// Bases without a window, and with one: below 8 there is none.
const SERIES: [(u32, bool); 8] =
    [(4, false), (8, false), (16, false), (32, false), (8, true), (16, true), (32, true), (64, true)];
/// The other ways to prefilter visibility.
const OTHERS: [(Visibility, &str); 4] = [
    (Visibility::Moments, "6 moments"),
    (Visibility::Rank { bits: 8 }, "Rank queries of 8 bits"),
    (Visibility::Rank { bits: 10 }, "Rank queries of 10 bits"),
    (Visibility::Rank { bits: 12 }, "Rank queries of 12 bits"),
];
/// Steps at which a march is timed to find how many fit into a given time.
const TIMED_STEPS: [u32; 2] = [16, 128];

/// A method's picture.
struct Entry {
    file: String,
    caption: String,
    scattered: Texture,
    /// Milliseconds of all that it takes from the shadow map on.
    time: f64,
}

/// Methods that go along the rows of the same rectified map.
struct Rows<'a> {
    studio: &'a Studio,
    stage: &'a Stage,
    map: &'a Rectification,
    /// Milliseconds that the map takes.
    time: f64,
}

/// The section of a scene. Visibility is the plain mean here, since that is what the competitors have.
pub fn section(studio: &Studio, folder: &str, name: &str) -> Result<Section, CommandError> {
    let (scene, stage) = studio.scene(name)?;
    // The march around the epipole reads another map than the reference does.
    let settings = Settings { weighting: Weighting::Average, epipole_march: false, ..studio.settings() };
    let own = Prefiltered::new(&studio.gpu, &studio.shaders, settings, studio.size)?;
    let bound = own.bind(&studio.gpu, &stage.inputs())?;
    let budget = studio.time(&|encoder| own.record(encoder, &bound))?;
    let time = studio.time(&|encoder| own.record_rectification(encoder, &bound))?;
    let rows = Rows { studio, stage: &stage, map: &own.rectification, time };

    let mut entries = Vec::new();
    for (bases, window) in SERIES {
        let caption = format!("{bases} bases{}", if window { " with a window" } else { "" });
        entries.push(series(studio, &stage, &caption, Settings { bases, window, ..settings })?);
    }
    let reference = rows.march(&Along::Rows(rows.map), Jitter::None, "reference")?;
    let exact = reference.scattered.read(&studio.gpu)?;
    entries.push(Entry { caption: "March of one step a texel: the reference".to_owned(), ..reference });
    for (visibility, caption) in OTHERS {
        entries.push(series(studio, &stage, caption, Settings { visibility, ..settings })?);
    }
    entries.extend(rows.competitors()?);
    entries.extend(rows.same_time(budget, settings.map[0])?);
    let caption = format!("{} bases with a window, in that time", settings.bases);
    entries.push(Entry {
        file: "same_time_fourier".to_owned(),
        caption,
        scattered: own.scattered,
        time: budget,
    });

    let title = format!("Methods: {}", scene.title);
    let about = format!(
        "Scattered light by plain means of visibility, above its difference to the reference, times {AMPLIFIED}. \
         Errors are means of the absolute difference of visibility; times hold for all from the shadow map on. {}",
        parameters(&scene)
    );
    let mut album = Album::new(&studio.out, folder, title, about)?;
    for row in entries.chunks(COLUMNS) {
        let mut below = Vec::new();
        for Entry { file, caption, scattered, time } in row {
            let error = mean_error(&scattered.read(&studio.gpu)?, &exact);
            let figures = format!("error {error:.4}, {time:.0} ms");
            let pixels = studio.pixels(scattered, scene.exposure)?;
            album.add_tile(format!("{file}.png"), format!("{caption}: {figures}"), studio.size, &pixels)?;
            let difference = plates::difference(&studio.gpu, scattered, &exact, AMPLIFIED)?;
            below.push((format!("{file}_error.png"), studio.pixels(&difference, scene.exposure)?));
            album.fact(caption.as_str(), figures);
        }
        for (file, pixels) in below {
            album.add_tile(file, format!("Its error, times {AMPLIFIED}"), studio.size, &pixels)?;
        }
    }
    album.finish_with_sheet(COLUMNS as u32, "All of them, in the order of the pictures below")
}

/// A way to prefilter visibility.
fn series(studio: &Studio, stage: &Stage, caption: &str, settings: Settings) -> Result<Entry, CommandError> {
    let prefiltered = Prefiltered::new(&studio.gpu, &studio.shaders, settings, studio.size)?;
    let bound = prefiltered.bind(&studio.gpu, &stage.inputs())?;
    let time = studio.time(&|encoder| prefiltered.record(encoder, &bound))?;
    let Settings { bases, window, visibility, .. } = settings;
    let file = match visibility {
        Visibility::Fourier if window => format!("fourier_{bases}_window"),
        Visibility::Fourier => format!("fourier_{bases}"),
        Visibility::Moments => "moments".to_owned(),
        Visibility::Rank { bits } => format!("rank_{bits}"),
        Visibility::Wavelet { bits } => format!("wavelet_{bits}"),
    };
    Ok(Entry { file, caption: caption.to_owned(), scattered: prefiltered.scattered, time })
}

impl Rows<'_> {
    fn march(&self, along: &Along<'_>, jitter: Jitter, file: &str) -> Result<Entry, CommandError> {
        let Self { studio, stage, time, .. } = self;
        let weighting = Weighting::Average;
        let march = March::jittered(&studio.gpu, &studio.shaders, along, weighting, jitter, studio.size)?;
        let bound = march.bind(&studio.gpu, &stage.inputs(), along)?;
        let time = time + studio.time(&|encoder| march.record(encoder, &bound))?;
        Ok(Entry { file: file.to_owned(), caption: String::new(), scattered: march.scattered, time })
    }

    fn competitors(&self) -> Result<Vec<Entry>, CommandError> {
        let Self { studio, stage, map, time } = self;
        let shaders = with_baselines(&studio.shaders);
        let competitors = [
            (Competitor::MinMax, "min_max", "Min-max mipmaps"),
            (Competitor::Variance, "variance", "Variance shadow map"),
            (Competitor::ExponentialVariance, "exponential_variance", "Exponential variance shadow map"),
        ];
        let entry = |(competitor, file, caption): (_, &str, &str)| {
            let baseline =
                Baseline::new(&studio.gpu, &shaders, competitor, &stage.inputs(), map, studio.size)?;
            let time = time + studio.time(&|encoder| baseline.record(encoder))?;
            let (file, caption) = (file.to_owned(), caption.to_owned());
            Ok(Entry { file, caption, scattered: baseline.scattered, time })
        };
        competitors.into_iter().map(entry).collect()
    }

    /// Marches with as many steps as fit into `budget` milliseconds, at most `most`.
    fn same_time(&self, budget: f64, most: u32) -> Result<Vec<Entry>, CommandError> {
        let march = |steps, jitter, file| self.march(&Along::RowSteps { map: self.map, steps }, jitter, file);
        // A straight line through two times, corrected once.
        let [few, many] = TIMED_STEPS;
        let few_time = march(few, Jitter::None, "")?.time;
        let step_time = ((march(many, Jitter::None, "")?.time - few_time) / f64::from(many - few)).max(1e-6);
        let clamped = |steps: f64| steps.clamp(1.0, f64::from(most));
        let guess = clamped(f64::from(few) + (budget - few_time) / step_time);
        let over = march(guess as u32, Jitter::None, "")?.time - budget;
        let steps = clamped(guess - over * guess / (over + budget - self.time).max(1e-6)) as u32;
        let kinds = [
            (Jitter::None, "same_time", "March of"),
            (Jitter::Gradient, "same_time_gradient", "With gradient jitter,"),
            (Jitter::BlueNoise, "same_time_blue_noise", "With blue noise,"),
        ];
        let entry = |(jitter, file, what)| {
            let caption = format!("{what} {steps} steps, about the time of 32 bases");
            Ok(Entry { caption, ..march(steps, jitter, file)? })
        };
        kinds.into_iter().map(entry).collect()
    }
}

/// Mean absolute difference of visibility, which lies in alpha.
fn mean_error(values: &[f32], exact: &[f32]) -> f64 {
    let visibility = |values: &[f32]| -> Vec<f64> {
        values.iter().skip(3).step_by(4).map(|value| f64::from(*value)).collect()
    };
    let (values, exact) = (visibility(values), visibility(exact));
    let sum: f64 = values.iter().zip(&exact).map(|(a, b)| (a - b).abs()).sum();
    sum / values.len().max(1) as f64
}
