//! The published contour trimmed here, against the trimmed pieces that come with it.
#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use host_sim::contour::{Along, Contour};
use host_sim::job::Job;
use host_sim::offset::trim;
use host_sim::reproduce::farouki2018::CONTOUR;
use shared::complex::Complex;
use shared::curve::{PhQuintic, Segment};

const INCH: f64 = 25.4;

/// A piece as the data have it: segment, interval, corners.
type Given = (usize, [f64; 2], [bool; 2]);

/// The bar of the project: 1e-9 in every parameter, and no piece more or less, in the same order around the loop.
fn assert_pieces(contour: &Contour, distance: f64, given: &[Given]) {
    let offset = trim(contour, distance).unwrap();
    let [ring] = &offset.loops[..] else { panic!("{} loops", offset.loops.len()) };
    assert!(ring.closed && ring.area > 0.0);
    assert_eq!(ring.pieces.len(), given.len());
    let mut worst = 0.0_f64;
    for (piece, (segment, [from, to], corners)) in ring.pieces.iter().zip(given) {
        let Along::Segment { segment: found, from: a, to: b } = piece.along else { panic!("{piece:?}") };
        assert_eq!(found, *segment);
        worst = worst.max((a - from).abs()).max((b - to).abs());
        assert!(worst < 1e-9, "{piece:?} instead of {from}..{to}");
        assert_eq!([piece.start_turn, piece.end_turn].map(|turn| turn.abs() > 1e-6), *corners, "{piece:?}");
    }
    println!("every parameter within {worst:.1e}");
}

#[test]
fn the_pieces_of_the_example() {
    let job = Job::from_toml("farouki2018.toml", CONTOUR).unwrap();
    let given: Vec<Given> = job
        .pieces
        .iter()
        .map(|piece| {
            let Along::Segment { segment, from, to } = piece.along else { panic!("{piece:?}") };
            (segment, [from, to], [piece.start.is_some(), piece.end.is_some()])
        })
        .collect();
    assert_pieces(&job.contour, INCH, &given);
}

/// The same contour as it was found, with all of its digits.
#[test]
fn the_pieces_of_the_data_file() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/farouki2018-contour.json");
    let text = match std::fs::read_to_string(file) {
        Ok(text) => text,
        Err(error) => {
            println!("SKIPPED: {file}: {error}");
            return;
        }
    };
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let complex = |value: &serde_json::Value| Complex::new(value[0].as_f64().unwrap(), value[1].as_f64().unwrap());
    let segment = |value: &serde_json::Value| {
        let w = ["w0", "w1", "w2"].map(|name| complex(&value[name]) * INCH.sqrt());
        Segment::Ph(PhQuintic { start: complex(&value["p0"]) * INCH, w })
    };
    let segments = json["segments"].as_array().unwrap().iter().map(segment).collect();
    let given: Vec<Given> = json["pieces"]
        .as_array()
        .unwrap()
        .iter()
        .map(|piece| {
            let interval = ["xi0", "xi1"].map(|name| piece[name].as_f64().unwrap());
            let corners = ["mod0", "mod1"].map(|name| piece[name].as_bool().unwrap());
            (piece["seg"].as_u64().unwrap() as usize, interval, corners)
        })
        .collect();
    assert_pieces(&Contour { segments, closed: true }, json["offset_d"].as_f64().unwrap() * INCH, &given);
}
