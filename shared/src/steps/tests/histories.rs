//! A hundred million steps, decoded back.
//!
//! Each axis rides at random: rests, steady speeds of every size up to the highest that the slots hold, ramps, reversals in every tick, and
//! jitter of single units. At every tick the position is exact and each step is the next one due; none is early by more than a slot,
//! and none late by more than a change of direction takes.

use super::rig::{Random, Rig, pin, plain};
use crate::fixed::Fixed;
use crate::steps::{Pin, StepSettings};

/// Steps that each of the four tests below plays, at least.
const STEPS: u64 = 25_000_000;

/// How far an axis may go, in units: 2 m.
const FAR: f64 = 524_288_000.0;

#[derive(Clone, Copy)]
enum Manner {
    Steady,
    Ramp(f64),
    /// Another speed in each tick.
    Shake,
    /// By single units.
    Jitter,
}

struct Ride {
    position: f64,
    speed: f64,
    /// The highest speed, in units per tick.
    most: f64,
    manner: Manner,
    left: u64,
}

impl Ride {
    fn new(most: f64, position: f64) -> Self {
        Self { position, speed: 0.0, most, manner: Manner::Steady, left: 0 }
    }

    fn next(&mut self, random: &mut Random) -> Fixed {
        if self.left == 0 {
            self.left = 1 + random.below(60);
            let speed = self.most * (random.part() * 2.0 - 1.0);
            (self.manner, self.speed) = match random.below(8) {
                0 => (Manner::Steady, 0.0),
                // Slow ones too, evenly over six decades.
                1 => (Manner::Steady, speed * libm::pow(10.0, -6.0 * random.part())),
                2 => (Manner::Steady, libm::copysign(self.most, speed)),
                3 | 4 => (Manner::Steady, speed),
                5 => (Manner::Ramp((speed - self.speed) / self.left as f64), self.speed),
                6 => (Manner::Shake, speed),
                _ => (Manner::Jitter, 0.0),
            };
        }
        self.left -= 1;
        match self.manner {
            Manner::Steady => (),
            Manner::Ramp(change) => self.speed = (self.speed + change).clamp(-self.most, self.most),
            Manner::Shake => self.speed = self.most * (random.part() * 2.0 - 1.0),
            Manner::Jitter => self.speed = random.below(3) as f64 - 1.0,
        }
        if (self.position + self.speed).abs() > FAR {
            self.speed = -self.speed;
        }
        self.position += self.speed;
        Fixed(libm::round(self.position) as i32)
    }
}

fn ride<const AXES: usize, const PORTS: usize, const SLOTS: usize>(seed: u64, settings: [StepSettings; AXES]) {
    let mut random = Random(seed);
    let mut rides = settings.map(|one| {
        let most = SLOTS as f64 / f64::from(one.pulse + one.gap) / one.steps_per_mm * 262_144.0;
        // Two setpoints in a row can be rounded apart by a unit.
        Ride::new((most - 1.0) * 0.999, (random.part() - 0.5) * FAR)
    });
    let start = core::array::from_fn(|axis| Fixed(libm::round(rides[axis].position) as i32));
    let mut rig: Rig<AXES, PORTS, SLOTS> = Rig::new(settings, start);
    while rig.count < STEPS {
        for _ in 0..1000 {
            rig.tick(core::array::from_fn(|axis| rides[axis].next(&mut random))).unwrap();
        }
        rig.drain();
        rig.check_times();
    }
    assert!(rig.earliest <= 1.0 + 1e-9, "early by {} slots", rig.earliest);
    assert!(rig.latest <= rig.longest_delay(), "late by {} slots", rig.latest);
}

/// The machine of the bars: three axes on one port at up to 937 500 steps/s.
#[test]
fn three_axes_on_a_port() {
    ride::<3, 1, 1875>(1, [plain(0, 1000.0), plain(1, 640.0), plain(2, 12_345.678)]);
}

/// Six axes on two ports, each with other times and polarities, pulses and directions on different ports.
#[test]
fn six_axes_on_two_ports() {
    let inverted = |port, bit| Pin { inverted: true, ..pin(port, bit) };
    ride::<6, 2, 3750>(
        2,
        [
            plain(0, 131_072.0),
            StepSettings {
                step: inverted(0, 8),
                direction: pin(1, 8),
                pulse: 2,
                gap: 1,
                ..plain(0, 157.480_314_960_629_93)
            },
            StepSettings { step: pin(1, 0), direction: inverted(1, 15), setup: 1, hold: 0, ..plain(0, 3_200.0) },
            StepSettings { step: inverted(1, 1), direction: inverted(0, 15), pulse: 7, gap: 3, ..plain(0, 80.0) },
            StepSettings { step: pin(1, 4), direction: pin(0, 12), setup: 900, hold: 400, ..plain(0, 400.0) },
            StepSettings { step: pin(1, 5), direction: pin(1, 6), pulse: 10, gap: 2, setup: 30, ..plain(0, 1.0 / 3.0) },
        ],
    );
}

/// Drives that are slow to take a direction: setup and hold as long as they may be.
#[test]
fn slow_directions() {
    let slow = |k| StepSettings { setup: 375, hold: 375, ..plain(k, 800.0) };
    ride::<3, 1, 1500>(
        3,
        [slow(0), StepSettings { setup: 200, hold: 0, ..slow(1) }, StepSettings { setup: 1, ..slow(2) }],
    );
}

/// The other two slot counts, with wide pulses and narrow ones.
#[test]
fn other_slot_counts() {
    let wide = |k| StepSettings { pulse: 2, gap: 2, setup: 8, hold: 8, ..plain(k, 2_000.0) };
    ride::<3, 1, 2500>(4, [plain(0, 320.0), wide(1), plain(2, 25_600.0)]);
}
