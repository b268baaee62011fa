//! Least squares of splines: every data point touches four neighbouring control points, so the normal equations are a band.

use super::vector::Vector;

/// The half width of the band of a cubic spline, with the diagonal.
const WIDTH: usize = 4;

/// Symmetric positive definite equations for control points.
#[derive(Clone, Debug)]
pub(super) struct Band {
    /// Of row k the entries at columns k to k + 3.
    rows: Vec<[f64; WIDTH]>,
    right: Vec<Vector>,
}

impl Band {
    pub(super) fn new(unknowns: usize) -> Self {
        Self { rows: vec![[0.0; WIDTH]; unknowns], right: vec![Vector::default(); unknowns] }
    }

    /// Adds the square of (the sum of `parts` times the control points from `first` on, less `point`).
    pub(super) fn add(&mut self, first: usize, parts: [f64; WIDTH], point: Vector) {
        for (row, &part) in parts.iter().enumerate() {
            for (column, &other) in parts.iter().enumerate().skip(row) {
                self.rows[first + row][column - row] += part * other;
            }
            self.right[first + row] = self.right[first + row] + point * part;
        }
    }

    /// Holds one control point at a place.
    pub(super) fn hold(&mut self, k: usize, place: Vector) {
        for column in 1..WIDTH {
            if let Some(right) = self.right.get_mut(k + column) {
                *right = *right - place * self.rows[k][column];
            }
            if let Some(row) = k.checked_sub(column) {
                self.right[row] = self.right[row] - place * self.rows[row][column];
                self.rows[row][column] = 0.0;
            }
        }
        self.rows[k] = [1.0, 0.0, 0.0, 0.0];
        self.right[k] = place;
    }

    /// The control points, by Cholesky's factors. None where data leave one of them open.
    pub(super) fn solve(mut self) -> Option<Vec<Vector>> {
        let count = self.rows.len();
        for k in 0..count {
            let pivot = self.rows[k][0];
            if pivot.is_nan() || pivot <= 1e-14 {
                return None;
            }
            let row = self.rows[k];
            for step in 1..WIDTH.min(count - k) {
                let factor = row[step] / pivot;
                for (below, entry) in self.rows[k + step].iter_mut().zip(&row[step..]) {
                    *below -= factor * entry;
                }
                self.right[k + step] = self.right[k + step] - self.right[k] * factor;
            }
        }
        for k in (0..count).rev() {
            let mut right = self.right[k];
            for step in 1..WIDTH.min(count - k) {
                right = right - self.right[k + step] * self.rows[k][step];
            }
            self.right[k] = right * (1.0 / self.rows[k][0]);
        }
        Some(self.right)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Data made from control points give these back.
    #[test]
    fn data_of_a_spline_give_the_spline() {
        let points: Vec<Vector> = (0..9).map(|k| Vector([f64::from(k), f64::from(k * k % 5), 1.0])).collect();
        let mut band = Band::new(points.len());
        for k in 0..60 {
            let first = k % 6;
            let t = f64::from(k as u32) / 60.0;
            let parts = [(1.0 - t) * 0.5, 0.4 * t + 0.1, 0.3, 0.2 + 0.1 * t];
            let sum = (0..4).map(|j| points[first + j] * parts[j]).fold(Vector::default(), |a, b| a + b);
            band.add(first, parts, sum);
        }
        band.hold(0, points[0]);
        band.hold(8, points[8]);
        for (found, wanted) in band.solve().unwrap().iter().zip(&points) {
            assert!((*found - *wanted).norm() < 1e-8, "{found:?} {wanted:?}");
        }
    }
}
