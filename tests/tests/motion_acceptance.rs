//! The bar of the motion: hold, resume, override, cancel, starvation and single block at each of 2 000 random ticks of the paper's
//! path. Every setpoint on the path within 0.1 um, no axis beyond its acceleration, the final point exact.
//!
//! Nothing here asks the kernel how it does it: distances are to the exact path by `host_sim::measure`, accelerations are second
//! differences of setpoints.
#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use host_sim::job::{FeedOverride, Job};
use host_sim::measure::{ContourError, Slowness};
use host_sim::pacing::{self, AxisLimits};
use host_sim::path::{Path, PathPiece};
use host_sim::reproduce::farouki2018::CONTOUR;
use shared::active::ActivePiece;
use shared::curve::Curve as _;
use shared::executor::{Executor, State};
use shared::fixed::{Position, UNITS_PER_MM};
use shared::loader::Motion;
use shared::motion::MotionCommand;
use shared::piece::{Header, Order};
use tests::random::Random;
use tests::run::{TICK, mm};
use tests::stock::{Stock, prepare};

/// Random ticks of the path.
const TICKS: usize = 2000;

/// What an axis bears: mm/s^2. At w = 0 the path alone asks for 2 700.
const ACCELERATION: f64 = 7620.0;

/// An axis that the path nearly asks too much of: overrides end soon above 100 %.
const BARELY: f64 = 3600.0;

/// The bar for the distance from the path, in mm.
const OFF: f64 = 1e-4;

/// A setpoint in f32 is some 25 nm off at most, along the path as beside it (`off` below); a second difference weighs four of them.
const ROUNDING: f64 = 4.0 * 25e-6 / (TICK * TICK);

/// Everything about the path that does not move.
struct Ground {
    path: Path,
    active: Vec<ActivePiece<f32>>,
    motion: Motion<f32>,
    rest: bool,
    acceleration: f64,
}

impl Ground {
    fn new(weight: f64, order: Order, rest: bool, acceleration: f64) -> Self {
        let by = FeedOverride { weight: Some(weight), ..FeedOverride::default() };
        let job = Job::from_toml("farouki2018.toml", CONTOUR).unwrap().with_feed(by).unwrap();
        let mut path = Path::new(&job, order).unwrap();
        let limits = AxisLimits { acceleration: [acceleration; 2], jerk: [20.0 * acceleration; 2] };
        path.header.pace = pacing::within(&path, &limits).unwrap();
        let header = Header { rest, ..path.header };
        let pieces: Vec<_> = path.wire().collect();
        let (motion, active) = prepare(&header, &pieces).unwrap();
        Self { path, active, motion, rest, acceleration }
    }

    /// Whether the velocity steps where this piece ends: the tangent breaks or, with w < 1, the curvature does.
    fn steps_after(&self, piece: u32) -> bool {
        let velocity = |piece: &PathPiece, end: usize| {
            let xi = piece.interval[end];
            piece.direction(xi)
                * (piece.stretch(xi) * piece.segment.speed(xi) / Slowness::new(piece, self.path.weight).at(xi))
        };
        let (Some(before), Some(after)) =
            (self.path.pieces.get(piece as usize), self.path.pieces.get(piece as usize + 1))
        else {
            return false;
        };
        // Of some 80 mm/s.
        (velocity(after, 0) - velocity(before, 1)).norm() > 1e-3
    }
}

/// A random number from 0 on.
fn below(random: &mut Random, count: u32) -> u32 {
    random.whole(0, count as usize - 1) as u32
}

/// A motion at some tick, with what is needed to look at the next ones.
#[derive(Clone)]
struct Walker<'a> {
    executor: Executor<f32>,
    stock: Stock<'a, f32>,
    /// The two setpoints before, and whether the path's own velocity steps between them.
    before: [Position; 2],
    corner: bool,
    place: (u32, f32),
    ticks: u32,
}

/// The worst of what was seen.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    off: f64,
    /// Of the axes' acceleration.
    share: f64,
    longest: u32,
}

impl<'a> Walker<'a> {
    fn new(ground: &'a Ground) -> Self {
        let start = ground.path.start();
        let mut executor = Executor::new(shared::TICK, start);
        executor.begin(&ground.motion);
        let stock = Stock::full(&ground.active);
        // A path that begins at its feed begins with a step of its velocity.
        let corner = !ground.rest;
        Self { executor, stock, before: [start; 2], corner, place: (0, -0.5), ticks: 0 }
    }

    /// One tick. `error` is none where the distance from the path is not looked at.
    fn step(&mut self, ground: &Ground, worst: &mut Worst, error: Option<&mut ContourError>) {
        let setpoint = self.executor.tick(&mut self.stock);
        self.ticks += 1;
        let place = self.executor.place().unwrap();
        assert!((place.piece, place.tau) >= self.place, "backwards: {place:?} after {:?}", self.place);
        // A path that ends at its feed ends with a step of its velocity.
        let corner = (self.place.0..place.piece).any(|piece| ground.steps_after(piece))
            || (!ground.rest && self.executor.state() == State::Finished);
        if !corner && !self.corner {
            for axis in 0..2 {
                let [a, b, c] = [self.before[0], self.before[1], setpoint].map(|p| f64::from(p[axis].0));
                let acceleration = (a - 2.0 * b + c).abs() / UNITS_PER_MM / (TICK * TICK);
                worst.share = worst.share.max(acceleration / ground.acceleration);
                assert!(
                    acceleration <= ground.acceleration + ROUNDING,
                    "axis {axis} at {acceleration} mm/s2 in tick {}, {:?} at pace {}, {place:?}",
                    self.ticks,
                    self.executor.state(),
                    self.executor.pace()
                );
            }
        }
        if let Some(error) = error {
            let piece = &ground.path.pieces[place.piece as usize];
            let off = error.at(mm(setpoint), place.piece as usize, piece.parameter(f64::from(place.tau)));
            worst.off = worst.off.max(off);
            assert!(off <= OFF, "{off} mm off in tick {}, {place:?}", self.ticks);
        }
        self.before = [self.before[1], setpoint];
        self.corner = corner;
        self.place = (place.piece, place.tau);
    }

    fn command(&mut self, command: MotionCommand) {
        self.executor.command(command).unwrap();
    }
}

/// A script from one tick on: called before each of the following ticks with their number from 0; false once nothing more happens.
type Script<'s> = dyn FnMut(u32, &mut Walker) -> bool + 's;

/// Runs `script` from each of 2 000 random ticks to the end of the path.
fn each_tick(name: &str, depth: Option<usize>, script: impl Fn(&mut Random) -> Box<Script<'static>>) {
    let mut worst = Worst::default();
    let grounds = [
        (0.0, Order::First, false, ACCELERATION),
        (0.0, Order::First, true, ACCELERATION),
        (0.0, Order::First, true, BARELY),
        (0.5, Order::Third, true, ACCELERATION),
        (1.0, Order::Exact, true, ACCELERATION),
    ];
    for (number, (weight, order, rest, acceleration)) in grounds.into_iter().enumerate() {
        let ground = Ground::new(weight, order, rest, acceleration);
        let mut random = Random::new(number as u64 + 1);
        let length = {
            let mut walker = Walker::new(&ground);
            while walker.executor.state() != State::Finished {
                walker.step(&ground, &mut worst, None);
            }
            walker.ticks
        };
        let mut ticks: Vec<u32> = (0..TICKS / grounds.len()).map(|_| below(&mut random, length)).collect();
        ticks.sort_unstable();
        let mut walker = Walker::new(&ground);
        if let Some(depth) = depth {
            walker.stock.come = depth;
        }
        for tick in ticks {
            while walker.ticks < tick && walker.executor.state() != State::Finished {
                if let Some(depth) = depth {
                    walker.stock.come = (walker.stock.taken + depth).min(ground.active.len());
                }
                walker.step(&ground, &mut worst, None);
            }
            if walker.executor.state() != State::Finished {
                branch(&ground, walker.clone(), script(&mut random), &mut worst);
            }
        }
    }
    println!(
        "{name}: at most {:.4} um off the path, {:.1} % of the axes' acceleration, {} ticks",
        worst.off * 1e3,
        worst.share * 100.0,
        worst.longest
    );
}

/// From one tick to the end.
fn branch(ground: &Ground, mut walker: Walker, mut script: Box<Script<'static>>, worst: &mut Worst) {
    let mut error = ContourError::new(&ground.path);
    // It follows a foot point; here it has to find it first, from the start of the piece.
    for _ in 0..4 {
        let (piece, tau) = walker.place;
        let xi = ground.path.pieces[piece as usize].parameter(f64::from(tau));
        error.at(mm(walker.executor.setpoint()), piece as usize, xi);
    }
    let mut busy = true;
    let from = walker.ticks;
    while !matches!(walker.executor.state(), State::Finished | State::Cancelled) {
        let tick = walker.ticks - from;
        busy = busy && script(tick, &mut walker);
        // Where nothing happens any more the path is run as by anybody; every setpoint of that is looked at elsewhere.
        let looked_at = busy || walker.executor.pace() != 1.0 || tick.is_multiple_of(32);
        walker.step(ground, worst, looked_at.then_some(&mut error));
        assert!(tick < 200_000, "never ends");
    }
    worst.longest = worst.longest.max(walker.ticks);
    if walker.executor.state() == State::Finished {
        assert_eq!(walker.executor.setpoint(), ground.path.end());
    } else {
        let rests = walker.executor.setpoint();
        assert_eq!(walker.stock.taken, walker.stock.come, "what was queued is dropped");
        assert_eq!(walker.executor.tick(&mut walker.stock), rests);
        assert!(walker.executor.command(MotionCommand::Resume).is_err());
    }
}

/// Held for a while, or resumed while it still comes to rest.
#[test]
fn hold_and_resume() {
    each_tick("hold and resume", None, |random| {
        let (resume, again) = (1 + below(random, 900), below(random, 2) == 0);
        let second = resume + 1 + below(random, 300);
        Box::new(move |tick, walker| {
            match tick {
                0 => walker.command(MotionCommand::Hold),
                _ if tick == resume => walker.command(MotionCommand::Resume),
                _ if again && tick == second => walker.command(MotionCommand::Hold),
                _ if again && tick == second + 50 => walker.command(MotionCommand::Resume),
                _ => {}
            }
            if tick == resume && resume > 850 {
                assert_eq!(walker.executor.pace(), 0.0, "it stands by now");
            }
            tick <= second + 50
        })
    });
}

/// To any override, and to another one at any time later.
#[test]
fn overrides() {
    each_tick("override", None, |random| {
        let percents = [0; 3].map(|_| 1 + below(random, 200) as u8);
        let later = [0; 2].map(|_| 1 + below(random, 400));
        Box::new(move |tick, walker| {
            let [first, second] = later;
            for (at, percent) in [(0, percents[0]), (first, percents[1]), (first + second, percents[2].max(20))] {
                if tick == at {
                    walker.command(MotionCommand::Override { percent });
                }
            }
            true
        })
    });
}

/// Comes to rest on the path and leaves it, from a hold or an override too.
#[test]
fn cancel() {
    each_tick("cancel", None, |random| {
        let (before, delay) = (below(random, 3), below(random, 300));
        Box::new(move |tick, walker| {
            if tick == 0 && before == 1 {
                walker.command(MotionCommand::Hold);
            }
            if tick == 0 && before == 2 {
                walker.command(MotionCommand::Override { percent: 200 });
            }
            if tick == delay {
                walker.command(MotionCommand::Cancel);
                walker.command(MotionCommand::Hold);
            }
            true
        })
    });
}

/// The host falls silent with one or two pieces in the queue, and comes back before or after the motion has stopped.
#[test]
fn starvation() {
    for depth in [1, 2] {
        each_tick("starvation", Some(depth), |random| {
            let (silent, commands) = (below(random, 6000), below(random, 3));
            Box::new(move |tick, walker| {
                if tick == silent {
                    walker.stock.come = walker.stock.all();
                }
                if commands == 1 && tick == 100 {
                    walker.command(MotionCommand::Override { percent: 170 });
                }
                if commands == 2 && tick == 100 {
                    walker.command(MotionCommand::Hold);
                }
                if commands == 2 && tick == 250 {
                    walker.command(MotionCommand::Resume);
                }
                tick <= silent.max(250)
            })
        });
    }
}

/// Piece by piece from any tick on; each time it stands it is resumed.
#[test]
fn single_block() {
    each_tick("single block", None, |_| {
        Box::new(|tick, walker| {
            if tick == 0 {
                walker.command(MotionCommand::SingleBlock(true));
            }
            if walker.executor.state() == State::Held {
                let place = walker.executor.place().unwrap();
                assert_eq!(place.tau, 0.5, "rests at the end of a piece");
                walker.command(MotionCommand::Resume);
            }
            true
        })
    });
}
