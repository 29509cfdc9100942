// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files of styles: the numbers of Table 5.1, and what is said of bad files.

use airlight::painterly::{Orientation, PainterlyStyle, Rates, STYLES, parse_style, read_style};
use std::path::Path;

fn style(name: &str) -> PainterlyStyle {
    let (_, text) = STYLES.iter().find(|(known, _)| *known == name).unwrap();
    parse_style(name, text).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn the_styles_of_the_table_have_its_numbers() {
    let thresholds = [0.1, 0.3, 1.0];
    let table = [
        ("a", [0.01, 0.05, 0.05], [100.0, 100.0, 40.0], [0.3, 0.1, 0.1], 0.1),
        ("b", [0.01, 0.02, 0.05], [150.0, 100.0, 50.0], [0.8, 0.03, 0.03], 0.01),
        ("c", [0.01, 0.02, 0.05], [200.0, 80.0, 30.0], [0.8, 0.025, 0.02], 0.01),
    ];
    for (name, probability, size, most, least) in table {
        let style = style(name);
        for (layer, of) in style.layers().into_iter().enumerate() {
            assert_eq!(of.threshold, thresholds[layer], "{name}");
            assert_eq!((of.probability, of.size), (probability[layer], size[layer]), "{name}");
            assert_eq!((of.density.min, of.density.max), (least, most[layer]), "{name}");
        }
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/styles/painterly");
        assert_eq!(read_style(folder.join(format!("{name}.toml"))).unwrap(), style);
    }
    let dense = style("dense");
    assert!(dense.layers().iter().all(|layer| layer.density.max > layer.density.min));
    assert_eq!(STYLES.len(), 4);
}

#[test]
fn printed_and_seamless_rates_differ_in_opacity_alone() {
    assert_eq!(
        (Rates::PRINTED.orientation, Rates::PRINTED.color, Rates::PRINTED.fade_in),
        (0.05, 1.0 / 3.0, 0.9)
    );
    assert_eq!(Rates::SEAMLESS.fade_in, 0.1);
    assert_eq!(Rates { fade_in: 0.9, fade_out: 0.9, ..Rates::SEAMLESS }, Rates::PRINTED);
    assert_eq!(style("a").rates, Rates::SEAMLESS);
}

const LAYER: &str = "probability = 0.01\nsize = 10\ndensity = { min = 0.1, max = 0.2 }\n";

fn text(head: &str, fine: &str) -> String {
    format!(
        "{head}\n[coarse]\nthreshold = 0.1\n{LAYER}[medium]\nthreshold = 0.3\n{LAYER}[fine]\nthreshold = 1\n{LAYER}{fine}"
    )
}

#[test]
fn what_is_left_out_has_defaults_and_every_key_is_read() {
    let plain = parse_style("x", &text("", "")).unwrap();
    assert_eq!((plain.coarse.aspect, plain.coarse.opacity, plain.coarse.brush), (0.35, 1.0, None));
    assert_eq!((plain.density_unit, plain.anticipation, plain.hysteresis), (0.01, 1.0, 0.1));
    assert_eq!((plain.orientation, plain.rates), (Orientation::Gradient, Rates::SEAMLESS));
    let head = "hysteresis = 0.2\ngradient_scale = 2\ndensity_unit = 0.05\nanticipation = 0\nsize_variation = 0.5\n\
                color_variation = 0.25\ndensity_margin = 0.5\norientation = \"curvature\"\nangle = 90\nocclusion_tolerance = 2\n\
                [rates]\ncolor = 0.5\norientation = 0.25\nsize = 0.125\nfade_in = 0.75\nfade_out = 1\nhidden = 0";
    let full = parse_style("x", &text(head, "aspect = 0.5\nopacity = 0.25\nbrush = 2\n")).unwrap();
    assert_eq!((full.hysteresis, full.gradient_scale, full.density_unit), (0.2, 2.0, 0.05));
    assert_eq!((full.anticipation, full.size_variation, full.color_variation), (0.0, 0.5, 0.25));
    assert_eq!((plain.density_margin, full.density_margin), (0.15, 0.5));
    for (found, expected) in plain
        .within_bounds(&plain.fine)
        .iter()
        .chain(&full.within_bounds(&full.fine))
        .zip([0.115, 0.185, 0.15, 0.15])
    {
        assert!((found - expected).abs() < 1e-6);
    }
    assert_eq!((full.orientation, full.angle, full.occlusion_tolerance), (Orientation::Curvature, 90.0, 2.0));
    let rates =
        Rates { color: 0.5, orientation: 0.25, size: 0.125, fade_in: 0.75, fade_out: 1.0, hidden: 0.0 };
    assert_eq!(full.rates, rates);
    assert_eq!((full.fine.aspect, full.fine.opacity, full.fine.brush), (0.5, 0.25, Some(2)));
}

#[test]
fn bad_files_are_refused_where_they_are_wrong() {
    let refusal = |text: &str| parse_style("style.toml", text).expect_err(text).to_string();
    for (wrong, expected) in [
        (text("colour = 1", ""), "style.toml:1:1: unknown field `colour`"),
        (text("", "weight = 1"), "style.toml:17:1: unknown field `weight`"),
        (text("rates = { opacity = 1 }", ""), "style.toml:1:11: unknown field `opacity`"),
        (text("orientation = \"up\"", ""), "style.toml:1:15: unknown variant `up`"),
        (text("angle = \"up\"", ""), "style.toml:1:9: invalid type: string"),
        ("[coarse]\nthreshold = 1".to_owned(), "missing field `probability`"),
        ("angle = 1".to_owned(), "missing field `coarse`"),
        ("angle = ".to_owned(), "style.toml:1:"),
        (text("hysteresis = nan", ""), "hysteresis of NaN is impossible: it must be 0 to 10"),
        (text("hysteresis = -1", ""), "hysteresis of -1 is impossible"),
        (text("anticipation = 2", ""), "anticipation of 2 is impossible: it must be 0 to 1"),
        (text("rates = { hidden = 1.5 }", ""), "rates.hidden of 1.5 is impossible"),
        (text("", "aspect = 0"), "fine.aspect of 0 is impossible: it must be 0.01 to 100"),
        (text("", "opacity = inf"), "fine.opacity of inf is impossible"),
        (
            text("", "").replace("max = 0.2", "max = 0.05"),
            "coarse.density.max of 0.05 is impossible: it must be finite and at least density.min",
        ),
        (
            text("", "").replace("threshold = 0.3", "threshold = 0.1"),
            "medium.threshold of 0.1 is impossible: it must be greater than that of the layer before",
        ),
    ] {
        let found = refusal(&wrong);
        assert!(found.contains(expected) && !found.contains('\n'), "{found}\n{wrong}");
    }
    let missing = read_style("no/such/style.toml").unwrap_err().to_string();
    assert!(missing.starts_with("the style no/such/style.toml cannot be read"), "{missing}");
}
