//! Axes beside the plane move with a piece, linearly in its arc length.
#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use shared::duration;
use shared::error::PathError;
use shared::executor::{Executor, State};
use shared::fixed::{Fixed, REACH_MM, UNITS_PER_MM};
use shared::further::{Setpoint, Travel};
use shared::motion::MotionCommand;
use shared::piece::{Header, Order, Piece, Shape};
use tests::Draft;
use tests::draft::{arc, curves, line, smooth_path};
use tests::run::{ORDERS, header};
use tests::stock::{Stock, prepare};

fn at(mm: f64) -> Fixed {
    Fixed::from_mm(mm)
}

/// A draft as a piece whose further axes travel so.
fn piece<const F: usize>(draft: &Draft, from: [f64; F], to: [f64; F]) -> Piece<f32, F> {
    let Piece { origin, shape, interval, feed, start, end, profile, last, .. } = draft.piece::<f32>();
    let further = Some(Travel { from: from.map(at), to: to.map(at) });
    Piece { origin, shape, interval, feed, start, end, profile, further, last }
}

fn last<const F: usize>(mut pieces: Vec<Piece<f32, F>>, draft: &Draft) -> Vec<Piece<f32, F>> {
    if let Some(piece) = pieces.last_mut() {
        piece.last = Some(draft.last());
    }
    pieces
}

/// Runs to the end from rest to rest, with a hold in the middle, and shows `look` every tick.
fn run<const F: usize>(
    order: Order,
    pieces: &[Piece<f32, F>],
    start: Setpoint<F>,
    mut look: impl FnMut(&Executor<f32, F>),
) {
    let (motion, active) = prepare(&Header { rest: true, ..header::<f32>(0.5, order) }, pieces).unwrap();
    let mut stock = Stock::full(&active);
    let mut executor = Executor::resting(shared::TICK, start);
    executor.begin(&motion);
    let mut ticks = 0;
    while executor.state() != State::Finished {
        match ticks {
            500 => executor.command(MotionCommand::Hold).unwrap(),
            1000 => executor.command(MotionCommand::Resume).unwrap(),
            _ => {}
        }
        executor.step(&mut stock);
        look(&executor);
        ticks += 1;
        assert!(ticks < 20_000);
    }
}

fn origin<const F: usize>(further: [f64; F]) -> Setpoint<F> {
    Setpoint { plane: [Fixed(0); 2], further: further.map(at) }
}

/// A helix: 8 mm deep over an arc of 2 rad and 20 mm radius, so that z = 4 mm/rad times the angle; at every tick of every order.
#[test]
fn an_arc_with_a_travel_is_a_helix() {
    let draft = Draft::whole(arc(-20.0, 0.0, 2.0), 0.0, 30.0);
    for order in ORDERS {
        let pieces = last(vec![piece(&draft, [1.0], [-7.0])], &draft);
        let mut seen = None;
        run(order, &pieces, origin([1.0]), |executor| {
            let Setpoint { plane: [x, y], further: [z] } = executor.axes();
            let angle = y.to_mm().atan2(x.to_mm() + 20.0);
            // 10 nm in the plane, the rounding of f32 on 8 mm, and half a unit.
            assert!((z.to_mm() - (1.0 - 4.0 * angle)).abs() < 2e-5, "{order:?}: {} at {angle}", z.to_mm());
            seen = Some((executor.axes(), executor.setpoint()));
        });
        let [x, y, _] = draft.last();
        assert_eq!(seen, Some((Setpoint { plane: [x, y], further: [at(-7.0)] }, [x, y, at(-7.0)])));
    }
}

/// On a PH curve at an offset the travel follows the arc length on C, by quadrature of the same preimage; four axes at once.
#[test]
fn four_axes_follow_the_arc_length_of_a_curve() {
    let draft = Draft::whole(curves(70.0)[1], 2.0, 40.0).ramped(0.25, 0.3);
    let (from, to) = ([0.0, 5.0, -100.0, 359.0], [10.0, 5.0, 100.0, -1.0]);
    let pieces = last(vec![piece(&draft, from, to)], &draft);
    let whole = draft.length(0.0, 1.0);
    let mut ends = None;
    run(Order::Third, &pieces, origin(from), |executor| {
        let Some(place) = executor.place() else { return };
        let u = draft.length(0.0, draft.xi(f64::from(place.tau))) / whole;
        for ((z, from), to) in executor.axes().further.into_iter().zip(from).zip(to) {
            // Four roundoffs of u times the travel, and two units.
            let expected = from + (to - from) * u;
            assert!((z.to_mm() - expected).abs() < 2.4e-7 * (to - from).abs() + 2.0 / UNITS_PER_MM, "{z:?} at {u}");
        }
        ends = Some(executor.axes().further);
    });
    assert_eq!(ends, Some(to.map(at)));
}

/// Down, along, and up again: a line without a chord is as long as its travel, and takes its feed; what a piece does not mention
/// stays where it is.
#[test]
fn a_plunge_is_a_line_of_its_own_length() {
    let path = smooth_path(&[line(25.0, 0.0)], shared::complex::Complex::ZERO, 0.0, 50.0);
    let along = path[0].piece::<f32>();
    let still = |plane: [Fixed; 2], from: f64, to: f64| Piece {
        origin: plane,
        shape: Shape::Line { chord: shared::complex::Complex::ZERO },
        feed: 10.0,
        profile: None,
        further: Some(Travel { from: [at(from)], to: [at(to)] }),
        ..along
    };
    let [x, y, _] = path[0].last();
    let pieces = last(vec![still([Fixed(0); 2], 5.0, -3.0), along, still([x, y], -3.0, 5.0)], &path[0]);
    let (motion, active) = prepare(&header::<f32>(0.5, Order::First), &pieces).unwrap();
    // 8 mm at 10 mm/s and 25 mm at 50 mm/s.
    for (piece, seconds) in active.iter().zip([0.8, 0.5, 0.8]) {
        assert!((duration::of(piece) - seconds).abs() < 1e-6, "{}", duration::of(piece));
    }
    let mut stock = Stock::full(&active);
    let mut executor = Executor::new(shared::TICK, [Fixed(0), Fixed(0), at(5.0)]);
    executor.begin(&motion);
    let mut ticks = 0;
    while executor.state() != State::Finished {
        let [x, y, z] = executor.tick(&mut stock);
        ticks += 1;
        match executor.place().unwrap().piece {
            0 => assert_eq!([x, y], [Fixed(0); 2]),
            1 => assert_eq!(z, at(-3.0), "stays where the plunge ended"),
            _ => assert_eq!([x, y], [path[0].last()[0], path[0].last()[1]]),
        }
    }
    assert!((f64::from(ticks) * tests::run::TICK - 2.1).abs() < 0.002);
    assert_eq!(executor.setpoint(), [x, y, at(5.0)]);
}

#[test]
fn faulty_travels_are_refused() {
    let draft = Draft::whole(line(30.0, 40.0), 0.0, 50.0);
    let next = draft.part(0.5, 1.0);
    let refusal = |pieces: &[Piece<f32>]| prepare(&header::<f32>(0.0, Order::First), pieces).err();
    let beyond = REACH_MM + 1.0;
    assert_eq!(refusal(&[piece(&draft, [0.0], [beyond])]), Some(PathError::Reach));
    assert_eq!(refusal(&[piece(&draft, [-beyond], [0.0])]), Some(PathError::Reach));
    let halves = |second: Piece<f32>| [piece(&draft.part(0.0, 0.5), [0.0], [2.0]), second];
    assert_eq!(refusal(&halves(piece(&next, [2.0], [9.0]))), None);
    // The tolerance is 1 um.
    let found = refusal(&halves(piece(&next, [2.25], [9.0])));
    assert!(matches!(found, Some(PathError::Gap { width }) if (width - 0.25).abs() < 1e-5), "{found:?}");
    // Neither a chord nor a travel.
    let nothing = Piece { shape: Shape::Line { chord: shared::complex::Complex::ZERO }, ..piece(&draft, [3.0], [3.0]) };
    assert_eq!(refusal(&[nothing]), Some(PathError::Length { length: 0.0 }));
}
