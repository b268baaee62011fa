//! The ring of set/reset words, and the hardware that plays it.
//!
//! TIM8's update, once a slot, asks DMA2 stream 1 (channel 7, RM0390 rev 6 table 29) for one word from the ring to port C's set/reset
//! register. DMA2 alone reaches the ports, which are on AHB1, and it reaches all of the SRAM, RM0390 rev 6 section 2.1; nothing else uses
//! it. There is no data cache between the core and the SRAM.
//!
//! TIM2 and TIM8 run from the same clock, TIM8 at twice TIM2's rate, and a tick is [`SLOTS`] slots exactly: once they have been started
//! together, the phase between the tick and the ring never changes. A half begins half a slot before the tick, so that neither the skew
//! of two stores to different buses nor an interrupt that comes a little late leaves a doubt which half is played; every tick looks,
//! and misses nothing silently.
//!
//! Where the tick does not come any more, the hardware would play the ring again and again: the watchdog ends that.

use shared::control::{Late, Ring};
use shared::steps::Half;
use stm32f4xx_hal::pac;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use super::pins::PORTS;
use super::timer::TIMER_HZ;
use crate::hardware::ring::{Phase, RingMemory};

/// Slots in a tick: 0.78 us each.
pub const SLOTS: usize = 1_250;

/// The clock of the timers on APB2, in Hz: twice the bus's 80 MHz, RM0390 rev 6 section 6.2.
pub const SLOT_TIMER_HZ: u32 = 160_000_000;

/// The timer's clocks in a slot.
const SLOT: u32 = SLOT_TIMER_HZ / 1024 / SLOTS as u32;

// Or ring and tick would drift.
const _: () = assert!(SLOT * SLOTS as u32 * 1024 == SLOT_TIMER_HZ && SLOT_TIMER_HZ == 2 * TIMER_HZ);

/// TIM8's update request on DMA2 stream 1.
const CHANNEL: u32 = 7;

static MEMORY: RingMemory<SLOTS> = RingMemory::new();

/// See the module.
pub struct StepRing {
    timer: pac::TIM8,
    dma: pac::DMA2,
    played: bool,
    phase: Phase<SLOTS>,
}

impl StepRing {
    /// A ring that is not played.
    pub(super) fn new(timer: pac::TIM8, dma: pac::DMA2, rcc: &mut Rcc) -> Self {
        pac::TIM8::enable(rcc);
        pac::TIM8::reset(rcc);
        pac::DMA2::enable(rcc);
        pac::DMA2::reset(rcc);
        Self { timer, dma, played: false, phase: Phase::new() }
    }

    /// Stops the slots, from wherever: one store, after which no request comes.
    #[inline(always)]
    pub(super) fn off() {
        // SAFETY: zero stops the timer, whatever it did.
        unsafe { (*pac::TIM8::ptr()).cr1().write(|w| w.bits(0)) };
    }

    /// Points the stream at the ring, from its start; false where it cannot be stopped.
    fn aim(&mut self) -> bool {
        let stream = self.dma.st(1);
        stream.cr().write(|w| w.en().clear_bit());
        // A stream that serves a request takes a few cycles to stop; one that never does is not aimed.
        if (0..1_000).all(|_| stream.cr().read().en().bit_is_set()) {
            return false;
        }
        // SAFETY: nothing plays the ring, and `&mut self` is the only way to it.
        let memory = unsafe { MEMORY.clear() };
        // SAFETY: the values are those of RM0390 rev 6 section 9.5: words from memory that is the ring's own for ever, to a register
        // whose every value is a valid one; all flags of stream 1 are cleared.
        unsafe {
            self.dma.lifcr().write(|w| w.bits(0x3d << 6));
            stream.ndtr().write(|w| w.bits(RingMemory::<SLOTS>::WORDS));
            stream.par().write(|w| w.bits((*pac::GPIOC::ptr()).bsrr().as_ptr() as u32));
            stream.m0ar().write(|w| w.bits(memory));
            stream.fcr().write(|w| w.bits(0));
            // Very high priority, words on both sides, memory increments, circular, memory to peripheral.
            stream.cr().write(|w| w.bits(CHANNEL << 25 | 3 << 16 | 2 << 13 | 2 << 11 | 1 << 10 | 1 << 8 | 1 << 6));
        }
        stream.cr().modify(|_, w| w.en().set_bit());
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
        // A request that was left over is withdrawn with this.
        self.timer.dier().write(|w| w.ude().clear_bit());
        // SAFETY: port C's set/reset register changes the pins of the word alone, which are outputs.
        unsafe { (*pac::GPIOC::ptr()).bsrr().write(|w| w.bits(idle)) };
        if !self.aim() {
            return;
        }
        // SAFETY: any number of clocks is a period, RM0390 rev 6 section 16.4.12.
        self.timer.arr().write(|w| unsafe { w.bits(SLOT - 1) });
        self.timer.dier().write(|w| w.ude().set_bit());
        self.phase = Phase::new();
        cortex_m::interrupt::free(|_| {
            // SAFETY: the tick's timer is stopped and started within a tick or before the first one, with all interrupts off: whoever
            // owns it sees a period that began here.
            let tick = unsafe { &*pac::TIM2::ptr() };
            tick.cr1().write(|w| w.cen().clear_bit());
            tick.cnt().reset();
            // SAFETY: any count below the period is one.
            self.timer.cnt().write(|w| unsafe { w.bits(SLOT / 2) });
            self.timer.cr1().write(|w| w.cen().set_bit());
            tick.cr1().write(|w| w.cen().set_bit());
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
        self.phase.next(self.dma.st(1).ndtr().read().bits())
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
