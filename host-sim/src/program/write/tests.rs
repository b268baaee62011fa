//! What is written is read back by the readers, which know nothing of the writers.

use std::f64::consts::{PI, TAU};

use proptest::prelude::*;

use super::{Dialect, Settings, WriteError, Writer};
use crate::program::bspline::NoCurve;
use crate::program::item::Nurbs;
use crate::program::{Action, Arc, Feed, Item, Motion, Plane, rs274, sinumerik};

/// What the module promises.
const CLOSE: f64 = 1e-9;

/// Points, weights and knots.
type Normal = (Vec<[f64; 3]>, Vec<f64>, Vec<f64>);

/// A motion that owns its points.
#[derive(Clone, Debug)]
enum Own {
    Rapid([f64; 3]),
    Line([f64; 3]),
    Arc(Arc),
    Bezier(Vec<[f64; 3]>),
    Nurbs { order: usize, points: Vec<[f64; 3]>, weights: Vec<f64>, knots: Vec<f64> },
}

impl Own {
    fn new(motion: &Motion<'_>) -> Self {
        match *motion {
            Motion::Rapid { to } => Self::Rapid(to),
            Motion::Line { to } => Self::Line(to),
            Motion::Arc(arc) => Self::Arc(arc),
            Motion::Bezier { points } => Self::Bezier(points.to_vec()),
            Motion::Nurbs(Nurbs { order, points, weights, knots }) => {
                Self::Nurbs { order, points: points.to_vec(), weights: weights.to_vec(), knots: knots.to_vec() }
            }
        }
    }

    fn motion(&self) -> Motion<'_> {
        match self {
            Self::Rapid(to) => Motion::Rapid { to: *to },
            Self::Line(to) => Motion::Line { to: *to },
            Self::Arc(arc) => Motion::Arc(*arc),
            Self::Bezier(points) => Motion::Bezier { points },
            Self::Nurbs { order, points, weights, knots } => {
                Motion::Nurbs(Nurbs { order: *order, points, weights, knots })
            }
        }
    }

    /// The same curve as a B-spline over 0..=1, its first weight 1.
    fn normal(&self, from: [f64; 3]) -> Option<Normal> {
        match self {
            Self::Bezier(points) => {
                let points: Vec<_> = std::iter::once(from).chain(points.iter().copied()).collect();
                let (order, weights) = (points.len(), vec![1.0; points.len()]);
                let knots = (0..2 * order).map(|k| if k < order { 0.0 } else { 1.0 }).collect();
                Some((points, weights, knots))
            }
            Self::Nurbs { points, weights, knots, .. } => {
                let weights = weights.iter().map(|weight| weight / weights[0]).collect();
                let (first, last) = (knots[0], knots[knots.len() - 1]);
                Some((points.clone(), weights, knots.iter().map(|knot| (knot - first) / (last - first)).collect()))
            }
            _ => None,
        }
    }
}

fn near(p: &[f64], q: &[f64], close: f64) -> bool {
    p.len() == q.len() && p.iter().zip(q).all(|(p, q)| (p - q).abs() <= close)
}

fn same(wrote: &Own, from: [f64; 3], read: &Item<'_>, back: &Own) -> bool {
    if !near(&from, &read.from, CLOSE) {
        return false;
    }
    match (wrote, back) {
        (Own::Rapid(to), Own::Rapid(other)) | (Own::Line(to), Own::Line(other)) => near(to, other, CLOSE),
        (Own::Arc(arc), Own::Arc(other)) => {
            // The angle is that of ends and centre with ten decimals: of a short radius it is less sure.
            let radius = (from[arc.plane.axes()[0]] - arc.centre[0]).hypot(from[arc.plane.axes()[1]] - arc.centre[1]);
            near(&arc.to, &other.to, CLOSE)
                && near(&arc.centre, &other.centre, CLOSE)
                && (arc.plane, arc.turns) == (other.plane, other.turns)
                && (arc.sweep - other.sweep).abs() * radius <= CLOSE
        }
        _ => match (wrote.normal(from), back.normal(read.from)) {
            (Some((points, weights, knots)), Some((others, theirs, marks))) => {
                near(points.as_flattened(), others.as_flattened(), CLOSE)
                    && near(&weights, &theirs, 1e-14)
                    && near(&knots, &marks, 1e-13)
            }
            _ => false,
        },
    }
}

type Chain = Vec<([f64; 3], Feed, Own)>;

fn written(chain: &Chain, dialect: Dialect, settings: Settings) -> Result<String, WriteError> {
    let mut writer = Writer::new(Vec::new(), dialect, settings)?;
    for (from, feed, own) in chain {
        writer.motion(*from, *feed, &own.motion())?;
    }
    Ok(String::from_utf8(writer.finish()?).unwrap())
}

/// The motions of a program, each with where it begins and its feed.
fn read(program: &str, dialect: Dialect) -> Vec<(Item<'static>, Own)> {
    let mut found = Vec::new();
    let mut sink = |item: &Item<'_>| {
        if let Action::Motion(motion) = item.action {
            found.push((
                Item { action: Action::End, line: item.line, column: 0, from: item.from, feed: item.feed },
                Own::new(&motion),
            ));
        }
        Ok(())
    };
    let result = match dialect {
        Dialect::Rs274 => rs274::read("part.ngc", program.as_bytes(), &rs274::Settings::default(), &mut sink),
        Dialect::Sinumerik => {
            sinumerik::read("part.mpf", program.as_bytes(), &sinumerik::Settings::default(), &mut sink)
        }
    };
    assert!(result.is_ok(), "{}\n{program}", result.unwrap_err());
    found
}

/// What a random motion is made of.
#[derive(Clone, Debug)]
struct Draw {
    kind: u8,
    points: Vec<[f64; 3]>,
    weights: Vec<f64>,
    intervals: Vec<f64>,
    degree: usize,
    angle: f64,
    turns: u32,
    feed: f64,
}

fn draws() -> impl Strategy<Value = Vec<Draw>> {
    let point = prop::array::uniform3(-300.0..300.0_f64);
    let draw = (
        0..6_u8,
        prop::collection::vec(point, 8..12),
        prop::collection::vec(0.5..1.4_f64, 12),
        prop::collection::vec(prop_oneof![Just(0.0), 0.01..5.0_f64], 12),
        2..=3_usize,
        (0.01..0.99_f64, any::<bool>()),
        0..3_u32,
        0.01..500.0_f64,
    );
    let draw = draw.prop_map(|(kind, points, weights, intervals, degree, (part, left), turns, feed)| {
        let angle = if left { part * TAU } else { -part * TAU };
        Draw { kind, points, weights, intervals, degree, angle, turns, feed }
    });
    prop::collection::vec(draw, 1..12)
}

/// A chain of motions that begins with a rapid; flat ones and equal intervals for a language that has no others.
fn chain(draws: Vec<Draw>, dialect: Dialect) -> Chain {
    let flat = dialect == Dialect::Rs274;
    let mut place = [0.0; 3];
    let mut chain = vec![([0.0; 3], Feed::Unset, Own::Rapid([1.5, -2.0 / 3.0, 0.125]))];
    place.copy_from_slice(&[1.5, -2.0 / 3.0, 0.125]);
    for mut draw in draws {
        if flat && draw.kind > 2 {
            draw.points.iter_mut().for_each(|point| point[2] = place[2]);
        }
        let feed = if draw.kind == 0 { Feed::Unset } else { Feed::Rate(draw.feed) };
        let own = match draw.kind {
            0 => Own::Rapid(draw.points[0]),
            1 => Own::Line(draw.points[0]),
            2 => {
                let plane = [Plane::Xy, Plane::Zx, Plane::Yz]
                    [draw.degree + draw.turns as usize - 2 - usize::from(draw.turns == 2)];
                let [first, second, across] = plane.axes();
                let centre = [draw.points[0][0], draw.points[0][1]];
                let (x, y) = (place[first] - centre[0], place[second] - centre[1]);
                let (sin, cos) = draw.angle.sin_cos();
                let mut to = place;
                to[first] = centre[0] + x * cos - y * sin;
                to[second] = centre[1] + x * sin + y * cos;
                to[across] = draw.points[0][2];
                let sweep = draw.angle + TAU.copysign(draw.angle) * f64::from(draw.turns);
                Own::Arc(Arc { plane, centre, to, sweep, turns: draw.turns })
            }
            3 => Own::Bezier(draw.points[..draw.degree].to_vec()),
            _ => {
                draw.points[0] = place;
                let count = draw.points.len();
                let spans = count - draw.degree;
                let mut knots = vec![0.0; draw.degree + 1];
                let (mut end, mut zeros) = (0.0, 0);
                for k in 0..spans {
                    let ends = k == 0 || k + 1 == spans || zeros + 1 >= draw.degree;
                    let length = match draw.intervals[k] {
                        _ if flat => 1.0,
                        0.0 if ends => 1.0,
                        length => length,
                    };
                    zeros = if length == 0.0 { zeros + 1 } else { 0 };
                    end += length;
                    knots.push(end);
                }
                knots.extend(vec![end; draw.degree]);
                let weights = if draw.kind == 4 { vec![1.0; count] } else { draw.weights[..count].to_vec() };
                Own::Nurbs { order: draw.degree + 1, points: draw.points, weights, knots }
            }
        };
        let to = own.motion().to().unwrap();
        chain.push((std::mem::replace(&mut place, to), feed, own));
    }
    chain
}

fn comes_back(chain: &Chain, dialect: Dialect, numbers: Option<u32>) -> Result<(), TestCaseError> {
    let program = written(chain, dialect, Settings { numbers }).unwrap();
    let back = read(&program, dialect);
    prop_assert_eq!(back.len(), chain.len(), "{}", program);
    for ((from, feed, own), (item, found)) in chain.iter().zip(&back) {
        prop_assert!(same(own, *from, item, found), "{:?}\n{:?} {:?}\n{}", own, item, found, program);
        if let (Feed::Rate(wrote), Feed::Rate(read)) = (feed, item.feed) {
            prop_assert!((wrote - read).abs() <= 1e-9 * wrote);
        }
    }
    Ok(())
}

proptest! {
    #[test]
    fn rs274_comes_back(draws in draws(), numbers in prop::option::of(1..20_000_u32)) {
        comes_back(&chain(draws, Dialect::Rs274), Dialect::Rs274, numbers)?;
    }

    #[test]
    fn sinumerik_comes_back(draws in draws(), numbers in prop::option::of(1..20_000_u32)) {
        comes_back(&chain(draws, Dialect::Sinumerik), Dialect::Sinumerik, numbers)?;
    }

    /// A curve with any knots is written as its Bézier pieces: the same places at the same knots, by the basis functions of Cox
    /// and de Boor for the whole, and by those of each piece.
    #[test]
    fn pieces_are_the_curve(draw in draws()) {
        let draws = draw.into_iter().map(|draw| Draw { kind: 5, ..draw }).take(1).collect();
        let mut chain = chain(draws, Dialect::Sinumerik);
        for (from, _, own) in &mut chain {
            from[2] = 0.0;
            match own {
                Own::Rapid(to) => to[2] = 0.0,
                Own::Nurbs { points, .. } => points.iter_mut().for_each(|point| point[2] = 0.0),
                _ => {}
            }
        }
        let (_, _, Own::Nurbs { order, points, weights, knots }) = &chain[1] else { panic!("{chain:?}") };
        let curve = Nurbs { order: *order, points, weights, knots };
        let back = read(&written(&chain, Dialect::Rs274, Settings::default()).unwrap(), Dialect::Rs274);
        let spans: Vec<_> = knots.windows(2).filter(|pair| pair[0] < pair[1]).collect();
        let pieces = &back[1..];
        prop_assert_eq!(pieces.len(), spans.len());
        for (span, (item, piece)) in spans.iter().zip(pieces) {
            let (points, weights, knots) = piece.normal(item.from).unwrap();
            let piece = Nurbs { order: *order, points: &points, weights: &weights, knots: &knots };
            for part in [0.0, 0.2, 0.5, 0.9] {
                let (whole, own) = (at(&curve, span[0] + (span[1] - span[0]) * part), at(&piece, part));
                prop_assert!(near(&whole, &own, 1e-8), "{:?} {:?}", whole, own);
            }
        }
    }
}

/// A point of a B-spline as the sum of basis functions.
fn at(curve: &Nurbs<'_>, u: f64) -> [f64; 3] {
    fn basis(knots: &[f64], i: usize, degree: usize, u: f64) -> f64 {
        if degree == 0 {
            return f64::from(u8::from(knots[i] <= u && u < knots[i + 1]));
        }
        let part = |top: f64, bottom: f64| if bottom == 0.0 { 0.0 } else { top / bottom };
        part(u - knots[i], knots[i + degree] - knots[i]) * basis(knots, i, degree - 1, u)
            + part(knots[i + degree + 1] - u, knots[i + degree + 1] - knots[i + 1]) * basis(knots, i + 1, degree - 1, u)
    }
    let parts: Vec<f64> =
        (0..curve.points.len()).map(|i| basis(curve.knots, i, curve.order - 1, u) * curve.weights[i]).collect();
    let whole: f64 = parts.iter().sum();
    std::array::from_fn(|k| parts.iter().zip(curve.points).map(|(part, point)| part * point[k]).sum::<f64>() / whole)
}

#[test]
fn programs_look_like_this() {
    let arc = Arc { plane: Plane::Xy, centre: [1.0, 1.0], to: [1.0, 2.0, 0.0], sweep: PI / 2.0, turns: 0 };
    let chain: Chain = vec![
        ([2.0, 1.0, 0.0], Feed::Rate(10.0), Own::Arc(arc)),
        ([1.0, 2.0, 0.0], Feed::Rate(10.0), Own::Bezier(vec![[0.0, 2.0, 0.0], [0.0, 3.0, 0.0], [0.5, 4.0, 0.0]])),
        ([0.5, 4.0, 0.0], Feed::Rate(100.0 / 3.0), Own::Bezier(vec![[1.0, 5.0, 0.0], [1.5, 4.0, 0.0]])),
        ([1.5, 4.0, 0.0], Feed::Duration(2.0), Own::Line([1.5, 4.1, 0.0])),
    ];
    assert_eq!(
        written(&chain, Dialect::Rs274, Settings { numbers: Some(10) }).unwrap(),
        "N10 G17 G21 G90 G91.1 G94\nN20 G0 X2 Y1 Z0\nN30 G3 X1 Y2 Z0 I-1 J0 F600\nN40 G5 I-1 J0 P-0.5 Q-1 X0.5 Y4\n\
         N50 G5.1 I0.5 J1 X1.5 Y4 F2000\nN60 G1 Y4.1 G93 F30\nN70 M30\n"
    );
    assert_eq!(
        written(&chain, Dialect::Sinumerik, Settings::default()).unwrap(),
        "G17 G710 G90 G94\nG0 X2 Y1 Z0\nG3 X1 Y2 Z0 I-1 J0 F600\nBSPLINE SD=3 X0 Y2 Z0 PL=0\nX0 Y3 Z0 PL=0\nX0.5 Y4 Z0 PL=1\n\
         G1\nBSPLINE SD=2 F2000 X1 Y5 Z0 PL=0\nX1.5 Y4 Z0 PL=1\nG1 Y4.1 G93 F30\nM30\n"
    );
}

#[test]
fn each_fault_is_found_and_nothing_of_it_is_written() {
    let rate = Feed::Rate(1.0);
    let nurbs = |weights: Vec<f64>, knots: Vec<f64>, z: f64| {
        let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, z], [0.0, 1.0, 0.0]];
        Own::Nurbs { order: 8 - weights.len(), points, weights, knots }
    };
    let cubic = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let quarter = Arc { plane: Plane::Xy, centre: [1.0, 0.0], to: [1.0, 1.0, 0.0], sweep: 1.0, turns: 0 };
    for (dialect, feed, own, expected) in [
        (Dialect::Rs274, Feed::Unset, Own::Line([1.0; 3]), WriteError::NoFeed),
        (Dialect::Rs274, Feed::Rate(0.0), Own::Line([1.0; 3]), WriteError::NoFeed),
        (Dialect::Rs274, rate, Own::Line([f64::NAN; 3]), WriteError::Number),
        (Dialect::Rs274, rate, Own::Line([1e10; 3]), WriteError::Number),
        (Dialect::Rs274, rate, Own::Arc(quarter), WriteError::Arc),
        (Dialect::Rs274, rate, Own::Bezier(vec![[1.0; 3], [2.0; 3]]), WriteError::Flat),
        (Dialect::Rs274, rate, Own::Bezier(vec![[1.0; 3]; 4]), WriteError::Degree(4)),
        (Dialect::Rs274, rate, nurbs(vec![1.0; 4], cubic.clone(), 1.0), WriteError::Flat),
        (Dialect::Sinumerik, rate, nurbs(vec![1.0, 4.0, 1.0, 1.0], cubic.clone(), 1.0), WriteError::Weight(4.0)),
        (Dialect::Sinumerik, Feed::Duration(1.0), nurbs(vec![1.0; 4], cubic.clone(), 1.0), WriteError::Duration),
        (Dialect::Sinumerik, rate, nurbs(vec![1.0; 3], cubic, 1.0), WriteError::Curve(NoCurve::Few)),
    ] {
        let mut writer = Writer::new(Vec::new(), dialect, Settings::default()).unwrap();
        writer.motion([0.0; 3], Feed::Unset, &Motion::Rapid { to: [0.0; 3] }).unwrap();
        assert_eq!(writer.motion([0.0; 3], feed, &own.motion()), Err(expected), "{own:?}");
        let program = String::from_utf8(writer.finish().unwrap()).unwrap();
        assert_eq!(program.lines().skip(1).collect::<Vec<_>>(), ["G0 X0 Y0 Z0", "M30"]);
    }
    let mut writer = Writer::new(Vec::new(), Dialect::Rs274, Settings::default()).unwrap();
    writer.motion([0.0; 3], rate, &Motion::Line { to: [1.0, 0.0, 0.0] }).unwrap();
    let result = writer.motion([0.0; 3], rate, &Motion::Line { to: [2.0, 0.0, 0.0] });
    assert_eq!(result, Err(WriteError::Gap(1.0)));
}

/// Found by fuzzing: an arc that is smaller than the digits of a program would be none, or a whole circle.
#[test]
fn arcs_too_small_for_digits_are_lines() {
    for (radius, sweep) in [(1e-29, TAU), (1e-12, 3.0), (1e-5, 3e-6), (1000.0, 1e-7), (1e-10, 3.0 * TAU)] {
        let to = [radius * f64::cos(sweep), radius * f64::sin(sweep), 5.0];
        let turns = if sweep > TAU { 2 } else { 0 };
        let arc = Arc { plane: Plane::Xy, centre: [0.0; 2], to, sweep, turns };
        for dialect in [Dialect::Rs274, Dialect::Sinumerik] {
            let chain: Chain = vec![([radius, 0.0, 0.0], Feed::Rate(1.0), Own::Arc(arc))];
            let back = read(&written(&chain, dialect, Settings::default()).unwrap(), dialect);
            assert!(matches!(&back[..], [_, (_, Own::Line(end))] if near(end, &to, CLOSE)), "{back:?}");
        }
    }
}
