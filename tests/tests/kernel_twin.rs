//! The f32 tick against its f64 twin and against the exact offset path.
#![allow(clippy::unwrap_used, reason = "clippy.toml allows it in tests, which leaves out their helpers")]

use proptest::prelude::*;
use shared::complex::Complex;
use shared::curve::{Curve, PhQuintic, Segment};
use shared::feed::Ramp;
use shared::piece::Order;
use tests::Draft;
use tests::draft::{arc, curves, line, moved, ph};
use tests::run::{ORDERS, TICK, exact_mm, mm, run};

/// The bar of the design: 0.1 um.
const BAR: f64 = 1e-4;

/// What a path did in both scalars.
#[derive(Clone, Copy, Debug, Default)]
struct Twins {
    /// The farthest that an f32 setpoint and an f64 position were off the exact offset path, in mm.
    off: [f64; 2],
    /// The difference of the times in ticks, and of the last setpoints in mm.
    ends: [f64; 2],
}

impl Twins {
    fn and(self, other: Self) -> Self {
        let larger = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].max(b[1])];
        Self { off: larger(self.off, other.off), ends: larger(self.ends, other.ends) }
    }

    fn check(self, what: &str) {
        let Self { off: [off, off_twin], ends: [late, apart] } = self;
        println!(
            "{what}: f32 {:.4} um and f64 {:.1e} um off the path, ends {late:.4} ticks and {:.4} um apart",
            off * 1e3,
            off_twin * 1e3,
            apart * 1e3
        );
        assert!(off < BAR, "{what}: an f32 setpoint is {off} mm off the path");
        // The frame is some 100 mm away from the origin, the point another 100 mm from it: a few roundoffs of that.
        assert!(off_twin < 1e-11, "{what}: the f64 twin is {off_twin} mm off the path");
        assert!(late < 1.0 && apart < BAR, "{what}: ends {late} ticks and {apart} mm apart");
    }
}

/// Runs both. Distances are to the foot point on the piece that the kernel says, so at least the true ones; the parameter that it
/// says is only where the search starts.
fn twins(path: &[Draft], weight: f64, order: Order) -> Twins {
    let single = run::<f32>(path, weight, order).unwrap();
    let double = run::<f64>(path, weight, order).unwrap();
    assert!(single.finished && double.finished);
    let mut twins = Twins::default();
    for (setpoint, place) in single.setpoints.iter().zip(&single.places) {
        let draft = path[place.piece as usize];
        twins.off[0] = twins.off[0].max(draft.distance(mm(*setpoint), draft.xi(f64::from(place.tau))));
    }
    // The last place is the end of the path, which is not evaluated any more.
    for place in &double.places[..double.places.len() - 1] {
        let draft = path[place.piece as usize];
        let point = exact_mm(path, place).unwrap();
        twins.off[1] = twins.off[1].max(draft.distance(point, draft.xi(place.tau)));
    }
    let [Some(a), Some(b)] = [single.setpoints.last(), double.setpoints.last()] else { return twins };
    twins.ends = [(single.time - double.time).abs() / TICK, (mm(*a) - mm(*b)).norm()];
    twins
}

/// Single pieces of all kinds up to 200 mm, with offsets to both sides and ramps, near the origin and far from it.
#[test]
fn f32_keeps_to_the_exact_path() {
    for length in [5.0, 60.0, 200.0] {
        let mut all = Twins::default();
        let radius = length / 2.0;
        let others =
            [line(length, 0.0), line(-0.6 * length, 0.8 * length), arc(0.0, radius, 2.0), arc(radius, 0.0, -1.3)];
        for (number, segment) in curves(length).into_iter().chain(others).enumerate() {
            for offset in [0.0, 0.02 * length, -0.02 * length, 25.4] {
                let segment = moved(segment, Complex::new(123.456_789 * offset, -345.678_912));
                let draft = Draft::whole(segment, offset, 120.0).ramped(0.25, 0.25);
                // Only what the loader takes: 25.4 mm to the inside of a tight bend has a cusp.
                let stretches: Vec<f64> = (0..=400).map(|k| draft.stretch(f64::from(k) / 400.0)).collect();
                if stretches.iter().any(|s| *s < 0.01) && stretches.iter().any(|s| *s > -0.01) {
                    continue;
                }
                for order in ORDERS {
                    let twins = twins(&[draft], [0.0, 0.5, 1.0][number % 3], order);
                    all = all.and(twins);
                }
            }
        }
        all.check(&format!("pieces of {length} mm"));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, max_global_rejects: 65_536, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any PH curve up to 200 mm at any offset up to an inch. Where the parametric speed falls below a 20th of its peak the
    /// direction of w, and with it the normal, is known to fewer digits: that is the range of this bar.
    #[test]
    fn f32_keeps_to_any_curve(
        w in [(-1.0..1.0, -1.0..1.0), (-1.0..1.0, -1.0..1.0), (-1.0..1.0, -1.0..1.0)], length in 1.0..200.0,
        offset in -25.4..25.4, weight in 0.0..=1.0, order in 0..4_usize,
    ) {
        let draft = Draft::whole(ph(w, length), offset, 120.0);
        let along = (0..=200).map(|k| f64::from(k) / 200.0);
        let (least, most) =
            along.clone().map(|xi| draft.sigma(xi)).fold((f64::MAX, 0.0_f64), |(a, b), s| (a.min(s), b.max(s)));
        prop_assume!(least > most / 20.0);
        let stretches: Vec<f64> = along.map(|xi| draft.stretch(xi)).collect();
        prop_assume!(stretches.iter().all(|s| *s > 0.05) || stretches.iter().all(|s| *s < -0.05));
        let Twins { off: [off, _], ends: [late, apart] } = twins(&[draft], weight, ORDERS[order]);
        prop_assert!(off < BAR && late < 1.0 && apart < BAR, "{off} mm off, ends {late} ticks and {apart} mm apart");
    }
}

/// A whole circle has its points twice as far from its frame as any other arc of its length.
#[test]
fn f32_keeps_to_a_whole_circle() {
    let circle = Draft::whole(arc(-30.0, 10.0, core::f64::consts::TAU), 3.0, 80.0);
    twins(&[circle], 0.5, Order::First).check("a circle of 66 mm");
}

/// The distance of the foot point is the true one: no sample of the whole piece, a micrometre apart, is nearer.
#[test]
fn foot_points_are_the_nearest() {
    let draft = Draft::whole(curves(20.0)[1], 0.3, 80.0);
    let samples: Vec<Complex<f64>> = (0..=20_000).map(|k| draft.centre(f64::from(k) / 20_000.0)).collect();
    for k in 0..40 {
        let xi = f64::from(k) / 40.0;
        let p = draft.centre(xi) + Complex::new(1e-4, -2e-4);
        let nearest = samples.iter().map(|s| (*s - p).norm()).fold(f64::MAX, f64::min);
        let foot = draft.distance(p, (xi + 0.002).min(1.0));
        // Half the spacing of the samples, some 2 um here, is by how much a sample may miss the foot sideways.
        assert!(foot <= nearest + 1e-12 && nearest < foot.hypot(3e-3), "{xi}: {foot} {nearest}");
    }
}

/// The published contour in mm with ramps at its corners, or why not.
fn published_contour(factor: f64) -> Option<Vec<Draft>> {
    const INCH: f64 = 25.4;
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/farouki2018-contour.json");
    let text = match std::fs::read_to_string(file) {
        Ok(text) => text,
        Err(error) => {
            println!("SKIPPED: {file}: {error}");
            return None;
        }
    };
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let complex = |value: &serde_json::Value| Complex::new(value[0].as_f64().unwrap(), value[1].as_f64().unwrap());
    let segments: Vec<Segment<f64>> = json["segments"]
        .as_array()
        .unwrap()
        .iter()
        .map(|segment| {
            let w = ["w0", "w1", "w2"].map(|name| complex(&segment[name]) * INCH.sqrt());
            Segment::Ph(PhQuintic { start: complex(&segment["p0"]) * INCH, w })
        })
        .collect();
    let pieces = json["pieces"].as_array().unwrap().iter().map(|piece| {
        let ramp = |name: &str| piece[name].as_bool().unwrap().then_some(Ramp { length: 0.25, factor });
        Draft {
            segment: segments[piece["seg"].as_u64().unwrap() as usize],
            interval: [piece["xi0"].as_f64().unwrap(), piece["xi1"].as_f64().unwrap()],
            offset: json["offset_d"].as_f64().unwrap() * INCH,
            feed: 200.0 * INCH / 60.0,
            start: ramp("mod0"),
            end: ramp("mod1"),
            profile: None,
        }
    });
    Some(pieces.collect())
}

/// The twelve published runs at every order; and the first-order times against the exact integral of (21), Table 1's bar of 0.1 %.
#[test]
fn the_published_contour_in_both_scalars() {
    let mut all = Twins::default();
    let mut worst = 0.0_f64;
    for factor in [0.25, 0.5, 0.75, 1.0] {
        let Some(path) = published_contour(factor) else { return };
        for weight in [0.0, 0.5, 1.0] {
            for order in ORDERS {
                all = all.and(twins(&path, weight, order));
            }
            let exact: f64 = path.iter().map(|draft| draft.duration(weight)).sum();
            let time = run::<f32>(&path, weight, Order::First).unwrap().time;
            println!("w {weight}, f {factor}: {time:.4} s, exactly {exact:.4} s");
            worst = worst.max((time / exact - 1.0).abs());
        }
    }
    println!("times of order 1 within {:.4} % of the integral", worst * 100.0);
    assert!(worst < 1e-3);
    all.check("the published contour");
}

/// The times that an independent program found for this contour (`farouki2018-contour.md`), to the digits it gives: the oracle of
/// these tests integrates the same equation.
#[test]
fn the_oracle_agrees_with_an_independent_program() {
    let published = [[12.647, 10.227, 9.207, 8.615], [14.466, 11.519, 10.270, 9.544], [24.230, 18.259, 15.676, 14.175]];
    for (weight, row) in [0.0, 0.5, 1.0].into_iter().zip(published) {
        for (factor, expected) in [0.25, 0.5, 0.75, 1.0].into_iter().zip(row) {
            let Some(path) = published_contour(factor) else { return };
            let time: f64 = path.iter().map(|draft| draft.duration(weight)).sum();
            // Three printed decimals, and that program's first-order steps: up to a tick a piece.
            assert!((time - expected).abs() < 1.5e-3, "w {weight}, f {factor}: {time} instead of {expected}");
        }
    }
}

/// The kernel's own f64 curves agree with the oracle's quadrature of the same preimage, so that "exact path" means one thing.
#[test]
fn the_exact_path_is_the_segment() {
    for segment in curves(200.0).into_iter().chain([line(120.0, -160.0), arc(40.0, 10.0, -2.2)]) {
        let draft = Draft::whole(segment, 3.0, 1.0);
        for k in 0..=50 {
            let xi = f64::from(k) / 50.0;
            assert!((draft.centre(xi) - segment.offset_point(xi, 3.0)).norm() < 1e-12);
        }
    }
}
