//! Polynomial splines under the tick: continuity at nodes, the feed that comes out, z, and what is refused.
#![allow(clippy::unwrap_used, missing_docs, reason = "a failed test says where")]

use host_sim::reproduce::feed_correction::fan_points;
use host_sim::spline::{Interpolant, Parametrisation};
use shared::active::ActivePiece;
use shared::complex::Complex;
use shared::curve::{Curve as _, Spline};
use shared::error::PathError;
use shared::executor::{Executor, State};
use shared::fixed::{Fixed, Position, round_point};
use shared::further::Travel;
use shared::loader::Loader;
use shared::pace::PaceLimits;
use shared::piece::{Header, Order, Piece, Shape, SplineShape};
use shared::real::Real;
use shared::spline::{CorrectionOrder, PolynomialSegment};

const FEED: f64 = 100.0;

fn piece<T: Real>(origin: Complex<f64>, shape: SplineShape<f64>, further: Option<Travel>) -> Piece<T> {
    let number = T::lit;
    let shape = SplineShape {
        plane: shape.plane.map(|z| Complex::new(number(z.re), number(z.im))),
        bow: shape.bow.map(number),
        correction: shape.correction,
    };
    Piece {
        origin: round_point(origin),
        shape: Shape::Spline(shape),
        interval: [T::ZERO, T::ONE],
        feed: number(FEED),
        start: None,
        end: None,
        profile: None,
        further,
        last: None,
    }
}

fn cut(curve: &Spline<f64>) -> (Complex<f64>, SplineShape<f64>) {
    let cut = curve.cut(0.0, 1.0, 0.0);
    let Shape::Spline(shape) = cut.shape else { panic!("a spline is cut to a spline") };
    (cut.origin, shape)
}

fn active(curve: &Spline<f64>) -> (Complex<f64>, ActivePiece<f64>) {
    let (origin, shape) = cut(curve);
    (origin, ActivePiece::activate(&piece(origin, shape, None), 0.0, 1.0 / 1024.0).unwrap())
}

/// The derivatives up to the third by time at an end of a piece, from the points that the piece puts out: the derivatives of the
/// polynomial through [`COUNT`] of them, over the part [`WIDTH`] next to that end.
fn motion(piece: &ActivePiece<f64>, origin: Complex<f64>, at_end: bool) -> [Complex<f64>; 3] {
    const COUNT: usize = 15;
    const WIDTH: f64 = 0.35;
    let angle = |k: usize| std::f64::consts::PI * k as f64 / (COUNT - 1) as f64;
    // From 0 at the end to 1, as the nodes of Chebyshev, which carry no more error than they must.
    let x: Vec<f64> = (0..COUNT).map(|k| 0.5 * (1.0 - angle(k).cos())).collect();
    let tau = |x: f64| if at_end { 0.5 - WIDTH * x } else { WIDTH * x - 0.5 };
    let mut table: Vec<Complex<f64>> = x.iter().map(|&x| origin + piece.point_and_rate(tau(x)).0).collect();
    // Newton's divided differences, then the derivatives at x = 0 by Horner's scheme on a series.
    for level in 1..COUNT {
        for k in (level..COUNT).rev() {
            table[k] = (table[k] - table[k - 1]) * (1.0 / (x[k] - x[k - level]));
        }
    }
    let mut series = [Complex::ZERO; 4];
    for k in (0..COUNT).rev() {
        // times (h - x_k), plus the coefficient
        series = [
            table[k] + series[0] * -x[k],
            series[0] + series[1] * -x[k],
            series[1] + series[2] * -x[k],
            series[2] + series[3] * -x[k],
        ];
    }
    let (_, rate) = piece.point_and_rate(if at_end { 0.5 } else { -0.5 });
    let by = if at_end { -rate / WIDTH } else { rate / WIDTH };
    [series[1] * by, series[2] * (2.0 * by * by), series[3] * (6.0 * by * by * by)]
}

/// The largest jump of each derivative at a node, relative to the largest size of that derivative at nodes.
fn jumps(spline: &Interpolant<2>, order: CorrectionOrder) -> [f64; 3] {
    let pieces: Vec<_> = spline.curves(order).map(|curve| active(&curve)).collect();
    let (mut jumps, mut sizes) = ([0.0_f64; 3], [0.0_f64; 3]);
    for k in 0..pieces.len() {
        let (origin, piece) = &pieces[k];
        let (next_origin, next) = &pieces[(k + 1) % pieces.len()];
        let (before, after) = (motion(piece, *origin, true), motion(next, *next_origin, false));
        for n in 0..3 {
            jumps[n] = jumps[n].max((after[n] - before[n]).norm());
            sizes[n] = sizes[n].max(before[n].norm());
        }
    }
    [0, 1, 2].map(|n| jumps[n] / sizes[n])
}

fn ring() -> Vec<[f64; 2]> {
    let angle = |k: u32| std::f64::consts::TAU * (f64::from(k) + 0.2 * (3.0 * f64::from(k)).sin()) / 17.0;
    (0..17).map(|k| [30.0 * angle(k).cos(), 18.0 * angle(k).sin()]).collect()
}

/// Velocity and acceleration of the axes, differentiated from the f64 tick's own points, do not jump at the nodes of a C2 cubic or a C3
/// quintic; without a correction they do.
#[test]
fn velocity_and_acceleration_are_continuous() {
    for by in [Parametrisation::Chord, Parametrisation::Arc] {
        let cubic = Interpolant::cubic(&ring(), true, by).unwrap();
        let quintic = Interpolant::quintic(&ring(), true, by).unwrap();
        for spline in [&cubic, &quintic] {
            for order in [CorrectionOrder::Seventh, CorrectionOrder::Ninth] {
                let [velocity, acceleration, _] = jumps(spline, order);
                assert!(velocity < 1e-9 && acceleration < 1e-9, "{by:?} {order:?}: {velocity} {acceleration}");
            }
            let [velocity, acceleration, _] = jumps(spline, CorrectionOrder::FifthFitted);
            assert!(velocity < 1e-9 && acceleration > 1e-6, "{by:?}, fifth: {velocity} {acceleration}");
        }
    }
    // By arc length even an uncorrected parameter goes on smoothly; by chord length it does not.
    let chord = Interpolant::cubic(&ring(), true, Parametrisation::Chord).unwrap();
    let [velocity, ..] = jumps(&chord, CorrectionOrder::Natural);
    assert!(velocity > 1e-6, "natural: {velocity}");
}

/// With the ninth order the jerk of the axes is continuous too, on a spline whose third derivative is; with the seventh it is not.
#[test]
fn the_jerk_is_continuous_at_the_ninth_order() {
    for by in [Parametrisation::Chord, Parametrisation::Arc] {
        let quintic = Interpolant::quintic(&ring(), true, by).unwrap();
        let [_, _, jerk] = jumps(&quintic, CorrectionOrder::Ninth);
        assert!(jerk < 1e-6, "{by:?}: {jerk}");
        let [_, _, seventh] = jumps(&quintic, CorrectionOrder::Seventh);
        assert!(seventh > 10.0 * jerk, "{by:?}: {seventh} {jerk}");
    }
}

fn header<T: Real>(order: Order, closed: bool) -> Header<T> {
    let rates = PaceLimits::<f32>::USUAL;
    let pace = PaceLimits {
        slope: T::lit(f64::from(rates.slope)),
        bend: T::lit(f64::from(rates.bend)),
        most: T::lit(f64::from(rates.most)),
    };
    Header { weight: T::ZERO, order, closed, tolerance: T::lit(2e-4), rest: false, pace }
}

/// All setpoints of a path, in mm.
fn run<T: Real>(pieces: Vec<Piece<T>>, order: Order, closed: bool) -> Vec<Position> {
    let mut loader = Loader::<T>::new(&header(order, closed), T::lit(1.0 / 1024.0)).unwrap();
    let mut queue: std::collections::VecDeque<_> = pieces.iter().map(|piece| loader.load(piece).unwrap()).collect();
    let [x, y] = loader.start().unwrap();
    let [z] = loader.further_start().unwrap_or([Fixed(0)]);
    struct Supply<T>(std::collections::VecDeque<ActivePiece<T>>);
    impl<T: Real> shared::executor::Pieces<T> for Supply<T> {
        fn next_piece(&mut self, place: &mut Option<ActivePiece<T>>) -> bool {
            let next = self.0.pop_front();
            let found = next.is_some();
            *place = next.or(*place);
            found
        }
    }
    let mut supply = Supply(std::mem::take(&mut queue));
    let mut executor = Executor::new(T::lit(1.0 / 1024.0), [x, y, z]);
    executor.begin(&loader.motion());
    let mut all = vec![[x, y, z]];
    while executor.state() != State::Finished {
        all.push(executor.tick(&mut supply));
        assert!(all.len() < 100_000, "the path ends");
    }
    all
}

fn fan<T: Real>(order: CorrectionOrder) -> Vec<Piece<T>> {
    let spline = Interpolant::cubic(&fan_points(), true, Parametrisation::Chord).unwrap();
    let mut pieces: Vec<Piece<T>> = spline
        .curves(order)
        .map(|curve| {
            let (origin, shape) = cut(&curve);
            piece(origin, shape, None)
        })
        .collect();
    let [x, y] = round_point(Complex::new(fan_points()[0][0], fan_points()[0][1]));
    pieces.last_mut().unwrap().last = Some([x, y, Fixed(0)]);
    pieces
}

/// The f32 tick on the fan: its setpoints are evenly spaced within 0.02 %, of which rounding takes more than half, and every order of
/// integration gives the same, since the rate is constant; in f64 they are within 0.005 %, but for the bow of a chord over its arc.
#[test]
fn the_tick_keeps_its_feed_on_the_fan() {
    let fluctuation = |setpoints: &[Position]| {
        let mm = |p: &Position| Complex::new(p[0].to_mm(), p[1].to_mm());
        let steps = setpoints.windows(2).map(|pair| (mm(&pair[1]) - mm(&pair[0])).norm());
        // The last tick is cut short.
        let count = setpoints.len() - 2;
        steps.take(count).map(|step| (step * 1024.0 / FEED - 1.0).abs()).fold(0.0, f64::max)
    };
    let single = run::<f32>(fan(CorrectionOrder::Seventh), Order::First, true);
    let double = run::<f64>(fan(CorrectionOrder::Seventh), Order::First, true);
    let natural = run::<f32>(fan(CorrectionOrder::Natural), Order::First, true);
    let found = [fluctuation(&single), fluctuation(&double), fluctuation(&natural)];
    println!(
        "fluctuation of the chords: f32 {:.2e}, f64 {:.2e}, f32 without correction {:.2e}",
        found[0], found[1], found[2]
    );
    // A unit of a setpoint is 4e-5 of a step; a step of 0.1 mm on the sharpest bend, of 1.5 mm radius, is 2e-4 shorter than its arc.
    assert!(found[0] < 4.5e-4 && found[1] < 4.5e-4 && found[2] > 1e-2, "{found:?}");
    for order in [Order::Second, Order::Third, Order::Exact] {
        let other = run::<f32>(fan(CorrectionOrder::Seventh), order, true);
        assert_eq!(other.len(), single.len());
        let off = |(a, b): (&Position, &Position)| (0..2).map(|k| (a[k].0 - b[k].0).abs()).max().unwrap();
        // Roundings of the parameter differ by order: 20 nm along the path.
        assert!(single.iter().zip(&other).map(off).max().unwrap() <= 6, "{order:?}");
    }
    let off = |(a, b): (&Position, &Position)| (0..2).map(|k| (a[k].0 - b[k].0).abs()).max().unwrap();
    let twin = single.iter().zip(&double).map(off).max().unwrap();
    println!("f32 against its f64 twin: {twin} units of 3.8 nm");
    assert!(twin < 100, "{twin}");
}

/// A cubic in space: the way is even in all three axes together, z ends exactly, and a bow bends it.
#[test]
fn a_spline_in_space_keeps_its_feed() {
    let rise = 12.0;
    let shape = SplineShape {
        plane: [(30.0, 5.0), (-4.0, 9.0), (3.0, -6.0), (0.0, 0.0), (0.0, 0.0)].map(|(x, y)| Complex::new(x, y)),
        bow: [8.0, -5.0, 0.0, 0.0],
        correction: CorrectionOrder::Seventh,
    };
    let travel = Travel { from: [Fixed::from_mm(-3.0)], to: [Fixed::from_mm(-3.0 + rise)] };
    let PolynomialSegment(space) = shape.segment(rise);
    // An independent z: the straight way and the bow, as the documentation has it.
    let z = |v: f64| -3.0 + rise * (v + 0.5) + (0.25 - v * v) * (8.0 - 5.0 * v);
    for v in [-0.5_f64, -0.2, 0.1, 0.5] {
        let power: f64 = space.iter().zip(0..).map(|(c, k)| c[2] * v.powi(k)).sum();
        assert!((power - (z(v) + 3.0 - 0.5 * rise)).abs() < 1e-13, "{v}");
    }
    let mut one: Piece<f32> = piece(Complex::new(100.0, 50.0), shape, Some(travel));
    let segment = PolynomialSegment(space);
    let [x, y, _] = segment.point(0.5);
    let end = round_point(Complex::new(100.0 + x, 50.0 + y));
    one.last = Some([end[0], end[1], travel.to[0]]);
    let setpoints = run::<f32>(vec![one], Order::First, false);
    let length = segment.length();
    let ticks = length / FEED * 1024.0;
    assert_eq!(setpoints.len(), ticks.ceil() as usize + 1);
    assert_eq!(setpoints.last().unwrap()[2], travel.to[0]);
    let mut bent = 0.0_f64;
    for (k, pair) in setpoints.windows(2).enumerate().take(setpoints.len() - 2) {
        let step: f64 = (0..3).map(|axis| (pair[1][axis].to_mm() - pair[0][axis].to_mm()).powi(2)).sum::<f64>().sqrt();
        assert!((step * 1024.0 / FEED - 1.0).abs() < 1e-3, "tick {k}: {step}");
        let straight = -3.0 + rise * (k as f64 + 1.0) / ticks;
        bent = bent.max((pair[1][2].to_mm() - straight).abs());
    }
    assert!(bent > 1.0, "z bends: {bent}");
}

/// What a controller refuses.
#[test]
fn faulty_splines_are_refused() {
    let shape = |plane: [(f64, f64); 3], bow| SplineShape {
        plane: [plane[0], plane[1], plane[2], (0.0, 0.0), (0.0, 0.0)].map(|(x, y)| Complex::new(x, y)),
        bow,
        correction: CorrectionOrder::Seventh,
    };
    let refused = |shape| {
        let piece = piece::<f32>(Complex::ZERO, shape, None);
        ActivePiece::activate(&piece, 0.0, shared::TICK).err()
    };
    let still = [0.0; 4];
    assert_eq!(refused(shape([(10.0, 0.0), (1.0, 3.0), (0.0, 0.0)], still)), None);
    assert_eq!(refused(shape([(0.0, 0.0), (10.0, 0.0), (0.0, 10.0)], still)), Some(PathError::Standstill));
    assert_eq!(refused(shape([(0.0, 0.0); 3], still)), Some(PathError::Standstill));
    assert_eq!(refused(shape([(f64::NAN, 0.0), (1.0, 3.0), (0.0, 0.0)], still)), Some(PathError::NotFinite));
    assert_eq!(refused(shape([(10.0, 0.0), (f64::INFINITY, 3.0), (0.0, 0.0)], still)), Some(PathError::NotFinite));
    assert_eq!(refused(shape([(0.2, 0.1), (10.0, 0.0), (0.0, 10.0)], still)), Some(PathError::Uneven));
    assert_eq!(refused(shape([(10.0, 0.0), (1.0, 3.0), (0.0, 0.0)], [1.0, 0.0, 0.0, 0.0])), Some(PathError::Bow));
    assert!(matches!(refused(shape([(1e-7, 0.0), (0.0, 0.0), (0.0, 0.0)], still)), Some(PathError::Length { .. })));
    assert_eq!(refused(shape([(1e4, 0.0), (0.0, 0.0), (0.0, 0.0)], still)), Some(PathError::Reach));
}
