//! The pin map of the NUCLEO-F446RE: three connectors, each for a step axis or a servo. Alternate functions are those of the
//! STM32F446xC/E data sheet DS10693 rev 10, table 11.
//!
//! | what | x | y | z | |
//! | --- | --- | --- | --- | --- |
//! | step, direction | PC0, PC1 | PC2, PC3 | PC4, PC5 | out, played by TIM8 and DMA2 stream 1 |
//! | encoder A, B | PC6, PC7 | PB6, PB7 | PA0, PA1 | in, TIM3, TIM4, TIM5; pulled up |
//! | command | PA4 | PA5 | PA7, PA6 | out; x, y: analog, half scale is zero; z: pulse width on TIM14, and direction |
//! | drive enable | PA8 | PA9 | PA10 | out, TIM1: off by hardware while the stop acts |
//! | drive fault | PB0 | PB1 | PB5 | in, pulled up |
//! | limit at the low end | PB13 | PB14 | PB15 | in, pulled up |
//! | limit at the high end | PB8 | PB9 | PB10 | in, pulled up |
//! | home switch | PC8 | PC9 | PC10 | in, pulled up |
//!
//! | what | pin | |
//! | --- | --- | --- |
//! | emergency stop | PB12 | in, pulled up, TIM1's break |
//! | button B1, a stop too | PC13 | in, low is pressed |
//! | line to the host | PA2, PA3 | USART2, the ST-Link's virtual serial port |
//! | lamp | PC11 | out: on while something moves; LD2 is on PA5, which is y's command |
//!
//! Left alone: PA13 and PA14, the debugger's; PB3, its trace; PB2, read at a reset; PH0, the clock from the ST-Link; PC14 and PC15, a
//! crystal. Free: PA11, PA12, PA15, PB4, PC12 and PD2.

use shared::control::StepPins;

/// How many connectors there are.
pub const AXES: usize = 3;

/// The ports with pins of step axes: port C alone.
pub const PORTS: usize = 1;

/// Step and direction of each connector: bits of port C.
pub const PINS: [StepPins; AXES] = [
    StepPins { step: (0, 0), direction: (0, 1) },
    StepPins { step: (0, 2), direction: (0, 3) },
    StepPins { step: (0, 4), direction: (0, 5) },
];

/// Bits of port B: three in a row, for x, y and z.
pub const LOW_LIMITS: u32 = 13;
/// See [`LOW_LIMITS`].
pub const HIGH_LIMITS: u32 = 8;

/// Bits of port C: three in a row, for x, y and z.
pub const HOMES: u32 = 8;

/// Bits of port B: the drives' faults, of x, y and z.
pub const DRIVE_FAULTS: [u32; AXES] = [0, 1, 5];

/// Bit of port B: the emergency stop.
pub const STOP: u32 = 12;
