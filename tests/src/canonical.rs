//! What LinuxCNC's interpreter prints of a motion, read and compared.

use host_sim::program::{Arc, Motion};

/// A motion as that interpreter prints it: where it ends, and for an arc its centre and whether it turns left; in inches where the program is.
#[derive(Clone, Debug, PartialEq)]
pub struct Canonical {
    /// The end.
    pub to: [f64; 3],
    /// Of an arc the centre, and whether it turns left.
    pub arc: Option<([f64; 2], bool)>,
}

impl Canonical {
    /// A motion in mm as one in inches. None of a curve without points.
    pub fn of(motion: &Motion<'_>) -> Option<Self> {
        let inch = |mm: f64| mm / 25.4;
        let arc = match motion {
            Motion::Arc(Arc { centre, sweep, .. }) => Some((centre.map(inch), *sweep > 0.0)),
            _ => None,
        };
        Some(Self { to: motion.to()?.map(inch), arc })
    }

    /// The motion of a line of its output; none if it is something else.
    pub fn read(line: &str) -> Option<Self> {
        let (name, rest) = line.split_once("..... ")?.1.split_once('(')?;
        let values: Vec<f64> =
            rest.trim_end().trim_end_matches(')').split(", ").map_while(|text| text.parse().ok()).collect();
        match (name, &values[..]) {
            ("STRAIGHT_TRAVERSE" | "STRAIGHT_FEED", &[x, y, z, ..]) => Some(Self { to: [x, y, z], arc: None }),
            ("ARC_FEED", &[x, y, first, second, turns, z, ..]) => {
                Some(Self { to: [x, y, z], arc: Some(([first, second], turns > 0.0)) })
            }
            _ => None,
        }
    }

    /// Whether both are one but for `close`.
    pub fn is(&self, other: &Self, close: f64) -> bool {
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= close);
        near(&self.to, &other.to)
            && match (self.arc, other.arc) {
                (Some((a, left)), Some((b, other_left))) => left == other_left && near(&a, &b),
                (None, None) => true,
                _ => false,
            }
    }
}
