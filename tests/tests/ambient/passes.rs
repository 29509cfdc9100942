// SPDX-License-Identifier: MIT OR Apache-2.0
//! The blur of bent normals, the halving of depth and normals and the upsampling, each by itself, of pictures whose weights are known:
//! floors at steps, normals that are half alike, pixels without a surface.

use crate::gpu::{Random, gpu, texture};
use crate::seen::{SeenImages, cameras, from_above, run_alone, seen};
use airlight::ambient::BentBlur;
use airlight::core::Camera;
use airlight::{Buffer, Texture};
use airlight_tests::linear::Vec3;
use glam::UVec2;
use wgpu::TextureFormat::{R32Float, Rgba16Float};

const UP: Vec3 = Vec3::new(0.0, 1.0, 0.0);
/// A normal whose cosine with `UP` is half way from 1 to the least that counts.
const TILTED: Vec3 = Vec3::new(0.6, 0.8, 0.0);
const LEAST_COSINE: f32 = 0.6;

/// A pixel of a floor: its height, and its normal.
type Floor = Option<(f64, Vec3)>;

fn blur(axis: usize, taps: u32, reach: f64) -> BentBlur {
    BentBlur {
        axis: UVec2::AXES[axis],
        taps,
        reach: reach as f32,
        least_cosine: LEAST_COSINE,
        reserved_a: 0.0,
        reserved_b: 0.0,
        reserved_c: 0.0,
    }
}

/// Pixels from above, of 1 cm.
fn floors(size: [u32; 2], reversed: bool, pixels: &[Floor]) -> SeenImages {
    let [width, height] = size.map(f64::from);
    let images = from_above(size, 0.005 * height, reversed, &|x, z| {
        let [column, row] = [x / 0.01 + 0.5 * width, z / 0.01 + 0.5 * height];
        pixels[row as usize * size[0] as usize + column as usize]
    });
    // Where nothing is seen there may be normals all the same.
    let normals: Vec<f32> = pixels
        .iter()
        .flat_map(|pixel| [normal(*pixel).to_array(), [0.0; 3]].concat().into_iter().take(4))
        .map(|part| part as f32)
        .collect();
    images.normals.write(gpu(), &normals).unwrap();
    images
}

/// Directions and openness that halves hold exactly, four numbers a pixel. Directions are long and much alike, so that on other normals some
/// would leave the unit sphere.
fn values(random: &mut Random, pixels: usize) -> Vec<f32> {
    let texel = |_| {
        let direction = (random.direction() * 0.5 + Vec3::new(1.0, 0.0, 0.0)).normalised() * 0.99;
        let parts = [direction.x, direction.y, direction.z, random.unit()];
        parts.map(|part| (256.0 * part).round() as f32 / 256.0)
    };
    (0..pixels).flat_map(texel).collect()
}

/// Steps between floors and what pixels of two of them count to each other, of a reach of 0.4 m.
const STEPS: [f64; 3] = [0.0, 0.1, 2.0];
const REACH: f64 = 0.4;

/// Floors at random steps with even normals, and a flat floor with two normals, each with some pixels without a surface; what pixels
/// of them count to each other, and how far a blur reaches.
fn cases(random: &mut Random, pixels: usize) -> [(Vec<Floor>, f64); 2] {
    let mut any = |of: &dyn Fn(usize) -> (f64, Vec3)| -> Vec<Floor> {
        (0..pixels).map(|_| (random.unit() > 0.15).then(|| of(random.below(3)))).collect()
    };
    let steps = any(&|k| (STEPS[k], UP));
    // So far that tilted planes do not part from the floor.
    let normals = any(&|k| (0.0, [UP, TILTED, TILTED][k]));
    [(steps, REACH), (normals, 1e5)]
}

/// What one pixel counts to another: 3/4 at the small step, 1/2 between the two normals.
fn counts(here: Floor, there: Floor) -> f64 {
    let (Some((height, normal)), Some((other, other_normal))) = (here, there) else { return 0.0 };
    let step = match (height - other).abs() {
        0.0 => 1.0,
        away if away < 0.2 => 0.75,
        _ => 0.0,
    };
    step * if normal == other_normal { 1.0 } else { 0.5 }
}

fn normal(floor: Floor) -> Vec3 {
    floor.map_or(UP, |(_, normal)| normal)
}

/// Direction and openness of a pixel of a picture.
fn bent(values: &[f32], pixel: usize) -> (Vec3, f64) {
    let texel = &values[4 * pixel..][..4];
    (Vec3::from([texel[0], texel[1], texel[2]]), f64::from(texel[3]))
}

/// The mean of what counts, no longer than 1: `parts` have a weight, a value and a normal, whose `share` is not blurred.
fn mean(parts: &[(f64, (Vec3, f64), Vec3)], share: f64, normal: Vec3) -> (Vec3, f64) {
    let weights: f64 = parts.iter().map(|part| part.0).sum();
    let directions = parts.iter().fold(Vec3::default(), |sum, (weight, (direction, _), facing)| {
        sum + (*direction - *facing * share) * *weight
    });
    let open: f64 = parts.iter().map(|(weight, (_, open), _)| weight * open).sum();
    let direction = directions * (1.0 / weights) + normal * share;
    (direction * (1.0 / direction.length().max(1.0)), open / weights)
}

fn close(what: &str, pixel: usize, found: (Vec3, f64), wanted: (Vec3, f64), tolerance: f64) {
    let off = (found.0 - wanted.0).length().max((found.1 - wanted.1).abs());
    assert!(off <= tolerance, "{what}, pixel {pixel}: {found:?} instead of {wanted:?}");
}

#[test]
fn a_blur_takes_the_mean_of_what_counts_in_its_row_or_column() {
    let mut random = Random(17);
    let size = [19_u32, 11];
    let pixels = 19 * 11;
    for (floor, reach) in cases(&mut random, pixels) {
        let images = floors(size, true, &floor);
        let given = values(&mut random, pixels);
        for (axis, taps, form) in
            [(0, 8, ""), (1, 8, ""), (1, 5, "PLAIN"), (0, 3, "OCCLUSION_ONLY"), (0, 2, "")]
        {
            let what = format!("{reach} {axis} {taps} {form}");
            let only = form == "OCCLUSION_ONLY";
            let format = if only { R32Float } else { Rgba16Float };
            let open: Vec<f32> = given.chunks_exact(4).map(|texel| texel[3]).collect();
            let values = texture(size, format, if only { &open } else { &given });
            let blurred = Texture::storage(gpu(), size, format);
            let camera = Buffer::uniform(gpu(), &images.camera);
            let blur = Buffer::uniform(gpu(), &blur(axis, taps, reach));
            let resources = [
                ("camera", (&camera).into()),
                ("blur", (&blur).into()),
                ("depth", (&images.depth).into()),
                ("normals", (&images.normals).into()),
                ("bent", (&values).into()),
                ("blurred", (&blurred).into()),
            ];
            run_alone("ambient/blur_bent", &[(form, !form.is_empty())], size, &resources);
            let found = blurred.read(gpu()).unwrap();
            for pixel in 0..pixels {
                let at = [pixel % 19, pixel / 19];
                let around = (0..taps as usize).filter_map(|tap| {
                    let other = (at[axis] + tap).checked_sub(taps as usize / 2)?;
                    let other = if axis == 0 { at[1] * 19 + other } else { other * 19 + at[0] };
                    let inside = if axis == 0 { other / 19 == at[1] } else { other < pixels };
                    let weight = inside.then(|| counts(floor[pixel], floor[other]))?;
                    Some((weight, bent(&given, other), normal(floor[other])))
                });
                let around: Vec<_> = around.collect();
                let share = if form == "PLAIN" { 0.0 } else { 0.5 };
                let wanted = match floor[pixel] {
                    Some((_, normal)) => mean(&around, share, normal),
                    None => (Vec3::default(), 1.0),
                };
                if only {
                    let off = (f64::from(found[pixel]) - wanted.1).abs();
                    assert!(off < 1e-4, "{what}, pixel {pixel}: {} instead of {}", found[pixel], wanted.1);
                } else {
                    close(&what, pixel, bent(&found, pixel), wanted, 1.5e-3);
                }
            }
        }
    }
}

/// Depth and normals of half the size.
fn halved(images: &SeenImages) -> ([u32; 2], Vec<f32>, Vec<f32>) {
    let size = images.size.map(|side| side.div_ceil(2));
    let (depth, normals) =
        (Texture::storage(gpu(), size, R32Float), Texture::storage(gpu(), size, Rgba16Float));
    let camera = Buffer::uniform(gpu(), &images.camera);
    let resources = [
        ("camera", (&camera).into()),
        ("depth", (&images.depth).into()),
        ("normals", (&images.normals).into()),
        ("halved_depth", (&depth).into()),
        ("halved_normals", (&normals).into()),
    ];
    run_alone("ambient/halve_geometry", &[], size, &resources);
    (size, depth.read(gpu()).unwrap(), normals.read(gpu()).unwrap())
}

#[test]
fn halving_takes_the_nearest_and_the_farthest_in_turn_on_their_planes() {
    let mut random = Random(23);
    for (size, reversed) in [([14_u32, 10_u32], true), ([13, 9], false), ([1, 1], true)] {
        let pixels = (size[0] * size[1]) as usize;
        let floor: Vec<Floor> = (0..pixels)
            .map(|_| {
                let normal = match random.below(6) {
                    // Nearly from the side: such a plane is not followed.
                    0 => Vec3::new(0.0, 0.03, 1.0),
                    1 => Vec3::new(1.0, 0.07, 0.0),
                    _ => Vec3::new(random.between(-1.0, 1.0), 1.0, random.between(-1.0, 1.0)),
                };
                // Some so near the far plane that their planes leave the view.
                let height = if random.below(3) == 0 { -3.99 } else { random.between(-3.9, 3.9) };
                (random.unit() > 0.2).then(|| (height + random.between(-0.009, 0.0), normal.normalised()))
            })
            .collect();
        let images = floors(size, reversed, &floor);
        let far = images.reference.far_depth;
        // Depths that are not finite are those of the far plane.
        let broken = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, far as f32];
        let depths = images.depths.iter().zip(&floor).enumerate();
        let depths = depths.map(|(index, (depth, floor))| floor.map_or(broken[index % 4], |_| *depth));
        images.depth.write(gpu(), &depths.collect::<Vec<_>>()).unwrap();
        let ([width, _], depths, normals) = halved(&images);
        for (index, (found, found_normal)) in depths.iter().zip(normals.chunks_exact(4)).enumerate() {
            let [x, y] = [index % width as usize, index / width as usize];
            let four = [[0, 0], [1, 0], [0, 1], [1, 1]]
                .map(|[i, j]| [(2 * x + i).min(size[0] as usize - 1), (2 * y + j).min(size[1] as usize - 1)]);
            let height = |[x, y]: [usize; 2]| floor[y * size[0] as usize + x].map_or(-9.0, |floor| floor.0);
            let mut ordered = four;
            // Ties keep their order either way.
            if (x + y) % 2 == 0 {
                ordered.sort_by(|a, b| height(*b).total_cmp(&height(*a)));
            } else {
                ordered.sort_by(|a, b| height(*a).total_cmp(&height(*b)));
            }
            let [column, row] = ordered[0];
            let chosen = floor[row * size[0] as usize + column];
            let normal = normal(chosen);
            // The corner of the four beside the chosen pixel's middle, metres.
            let beside = [2 * x + 1, 2 * y + 1].map(|side| 0.01 * side as f64);
            let middle = [column, row].map(|side| 0.01 * (side as f64 + 0.5));
            let wanted = chosen.map_or(far, |(height, _)| {
                let rise =
                    -(normal.x * (beside[0] - middle[0]) + normal.z * (beside[1] - middle[1])) / normal.y;
                let depth = |height: f64| {
                    images.reference.project(Vec3::new(0.0, height, 0.0)).unwrap()[2].clamp(0.0, 1.0)
                };
                let moved = depth(height + rise);
                if normal.y < 0.05 || moved == far { depth(height) } else { moved }
            });
            let what = format!("{size:?} {reversed}, halved pixel {x} {y}");
            assert!((f64::from(*found) - wanted).abs() < 2e-6, "{what}: {found} instead of {wanted}");
            let off = (Vec3::from([found_normal[0], found_normal[1], found_normal[2]]) - normal).length();
            assert!(off < 1e-3, "{what}: {found_normal:?} instead of {normal:?}");
        }
    }
}

#[test]
fn every_four_halved_pixels_at_steps_have_both_sides() {
    for reversed in [false, true] {
        // Two levels in turn, so that all 2x2 pixels meet both.
        let floor: Vec<Floor> =
            (0..32 * 32).map(|pixel| Some((f64::from((pixel % 32 + pixel / 32) % 2), UP))).collect();
        let images = floors([32, 32], reversed, &floor);
        let (_, depths, _) = halved(&images);
        let high = |x: usize, y: usize| {
            let depth = f64::from(depths[y * 16 + x]);
            let levels =
                [0.0, 1.0].map(|height| images.reference.project(Vec3::new(0.0, height, 0.0)).unwrap()[2]);
            (depth - levels[1]).abs() < (depth - levels[0]).abs()
        };
        for (x, y) in (0..15).flat_map(|y| (0..15).map(move |x| (x, y))) {
            let four = [high(x, y), high(x + 1, y), high(x, y + 1), high(x + 1, y + 1)];
            assert_eq!(four.iter().filter(|high| **high).count(), 2, "{reversed} {x} {y}: {four:?}");
        }
    }
}

#[test]
fn halved_planes_are_the_planes() {
    let normal = Vec3::new(0.3, 1.0, -0.2).normalised();
    let plane = |origin: Vec3, direction: Vec3| Some((-origin.dot(normal) / direction.dot(normal), normal));
    for (name, camera) in cameras(Vec3::new(1.0, 2.5, 1.0), Vec3::default(), 1.0) {
        let images = seen(camera, [30, 30], &plane);
        let ([width, height], depths, _) = halved(&images);
        let whole = seen(camera, [width, height], &plane);
        let worst = depths.iter().zip(&whole.depths).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst < 2e-6, "{name}: {worst}");
        assert_eq!(height, 15);
    }
}

/// Upsamples values of half the size.
fn upsampled(images: &SeenImages, halved: &SeenImages, given: &[f32], reach: f64) -> Vec<f32> {
    let bent = texture(halved.size, Rgba16Float, given);
    let whole = Texture::storage(gpu(), images.size, Rgba16Float);
    let camera = Buffer::uniform(gpu(), &images.camera);
    let halved_camera =
        Buffer::uniform(gpu(), &Camera { viewport: 0.5 * images.camera.viewport, ..images.camera });
    let blur = Buffer::uniform(gpu(), &blur(0, 8, reach));
    let resources = [
        ("camera", (&camera).into()),
        ("halved_camera", (&halved_camera).into()),
        ("blur", (&blur).into()),
        ("depth", (&images.depth).into()),
        ("normals", (&images.normals).into()),
        ("halved_depth", (&halved.depth).into()),
        ("halved_normals", (&halved.normals).into()),
        ("bent", (&bent).into()),
        ("whole", (&whole).into()),
    ];
    run_alone("ambient/upsample_bent", &[], images.size, &resources);
    whole.read(gpu()).unwrap()
}

/// Halved pixels around a pixel and their bilinear weights: 9/16, 3/16, 3/16 and 1/16; at the border some are the same.
fn four_around(x: usize, y: usize, [width, height]: [usize; 2]) -> [(f64, usize); 4] {
    let along = |at: usize, count: usize| {
        let own = at / 2;
        let beside = if at % 2 == 1 { (own + 1).min(count - 1) } else { own.saturating_sub(1) };
        [(0.75, own), (0.25, beside)]
    };
    let (columns, rows) = (along(x, width), along(y, height));
    std::array::from_fn(|index| {
        let (column, row) = (columns[index % 2], rows[index / 2]);
        (column.0 * row.0, row.1 * width + column.1)
    })
}

#[test]
fn upsampling_is_bilinear_over_what_is_of_the_same_surface() {
    let mut random = Random(29);
    for size in [[24_u32, 16_u32], [13, 9], [1, 1]] {
        let half = size.map(|side| side.div_ceil(2));
        let half_sides = half.map(|side| side as usize);
        let [pixels, half_pixels] = [size, half].map(|[width, height]| (width * height) as usize);
        let all = cases(&mut random, pixels).into_iter().zip(cases(&mut random, half_pixels));
        for ((floor, reach), (half_floor, _)) in all {
            let (images, small) = (floors(size, true, &floor), floors(half, true, &half_floor));
            let given = values(&mut random, half_pixels);
            let found = upsampled(&images, &small, &given, reach);
            for (pixel, own) in floor.iter().copied().enumerate() {
                let [x, y] = [pixel % size[0] as usize, pixel / size[0] as usize];
                let of = |weight: &dyn Fn(Floor) -> f64| {
                    let around = four_around(x, y, half_sides).map(|(share, other)| {
                        let weight = share * weight(half_floor[other]);
                        (weight, bent(&given, other), normal(half_floor[other]))
                    });
                    let some = around.iter().any(|part| part.0 > 0.0);
                    some.then(|| mean(&around, 0.5, normal(own)))
                };
                let alike = of(&|there| counts(own, there));
                // Where none is of the surface, all that are seen count; where none is seen it is open.
                let any = || of(&|there| f64::from(u8::from(there.is_some())));
                let wanted = match own {
                    Some((_, normal)) => alike.or_else(any).unwrap_or((normal * 0.5, 1.0)),
                    None => (Vec3::default(), 1.0),
                };
                // What is not of the surface counts by a ten thousandth.
                close(&format!("{size:?} {reach}"), pixel, bent(&found, pixel), wanted, 4e-3);
            }
        }
    }
}

#[test]
fn upsampling_on_a_slanted_plane_is_bilinear() {
    let plane = |x: f64, _: f64| Some((-0.75 * x, TILTED));
    let mut random = Random(31);
    let (images, small) = (from_above([24, 24], 1.0, true, &plane), from_above([12, 12], 1.0, true, &plane));
    let given = values(&mut random, 144);
    // Pixels are 8 cm apart.
    let found = upsampled(&images, &small, &given, 0.02);
    for pixel in 0..24 * 24 {
        let around = four_around(pixel % 24, pixel / 24, [12, 12])
            .map(|(share, other)| (share, bent(&given, other), TILTED));
        close("plane", pixel, bent(&found, pixel), mean(&around, 0.5, TILTED), 1.5e-3);
    }
}
