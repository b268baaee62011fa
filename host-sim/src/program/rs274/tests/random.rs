//! Whatever is in a file, reading ends with a result, and an error names a place in it.

use proptest::prelude::*;

use crate::program::rs274::{Settings, read};

/// Blocks to be spoiled.
const BLOCKS: [&str; 14] = [
    "n10 g1 x1.5 y-2 z.3 f100",
    "g2 x1 y1 i0.5 j.5 p2",
    "g3 x2 r-1",
    "#1=[2**3 + sin[30]] #<a>=#1",
    "x#<a> y[#1/2] z-#1",
    "g5 i1 j1 p1 q1 x2 y2",
    "g5.2 x1 y1 p2 l4",
    "x3 y3 p1",
    "g5.3",
    "g10 l20 p2 x0 z1",
    "g41.1 d5 (left) g64 p.1 q.2",
    "g92 x0 a3\ng28 z0",
    "t1 m6 s1000 m3 m8 g43 h1",
    "%",
];

fn check(program: &[u8]) -> Result<(), TestCaseError> {
    let lines = program.split(|&byte| byte == b'\n').count();
    for block_delete in [false, true] {
        let settings = Settings { block_delete, ..Settings::default() };
        let mut finite = true;
        let result = read("random.ngc", program, &settings, &mut |item| {
            finite &= item.from.iter().all(|x| x.is_finite());
            Ok(())
        });
        prop_assert!(finite);
        if let Err(error) = result {
            let (line, column) = error.position.unwrap();
            prop_assert!(line >= 1 && line <= lines && column >= 1);
            // At the end of the file there is no block to show.
            let shown = error.to_string().lines().count();
            prop_assert!(shown == 3 || (shown == 1 && error.block.is_none()), "{}", error);
        }
    }
    Ok(())
}

proptest! {
    #[test]
    fn any_bytes(program in proptest::collection::vec(any::<u8>(), 0..300)) {
        check(&program)?;
    }

    #[test]
    fn any_words(program in "([ \nA-Za-z]?[-+.0-9\\[\\]#<>=*/()%;]{0,4}){0,60}") {
        check(program.as_bytes())?;
    }

    #[test]
    fn spoiled_blocks(
        blocks in proptest::collection::vec(0..BLOCKS.len(), 1..20),
        spoils in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..3), 0..4),
    ) {
        let mut program = format!("f100 g0 x1\n{}", blocks.iter().map(|&k| BLOCKS[k]).collect::<Vec<_>>().join("\n")).into_bytes();
        for (place, byte, kind) in spoils {
            let at = place.index(program.len());
            match kind {
                0 => program[at] = byte,
                1 => program.insert(at, byte),
                _ => { program.remove(at); }
            }
        }
        check(&program)?;
    }
}

/// A program that is right, without comments and names, in which blanks and capitals change nothing.
const RIGHT: &str = "n10g1x1.5y-2z.3f100\ng2i2j1p2f33.25\n#1=[2**3+sin[30]]\ng1y[#1/2mod3]z-#1\ng64p.1q.2s1000m3\n\
                     g91.1g17g3i1j0\ng5i1j1p1q1x2y2\ng20g92x0a3\nt1m6\n";

proptest! {
    /// The standard: blanks and tabs have no meaning anywhere, and letters are capitals or not.
    #[test]
    fn blanks_and_capitals_mean_nothing(changes in proptest::collection::vec((any::<prop::sample::Index>(), 0..3), 0..60)) {
        let items = |program: &str| {
            let (items, error) = super::all(program, &Settings::default());
            (items.into_iter().map(|item| (item.from, item.feed, item.got)).collect::<Vec<_>>(), error)
        };
        let mut program = RIGHT.to_string();
        for (place, kind) in changes {
            let at = place.index(program.len());
            match kind {
                0 => program.insert(at, ' '),
                1 => program.insert(at, '\t'),
                _ => program = program[..at].to_string() + &program[at..=at].to_uppercase() + &program[at + 1..],
            }
        }
        let right = items(RIGHT);
        prop_assert_eq!(&right.1, &None);
        prop_assert_eq!(items(&program), right, "{}", program);
    }
}

#[test]
fn depth_is_bounded() {
    for text in ["[", "#", "-[", "sin[", "#[", "1+[", "exists[#["] {
        check(format!("g0 x[{}", text.repeat(20_000)).as_bytes()).unwrap();
    }
}
