//! One coordinate that starts and stops within an acceleration, in whole units a tick: no rounding, no root, exact ends.

/// Where it is and by how much the last tick moved it. Units of 2^-18 mm, and units a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mover {
    /// Where it is.
    pub position: i32,
    /// By how much the last tick moved it.
    pub velocity: i32,
}

impl Mover {
    /// One tick towards a velocity; `acceleration` is at least 1 unit a tick^2.
    #[inline]
    pub fn toward_velocity(&mut self, velocity: i32, acceleration: i32) {
        let change = velocity.saturating_sub(self.velocity).max(-acceleration).min(acceleration);
        self.go(self.velocity.saturating_add(change));
    }

    /// One tick towards a point, where it comes to rest, at `fastest` at most. 24 rounds at most.
    ///
    /// The velocity is the greatest from which the point is not passed by braking. Braking takes n v - a n (n + 1)/2 after a tick of
    /// velocity v, with n = v/a rounded down.
    #[inline]
    pub fn toward_point(&mut self, point: i32, fastest: i32, acceleration: i32) {
        let way = point.wrapping_sub(self.position);
        let sign = if way < 0 { -1 } else { 1 };
        let distance = i64::from(way.unsigned_abs());
        let velocity = self.velocity.saturating_mul(sign);
        let stops = |velocity: i32| {
            let ticks = velocity.checked_div(acceleration).unwrap_or(0);
            let (v, n, a) = (i64::from(velocity), i64::from(ticks), i64::from(acceleration));
            velocity <= 0 || v + n * v - a * (n * (n + 1) / 2) <= distance
        };
        let mut low = velocity.saturating_sub(acceleration);
        let mut high = velocity.saturating_add(acceleration).min(fastest);
        if stops(low) && low < high {
            if stops(high) {
                low = high;
            }
            // `low` stops in time and `high` does not; their distance halves.
            for _ in 0..24 {
                let middle = low.midpoint(high);
                if middle == low {
                    break;
                }
                if stops(middle) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
        }
        self.go(low.saturating_mul(sign));
    }

    /// Whether it rests at a point.
    pub fn rests_at(&self, point: i32) -> bool {
        self.position == point && self.velocity == 0
    }

    fn go(&mut self, velocity: i32) {
        self.velocity = velocity;
        self.position = self.position.wrapping_add(velocity);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// From any velocity: the acceleration holds in every tick, the end is exact, and it takes the time of a trapezoid.
        #[test]
        fn it_arrives_exactly_within_its_acceleration(
            start in -50_000..50_000_i32, point in -9_000_000..9_000_000_i32, fastest in 50..50_000_i32, a in 1..5_000_i32,
        ) {
            let mut mover = Mover { position: 0, velocity: start };
            let mut before = start;
            // To brake, to come back from there, to speed up and to brake once more.
            let back = f64::from(start).powi(2) / f64::from(a) + f64::from(point).abs();
            let most = f64::from(start).abs() / f64::from(a) + back / f64::from(fastest)
                + 4.0 * f64::from(fastest) / f64::from(a) + 40.0 + 4.0 * (back / f64::from(a)).sqrt();
            let mut ticks = 0.0;
            while !mover.rests_at(point) {
                mover.toward_point(point, fastest, a);
                prop_assert!((mover.velocity - before).abs() <= a);
                before = mover.velocity;
                ticks += 1.0;
                prop_assert!(ticks < most, "{ticks} ticks, {mover:?}");
            }
        }
    }
}
