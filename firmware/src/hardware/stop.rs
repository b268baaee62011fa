//! The stop input: an interrupt at both edges.
//!
//! The button of the board closes when it is pressed. A machine's stop chain opens, so that a broken wire stops it too: turn the level
//! in [`StopInput::acknowledge`] around for one, and the pin's pull to match.

use stm32h7xx_hal::gpio::{Edge, ExtiPin, Input, PC13};
use stm32h7xx_hal::pac;

/// The input.
pub struct StopInput {
    pin: PC13<Input>,
}

impl StopInput {
    /// Listens to `pin`.
    pub fn new(mut pin: PC13<Input>, syscfg: &mut pac::SYSCFG, exti: &mut pac::EXTI) -> Self {
        pin.make_interrupt_source(syscfg);
        pin.trigger_on_edge(exti, Edge::RisingFalling);
        pin.enable_interrupt(exti);
        Self { pin }
    }

    /// Takes the interrupt back, and says whether the stop is pressed now.
    pub fn acknowledge(&mut self) -> bool {
        self.pin.clear_interrupt_pending_bit();
        self.pin.is_high()
    }

    /// Whether the stop is pressed now.
    pub fn is_pressed(&self) -> bool {
        self.pin.is_high()
    }
}
