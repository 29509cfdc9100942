// SPDX-License-Identifier: MIT OR Apache-2.0
//! The flags of `airlight stylize`, and which of them cannot be meant together.

use super::holes::KeyedHoles;
use crate::command::CommandError;
use crate::command::scattering::{self, JitterSpelling};
use crate::command::sequence::{FrameRange, frames, rate};
use crate::stylize::{Element, Form, Keyed, Operator, ShadowOperator, Width};
use clap::ValueEnum;
use std::path::PathBuf;

/// `--epipolar`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FormSpelling {
    /// By resampling along lines: the same cost for all widths.
    Rectified,
    /// Texel by texel: exact, new blockers are never seen.
    Direct,
}

/// Flags of the command: those of `airlight scattering`, and what is done to shadows and light.
#[derive(clap::Args)]
pub struct Options {
    #[command(flatten)]
    pub scattering: scattering::Options,
    /// Closes holes of the shadow map with a box of K texels, odd; key frames 0:5,48:31.
    #[arg(long, value_name = "K", value_parser = widths, allow_hyphen_values = true, help_heading = HEADING)]
    pub close_box: Option<Keyed<f32>>,
    /// Closes holes of the shadow map with a disc of K texels, odd; key frames 0:5,48:31.
    #[arg(long, value_name = "K", value_parser = widths, allow_hyphen_values = true, help_heading = HEADING)]
    pub close_disc: Option<Keyed<f32>>,
    /// Closes holes of the shadow map along view rays, K texels, odd; key frames 0:5,48:31.
    #[arg(long, value_name = "K", value_parser = widths, allow_hyphen_values = true, help_heading = HEADING)]
    pub close_epipolar: Option<Keyed<f32>>,
    /// Extrudes blockers along view rays, away from the eye, by K - 1 texels, K odd; key frames 0:5,48:31.
    #[arg(long, value_name = "K", value_parser = widths, allow_hyphen_values = true, help_heading = HEADING)]
    pub extrude: Option<Keyed<f32>>,
    /// How --close-epipolar and --extrude follow view rays [default: direct].
    #[arg(long, value_enum, help_heading = HEADING)]
    pub epipolar: Option<FormSpelling>,
    /// Random holes in shadows: NAME=NUMBER,… of size (m), density, octaves, persistence, seed, time (s), distance (m), turn
    /// (degrees) and pace; key frames size=0:0.2/48:0.6.
    #[arg(long, value_name = "NAME=N,…", value_parser = super::holes::holes, allow_hyphen_values = true, help_heading = HEADING)]
    pub holes: Option<KeyedHoles>,
    /// One of the --mesh files, whose shadow alone gets the holes; may be given several times [default: all].
    #[arg(long, value_name = "MESH", help_heading = HEADING)]
    pub holes_on: Vec<PathBuf>,
    /// Transfer function that recolours scattered light, a TOML file.
    #[arg(long, value_name = "FILE.toml", help_heading = HEADING)]
    pub transfer: Option<PathBuf>,
    /// Prints where a pixel lies in the transfer function, as a line for a constraint; may be given several times.
    #[arg(long, value_name = "X,Y", value_parser = pixel, allow_hyphen_values = true, help_heading = HEADING)]
    pub pick: Vec<[u32; 2]>,
    /// Frames A to B, both included: pictures NAME.0000.png beside --out, and at --out an animated PNG of them.
    #[arg(long, value_name = "A..B", value_parser = frames, allow_hyphen_values = true, help_heading = HEADING)]
    pub frames: Option<FrameRange>,
    /// Frames a second, 0.001 to 1000 [default: 24].
    #[arg(long, value_name = "N", value_parser = rate, allow_hyphen_values = true, help_heading = HEADING)]
    pub rate: Option<f32>,
}

const HEADING: &str = "Stylization";

/// The width of a kernel, key-framed.
fn widths(text: &str) -> Result<Keyed<f32>, String> {
    let said = |error: &dyn std::fmt::Display| error.to_string();
    if !text.contains(':') {
        let width: Width = text.parse().map_err(|error| said(&error))?;
        return Ok(Keyed::constant(width.texels() as f32));
    }
    let keyed: Keyed<f32> = text.parse().map_err(|error| said(&error))?;
    for (frame, width) in keyed.keys() {
        Width::try_from(f64::from(*width)).map_err(|error| format!("frame {frame}: {error}"))?;
    }
    Ok(keyed)
}

/// `X,Y`: column and row.
fn pixel(text: &str) -> Result<[u32; 2], String> {
    let wrong = || format!("`{text}` is not a pixel X,Y such as 320,200: column and row from 0 on");
    let (x, y) = text.split_once(',').ok_or_else(wrong)?;
    let parse = |side: &str| side.trim().parse::<u32>().map_err(|_| wrong());
    Ok([parse(x)?, parse(y)?])
}

impl Options {
    /// Checks what the flags alone say.
    ///
    /// # Errors
    /// Misuse: a value, or two flags that cannot be meant together.
    pub fn check(&self) -> Result<(), CommandError> {
        self.scattering.check(true)?;
        let refuse = |flag: &str, problem: String| Err(CommandError::misuse(flag, problem));
        for (refused, flag, problem) in self.rules() {
            if refused {
                return refuse(flag, problem.to_owned());
            }
        }
        for mesh in &self.holes_on {
            if !self.scattering.mesh.contains(mesh) {
                let known: Vec<_> =
                    self.scattering.mesh.iter().map(|mesh| mesh.display().to_string()).collect();
                let (mesh, known) = (mesh.display(), known.join(", "));
                return refuse("--holes-on", format!("`{mesh}` is no --mesh: give one of {known}"));
            }
        }
        let [width, height] = self.picture_size();
        for [x, y] in &self.pick {
            if *x >= width || *y >= height {
                let problem = format!("pixel {x},{y} lies outside the picture of {width}x{height}");
                return refuse("--pick", problem);
            }
        }
        let png = self.scattering.out.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        if self.frames.is_some() && !png {
            let out = self.scattering.out.display();
            return refuse("--frames", format!("an animation is a .png: give another --out than `{out}`"));
        }
        Ok(())
    }

    fn rules(&self) -> [(bool, &'static str, &'static str); 6] {
        let along = self.close_epipolar.is_some() || self.extrude.is_some();
        let moves = self.holes.as_ref().is_some_and(KeyedHoles::moves);
        let jitter = self.scattering.jitter != JitterSpelling::None;
        let changes =
            moves || jitter || self.transfer.is_some() || self.widths().any(|keyed| keyed.keys().len() > 1);
        [
            (
                self.epipolar.is_some() && !along,
                "--epipolar",
                "nothing is done along view rays: give --close-epipolar or --extrude as well, or leave it out",
            ),
            (
                self.holes.is_some() && self.scattering.cascades.is_some(),
                "--holes",
                "their pattern would break from one of the --cascades to the next: leave one of both out",
            ),
            (
                !self.holes_on.is_empty() && self.holes.is_none(),
                "--holes-on",
                "there are no holes: give --holes as well, such as size=0.3,density=0.2",
            ),
            (
                self.frames.is_some() && self.scattering.frame.is_some(),
                "--frame",
                "it is for a single picture: leave it or --frames out",
            ),
            (
                self.scattering.frame.is_some() && !changes,
                "--frame",
                "nothing changes with it: give key frames, holes with a distance, --transfer or --jitter, or leave it out",
            ),
            (
                self.rate.is_some() && self.frames.is_none() && !moves,
                "--rate",
                "nothing changes with it: give --frames, or holes with a distance, or leave it out",
            ),
        ]
    }

    /// Every width that is given.
    fn widths(&self) -> impl Iterator<Item = &Keyed<f32>> {
        [&self.close_box, &self.close_disc, &self.close_epipolar, &self.extrude].into_iter().flatten()
    }

    /// Width and height of what is written: both eyes side by side.
    pub fn picture_size(&self) -> [u32; 2] {
        let [width, height] = self.scattering.size;
        [if self.scattering.stereo.is_some() { width.saturating_mul(2) } else { width }, height]
    }

    /// The operators of a frame, in their order.
    pub fn operators(&self, frame: f32) -> Vec<ShadowOperator> {
        let form = match self.epipolar.unwrap_or(FormSpelling::Direct) {
            FormSpelling::Rectified => Form::Rectified,
            FormSpelling::Direct => Form::Direct,
        };
        let across = |keyed: &Keyed<f32>, element| ShadowOperator::Across {
            operator: Operator::Closing,
            element,
            width: keyed.width(frame),
        };
        let along = |keyed: &Keyed<f32>, operator| ShadowOperator::Along {
            operator,
            form,
            width: keyed.width(frame),
        };
        let all = [
            self.close_box.as_ref().map(|keyed| across(keyed, Element::Box)),
            self.close_disc.as_ref().map(|keyed| across(keyed, Element::Disc)),
            self.close_epipolar.as_ref().map(|keyed| along(keyed, Operator::Closing)),
            self.extrude.as_ref().map(|keyed| along(keyed, Operator::Dilation)),
        ];
        all.into_iter().flatten().collect()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Typed {
        #[command(flatten)]
        options: Options,
    }

    #[test]
    fn operators_follow_each_other_in_one_order_whatever_was_typed_first() {
        let typed =
            "x --mesh a.obj --out x.png --extrude 3 --close-epipolar 5 --close-disc 7 --close-box 0:9,4:15";
        let options = Typed::parse_from(typed.split(' ')).options;
        let width = |texels| Width::new(texels).unwrap();
        let closing = |element, texels| ShadowOperator::Across {
            operator: Operator::Closing,
            element,
            width: width(texels),
        };
        let along = |operator, texels| {
            let form = Form::Direct;
            ShadowOperator::Along { operator, form, width: width(texels) }
        };
        let expected = [
            closing(Element::Box, 13),
            closing(Element::Disc, 7),
            along(Operator::Closing, 5),
            along(Operator::Dilation, 3),
        ];
        // Between 9 and 15 lies 12.
        assert_eq!(options.operators(2.0), expected);
    }

    #[test]
    fn widths_and_pixels_are_read_and_nonsense_refused() {
        assert_eq!(widths("11").unwrap(), Keyed::constant(11.0));
        assert_eq!(widths("0:5,48:31").unwrap().width(24.0).texels(), 19);
        for (wrong, said) in [
            ("4", "4 texels"),
            ("0", "0 texels"),
            ("-3", "-3 texels"),
            ("nan", "odd"),
            ("wide", "`wide`"),
            ("0:4", "frame 0: a kernel of 4"),
            ("0:5,8:nan", "0:5,8:nan"),
            ("8:5,0:3", "ascend"),
            ("0:5,0:7", "ascend"),
            ("0:5,", "0:5,"),
        ] {
            let error = widths(wrong).unwrap_err();
            assert!(error.contains(said), "{wrong}: {error}");
        }
        assert_eq!(pixel("320,200"), Ok([320, 200]));
        for wrong in ["", "1", "1,2,3", "-1,2", "1.5,2", "a,b"] {
            assert!(pixel(wrong).unwrap_err().contains(wrong), "{wrong}");
        }
    }
}
