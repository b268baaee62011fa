//! The program that is run in every way: a plate milled around at four levels, as CAM writes it, in lines.
//!
//! Straight sides with fillets of 3 to 10 mm between them, a slot, and a side with waves. The lines of a bend are chords within
//! [`CHORD_MM`] of it. From level to level the tool goes straight down.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write as _;

/// How far a chord may be from its bend, in mm: half of what the fits may add.
pub const CHORD_MM: f64 = 0.005;

/// The heights of the levels, in mm.
const LEVELS: [f64; 4] = [-1.0, -2.0, -3.0, -4.0];

/// The feed in mm/min.
pub const FEED: f64 = 6000.0;

/// The outline, as points in mm; it ends where it begins, in the middle of a side.
pub fn outline() -> Vec<[f64; 2]> {
    let mut points = vec![[60.0, 0.0]];
    bend(&mut points, [112.0, 8.0], 8.0, [-FRAC_PI_2, 0.0]);
    wave(&mut points, [120.0, 16.0], 44.0);
    bend(&mut points, [114.0, 74.0], 6.0, [0.0, FRAC_PI_2]);
    bend(&mut points, [70.0, 77.0], 3.0, [FRAC_PI_2, PI]);
    bend(&mut points, [60.0, 70.0], 7.0, [0.0, -PI]);
    bend(&mut points, [50.0, 77.0], 3.0, [0.0, FRAC_PI_2]);
    bend(&mut points, [4.0, 76.0], 4.0, [FRAC_PI_2, PI]);
    bend(&mut points, [10.0, 10.0], 10.0, [PI, 1.5 * PI]);
    points.push([60.0, 0.0]);
    points
}

/// A line to the start of an arc, and the chords of it.
fn bend(points: &mut Vec<[f64; 2]>, [x, y]: [f64; 2], radius: f64, [from, to]: [f64; 2]) {
    // A chord over an angle a is off by r (1 - cos(a/2)).
    let widest = 2.0 * (1.0 - CHORD_MM / radius).acos();
    let count = ((to - from).abs() / widest).ceil() as u32;
    points.extend((0..=count).map(|k| from + (to - from) * f64::from(k) / f64::from(count)).map(|angle| {
        let (sine, cosine) = angle.sin_cos();
        [x + radius * cosine, y + radius * sine]
    }));
}

/// Two waves along y, as high as a mm and a half to the inside, that begin and end along y.
fn wave(points: &mut Vec<[f64; 2]>, [x, y]: [f64; 2], length: f64) {
    const HEIGHT: f64 = 1.5;
    const WAVES: f64 = 2.0;
    let most = 0.5 * HEIGHT * (TAU * WAVES / length).powi(2);
    // A chord over a way w is off by kappa w^2/8.
    let count = (length / (8.0 * CHORD_MM / most).sqrt()).ceil() as u32;
    points.extend(
        (0..=count)
            .map(|k| f64::from(k) / f64::from(count))
            .map(|part| [x - 0.5 * HEIGHT * (1.0 - (TAU * WAVES * part).cos()), y + length * part]),
    );
}

/// The program in RS-274.
pub fn program() -> String {
    let mut text = String::from("(a plate, milled around at four levels)\nG21 G90 G17\nG0 Z5\nG0 X60 Y0\nG0 Z1\n");
    let outline = outline();
    for (number, level) in LEVELS.into_iter().enumerate() {
        let feed = if number == 0 { format!(" F{FEED}") } else { String::new() };
        // Writing to a string does not fail.
        let _ = writeln!(text, "G1 Z{level}{feed}");
        for [x, y] in &outline[1..] {
            let _ = writeln!(text, "X{x:.4} Y{y:.4}");
        }
    }
    text.push_str("G0 Z5\nM30\n");
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// It closes, its chords are short where it bends, and no direction breaks by more than a chord's turn.
    #[test]
    fn the_outline_is_smooth() {
        let points = outline();
        assert_eq!(points.first(), points.last());
        let chords: Vec<[f64; 2]> = points.windows(2).map(|w| [w[1][0] - w[0][0], w[1][1] - w[0][1]]).collect();
        for pair in chords.windows(2) {
            let [[a, b], [c, d]] = [pair[0], pair[1]];
            let turn = (a * d - b * c).atan2(a * c + b * d).abs();
            // On 3 mm a chord within 5 um turns by 0.115.
            assert!(turn < 0.12, "{turn}");
        }
    }
}
