// SPDX-License-Identifier: MIT OR Apache-2.0
//! Projective rectification (thesis 4.4.2): the matrix, when it exists, and when it is worth taking.

use crate::core::Camera;
use encase::ShaderType;
use glam::{DMat4, DVec3, DVec4, Mat4, Vec3, Vec4};

/// Least share of its far end at which the first column begins: what is nearer belongs to the first texel.
const LEAST_NEAR: f64 = 1e-3;
/// Cosines below are rounding: such a ray is parallel to the light.
const PARALLEL: f64 = 1e-6;
/// Part of the depth range at either end that is kept free of view rays, as in `core/fourier_basis`.
const GUARD: f64 = 0.05;

/// Greatest obliqueness that [`choose`] takes; see [`Projective::obliqueness`]. Against the exact radiance, by three
/// splits of 171 columns and 512 rows with 32 bases, in the scenes foliage, terrain, torus and plane: 0.4, 0.2, 0.3,
/// 1.2 % error at an obliqueness of 1, 0.7, 0.4, 0.7, 2.3 % at 6, 1.2, 0.8, 1.3, 3.7 % at 12 and 4.5, 3.8, 6.5, 9.9 %
/// at 120, where epipolar slices have 0.4, 0.3, 0.3, 1.1 % at 6 and no more than 0.6, 0.4, 0.7, 1.3 % anywhere.
pub const OBLIQUENESS_LIMIT: f32 = 6.0;

/// Why there are no projective rows.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ProjectiveError {
    /// A view ray runs towards the light.
    #[error("the light is in the picture or at its border: projective rows need it outside")]
    LightInView,
    /// A view ray runs away from the light.
    #[error(
        "the point opposite to the light is in the picture or at its border: projective rows need it outside"
    )]
    AntipodeInView,
    /// An orthographic camera looks along the light.
    #[error("the view is parallel to the light: projective rows need an angle between them")]
    ViewParallelToLight,
    /// Some view rays cover next to nothing of their row.
    #[error(
        "the light is too oblique: some view rays end at 1/{obliqueness:.0} of their row, and the limit is 1/{limit:.0}"
    )]
    TooOblique {
        /// Length of the rows over what the shortest view ray covers.
        obliqueness: f32,
        /// The greatest that is taken.
        limit: f32,
    },
    /// The number of splits.
    #[error("{0} splits are impossible: the number must lie between 1 and 4")]
    Splits(u32),
    /// The camera, the light or the limit has a value that is not finite, or the light no direction.
    #[error(
        "projective rows need a finite camera, a light with a direction and a positive limit of the distance"
    )]
    NotFinite,
}

/// The uniform `ProjectiveRows` of `scattering/projective`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct ProjectiveRows {
    /// The eye, or the centre of an orthographic near plane, metres.
    pub origin: Vec3,
    /// X at the left end, metres.
    pub near: f32,
    /// Unit vector of X.
    pub along: Vec3,
    /// Metres of Z for one of X along an orthographic view ray.
    pub tilt: f32,
    /// Unit vector of Y.
    pub across: Vec3,
    /// Slope (orthographic: Y) at the upper border.
    pub row_min: f32,
    /// Unit vector of Z, away from the light.
    pub away: Vec3,
    /// Range of slopes over all rows.
    pub row_span: f32,
    /// Right ends of the splits, metres of X.
    pub bounds: Vec4,
    /// Least slope Z / X of view rays.
    pub depth_min: f32,
    /// Range of those.
    pub depth_span: f32,
    /// Number of splits.
    pub splits: u32,
    /// 0 perspective, 1 orthographic.
    pub projection: u32,
}

/// The uniform `ProjectiveSplit` of the pass `project`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct ProjectiveSplit {
    /// World to the clip space of the split's columns; z / w is the depth in the map, which blockers outside of
    /// the view frustum must be clamped to.
    pub clip_from_world: Mat4,
}

/// Projective rows of a camera and a light.
#[derive(Debug, Clone, PartialEq)]
pub struct Projective {
    /// For the shaders.
    pub rows: ProjectiveRows,
    /// For rasterising, one a split.
    pub splits: Vec<ProjectiveSplit>,
    /// Length of the rows over what the shortest view ray covers of them when it ends at the far plane or the
    /// distance limit, at least 1. In perspective also how much further the columns reach than that ray does.
    pub obliqueness: f32,
}

/// How the shadow map is best rectified.
#[derive(Debug, Clone, PartialEq)]
pub enum Choice {
    /// By a matrix.
    Projective(Box<Projective>),
    /// By epipolar slices, which any perspective camera allows.
    Epipolar {
        /// Why not by a matrix.
        reason: ProjectiveError,
    },
    /// Not at all, and the shadow map is to be marched: an orthographic camera has no epipolar slices.
    March {
        /// Why not by a matrix.
        reason: ProjectiveError,
    },
}

/// The frustum as its corners see it: relative to the origin, metres.
struct Frustum {
    origin: DVec3,
    /// Unit vectors along the corner rays.
    directions: [DVec3; 4],
    near: [DVec3; 4],
    far: [DVec3; 4],
    orthographic: bool,
}

const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

impl Frustum {
    fn new(camera: &Camera, limit: f64) -> Option<Self> {
        let inverse = camera.world_from_clip.as_dmat4();
        let at = |ndc: [f64; 2], depth: f32| inverse * DVec4::new(ndc[0], ndc[1], f64::from(depth), 1.0);
        let frustum = if camera.projection == 0 {
            let eye = camera.eye.as_dvec3();
            let from_eye = |point: DVec4| point.truncate() - eye * point.w;
            let forward = camera.clip_from_world.as_dmat4().row(3).truncate().normalize_or_zero();
            let distance = |depth: f32| {
                let point = at([0.0, 0.0], depth);
                let along = from_eye(point).dot(forward);
                // An infinite far plane has w = 0, or less by rounding.
                if along >= limit * point.w { limit } else { along / point.w }
            };
            let (near, far) = (distance(camera.near_depth), distance(camera.far_depth));
            let directions = CORNERS.map(|ndc| from_eye(at(ndc, camera.far_depth)).normalize_or_zero());
            let slant = directions.map(|direction| direction.dot(forward));
            if !(near > 0.0 && far > 0.0 && slant.iter().all(|cosine| *cosine > PARALLEL)) {
                return None;
            }
            let plane = |distance: f64| std::array::from_fn(|i| directions[i] * (distance / slant[i]));
            Self { origin: eye, directions, near: plane(near.min(far)), far: plane(far), orthographic: false }
        } else {
            let point = |ndc, depth| {
                let point: DVec4 = at(ndc, depth);
                point.truncate() / point.w
            };
            let origin = point([0.0, 0.0], camera.near_depth);
            let view = point([0.0, 0.0], camera.far_depth) - origin;
            let direction = view.normalize_or_zero();
            let near = CORNERS.map(|ndc| point(ndc, camera.near_depth) - origin);
            let far = near.map(|corner| corner + direction * view.length().min(limit));
            Self { origin, directions: [direction; 4], near, far, orthographic: true }
        };
        let corners = frustum.near.iter().chain(&frustum.far);
        (frustum.origin.is_finite() && corners.clone().all(|corner| corner.is_finite())).then_some(frustum)
    }

    /// The unit vector of X: the bisector of the two outermost corner rays as the light sees them.
    fn along(&self, light: DVec3) -> Result<DVec3, ProjectiveError> {
        let flat = self.directions.map(|direction| direction - light * direction.dot(light));
        if self.orthographic {
            let along = flat[0].normalize_or_zero();
            return if flat[0].length() < 1e-4 {
                Err(ProjectiveError::ViewParallelToLight)
            } else {
                Ok(along)
            };
        }
        // The mean direction is inside the cone: it tells the light from its antipode.
        let middle: DVec3 = self.directions.iter().sum();
        let failure = || {
            if middle.dot(light) >= 0.0 {
                ProjectiveError::LightInView
            } else {
                ProjectiveError::AntipodeInView
            }
        };
        let unit = flat.map(DVec3::normalize_or_zero);
        let (mut along, mut least) = (unit[0], f64::INFINITY);
        for (i, j) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            if unit[i].dot(unit[j]) < least {
                least = unit[i].dot(unit[j]);
                // Opposite ones have no bisector, and the light is between them.
                let sum = unit[i] + unit[j];
                along = if sum.length() > PARALLEL { sum.normalize() } else { DVec3::ZERO };
            }
        }
        // All corners are in front of the bisector if and only if the light sees them within a half circle.
        if self.directions.iter().all(|direction| direction.dot(along) > PARALLEL) {
            Ok(along)
        } else {
            Err(failure())
        }
    }
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

/// The rows of a camera and a light, with their matrices; composed in f64. `towards_light`: of any length;
/// `distance_limit`: metres, where rays end that meet nothing; `splits`: 1 to 4, which an orthographic camera does
/// not use.
///
/// # Errors
/// [`ProjectiveError`] names the condition that failed.
pub fn projective_rows(
    camera: &Camera,
    towards_light: Vec3,
    distance_limit: f32,
    splits: u32,
) -> Result<Projective, ProjectiveError> {
    if !(1..=4).contains(&splits) {
        return Err(ProjectiveError::Splits(splits));
    }
    let light = towards_light.as_dvec3().normalize_or_zero();
    let finite = camera.world_from_clip.is_finite() && camera.clip_from_world.is_finite();
    if !(finite
        && light.is_finite()
        && light != DVec3::ZERO
        && distance_limit > 0.0
        && distance_limit.is_finite())
    {
        return Err(ProjectiveError::NotFinite);
    }
    let frustum = Frustum::new(camera, f64::from(distance_limit)).ok_or(ProjectiveError::NotFinite)?;
    let away = -light;
    let along = frustum.along(light)?;
    let across = away.cross(along);
    let view = frustum.directions[0];
    let tilt = if frustum.orthographic { view.dot(away) / view.dot(along) } else { 0.0 };

    let corners = || frustum.near.iter().chain(&frustum.far);
    let (near, far) = range(corners().map(|corner| corner.dot(along)));
    let slopes = |axis: DVec3, tilt: f64| {
        let slope = |corner: &DVec3| {
            let x = corner.dot(along);
            corner.dot(axis) / if frustum.orthographic { 1.0 } else { x } - tilt * x
        };
        let (low, high) = range(corners().map(slope));
        (low, (high - low).max(1e-6))
    };
    let (row_min, row_span) = slopes(across, 0.0);
    let (depth_min, depth_span) = slopes(away, tilt);
    // What the shortest ray covers, of all that the columns cover.
    let (shortest, _) = range((0..4).map(|i| {
        let end = frustum.far[i].dot(along);
        if frustum.orthographic { end - frustum.near[i].dot(along) } else { end }
    }));
    let length = if frustum.orthographic { far - near } else { far };
    let limit = 1.0 / LEAST_NEAR;
    let obliqueness = (length / shortest) as f32;
    if !obliqueness.is_finite() || f64::from(obliqueness) > limit {
        return Err(ProjectiveError::TooOblique { obliqueness, limit: limit as f32 });
    }

    let splits = if frustum.orthographic { 1 } else { splits };
    let near = if frustum.orthographic { near } else { near.max(far * LEAST_NEAR).min(far * 0.999) };
    let mut edges = [far; 5];
    for (k, edge) in edges.iter_mut().enumerate().take(splits as usize) {
        *edge = if k == 0 { near } else { near * (far / near).powf(k as f64 / f64::from(splits)) };
    }
    let homogeneous = |axis: DVec3| axis.extend(-axis.dot(frustum.origin));
    let (x, y, z) = (homogeneous(along), homogeneous(across), homogeneous(away));
    let w = if frustum.orthographic { DVec4::W } else { x };
    let matrix = |begin: f64, end: f64| {
        let from_begin = (x - DVec4::W * begin) / (end - begin);
        let u = if frustum.orthographic { from_begin } else { from_begin * end };
        let v = (y - w * row_min) / row_span;
        let unit = (z - x * tilt - w * depth_min) / depth_span;
        let rows = [u * 2.0 - w, w - v * 2.0, w * GUARD + unit * (1.0 - 2.0 * GUARD), w];
        DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose()
    };
    let matrices = edges.windows(2).take(splits as usize);
    Ok(Projective {
        splits: matrices
            .map(|edge| ProjectiveSplit { clip_from_world: matrix(edge[0], edge[1]).as_mat4() })
            .collect(),
        rows: ProjectiveRows {
            origin: frustum.origin.as_vec3(),
            near: near as f32,
            along: along.as_vec3(),
            tilt: tilt as f32,
            across: across.as_vec3(),
            row_min: row_min as f32,
            away: away.as_vec3(),
            row_span: row_span as f32,
            bounds: Vec4::from_array(std::array::from_fn(|i| edges[i + 1] as f32)),
            depth_min: depth_min as f32,
            depth_span: depth_span as f32,
            splits,
            projection: camera.projection,
        },
        obliqueness,
    })
}

/// Chooses projective rows where they exist and are good, and says why where not. Parameters as of
/// [`projective_rows`].
pub fn choose(camera: &Camera, towards_light: Vec3, distance_limit: f32, splits: u32) -> Choice {
    let limit = OBLIQUENESS_LIMIT;
    let reason = match projective_rows(camera, towards_light, distance_limit, splits) {
        Ok(rows) if rows.obliqueness <= limit => return Choice::Projective(Box::new(rows)),
        Ok(rows) => ProjectiveError::TooOblique { obliqueness: rows.obliqueness, limit },
        Err(reason) => reason,
    };
    if camera.projection == 0 { Choice::Epipolar { reason } } else { Choice::March { reason } }
}
