//! The pin map of the NUCLEO-H743ZI2: three connectors, each for a step axis or a servo.
//!
//! | what | x | y | z | |
//! | --- | --- | --- | --- | --- |
//! | step, direction | PD3, PD4 | PD5, PD6 | PD7, PD0 | out, played by TIM8 and DMA1 stream 0 |
//! | encoder A, B | PC6, PC7 | PD12, PD13 | PE9, PE11 | in, TIM3, TIM4, TIM1; pulled up |
//! | command | PA4 | PA5 | PF9, PF10 | out; x, y: analog, half scale is zero; z: pulse width on TIM14, and direction |
//! | drive enable | PE5 | PE6 | PE4 | out, TIM15: off by hardware while the stop acts |
//! | drive fault | PE7 | PE8 | PE10 | in, pulled up |
//! | limit at the low end | PF0 | PF1 | PF2 | in, pulled up |
//! | limit at the high end | PF3 | PF4 | PF5 | in, pulled up |
//! | home switch | PF6 | PF7 | PF8 | in, pulled up |
//!
//! | what | pin | |
//! | --- | --- | --- |
//! | emergency stop | PE3 | in, pulled up, TIM15's break |
//! | button B1, a stop too | PC13 | in, high is pressed |
//! | line to the host | PD8, PD9 | USART3, the ST-Link's virtual serial port |
//! | lamp | PB0 | out, LD1: on while something moves |

use shared::control::StepPins;

/// How many connectors there are.
pub const AXES: usize = 3;

/// The ports with pins of step axes: port D alone.
pub const PORTS: usize = 1;

/// Step and direction of each connector: bits of port D.
pub const PINS: [StepPins; AXES] = [
    StepPins { step: (0, 3), direction: (0, 4) },
    StepPins { step: (0, 5), direction: (0, 6) },
    StepPins { step: (0, 7), direction: (0, 0) },
];

/// Bits of port F: each three in a row, for x, y and z.
pub const LOW_LIMITS: u32 = 0;
/// See [`LOW_LIMITS`].
pub const HIGH_LIMITS: u32 = 3;
/// See [`LOW_LIMITS`].
pub const HOMES: u32 = 6;

/// Bits of port E: the drives' faults, of x, y and z.
pub const DRIVE_FAULTS: [u32; AXES] = [7, 8, 10];

/// Bit of port E: the emergency stop.
pub const STOP: u32 = 3;
