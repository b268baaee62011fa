//! What the loader refuses; and that the tick bears whatever it takes.
#![allow(clippy::unwrap_used, reason = "clippy.toml allows it in tests, which leaves out their helpers")]

use proptest::prelude::*;
use shared::active::ActivePiece;
use shared::complex::Complex;
use shared::error::PathError;
use shared::executor::{Executor, State};
use shared::feed::Ramp;
use shared::fixed::{Fixed, REACH_MM, UNITS_PER_MM};
use shared::loader::Loader;
use shared::pace::PaceLimits;
use shared::piece::{Header, Order, Piece, Shape};
use shared::profile::Profile;
use tests::Draft;
use tests::draft::{arc, curves, line, moved, pieces};
use tests::run::{Feeder, ORDERS, TICK, header, load};

const HEADER: Header<f32> =
    Header { weight: 0.5, order: Order::First, closed: false, tolerance: 1e-3, rest: false, pace: PaceLimits::USUAL };

/// A piece of each kind that nothing is wrong with.
fn good() -> [Piece<f32>; 3] {
    [curves(50.0)[0], line(30.0, 40.0), arc(0.0, 20.0, 1.5)]
        .map(|segment| Draft::whole(segment, 2.0, 80.0).ramped(0.25, 0.25).piece())
}

/// What the loader says to these pieces.
fn refusal(header: Header<f32>, pieces: &[Piece<f32>]) -> Option<PathError> {
    load(&header, pieces, TICK).err()
}

/// The same bad number in a piece of every kind.
fn every_kind(spoil: impl Fn(&mut Piece<f32>)) -> [Option<PathError>; 3] {
    good().map(|mut piece| {
        spoil(&mut piece);
        refusal(HEADER, &[piece])
    })
}

#[test]
fn nothing_is_wrong_with_the_good_pieces() {
    for piece in good() {
        assert_eq!(refusal(HEADER, &[piece]), None);
    }
}

#[test]
fn headers_out_of_range() {
    for weight in [-0.001, 1.001, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(refusal(Header { weight, ..HEADER }, &[]), Some(PathError::Weight { weight }));
    }
    for tolerance in [0.0, -1.0, f32::INFINITY] {
        assert_eq!(refusal(Header { tolerance, ..HEADER }, &[]), Some(PathError::Tolerance { tolerance }));
    }
    assert!(matches!(refusal(Header { weight: f32::NAN, ..HEADER }, &[]), Some(PathError::Weight { .. })));
    assert!(matches!(refusal(Header { tolerance: f32::NAN, ..HEADER }, &[]), Some(PathError::Tolerance { .. })));
    for weight in [0.0, 1.0] {
        assert_eq!(refusal(Header { weight, ..HEADER }, &good()[..1]), None);
    }
}

#[test]
fn feeds_and_ramps_out_of_range() {
    for feed in [0.0, -80.0, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(every_kind(|piece| piece.feed = feed), [Some(PathError::Feed { feed }); 3]);
    }
    assert!(every_kind(|piece| piece.feed = f32::NAN).iter().all(|e| matches!(e, Some(PathError::Feed { .. }))));
    for factor in [0.0, -0.25, 1.001, f32::INFINITY] {
        let ramp = Some(Ramp { length: 0.25, factor });
        assert_eq!(every_kind(|piece| piece.start = ramp), [Some(PathError::Reduction { factor }); 3]);
        assert_eq!(every_kind(|piece| piece.end = ramp), [Some(PathError::Reduction { factor }); 3]);
    }
    for length in [-0.01, 1.01, f32::INFINITY] {
        let ramp = Some(Ramp { length, factor: 0.5 });
        assert_eq!(every_kind(|piece| piece.start = ramp), [Some(PathError::RampLength { length }); 3]);
        assert_eq!(every_kind(|piece| piece.end = ramp), [Some(PathError::RampLength { length }); 3]);
    }
    // 0.8 and the 0.25 of the other end.
    let ramp = Some(Ramp { length: 0.75 + 0.125, factor: 0.5 });
    assert_eq!(every_kind(|piece| piece.end = ramp), [Some(PathError::Ramps { sum: 1.125 }); 3]);
}

/// A profile stands alone, within 0..=1, and reaches a half: otherwise V would be no more than a name.
#[test]
fn profiles_out_of_range() {
    let timed = |factors: [f32; 4]| {
        every_kind(move |piece| {
            (piece.start, piece.end, piece.profile) = (None, None, Some(Profile { factors }));
        })
    };
    for factors in [[0.0, 0.0, 0.5, 0.0], [1.0; 4], [0.5, 0.0, 0.0, 0.0], [0.0, 1.0, 1.0, 0.0]] {
        assert_eq!(timed(factors), [None; 3]);
    }
    for k in 0..4 {
        for wrong in [-1e-6, 1.000_001, f32::INFINITY, f32::NEG_INFINITY] {
            let mut factors = [0.75; 4];
            factors[k] = wrong;
            assert_eq!(timed(factors), [Some(PathError::Profile { factors }); 3]);
        }
        let mut factors = [0.75; 4];
        factors[k] = f32::NAN;
        assert!(timed(factors).iter().all(|e| matches!(e, Some(PathError::Profile { .. }))));
    }
    for factors in [[0.0; 4], [0.499_999; 4]] {
        assert_eq!(timed(factors), [Some(PathError::Profile { factors }); 3]);
    }
    // Beside a ramp at either end, as the good pieces have them, or at one.
    let factors = [1.0; 4];
    let (error, profile) = (Some(PathError::Profile { factors }), Some(Profile { factors }));
    assert_eq!(every_kind(|piece| piece.profile = profile), [error; 3]);
    assert_eq!(every_kind(|piece| (piece.start, piece.profile) = (None, profile)), [error; 3]);
    assert_eq!(every_kind(|piece| (piece.end, piece.profile) = (None, profile)), [error; 3]);
}

#[test]
fn intervals_that_are_none() {
    for [from, to] in [[0.5, 0.5], [0.7, 0.3], [-0.1, 0.5], [0.5, 1.1], [f32::NEG_INFINITY, f32::INFINITY]] {
        assert_eq!(every_kind(|piece| piece.interval = [from, to]), [Some(PathError::Interval { from, to }); 3]);
    }
    let found = every_kind(|piece| piece.interval[0] = f32::NAN);
    assert!(found.iter().all(|e| matches!(e, Some(PathError::Interval { .. }))));
}

#[test]
fn shapes_that_are_no_motion() {
    let [ph, line, arc] = good();
    let with = |piece: Piece<f32>, shape| refusal(HEADER, &[Piece { shape, ..piece }]);
    let point = |re, im| Complex::new(re, im);

    // Zero length, of each kind.
    assert_eq!(with(line, Shape::Line { chord: point(0.0, 0.0) }), Some(PathError::Length { length: 0.0 }));
    let preimage = [point(0.0, 0.0); 3];
    assert_eq!(with(ph, Shape::Ph { preimage, offset: 0.0 }), Some(PathError::Length { length: 0.0 }));
    let shape = Shape::Arc { radius: point(0.0, 0.0), sweep: 1.0, ratio: 1.0 };
    assert_eq!(with(arc, shape), Some(PathError::Length { length: 0.0 }));

    for sweep in [0.0, 6.3, -7.0, f32::INFINITY] {
        let shape = Shape::Arc { radius: point(5.0, 0.0), sweep, ratio: 1.0 };
        assert_eq!(with(arc, shape), Some(PathError::Sweep { sweep }));
    }

    // 1 + kappa d = 0 inside: w = 1 + i tau has kappa = 2 at tau = 0, so that d = -0.5 is the centre of curvature there, where
    // kappa is largest; a little more has two cusps, a little less has none.
    let parabola = [point(1.0, 0.0), point(0.0, 1.0), point(0.0, 0.0)];
    for (offset, expected) in
        [(-0.5, Some(PathError::Cusp)), (-0.51, Some(PathError::Cusp)), (-0.49, None), (0.5, None), (-2.0, None)]
    {
        assert_eq!(with(ph, Shape::Ph { preimage: parabola, offset }), expected, "offset {offset}");
    }
    // The curve itself stands still at tau = 0.25.
    let still = [point(-0.25, 0.0), point(1.0, 0.0), point(0.0, 0.0)];
    assert_eq!(with(ph, Shape::Ph { preimage: still, offset: 0.0 }), Some(PathError::Cusp));
    // An arc offset to its own centre.
    let shape = Shape::Arc { radius: point(5.0, 0.0), sweep: 1.0, ratio: 0.0 };
    assert_eq!(with(arc, shape), Some(PathError::Cusp));
}

#[test]
fn numbers_that_are_none() {
    let [ph, line, arc] = good();
    let with = |piece: Piece<f32>, shape| refusal(HEADER, &[Piece { shape, ..piece }]);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let (Shape::Ph { preimage, .. }, Shape::Arc { sweep, ratio, .. }) = (ph.shape, arc.shape) else {
            unreachable!("the good pieces have these kinds")
        };
        assert_eq!(with(ph, Shape::Ph { preimage, offset: bad }), Some(PathError::NotFinite));
        for k in 0..3 {
            let mut preimage = preimage;
            preimage[k].im = bad;
            assert_eq!(with(ph, Shape::Ph { preimage, offset: 1.0 }), Some(PathError::NotFinite));
        }
        assert_eq!(with(line, Shape::Line { chord: Complex::new(1.0, bad) }), Some(PathError::NotFinite));
        let radius = Complex::new(bad, 1.0);
        assert_eq!(with(arc, Shape::Arc { radius, sweep, ratio }), Some(PathError::NotFinite));
    }
}

/// Out of reach by its frame, by its ends, or by what lies between them.
#[test]
fn pieces_out_of_reach() {
    let beyond = Fixed((REACH_MM * UNITS_PER_MM) as i32 + 1);
    for place in [beyond, Fixed(-beyond.0), Fixed(i32::MIN), Fixed(i32::MAX)] {
        assert_eq!(every_kind(|piece| piece.origin[0] = place), [Some(PathError::Reach); 3]);
        assert_eq!(every_kind(|piece| piece.origin[1] = place), [Some(PathError::Reach); 3]);
    }
    let last = Some([Fixed(0), Fixed(0), beyond]);
    assert_eq!(every_kind(|piece| piece.last = last), [Some(PathError::Reach); 3]);

    let draft = |segment, x| {
        let segment = moved(segment, Complex::new(x, 0.0));
        refusal(HEADER, &[Draft::whole(segment, 0.0, 80.0).piece()])
    };
    assert_eq!(draft(line(200.0, 0.0), 3799.0), None);
    assert_eq!(draft(line(200.0, 0.0), 3801.0), Some(PathError::Reach), "its end is out of reach, its middle is not");
    assert_eq!(draft(line(1e9, 0.0), -5e8), Some(PathError::Reach));
    assert_eq!(draft(curves(200.0)[0], 3900.0), Some(PathError::Reach));
    assert_eq!(draft(arc(0.0, 200.0, 3.0), 3900.0), Some(PathError::Reach), "its ends are in reach, its middle is not");
}

#[test]
fn paths_that_do_not_hang_together() {
    let line_at = |x: f64, y: f64| Draft::whole(moved(line(10.0, 0.0), Complex::new(x, y)), 0.0, 80.0);
    let gap = |second: Draft| refusal(HEADER, &pieces(&[line_at(0.0, 0.0), second]));
    assert_eq!(gap(line_at(10.0, 0.0)), None);
    // The tolerance is 1 um.
    assert_eq!(gap(line_at(10.0009, 0.0)), None);
    for (found, width) in
        [(gap(line_at(10.25, 0.0)), 0.25), (gap(line_at(10.0, -3.0)), 3.0), (gap(line_at(10.0011, 0.0)), 0.0011)]
    {
        // Two units of rounding.
        assert!(matches!(found, Some(PathError::Gap { width: w }) if (f64::from(w) - width).abs() < 1e-5), "{found:?}");
    }

    let closed = Header { closed: true, ..HEADER };
    let found = refusal(closed, &pieces(&[line_at(0.0, 0.0)]));
    assert!(matches!(found, Some(PathError::Open { width }) if (width - 10.0).abs() < 1e-5), "{found:?}");

    let mut path: Vec<Piece<f32>> = pieces(&[line_at(0.0, 0.0)]);
    let [x, y, z] = path[0].last.unwrap();
    path[0].last = Some([Fixed(x.0 + (2.0 * UNITS_PER_MM) as i32), y, z]);
    let found = refusal(HEADER, &path);
    assert!(matches!(found, Some(PathError::LastPoint { width }) if (width - 2.0).abs() < 1e-5), "{found:?}");

    let mut path: Vec<Piece<f32>> = pieces(&[line_at(0.0, 0.0)]);
    path.push(line_at(10.0, 0.0).piece());
    assert_eq!(refusal(HEADER, &path), Some(PathError::AfterLast));
}

/// A refused piece leaves the loader as it was: the right one may follow.
#[test]
fn a_refused_piece_changes_nothing() {
    let at = |x: f64| Draft::whole(moved(line(10.0, 0.0), Complex::new(x, 0.0)), 0.0, 80.0).piece::<f32>();
    let mut loader = Loader::new(&HEADER, TICK as f32).unwrap();
    assert!(loader.load(&at(0.0)).is_ok());
    assert!(loader.load(&at(30.0)).is_err());
    assert!(loader.load(&Piece { feed: 0.0, ..at(10.0) }).is_err());
    assert!(loader.load(&at(10.0)).is_ok() && !loader.is_finished());
}

/// Every refusal has a test above or elsewhere: a new one must be thought of here.
#[test]
fn every_refusal_is_a_sentence() {
    let all = [
        PathError::Weight { weight: 2.0 },
        PathError::Tolerance { tolerance: 0.0 },
        PathError::Feed { feed: 0.0 },
        PathError::RampLength { length: 2.0 },
        PathError::Reduction { factor: 0.0 },
        PathError::Ramps { sum: 1.5 },
        PathError::Interval { from: 1.0, to: 0.0 },
        PathError::Length { length: 0.0 },
        PathError::Cusp,
        PathError::Sweep { sweep: 0.0 },
        PathError::NotFinite,
        PathError::Reach,
        PathError::Gap { width: 1.0 },
        PathError::Open { width: 1.0 },
        PathError::LastPoint { width: 1.0 },
        PathError::AfterLast,
        PathError::Empty,
        PathError::Pace { slope: 0.0, bend: 1.0, most: 1.0 },
        PathError::SlowStop { slope: 0.1, bend: 1.0 },
    ];
    let mut sentences: Vec<String> = all.iter().map(ToString::to_string).collect();
    sentences.sort();
    sentences.dedup();
    assert_eq!(sentences.len(), all.len(), "no two alike");
    for (error, sentence) in all.iter().map(|e| (e, e.to_string())) {
        assert!(sentence.len() > 20 && !sentence.contains('\n') && !sentence.ends_with('.'), "{error:?}: {sentence}");
    }
}

/// Numbers as they may come over a wire from a faulty sender: any bits, with a liking for the edges.
fn any_number() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => any::<u32>().prop_map(f32::from_bits),
        4 => (any::<bool>(), -40.0..40.0_f32).prop_map(|(minus, power)| 10_f32.powf(power) * if minus { -1.0 } else { 1.0 }),
        2 => -2.0..2.0_f32,
        2 => prop::sample::select(vec![
            0.0, -0.0, 1.0, -1.0, 0.5, f32::MIN_POSITIVE, 1e-45, -1e-45, f32::EPSILON, f32::MAX, f32::MIN,
            f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 4000.0, -8192.0, core::f32::consts::TAU,
        ]),
    ]
}

/// How many numbers a piece and its header hold below.
const SLOTS: usize = 21;

/// Which ramps a piece has, and the coefficients of its profile.
type Law = ([bool; 2], Option<[f32; 4]>);

/// A piece from its numbers.
fn assemble(kind: u8, n: &[f32; SLOTS], (ramps, profile): Law, origin: [i32; 2]) -> (Header<f32>, Piece<f32>) {
    let z = |k: usize| Complex::new(n[k], n[k + 1]);
    let shape = match kind {
        0 => Shape::Ph { preimage: [z(0), z(2), z(4)], offset: n[6] },
        1 => Shape::Line { chord: z(7) },
        _ => Shape::Arc { radius: z(9), sweep: n[11], ratio: n[12] },
    };
    let ramp = |there: bool, k: usize| there.then_some(Ramp { length: n[k], factor: n[k + 1] });
    (
        Header { weight: n[13], tolerance: 1e-3, ..HEADER },
        Piece {
            origin: origin.map(Fixed),
            shape,
            interval: [n[14], n[15]],
            feed: n[16],
            start: ramp(ramps[0], 17),
            end: ramp(ramps[1], 19),
            profile: profile.map(|factors| Profile { factors }),
            further: None,
            last: None,
        },
    )
}

/// Numbers within which most pieces are good.
fn usual_numbers() -> impl Strategy<Value = [f32; SLOTS]> {
    let w = || -8.0..8.0_f32;
    (
        [w(), w(), w(), w(), w(), w()],
        (-5.0..5.0_f32, -100.0..100.0_f32, -100.0..100.0_f32, -50.0..50.0_f32, -50.0..50.0_f32, -6.0..6.0_f32),
        (0.1..2.0_f32, 0.0..=1.0_f32, 0.0..0.5_f32, 0.5..=1.0_f32, 1.0..300.0_f32),
        [0.0..=0.5_f32, 0.01..=1.0_f32, 0.0..=0.5_f32, 0.01..=1.0_f32],
    )
        .prop_map(|(w, (d, x, y, rx, ry, sweep), (ratio, weight, from, to, feed), [l0, f0, l1, f1])| {
            let [a, b, c, d0, e, f] = w;
            [a, b, c, d0, e, f, d, x, y, rx, ry, sweep, ratio, weight, from, to, feed, l0, f0, l1, f1]
        })
}

/// Ramps, or a profile that is mostly good.
fn laws() -> impl Strategy<Value = Law> {
    prop_oneof![
        any::<[bool; 2]>().prop_map(|ramps| (ramps, None)),
        prop::array::uniform4(0.0..=1.0_f32).prop_map(|factors| ([false; 2], Some(factors))),
    ]
}

/// Runs what was accepted and checks every tick: finite, on the piece, and the setpoint is where frame and point say, so that
/// nothing wrapped or saturated on the way. Returns whether the path came to its end.
fn bear(active: ActivePiece<f32>, order: Order, ticks: u32) -> Result<bool, TestCaseError> {
    let mut executor = Executor::new(TICK as f32, [Fixed(0); 3]);
    executor.start(order);
    let mut feeder = Feeder { rest: core::iter::once(active), taken: 0 };
    for _ in 0..ticks {
        let setpoint = executor.tick(&mut feeder);
        match executor.state() {
            State::Finished => return Ok(true),
            State::Starved => return Err(TestCaseError::fail("starved with its last piece")),
            State::Run => {}
            state => return Err(TestCaseError::fail(format!("{state:?} at a fixed pace"))),
        }
        let place = executor.place().unwrap();
        prop_assert!(place.tau >= -0.5 && place.tau <= 0.5, "{order:?}: {place:?}");
        prop_assert!(place.point.is_finite() && place.rate.is_finite() && place.rate >= 0.0, "{order:?}: {place:?}");
        for (coordinate, origin, local) in
            [(setpoint[0], active.origin()[0], place.point.re), (setpoint[1], active.origin()[1], place.point.im)]
        {
            let expected = origin.to_mm() + f64::from(local);
            prop_assert!(
                (coordinate.to_mm() - expected).abs() <= 1.0 / UNITS_PER_MM,
                "{order:?}: {place:?} {setpoint:?}"
            );
        }
    }
    Ok(false)
}

/// The piece with the last point that the kernel itself finds for it, loaded; none where the loader refuses it.
fn load_alone(header: &Header<f32>, mut piece: Piece<f32>) -> Option<ActivePiece<f32>> {
    let active = Loader::new(header, TICK as f32).ok()?.load(&piece).ok()?;
    let [x, y] = active.place(active.point_and_rate(0.5).0);
    piece.last = Some([x, y, Fixed(0)]);
    Loader::new(header, TICK as f32).ok()?.load(&piece).ok()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any bits at all: no panic in the loader, and none in the tick if it takes them.
    #[test]
    fn arbitrary_pieces_never_panic(
        kind in 0..3_u8, numbers in prop::array::uniform21(any_number()), ramps: [bool; 2],
        profile in prop::option::of(prop::array::uniform4(any_number())), origin: [i32; 2],
        last: Option<[i32; 3]>, closed: bool, tolerance in any_number(), order in 0..4_usize,
    ) {
        let (header, piece) = assemble(kind, &numbers, (ramps, profile), origin);
        let header = Header { closed, tolerance, ..header };
        let piece = Piece { last: last.map(|p| p.map(Fixed)), ..piece };
        if let Ok(mut loader) = Loader::new(&header, TICK as f32) {
            let loaded = [loader.load(&piece), loader.load(&piece)];
            let mut executor = Executor::new(TICK as f32, [Fixed(0); 3]);
            executor.start(ORDERS[order]);
            let mut feeder = Feeder { rest: loaded.into_iter().flatten(), taken: 0 };
            for _ in 0..50 {
                executor.tick(&mut feeder);
            }
        }
    }

    /// Good pieces with up to two numbers spoilt: what the loader takes keeps the tick on its path, at every order.
    #[test]
    fn what_is_accepted_is_borne(
        kind in 0..3_u8, numbers in usual_numbers(), law in laws(), origin in [-1e9..1e9, -1e9..1e9],
        spoilt in prop::collection::vec((0..SLOTS, any_number()), 0..3),
    ) {
        let mut numbers = numbers;
        for (slot, value) in spoilt {
            numbers[slot] = value;
        }
        let (header, piece) = assemble(kind, &numbers, law, origin.map(|c: f64| c as i32));
        if let Some(active) = load_alone(&header, piece) {
            for order in ORDERS {
                bear(active, order, 300)?;
            }
        }
    }

    /// Good pieces come to their end: 200 mm at 5 % of 100 mm/s would be 40 s, and the contact point's way on an arc, which is what a
    /// profile counts, may be ten times as long.
    #[test]
    fn good_pieces_come_to_their_end(kind in 0..3_u8, numbers in usual_numbers(), law in laws(), order in 0..4_usize) {
        let mut numbers = numbers;
        numbers[16] = numbers[16].max(100.0);
        for factor in [18, 20] {
            numbers[factor] = numbers[factor].max(0.05);
        }
        let (header, piece) = assemble(kind, &numbers, law, [0; 2]);
        if let Some(active) = load_alone(&header, piece) {
            prop_assert!(bear(active, ORDERS[order], 400 * 1024)?);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Close to a cusp of the offset, or to a standstill of the curve, the loader refuses or the tick is sound.
    #[test]
    fn near_cusps_are_refused_or_borne(
        numbers in usual_numbers(), law in laws(), at in -0.5..0.5_f32, power in -8.0..-1.0_f32, below: bool, still: bool,
    ) {
        let mut n = numbers;
        let near = 10_f32.powf(power) * if below { -1.0 } else { 1.0 };
        if still {
            // w(at) = near (1 + i).
            n[0] = near - at * (n[2] + at * n[4]);
            n[1] = near - at * (n[3] + at * n[5]);
        } else {
            // d = -(1 + near)/kappa(at), kappa = 2 Im(conj w w')/|w|^4.
            let w = [n[0] + at * (n[2] + at * n[4]), n[1] + at * (n[3] + at * n[5])];
            let slope = [n[2] + 2.0 * at * n[4], n[3] + 2.0 * at * n[5]];
            let kappa = 2.0 * (w[0] * slope[1] - w[1] * slope[0]) / (w[0] * w[0] + w[1] * w[1]).powi(2);
            n[6] = -(1.0 + near) / kappa;
        }
        let (header, piece) = assemble(0, &n, law, [0; 2]);
        if let Some(active) = load_alone(&header, piece) {
            for order in ORDERS {
                bear(active, order, 300)?;
            }
        }
    }
}

/// The pieces of the property tests above are not all refused: of usual ones most are taken.
#[test]
fn usual_pieces_are_mostly_accepted() {
    use proptest::strategy::ValueTree;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let mut accepted = 0;
    for k in 0..300 {
        let numbers = usual_numbers().new_tree(&mut runner).unwrap().current();
        let (header, piece) = assemble((k % 3) as u8, &numbers, ([true; 2], None), [0; 2]);
        accepted += u32::from(load_alone(&header, piece).is_some());
    }
    println!("{accepted} of 300 usual pieces are accepted");
    assert!(accepted > 150);
    assert!(header::<f32>(0.5, Order::First).tolerance > 0.0);
}
