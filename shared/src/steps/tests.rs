//! The words played back. [`rig`] holds what the tests share; the decoder and the exact crossings there know nothing of the encoder.

mod faults;
mod histories;
mod properties;
mod rig;
mod single;
