//! What the step rings of all boards have in common: two halves in memory, and which of them the tick fills next.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use shared::control::Late;
use shared::steps::Half;

/// The memory of a ring, which nothing initializes before [`RingMemory::clear`]. In which section it stands is the board's.
#[repr(transparent)]
pub struct RingMemory<const SLOTS: usize>(UnsafeCell<MaybeUninit<[[u32; SLOTS]; 2]>>);

// SAFETY: it hands out addresses alone; who uses them says why that is sound.
unsafe impl<const SLOTS: usize> Sync for RingMemory<SLOTS> {}

impl<const SLOTS: usize> RingMemory<SLOTS> {
    /// Words of both halves.
    pub const WORDS: u32 = 2 * SLOTS as u32;

    /// Memory that is not initialized.
    pub const fn new() -> Self {
        Self(UnsafeCell::new(MaybeUninit::uninit()))
    }

    /// Fills both halves with words that change nothing, waits until these are in memory, and returns the address of the first.
    ///
    /// # Safety
    ///
    /// Nothing plays the ring, and nobody else has a reference to it.
    pub unsafe fn clear(&self) -> u32 {
        let memory = self.0.get();
        // SAFETY: the caller's; zeros are words.
        unsafe { memory.write(MaybeUninit::zeroed()) };
        cortex_m::asm::dsb();
        memory as u32
    }

    /// Where a half is.
    #[inline(always)]
    pub fn half(&self, half: Half) -> *mut [u32; SLOTS] {
        let first = self.0.get().cast::<[u32; SLOTS]>();
        match half {
            Half::First => first,
            Half::Second => first.wrapping_add(1),
        }
    }
}

/// Which half is filled next. Every tick looks where the hardware is, so that a tick that is missing is seen.
#[derive(Clone, Copy, Debug)]
pub struct Phase<const SLOTS: usize> {
    /// The half that was filled last.
    filled: Half,
}

impl<const SLOTS: usize> Phase<SLOTS> {
    /// How far into a half the tick may find the hardware: with the other half of the time it fills what comes next.
    const LATEST: usize = SLOTS / 2;

    /// A ring that begins with its first half: that is the first to be filled anew.
    pub const fn new() -> Self {
        Self { filled: Half::Second }
    }

    /// The half that is not played, where the hardware has `left` words to the end of the ring. Errors: it is not the one after
    /// the last, or too much of the other one is past.
    #[inline(always)]
    pub fn next(&self, left: u32) -> Result<Half, Late> {
        let played = (2 * SLOTS).saturating_sub(left as usize);
        let (half, into) = if played < SLOTS { (Half::Second, played) } else { (Half::First, played - SLOTS) };
        if half == self.filled || into > Self::LATEST { Err(Late) } else { Ok(half) }
    }

    /// Takes note that a half is filled, and waits until its words are in memory.
    #[inline(always)]
    pub fn fill(&mut self, half: Half) {
        self.filled = half;
        cortex_m::asm::dsb();
    }
}
