//! What plays the step words: on a board a timer and a DMA, in a simulator a list.

use crate::safety::Fault;
use crate::steps::Half;

/// A ring of two halves for each of `PORTS` ports, and whoever plays it, a half a tick.
pub trait Ring<const PORTS: usize, const SLOTS: usize> {
    /// Whether it is played.
    fn is_played(&self) -> bool;

    /// Plays it from the start of the first half on, full of words that change nothing, with the pins at the levels of `idle`. The next
    /// tick comes with the start of the second half, and fills the first one.
    fn play(&mut self, idle: [u32; PORTS]);

    /// Plays no word from here on.
    fn stop(&mut self);

    /// The half that is to be filled in this tick, the one that is not played. Errors: a tick that came too late for it.
    fn next_half(&self) -> Result<Half, Late>;

    /// The words of a half that [`Ring::next_half`] named in this tick.
    fn words(&mut self, half: Half) -> [&mut [u32; SLOTS]; PORTS];

    /// Takes note that a half is filled.
    fn filled(&mut self, half: Half);
}

/// The tick came too late to fill its half.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Late;

impl From<Late> for Fault {
    fn from(_: Late) -> Self {
        Self::LateTick
    }
}
