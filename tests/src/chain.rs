//! Contours built segment by segment, and moved, turned, scaled, mirrored and reversed as wholes.

use shared::complex::Complex;
use shared::curve::{Arc, Curve as _, Line, PhQuintic, Segment, Spline, hermite};

use host_sim::contour::Contour;

/// A contour while it is being built. Every segment begins where the one before it ends.
#[derive(Clone, Debug)]
pub struct Chain {
    start: Complex<f64>,
    end: Complex<f64>,
    segments: Vec<Segment<f64>>,
}

impl Chain {
    /// Begins at a point.
    pub fn at(start: Complex<f64>) -> Self {
        Self { start, end: start, segments: Vec::new() }
    }

    /// The line through all of `points`.
    pub fn through(points: &[Complex<f64>]) -> Self {
        let start = points.first().copied().unwrap_or(Complex::ZERO);
        points.iter().skip(1).fold(Self::at(start), |chain, point| chain.line(*point))
    }

    /// Where it ends so far.
    pub fn end(&self) -> Complex<f64> {
        self.end
    }

    /// The segments so far.
    pub fn segments(&self) -> &[Segment<f64>] {
        &self.segments
    }

    /// A segment as it is; it is taken to start at the end.
    pub fn segment(mut self, segment: Segment<f64>) -> Self {
        self.end = segment.point(1.0);
        self.segments.push(segment);
        self
    }

    /// A line.
    pub fn line(mut self, to: Complex<f64>) -> Self {
        self.segments.push(Segment::Line(Line { start: self.end, end: to }));
        self.end = to;
        self
    }

    /// An arc about a centre by a signed angle in radians.
    pub fn turn(self, centre: Complex<f64>, sweep: f64) -> Self {
        let arc = Arc { start: self.end, radius: self.end - centre, sweep };
        self.segment(Segment::Arc(arc))
    }

    /// An arc to a point that turns by `sweep` on the way; with a sweep of zero, a line.
    pub fn bow(mut self, to: Complex<f64>, sweep: f64) -> Self {
        if sweep == 0.0 {
            return self.line(to);
        }
        let radius = (to - self.end) * Complex::new(-0.5, -0.5 / (0.5 * sweep).tan());
        self.segments.push(Segment::Arc(Arc { start: self.end, radius, sweep }));
        // What follows begins at the point that was meant.
        self.end = to;
        self
    }

    /// The PH quintic of least rotation with these end derivatives; a line where there is none.
    pub fn hermite(mut self, to: Complex<f64>, d0: Complex<f64>, d1: Complex<f64>) -> Self {
        match hermite(self.end, to, d0, d1) {
            Ok(curve) => {
                self.segments.push(Segment::Ph(curve));
                self.end = to;
                self
            }
            Err(_) => self.line(to),
        }
    }

    /// The PH quintic of a preimage.
    pub fn ph(self, w: [Complex<f64>; 3]) -> Self {
        let start = self.end;
        self.segment(Segment::Ph(PhQuintic { start, w }))
    }

    /// All segments of another contour that is placed to begin at the end.
    pub fn then(self, other: &Contour) -> Self {
        other.segments.iter().fold(self, |chain, segment| chain.segment(*segment))
    }

    /// As an open contour.
    pub fn open(self) -> Contour {
        Contour { segments: self.segments, closed: false }
    }

    /// As a closed contour, with a line back to the start.
    pub fn close(self) -> Contour {
        let start = self.start;
        self.line(start).closed_as_it_is()
    }

    /// As a closed contour that has come back to its start by itself.
    pub fn closed_as_it_is(self) -> Contour {
        Contour { segments: self.segments, closed: true }
    }
}

/// A similarity of the plane: z to `factor` z + `shift`, after z to its conjugate if it mirrors.
#[derive(Clone, Copy, Debug)]
pub struct Placing {
    /// The scale and the turn.
    pub factor: Complex<f64>,
    /// The shift.
    pub shift: Complex<f64>,
    /// Whether the real axis is a mirror first.
    pub mirror: bool,
}

impl Placing {
    /// A shift.
    pub fn shift(by: Complex<f64>) -> Self {
        Self { factor: Complex::new(1.0, 0.0), shift: by, mirror: false }
    }

    /// A scale and turn about the origin.
    pub fn factor(factor: Complex<f64>) -> Self {
        Self { factor, shift: Complex::ZERO, mirror: false }
    }

    /// The mirror image in the imaginary axis: x to -x.
    pub fn mirror_x() -> Self {
        Self { factor: Complex::new(-1.0, 0.0), shift: Complex::ZERO, mirror: true }
    }

    /// A point's image.
    pub fn point(&self, z: Complex<f64>) -> Complex<f64> {
        self.vector(z) + self.shift
    }

    fn vector(&self, z: Complex<f64>) -> Complex<f64> {
        self.factor * if self.mirror { z.conj() } else { z }
    }

    /// A signed distance's image: right of travel becomes left of it in a mirror.
    pub fn distance(&self, d: f64) -> f64 {
        d * self.factor.norm() * if self.mirror { -1.0 } else { 1.0 }
    }

    /// A segment's image.
    pub fn segment(&self, segment: &Segment<f64>) -> Segment<f64> {
        match segment {
            Segment::Line(line) => Segment::Line(Line { start: self.point(line.start), end: self.point(line.end) }),
            Segment::Arc(arc) => Segment::Arc(Arc {
                start: self.point(arc.start),
                radius: self.vector(arc.radius),
                sweep: if self.mirror { -arc.sweep } else { arc.sweep },
            }),
            Segment::Ph(curve) => {
                let root = self.factor.sqrt();
                let w = curve.w.map(|w| root * if self.mirror { w.conj() } else { w });
                Segment::Ph(PhQuintic { start: self.point(curve.start), w })
            }
            Segment::Spline(spline) => {
                Segment::Spline(Spline { points: spline.points.map(|p| self.point(p)), ..*spline })
            }
        }
    }

    /// A contour's image.
    pub fn contour(&self, contour: &Contour) -> Contour {
        Contour { segments: contour.segments.iter().map(|s| self.segment(s)).collect(), closed: contour.closed }
    }
}

/// The same curve in the other direction.
pub fn reversed(contour: &Contour) -> Contour {
    let segments = contour.segments.iter().rev().map(|segment| match segment {
        Segment::Line(line) => Segment::Line(Line { start: line.end, end: line.start }),
        Segment::Arc(arc) => {
            let radius = arc.derivative(1.0).right() * (1.0 / arc.sweep);
            Segment::Arc(Arc { start: arc.point(1.0), radius, sweep: -arc.sweep })
        }
        Segment::Ph(curve) => {
            // r' changes its sign, and w^2 does when w is turned by a quadrant.
            let [w0, w1, w2] = curve.w.map(Complex::left);
            Segment::Ph(PhQuintic { start: curve.end(), w: [w2, w1, w0] })
        }
        Segment::Spline(spline) => {
            let mut points = spline.points;
            points.reverse();
            Segment::Spline(Spline { points, ..*spline })
        }
    });
    Contour { segments: segments.collect(), closed: contour.closed }
}

/// The diagonal of the contour's extent.
pub fn size(contour: &Contour) -> f64 {
    let [low, high] = contour.extent();
    (high - low).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chain() -> Contour {
        Chain::at(Complex::new(1.0, 2.0))
            .line(Complex::new(4.0, 2.0))
            .bow(Complex::new(5.0, 4.0), 1.1)
            .hermite(Complex::new(2.0, 6.0), Complex::new(-1.0, 3.0), Complex::new(-4.0, -1.0))
            .open()
    }

    #[test]
    fn bows_and_hermite_curves_end_where_they_should() {
        for segments in chain().segments.windows(2) {
            assert!((segments[0].point(1.0) - segments[1].point(0.0)).norm() < 1e-14);
        }
        let Segment::Arc(arc) = chain().segments[1] else { panic!("an arc") };
        assert!((arc.sweep - 1.1).abs() < 1e-15);
    }

    /// Points go where the similarity says, and a reversed curve has the same points at 1 - xi.
    #[test]
    fn images_and_reversals_are_pointwise() {
        let contour = chain();
        let placing = Placing { factor: Complex::new(0.3, -1.2), shift: Complex::new(7.0, 5.0), mirror: true };
        let (image, back) = (placing.contour(&contour), reversed(&contour));
        for (k, segment) in contour.segments.iter().enumerate() {
            for xi in [0.0, 0.2, 0.7, 1.0] {
                assert!((image.segments[k].point(xi) - placing.point(segment.point(xi))).norm() < 1e-13);
                let offset = placing.point(segment.offset_point(xi, 0.5));
                assert!((image.segments[k].offset_point(xi, placing.distance(0.5)) - offset).norm() < 1e-13);
                assert!((back.segments[2 - k].point(1.0 - xi) - segment.point(xi)).norm() < 1e-13);
            }
        }
    }
}
