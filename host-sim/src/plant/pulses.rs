//! The pulses of a stepping axis: the controller's own words, played at pins into a drive's inputs.
//!
//! The words are those of [`shared::steps`], built once a tick for an axis on its own two pins, and read back by the decoder. What
//! comes out is what a drive would see: pulses at their slots, with the times that the drive asks for.

use shared::fixed::Fixed;
use shared::steps::decoder::Decoder;
use shared::steps::{Half, Pin, StepAxes, StepError, StepFault, StepSettings, StepState, slots_in};

/// Slots of a tick, as the default board's timer paces them: 1.92 MHz.
pub const SLOTS: usize = 1_875;

/// The least times at a drive's inputs, in s, and the size of its steps.
#[derive(Clone, Copy, Debug)]
pub struct InputTimes {
    /// Of a pulse.
    pub pulse: f64,
    /// Between two pulses.
    pub gap: f64,
    /// From a change of direction to a pulse.
    pub setup: f64,
    /// From a pulse to a change of direction.
    pub hold: f64,
}

/// One step pulse, as a drive sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulse {
    /// When it begins, in s since the start of the tick.
    pub instant: f64,
    /// Whether it goes in the positive direction.
    pub forward: bool,
}

/// One axis' step generator with its pins.
#[derive(Clone, Debug)]
pub struct Pulses {
    settings: StepSettings,
    axes: StepAxes<1, 1, SLOTS>,
    state: StepState<1>,
    decoder: Decoder<1, 1>,
    words: Box<[u32; SLOTS]>,
    /// The length of a slot in s.
    slot: f64,
    pulses: Vec<Pulse>,
}

impl Pulses {
    /// A generator at rest at 0, for a controller with this `tick` in s. Errors: what the shared code refuses.
    pub fn new(steps_per_mm: f64, times: InputTimes, tick: f64) -> Result<Self, StepError> {
        let pin = |bit| Pin { port: 0, bit, inverted: false };
        // The shared code counts in its own tick.
        let slots = |time: f64| slots_in(time * f64::from(shared::TICK) / tick, SLOTS);
        let settings = StepSettings {
            steps_per_mm,
            step: pin(0),
            direction: pin(1),
            pulse: slots(times.pulse).max(1),
            gap: slots(times.gap).max(1),
            setup: slots(times.setup).max(1),
            hold: slots(times.hold),
        };
        let all = [settings];
        let axes = StepSettings::activate(&all)?;
        let state = axes.at_rest([Fixed(0)]);
        let words = Box::new([0; SLOTS]);
        let slot = tick / SLOTS as f64;
        Ok(Self { settings, axes, state, decoder: Decoder::new(&all), words, slot, pulses: Vec::new() })
    }

    /// Puts the axis at rest at `position` and returns the step next to it.
    pub fn rest_at(&mut self, position: Fixed) -> i32 {
        self.state = self.axes.at_rest([position]);
        self.decoder = Decoder::new(&[self.settings]);
        self.words.fill(0);
        self.position()
    }

    /// Where the pulses lead to, in steps from coordinate zero.
    pub fn position(&self) -> i32 {
        self.state.position(0).unwrap_or(0)
    }

    /// The pulses of the tick that leads to `target`, in their order, and what is wrong if they cannot all be played.
    pub fn play(&mut self, target: Fixed) -> (&[Pulse], Result<(), StepFault>) {
        let Self { pulses, slot, .. } = self;
        // One buffer is played at once, so it is always the same half.
        let result = self.axes.fill(&mut self.state, [target], Half::First, [&mut *self.words]);
        let start = self.decoder.now();
        pulses.clear();
        self.decoder.play([&*self.words], |step| {
            pulses.push(Pulse { instant: (step.instant - start) as f64 * *slot, forward: step.forward });
        });
        (pulses, result)
    }
}

#[cfg(test)]
mod tests {
    use shared::steps::receiver::Least;

    use super::*;

    const TICK: f64 = 1.0 / 1024.0;

    /// A drive of 2.5 us and 5 us: what it sees is in s what was asked for, rounded up to slots, on any tick.
    #[test]
    fn the_drive_sees_the_times_that_it_asks_for() {
        let times = InputTimes { pulse: 2.5e-6, gap: 2.5e-6, setup: 5e-6, hold: 5e-6 };
        for tick in [TICK, TICK / 2.0] {
            let mut pulses = Pulses::new(640.0, times, tick).unwrap();
            pulses.rest_at(Fixed::from_mm(3.0));
            for k in 0..200 {
                // Both ways, at up to the highest speed that the pulses allow.
                let speed = if tick == TICK { 187.0 } else { 93.0 } * (1.0 + f64::from(k)) / 200.0 / 640.0;
                let (_, result) = pulses.play(Fixed::from_mm(3.0 + if k % 2 == 0 { speed } else { 0.0 }));
                assert_eq!(result, Ok(()));
            }
            let slots = |time: f64| (time / (tick / SLOTS as f64)).ceil() as u64;
            let Least { pulse, gap, setup, hold } = pulses.decoder.drive(0).unwrap().least();
            assert_eq!(pulse, slots(2.5e-6));
            assert!(gap >= slots(2.5e-6) && setup >= slots(5e-6) && hold >= slots(5e-6));
        }
    }
}
