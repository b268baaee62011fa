//! Programs with words that are changed, left out and put in at random: whatever a program says, its strokes, its job and its path are
//! finite, or are refused in one sentence. `fuzz/fuzz_targets/job.rs` tries the same with any bytes.

use std::time::{Duration, Instant};

use host_sim::compensation::Gouge;
use tests::program_strokes::{LINES, hold, tooling};
use tests::random::Random;

/// What is spoiled: arcs, helices and turns in all planes, every kind of spline, lines that are long, short and none, compensation, lengths
/// of tools, modes of the path, and what is done between motions.
const PROGRAMS: [&str; 7] = [
    "G21 G90 G17 G64 P0.02\nF600 S8000 M3\nG0 X0 Y0 Z5\nG1 Z-1\nX10 Y0\nX10 Y10\nG2 X20 Y10 I5 J0\nG3 X20 Y10 I-5 J0 P3\nG2 X25 Y15 R8\n\
     G3 X20 Y20 Z-3 I-5 J0 P2\nG4 P0.5\nG1 X0 Y0\nG0 Z5\nM2\n",
    "G21 G90 F300 G64\nG0 X0 Y0 Z0\nG5 X10 Y10 I3 J0 P0 Q-3\nG5 X20 Y0 P0 Q3\nG5.1 X30 Y0 I5 J5\nG5.2 X30 Y0 P1 L3\nX32 Y5 P2\nX38 Y5 P1\n\
     X40 Y0 P1\nX45 Y-2 P1\nG5.3\nG61\nG1 X50 Y1\nX50.1 Y1.05\nX50.2 Y1.15\nX50.25 Y1.3\nG61.1 X50.3 Y1.5\nG64 P.1 Q.1\nX60 Y2\nM2\n",
    "G21 G90 G17 F500\nT1 M6 G43.1 Z5\nG0 X-10 Y-10 Z5\nG41.1 D4\nG1 X0 Y0 Z0\nX30 Y0\nX30 Y20\nG3 X25 Y25 I-5 J0\nG1 X15 Y25\nX15 Y15\nX14 Y25\n\
     X0 Y25\nX0 Y0\nG40\nG0 X-10 Y-10\nG49\nG0 Z5\nM2\n",
    "G21 G90 F400\nT3 M6 G43 H1\nG42 D1\nG0 X0 Y0 Z0\nX3 Y3\nG40\nG0 X0 Y0\nG18 G2 X10 Z0 I5 K0\nG3 X0 Z0 I-5 K0 Y3\nG19 G2 Y10 Z0 J3.5 K0 P2\nG3 Y0 Z4 R9\n\
     G17 M8\nG1 X20 M9\nG93 G1 X10 Y5 F4\nG94 F200 X0\nM0\nG0 Z10\nM30\n",
    "G20 G91 F10\nG0 X.1 Y.1\nG1 X.01 Y.002\nX.01 Y.001\nX.01 Y0\nX.01 Y-.001\nX.01 Y-.002\nX.01 Y-.004 Z.001\nX.01 Y-.004\nX.01 Y.01\nX.00001\n\
     Y.00002\nX0\nG3 X.1 Y.1 I0 J.1\nX-.2 Y0 I-.1 J0\nM2\n",
    "G21 G90 F900\nG0 X0 Y0\nG42.1 D2\nG1 X5 Y5\nG5.2 X5 Y5 P1 L4\nX10 Y12 P1\nX18 Y12 P1\nX22 Y5 P1\nX28 Y5 P1\nG5.3\nG2 X36 Y5 I4 J0\n\
     G5 X46 Y5 I2 J4 P-2 Q4\nG61.1\nG4 P1\nM5\nG1 X60 Y5\nG40\nG1 X70\nM2\n",
    "G21 G90 F600\n#1=10 #<step>=[#1/4]\nG10 L2 P1 X1 Y2\nG54 G0 X#1\nG92 X0 Y0\nG1 X[#1*2] Y-#<step>\nG28.1\nG0 X0\nG28 Z0\nG53 G0 X3\n\
     G1 Y[SIN[30]*#1]\nG92.1 G55 X4\nM2\n",
];

/// Words to put in.
const WORDS: [&str; 52] = [
    "G0",
    "G1",
    "G2",
    "G3",
    "G4 P1",
    "G5",
    "G5.1",
    "G5.2 P1 L3",
    "G5.3",
    "G17",
    "G18",
    "G19",
    "G20",
    "G21",
    "G40",
    "G41 D1",
    "G42 D4",
    "G41.1 D3",
    "G42.1 D1e-3",
    "G41.1 D0.0001",
    "G43 H1",
    "G43 H5",
    "G43.1 Z3",
    "G49",
    "G61",
    "G61.1",
    "G64",
    "G64 P.5",
    "G64 P0",
    "G90",
    "G91",
    "G90.1",
    "G91.1",
    "G93",
    "G94",
    "X1",
    "Y2",
    "Z3",
    "I1",
    "J1",
    "K1",
    "R5",
    "R-5",
    "P1",
    "P7",
    "Q1",
    "L2",
    "F100",
    "T3 M6",
    "M3",
    "A5",
    "M2",
];

/// Numbers to put in the place of others.
const NUMBERS: [&str; 26] = [
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "3",
    "10",
    "0.5",
    "-7.25",
    "1000",
    "0.0000001",
    "-0.00001",
    "0.000000000000000000000000000001",
    "0.001",
    "0.0101",
    "1000000",
    "-99999999",
    "4294967296",
    "1000000000000",
    "100000000000000000000000000000000000000",
    "[1/3]",
    "[0-1/0.0000001]",
    "[10**150]",
    "[10**300]",
    "[10**-300]",
    "[2**0.5]",
];

/// What takes longer is shown to whoever looks.
const SLOW: Duration = Duration::from_secs(1);

/// Says what was spoiled where it fails.
struct Case<'a>(&'a str);

impl Drop for Case<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            println!("the program:\n{}", self.0);
        }
    }
}

fn number(random: &mut Random, old: &str) -> String {
    match random.whole(0, 5) {
        0 | 1 => random.pick(&NUMBERS).to_string(),
        2 => format!("{:.6}", random.sign() * random.scale(1e-6, 1e6)),
        3 => format!("{:.3}", random.within(-30.0, 30.0)),
        4 => format!("{}", random.whole(0, 12)),
        // All but the same.
        _ => old.parse::<f64>().map_or_else(|_| old.to_string(), |old| format!("{:.9}", old * random.nearly_one())),
    }
}

/// One of the programs with up to `most` changes.
fn spoiled(random: &mut Random, most: usize) -> String {
    let text = random.pick(&PROGRAMS);
    let mut lines: Vec<Vec<String>> = text.lines().map(|line| line.split(' ').map(str::to_string).collect()).collect();
    for _ in 0..random.whole(1, most) {
        let at = random.whole(0, lines.len() - 1);
        let word = random.whole(0, lines[at].len());
        match random.whole(0, 10) {
            0 => lines[at].insert(word, random.pick(&WORDS).to_string()),
            1 => lines.insert(at, vec![random.pick(&WORDS).to_string()]),
            2 if lines.len() > 1 => {
                lines.remove(at);
            }
            3 => {
                let line = random.pick(&(0..lines.len()).collect::<Vec<_>>());
                lines.swap(at, line);
            }
            4 => lines.insert(at, lines[at].clone()),
            5 if word < lines[at].len() => {
                lines[at].remove(word);
            }
            _ => {
                if let Some(word) = lines[at].get_mut(word) {
                    let (letter, old) = word.split_at(word.len().min(1));
                    *word = format!("{letter}{}", number(random, old));
                }
            }
        }
    }
    lines.iter().map(|words| words.join(" ") + "\n").collect()
}

/// How many of so many spoiled programs have a path.
fn try_out(seed: u64, count: usize) -> usize {
    let tools = [Gouge::Trim, Gouge::Refuse].map(tooling);
    let mut random = Random::new(seed);
    let mut paths = 0;
    for _ in 0..count {
        let program = spoiled(&mut random, 5);
        let lines = random.pick(&LINES);
        let tools = &tools[usize::from(random.chance(0.2))];
        let _case = Case(&program);
        let start = Instant::now();
        paths += usize::from(hold(program.as_bytes(), lines, tools).is_ok());
        if start.elapsed() > SLOW {
            println!("{:.1?} with {lines:?}:\n{program}", start.elapsed());
        }
    }
    paths
}

#[test]
fn programs_as_they_are_have_a_path() {
    let tooling = tooling(Gouge::Trim);
    let refused: Vec<String> = PROGRAMS
        .iter()
        .flat_map(|program| LINES.map(|lines| (program, lines)))
        .filter_map(|(program, lines)| {
            hold(program.as_bytes(), lines, &tooling).err().map(|e| format!("{lines:?}: {e}"))
        })
        .collect();
    assert!(refused.is_empty(), "{refused:#?}");
}

#[test]
fn spoiled_programs_are_finite_or_refused() {
    const COUNT: usize = 500;
    let paths = try_out(1, COUNT);
    // Some changes spoil nothing.
    assert!(paths > COUNT / 5, "{paths}");
}

/// The same for as many seeds as wanted: `SEEDS=1000..2000 cargo test --release --test job_mutations -- --ignored`.
#[test]
#[ignore = "by hand"]
fn many_spoiled_programs() {
    let seeds = std::env::var("SEEDS").unwrap_or_default();
    let bounds = seeds.split_once("..").and_then(|(from, to)| Some((from.parse().ok()?, to.parse().ok()?)));
    let (from, to): (u64, u64) = bounds.unwrap_or((2, 20));
    for seed in from..to {
        println!("{seed}: {} of 500 have a path", try_out(seed, 500));
    }
}
