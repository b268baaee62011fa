//! The way that a stop takes on the lattice of [`super`], in whole numbers.
//!
//! A level n falls by a slope a tick; the slope itself may change by one a tick. The way of a tick is the sum of its two
//! levels, so that all ways are whole numbers of half units. The shortest stop makes its slopes 1, 2, .. j, stays at j, and
//! goes back j - 1, .. 2, 1: j^2 + (ticks at j) j + rest = n, where one more tick at a slope of `rest` takes what is left.

/// The shortest way in which a level can come to 0 from slope `slope`, at most `steepest` down a tick. Below 0 it cannot go:
/// with a slope of -k the level is at least k (k - 1)/2.
///
/// Exact: the least of all ways (test `the_way_is_the_shortest_there_is`). Some 40 operations, one of them a division and one
/// an integer root of a bounded number of steps.
#[inline(always)]
pub(super) fn stopping_way(level: i32, slope: i32, steepest: i32) -> i32 {
    if slope <= 0 {
        return falling_way(level, -slope, steepest);
    }
    // Up to where the slope is 0, and from there down.
    let top = level + slope * (slope - 1) / 2;
    2 * slope * top - squares(slope - 1) + falling_way(top, 0, steepest)
}

/// The same while the level falls by `slope` already.
#[inline(always)]
fn falling_way(level: i32, slope: i32, steepest: i32) -> i32 {
    // Any such state lies on a stop that began at this level with no slope, `slope` ticks ago.
    let top = level + slope * (slope + 1) / 2;
    let behind = 2 * slope * top - squares(slope);
    let root = top.unsigned_abs().isqrt() as i32;
    let steep = root.min(steepest);
    let more = top - steep * steep;
    let flat = more.checked_div(steep).unwrap_or(0);
    let rest = more - flat * steep;
    let ticks = 2 * steep - 1 + flat;
    // Without the rest the stop is symmetric, so its mean level is half of its top. The tick that takes the rest comes
    // before the last rest - 1.
    (top - rest) * ticks + rest * (2 * ticks + 2 - rest) - behind
}

/// 1 + 4 + .. + k^2.
#[inline(always)]
fn squares(k: i32) -> i32 {
    k * (k + 1) * (2 * k + 1) / 6
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec;
    use std::vec::Vec;

    use super::*;

    /// Dijkstra's principle over all states: the least way to (0, 0), by relaxing until nothing changes.
    fn shortest(levels: i32, steepest: i32) -> impl Fn(i32, i32) -> Option<i32> {
        let width = 2 * steepest + 1;
        let index = move |level: i32, slope: i32| (level * width + slope + steepest) as usize;
        let mut least: Vec<Option<i32>> = vec![None; (levels * width) as usize];
        least[index(0, 0)] = Some(0);
        loop {
            let mut changed = false;
            for level in 0..levels {
                for slope in -steepest..=steepest {
                    for next in [slope - 1, slope, slope + 1] {
                        let after = level + next;
                        if next.abs() > steepest || !(0..levels).contains(&after) || (level, after) == (0, 0) {
                            continue;
                        }
                        if let Some(rest) = least[index(after, next)] {
                            let way = level + after + rest;
                            if least[index(level, slope)].is_none_or(|known| way < known) {
                                least[index(level, slope)] = Some(way);
                                changed = true;
                            }
                        }
                    }
                    // At level 0 a slope of -1, 0 or 1 is a stop.
                    if level == 0 && slope.abs() <= 1 && least[index(0, slope)] != Some(0) {
                        least[index(0, slope)] = Some(0);
                        changed = true;
                    }
                }
            }
            if !changed {
                return move |level, slope| least[index(level, slope)];
            }
        }
    }

    #[test]
    fn the_way_is_the_shortest_there_is() {
        let levels = 90;
        let mut compared = 0;
        for steepest in [1, 2, 3, 5, 12] {
            let least = shortest(levels, steepest);
            for level in 0..levels {
                for slope in -steepest..=steepest {
                    // What cannot stop within the table is not compared; a rising slope of 1 at level 0 is a stop there.
                    let top = level + if slope > 0 { slope * (slope - 1) / 2 } else { 0 };
                    if top >= levels || (level == 0 && slope == 1) {
                        continue;
                    }
                    let reachable = slope >= 0 || level >= slope * (slope + 1) / 2;
                    let expected = least(level, slope);
                    assert_eq!(expected.is_some(), reachable, "level {level}, slope {slope}, steepest {steepest}");
                    if let Some(expected) = expected {
                        assert_eq!(stopping_way(level, slope, steepest), expected, "{level}, {slope}, {steepest}");
                        compared += 1;
                    }
                }
            }
        }
        assert!(compared > 2_000);
    }

    /// The S-shaped stop in closed form: from q with |q'| <= R and |q''| <= J it takes q/R + R/J and half of that times q.
    #[test]
    fn a_long_stop_has_its_closed_form() {
        for (top, steepest) in [(26_215, 102), (52_430, 102), (10_000, 30)] {
            let (n, k) = (f64::from(top), f64::from(steepest));
            let way = f64::from(stopping_way(top, 0, steepest));
            // Whole ticks make it longer by less than one of them at full level.
            let closed = n * (n / k + k);
            assert!(way > closed - n && way < closed + n, "{way} beside {closed}");
        }
    }
}
