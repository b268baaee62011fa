//! Zeros of polynomials in Bernstein form.

use shared::polynomial::bernstein_product;

/// Parameters that differ by less than this are one zero: a double zero is found as one, or as two that are this near.
const RESOLUTION: f64 = 1e-12;

/// The zeros inside (0, 1), in order: every one where the sign changes, and those of even order to rounding.
///
/// Bernstein coefficients change their sign at least as often as the polynomial does, so an interval without a change holds no
/// zero and one with a single change holds one; others are halved. Cost: a handful of subdivisions for each zero.
pub fn zeros<const N: usize>(bernstein: [f64; N]) -> Vec<f64> {
    let mut found = Vec::new();
    let mut pending = vec![(bernstein, 0.0, 1.0)];
    while let Some((part, from, to)) = pending.pop() {
        match changes(&part) {
            0 => {}
            1 => found.push(bracketed(part, from, to)),
            _ if to - from < RESOLUTION => found.push(0.5 * (from + to)),
            _ => {
                let middle = 0.5 * (from + to);
                let (left, right) = halves(part);
                if right.first() == Some(&0.0) {
                    // A zero that the middle hits exactly is a change of sign in neither half.
                    found.push(middle);
                }
                pending.push((right, middle, to));
                pending.push((left, from, middle));
            }
        }
    }
    found.retain(|&x| x > 0.0 && x < 1.0);
    found.sort_by(f64::total_cmp);
    found.dedup_by(|b, a| *b - *a < RESOLUTION);
    found
}

/// How often the sign changes along the coefficients; zeros do not count.
fn changes(coefficients: &[f64]) -> usize {
    let mut signs = coefficients.iter().filter(|&&c| c != 0.0).map(|&c| c > 0.0);
    let Some(mut before) = signs.next() else { return 0 };
    let mut count = 0;
    for sign in signs {
        count += usize::from(sign != before);
        before = sign;
    }
    count
}

/// de Casteljau's scheme at the middle: both halves in their own Bernstein form.
fn halves<const N: usize>(mut right: [f64; N]) -> ([f64; N], [f64; N]) {
    let mut left = right;
    for (k, slot) in left.iter_mut().enumerate().skip(1) {
        for j in 0..N - k {
            right[j] = 0.5 * (right[j] + right[j + 1]);
        }
        *slot = right[0];
    }
    (left, right)
}

/// The only zero of a part whose coefficients change their sign once, to the last bit that bisection can tell.
fn bracketed<const N: usize>(mut part: [f64; N], mut from: f64, mut to: f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (from + to);
        let (left, right) = halves(part);
        if changes(&left) > 0 {
            (part, to) = (left, middle);
        } else if changes(&right) > 0 {
            (part, from) = (right, middle);
        } else {
            // The zero is the middle itself.
            return middle;
        }
    }
    0.5 * (from + to)
}

/// The same polynomial in a higher degree: N - M more coefficients.
pub fn elevate<const M: usize, const R: usize, const N: usize>(lower: [f64; M]) -> [f64; N] {
    bernstein_product::<f64, M, R, N>(lower, [1.0; R])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_of_a_product_are_found_in_order() {
        // (x - 0.25)(x - 0.75)(2 - x), each factor in Bernstein form.
        let two: [f64; 3] = bernstein_product([-0.25, 0.75], [-0.75, 0.25]);
        let found = zeros::<4>(bernstein_product(two, [2.0, 1.0]));
        assert!(found.len() == 2 && (found[0] - 0.25).abs() < 1e-15 && (found[1] - 0.75).abs() < 1e-15, "{found:?}");
    }

    #[test]
    fn a_double_zero_is_one_and_a_near_miss_is_none() {
        let square: [f64; 3] = bernstein_product([-0.3, 0.7], [-0.3, 0.7]);
        let found = zeros(square);
        assert!(found.iter().all(|x| (x - 0.3).abs() < 1e-7), "{found:?}");
        assert!(zeros(square.map(|c| c + 1e-9)).is_empty());
        assert_eq!(zeros(square.map(|c| c - 1e-9)).len(), 2);
        assert!(zeros([1.0, 1.0, 2.0]).is_empty() && zeros([0.0, 0.0]).is_empty());
    }

    #[test]
    fn a_zero_in_the_very_middle_is_found() {
        let cubic: [f64; 4] =
            bernstein_product::<f64, 3, 2, 4>(bernstein_product([-0.5, 0.5], [-0.125, 0.875]), [1.0, 2.0]);
        assert_eq!(zeros(cubic).len(), 2);
        assert_eq!(zeros([-0.5, 0.5]), [0.5]);
    }

    #[test]
    fn elevation_changes_nothing() {
        assert_eq!(elevate::<2, 2, 3>([1.0, 3.0]), [1.0, 2.0, 3.0]);
    }
}
