//! The virtual board: the image that is flashed, on an emulated STM32H743, with a host on the other end of its serial line.
//!
//! The emulator is the crate `rigless`: a Cortex-M7 that runs the image's own instructions, and models of the clock tree, the timers, the
//! ports and the serial interfaces, in virtual time. Two runs are the same run. What is ours:
//!
//! | module | what |
//! | --- | --- |
//! | [`image`] | the linked image: symbols, code, the interrupt's first instruction and its ends, every call |
//! | [`line`](mod@line) | the far end of the serial line: whoever speaks to the controller |
//! | [`machine`] | what the board is told of its machine, and what hangs on the pins: drivers, servo axes with their encoders, switches |
//! | [`probe`] | counts instructions of each tick, reads its setpoint in RAM, measures its stack |
//! | [`run`](mod@run) | one image, one conversation, until it ends |
//! | [`socket`] | a TCP listener as the far end of the line |
//! | [`serve`](mod@serve) | the board behind that listener, in real time |
//! | [`stages`] | which source file each executed instruction came from |
//! | [`reach`] | what the tick can call, from the machine code |
//! | [`calls`] | counts the instructions of a function that the program calls outside the tick |
//! | [`jobs`] | small jobs of one kind of piece each, for budgets |
//! | [`budget`] | all figures of an image together |
//!
//! An instruction takes 4 ns here, whatever it is: instruction counts are exact, cycle counts are not a processor's. Caches, wait
//! states and the order of two bus masters are not modelled.
#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod budget;
pub mod calls;
pub mod image;
pub mod jobs;
pub mod line;
pub mod machine;
pub mod probe;
pub mod reach;
pub mod run;
pub mod serve;
pub mod socket;
pub mod stages;

/// What went wrong with a run, as one sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error(pub String);

impl Error {
    /// An error of this text.
    pub fn new(text: impl Into<String>) -> Self {
        Self(text.into())
    }
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Error {}
