//! One number for all setpoints of a run, by which two machines can tell that they moved alike.

use crate::fixed::Position;

/// FNV-1a with 64 bits [Fowler, Noll & Vo], taking a coordinate of 32 bits at a time instead of an octet: a third of a tick's hash is
/// then one exclusive-or and one multiplication.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetpointHash(u64);

impl SetpointHash {
    /// The hash of no setpoints.
    pub const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Takes in the setpoint of one tick.
    #[inline(always)]
    pub fn add(&mut self, setpoint: Position) {
        for coordinate in setpoint {
            self.0 = (self.0 ^ u64::from(coordinate.0 as u32)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// The hash of all setpoints so far.
    pub const fn value(self) -> u64 {
        self.0
    }
}

impl Default for SetpointHash {
    fn default() -> Self {
        Self::new()
    }
}
