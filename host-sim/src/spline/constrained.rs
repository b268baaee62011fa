//! The earlier fit of the feed correction polynomial: least squares under six constraints, as 14 linear equations, FC(14).
//!
//! In the normalised way sigma = s/S, as its authors computed it, and solved by Crout's LU decomposition with partial pivoting. Generic
//! over the number, so that a test can solve it in more digits and a count can count.

use std::ops::{Add, Div, Mul, Neg, Sub};

use shared::real::Real;
use shared::spline::Ends;

/// What the equations are solved in.
pub trait Field:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// A number of the text.
    fn of(value: f64) -> Self;

    /// Its magnitude.
    fn size(self) -> Self {
        if self < Self::of(0.0) { -self } else { self }
    }
}

impl<T: Real> Field for T {
    fn of(value: f64) -> Self {
        T::lit(value)
    }
}

/// Unknowns: eight coefficients and six multipliers.
const UNKNOWNS: usize = 14;

/// The coefficients of u over sigma, the highest power first, from samples (s, u), both ends included. None where the system
/// has no solution.
pub fn fit<F: Field>(ends: &Ends<F>, samples: impl IntoIterator<Item = (F, F)>) -> Option<[F; 8]> {
    let zero = F::of(0.0);
    let mut matrix = [[zero; UNKNOWNS]; UNKNOWNS];
    let mut right = [zero; UNKNOWNS];
    for (s, u) in samples {
        let sigma = s / ends.length;
        let mut phi = [F::of(1.0); 8];
        for k in (0..7).rev() {
            phi[k] = phi[k + 1] * sigma;
        }
        for (row, &a) in phi.iter().enumerate() {
            for (slot, &b) in matrix[row].iter_mut().zip(&phi) {
                *slot = *slot + a * b;
            }
            right[row] = right[row] + a * u;
        }
    }
    // FC(12): u, u_s and u_ss at sigma = 0 and 1.
    let start = [[0, 0, 0, 0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 2, 0, 0]];
    let end = [[1; 8], [7, 6, 5, 4, 3, 2, 1, 0], [42, 30, 20, 12, 6, 2, 0, 0]];
    let square = ends.length * ends.length;
    let values = |k: usize| [ends.parameter[k], ends.first[k] * ends.length, ends.second[k] * square];
    let rows = start.into_iter().zip(values(0)).chain(end.into_iter().zip(values(1)));
    for (k, (row, value)) in rows.enumerate() {
        for (j, entry) in row.into_iter().enumerate() {
            let entry = F::of(f64::from(entry));
            matrix[8 + k][j] = entry;
            matrix[j][8 + k] = entry;
        }
        right[8 + k] = value;
    }
    let solution = solve(matrix, right)?;
    Some(std::array::from_fn(|k| solution[k]))
}

/// The number, if it is above zero: not NaN either.
fn positive<F: Field>(number: F) -> Option<F> {
    (number > F::of(0.0)).then_some(number)
}

/// Crout's decomposition with partial pivoting on rows scaled by their largest entry, and both substitutions.
fn solve<F: Field, const N: usize>(mut a: [[F; N]; N], mut right: [F; N]) -> Option<[F; N]> {
    let zero = F::of(0.0);
    let mut scale = [zero; N];
    for (scale, row) in scale.iter_mut().zip(&a) {
        let largest = row.iter().fold(zero, |most, x| if x.size() > most { x.size() } else { most });
        *scale = F::of(1.0) / positive(largest)?;
    }
    for column in 0..N {
        for row in 0..N {
            let mut sum = a[row][column];
            for (k, above) in a.iter().enumerate().take(row.min(column)) {
                sum = sum - a[row][k] * above[column];
            }
            a[row][column] = sum;
        }
        let better = |best: usize, row: usize| {
            if scale[row] * a[row][column].size() > scale[best] * a[best][column].size() { row } else { best }
        };
        let pivot = (column..N).fold(column, better);
        a.swap(pivot, column);
        right.swap(pivot, column);
        scale.swap(pivot, column);
        positive(a[column][column].size())?;
        let inverse = F::of(1.0) / a[column][column];
        for row in a.iter_mut().skip(column + 1) {
            row[column] = row[column] * inverse;
        }
    }
    for row in 0..N {
        for k in 0..row {
            right[row] = right[row] - a[row][k] * right[k];
        }
    }
    for row in (0..N).rev() {
        for k in row + 1..N {
            right[row] = right[row] - a[row][k] * right[k];
        }
        right[row] = right[row] / a[row][row];
    }
    Some(right)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every equation of a system that needs its pivots holds.
    #[test]
    fn a_system_without_a_diagonal_is_solved() {
        let a = [[0.0, 2.0, 1.0], [3.0, 0.0, 1.0], [1.0, 1.0, 0.0]];
        let x = solve(a, [7.0, 6.0, 3.5]).unwrap();
        for (row, right) in a.iter().zip([7.0, 6.0, 3.5]) {
            let sum: f64 = row.iter().zip(x).map(|(a, x)| a * x).sum();
            assert!((sum - right).abs() < 1e-14);
        }
        assert_eq!(solve([[1.0, 2.0], [2.0, 4.0]], [1.0, 1.0]), None);
    }
}
