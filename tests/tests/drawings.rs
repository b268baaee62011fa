//! Drawings of others: chains, curves, lengths and ends as an independent count has them; and programs of others, written in
//! both languages and read back.
//!
//! They stand in the data folder beside the project, and these tests say so where that is missing.

use std::f64::consts::PI;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use host_sim::input::InputError;
use host_sim::program::drawing::{Seen, dxf, svg};
use host_sim::program::item::Nurbs;
use host_sim::program::write::{Dialect, Settings, Writer};
use host_sim::program::{Action, Feed, Item, Motion, rs274, sinumerik};
use tests::nurbs;

fn data(folder: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data").join(folder);
    if !path.exists() {
        println!("SKIPPED: the {folder} of the data folder are not here");
        return None;
    }
    Some(path)
}

/// Rapids, lines, arcs, Bézier curves and B-splines, how long they are, and where the rapids end; mm.
#[derive(Debug, Default)]
struct Count {
    counts: [usize; 5],
    lengths: [f64; 5],
    starts: Vec<[f64; 3]>,
    end: [f64; 3],
}

impl Count {
    fn add(&mut self, item: &Item<'_>) {
        let Action::Motion(motion) = item.action else { return };
        let Some(to) = motion.to() else { panic!("a motion without end: {item:?}") };
        let straight = (0..3).map(|k| (to[k] - item.from[k]).powi(2)).sum::<f64>().sqrt();
        let (kind, length) = match motion {
            Motion::Rapid { .. } => {
                self.starts.push(to);
                (0, straight)
            }
            Motion::Line { .. } => (1, straight),
            Motion::Arc(arc) => {
                (2, (item.from[0] - arc.centre[0]).hypot(item.from[1] - arc.centre[1]) * arc.sweep.abs())
            }
            Motion::Bezier { points } => {
                let points: Vec<_> = std::iter::once(item.from).chain(points.iter().copied()).collect();
                let knots = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
                (3, nurbs::length(&Nurbs { order: 4, points: &points, weights: &[1.0; 4], knots: &knots }))
            }
            Motion::Nurbs(curve) => (4, nurbs::length(&curve)),
        };
        self.counts[kind] += 1;
        self.lengths[kind] += length;
        self.end = to;
    }
}

fn counted(read: impl FnOnce(&mut Count) -> Result<Seen, InputError>) -> (Count, Seen) {
    let mut count = Count::default();
    let seen = read(&mut count).unwrap_or_else(|error| panic!("{error}"));
    println!("{:?} of {:.6?} mm, {seen:?}", count.counts, count.lengths);
    (count, seen)
}

fn close(found: &[f64], expected: &[f64], within: f64) {
    let same = found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= within);
    assert!(same, "{found:?} and {expected:?}");
}

/// The letters that potrace made of a picture, counted by a script in Python: regular expressions for words and numbers, lengths
/// of Bézier curves by 64, 128 and 256 chords, extrapolated twice. 300 pt are 300 units of the viewBox, ten of the group's.
#[test]
fn letters_of_an_svg() {
    let Some(folder) = data("drawings") else { return };
    let file = File::open(folder.join("cncjs_jsdc.svg")).unwrap();
    let (count, seen) = counted(|count| {
        svg::read("cncjs_jsdc.svg", file, &mut |item| {
            count.add(item);
            Ok(())
        })
    });
    assert_eq!((seen.chains, seen.warnings.len()), (5, 0));
    assert_eq!(count.counts, [5, 30, 0, 38, 0]);
    // `f32`, which the crate for SVG has, is 2e-5 px at 300 px; a length is off by some of that for each of its curves.
    close(&count.lengths[1..4], &[136.540_498_186, 0.0, 323.544_306_940], 3e-4);
    close(&count.starts[0][..2], &[38.452_777_778, 52.563_888_889], 3e-5);
    close(&count.starts[4][..2], &[64.664_166_667, 47.483_888_889], 3e-5);
}

/// Four lines and four quarters of circles in one closed chain, without a unit.
#[test]
fn border_of_a_dxf() {
    let Some(folder) = data("drawings") else { return };
    let file = BufReader::new(File::open(folder.join("camotics_border.dxf")).unwrap());
    let (count, seen) = counted(|count| {
        dxf::read("camotics_border.dxf", file, &dxf::Settings::default(), &mut |item| {
            count.add(item);
            Ok(())
        })
    });
    assert_eq!((seen.chains, seen.warnings.len()), (1, 0));
    assert_eq!(count.counts, [1, 4, 4, 0, 0]);
    close(&count.lengths, &[10.0, 398.0, 20.0 * PI, 0.0, 0.0], 1e-9);
    close(&count.end, &[10.0, 0.0, 0.0], 1e-9);
}

/// Three closed polylines and an ellipse, whose circumference is that of Gauss, by arithmetic and geometric means.
#[test]
fn shapes_of_a_dxf() {
    let Some(folder) = data("drawings") else { return };
    let file = BufReader::new(File::open(folder.join("pycam_simple-shapes.dxf")).unwrap());
    let (count, seen) = counted(|count| {
        dxf::read("pycam_simple-shapes.dxf", file, &dxf::Settings::default(), &mut |item| {
            count.add(item);
            Ok(())
        })
    });
    assert_eq!((seen.chains, seen.warnings.len()), (4, 0));
    assert_eq!(count.counts, [4, 11, 0, 0, 1]);
    close(&count.lengths[1..2], &[260.0 + 236.319_128_061_810_2 + 225.878_114_742_203], 1e-9);
    let long = 50_f64.hypot(30.0);
    close(&count.lengths[4..], &[circumference(long, long * 0.441_176_470_588_235_3)], 1e-6);
}

fn circumference(long: f64, short: f64) -> f64 {
    let (mut a, mut b, mut power) = (long, short, 0.5);
    let mut sum = power * (long * long - short * short);
    while a - b > 1e-9 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        power *= 2.0;
        sum += power * (a * a - b * b);
    }
    2.0 * PI * (long * long - sum) / (0.5 * (a + b))
}

/// The kind and the end of each motion.
fn ends(item: &Item<'_>) -> Option<(u8, [f64; 3])> {
    let Action::Motion(motion) = item.action else { return None };
    let kind = match motion {
        Motion::Rapid { .. } => 0,
        Motion::Line { .. } => 1,
        Motion::Arc(_) => 2,
        Motion::Bezier { .. } | Motion::Nurbs(_) => 3,
    };
    Some((kind, motion.to()?))
}

/// Every program, written in both languages, has the motions that it had. Those that change the length of the tool are written
/// up to there: the place of the tip changes then, and a writer has no word for that.
#[test]
fn programs_of_others_come_back() {
    let Some(folder) = data("gcode") else { return };
    let mut programs: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    programs.sort();
    programs
        .retain(|path| path.extension().is_some_and(|ending| matches!(ending.to_str(), Some("ngc" | "nc" | "gcode"))));
    assert!(programs.len() > 20);
    for path in programs {
        let name = path.file_name().unwrap().to_str().unwrap();
        for dialect in [Dialect::Rs274, Dialect::Sinumerik] {
            let mut writer = Writer::new(Vec::new(), dialect, Settings { numbers: Some(5) }).unwrap();
            let (mut wrote, mut longer) = (Vec::new(), false);
            let input = BufReader::new(File::open(&path).unwrap());
            let result = rs274::read(name, input, &rs274::Settings::default(), &mut |item| {
                longer |= matches!(item.action, Action::ToolLength(_));
                if let (Action::Motion(motion), false) = (item.action, longer) {
                    writer.motion(item.from, item.feed, &motion).map_err(|error| error.to_string())?;
                    if wrote.is_empty() && !matches!(motion, Motion::Rapid { .. }) {
                        // The way to its start is written too.
                        wrote.push((0, item.from));
                    }
                    wrote.extend(ends(item));
                }
                Ok(())
            });
            assert!(result.is_ok(), "{}", result.unwrap_err());
            let program = writer.finish().unwrap();
            let mut read = Vec::new();
            let mut sink = |item: &Item<'_>| {
                assert!(item.feed != Feed::Unset || ends(item).is_none_or(|(kind, _)| kind == 0));
                read.extend(ends(item));
                Ok(())
            };
            let result = match dialect {
                Dialect::Rs274 => rs274::read(name, &program[..], &rs274::Settings::default(), &mut sink),
                Dialect::Sinumerik => sinumerik::read(name, &program[..], &sinumerik::Settings::default(), &mut sink),
            };
            assert!(result.is_ok(), "{}", result.unwrap_err());
            println!("{name:36} {dialect:?}: {} motions, {} bytes", wrote.len(), program.len());
            assert_eq!(wrote.len(), read.len(), "{name} {dialect:?}");
            for ((kind, to), (other, end)) in wrote.iter().zip(&read) {
                assert_eq!(kind, other, "{name} {dialect:?}");
                close(to, end, 1e-9);
            }
        }
    }
}
