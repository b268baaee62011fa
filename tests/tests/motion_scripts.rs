//! Whatever is commanded and however the pieces come: on the path, forwards, within the limits of the pace, and to the end.
#![allow(clippy::unwrap_used, reason = "clippy.toml allows it in tests, which leaves out their helpers")]

use std::sync::atomic::AtomicU32;

use heapless::spsc::Queue;
use proptest::prelude::*;
use shared::active::ActivePiece;
use shared::complex::Complex;
use shared::executor::{Executor, Pieces, State};
use shared::feed::Ramp;
use shared::fixed::Fixed;
use shared::motion::{CommandError, MotionCommand};
use shared::pace::PaceLimits;
use shared::piece::{Header, Order};
use shared::supply::{PathTime, Sink, Source};
use tests::Draft;
use tests::draft::{arc, curves, line, pieces, smooth_path};
use tests::run::{Feeder, ORDERS, Scalar, TICK, exact_mm, header, load, mm};
use tests::stock::{Stock, prepare};

/// What happens before a tick.
#[derive(Clone, Copy, Debug)]
enum Happening {
    Command(MotionCommand),
    /// So many pieces come.
    Come(usize),
}

fn happening() -> impl Strategy<Value = Happening> {
    let percent = prop_oneof![1..=200_u8, Just(100), Just(200)];
    prop_oneof![
        3 => (0..4_usize).prop_map(Happening::Come),
        2 => Just(Happening::Command(MotionCommand::Hold)),
        3 => Just(Happening::Command(MotionCommand::Resume)),
        2 => percent.prop_map(|percent| Happening::Command(MotionCommand::Override { percent })),
        1 => any::<bool>().prop_map(|on| Happening::Command(MotionCommand::SingleBlock(on))),
    ]
}

/// Happenings with the ticks before each.
fn script() -> impl Strategy<Value = Vec<(u32, Happening)>> {
    prop::collection::vec((prop_oneof![0..5_u32, 0..400_u32], happening()), 0..25)
}

/// A curve, a line, an arc and a curve that follow each other smoothly, with ramps at some nodes, cut at some places.
fn path() -> impl Strategy<Value = Vec<Draft>> {
    let ramp = prop::option::of((0.05..0.4, 0.1..=1.0).prop_map(|(length, factor)| Ramp { length, factor }));
    let pieces = prop::collection::vec((0..6_usize, 4.0..40.0, ramp.clone(), ramp), 1..5);
    (pieces, -2.0..2.0, 20.0..150.0, prop::collection::vec((0..5_usize, 0.02..0.98), 0..5)).prop_map(
        |(given, offset, feed, cuts)| {
            let segment = |kind: usize, length: f64| match kind {
                0..4 => curves(length)[kind],
                4 => line(0.6 * length, -0.8 * length),
                _ => arc(0.0, length, 1.0),
            };
            let segments: Vec<_> = given.iter().map(|&(kind, length, ..)| segment(kind, length)).collect();
            let mut drafts = smooth_path(&segments, Complex::new(-31.25, 77.125), offset, feed);
            for (draft, (.., start, end)) in drafts.iter_mut().zip(&given) {
                (draft.start, draft.end) = (*start, *end);
            }
            // A cut piece has lost its ramps in the middle: the feed then steps, which is nobody's concern here.
            for (at, fraction) in cuts {
                if let Some(&draft) = drafts.get(at) {
                    let second = Draft { start: None, ..draft.part(fraction, 1.0) };
                    drafts[at] = Draft { end: None, ..draft.part(0.0, fraction) };
                    drafts.insert(at + 1, second);
                }
            }
            drafts
        },
    )
}

/// Only what the loader takes: no cusps.
fn has_no_cusps(path: &[Draft]) -> bool {
    path.iter().all(|draft| (0..=200).all(|k| draft.stretch(draft.xi(f64::from(k) / 200.0 - 0.5)) > 0.1))
}

fn limits() -> impl Strategy<Value = PaceLimits<f32>> {
    (0.0..1.3_f32, 1.2..3.5_f32, 1.0..=2.0_f32).prop_map(|(slope, bend, most)| PaceLimits {
        slope: 10_f32.powf(slope),
        bend: 10_f32.powf(bend),
        most,
    })
}

/// Looks at every tick of a motion.
struct Watch<'a, T> {
    path: &'a [Draft],
    limits: PaceLimits<f64>,
    place: (u32, T),
    pace: [f64; 2],
    moved: bool,
}

impl<T: Scalar> Watch<'_, T> {
    fn look(&mut self, executor: &Executor<T>) -> Result<(), TestCaseError> {
        let (state, q) = (executor.state(), executor.pace().into());
        // A tick's change of q in what the limits allow; a roundoff of q on top.
        let [before, last] = self.pace;
        let slope = (q - last).abs() / (self.limits.slope * TICK);
        let bend = (q - 2.0 * last + before).abs() / (self.limits.bend * TICK * TICK);
        let roundoff = |limit: f64| 1.0 + 4e-7 / limit;
        prop_assert!(
            slope <= roundoff(self.limits.slope * TICK),
            "{state:?}: q from {last} to {q}, {slope} of the limit"
        );
        // Where a way ends the pace ends with it, from at most one slope.
        let ends = matches!(state, State::Starved | State::Held | State::Finished | State::Cancelled);
        prop_assert!(
            ends || bend <= 2.0 * roundoff(self.limits.bend * TICK * TICK),
            "{state:?}: {before} {last} {q}, {bend}"
        );
        prop_assert!((0.0..=self.limits.most + 1e-6).contains(&q), "{state:?}: {q}");
        self.pace = if ends { [q, q] } else { [last, q] };
        let Some(place) = executor.place() else { return Ok(()) };
        prop_assert!((place.piece, place.tau) >= self.place, "backwards: {place:?} after {:?}", self.place);
        self.moved = (place.piece, place.tau) != self.place;
        self.place = (place.piece, place.tau);
        let draft = self.path[place.piece as usize];
        let off = draft.distance(mm(executor.setpoint()), draft.xi(place.tau.into()));
        prop_assert!(off < 1e-4, "{off} mm off the path, {state:?}, {place:?}");
        if state != State::Finished {
            let exact = draft.distance(exact_mm(self.path, &place).unwrap(), draft.xi(place.tau.into()));
            prop_assert!(exact < 1e-4);
        }
        Ok(())
    }
}

/// Runs a script and lets the path come to its end.
fn run<T: Scalar>(
    path: &[Draft],
    order: Order,
    limits: &PaceLimits<f32>,
    script: &[(u32, Happening)],
    cancel: bool,
) -> Result<u32, TestCaseError> {
    let header = Header { rest: true, pace: limits.exact(), ..header::<T>(0.5, order) };
    let (motion, active) = prepare(&header, &pieces::<T>(path)).unwrap();
    let mut stock = Stock::full(&active);
    stock.come = 1;
    let mut executor = Executor::new(T::lit(TICK), [Fixed(0); 3]);
    executor.begin(&motion);
    let mut watch = Watch { path, limits: limits.exact(), place: (0, -T::HALF), pace: [0.0; 2], moved: false };
    let mut ticks = 0;
    let mut tick = |executor: &mut Executor<T>, stock: &mut Stock<T>| {
        let rests = !executor.state().is_moving();
        let before = executor.setpoint();
        executor.tick(stock);
        ticks += 1;
        prop_assert!(!rests || executor.setpoint() == before, "moved in {:?}", executor.state());
        watch.look(executor)
    };
    for &(delay, happening) in script {
        for _ in 0..delay {
            tick(&mut executor, &mut stock)?;
        }
        match happening {
            Happening::Come(count) => stock.come = (stock.come + count).min(stock.all()),
            Happening::Command(command) => {
                let outcome = executor.command(command);
                // Everything is legal on a path.
                prop_assert!(outcome.is_ok() || executor.state() == State::Finished, "{command:?}: {outcome:?}");
            }
        }
    }
    stock.come = stock.all();
    if executor.state() != State::Finished {
        for command in [MotionCommand::SingleBlock(false), MotionCommand::Override { percent: 100 }] {
            executor.command(command).unwrap();
        }
        executor.command(if cancel { MotionCommand::Cancel } else { MotionCommand::Resume }).unwrap();
    }
    // 160 mm at 20 mm/s and f = 0.1 are 80 s; stops take seconds.
    for _ in 0..200_000 {
        if matches!(executor.state(), State::Finished | State::Cancelled) {
            break;
        }
        tick(&mut executor, &mut stock)?;
    }
    match executor.state() {
        State::Finished => prop_assert_eq!(executor.setpoint(), path[path.len() - 1].last()),
        state => prop_assert!(cancel && state == State::Cancelled && stock.taken == stock.come, "{state:?}"),
    }
    let rests = executor.setpoint();
    prop_assert_eq!(executor.tick(&mut stock), rests);
    Ok(ticks)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 384, max_global_rejects: 65_536, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_script_keeps_to_the_path(
        path in path(), order in 0..4_usize, limits in limits(), script in script(), cancel in prop::bool::weighted(0.3),
    ) {
        prop_assume!(has_no_cusps(&path));
        run::<f32>(&path, ORDERS[order], &limits, &script, cancel)?;
        run::<f64>(&path, ORDERS[order], &limits, &script, cancel)?;
    }
}

/// The twin takes the same decisions: where no way is short, the paces of f32 and f64 are the same in every tick, and the setpoints
/// within 0.1 um, at order "exact" after a second of a second's path.
#[test]
fn the_twin_has_the_same_pace() {
    let path = smooth_path(&[curves(90.0)[0], line(40.0, -30.0)], Complex::ZERO, 2.0, 84.0);
    let commands = [
        (40, MotionCommand::Override { percent: 173 }),
        (300, MotionCommand::Hold),
        (420, MotionCommand::Resume),
        (700, MotionCommand::Override { percent: 20 }),
    ];
    let run = |order| {
        let (motion, active) = prepare(&header::<f32>(0.5, order), &pieces(&path)).unwrap();
        let (twin_motion, twin_active) = prepare(&header::<f64>(0.5, order), &pieces(&path)).unwrap();
        let (mut stock, mut twin_stock) = (Stock::full(&active), Stock::full(&twin_active));
        let mut executor = Executor::new(shared::TICK, [Fixed(0); 3]);
        let mut twin = Executor::new(TICK, [Fixed(0); 3]);
        executor.begin(&motion);
        twin.begin(&twin_motion);
        let mut apart = 0.0_f64;
        for tick in 0..1200 {
            if let Some((_, command)) = commands.iter().find(|(at, _)| *at == tick) {
                executor.command(*command).unwrap();
                twin.command(*command).unwrap();
            }
            let (a, b) = (executor.tick(&mut stock), twin.tick(&mut twin_stock));
            assert_eq!(executor.state(), twin.state(), "tick {tick}");
            assert!((f64::from(executor.pace()) - twin.pace()).abs() < 1e-7);
            apart = apart.max((mm(a) - mm(b)).norm());
        }
        apart
    };
    for order in ORDERS {
        let apart = run(order);
        println!("twins at order {order:?}: {:.4} um apart", apart * 1e3);
        // A thousand steps in f32, each a roundoff of 0.08 mm off in its length: their sum.
        assert!(apart < 1000.0 * 6e-8 * 0.08 + 5e-5, "{order:?}: {apart} mm apart");
    }
}

/// A path that is begun without anything happening to it moves as one at a fixed pace: to the bit.
#[test]
fn a_pace_of_one_changes_no_bit() {
    let path = smooth_path(&[curves(90.0)[0], line(40.0, -30.0), arc(0.0, 40.0, 2.0)], Complex::ZERO, 3.0, 84.0);
    for order in ORDERS {
        let header = header::<f32>(0.5, order);
        let (motion, active) = prepare(&header, &pieces(&path)).unwrap();
        let mut stock = Stock::full(&active);
        let mut feeder = Feeder { rest: active.iter().copied(), taken: 0 };
        let mut executor = Executor::new(shared::TICK, [Fixed(0); 3]);
        let mut fixed = executor;
        executor.begin(&motion);
        fixed.start(order);
        while fixed.state() != State::Finished {
            assert_eq!(executor.tick(&mut stock), fixed.tick(&mut feeder));
            assert_eq!(executor.state(), fixed.state());
        }
        assert_eq!(executor.spare_time(), fixed.spare_time());
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let mut executor = Executor::new(shared::TICK, [Fixed(0); 3]);
    for command in [MotionCommand::Hold, MotionCommand::Resume, MotionCommand::Cancel] {
        assert_eq!(executor.command(command), Err(CommandError::Refused { state: State::Idle }));
    }
    for percent in [0, 201, 255] {
        assert_eq!(executor.command(MotionCommand::Override { percent }), Err(CommandError::Override { percent }));
    }
    executor.start(Order::First);
    assert_eq!(executor.command(MotionCommand::Hold), Err(CommandError::FixedPace));
    // Override and single block hold for later paths.
    executor.command(MotionCommand::Override { percent: 50 }).unwrap();
    executor.abort();
    assert_eq!(executor.percent(), 50);
}

/// Loader and tick with a queue between them, filled while the motion runs; a word says how far it reaches.
#[test]
fn a_queue_says_how_far_it_reaches() {
    let whole = Draft::whole(line(60.0, 80.0), 0.0, 100.0);
    let path: Vec<Draft> = (0..20).map(|k| whole.part(f64::from(k) / 20.0, f64::from(k + 1) / 20.0)).collect();
    let header = Header { rest: true, ..header::<f32>(0.0, Order::First) };
    let (motion, active) = prepare(&header, &pieces(&path)).unwrap();
    let mut queue: Queue<ActivePiece<f32>, 8> = Queue::new();
    let (producer, consumer) = queue.split();
    let horizon = AtomicU32::new(77);
    let (mut sink, mut source) = (Sink::new(producer, &horizon), Source::new(consumer, &horizon));
    sink.restart();
    assert_eq!(Pieces::<f32>::horizon(&source), Some(PathTime::START));
    let mut executor = Executor::new(shared::TICK, [Fixed(0); 3]);
    executor.begin(&motion);
    let mut next = active.iter();
    let (mut ticks, mut starved, mut fastest) = (0_u32, 0, 0.0_f32);
    while executor.state() != State::Finished {
        // One piece of 50 ms every 80 ms.
        if ticks.is_multiple_of(82)
            && sink.room() > 0
            && let Some(piece) = next.next()
        {
            sink.push(*piece).unwrap();
        }
        executor.tick(&mut source);
        starved += u32::from(executor.state() == State::Starved);
        fastest = fastest.max(executor.pace());
        ticks += 1;
        assert!(ticks < 5000);
    }
    // It never counts on more than has come: as slow as its host, and never dead in the middle of a tick.
    assert!(fastest < 0.9 && ticks > 19 * 82, "{fastest}, {ticks} ticks, {starved} starved");
    assert_eq!(executor.setpoint(), path[19].last());
    // A full queue gives the piece back.
    for _ in 0..7 {
        sink.push(active[0]).unwrap();
    }
    assert_eq!((sink.room(), sink.push(active[1])), (0, Err(active[1])));
    Pieces::<f32>::discard(&mut source);
    assert_eq!(sink.room(), 7);
}

/// A supply without a horizon that runs dry all the same stops dead at its node, and goes on from rest.
#[test]
fn a_path_that_counts_on_pieces_that_do_not_come() {
    let whole = Draft::whole(line(60.0, 80.0), 0.0, 100.0);
    let path = [whole.part(0.0, 0.5), whole.part(0.5, 1.0)];
    let header = header::<f32>(0.0, Order::First);
    let (motion, _) = prepare(&header, &pieces(&path)).unwrap();
    let active = load(&header, &pieces(&path), TICK).unwrap();
    let mut executor = Executor::new(shared::TICK, [Fixed(0); 3]);
    executor.begin(&motion);
    let mut first = Feeder { rest: active[..1].iter().copied(), taken: 0 };
    for _ in 0..600 {
        executor.tick(&mut first);
    }
    assert_eq!((executor.state(), executor.pace()), (State::Starved, 0.0));
    assert!((mm(executor.setpoint()) - path[0].centre(0.5)).norm() < 1e-5);
    let mut second = Feeder { rest: active[1..].iter().copied(), taken: 0 };
    let before = executor.setpoint();
    let after = executor.tick(&mut second);
    assert!((mm(after) - mm(before)).norm() < 1e-3 && executor.pace() < 0.01);
}
