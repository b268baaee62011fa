//! Pieces with a feed over time: that they keep their time, and what their setpoints are.
#![allow(clippy::unwrap_used, reason = "clippy.toml allows it in tests, which leaves out their helpers")]

use shared::active::ActivePiece;
use shared::complex::Complex;
use shared::curve::{Curve as _, Segment, Spline};
use shared::executor::{Executor, State};
use shared::fixed::{Fixed, Position, UNITS_PER_MM, round_point};
use shared::loader::Motion;
use shared::motion::MotionCommand;
use shared::pace::PaceLimits;
use shared::piece::{Header, Order};
use shared::spline::CorrectionOrder;
use tests::Draft;
use tests::draft::{arc, curves, line, pieces, smooth_path};
use tests::random::Random;
use tests::run::{ORDERS, Scalar, TICK, header, mm, run};
use tests::stock::{Stock, prepare};

/// The feed of all chains, in mm/s.
const FEED: f64 = 120.0;

/// The unit of a setpoint, in mm.
const UNIT: f64 = 1.0 / UNITS_PER_MM;

/// A cubic that bends to both sides, about 50 mm.
fn spline() -> Segment<f64> {
    let points = [(0.0, 0.0), (15.0, 0.0), (32.0, 18.0), (46.0, 9.0)].map(|(x, y)| Complex::new(x, y));
    Segment::Spline(Spline::cubic(points, CorrectionOrder::Ninth))
}

/// Drafts with the speed `speeds` at their ends, in parts of the feed: it goes up and down between them too.
fn timed(path: Vec<Draft>, speeds: &[f64]) -> Vec<Draft> {
    let inner = |k: usize| [[0.8, 0.6], [1.0, 0.3], [0.2, 0.9], [0.5, 0.5]][k % 4];
    let ends = speeds.windows(2).enumerate();
    path.into_iter()
        .zip(ends)
        .map(|(draft, (k, ends))| draft.timed([ends[0], inner(k)[0], inner(k)[1], ends[1]]))
        .collect()
}

/// Curves of every kind from rest to rest: with an offset, and with a spline, which has none.
fn chains() -> [Vec<Draft>; 2] {
    let at = Complex::new(-31.25, 77.125);
    let offset = [curves(90.0)[0], line(40.0, -30.0), arc(0.0, 40.0, 2.0), curves(70.0)[2]];
    let plain = [spline(), curves(50.0)[1], line(40.0, -30.0), arc(0.0, 20.0, -1.0), curves(20.0)[3]];
    [
        timed(smooth_path(&offset, at, 3.0, FEED), &[0.0, 1.0, 0.4, 0.9, 0.0]),
        timed(smooth_path(&plain, at, 0.0, FEED), &[0.0, 0.5, 1.0, 0.3, 0.7, 0.0]),
    ]
}

/// How many ticks a run is off its time.
fn late<T: Scalar>(path: &[Draft], order: Order) -> f64 {
    let expected: f64 = path.iter().map(|draft| draft.duration(0.0)).sum();
    let run = run::<T>(path, 0.5, order).unwrap();
    assert!(run.finished);
    assert_eq!(run.ticks, (expected / TICK).ceil() as u64);
    assert_eq!(run.setpoints.last(), Some(&path[path.len() - 1].last()));
    (run.time - expected) / TICK
}

/// The time of a chain is the sum of S/V over the mean of F, at every order; and its end is the exact one.
#[test]
fn a_profile_keeps_its_time() {
    for path in chains() {
        for order in ORDERS {
            let [single, double] = [late::<f32>(&path, order), late::<f64>(&path, order)];
            println!("{order:?}: {single:.1e} ticks late in f32, {double:.1e} in f64");
            // In f32 the duration of a piece is given to some roundoffs of it, and it has about 1000 ticks; in f64 what a spline's length is
            // fitted to.
            assert!(single.abs() < 1e-2 && double.abs() < 1e-6, "{order:?}: {single} and {double} ticks late");
        }
    }
}

/// The order of the path says nothing where time says all.
#[test]
fn every_order_is_the_same_motion() {
    for path in chains() {
        let first = run::<f32>(&path, 0.0, Order::First).unwrap().setpoints;
        for order in ORDERS {
            assert_eq!(run::<f32>(&path, 0.0, order).unwrap().setpoints, first, "{order:?}");
        }
    }
}

/// Along a profile the feed is the contact point's, whatever weight the path has, and on an arc whose centre goes farther than
/// the contact point too.
#[test]
fn the_weight_does_not_matter() {
    let [path, _] = chains();
    assert!(path[2].stretch(0.5) > 1.05, "an arc with another ratio than 1");
    let [none, half, all] = [0.0, 0.5, 1.0].map(|weight| run::<f32>(&path, weight, Order::Second).unwrap());
    assert_eq!(none.setpoints, half.setpoints);
    assert_eq!(none.setpoints, all.setpoints);
    let arc = Draft::whole(arc(0.0, 40.0, 2.0), 3.0, FEED).timed([1.0; 4]);
    let run = run::<f64>(&[arc], 1.0, Order::First).unwrap();
    assert!((run.time - 80.0 / FEED).abs() < 1e-12, "the way of the contact point is 80 mm");
}

/// A motion with constant jerk on each of seven stretches, from rest to rest: equation by equation.
struct Stretch {
    time: f64,
    /// Way, speed and acceleration at its start, and the jerk.
    start: [f64; 3],
    jerk: f64,
}

impl Stretch {
    fn at(&self, t: f64) -> [f64; 3] {
        let Self { start: [s, v, a], jerk, .. } = *self;
        [s + t * (v + t * (a / 2.0 + t * jerk / 6.0)), v + t * (a + t * jerk / 2.0), a + t * jerk]
    }
}

fn s_curve(jerk: f64, rise: f64, push: f64, cruise: f64) -> Vec<Stretch> {
    let mut state = [0.0; 3];
    [(rise, 1.0), (push, 0.0), (rise, -1.0), (cruise, 0.0), (rise, -1.0), (push, 0.0), (rise, 1.0)]
        .map(|(time, sign)| {
            let stretch = Stretch { time, start: state, jerk: sign * jerk };
            state = stretch.at(time);
            stretch
        })
        .into()
}

/// The farthest that a setpoint of a line with seven stretches of constant jerk is off their closed form, per axis in mm.
fn off_s_curve<T: Scalar>() -> f64 {
    // 600 mm/s^2 after 50 ms, 75 mm/s after 175 ms, as long again, and back.
    let stretches = s_curve(12_000.0, 0.05, 0.075, 0.4003);
    let last = &stretches[6];
    let [way, speed, _] = last.at(last.time);
    assert!(way > 40.0 && speed.abs() < 1e-9);
    let whole = Draft::whole(line(0.6 * way, 0.8 * way), 0.0, 1.0);
    let path: Vec<Draft> = stretches
        .iter()
        .map(|stretch| {
            let ([s0, v0, a0], [s1, v1, a1]) = (stretch.at(0.0), stretch.at(stretch.time));
            // A quadratic in Bezier's form of a cubic: slopes at both ends.
            let third = stretch.time / 3.0;
            let speeds = [v0, v0 + a0 * third, v1 - a1 * third, v1].map(|v| v.max(0.0));
            let feed = speeds.into_iter().fold(0.0, f64::max);
            let to = if s1 > way * (1.0 - 1e-12) { 1.0 } else { s1 / way };
            Draft { feed, ..whole.part(s0 / way, to).timed(speeds.map(|v| v / feed)) }
        })
        .collect();
    let run = run::<T>(&path, 0.0, Order::First).unwrap();
    let time: f64 = stretches.iter().map(|stretch| stretch.time).sum();
    assert_eq!(run.ticks, (time / TICK).ceil() as u64);
    let mut off = 0.0_f64;
    for (setpoint, tick) in run.setpoints.iter().zip(1..run.ticks) {
        let mut t = tick as f64 * TICK;
        let mut rest = stretches.iter();
        let mut stretch = rest.next().unwrap();
        while t > stretch.time {
            t -= stretch.time;
            stretch = rest.next().unwrap();
        }
        let [s, ..] = stretch.at(t);
        let apart = mm(*setpoint) - Complex::new(0.6 * s, 0.8 * s);
        off = off.max(apart.re.abs()).max(apart.im.abs());
    }
    off
}

/// Seven pieces of constant jerk are the S-curve, to the rounding of a setpoint.
#[test]
fn constant_jerk_is_one_piece() {
    let [single, double] = [off_s_curve::<f32>(), off_s_curve::<f64>()].map(|off| off / UNIT);
    println!("an S-curve of 7 pieces: f32 {single:.2} and f64 {double:.2} units off");
    // Half a unit of the setpoint and half a unit of the frame; in f32 besides a roundoff of the 15 mm from the frame.
    assert!(double < 1.001 && single < 2.0);
}

/// F by its coefficients, and its integral over the time before as a part of all of it; t over 0..=1.
fn covered([b0, b1, b2, b3]: [f64; 4], t: f64) -> f64 {
    // The integral of Bernstein's form: its coefficients are the sums, of one degree more.
    let sums = [0.0, b0, b0 + b1, b0 + b1 + b2, b0 + b1 + b2 + b3];
    let s = 1.0 - t;
    let forms = [s.powi(4), 4.0 * s.powi(3) * t, 6.0 * s * s * t * t, 4.0 * s * t.powi(3), t.powi(4)];
    sums.iter().zip(forms).map(|(sum, form)| sum * form).sum::<f64>() / sums[4]
}

/// The parameter xi after the arc length `way`, by bisection.
fn after(draft: &Draft, way: f64) -> f64 {
    let [from, to] = draft.interval;
    let before = draft.segment.length_to(from);
    let (mut low, mut high) = (from, to);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if draft.segment.length_to(middle) - before < way { low = middle } else { high = middle }
    }
    (low + high) / 2.0
}

/// What the ticks on one PH piece were off, in nm: the way on C by the parameter; the setpoints, with their rounding; and the noise of
/// the latter.
fn off_time<T: Scalar>(draft: &Draft) -> [f64; 3] {
    let factors = draft.profile.unwrap().factors;
    let time = draft.duration(0.0);
    let [from, to] = draft.interval;
    let whole = draft.length(from, to);
    let run = run::<T>(&[*draft], 0.0, Order::First).unwrap();
    let mut offs = vec![];
    let mut along = 0.0_f64;
    for ((setpoint, place), tick) in run.setpoints.iter().zip(&run.places).zip(1..run.ticks) {
        let way = whole * covered(factors, tick as f64 * TICK / time);
        let xi = draft.xi(place.tau.into());
        let before = draft.segment.length_to(from);
        along = along.max((draft.segment.length_to(xi) - before - way).abs());
        offs.push(mm(*setpoint) - draft.centre(after(draft, way)));
    }
    let off = offs.iter().map(|off| off.norm()).fold(0.0, f64::max);
    [along * 1e6, off * 1e6, noise(&offs) * 1e6]
}

/// The root mean square of second differences, in what `offs` is in.
fn noise(offs: &[Complex<f64>]) -> f64 {
    let seconds: Vec<f64> = offs.windows(3).map(|o| (o[0] - o[1] * 2.0 + o[2]).norm_sqr()).collect();
    (seconds.iter().sum::<f64>() / seconds.len() as f64).sqrt()
}

/// The noise at constant feed: by ramps, at order "exact".
fn noise_of_ramps<T: Scalar>(draft: &Draft) -> f64 {
    let run = run::<T>(&[*draft], 0.0, Order::Exact).unwrap();
    let offs: Vec<_> = run
        .setpoints
        .iter()
        .zip(1..run.ticks)
        .map(|(setpoint, tick)| mm(*setpoint) - draft.centre(after(draft, tick as f64 * TICK * draft.feed)))
        .collect();
    noise(&offs) * 1e6
}

/// On PH pieces the way on C after every tick is the integral of the profile: in f64 within a nanometre, in f32 within some roundoffs
/// of the piece's length; and the setpoints are no noisier than without a profile.
#[test]
fn the_way_is_the_integral_of_the_profile() {
    // Lengths in mm, and what the way may be off in f32 and f64 in nm. At 120 mm/s 2 mm are 17 ticks.
    for (length, bar) in [(2.0, [2.0, 1.0]), (10.0, [5.0, 1.0]), (50.0, [30.0, 1.0]), (100.0, [60.0, 1.0])] {
        let larger = |a: [f64; 3], b: [f64; 3]| core::array::from_fn(|k| a[k].max(b[k]));
        let (mut single, mut double) = ([0.0; 3], [0.0; 3]);
        let mut noises = [0.0_f64; 2];
        for segment in curves(length) {
            for offset in [0.0, 0.02 * length, -0.02 * length] {
                let draft = Draft::whole(segment, offset, FEED);
                if (0..=100).any(|k| draft.stretch(f64::from(k) / 100.0) < 0.05) {
                    continue;
                }
                for factors in [[0.0, 0.0, 1.0, 1.0], [1.0, 0.3, 0.1, 0.0], [0.0, 1.0, 1.0, 0.0]] {
                    let timed = draft.timed(factors);
                    single = larger(single, off_time::<f32>(&timed));
                    double = larger(double, off_time::<f64>(&timed));
                }
                let even = off_time::<f32>(&draft.timed([1.0; 4]));
                single = larger(single, even);
                noises = [noises[0].max(even[2]), noises[1].max(noise_of_ramps::<f32>(&draft))];
            }
        }
        println!("{length} mm, nm off in f32: way {:.1}, setpoint {:.1}, noise {:.1}", single[0], single[1], single[2]);
        println!(
            "  in f64: {:.1}, {:.1}, {:.1}; noise in f32 at F = 1 {:.1}, by ramps {:.1}",
            double[0], double[1], double[2], noises[0], noises[1]
        );
        assert!(single[0] < bar[0] && double[0] < bar[1], "{length} mm: the way is {single:?} and {double:?} nm off");
        // Half a unit of both axes, of the setpoint and of the frame.
        assert!(double[1] < double[0] + 2.0 * core::f64::consts::FRAC_1_SQRT_2 * UNIT * 1e6);
        assert!(noises[0] < 1.5 * noises[1], "{length} mm: noise {noises:?}");
    }
}

/// A curve whose speed changes tenfold, in parts of some ticks each: the same motion as in one.
#[test]
fn many_nodes_change_nothing() {
    for count in [10, 100, 400] {
        let whole = Draft::whole(curves(50.0)[3], 0.0, FEED);
        let parts =
            (0..count).map(|k| whole.part(f64::from(k) / f64::from(count), f64::from(k + 1) / f64::from(count)));
        let path: Vec<Draft> = parts.map(|part| part.timed([1.0; 4])).collect();
        let run = run::<f32>(&path, 0.0, Order::First).unwrap();
        let off = |(setpoint, tick): (&Position, u64)| {
            (mm(*setpoint) - whole.centre(after(&whole, tick as f64 * TICK * FEED))).norm() * 1e6
        };
        let off = run.setpoints.iter().zip(1..run.ticks).map(off).fold(0.0, f64::max);
        println!("{count} parts: {off:.1} nm off");
        // The rounding of setpoint and frame is 5.4 nm.
        assert!(off < 15.0, "{count} parts: {off} nm off");
    }
}

/// What is done to a motion at some tick.
#[derive(Clone, Copy, Debug)]
enum Disturbance {
    /// Nothing.
    None,
    /// A hold, and a resumption some ticks after the rest.
    Hold,
    /// The override to so many per cent, and back after 200 ticks.
    Override(u8),
    /// Only so many pieces have come, the rest 50 ticks after the stop.
    Dry(usize),
    /// Pieces one by one.
    Blocks,
}

/// A chain that is ready to run.
struct Ground {
    path: Vec<Draft>,
    active: Vec<ActivePiece<f32>>,
    motion: Motion<f32>,
}

impl Ground {
    fn new(path: Vec<Draft>) -> Self {
        // At its feed from the first tick: the profile begins at rest by itself.
        let header = Header { pace: PaceLimits::USUAL, ..header::<f32>(0.0, Order::First) };
        let (motion, active) = prepare(&header, &pieces(&path)).unwrap();
        Self { path, active, motion }
    }

    /// Runs it, disturbed at the tick `at`; looks at every tick. Returns the largest second difference of setpoints in mm, how
    /// many ticks it took, and how many of them it rested.
    fn run(&self, at: u32, disturbance: Disturbance) -> (f64, u32, u32) {
        let start: Position = {
            let [x, y] = round_point(self.path[0].centre(self.path[0].interval[0]));
            [x, y, Fixed(0)]
        };
        let mut executor = Executor::new(shared::TICK, start);
        let mut stock = Stock::full(&self.active);
        if let Disturbance::Dry(come) = disturbance {
            stock.come = come;
        }
        executor.begin(&self.motion);
        let (mut before, mut largest) = ([mm(start); 2], 0.0_f64);
        let (mut rested, mut here) = (0, 0);
        let mut place = (0, -0.5);
        for tick in 0..60_000 {
            match disturbance {
                Disturbance::Hold if tick == at => executor.command(MotionCommand::Hold).unwrap(),
                Disturbance::Override(percent) if tick == at => {
                    executor.command(MotionCommand::Override { percent }).unwrap();
                }
                Disturbance::Override(_) if tick == at + 200 => {
                    executor.command(MotionCommand::Override { percent: 100 }).unwrap();
                }
                Disturbance::Blocks if tick == at => executor.command(MotionCommand::SingleBlock(true)).unwrap(),
                _ => {}
            }
            let setpoint = executor.tick(&mut stock);
            let now = executor.place().unwrap();
            assert!((now.piece, now.tau) >= place, "{disturbance:?} at {at}: backwards at {now:?}");
            place = (now.piece, now.tau);
            let draft = &self.path[now.piece as usize];
            let off = draft.distance(mm(setpoint), draft.xi(now.parameter.into()));
            assert!(off < 2e-5, "{disturbance:?} at {at}: {off} mm off the path at {now:?}");
            largest = largest.max((before[0] - before[1] * 2.0 + mm(setpoint)).norm());
            before = [before[1], mm(setpoint)];
            match executor.state() {
                State::Finished => {
                    assert_eq!(setpoint, self.path[self.path.len() - 1].last(), "{disturbance:?} at {at}");
                    return (largest, tick, rested);
                }
                State::Held | State::Starved => {
                    (rested, here) = (rested + 1, here + 1);
                    assert!(here == 1 || before[0] == before[1], "{disturbance:?} at {at}: moves where it rests");
                    match disturbance {
                        Disturbance::Dry(_) if here == 50 => stock.come = stock.all(),
                        Disturbance::Hold | Disturbance::Blocks if here == 50 => {
                            executor.command(MotionCommand::Resume).unwrap();
                        }
                        _ => {}
                    }
                }
                _ => here = 0,
            }
        }
        panic!("{disturbance:?} at {at}: does not end");
    }
}

/// Hold, resume, override, starvation and single block at random ticks of a profiled path: on the path, at rest where it should, to the
/// exact end.
#[test]
fn a_profile_is_borne_at_any_pace() {
    let mut random = Random::new(21);
    for path in chains() {
        let ground = Ground::new(path);
        let (own, ticks, rested) = ground.run(0, Disturbance::None);
        assert_eq!(rested, 0);
        let mut worst = [0.0_f64; 5];
        for _ in 0..150 {
            let at = random.whole(0, ticks as usize - 20) as u32;
            let kinds = [
                Disturbance::Hold,
                Disturbance::Override(40),
                Disturbance::Override(170),
                Disturbance::Dry(1 + at as usize % (ground.path.len() - 1)),
                Disturbance::Blocks,
            ];
            for (kind, worst) in kinds.into_iter().zip(&mut worst) {
                let (largest, longer, rested) = ground.run(at, kind);
                *worst = worst.max(largest);
                if matches!(kind, Disturbance::Dry(_)) {
                    assert!(rested >= 50, "{kind:?} at {at}: rests");
                }
                assert!(matches!(kind, Disturbance::Override(170)) || longer >= ticks);
            }
        }
        let [own, hold, slower, faster, dry, blocks] =
            [own, worst[0], worst[1], worst[2], worst[3], worst[4]].map(|second| second / (TICK * TICK));
        println!(
            "own {own:.0} mm/s^2, hold {hold:.0}, 40 % {slower:.0}, 170 % {faster:.0}, dry {dry:.0}, blocks {blocks:.0}"
        );
        // What the pace adds, and at a higher pace its square; 4 roundings of 10 nm.
        let bound = own + f64::from(PaceLimits::USUAL.slope) * FEED + 4e-5 / (TICK * TICK);
        assert!([hold, slower, dry, blocks].iter().all(|&second| second < bound));
        assert!(faster < 1.7 * 1.7 * bound);
    }
}
