//! Numbers, parameters, expressions, and how words may be written.

use super::{all, ends};
use crate::program::rs274::Settings;

/// What `X` comes to with this text behind it, after these blocks.
fn value_after(blocks: &str, text: &str) -> f64 {
    let ends = ends(&format!("{blocks}\ng0 x{text}"));
    ends[ends.len() - 1][0]
}

fn value(text: &str) -> f64 {
    value_after("", text)
}

#[test]
fn expressions_follow_their_table_of_operators() {
    for (text, expected) in [
        ("1.5", 1.5),
        ("-1.5", -1.5),
        ("+.5", 0.5),
        ("[1+2*3]", 7.0),
        ("[[1+2]*3]", 9.0),
        ("[10-4-3]", 3.0),
        ("[2**3**2]", 64.0),
        ("[-2**2]", 4.0),
        ("[2 * 3 ** 2]", 18.0),
        ("[12/4/3]", 1.0),
        ("[7 MOD 3]", 1.0),
        ("[-7 mod 3]", 2.0),
        ("[1 LT 2]", 1.0),
        ("[1 gt 2]", 0.0),
        ("[1 + 1 EQ 2]", 1.0),
        ("[1 NE 1]", 0.0),
        ("[2 GE 2]", 1.0),
        ("[2 LE 1]", 0.0),
        ("[1 AND 0 OR 1]", 1.0),
        ("[1 XOR 1]", 0.0),
        ("-[1+2]", -3.0),
        ("sqrt[16]", 4.0),
        ("[abs[-3]]", 3.0),
        ("[sin[30]]", 0.5),
        ("[cos[60]]", 0.5),
        ("[tan[45]]", 1.0),
        ("[asin[1]]", 90.0),
        ("[acos[0]]", 90.0),
        ("[atan[1]/[1]]", 45.0),
        ("[atan[1]/[-1]]", 135.0),
        ("[fix[-2.8]]", -3.0),
        ("[fup[-2.8]]", -2.0),
        ("[round[2.5]]", 3.0),
        ("[exp[0]]", 1.0),
        ("[ln[exp[2]]]", 2.0),
        ("[exists[#<none>]]", 0.0),
    ] {
        // A few functions of degrees round in the last place.
        assert!((value(text) - expected).abs() < 1e-14 * expected.abs().max(1.0), "{text}: {}", value(text));
    }
}

#[test]
fn parameters_are_set_when_the_block_has_been_read() {
    assert_eq!(ends("#3 = 15 #4=[2*4]\ng0 x#3 y#4"), [[15.0, 8.0, 0.0]]);
    // The standard's own example: the old value is used, and the new one holds afterwards.
    assert_eq!(ends("#3=15\n#3=6 g0 x#3\nx#3"), [[15.0, 0.0, 0.0], [6.0, 0.0, 0.0]]);
    assert_eq!(value_after("#1=2 #2=7", "##1"), 7.0);
    assert_eq!(value_after("#[1+1]=7", "#2"), 7.0);
    assert_eq!(value_after("#2=7", "-#2"), -7.0);
    assert_eq!(value_after("#<Deep Hole>=7", "#<deephole>"), 7.0);
    assert_eq!(value_after("#<_all>=7", "[#<_all> + exists[#<_all>]]"), 8.0);
    assert_eq!(value("#30"), 0.0);
    // A code may be computed too.
    assert_eq!(ends("#1=0\ng#1 x1\ng[90+#1] x2"), [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
}

#[test]
fn the_machine_s_own_parameters_can_be_read() {
    assert_eq!(value_after("g20 g0 x3", "[#5420 * 2]"), 6.0 * 25.4);
    assert_eq!(value_after("g10 l2 p3 x4", "[#5261]"), 4.0);
    assert_eq!(value_after("g0 y8\ng92 y3", "[#5212]"), 5.0);
    assert_eq!(value_after("g56", "#5220"), 3.0);
    assert_eq!(value_after("t7 m6", "#5400"), 7.0);
    assert_eq!(value_after("g0 z2\ng91 g0", "[#<_z> + #<_incremental> + #<_line>]"), 6.0);
}

#[test]
fn words_are_written_as_in_the_wild() {
    let once = [[1.0, 2.0, 0.0]];
    for program in [
        "g0x1y2",
        "G0X1Y2",
        "G 0 X 1 Y 2",
        "\tG00\tX1.\tY2.0\r\n",
        "n10g0x1y2",
        "N0010 G0 X+1 Y2 (a comment) ; and another",
        "(before) g0 (within) x1 (again) y2",
        "x1 y2 g0",
        "g0 x1 y0 2",
        "%\ng0 x1 y2\n%\ng0 x9",
        "g0 x1 y2\nm2\nx9 what follows is not read",
        "g0 x1 y2\nm30\n%",
        "\u{feff}g0 x1 y2",
        "\n\n;\n(only comments)\n  \n/x\ng0 x1 y2\n/x9",
        "n5\ng0 x1 y2",
        "g0 x1 y2 ; größer",
    ] {
        assert_eq!(ends(program), once, "{program:?}");
    }
    let kept = Settings { block_delete: false, ..Settings::default() };
    assert_eq!(super::ends_with("g0 x1\n / x9", &kept), [[1.0, 0.0, 0.0], [9.0, 0.0, 0.0]]);
    // A column counts characters, and of a block that moves it is that of its code or of its first axis.
    let (items, _) = all("(größer) g0 x1\n  y2 x3", &Settings::default());
    assert_eq!([items[0].place, items[1].place], [(1, 10), (2, 3)]);
}
