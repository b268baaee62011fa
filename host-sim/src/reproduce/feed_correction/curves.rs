//! The curves of the paper: the fan, and an airfoil.

use crate::spline::{Interpolant, Parametrisation, SplineError};

/// One quarter of the fan; the next ones are this one turned by 90, 180 and 270 degrees.
const QUARTER: &str = include_str!("fan.csv");

/// The paper's factor, on a chord of one inch: it has no say in how much the feed fluctuates, only in how finely ticks see it.
const AIRFOIL_MM: f64 = 6.0 * 25.4;

/// As many segments as the paper's airfoil has.
pub const AIRFOIL_SEGMENTS: usize = 48;

/// The 88 points of the fan, in mm.
pub fn fan_points() -> Vec<[f64; 2]> {
    let quarter: Vec<[f64; 2]> = QUARTER.lines().filter_map(point).collect();
    let turned = |turns: usize| quarter.iter().map(move |&p| (0..turns).fold(p, |[x, y], _| [-y, x]));
    (0..4).flat_map(turned).collect()
}

fn point(line: &str) -> Option<[f64; 2]> {
    let mut numbers = line.split([',', ' ', '\t']).filter(|word| !word.is_empty()).map(str::parse::<f64>);
    match (numbers.next(), numbers.next(), numbers.next()) {
        (Some(Ok(x)), Some(Ok(y)), None) => Some([x, y]),
        _ => None,
    }
}

/// The closed C2 cubic through the fan's points by chord length, as in the paper.
pub fn fan() -> Result<Interpolant<2>, SplineError> {
    Interpolant::cubic(&fan_points(), true, Parametrisation::Chord)
}

/// An airfoil: its name and the points of its section from the trailing edge over the top and back, at a chord of 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Airfoil {
    /// What it is called.
    pub name: String,
    /// The points.
    pub points: Vec<[f64; 2]>,
}

impl Airfoil {
    /// NACA 0012 with an edge that closes, from its formula, at the angles of even steps: points are dense at both edges.
    pub fn naca0012() -> Self {
        let half = AIRFOIL_SEGMENTS as i32 / 2;
        let point = |k: i32| {
            let x = 0.5 * (1.0 + (std::f64::consts::PI * f64::from(k) / f64::from(half)).cos());
            let thickness =
                0.6 * (0.2969 * x.sqrt() - 0.1260 * x - 0.3516 * x.powi(2) + 0.2843 * x.powi(3) - 0.1036 * x.powi(4));
            [x, if k <= half { thickness } else { -thickness }]
        };
        Self { name: "NACA 0012, from its formula".to_string(), points: (0..=2 * half).map(point).collect() }
    }

    /// Reads a coordinate file in Selig's form: a name, then x and y a line, from the trailing edge over the top and back. Errors: a
    /// sentence for the file of that name.
    pub fn from_text(file: &str, text: &str) -> Result<Self, String> {
        let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
        let name = lines.next().map_or("", |(_, line)| line.trim()).to_string();
        let points = lines
            .map(|(number, line)| {
                point(line).filter(|p| p.iter().all(|c| c.is_finite())).ok_or_else(|| {
                    format!(
                        "{file}:{}: \"{}\" is no pair of coordinates; a line holds x and y",
                        number + 1,
                        line.trim()
                    )
                })
            })
            .collect::<Result<Vec<_>, _>>()?;
        if points.len() <= AIRFOIL_SEGMENTS {
            return Err(format!(
                "{file}: it has {} points, and {} segments take {}; take a finer file",
                points.len(),
                AIRFOIL_SEGMENTS,
                AIRFOIL_SEGMENTS + 1
            ));
        }
        Ok(Self { name, points })
    }

    /// The approximately arc-length parametrised C3 quintic of 48 segments, through every so manyth point. Errors: a sentence.
    pub fn spline(&self) -> Result<Interpolant<2>, SplineError> {
        let last = self.points.len() - 1;
        let chosen: Vec<[f64; 2]> = (0..=AIRFOIL_SEGMENTS)
            .filter_map(|k| self.points.get((k * last + AIRFOIL_SEGMENTS / 2) / AIRFOIL_SEGMENTS))
            .map(|p| p.map(|c| c * AIRFOIL_MM))
            .collect();
        Interpolant::quintic(&chosen, false, Parametrisation::Arc)
    }
}
