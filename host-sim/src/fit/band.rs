//! Least squares of splines: every data point touches four neighbouring control points, so the normal equations are a band.

use crate::vector::Vector;

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

    /// Adds to row `k` the entries from its diagonal on, and to its right side.
    pub(super) fn add_row(&mut self, k: usize, entries: &[f64; WIDTH], right: Vector) {
        self.rows[k].iter_mut().zip(entries).for_each(|(all, entry)| *all += entry);
        self.right[k] = self.right[k] + right;
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
            let inverse = 1.0 / pivot;
            for step in 1..WIDTH.min(count - k) {
                let factor = row[step] * inverse;
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
            for row in 0..4 {
                let entries =
                    std::array::from_fn(|step| if row + step < 4 { parts[row] * parts[row + step] } else { 0.0 });
                band.add_row(first + row, &entries, sum * parts[row]);
            }
        }
        band.hold(0, points[0]);
        band.hold(8, points[8]);
        for (found, wanted) in band.solve().unwrap().iter().zip(&points) {
            assert!((*found - *wanted).norm() < 1e-8, "{found:?} {wanted:?}");
        }
    }
}
