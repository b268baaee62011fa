//! The line: bytes between a serial port and two queues.
//!
//! The port has room for one byte, and the tick is longer than a byte at 921 600 baud. So DMA1 stream 5 (channel 4, RM0390 rev 6
//! table 28) puts what is received into memory, as much as a sender may have under way; the interrupt comes when the line falls
//! idle, and the task of the link looks too, every 4 ms at least.

use core::cell::UnsafeCell;

use heapless::spsc::{Consumer, Producer};
use shared::link::sender::RECEIVE_SIZE;
use stm32f4xx_hal::pac;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// USART2's receiving on DMA1 stream 5.
const CHANNEL: u32 = 4;

/// Where received bytes are put, round and round.
#[repr(transparent)]
struct Memory(UnsafeCell<[u8; RECEIVE_SIZE]>);

// SAFETY: the DMA writes it, and the only `SerialPort` reads single bytes; there is one because it owns USART2.
unsafe impl Sync for Memory {}

static MEMORY: Memory = Memory(UnsafeCell::new([0; RECEIVE_SIZE]));

/// USART2. All of it belongs to its interrupt; whoever wants something sent queues it and pends the interrupt.
pub struct SerialPort {
    usart: pac::USART2,
    dma: pac::DMA1,
    /// The place of the next byte that is taken from the memory.
    next: usize,
    received: Producer<'static, u8>,
    to_send: Consumer<'static, u8>,
}

impl SerialPort {
    /// Listens. The port runs and asks the DMA for each byte it receives.
    pub(super) fn new(
        usart: pac::USART2,
        dma: pac::DMA1,
        received: Producer<'static, u8>,
        to_send: Consumer<'static, u8>,
        rcc: &mut Rcc,
    ) -> Self {
        pac::DMA1::enable(rcc);
        pac::DMA1::reset(rcc);
        let stream = dma.st(5);
        // SAFETY: the values are those of RM0390 rev 6 section 9.5: bytes from the data register to memory that is the line's own for
        // ever; high priority, memory increments, circular, peripheral to memory.
        unsafe {
            stream.ndtr().write(|w| w.bits(RECEIVE_SIZE as u32));
            stream.par().write(|w| w.bits(usart.dr().as_ptr() as u32));
            stream.m0ar().write(|w| w.bits(MEMORY.0.get() as u32));
            stream.fcr().write(|w| w.bits(0));
            stream.cr().write(|w| w.bits(CHANNEL << 25 | 2 << 16 | 1 << 10 | 1 << 8));
        }
        stream.cr().modify(|_, w| w.en().set_bit());
        usart.cr1().modify(|_, w| w.idleie().set_bit());
        Self { usart, dma, next: 0, received, to_send }
    }

    /// Takes what has come and sends what may go. True when a frame has ended.
    ///
    /// A byte that is lost, to noise, to an overrun or to a full queue, makes its frame fail its CRC; the sender goes back.
    pub fn exchange(&mut self) -> bool {
        let status = self.usart.sr().read();
        // An idle line and an overrun are taken back by reading the data too, RM0390 rev 6 section 25.6.1. Where there is a byte, the
        // DMA's reading does it.
        if status.rxne().bit_is_clear() && (status.idle().bit_is_set() || status.ore().bit_is_set()) {
            let _ = self.usart.dr().read();
        }
        let ended = self.take();
        while let Some(&byte) = self.to_send.peek() {
            if self.usart.sr().read().txe().bit_is_clear() {
                self.usart.cr1().modify(|_, w| w.txeie().set_bit());
                return ended;
            }
            self.usart.dr().write(|w| w.dr().set(byte.into()));
            self.to_send.dequeue();
        }
        self.usart.cr1().modify(|_, w| w.txeie().clear_bit());
        ended
    }

    /// Takes the bytes that the DMA has put into the memory. True when a frame has ended.
    fn take(&mut self) -> bool {
        let mut ended = false;
        // The register counts down, and begins anew with the memory.
        let left = self.dma.st(5).ndtr().read().bits() as usize;
        let end = RECEIVE_SIZE.saturating_sub(left) % RECEIVE_SIZE;
        while self.next != end {
            // SAFETY: within the array, since `next` is below its length; volatile, because the DMA writes there.
            let byte = unsafe { MEMORY.0.get().cast::<u8>().add(self.next).read_volatile() };
            self.next = (self.next + 1) % RECEIVE_SIZE;
            ended |= byte == 0;
            let _ = self.received.enqueue(byte);
        }
        ended
    }
}
