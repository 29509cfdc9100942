// SPDX-License-Identifier: MIT OR Apache-2.0
//! The competitors: that each is what its name says, and how good it is next to prefiltered bases.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "support/competitors.rs"]
mod competitors;
#[path = "support/gpu.rs"]
mod gpu;

use airlight::command::baselines::{Baseline, Competitor};
use airlight::scattering::{Along, March, Prefiltered, Rectification, Settings, Weighting};
use airlight::{Stage, scenes};
use airlight_tests::baselines::variance;
use airlight_tests::error;
use airlight_tests::reference::scattering as reference;
use competitors::shaders;
use gpu::{Random, gpu};

/// Size of the pictures.
const PICTURE: [u32; 2] = [480, 270];
/// Step of a half float next to 1: this adapter rounds towards zero.
const HALF: f64 = 1.0 / 2048.0;

/// A scene of the gallery with a rectified map.
struct Case {
    stage: Stage,
    view: airlight::core::PerspectiveView,
    map: Rectification,
}

/// Exact and approximate answers of one pixel, in f64 over the nearest row.
struct Pixel {
    /// Average visibility, the last column in part.
    exact: f64,
    /// Average visibility of the whole columns that a look-up stands for.
    whole: f64,
    variance: f64,
    exponential: f64,
}

impl Case {
    fn new(name: &str, map: [u32; 2]) -> Self {
        let scene = scenes::scene(name).unwrap().unwrap();
        let view = scene.setting().view.perspective().unwrap();
        let stage = Stage::new(gpu(), gpu::raster(), &scene.setting(), PICTURE, [1024, 1024]).unwrap();
        let map = Rectification::new(gpu(), shaders(), map).unwrap();
        let bound = map.bind(gpu(), &stage.inputs()).unwrap();
        let mut encoder = gpu().encoder();
        map.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        Self { stage, view, map }
    }

    /// Average visibility by a competitor.
    fn visibility(&self, competitor: Competitor) -> Vec<f32> {
        let inputs = self.stage.inputs();
        let baseline = Baseline::new(gpu(), shaders(), competitor, &inputs, &self.map, PICTURE).unwrap();
        let mut encoder = gpu().encoder();
        baseline.record(&mut encoder);
        gpu().submit(encoder).unwrap();
        alpha(&baseline.scattered.read(gpu()).unwrap())
    }

    /// What `of` says of each pixel's nearest row and its ray's end there.
    fn pixels<T: Send>(&self, of: impl Fn(&[f32], reference::RowEnd) -> T + Sync) -> Vec<T> {
        let [width, height] = PICTURE.map(|side| side as usize);
        let camera = gpu::reference_camera(&self.view, PICTURE);
        let limit = self.stage.medium.distance_limit;
        let rectification = gpu::read_back(&camera, self.stage.light.direction, limit, &self.map);
        let depth = self.stage.pictures.depth.read(gpu()).unwrap();
        let map = self.map.rectified.read(gpu()).unwrap();
        let scene = reference::Scene {
            camera: &camera,
            light: gpu::reference_light(&self.stage.light),
            medium: gpu::reference_medium(&self.stage.medium),
            depth: &depth,
            width,
            height,
        };
        let rows = airlight_tests::parallel::rows(height, |y| {
            (0..width)
                .map(|x| {
                    let (direction, distance) = scene.view_ray(x, y);
                    let azimuth = rectification.frame.polar_direction(direction).phi;
                    let (first, second, share) = rectification.rows(azimuth);
                    let j = if share >= 0.5 { second } else { first };
                    let row = &map[j * rectification.width..(j + 1) * rectification.width];
                    of(row, rectification.row_end(j, direction, distance, 0.0))
                })
                .collect::<Vec<_>>()
        });
        rows.into_iter().flatten().collect()
    }

    fn exact(&self) -> Vec<f64> {
        self.pixels(|row, end| reference::row_visibility(row, end).average)
    }

    fn statistics(&self) -> Vec<Pixel> {
        self.pixels(|row, end| {
            let count = ((end.s + 0.5) as usize).clamp(1, row.len());
            let covered = &row[..count];
            Pixel {
                exact: reference::row_visibility(row, end).average,
                whole: reference::row_visibility(row, reference::RowEnd { s: count as f64, ..end }).average,
                variance: variance::variance_visibility(covered, end.z),
                exponential: variance::exponential_variance_visibility(covered, end.z),
            }
        })
    }

    fn marched(&self) -> Vec<f32> {
        let along = Along::Rows(&self.map);
        let method = March::new(gpu(), shaders(), &along, Weighting::Average, PICTURE).unwrap();
        let bound = method.bind(gpu(), &self.stage.inputs(), &along).unwrap();
        let mut encoder = gpu().encoder();
        method.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        alpha(&method.scattered.read(gpu()).unwrap())
    }

    fn prefiltered(&self, settings: Settings) -> Vec<f32> {
        let method = Prefiltered::new(gpu(), shaders(), settings, PICTURE).unwrap();
        let bound = method.bind(gpu(), &self.stage.inputs()).unwrap();
        let mut encoder = gpu().encoder();
        method.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        alpha(&method.scattered.read(gpu()).unwrap())
    }
}

fn alpha(values: &[f32]) -> Vec<f32> {
    values.chunks_exact(4).map(|texel| texel[3]).collect()
}

/// Both forms of min-max mipmaps against the exact sum over the nearest row, and against the march, whose pixels
/// they share to the bit.
fn assert_exact(name: &str, case: &Case) {
    let expected = case.exact();
    let marched = case.marched();
    for competitor in [Competitor::MinMax, Competitor::BinaryMinMax] {
        let found = case.visibility(competitor);
        let mean = error::mean_absolute(&found, &expected);
        // Where the stored depth is the ray's own to within f32, one column more or less; another row where two are as near.
        let off = found.iter().zip(&expected).filter(|(f, e)| (f64::from(**f) - **e).abs() > 2e-3).count();
        let share = off as f64 / found.len() as f64;
        println!(
            "{} {name}: mean {mean:.2e}, {:.2} % off by more than 2e-3, {}",
            competitor.name(),
            100.0 * share,
            error::worst(&found, &expected, PICTURE[0] as usize).unwrap()
        );
        assert!(mean < 4e-4 && share < 0.005, "{} {name}", competitor.name());
        let march = error::max_absolute(&found, &marched);
        assert!(march <= HALF, "{} {name}: {march:.1e} from the march", competitor.name());
    }
}

#[test]
fn minmax_mipmaps_are_exact_whatever_the_width() {
    assert_exact("foliage 512", &Case::new("foliage", [512, 512]));
    assert_exact("foliage 1024", &Case::new("foliage", [1024, 300]));
    assert_exact("terrain 700", &Case::new("terrain", [700, 257]));
    for width in [1, 7, 65, 129, 513, 1000] {
        assert_exact(&format!("plane {width}"), &Case::new("plane", [width, 64]));
    }
}

#[test]
fn minmax_mipmaps_are_exact_over_random_rows() {
    let mut random = Random(3);
    for (width, levels) in [(1024, 0), (777, 0), (513, 40), (300, 1000), (130, 3)] {
        let case = Case::new("torus", [width, 128]);
        // Noise with stretches of one value, or of few values.
        let mut values = Vec::new();
        while values.len() < (width * 128) as usize {
            let value = random.unit();
            let value =
                if levels > 0 { (value * f64::from(levels)).floor() / f64::from(levels) } else { value };
            let length = if random.unit() < 0.1 { random.below(90) } else { 1 };
            values.extend(std::iter::repeat_n(value as f32, length));
        }
        values.truncate((width * 128) as usize);
        case.map.rectified.write(gpu(), &values).unwrap();
        assert_exact(&format!("random {width}, {levels} levels"), &case);
    }
}

#[test]
fn depths_that_are_the_rays_own_are_lit() {
    // Every ray's depth is clamped to 0.05 .. 0.95; a map at one of these bounds, up to a step of f32, decides alike
    // for all rays: codes of 7 and of 15 bits do not tell the three apart.
    let case = Case::new("plane", [200, 64]);
    let columns = case.map.rectified.size()[0] as usize;
    let greatest = 1.0 - 0.05_f32;
    for (depth, all) in
        [(greatest, 1.0), (0.049_99, 0.0), (1.0, 1.0), (0.0, 0.0), (-3.0, 0.0), (f32::NAN, 1.0)]
    {
        case.map.rectified.write(gpu(), &vec![depth; columns * 64]).unwrap();
        for competitor in [Competitor::MinMax, Competitor::BinaryMinMax] {
            let found = case.visibility(competitor);
            assert!(found.iter().all(|v| *v == all), "{} {depth}", competitor.name());
        }
    }
}

#[test]
fn variance_shadow_maps_are_those_of_their_equations() {
    let mut random = Random(5);
    // Rows of one depth each, where the least variance decides; noise about one depth a row.
    let mut rows = |spread: f64| {
        let case = Case::new("torus", [160, 256]);
        let mut values = Vec::new();
        for _ in 0..256 {
            let middle = random.between(0.1, 0.9);
            values.extend((0..160).map(|_| (middle + spread * random.between(-0.5, 0.5)) as f32));
        }
        case.map.rectified.write(gpu(), &values).unwrap();
        case
    };
    let cases = [
        ("foliage", Case::new("foliage", [512, 512])),
        ("terrain", Case::new("terrain", [300, 200])),
        ("plane", Case::new("plane", [513, 256])),
        ("rows of one depth", rows(0.0)),
        ("rows of noise", rows(0.1)),
    ];
    for (name, case) in cases {
        let twins = case.statistics();
        for competitor in [Competitor::Variance, Competitor::ExponentialVariance] {
            let found = case.visibility(competitor);
            let twin = |pixel: &Pixel| match competitor {
                Competitor::Variance => pixel.variance,
                _ => pixel.exponential,
            };
            let expected: Vec<f64> = twins.iter().map(twin).collect();
            let mean = error::mean_absolute(&found, &expected);
            let off =
                found.iter().zip(&expected).filter(|(f, e)| (f64::from(**f) - **e).abs() > 0.01).count();
            let share = off as f64 / found.len() as f64;
            // Chebyshev's inequality: never darker than the truth over the same columns, but for f32.
            let darker = found.iter().zip(&twins).filter(|(f, t)| t.whole - f64::from(**f) > 2e-3).count();
            let darkest = found.iter().zip(&twins).map(|(f, t)| t.whole - f64::from(*f)).fold(0.0, f64::max);
            println!(
                "{} {name}: mean {mean:.2e} from its equations, {:.2} % off by more than 0.01, {}; below the truth by {darkest:.1e} at most",
                competitor.name(),
                100.0 * share,
                error::worst(&found, &expected, PICTURE[0] as usize).unwrap()
            );
            assert!(mean < 5e-4 && share < 1e-3, "{} {name}", competitor.name());
            assert!(
                darker * 1000 < found.len(),
                "{} {name}: {darker} darker than the truth",
                competitor.name()
            );
        }
    }
}

#[test]
fn fourier_bases_are_nearer_to_the_truth_than_variance() {
    for name in ["foliage", "plane"] {
        let case = Case::new(name, [512, 512]);
        let exact: Vec<f64> = case.statistics().iter().map(|pixel| pixel.exact).collect();
        let settings = Settings {
            map: [512, 512],
            weighting: Weighting::Average,
            epipole_march: false,
            ..Settings::default()
        };
        let fourier = error::mean_absolute(&case.prefiltered(settings), &exact);
        let [variance, exponential] = [Competitor::Variance, Competitor::ExponentialVariance]
            .map(|competitor| error::mean_absolute(&case.visibility(competitor), &exact));
        println!(
            "{name}: Fourier M = 32 {fourier:.4}, variance {variance:.4}, exponential variance {exponential:.4}"
        );
        assert!(fourier < variance && fourier < exponential, "{name}");
    }
}
