//! The only place with hardware registers. A board is a module; what it hands out is named the same on every board.
//!
//! | what | on a NUCLEO-H743ZI2 |
//! | --- | --- |
//! | tick | TIM2, 192 MHz / 187 500 = 1024 Hz exactly |
//! | line | USART3 on PD8, PD9: the ST-Link's virtual serial port |
//! | servo axes: encoders | x: TIM3 on PC6, PC7; y: TIM4 on PD12, PD13 |
//! | servo axes: commands | x, y: the converters on PA4, PA5, 12 bits, half scale is zero |
//! | step axes | step, direction of x: PD3, PD4; y: PD5, PD6; z: PD7, PD0; played by TIM8 and DMA1 stream 0 |
//! | drives | enabled by PE2 |
//! | stop | PC13, the blue button B1: high is pressed |
//! | watchdog | IWDG1, 4 ms: fed by the tick alone |
//! | lamp | PB0, the green LED LD1: on while a job runs |

mod cycles;
#[cfg(not(feature = "steps"))]
mod drives;
mod enable;
#[cfg(not(feature = "steps"))]
mod encoders;
mod h743;
mod serial;
#[cfg(feature = "steps")]
mod step_ring;
mod stop;
mod timer;
mod watchdog;

pub use cycles::Cycles;
#[cfg(not(feature = "steps"))]
pub use drives::Drives;
pub use enable::{enable, off};
#[cfg(not(feature = "steps"))]
pub use encoders::Encoders;
pub use h743::{Actuators, Board, Lamp, start};
pub use serial::SerialPort;
#[cfg(feature = "steps")]
pub use step_ring::{SLOTS, StepRing};
pub use stop::StopInput;
pub use timer::TickTimer;
pub use watchdog::Watchdog;
