//! Boxes around parts of a curve, and a tree of them: what is far away is passed over in one step.

use shared::complex::Complex;
use shared::curve::{Curve as _, Segment};

/// Lower left and upper right corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds([Complex<f64>; 2]);

impl Bounds {
    /// Around nothing: infinitely far from everywhere.
    const EMPTY: Self = {
        let far = f64::INFINITY;
        Self([Complex::new(far, far), Complex::new(-far, -far)])
    };

    /// The box around `points`.
    pub(super) fn around(points: impl IntoIterator<Item = Complex<f64>>) -> Self {
        points.into_iter().fold(Self::EMPTY, |all, p| all.and(Self([p, p])))
    }

    /// A box around the whole of `segment`.
    pub(super) fn of(segment: &Segment<f64>) -> Self {
        match segment {
            Segment::Line(line) => Self::around([line.start, line.end]),
            Segment::Ph(curve) => Self::around(curve.control_points()),
            Segment::Spline(curve) => Self::around(curve.points),
            Segment::Arc(arc) => {
                // Between two of these points an arc leaves their chord by less than half of its part's length.
                let points = (0..=16).map(|k| arc.point(f64::from(k) / 16.0));
                Self::around(points).grown(arc.length() / 32.0)
            }
        }
    }

    /// The box around both.
    fn and(self, other: Self) -> Self {
        let (Self([a, b]), Self([c, d])) = (self, other);
        Self([Complex::new(a.re.min(c.re), a.im.min(c.im)), Complex::new(b.re.max(d.re), b.im.max(d.im))])
    }

    /// Larger by so much on every side.
    pub(super) fn grown(self, by: f64) -> Self {
        let Self([low, high]) = self;
        let by = Complex::new(by, by);
        Self([low - by, high + by])
    }

    /// The square of the distance from `p`; 0 inside.
    fn distance_sqr(&self, p: Complex<f64>) -> f64 {
        let Self([low, high]) = self;
        let x = (low.re - p.re).max(p.re - high.re).max(0.0);
        let y = (low.im - p.im).max(p.im - high.im).max(0.0);
        x * x + y * y
    }

    /// The length of the diagonal; 0 around nothing.
    fn size(&self) -> f64 {
        let Self([low, high]) = self;
        if low.re <= high.re { (*high - *low).norm() } else { 0.0 }
    }
}

/// Boxes of things in an order in which neighbours are near each other, and of pairs of them, pairs of pairs and so on.
#[derive(Debug)]
pub(super) struct Tree {
    /// The box of all stands at 1, those of the two halves of k at 2 k and 2 k + 1.
    boxes: Vec<Bounds>,
    leaves: usize,
}

impl Tree {
    /// Of the boxes of all things.
    pub(super) fn new(leaves: impl ExactSizeIterator<Item = Bounds>) -> Self {
        let count = leaves.len().next_power_of_two();
        let mut boxes = vec![Bounds::EMPTY; count];
        boxes.extend(leaves);
        boxes.resize(2 * count, Bounds::EMPTY);
        for k in (1..count).rev() {
            boxes[k] = boxes[2 * k].and(boxes[2 * k + 1]);
        }
        Self { boxes, leaves: count }
    }

    /// The diagonal of the box of all.
    pub(super) fn size(&self) -> f64 {
        self.boxes.get(1).map_or(0.0, Bounds::size)
    }

    /// Hands to `look` the numbers of things whose boxes are nearer to `p` than `best`, near ones early. It returns what is best
    /// from then on.
    pub(super) fn visit(&self, p: Complex<f64>, mut best: f64, mut look: impl FnMut(usize) -> f64) {
        if let Some(all) = self.boxes.get(1) {
            self.descend((1, all.distance_sqr(p)), p, &mut best, &mut look);
        }
    }

    fn descend(
        &self,
        (node, distance_sqr): (usize, f64),
        p: Complex<f64>,
        best: &mut f64,
        look: &mut impl FnMut(usize) -> f64,
    ) {
        if distance_sqr >= *best * *best {
            return;
        }
        if node >= self.leaves {
            *best = look(node - self.leaves);
            return;
        }
        let [a, b] = [2 * node, 2 * node + 1].map(|half| (half, self.boxes[half].distance_sqr(p)));
        let (near, far) = if a.1 <= b.1 { (a, b) } else { (b, a) };
        self.descend(near, p, best, look);
        self.descend(far, p, best, look);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of boxes one apart, of any number: the nearest is found, and few others are looked at.
    #[test]
    fn the_nearest_is_seen_and_few_others() {
        for count in [1_usize, 2, 5, 64, 1000] {
            let tree = Tree::new((0..count).map(|k| {
                let at = Complex::new(k as f64, 0.0);
                Bounds::around([at]).grown(0.3)
            }));
            assert!((tree.size() - (count as f64 - 0.4).hypot(0.6)).abs() < 1e-12);
            for k in 0..count {
                let p = Complex::new(k as f64 + 0.1, 4.0);
                let (mut found, mut looks) = ((f64::INFINITY, 0), 0);
                tree.visit(p, f64::INFINITY, |number| {
                    looks += 1;
                    let distance = (Complex::new(number as f64, 0.0) - p).norm();
                    if distance < found.0 {
                        found = (distance, number);
                    }
                    found.0
                });
                assert_eq!(found.1, k, "of {count}");
                assert!(looks <= 12, "{looks} of {count}");
            }
        }
        assert_eq!(Tree::new(std::iter::empty()).size(), 0.0);
        Tree::new(std::iter::empty()).visit(Complex::ZERO, f64::INFINITY, |_| panic!("there is nothing"));
    }
}
