//! Systems in which every unknown meets its two neighbours, in a row or in a ring.

/// b_k x_{k-1} + d_k x_k + a_k x_{k+1} = r_k, one row of it; x may be a vector.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row<const D: usize> {
    pub before: f64,
    pub diagonal: f64,
    pub after: f64,
    pub right: [f64; D],
}

/// Solves a system whose diagonal dominates. In a ring the first row's `before` stands for the last unknown, and the last row's `after`
/// for the first one; in a row they say nothing.
pub(super) fn solve<const D: usize>(rows: &[Row<D>], ring: bool) -> Vec<[f64; D]> {
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return Vec::new() };
    if !ring || rows.len() < 3 {
        return in_row(rows);
    }
    // Sherman & Morrison: the corners as a product of two vectors, which a second right-hand side takes away.
    let (low, high, pivot) = (last.after, first.before, -first.diagonal);
    let count = rows.len();
    let open = |k: usize, right: [f64; D], row: &Row<D>| {
        let diagonal = match k {
            0 => row.diagonal - pivot,
            _ if k + 1 == count => row.diagonal - low * high / pivot,
            _ => row.diagonal,
        };
        Row { diagonal, right, ..*row }
    };
    let plain = in_row(&rows.iter().enumerate().map(|(k, row)| open(k, row.right, row)).collect::<Vec<_>>());
    let unit = |k: usize| match k {
        0 => [pivot; D],
        _ if k + 1 == count => [low; D],
        _ => [0.0; D],
    };
    let turned = in_row(&rows.iter().enumerate().map(|(k, row)| open(k, unit(k), row)).collect::<Vec<_>>());
    let mix = high / pivot;
    let seen = |x: &[[f64; D]], axis: usize| x[0][axis] + mix * x[count - 1][axis];
    let mut solution = plain.clone();
    for axis in 0..D {
        let factor = seen(&plain, axis) / (1.0 + seen(&turned, axis));
        for (x, turned) in solution.iter_mut().zip(&turned) {
            x[axis] -= factor * turned[axis];
        }
    }
    solution
}

/// Thomas's algorithm.
fn in_row<const D: usize>(rows: &[Row<D>]) -> Vec<[f64; D]> {
    let mut solution = Vec::with_capacity(rows.len());
    let mut factors = Vec::with_capacity(rows.len());
    let (mut factor, mut previous) = (0.0, [0.0; D]);
    for row in rows {
        let pivot = row.diagonal - row.before * factor;
        previous = std::array::from_fn(|axis| (row.right[axis] - row.before * previous[axis]) / pivot);
        factor = row.after / pivot;
        solution.push(previous);
        factors.push(factor);
    }
    let mut next = [0.0; D];
    for (x, factor) in solution.iter_mut().zip(factors).rev() {
        next = std::array::from_fn(|axis| x[axis] - factor * next[axis]);
        *x = next;
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every row holds of what comes out, in a row and in rings of three and more.
    #[test]
    fn every_equation_holds() {
        for (count, ring) in [(1, false), (2, false), (7, false), (3, true), (8, true)] {
            let rows: Vec<Row<2>> = (0..count)
                .map(|k| {
                    let x = k as f64;
                    Row { before: 1.0 + 0.1 * x, diagonal: 5.0 + x, after: 2.0 - 0.1 * x, right: [x.sin(), 3.0 - x] }
                })
                .collect();
            let x = solve(&rows, ring);
            for (k, row) in rows.iter().enumerate() {
                let at = |step: usize, stands: bool| if stands { x[(k + step) % count] } else { [0.0; 2] };
                let (before, after) = (at(count - 1, ring || k > 0), at(1, ring || k + 1 < count));
                for (((before, here), after), right) in before.iter().zip(x[k]).zip(after).zip(row.right) {
                    let sum = row.before * before + row.diagonal * here + row.after * after;
                    assert!((sum - right).abs() < 1e-13, "{count} {ring}: row {k}");
                }
            }
        }
    }
}
