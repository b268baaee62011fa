//! The search for a minimum of a function of one number.

/// The place of a minimum between `a` and `b` by the golden section, to half the digits.
pub fn golden(function: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    const SHARE: f64 = 0.618_033_988_749_894_8;
    let (mut x, mut y) = (b - SHARE * (b - a), a + SHARE * (b - a));
    let (mut fx, mut fy) = (function(x), function(y));
    for _ in 0..48 {
        if fx < fy {
            (b, y, fy) = (y, x, fx);
            x = b - SHARE * (b - a);
            fx = function(x);
        } else {
            (a, x, fx) = (x, y, fy);
            y = a + SHARE * (b - a);
            fy = function(y);
        }
    }
    if fx < fy { x } else { y }
}
