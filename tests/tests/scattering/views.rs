// SPDX-License-Identifier: MIT OR Apache-2.0
//! Several views in one call, by every method.

use crate::gpu::{self, gpu, shaders};
use airlight::core::Jitter;
use airlight::scattering::{
    LightForm, March, Method, Prefiltered, Resolution, Settings, ViewSettings, Views, Visibility, Weighting,
    choose, projective_rows,
};
use airlight_tests::error::relative_rmse;

#[test]
fn views_of_one_call_are_those_of_their_own() {
    let scene = gpu::torus_over_plane();
    let stage = scene.stage([64, 48], [256, 256]);
    let settings = Settings { map: [128, 128], ..Settings::default() };
    let (camera, light) = (stage.camera, &stage.light);
    let limit = stage.medium.distance_limit;
    let march = Method::March {
        form: LightForm::default(),
        steps: 64,
        weighting: Weighting::Transmittance,
        jitter: Jitter::None,
        frame: 0,
    };
    let mut views = vec![
        ViewSettings { camera, resolution: None, method: Method::Epipolar(settings) },
        ViewSettings { camera, resolution: None, method: march.clone() },
        ViewSettings { camera, resolution: Some(Resolution::Half), method: march.clone() },
    ];
    let rows = projective_rows(&camera, light.direction, limit, 2);
    println!("{:?}", choose(&camera, light.direction, limit, 2));
    views.extend(rows.map(|rows| ViewSettings {
        camera,
        resolution: None,
        method: Method::Projective(settings, Box::new(rows)),
    }));
    // The other ways to prefilter visibility, at full and at half the resolution.
    let others = views.len();
    for (visibility, weighting) in [
        (Visibility::Rank { bits: 12 }, Weighting::Transmittance),
        (Visibility::Moments, Weighting::Transmittance),
        (Visibility::Wavelet { bits: 12 }, Weighting::Average),
    ] {
        for resolution in [None, Some(Resolution::Half)] {
            let method = Method::Epipolar(Settings { visibility, weighting, ..settings });
            views.push(ViewSettings { camera, resolution, method });
        }
    }
    let record = |views: &[ViewSettings]| {
        let made = Views::new(gpu(), shaders(), views).unwrap();
        let inputs = vec![stage.inputs(); views.len()];
        let bound = made.bind(gpu(), &inputs).unwrap();
        let mut encoder = gpu().encoder();
        made.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        made.views.iter().map(|view| view.scattered().read(gpu()).unwrap()).collect::<Vec<_>>()
    };
    let together = record(&views);
    for (view, picture) in views.iter().zip(&together) {
        assert!(record(std::slice::from_ref(view))[0] == *picture, "{:?}", view.method);
        assert_eq!(picture.len(), 64 * 48 * 4);
    }
    // And those of the passes by themselves.
    let alone = Prefiltered::new(gpu(), shaders(), settings, [64, 48]).unwrap();
    let bound = alone.bind(gpu(), &stage.inputs()).unwrap();
    let mut encoder = gpu().encoder();
    alone.record(&mut encoder, &bound);
    let along = airlight::scattering::Along::ShadowMap { steps: 64 };
    let marched = March::new(gpu(), shaders(), &along, Weighting::Transmittance, [64, 48]).unwrap();
    let bound = marched.bind(gpu(), &stage.inputs(), &along).unwrap();
    marched.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    assert!(alone.scattered.read(gpu()).unwrap() == together[0]);
    assert!(marched.scattered.read(gpu()).unwrap() == together[1]);
    let half = relative_rmse(&together[2], &together[1]);
    assert!(half > 0.0 && half < 0.1, "half the resolution: {half}");
    for pair in together[others..].chunks_exact(2) {
        let half = relative_rmse(&pair[1], &pair[0]);
        assert!(half > 0.0 && half < 0.1, "half the resolution of another method: {half}");
        assert!(pair[0] != together[0] && relative_rmse(&pair[0], &together[0]) < 0.1);
    }
    // Jitter that no march of this light has.
    let form = LightForm { spot: true, ..LightForm::default() };
    let Method::March { steps, weighting, frame, .. } = march else { unreachable!() };
    let method = Method::March { form, steps, weighting, jitter: Jitter::Gradient, frame };
    assert!(Views::new(gpu(), shaders(), &[ViewSettings { camera, resolution: None, method }]).is_err());
}
