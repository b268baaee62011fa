//! Curves as LinuxCNC has them: G5, G5.1, G5.2.

use std::io::Write;

use super::blocks::decimals;
use super::{SAME, WriteError, Writer, check};
use crate::program::bspline::{Clamped, projected};
use crate::program::{Feed, Plane};

/// The highest degree that the reader takes.
const HIGHEST_DEGREE: usize = 15;

impl<W: Write> Writer<W> {
    /// G5 and G5.1.
    pub(super) fn rs274_bezier(&mut self, from: [f64; 3], feed: Feed, points: &[[f64; 3]]) -> Result<(), WriteError> {
        check(points.as_flattened())?;
        if points.iter().any(|point| (point[2] - from[2]).abs() > SAME) {
            return Err(WriteError::Flat);
        }
        self.in_plane(Plane::Xy);
        let [control, .., end] = points else { return Err(WriteError::Degree(points.len())) };
        self.blocks.word(if points.len() == 2 { "G5.1" } else { "G5" });
        self.blocks.valued("I", &decimals(control[0] - from[0]));
        self.blocks.valued("J", &decimals(control[1] - from[1]));
        if let [_, second, _] = points {
            self.blocks.valued("P", &decimals(second[0] - end[0]));
            self.blocks.valued("Q", &decimals(second[1] - end[1]));
        }
        self.blocks.valued("X", &decimals(end[0]));
        self.blocks.valued("Y", &decimals(end[1]));
        self.feed(feed)?;
        self.blocks.end()
    }

    /// G5.2 to G5.3, or the Bézier pieces of a curve whose knots are not equally far apart.
    pub(super) fn rs274_nurbs(&mut self, feed: Feed, curve: &Clamped) -> Result<(), WriteError> {
        if curve.degree > HIGHEST_DEGREE {
            return Err(WriteError::Degree(curve.degree));
        }
        let [_, _, depth, weight] = curve.points[0];
        let depth = depth / weight;
        // A whole spline is looked at before any of it is written.
        for &point in &curve.points {
            let (place, _) = projected(point);
            check(&place)?;
            if (place[2] - depth).abs() > SAME {
                return Err(WriteError::Flat);
            }
        }
        if curve.is_uniform() {
            return self.g5_2(feed, curve.degree, &curve.points);
        }
        // The time of a whole curve is not that of each piece.
        if matches!(feed, Feed::Duration(_)) {
            return Err(WriteError::Duration);
        }
        for piece in curve.pieces() {
            let same = piece.iter().all(|point| (point[3] / piece[0][3] - 1.0).abs() < 1e-15);
            if same && matches!(curve.degree, 2 | 3) {
                let places: Vec<[f64; 3]> = piece.iter().map(|&point| projected(point).0).collect();
                self.rs274_bezier(self.place.unwrap_or(places[0]), feed, &places[1..])?;
            } else {
                self.g5_2(feed, curve.degree, &piece)?;
            }
            self.place = piece.last().map(|&point| projected(point).0);
        }
        Ok(())
    }

    fn g5_2(&mut self, feed: Feed, degree: usize, points: &[[f64; 4]]) -> Result<(), WriteError> {
        let first = points[0][3];
        // A weight that a reader would refuse is found before anything is written.
        let weights: Vec<f64> = points.iter().map(|point| point[3] / first).collect();
        check(&weights)?;
        self.in_plane(Plane::Xy);
        self.blocks.word("G5.2 P1");
        self.blocks.valued("L", &(degree + 1).to_string());
        self.feed(feed)?;
        self.blocks.end()?;
        for (&point, weight) in points.iter().zip(weights).skip(1) {
            let ([x, y, _], _) = projected(point);
            self.blocks.valued("X", &decimals(x));
            self.blocks.valued("Y", &decimals(y));
            self.blocks.valued("P", &weight.to_string());
            self.again();
            self.blocks.end()?;
        }
        self.blocks.word("G5.3");
        self.again();
        self.blocks.end()
    }

    /// With G93 every block that cuts needs its time; here all of them are one motion.
    fn again(&mut self) {
        if let Some(text) = self.feed.as_ref().filter(|_| self.inverse) {
            self.blocks.valued("F", text);
        }
    }
}
