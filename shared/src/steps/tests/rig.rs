//! Axes, rings and drives on a bench, and exact arithmetic that says when each step was due.

extern crate std;

use std::boxed::Box;
use std::collections::VecDeque;
use std::vec::Vec;

use crate::fixed::Fixed;
use crate::steps::decoder::{Decoder, Step};
use crate::steps::receiver::Least;
use crate::steps::{Half, Pin, StepAxes, StepFault, StepSettings, StepState};

pub fn pin(port: u8, bit: u8) -> Pin {
    Pin { port, bit, inverted: false }
}

/// An axis on its own two pins of port 0: bits 2k and 2k + 1.
pub fn plain(k: u8, steps_per_mm: f64) -> StepSettings {
    StepSettings {
        steps_per_mm,
        step: pin(0, 2 * k),
        direction: pin(0, 2 * k + 1),
        pulse: 1,
        gap: 1,
        setup: 4,
        hold: 3,
    }
}

/// An axis in exact arithmetic: where it is, and the instants, in slots since the start, of the steps that are due and not played.
struct Exact {
    /// Steps per unit of a coordinate, as a fraction.
    numerator: i128,
    denominator: i128,
    setpoint: i128,
    level: i128,
    due: VecDeque<(f64, bool)>,
}

impl Exact {
    fn new(settings: &StepSettings, position: Fixed) -> Self {
        // A double is a whole number of 53 bits times a power of two.
        let (mut mantissa, mut exponent) = (settings.steps_per_mm, 18);
        while mantissa != mantissa.trunc() {
            mantissa *= 2.0;
            exponent += 1;
        }
        let mut exact = Self {
            numerator: mantissa as i128,
            denominator: 1 << exponent,
            setpoint: position.0.into(),
            level: 0,
            due: VecDeque::new(),
        };
        exact.level = exact.nearest(exact.setpoint);
        exact
    }

    fn nearest(&self, units: i128) -> i128 {
        (2 * units * self.numerator + self.denominator).div_euclid(2 * self.denominator)
    }

    /// Moves on to `target` in a straight line from slot `start` to slot `start + slots`. A step back takes a step that is still due.
    fn advance(&mut self, target: Fixed, start: f64, slots: f64) {
        let target = i128::from(target.0);
        let level = self.nearest(target);
        let forward = level > self.level;
        // Both ways in steps, times two denominators.
        let middle = (2 * self.level + if forward { 1 } else { -1 }) * self.denominator;
        let first = (middle - 2 * self.setpoint * self.numerator).abs() as f64;
        let whole = (2 * (target - self.setpoint) * self.numerator).abs() as f64;
        let one = 2.0 * self.denominator as f64;
        for k in 0..(level - self.level).unsigned_abs() as u32 {
            match self.due.back() {
                Some(&(_, direction)) if direction != forward => {
                    self.due.pop_back();
                }
                _ => self.due.push_back((start + slots * (first + f64::from(k) * one) / whole, forward)),
            }
        }
        (self.setpoint, self.level) = (target, level);
    }
}

/// Everything on one bench.
pub struct Rig<const AXES: usize, const PORTS: usize, const SLOTS: usize> {
    pub axes: StepAxes<AXES, PORTS, SLOTS>,
    pub state: StepState<AXES>,
    pub decoder: Decoder<AXES, PORTS>,
    settings: [StepSettings; AXES],
    exact: Vec<Exact>,
    start: [i32; AXES],
    rings: Vec<Box<[[u32; SLOTS]; 2]>>,
    second: bool,
    /// The steps of the last tick.
    pub steps: Vec<Step>,
    /// All steps so far.
    pub count: u64,
    /// How many slots a step came before, and after, the instant of its crossing, at the worst.
    pub earliest: f64,
    pub latest: f64,
}

impl<const AXES: usize, const PORTS: usize, const SLOTS: usize> Rig<AXES, PORTS, SLOTS> {
    pub fn new(settings: [StepSettings; AXES], position: [Fixed; AXES]) -> Self {
        let axes: StepAxes<AXES, PORTS, SLOTS> = StepSettings::activate(&settings).unwrap();
        let state = axes.at_rest(position);
        Self {
            axes,
            state,
            decoder: Decoder::new(&settings),
            settings,
            exact: settings.iter().zip(position).map(|(one, position)| Exact::new(one, position)).collect(),
            start: core::array::from_fn(|axis| state.position(axis).unwrap()),
            rings: (0..PORTS).map(|_| Box::new([[0; SLOTS]; 2])).collect(),
            second: false,
            steps: Vec::new(),
            count: 0,
            earliest: 0.0,
            latest: 0.0,
        }
    }

    /// One tick through words and pins. Every step must be the next one that is due.
    pub fn tick(&mut self, target: [Fixed; AXES]) -> Result<(), StepFault> {
        let half = if self.second { Half::Second } else { Half::First };
        let start = self.decoder.now() as f64;
        for (exact, target) in self.exact.iter_mut().zip(target) {
            exact.advance(target, start, SLOTS as f64);
        }
        let mut rings = self.rings.iter_mut();
        let words = core::array::from_fn(|_| &mut rings.next().unwrap()[usize::from(self.second)]);
        let result = self.axes.fill(&mut self.state, target, half, words);
        self.steps.clear();
        let words = core::array::from_fn(|port| &self.rings[port][usize::from(self.second)]);
        self.decoder.play(words, |step| self.steps.push(step));
        for step in &self.steps {
            let due = self.exact[step.axis].due.pop_front();
            let (instant, forward) = due.unwrap_or_else(|| panic!("nothing is due for {step:?}"));
            assert_eq!(step.forward, forward, "{step:?}");
            let late = step.instant as f64 - instant;
            self.earliest = self.earliest.max(-late);
            self.latest = self.latest.max(late);
        }
        self.count += self.steps.len() as u64;
        self.second = !self.second;
        for axis in 0..AXES {
            let (position, owed) = (self.state.position(axis).unwrap(), self.state.owed(axis).unwrap());
            let played = self.decoder.drive(axis).unwrap().position();
            assert_eq!(i64::from(position), i64::from(self.start[axis]) + played);
            assert_eq!(i128::from(position) + i128::from(owed), self.exact[axis].level);
            assert_eq!(self.exact[axis].due.len(), owed.unsigned_abs() as usize);
        }
        result
    }

    /// Rests where the axes are, until nothing is owed, and one tick more for the last trailing edge.
    pub fn drain(&mut self) {
        let target = core::array::from_fn(|axis| Fixed(self.exact[axis].setpoint as i32));
        for _ in 0..2 {
            self.tick(target).unwrap();
        }
        for axis in 0..AXES {
            assert_eq!(self.state.owed(axis), Some(0));
            assert_eq!(i128::from(self.state.position(axis).unwrap()), self.exact[axis].level);
        }
        self.tick(target).unwrap();
        assert!(self.steps.is_empty() && self.rings.iter().all(|ring| ring[usize::from(!self.second)] == [0; SLOTS]));
    }

    pub fn least(&self, axis: usize) -> Least {
        self.decoder.drive(axis).unwrap().least()
    }

    /// No drive ever saw less than it asks for.
    pub fn check_times(&self) {
        assert_eq!(self.decoder.clashes(), 0);
        for (axis, asked) in self.settings.iter().enumerate() {
            let Least { pulse, gap, setup, hold } = self.least(axis);
            assert!(pulse == u64::from(asked.pulse) || pulse == u64::MAX, "axis {axis}: a pulse of {pulse}");
            assert!(gap >= u64::from(asked.gap), "axis {axis}: a gap of {gap}");
            assert!(setup >= u64::from(asked.setup), "axis {axis}: a setup of {setup}");
            assert!(hold >= u64::from(asked.hold), "axis {axis}: a hold of {hold}");
        }
    }

    /// The most by which a change of direction may delay a step, in slots, and one for the slot itself: the middle that was crossed
    /// just before may be crossed back at once.
    pub fn longest_delay(&self) -> f64 {
        let of = |one: &StepSettings| one.pulse + one.gap.max(one.hold + one.setup);
        f64::from(self.settings.iter().map(of).max().unwrap() + 1)
    }
}

/// Numbers without a pattern: SplitMix64 [Steele, Lea & Flood 2014].
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, end: u64) -> u64 {
        self.next() % end
    }

    /// In 0..1.
    pub fn part(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}
