//! The button of the board, as a stop beside the emergency stop: an interrupt when it is pressed.
//!
//! The emergency stop itself needs no interrupt: it takes the drives' power by hardware, and the next tick sees it.

use stm32f4xx_hal::gpio::{Edge, ExtiPin, Input, PC13};
use stm32f4xx_hal::pac;
use stm32f4xx_hal::syscfg::SysCfg;

/// The input: B1 pulls it low, the board pulls it up (UM1724 rev 15 section 6.5).
pub struct StopInput {
    pin: PC13<Input>,
}

impl StopInput {
    /// Listens to `pin`.
    pub(super) fn new(mut pin: PC13<Input>, syscfg: &mut SysCfg, exti: &mut pac::EXTI) -> Self {
        pin.make_interrupt_source(syscfg);
        pin.trigger_on_edge(exti, Edge::RisingFalling);
        pin.enable_interrupt(exti);
        Self { pin }
    }

    /// Takes the interrupt back, and says whether the button is pressed now.
    pub fn acknowledge(&mut self) -> bool {
        self.pin.clear_interrupt_pending_bit();
        self.pin.is_low()
    }

    /// Whether the button is pressed now.
    pub fn is_pressed(&self) -> bool {
        self.pin.is_low()
    }
}
