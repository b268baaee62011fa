//! The ring of set/reset words, and the hardware that plays it.
//!
//! TIM8's update, once a slot, asks DMA1 stream 0 (DMAMUX1 request 51) for one word from the ring to port D's set/reset register. The
//! ring stands in SRAM1: DMA1 does not reach the DTCM, where everything else is, RM0433 rev 9 table 3. The core's data cache stays off,
//! so that what the tick writes is in memory when the barrier in `Phase::fill` is past; a firmware that switches it on
//! has to make this region non-cacheable in the MPU.
//!
//! TIM2 and TIM8 run from the same clock, and a tick is [`SLOTS`] slots exactly: once they have been started together, the phase between
//! the tick and the ring never changes. A half begins half a slot before the tick, so that neither the skew of two stores nor
//! an interrupt that comes a little late leaves a doubt which half is played; every tick looks, and misses nothing silently.
//!
//! Where the tick does not come any more, the hardware would play the ring again and again: the watchdog ends that.

use shared::control::{Late, Ring};
use shared::steps::Half;
use stm32h7xx_hal::pac;
use stm32h7xx_hal::rcc::{ResetEnable, rec};

use super::pins::PORTS;
use super::timer::PERIOD;
use crate::hardware::ring::{Phase, RingMemory};

/// Slots in a tick: 0.52 us each.
pub const SLOTS: usize = 1_875;

/// The timers' clocks in a slot.
const SLOT: u32 = PERIOD / SLOTS as u32;

// Or ring and tick would drift.
const _: () = assert!(SLOT * SLOTS as u32 == PERIOD);

/// DMAMUX1's number of TIM8's update request, RM0433 rev 9 table 121.
const TIM8_UPDATE: u32 = 51;

#[unsafe(link_section = ".sram1.ring")]
static MEMORY: RingMemory<SLOTS> = RingMemory::new();

/// See the module.
pub struct StepRing {
    timer: pac::TIM8,
    dma: pac::DMA1,
    mux: pac::DMAMUX1,
    played: bool,
    phase: Phase<SLOTS>,
}

impl StepRing {
    /// A ring that is not played.
    pub(super) fn new(
        (timer, timer_rec): (pac::TIM8, rec::Tim8),
        (dma, dma_rec): (pac::DMA1, rec::Dma1),
        mux: pac::DMAMUX1,
    ) -> Self {
        let _ = timer_rec.enable().reset();
        let _ = dma_rec.enable().reset();
        // SAFETY: the clock of SRAM1, which no other code switches; the HAL has given out the rest of the register by now.
        unsafe { (*pac::RCC::ptr()).ahb2enr.modify(|_, w| w.sram1en().set_bit()) };
        Self { timer, dma, mux, played: false, phase: Phase::new() }
    }

    /// Stops the slots, from wherever: one store, after which no request comes.
    #[inline(always)]
    pub(super) fn off() {
        // SAFETY: zero stops the timer, whatever it did.
        unsafe { (*pac::TIM8::ptr()).cr1.write(|w| w.bits(0)) };
    }

    /// Points the stream at the ring, from its start; false where it cannot be stopped.
    fn aim(&mut self) -> bool {
        let stream = &self.dma.st[0];
        stream.cr.write(|w| w.en().clear_bit());
        // A stream that serves a request takes a few cycles to stop; one that never does is not aimed.
        if (0..1_000).all(|_| stream.cr.read().en().bit_is_set()) {
            return false;
        }
        // SAFETY: nothing plays the ring, and `&mut self` is the only way to it.
        let memory = unsafe { MEMORY.clear() };
        // SAFETY: the values are those of RM0433 rev 9 sections 15.5 and 17.6: words from memory that is the ring's own for ever, to a
        // register whose every value is a valid one; all flags of stream 0 are cleared.
        unsafe {
            self.dma.lifcr.write(|w| w.bits(0x3d));
            self.mux.ccr[0].write(|w| w.bits(TIM8_UPDATE));
            stream.ndtr.write(|w| w.bits(RingMemory::<SLOTS>::WORDS));
            stream.par.write(|w| w.bits((*pac::GPIOD::ptr()).bsrr.as_ptr() as u32));
            stream.m0ar.write(|w| w.bits(memory));
            stream.fcr.write(|w| w.bits(0));
            // Very high priority, words on both sides, memory increments, circular, memory to peripheral.
            stream.cr.write(|w| w.bits(3 << 16 | 2 << 13 | 2 << 11 | 1 << 10 | 1 << 8 | 1 << 6));
        }
        stream.cr.modify(|_, w| w.en().set_bit());
        true
    }
}

impl Ring<PORTS, SLOTS> for StepRing {
    #[inline(always)]
    fn is_played(&self) -> bool {
        self.played
    }

    /// The tick's period begins anew with the ring.
    #[cold]
    #[inline(never)]
    fn play(&mut self, [idle]: [u32; PORTS]) {
        self.stop();
        // SAFETY: port D's set/reset register changes the pins of the word alone, which are outputs.
        unsafe { (*pac::GPIOD::ptr()).bsrr.write(|w| w.bits(idle)) };
        if !self.aim() {
            return;
        }
        self.timer.arr.write(|w| w.arr().bits((SLOT - 1) as u16));
        self.timer.dier.write(|w| w.ude().set_bit());
        self.phase = Phase::new();
        cortex_m::interrupt::free(|_| {
            // SAFETY: the tick's timer is stopped and started within a tick or before the first one, with all interrupts off: whoever
            // owns it sees a period that began here.
            let tick = unsafe { &*pac::TIM2::ptr() };
            tick.cr1.write(|w| w.cen().clear_bit());
            tick.cnt.reset();
            self.timer.cnt.write(|w| w.cnt().bits((SLOT / 2) as u16));
            self.timer.cr1.write(|w| w.cen().set_bit());
            tick.cr1.write(|w| w.cen().set_bit());
        });
        self.played = true;
    }

    #[inline(always)]
    fn stop(&mut self) {
        self.played = false;
        Self::off();
    }

    #[inline(always)]
    fn next_half(&self) -> Result<Half, Late> {
        self.phase.next(self.dma.st[0].ndtr.read().bits())
    }

    #[inline(always)]
    fn words(&mut self, half: Half) -> [&mut [u32; SLOTS]; PORTS] {
        // SAFETY: `play` has initialized the memory; `&mut self` is the only way to it, since the only `StepRing` owns TIM8; the DMA
        // only reads, and in this tick only the other half.
        [unsafe { &mut *MEMORY.half(half) }]
    }

    #[inline(always)]
    fn filled(&mut self, half: Half) {
        self.phase.fill(half);
    }
}
