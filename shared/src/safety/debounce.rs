//! Inputs that bounce: a level counts when it has stood for some ticks.

use crate::steps::MOST_AXES;

/// A debounced input for each axis, bit k for axis k. At rest it costs one comparison.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Debounce {
    level: u8,
    counts: [u8; MOST_AXES],
    /// Whether any of the counts is above 0.
    counting: bool,
}

impl Debounce {
    /// The levels that count now.
    #[inline(always)]
    pub fn level(&self) -> u8 {
        self.level
    }

    /// Whether all levels are inactive and stay so: another tick without an active one would change nothing.
    #[inline(always)]
    pub fn rests(&self) -> bool {
        self.level == 0 && !self.counting
    }

    /// One tick: a change counts with the `ticks`-th tick in a row that shows it; 0 and 1 are at once.
    #[inline]
    pub fn step(&mut self, raw: u8, ticks: u8) -> u8 {
        self.asymmetric(raw, ticks, ticks)
    }

    /// One tick, where a change to active takes `on` ticks and one to inactive `off`.
    #[inline]
    pub fn asymmetric(&mut self, raw: u8, on: u8, off: u8) -> u8 {
        let changed = raw ^ self.level;
        if changed == 0 {
            (self.counts, self.counting) = ([0; MOST_AXES], false);
            return self.level;
        }
        let mut bit = 1_u8;
        self.counting = false;
        for count in &mut self.counts {
            if changed & bit == 0 {
                *count = 0;
            } else {
                *count = count.saturating_add(1);
                if *count >= if raw & bit != 0 { on } else { off } {
                    *count = 0;
                    self.level ^= bit;
                }
                self.counting |= *count != 0;
            }
            bit = bit.wrapping_shl(1);
        }
        self.level
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_counts_with_the_last_of_its_ticks_and_a_glitch_never() {
        let mut input = Debounce::default();
        for raw in [1, 1, 0, 1, 1] {
            assert_eq!(input.step(raw, 3), 0);
        }
        assert_eq!(input.step(1, 3), 1);
        assert_eq!([0, 0, 0].map(|raw| input.step(raw, 3)), [1, 1, 0]);
    }

    #[test]
    fn axes_do_not_disturb_each_other_and_a_stop_acts_at_once() {
        let mut input = Debounce::default();
        assert_eq!([0b10, 0b11, 0b10, 0b11].map(|raw| input.asymmetric(raw, 1, 3)), [0b10, 0b11, 0b11, 0b11]);
        assert_eq!([0, 0, 0].map(|raw| input.asymmetric(raw, 1, 3)), [0b11, 0b11, 0]);
    }
}
