//! Bad programs, and the very sentences about them.

use super::all;
use crate::program::rs274::{Settings, read};

#[test]
fn each_fault_has_its_place_and_its_sentence() {
    let mut report = String::new();
    for &(program, expected) in TABLE {
        let (_, error) = all(program, &Settings::default());
        let said = error.unwrap_or_else(|| "no error".to_string());
        let first = said.lines().next().unwrap_or_default().trim_start_matches("part.ngc:");
        if first != expected {
            report += &format!("    ({program:?}, {first:?}),\n");
        }
    }
    assert!(report.is_empty(), "\n{report}");
}

#[test]
fn the_block_is_shown() {
    let (items, error) = all("g0 x1\n  g1\tx2 ; größer\nm2", &Settings::default());
    assert_eq!(items.len(), 1);
    assert_eq!(
        error.as_deref(),
        Some("part.ngc:2:3: G1 has no feed yet; put an F word before it\n    g1 x2 ; größer\n    ^")
    );
}

#[test]
fn a_sink_can_refuse() {
    let error = read("part.ngc", &b"g0 x1\n g0 x2"[..], &Settings::default(), &mut |item| {
        if item.line == 2 { Err("outside of the machine".to_string()) } else { Ok(()) }
    });
    assert_eq!(error.unwrap_err().to_string(), "part.ngc:2:2: outside of the machine\n    g0 x2\n    ^");
}

const TABLE: &[(&str, &str)] = &[
    ("g0 x", "1:4: X has no number behind it"),
    ("g0 x1 x2", "1:7: a second X word; a block may have one"),
    ("g0 ?", "1:4: `?` begins no word; a word is a letter and a number"),
    ("g0 \u{1}", "1:4: the byte 1 begins no word; a word is a letter and a number"),
    ("g0 x1 (open", "1:7: this comment does not end; put `)` behind it"),
    ("g0 (a (b))", "1:7: a comment in a comment; end the first one with `)`, or use other brackets"),
    ("g0 x1 / y2", "1:7: `/` marks a block that may be left out, and stands at its beginning"),
    ("g0 n5", "1:4: N is a line's whole number, and stands once at the beginning of a block"),
    ("n1.5 g0", "1:1: N is a line's whole number, and stands once at the beginning of a block"),
    ("g0 g1 x1", "1:4: G1 beside G0: of one modal group, a block may have one code"),
    ("g20 g21", "1:5: G21 beside G20: of one modal group, a block may have one code"),
    ("g17 g18", "1:5: G18 beside G17: of one modal group, a block may have one code"),
    ("m3 m4", "1:4: M4 beside M3: of one modal group, a block may have one code"),
    ("m2 m30", "1:4: M30 beside M2: of one modal group, a block may have one code"),
    ("g81 x1 z-1 r1", "1:1: G81 is not supported: it belongs to canned cycles; write the moves of the cycle instead"),
    ("g38.2 z-1", "1:1: G38.2 is not supported: it probes"),
    ("g95", "1:1: G95 is not supported: it gives feeds per turn; use G94 or G93"),
    ("g123", "1:1: G123 is not supported: no such code is known here"),
    ("g1.05 x1", "1:1: G1.05 is not supported: no such code is known here"),
    ("g-1", "1:1: G-1 is not supported: no such code is known here"),
    ("m62 p1", "1:1: M62 is not supported: it switches inputs and outputs, which a path does not have"),
    ("m100", "1:1: M100 is not supported: it runs a program of the machine's own"),
    ("o100 sub", "1:1: O words (subprograms, loops, conditions) are not supported; write their blocks out"),
    ("O<hole> call", "1:1: O words (subprograms, loops, conditions) are not supported; write their blocks out"),
    ("n5 o1 if [1]", "1:4: O words (subprograms, loops, conditions) are not supported; write their blocks out"),
    ("g0 x1e3", "1:6: nothing in this block uses E"),
    ("g0 x99999999999", "1:5: this number is too large for any machine"),
    ("g0 x[1+]", "1:8: no value; a number, `#` with a parameter, `[` or a function would do"),
    ("g0 x[1+2", "1:5: this bracket has no other half"),
    ("g0 x[1 2 3 $]", "1:12: no operator; + - * / ** MOD, AND OR XOR, EQ NE GT GE LT LE or `]` would do"),
    ("g0 x[1]]", "1:8: `]` begins no word; a word is a letter and a number"),
    ("g0 xfoo[1]", "1:5: no such function; there are ABS ACOS ASIN ATAN COS EXISTS EXP FIX FUP LN ROUND SIN SQRT TAN"),
    ("g0 x[atan[1]]", "1:13: ATAN takes two values, as in ATAN[1]/[2]"),
    ("g0 x[1/0]", "1:7: a division by zero"),
    ("g0 x[1 mod 0]", "1:7: a division by zero"),
    ("g0 xsqrt[-1]", "1:5: this has no value for -1"),
    ("g0 x[ln[0]]", "1:6: this has no value for 0"),
    ("g0 x[asin[2]]", "1:6: this has no value for 2"),
    ("g0 x[[0-1]**0.5]", "1:11: this has no value for -1"),
    ("g0 x[10**400]", "1:8: the result is no finite number"),
    ("g0 x#0", "1:5: there is no parameter 0; they are numbered 1 to 5602"),
    ("g0 x#5603", "1:5: there is no parameter 5603; they are numbered 1 to 5602"),
    ("g0 x#<gone>", "1:5: this parameter has no value yet; set it first"),
    ("#<open=3", "1:1: this bracket has no other half"),
    ("#5420=1", "1:1: the machine itself keeps this parameter; G10, G92, G28.1 and G30.1 change it"),
    ("#<_x>=1", "1:1: the machine itself keeps this parameter; G10, G92, G28.1 and G30.1 change it"),
    ("#1 g0", "1:4: a parameter at this place is set, and needs `=` and a value"),
    ("x1", "1:1: X without a motion that is in force; put G0 or G1 before it"),
    ("g0 x1\ng80\nx2", "3:1: X without a motion that is in force; put G0 or G1 before it"),
    ("g80 x1", "1:5: nothing in this block uses X"),
    ("g0 g92 x1", "1:1: G92 and G0 would both use X; give each its block"),
    ("g28 g0 x1", "1:5: G28 and G0 would both use X; give each its block"),
    ("g4 p1 g64 p1", "1:11: a second P word; a block may have one"),
    ("g92", "1:1: G92 needs an axis"),
    ("g0 x1 i1", "1:7: nothing in this block uses I"),
    ("g0 x1 d1", "1:7: nothing in this block uses D"),
    ("h1", "1:1: nothing in this block uses H"),
    ("g1 x1", "1:1: G1 has no feed yet; put an F word before it"),
    ("g1 x1 f0", "1:1: G1 has no feed yet; put an F word before it"),
    ("f-1", "1:1: F must not be negative"),
    ("s-1", "1:1: S must not be negative"),
    ("t1.5", "1:1: T must be a whole number from 0 to 99999"),
    ("g96", "1:1: G96 needs the speed of the cut (S)"),
    ("g93 g1 x1", "1:5: G1 needs a positive F of its own while feeds are inverse times (G93)"),
    ("f1 g2 x1 y1", "1:4: G2 needs its centre (I, J, K) or its radius (R)"),
    ("f1 g2 x1 y1 r1 i1", "1:4: G2 has both a centre and a radius; leave one out"),
    ("f1 g2 x1 k1", "1:10: K is no word of a centre in the XY plane (G17)"),
    ("f1 g18 g2 x1 j1", "1:14: J is no word of a centre in the XZ plane (G18)"),
    ("f1 g90.1 g2 x1 i1", "1:10: an absolute centre (G90.1) needs J too"),
    ("f1 g2 x3 i1", "1:4: the start is 1 from the centre and the end 2; both are on one circle"),
    ("f1 g20 g2 x3 i1", "1:8: the start is 1 from the centre and the end 2; both are on one circle"),
    ("f1 g2 x3 i0 j0", "1:4: the centre is where the arc starts or ends; there is no circle"),
    ("f1 g2 x10 r1", "1:4: a radius of 1 cannot span the distance; 5 or more would do"),
    ("f1 g2 r1", "1:4: an arc by radius needs another end; give a full circle by its centre"),
    ("f1 g2 x0 r1", "1:4: an arc by radius needs another end; give a full circle by its centre"),
    ("f1 g2 x2 i1 p0", "1:13: P must be a whole number from 1 to 1000"),
    ("f1 g53 g2 x2 i1", "1:8: G53 goes with G0 or G1 only"),
    ("g91 g53 g0 x2", "1:9: G53 needs absolute distances (G90)"),
    ("f1 g5.2 x1 y1\n  m3", "2:3: between G5.2 and G5.3 stand control points alone; put G5.3 before this"),
    ("g0 g53", "no error"),
    ("g53", "1:1: G53 goes with G0 or G1 only"),
    ("g53 x1", "1:5: X without a motion that is in force; put G0 or G1 before it"),
    ("g4", "1:1: G4 needs its seconds (P)"),
    ("g4 p-1", "1:4: P must not be negative"),
    ("g10 l1 p1 z1", "1:1: of G10, L2 and L20 are supported"),
    ("g10 l2 x1", "1:1: G10 needs the number of a coordinate system (P)"),
    ("g10 l2 p10 x1", "1:8: P must be a whole number from 0 to 9"),
    ("g10 l2 p1 r45", "1:11: coordinate systems that are turned (G10 L2 R) are not supported"),
    ("g41 d1\ng42 d1", "2:1: G42 while cutter compensation is on; put G40 before it"),
    ("g41 d1\ng18", "2:1: G18 while cutter compensation is on; put G40 before it"),
    ("g41 d1\ng20", "2:1: G20 while cutter compensation is on; put G40 before it"),
    ("g41 d1\ng55", "2:1: G55 while cutter compensation is on; put G40 before it"),
    ("g19 g41 d1", "1:5: cutter compensation needs the XY plane (G17) or the XZ plane (G18)"),
    ("g41 d1.5", "1:5: D must be a whole number from 0 to 99999"),
    ("g41.1", "1:1: G41.1 needs the diameter of the tool (D)"),
    ("f1 g5 x1 y1 p1 q1", "1:4: the first G5 of a chain needs I and J"),
    ("f1 g5 x1 y1 i1 p1 q1", "1:13: G5 needs both I and J, or neither"),
    ("f1 g5 x1 y1 i1 j1 p1", "1:19: G5 needs both P and Q"),
    ("f1 g5 x1 y1 i1 j1", "1:4: G5 needs both P and Q"),
    ("f1 g5 x1 z1 i1 j1 p1 q1", "1:10: nothing in this block uses Z"),
    ("f1 g18 g5.1 x1 i1 j1", "1:8: G5.1 needs the XY plane (G17)"),
    ("f1 g5.1 x1 y1", "1:4: G5.1 needs both I and J"),
    ("g5.2 x1 y1", "1:1: G5.2 has no feed yet; put an F word before it"),
    ("f1 g5.2 x1 y1\ng0 x1", "2:1: between G5.2 and G5.3 stand control points alone; put G5.3 before this"),
    ("f1 g5.2 x1 y1\nm3", "2:1: between G5.2 and G5.3 stand control points alone; put G5.3 before this"),
    ("f1 g5.2 x1 y1\nf2", "2:1: between G5.2 and G5.3 stand control points alone; put G5.3 before this"),
    ("f1 g5.2 x1", "1:4: a control point needs both X and Y"),
    ("f1 g5.2 x1 y1 p0", "1:15: P must be positive"),
    ("f1 g5.2 x1 y1 l2", "1:15: L must be a whole number from 3 to 16"),
    ("f1 g91 g5.2 x1 y1", "1:8: control points need absolute distances (G90)"),
    ("f1 g5.2 x1 y1\ng5.3", "2:1: 2 control points, the start among them, make no curve of order 3"),
    ("f1 g5.2 x1 y1", "1:1: the program ends within a curve; put G5.3 behind its control points"),
    ("g5.3", "1:1: G5.3 ends what G5.2 begins, and nothing has begun"),
    ("g43.1 a1", "1:7: nothing in this block uses A"),
    ("g0 x1 m2.5", "1:7: M2.5 is not supported: no such code is known here"),
];
