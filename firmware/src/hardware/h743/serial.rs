//! The line: bytes between a serial port and two queues.

use heapless::spsc::{Consumer, Producer};
use stm32h7xx_hal::nb;
use stm32h7xx_hal::pac::USART3;
use stm32h7xx_hal::prelude::*;
use stm32h7xx_hal::serial::{Rx, Tx};

/// USART3. All of it belongs to its interrupt; whoever wants something sent queues it and pends the interrupt.
pub struct SerialPort {
    rx: Rx<USART3>,
    tx: Tx<USART3>,
    received: Producer<'static, u8>,
    to_send: Consumer<'static, u8>,
}

impl SerialPort {
    /// Listens.
    pub(super) fn new(
        mut rx: Rx<USART3>,
        tx: Tx<USART3>,
        received: Producer<'static, u8>,
        to_send: Consumer<'static, u8>,
    ) -> Self {
        rx.listen();
        Self { rx, tx, received, to_send }
    }

    /// Takes what has come and sends what may go. True when a frame has ended.
    ///
    /// A byte that is lost, to noise, to an overrun or to a full queue, makes its frame fail its CRC; the sender goes back.
    pub fn exchange(&mut self) -> bool {
        let mut ended = false;
        loop {
            match self.rx.read() {
                Ok(byte) => {
                    ended |= byte == 0;
                    let _ = self.received.enqueue(byte);
                }
                Err(nb::Error::WouldBlock) => break,
                Err(nb::Error::Other(_)) => {}
            }
        }
        while let Some(&byte) = self.to_send.peek() {
            if self.tx.write(byte).is_err() {
                self.tx.listen();
                return ended;
            }
            self.to_send.dequeue();
        }
        self.tx.unlisten();
        ended
    }
}
