//! The only place with hardware registers. A board is a module; what it hands out is named the same on every board.
//!
//! | what | on a NUCLEO-H743ZI2 |
//! | --- | --- |
//! | tick | TIM2, 192 MHz / 187 500 = 1024 Hz exactly |
//! | line | USART3 on PD8, PD9: the ST-Link's virtual serial port |
//! | encoders | x: TIM3 on PC6, PC7; y: TIM4 on PD12, PD13 |
//! | drives | x, y: the converters on PA4, PA5, 12 bits, half scale is zero; enabled by PE2 |
//! | stop | PC13, the blue button B1: high is pressed |
//! | lamp | PB0, the green LED LD1: on while a job runs |

mod cycles;
mod drives;
mod encoders;
mod h743;
mod serial;
mod stop;
mod timer;

pub use cycles::Cycles;
pub use drives::Drives;
pub use encoders::Encoders;
pub use h743::{Board, Lamp, start};
pub use serial::SerialPort;
pub use stop::StopInput;
pub use timer::TickTimer;
