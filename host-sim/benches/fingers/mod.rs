//! A closed contour of any number of segments: fingers around a ring, of PH quintics, lines and arcs, with a corner at every
//! node. It looks the same everywhere and at every size, so that time grows with the number of segments and nothing else.

use std::f64::consts::TAU;

use host_sim::contour::Contour;
use shared::complex::Complex;
use shared::curve::{Arc, Line, Segment, hermite};

/// Segments of one finger.
const PERIOD: usize = 20;
/// Half the length of a finger, in mm; a segment is about 1 mm long.
const REACH: f64 = 3.0;

/// The contour of `count` segments (a multiple of 20, at least 60), anticlockwise, in mm.
pub fn fingers(count: usize) -> Contour {
    let turn = |angle: f64| Complex::new(angle.cos(), angle.sin());
    let node = |k: usize| {
        let part = |period: usize| TAU * (k % period) as f64 / period as f64;
        turn(part(count)) * (count as f64 / TAU + REACH * part(PERIOD).sin())
    };
    // Some angle between -1 and 1 rad; it has no period.
    let some = |k: usize| (12.9898 * k as f64).sin();
    let segment = |k: usize| {
        let (start, end) = (node(k), node(k + 1));
        let chord = end - start;
        match k % 4 {
            0 => Segment::Line(Line { start, end }),
            1 => {
                let sweep = 0.2 + 0.6 * some(k).abs();
                let radius = chord * Complex::new(-0.5, -0.5 / (0.5 * sweep).tan());
                Segment::Arc(Arc { start, radius, sweep })
            }
            _ => {
                // A bow or an S.
                let [a, b] = [0.3 + 0.2 * some(k), (0.3 + 0.2 * some(k + 1)) * some(k + 2).signum()];
                let [d0, d1] = [chord * turn(a), chord * turn(b)];
                hermite(start, end, d0, d1).map_or(Segment::Line(Line { start, end }), Segment::Ph)
            }
        }
    };
    Contour { segments: (0..count).map(segment).collect(), closed: true }
}
