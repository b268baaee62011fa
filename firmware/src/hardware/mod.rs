//! The only place with hardware registers. A board is a folder, chosen by a feature; what it hands out is named the same on every board:
//!
//! | name | what |
//! | --- | --- |
//! | `pac` | the part's registers and interrupts |
//! | `start` | brings the board up as far as the flash; `Early::finish` the rest, for a machine |
//! | `Board` | what the application uses of it: the fields below |
//! | `TickTimer` | interrupts 1024 times a second, exactly |
//! | `InputPins` | the levels at the inputs |
//! | `Encoders`, `Drives` | servo axes: counts, and commands |
//! | `StepRing`, `SLOTS`, `PINS` | step axes: the ring that hardware plays |
//! | `Enables`, `off` | power for the drives, which the stop input takes away without a program |
//! | `StopInput` | the interrupt of the stop |
//! | `LINE` | the interrupt of the line to the host |
//! | `SerialPort`, `Lamp`, `Watchdog` | the line to the host; for people; against a tick that does not come |
//! | `KEPT_RANGE` | where in the flash the machine is kept |
//!
//! `AXES` is how many connectors the board has; each takes a step axis or a servo.

mod blocking;
mod cycles;
mod ring;

#[cfg(not(any(feature = "nucleo-h743zi2", feature = "nucleo-f446re")))]
compile_error!("the firmware is for one board: choose it by a feature, such as `nucleo-h743zi2`");
#[cfg(all(feature = "nucleo-h743zi2", feature = "nucleo-f446re"))]
compile_error!("the firmware is for one board: `nucleo-f446re` takes `--no-default-features`");

#[cfg(feature = "nucleo-f446re")]
mod f446;
#[cfg(feature = "nucleo-h743zi2")]
mod h743;

#[cfg(feature = "nucleo-f446re")]
pub use f446::*;
#[cfg(feature = "nucleo-h743zi2")]
pub use h743::*;

pub use blocking::Blocking;
pub use cycles::Cycles;

/// Everything that the application uses of the board.
pub struct Board {
    /// Interrupts 1024 times a second.
    pub timer: TickTimer,
    /// Switches and faults.
    pub inputs: InputPins,
    /// Where servo axes are.
    pub encoders: Encoders,
    /// Where they are told to go.
    pub drives: Drives,
    /// The steps of the next tick.
    pub ring: StepRing,
    /// Power for the drives.
    pub enables: Enables,
    /// Waits for the tick to fail.
    pub watchdog: Watchdog,
    /// The line to the host.
    pub port: SerialPort,
    /// The emergency stop's interrupt.
    pub stop: StopInput,
    /// For people.
    pub lamp: Lamp,
}
