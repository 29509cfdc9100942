// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which method finds the light shafts, and why.

use super::flags::{MethodSpelling, Options, RectificationSpelling, ReferenceSpelling, SPLITS};
use crate::command::CommandError;
use crate::core::{Camera, Light};
use crate::scattering::{
    Choice, LightForm, Method, Projective, ProjectiveError, Settings, Visibility, choose,
    epipole_near_picture, projective_rows,
};

/// The rows of every view.
pub enum Rows {
    /// Around the light.
    Epipolar,
    /// By a matrix, one a view.
    Projective(Vec<Projective>),
    /// None: the shadow maps are marched.
    None,
}

/// The rows that were chosen, in words too.
pub struct Plan {
    /// The rows.
    pub rows: Rows,
    /// Which they are and why.
    pub reason: String,
}

impl Plan {
    /// Chooses rows for all views alike. `cameras`: those whose pixels are evaluated; `limit`: of distances, metres.
    ///
    /// # Errors
    /// Misuse: rows that were asked for and do not exist.
    pub fn new(
        flags: &Options,
        form: LightForm,
        cameras: &[Camera],
        light: &Light,
        limit: f32,
    ) -> Result<Self, CommandError> {
        let splits = flags.splits.unwrap_or(SPLITS);
        let at_light = cameras.iter().find_map(|camera| LightForm::check_eye(camera, light).err());
        if flags.method == MethodSpelling::March {
            return Ok(Self { rows: Rows::None, reason: "none (--method march)".to_owned() });
        }
        match flags.rectification {
            RectificationSpelling::Epipolar => {
                if let Some(error) = at_light {
                    return Err(CommandError::misuse("--rectification", format!("`epipolar`: {error}")));
                }
                Ok(Self { rows: Rows::Epipolar, reason: "epipolar (as asked for)".to_owned() })
            }
            RectificationSpelling::Projective => {
                let rows = |camera| projective_rows(camera, light.direction, limit, splits);
                let rows: Result<Vec<_>, ProjectiveError> = cameras.iter().map(rows).collect();
                let rows = rows.map_err(|error| {
                    CommandError::misuse(
                        "--rectification",
                        format!("`projective`: {error}: take auto, or turn camera or light"),
                    )
                })?;
                Ok(Self { rows: Rows::Projective(rows), reason: "projective (as asked for)".to_owned() })
            }
            RectificationSpelling::Auto => Ok(automatic(flags, form, cameras, at_light, |camera| {
                choose(camera, light.direction, limit, splits)
            })),
        }
    }

    /// The method of each view. `settings` but for the light's form, whose march is asked for here.
    pub fn methods(
        self,
        flags: &Options,
        settings: Settings,
        cameras: &[Camera],
        light: &Light,
    ) -> Vec<Method> {
        match self.rows {
            Rows::Projective(rows) => {
                rows.into_iter().map(|rows| Method::Projective(settings, Box::new(rows))).collect()
            }
            Rows::Epipolar => {
                let near = |camera| settings.light.local() || epipole_near_picture(camera, light.direction);
                // Views of one picture are marched alike.
                let epipole_march = cameras.iter().any(near);
                cameras.iter().map(|_| Method::Epipolar(Settings { epipole_march, ..settings })).collect()
            }
            Rows::None => {
                let march = Method::March {
                    form: settings.light,
                    steps: flags.steps,
                    weighting: settings.weighting,
                    jitter: flags.jitter.jitter(),
                    frame: flags.frame.unwrap_or(0),
                };
                cameras.iter().map(|_| march.clone()).collect()
            }
        }
    }
}

/// Projective rows where they are good for all views, else epipolar ones, else none.
fn automatic(
    flags: &Options,
    form: LightForm,
    cameras: &[Camera],
    at_light: Option<crate::scattering::SettingsError>,
    choose: impl Fn(&Camera) -> Choice,
) -> Plan {
    let march = |reason: &str| Plan { rows: Rows::None, reason: format!("none, marched instead ({reason})") };
    let epipolar = |reason: &str| Plan { rows: Rows::Epipolar, reason: format!("epipolar ({reason})") };
    let visibility = flags.visibility();
    // Rank queries see through a row to its last texel in either rectification: epipolar rows have theirs where the light is.
    // Moments err alike in both.
    let asked = visibility == Visibility::Fourier || flags.splits.is_some();
    let level = cameras.iter().any(|camera| camera.projection != 0);
    if (asked || level) && form.plain() && flags.reference == ReferenceSpelling::Bisectrix {
        let mut rows = Vec::new();
        for camera in cameras {
            match choose(camera) {
                Choice::Projective(projective) => rows.push(*projective),
                Choice::Epipolar { reason } => return epipolar(&reason.to_string()),
                Choice::March { reason } => return march(&reason.to_string()),
            }
        }
        let reason = "the light is outside of the picture and not too oblique";
        return Plan { rows: Rows::Projective(rows), reason: format!("projective ({reason})") };
    }
    if cameras.iter().any(|camera| camera.projection != 0) {
        return march(
            "an orthographic camera has rows for a directional light without cascades and texture only",
        );
    }
    if let Some(error) = at_light {
        return march(&error.to_string());
    }
    epipolar(if form.local() {
        "rows of a spot or point light go round it"
    } else if form.texture {
        "a light texture is filtered along them only"
    } else if form.shadow_array {
        "cascades are resampled along them only"
    } else if visibility == Visibility::Moments {
        "moments need no others for a perspective camera"
    } else if !asked {
        "rank queries need no others for a perspective camera"
    } else {
        "--reference optimum is of these"
    })
}
