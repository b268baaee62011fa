//! What a step drive makes of its two inputs.
//!
//! A drive steps at the leading edge of a pulse, in the direction that its other input shows then. How long levels have stood is
//! measured, so that a data sheet's least times can be compared. Nothing here knows how pulses are made.

/// The least times that were seen at a drive's inputs, in the unit of the instants; [`u64::MAX`] where none was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Least {
    /// From a pulse's leading edge to its trailing one.
    pub pulse: u64,
    /// From a pulse's trailing edge to the next leading one.
    pub gap: u64,
    /// From a change of direction to the next leading edge.
    pub setup: u64,
    /// From a trailing edge to the next change of direction; 0 where the direction changes within a pulse.
    pub hold: u64,
}

/// A drive's inputs, whatever their polarity, and where its steps have led.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Receiver {
    pulse: bool,
    forward: bool,
    position: i64,
    /// Instants of the last edges, where there were any.
    led: Option<u64>,
    trailed: Option<u64>,
    turned: Option<u64>,
    least: Least,
}

impl Receiver {
    /// At position 0, with no pulse and the positive direction.
    pub const fn new() -> Self {
        let least = Least { pulse: u64::MAX, gap: u64::MAX, setup: u64::MAX, hold: u64::MAX };
        Self { pulse: false, forward: true, position: 0, led: None, trailed: None, turned: None, least }
    }

    /// Takes both levels as they are from the instant `now` on. Returns the direction of a step, true for the positive one, where a
    /// pulse begins.
    pub fn see(&mut self, now: u64, pulse: bool, forward: bool) -> Option<bool> {
        let since = |instant: Option<u64>| instant.map_or(u64::MAX, |instant| now.saturating_sub(instant));
        if self.pulse && !pulse {
            self.least.pulse = self.least.pulse.min(since(self.led));
            self.trailed = Some(now);
        }
        if self.forward != forward {
            let hold = if self.pulse { 0 } else { since(self.trailed) };
            self.least.hold = self.least.hold.min(hold);
            self.turned = Some(now);
            self.forward = forward;
        }
        let begins = pulse && !self.pulse;
        self.pulse = pulse;
        if !begins {
            return None;
        }
        self.least.gap = self.least.gap.min(since(self.trailed));
        self.least.setup = self.least.setup.min(since(self.turned));
        self.led = Some(now);
        self.position = self.position.saturating_add(if forward { 1 } else { -1 });
        Some(forward)
    }

    /// Where the steps have led.
    pub const fn position(&self) -> i64 {
        self.position
    }

    /// The least times so far.
    pub const fn least(&self) -> Least {
        self.least
    }
}

impl Default for Receiver {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every time of a drawn diagram.
    #[test]
    fn edges_are_measured() {
        let mut drive = Receiver::new();
        for (now, pulse, forward, step) in [
            (10, true, true, Some(true)),
            (13, false, true, None),
            (20, true, true, Some(true)),
            (25, false, true, None),
            (32, false, false, None),
            (36, true, false, Some(false)),
            (40, false, false, None),
        ] {
            assert_eq!(drive.see(now, pulse, forward), step, "{now}");
        }
        assert_eq!(drive.position(), 1);
        assert_eq!(drive.least(), Least { pulse: 3, gap: 7, setup: 4, hold: 7 });
    }

    /// A direction that changes with an edge, or within a pulse, has not been held, or not been set up.
    #[test]
    fn what_comes_at_once_has_no_time() {
        let mut drive = Receiver::new();
        drive.see(5, true, false);
        assert_eq!((drive.position(), drive.least().setup), (-1, 0));
        drive.see(7, false, true);
        assert_eq!(drive.least().hold, 0);
        let mut drive = Receiver::new();
        drive.see(5, true, true);
        drive.see(7, true, false);
        assert_eq!(drive.least().hold, 0);
    }
}
