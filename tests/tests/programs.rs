//! Programs of others, read whole: moves, arcs, curves, lengths and the end as an independent count has them.
//!
//! They stand in the data folder beside the project, and this test says so where that is missing.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use host_sim::program::rs274::{Settings, read};
use host_sim::program::{Action, Item, Motion};
use tests::canonical::Canonical;
use tests::nurbs;

/// The counts are whole; lengths and ends were written with six decimals.
const CLOSE: f64 = 1e-6;

/// What a program comes to: rapids, lines, arcs, B-splines, and where it ends; mm.
#[derive(Debug, Default, PartialEq)]
struct Count {
    counts: [usize; 4],
    lengths: [f64; 4],
    end: [f64; 3],
    finished: bool,
}

impl Count {
    fn add(&mut self, item: &Item<'_>) {
        let Action::Motion(motion) = item.action else {
            self.finished |= item.action == Action::End;
            return;
        };
        let Some(to) = motion.to() else { panic!("a motion without end: {item:?}") };
        let straight = (0..3).map(|k| (to[k] - item.from[k]).powi(2)).sum::<f64>().sqrt();
        let (kind, length) = match motion {
            Motion::Rapid { .. } => (0, straight),
            Motion::Line { .. } => (1, straight),
            Motion::Arc(arc) => {
                let [first, second, across] = arc.plane.axes();
                // The ends of a program's arcs are rounded: their mean distance from the centre is the radius.
                let radii = [item.from, to].map(|p| (p[first] - arc.centre[0]).hypot(p[second] - arc.centre[1]));
                (2, (0.5 * (radii[0] + radii[1]) * arc.sweep).hypot(to[across] - item.from[across]))
            }
            Motion::Nurbs(curve) => (3, nurbs::length(&curve)),
            Motion::Bezier { .. } => panic!("none of these programs has G5 or G5.1"),
        };
        self.counts[kind] += 1;
        self.lengths[kind] += length;
        self.end = to;
    }
}

struct Row {
    file: &'static str,
    counts: [usize; 4],
    lengths: [f64; 4],
    end: [f64; 3],
}

/// Counted by a script of 110 lines in Python, written from the manuals beside this reader and not from it: comments and
/// blanks are cut out by regular expressions, words found by another one, and what is left over stops the script. It keeps
/// coordinates as the program counts them, so G92 changes a number and no frame. Arcs are complex numbers: the angle by
/// centre is the phase of (end - centre)/(start - centre), the angle by radius 2 asin(chord/2R). B-splines are sums of basis
/// functions by the recursion of Cox and de Boor; their length is that of 200, 400 and 800 chords in each span,
/// extrapolated twice. The file `lcnc_comp-g1.ngc`, which its list says has O words, has none.
const ROWS: &[Row] = &[
    Row {
        file: "bcnc_sample.gcode",
        counts: [4, 394, 0, 0],
        lengths: [10.979_055, 154.495_518, 0.0, 0.0],
        end: [0.0, 0.0, 2.0],
    },
    Row {
        file: "camotics_bear.nc",
        counts: [7, 15_152, 0, 0],
        lengths: [170.944_054, 14_805.654_557, 0.0, 0.0],
        end: [0.0, 0.0, 20.0],
    },
    Row {
        file: "camotics_cds.gcode",
        counts: [3, 487, 0, 0],
        lengths: [37.493_801, 2_144.360_398, 0.0, 0.0],
        end: [-26.5875, 0.0, 3.0],
    },
    Row {
        file: "camotics_flower_mold.nc",
        counts: [7, 16_553, 0, 0],
        lengths: [90.964_347, 24_458.124_571, 0.0, 0.0],
        end: [0.0, 0.0, 5.08],
    },
    Row {
        file: "cncjs_circle-inch.gcode",
        counts: [4, 2, 4, 0],
        lengths: [36.119_189, 5.08, 79.796_453, 0.0],
        end: [0.0, 0.0, 6.35],
    },
    Row {
        file: "cncjs_helical-thread-milling.gcode",
        counts: [0, 2, 10, 0],
        lengths: [0.0, 19.052_438, 46.129_372, 0.0],
        end: [0.619_76, 2.473_96, -12.047_22],
    },
    Row {
        file: "cncjs_jsdc.gcode",
        counts: [1, 2381, 0, 0],
        lengths: [47.352_535, 661.800_463, 0.0, 0.0],
        end: [0.0, 0.0, 1.0],
    },
    Row {
        file: "lcnc_Curva_Delfino_1_1_G5.ngc",
        counts: [39, 2, 0, 1],
        lengths: [499.566_72, 4.0, 0.0, 207.966_159],
        end: [60.851, 97.918, 50.0],
    },
    Row {
        file: "lcnc_butterfly-xy.ngc",
        counts: [16, 5, 0, 6],
        lengths: [146.395_754, 5.0, 0.0, 331.589_054],
        end: [0.0, 0.0, 10.0],
    },
    Row {
        file: "lcnc_circle_small_segments_ncd.ngc",
        counts: [1, 10_000, 0, 0],
        lengths: [0.0, 185.294_416, 0.0, 0.0],
        end: [-0.015_24, 25.4, 0.0],
    },
    Row {
        file: "lcnc_comp-g1.ngc",
        counts: [4, 10, 6, 0],
        lengths: [194.744_444, 868.747_139, 192.282_763, 0.0],
        end: [76.2, 88.9, 0.0],
    },
    Row {
        file: "lcnc_comp.ngc",
        counts: [7, 24, 12, 0],
        lengths: [322.264_289, 271.705_229, 119.694_68, 0.0],
        end: [5.08, 0.0, -5.08],
    },
    Row {
        file: "lcnc_machinekit_412.ngc",
        counts: [3, 8, 0, 0],
        lengths: [1.476_842, 57.342_656, 0.0, 0.0],
        end: [-44.806, 15.438, 6.5],
    },
    Row {
        file: "lcnc_mill-line-arc-entry.ngc",
        counts: [2, 8, 10, 0],
        lengths: [186.311_222, 660.4, 398.982_267, 0.0],
        end: [50.8, 76.2, 0.0],
    },
    Row {
        file: "lcnc_random_lines_0.001in.ngc",
        counts: [1, 4001, 0, 0],
        lengths: [0.1, 4.087_035, 0.0, 0.0],
        end: [0.316_023, -0.076_252, 0.316_086],
    },
    Row {
        file: "lcnc_short_segments_0.001.ngc",
        counts: [1, 3001, 0, 0],
        lengths: [0.0, 76.2, 0.0, 0.0],
        end: [25.4, 25.4, 25.4],
    },
    Row {
        file: "lcnc_tangent_helix.ngc",
        counts: [2, 2, 1, 0],
        lengths: [6.805_909, 51.696_015, 165.222_735, 0.0],
        end: [25.4, 25.4, 42.762_79],
    },
    Row {
        file: "lcnc_tort.ngc",
        counts: [74, 56, 138, 0],
        lengths: [681.782_185, 283.266_261, 2_962.348_123, 0.0],
        end: [0.0, 0.0, 20.0],
    },
    Row {
        file: "tinyg_braid_600mm.gcode",
        counts: [14, 2498, 0, 0],
        lengths: [227.035_392, 1_100.098_368, 0.0, 0.0],
        end: [-0.327, 33.521, 21.0],
    },
    Row {
        file: "ugs_arc_rword_test.gcode",
        counts: [4, 28, 168, 0],
        lengths: [60.338_083, 1197.6735, 1_034.428_926, 0.0],
        end: [0.0, 0.0, 6.35],
    },
    Row {
        file: "ugs_g17-g18-g19.gcode",
        counts: [3, 0, 6, 0],
        lengths: [91.981_537, 0.0, 718.168_081, 0.0],
        end: [0.0, -38.1, 0.0],
    },
    Row {
        file: "ugs_no_spaces.gcode",
        counts: [100, 102, 0, 0],
        lengths: [391.670_021, 796.925, 0.0, 0.0],
        end: [152.4, 0.0, 3.175],
    },
];

#[test]
fn programs_of_others_are_read_whole() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/gcode");
    if !folder.exists() {
        println!("SKIPPED: the programs of the data folder are not here");
        return;
    }
    for row in ROWS {
        let input = BufReader::new(File::open(folder.join(row.file)).unwrap());
        let mut count = Count::default();
        let lines = read(row.file, input, &Settings::default(), &mut |item| {
            count.add(item);
            Ok(())
        });
        let lines = lines.unwrap_or_else(|error| panic!("{error}"));
        println!("{:36} {lines:6} lines: {:?} of {:.3?} mm", row.file, count.counts, count.lengths);
        assert_eq!(count.counts, row.counts, "{}", row.file);
        assert!(count.finished, "{}", row.file);
        let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= CLOSE * a.abs().max(1.0));
        assert!(same(&count.lengths, &row.lengths), "{}: {:?} and {:?}", row.file, count.lengths, row.lengths);
        assert!(same(&count.end, &row.end), "{}: {:?} and {:?}", row.file, count.end, row.end);
    }
}

/// LinuxCNC's own reading of a program, up to where it compensates for the tool, which is done elsewhere here. It prints
/// inches with four decimals.
#[test]
fn motions_are_those_that_linuxcnc_prints() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/gcode");
    let Ok(expected) = std::fs::read_to_string(folder.join("lcnc_mill-line-arc-entry.expected")) else {
        println!("SKIPPED: the programs of the data folder are not here");
        return;
    };
    let four = |mm: f64| (mm / 25.4 * 1e4).round() / 1e4 + 0.0;
    let (mut motions, mut compensated) = (Vec::new(), false);
    let input = BufReader::new(File::open(folder.join("lcnc_mill-line-arc-entry.ngc")).unwrap());
    let read = read("mill-line-arc-entry", input, &Settings::default(), &mut |item| {
        compensated |= matches!(item.action, Action::Compensation(_));
        if let (Action::Motion(motion), false) = (item.action, compensated) {
            let arc = if let Motion::Arc(arc) = motion { Some((arc.centre.map(four), arc.sweep > 0.0)) } else { None };
            motions.push(Canonical { to: motion.to().unwrap().map(four), arc });
        }
        Ok(())
    });
    assert!(read.is_ok() && motions.len() == 11, "{motions:?}");
    let expected: Vec<Canonical> = expected.lines().filter_map(Canonical::read).take(motions.len()).collect();
    assert_eq!(motions, expected);
}

/// A program that is made while it is read.
struct Endless {
    lines: usize,
    left: usize,
    rest: Vec<u8>,
}

impl Read for Endless {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if self.rest.is_empty() && self.left > 0 {
            self.left -= 1;
            let k = (self.lines - self.left) % 1000;
            self.rest = format!("N{k} G1 X{k}.125 Y-{k}.25 Z{k}.5 (a part)\n").into_bytes();
        }
        let count = self.rest.len().min(buffer.len());
        buffer[..count].copy_from_slice(&self.rest[..count]);
        self.rest.drain(..count);
        Ok(count)
    }
}

/// The most memory that this process has had, in kB; none where the system does not say.
fn peak() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().trim_end_matches("kB").trim().parse().ok()
}

/// A hundred megabytes leave no more behind than allocators and the other test do: a few megabytes.
#[test]
fn memory_is_flat() {
    let lines = 2_700_000;
    let Some(before) = peak() else {
        println!("SKIPPED: this system does not say how much memory a process has had");
        return;
    };
    let input = BufReader::new(Endless { lines, left: lines, rest: b"F100\n".to_vec() });
    let mut count = Count::default();
    let read = read("endless.ngc", input, &Settings::default(), &mut |item| {
        count.add(item);
        Ok(())
    });
    assert_eq!((read, count.counts[1]), (Ok(lines + 1), lines));
    let grown = peak().unwrap() - before;
    println!("{grown} kB more after {lines} lines");
    assert!(grown < 8192, "{grown} kB");
}
