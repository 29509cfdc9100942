// SPDX-License-Identifier: MIT OR Apache-2.0
//! Functions of splines and curvatures by themselves: against sums over all voxels and eigenvalues in f64, and with numbers
//! from one end of f32 to the other.

use crate::gpu::{Probe, Random, copy_of_wgsl, gpu};
use crate::probing::{f, hold, triple};
use airlight::validate::{Definitions, Library};
use airlight::{Buffer, Pass, Sampler, Shaders, Texture};
use airlight_tests::linear::Vec3;
use airlight_tests::reference::painterly::{Form, in_other_coordinates, principal_curvatures, spline_jet};

/// Numbers of a spline: value by fetches; gradient by fetches; value, gradient, xx, yy, zz, xy, xz, yz by loads.
const SPLINE_NUMBERS: usize = 14;

const SPLINES: &str = "
    #import airlight::painterly::spline::{spline_value, spline_gradient, spline_jet}
    @group(#{GROUP}) @binding(0) var<storage, read> places: array<vec4<f32>>;
    @group(#{GROUP}) @binding(1) var<storage, read_write> found: array<f32>;
    @group(#{GROUP}) @binding(2) var values: texture_3d<f32>;
    @group(#{GROUP}) @binding(3) var linear_sampler: sampler;
    @compute @workgroup_size(64)
    fn splines(@builtin(global_invocation_id) id: vec3<u32>) {
        if id.x >= arrayLength(&places) { return; }
        let unit = places[id.x].xyz;
        let g = spline_gradient(values, linear_sampler, unit, 0.5, 0.25);
        let jet = spline_jet(values, unit, 0.5, 0.25);
        let h = jet.hessian;
        var all = array<f32, 14>(
            spline_value(values, linear_sampler, unit, 0.5, 0.25), g.x, g.y, g.z, jet.value, jet.gradient.x, jet.gradient.y,
            jet.gradient.z, h[0].x, h[1].y, h[2].z, h[0].y, h[0].z, h[1].z
        );
        for (var i = 0u; i < 14u; i++) { found[id.x * 14u + i] = all[i]; }
    }";

/// Splines of a volume of half floats at places, values half the texels and a quarter.
fn splines(size: [u32; 3], texels: &[f32], places: &[[f64; 3]]) -> Vec<f32> {
    let folder = copy_of_wgsl();
    std::fs::write(folder.path().join("core/passes/splines.wgsl"), SPLINES).unwrap();
    let shaders = Shaders::from_library(Library::from_directory(folder.path()).unwrap());
    let pass = match Pass::compute_with(gpu(), &shaders, "core/splines", &Definitions::new()) {
        Ok(pass) => pass,
        Err(error) => panic!("{error}"),
    };
    let texture = Texture::volume(gpu(), size, wgpu::TextureFormat::R16Float);
    texture.write(gpu(), texels).unwrap();
    let bytes: Vec<u8> = places
        .iter()
        .flat_map(|[x, y, z]| [*x, *y, *z, 0.0])
        .flat_map(|u| (u as f32).to_le_bytes())
        .collect();
    let from = Buffer::with_bytes(gpu(), &bytes, wgpu::BufferUsages::STORAGE);
    let to = Buffer::storage(gpu(), (places.len() * SPLINE_NUMBERS * 4) as u64);
    let sampler = Sampler::linear(gpu());
    let resources = [
        ("places", (&from).into()),
        ("found", (&to).into()),
        ("values", (&texture).into()),
        ("linear_sampler", (&sampler).into()),
    ];
    let bound = pass.bind(gpu(), &resources).unwrap();
    let mut encoder = gpu().encoder();
    pass.dispatch(&mut encoder, &bound, [places.len() as u32, 1, 1]);
    gpu().submit(encoder).unwrap();
    let mut found = to.read_floats(gpu()).unwrap();
    found.truncate(places.len() * SPLINE_NUMBERS);
    found
}

fn random_texels(random: &mut Random, count: u32) -> Vec<f32> {
    (0..count).map(|_| half::f16::from_f64(random.between(-0.5, 1.5)).to_f32()).collect()
}

fn random_places(random: &mut Random, count: usize) -> Vec<[f64; 3]> {
    // Also outside, where nothing changes any more.
    let mut unit = || f64::from(random.between(-0.02, 1.02) as f32);
    (0..count).map(|_| [unit(), unit(), unit()]).collect()
}

#[test]
fn fetches_and_loads_are_the_sum_over_all_voxels() {
    let mut random = Random(9);
    for size in [[7, 6, 5], [1, 9, 4], [2, 1, 3]] {
        let texels = random_texels(&mut random, size.iter().product());
        let places = random_places(&mut random, 120);
        let found = splines(size, &texels, &places);
        let values: Vec<f64> = texels.iter().map(|texel| f(*texel) * 0.5 + 0.25).collect();
        let (mut fetched, mut loaded) = (0.0_f64, 0.0_f64);
        for (found, unit) in found.chunks_exact(SPLINE_NUMBERS).zip(&places) {
            let (value, g, h) = spline_jet(size.map(|side| side as usize), &values, *unit);
            let exact = [value, g[0], g[1], g[2], h[0][0], h[1][1], h[2][2], h[0][1], h[0][2], h[1][2]];
            for (i, found) in found.iter().enumerate() {
                let (worst, i) = if i < 4 { (&mut fetched, i) } else { (&mut loaded, i - 4) };
                *worst = worst.max((f(*found) - exact[i]).abs());
            }
        }
        // Filters may place fetches to a 256th of a voxel.
        hold(&format!("{size:?}, 8 and 24 fetches"), fetched, 1.0 / 256.0);
        hold(&format!("{size:?}, 64 loads"), loaded, 1e-5);
    }
}

#[test]
fn wild_voxels_are_replaced_one_by_one() {
    let mut random = Random(10);
    let size = [8, 7, 6];
    let mut wild = random_texels(&mut random, 8 * 7 * 6);
    let mut tame = wild.clone();
    for (i, odd) in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY].into_iter().cycle().take(24).enumerate() {
        let at = (i * 61 + 3) % wild.len();
        (wild[at], tame[at]) = (odd, 0.0);
    }
    let places = random_places(&mut random, 200);
    let [wild, tame] = [wild, tame].map(|texels| splines(size, &texels, &places));
    assert!(wild.iter().all(|number| number.is_finite()));
    for (wild, tame) in wild.chunks_exact(SPLINE_NUMBERS).zip(tame.chunks_exact(SPLINE_NUMBERS)) {
        assert_eq!(wild[4..], tame[4..]);
    }
}

const CURVATURES: &str = "
    #import airlight::painterly::spline::SplineJet
    #import airlight::painterly::curvature::world_curvatures
    fn triple_at(first: u32) -> vec3<f32> { return vec3<f32>(input(first), input(first + 1u), input(first + 2u)); }
    fn affine_at(first: u32) -> mat4x4<f32> {
        return mat4x4<f32>(vec4<f32>(triple_at(first), 0.0), vec4<f32>(triple_at(first + 3u), 0.0),
            vec4<f32>(triple_at(first + 6u), 0.0), vec4<f32>(0.0, 0.0, 0.0, 1.0));
    }";

/// Gradient, second derivatives by columns, columns of `unit_from_world`, voxels, side; both curvatures and directions.
fn curvatures(records: &[f32]) -> Vec<f32> {
    let probe = Probe {
        head: CURVATURES,
        body: "let jet = SplineJet(0.5, triple_at(0u), mat3x3<f32>(triple_at(3u), triple_at(6u), triple_at(9u)));
               let found = world_curvatures(jet, triple_at(21u), affine_at(12u), input(24u));
               output(0u, found.one); output(1u, found.two);
               for (var i = 0u; i < 3u; i++) {
                   output(2u + i, found.along_one[i]);
                   output(5u + i, found.along_two[i]);
               }",
        inputs: 25,
        outputs: 8,
    };
    probe.run(records)
}

/// A record, and its gradient and second derivatives in metres in f64.
fn record(gradient: Vec3, hessian: &Form, to: &Form, size: [f64; 3], side: f64) -> (Vec<f32>, Vec3, Form) {
    let mut numbers = gradient.to_array().to_vec();
    numbers.extend(hessian.as_flattened());
    for column in 0..3 {
        numbers.extend(to.iter().map(|row| row[column]));
    }
    numbers.extend(size);
    numbers.push(side);
    let numbers: Vec<f32> = numbers.into_iter().map(|x| x as f32).collect();
    let voxels: Form = std::array::from_fn(|i| to[i].map(|entry| f(entry as f32) * size[i]));
    let (gradient, hessian) = in_other_coordinates(&voxels, gradient.to_array(), hessian);
    (numbers, Vec3::from(gradient), hessian)
}

fn random_form(random: &mut Random) -> Form {
    let mut form = [[0.0; 3]; 3];
    for (a, b) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] {
        form[a][b] = f64::from(random.between(-1.0, 1.0) as f32);
        form[b][a] = form[a][b];
    }
    form
}

#[test]
fn curvatures_are_eigenvalues_in_any_space() {
    let mut random = Random(11);
    let (mut records, mut exact) = (Vec::new(), Vec::new());
    for i in 0..600 {
        let scale = random.magnitude(1e-3, 100.0);
        // Turned, stretched and skewed.
        let to: Form = loop {
            let to: Form =
                std::array::from_fn(|_| (random.direction() * scale * random.between(0.5, 2.0)).to_array());
            let rows = to.map(Vec3::from);
            if rows[0].normalised().cross(rows[1].normalised()).dot(rows[2].normalised()).abs() > 0.3 {
                break to;
            }
        };
        let gradient =
            Vec3::from((random.direction() * random.magnitude(0.01, 1.0)).to_array().map(|x| f(x as f32)));
        let size = [0; 3].map(|_| random.between(20.0, 60.0).floor());
        let side = if i % 2 == 0 { 1.0 } else { -1.0 };
        let (numbers, gradient, hessian) = record(gradient, &random_form(&mut random), &to, size, side);
        records.extend(numbers);
        exact.push(principal_curvatures(gradient, &hessian, side));
    }
    let (mut worst, mut degrees, mut directed) = (0.0_f64, 0.0_f64, 0);
    for (found, [one, two]) in curvatures(&records).chunks_exact(8).zip(&exact) {
        let greatest = one.0.abs().max(two.0.abs());
        if greatest > 65000.0 {
            continue;
        }
        for (found, exact) in found.iter().zip([one.0, two.0]) {
            worst = worst.max((f(*found) - exact).abs() / greatest);
        }
        if one.0 - two.0 > 0.05 * greatest {
            directed += 1;
            for (found, exact) in [(&found[2..5], one.1), (&found[5..8], two.1)] {
                let along = triple(found);
                assert!((along.length() - 1.0).abs() < 1e-5);
                degrees = degrees.max(along.cross(exact).length().asin().to_degrees());
            }
        }
    }
    assert!(directed > 450, "{directed}");
    hold("curvature", worst, 1e-4);
    hold("degrees", degrees, 0.05);
}

#[test]
fn umbilics_and_odd_numbers_are_finite() {
    let mut random = Random(12);
    let ends = [0.0, 1e-38, -1e-38, 1e-20, 1e-6, 1.0, -1.0, 2.0];
    let mut records = Vec::new();
    for i in 0..4000 {
        let mut odd = || ends[random.below(ends.len())];
        let gradient = Vec3::new(odd(), odd(), odd());
        let mut form = random_form(&mut random);
        if i % 3 == 0 {
            // An umbilic, to the last bit.
            let bend = f64::from(random.between(-2.0, 2.0) as f32);
            form = std::array::from_fn(|a| std::array::from_fn(|b| if a == b { bend } else { 0.0 }));
        }
        // Of nothing, of atoms and of galaxies.
        let scale = [0.0, 1e-37, 1e-15, 1.0, 1e15, 1e35][random.below(6)];
        let to = std::array::from_fn(|_| (random.direction() * scale).to_array());
        records.extend(record(gradient, &form, &to, [1.0, 64.0, 2048.0], -1.0).0);
    }
    for (found, given) in curvatures(&records).chunks_exact(8).zip(records.chunks_exact(25)) {
        assert!(found.iter().all(|number| number.is_finite()), "{found:?} of {given:?}");
        assert!(found[0] >= found[1] && found[0].abs().max(found[1].abs()) <= 65504.0 * 1.001, "{found:?}");
        let size = triple(&found[2..5]).length();
        assert!(size == 0.0 || (size - 1.0).abs() < 1e-5, "{found:?} of {given:?}");
        if given[..3].iter().all(|slope| slope.abs() < 1e-7) || given[12..21].iter().all(|x| *x == 0.0) {
            assert!(found.iter().all(|number| *number == 0.0), "{found:?} of {given:?}");
        }
    }
    // Umbilics of cubes have no direction.
    let cube = std::array::from_fn(|a| std::array::from_fn(|b| if a == b { 1.0 } else { 0.0 }));
    let records: Vec<f32> =
        (0..200).flat_map(|_| record(random.direction(), &cube, &cube, [1.0; 3], -1.0).0).collect();
    for found in curvatures(&records).chunks_exact(8) {
        assert!((found[0] + 1.0).abs() < 1e-5 && (found[1] + 1.0).abs() < 1e-5, "{found:?}");
        assert!(found[2..].iter().all(|number| *number == 0.0), "{found:?}");
    }
}
