//! Curves as Sinumerik has them: BSPLINE, by the rule of [`crate::program::sinumerik`].

use std::io::Write;

use super::blocks::decimals;
use super::{WriteError, Writer, check};
use crate::program::Feed;
use crate::program::bspline::{Clamped, projected};

/// The highest weight that the control takes.
const HEAVIEST: f64 = 3.0;

impl<W: Write> Writer<W> {
    /// A Bézier curve is a B-spline of one interval.
    pub(super) fn sinumerik_bezier(&mut self, feed: Feed, points: &[[f64; 3]]) -> Result<(), WriteError> {
        let last = points.len() - 1;
        let points = points.iter().enumerate().map(|(k, &point)| (point, 1.0, if k == last { 1.0 } else { 0.0 }));
        self.bspline(feed, last + 1, &points.collect::<Vec<_>>())
    }

    /// A B-spline.
    pub(super) fn sinumerik_nurbs(&mut self, feed: Feed, curve: &Clamped) -> Result<(), WriteError> {
        let degree = curve.degree;
        if !matches!(degree, 2 | 3) {
            return Err(WriteError::Degree(degree));
        }
        let first = curve.points[0][3];
        let points = curve.points.iter().enumerate().skip(1).map(|(k, &point)| {
            let (place, weight) = projected(point);
            (place, weight / first, if k < degree { 0.0 } else { curve.knots[k + 1] - curve.knots[k] })
        });
        self.bspline(feed, degree, &points.collect::<Vec<_>>())
    }

    /// Writes points with their weights and intervals, looked at before any of them is written.
    fn bspline(&mut self, feed: Feed, degree: usize, points: &[([f64; 3], f64, f64)]) -> Result<(), WriteError> {
        // Its points are blocks of their own.
        if matches!(feed, Feed::Duration(_)) {
            return Err(WriteError::Duration);
        }
        for (place, weight, interval) in points {
            check(place)?;
            check(&[*interval])?;
            if *weight > HEAVIEST {
                return Err(WriteError::Weight(*weight));
            }
        }
        let weighted = points.iter().any(|(_, weight, _)| *weight != 1.0);
        if std::mem::replace(&mut self.spline, true) {
            self.blocks.word("G1");
            self.blocks.end()?;
        }
        self.blocks.word("BSPLINE");
        self.blocks.valued("SD=", &degree.to_string());
        self.feed(feed)?;
        for (place, weight, interval) in points {
            for (letter, value) in ["X", "Y", "Z"].into_iter().zip(place) {
                self.blocks.valued(letter, &decimals(*value));
            }
            self.blocks.valued("PL=", &interval.to_string());
            if weighted {
                self.blocks.valued("PW=", &weight.to_string());
            }
            self.blocks.end()?;
        }
        Ok(())
    }
}
