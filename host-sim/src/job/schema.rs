//! The contour form as serde reads it: names and types of design section 6, nothing checked yet.

use serde::Deserialize;
use toml::Spanned;

use super::Units;
use super::splines::{RawBezier, RawSpline};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawJob {
    pub units: Units,
    pub closed: Spanned<bool>,
    #[serde(default)]
    pub rest: bool,
    pub tolerance: Option<Spanned<f64>>,
    pub offset: Option<RawOffset>,
    pub feed: Option<RawFeed>,
    #[serde(default)]
    pub segment: Vec<Spanned<RawSegment>>,
    #[serde(default)]
    pub piece: Vec<Spanned<RawPiece>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawOffset {
    pub distance: Spanned<f64>,
    #[serde(rename = "loop")]
    pub chosen: Option<Spanned<usize>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawFeed {
    pub rate: Spanned<f64>,
    pub weight: Option<Spanned<f64>>,
    pub reduction: Option<Spanned<RawReduction>>,
    pub ramp: Option<Spanned<f64>>,
}

#[derive(Clone, Deserialize)]
#[serde(untagged, expecting = "expected a number above 0 and at most 1, or \"auto\"")]
pub(super) enum RawReduction {
    Number(f64),
    Word(String),
}

pub(super) type Point = [f64; 2];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawSegment {
    pub ph: Option<RawPh>,
    pub line: Option<RawLine>,
    pub arc: Option<RawArc>,
    pub hermite: Option<RawHermite>,
    pub bezier: Option<RawBezier>,
    pub spline: Option<RawSpline>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPh {
    pub start: Option<Point>,
    pub w: [Point; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawLine {
    pub start: Option<Point>,
    pub to: Point,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawArc {
    pub start: Option<Point>,
    pub to: Point,
    pub centre: Point,
    pub ccw: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawHermite {
    pub start: Option<Point>,
    pub to: Point,
    pub d0: Point,
    pub d1: Point,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPiece {
    pub segment: Option<usize>,
    pub from: Option<f64>,
    pub to: Option<f64>,
    pub fill: Option<RawFill>,
    #[serde(default)]
    pub start_corner: bool,
    #[serde(default)]
    pub end_corner: bool,
    pub start_ramp: Option<f64>,
    pub start_reduction: Option<f64>,
    pub end_ramp: Option<f64>,
    pub end_reduction: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawFill {
    pub node: usize,
    pub from: Option<f64>,
    pub to: Option<f64>,
}
