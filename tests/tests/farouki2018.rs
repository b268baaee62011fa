//! The twelve published runs (Farouki & Srinathu 2018, section 5) against the published tables, and against an independent
//! program that ran the same reconstructed contour and fitted drive (its figures are those of `docs/farouki2018.md`).

#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use host_sim::reproduce::farouki2018::{Reproduction, Table, reproduce};

type Cells = [[f64; 4]; 3];

/// Table 1 by the independent program, first order at 1024 Hz, in s.
const TIMES: Cells =
    [[12.647, 10.227, 9.207, 8.615], [14.466, 11.519, 10.270, 9.544], [24.230, 18.259, 15.676, 14.175]];
/// Table 3, commanded, by the independent program, in in/min.
const COMMANDED: Cells = [[744.0, 987.0, 1282.0, 1600.0], [472.0, 557.0, 722.0, 900.0], [200.0; 4]];
/// Table 2 by the independent program, in in.
const ERRORS: Cells =
    [[0.0020, 0.0047, 0.0267, 0.1272], [0.0016, 0.0034, 0.0072, 0.0159], [0.0012, 0.0024, 0.0036, 0.0066]];
/// Table 4 by the independent program, in in/s^2.
const ACCELERATIONS: Cells =
    [[299.0, 617.0, 775.0, 1204.0], [242.0, 490.0, 707.0, 782.0], [193.0, 391.0, 589.0, 724.0]];

fn result() -> Reproduction {
    reproduce(|| ()).unwrap()
}

fn assert_within(what: &str, cells: &Cells, expected: &Cells, relative: f64) {
    for (row, (cells, expected)) in cells.iter().zip(expected).enumerate() {
        for (column, (cell, expected)) in cells.iter().zip(expected).enumerate() {
            let off = cell / expected - 1.0;
            assert!(off.abs() <= relative, "{what}, row {row}, column {column}: {cell} beside {expected}, {off:+.4}");
        }
    }
}

fn table(result: &Reproduction, number: usize) -> &Table {
    &result.tables[number - 1]
}

/// The bars of the project's first issue: 0.25 % of the published times, 0.1 % of the exact integral of (21), which quadrature
/// gives without the kernel; and the independent program's times to the digits it gave.
#[test]
fn table_1_traversal_times() {
    let result = result();
    let table = table(&result, 1);
    assert_within("published", &table.measured, &table.published, 0.0025);
    let (_, exact) = table.beside.unwrap();
    assert_within("exact integral", &table.measured, &exact, 0.001);
    assert_within("independent program", &table.measured, &TIMES, 0.0005 / 8.6);
}

#[test]
fn table_3_commanded_feeds() {
    let result = result();
    let (_, commanded) = table(&result, 3).beside.unwrap();
    // Half a per cent; the independent figures have three digits.
    assert_within("commanded feed", &commanded, &COMMANDED, 0.005);
}

/// With the fitted drive: within 10 % of the independent program, and so within 45 % of every published cell.
#[test]
fn tables_2_and_4_with_the_fitted_drive() {
    let result = result();
    for (number, expected) in [(2, &ERRORS), (4, &ACCELERATIONS)] {
        let table = table(&result, number);
        assert_within("independent program", &table.measured, expected, 0.10);
        assert_within("published", &table.measured, &table.published, 0.45);
    }
}

/// Every figure stands in the machine-readable rows, beside its published one.
#[test]
fn the_rows_hold_every_published_figure() {
    let result = result();
    assert_eq!(result.rows.len(), 48);
    for (row, (published, measured)) in result.rows.iter().zip(
        result.tables.iter().flat_map(|table| table.published.iter().flatten().zip(table.measured.iter().flatten())),
    ) {
        assert_eq!((row.published, row.measured), (*published, *measured), "{}", row.name);
    }
}

/// The f32 tick never leaves the exact path: without a plant, the contour error is the setpoint's own.
#[test]
fn the_tick_stays_on_the_exact_path() {
    use host_sim::job::{FeedOverride, Job, Reduction, Units};
    use host_sim::path::Path;
    use host_sim::plant::Measured;
    use host_sim::reproduce::farouki2018::{CONTOUR, REDUCTIONS, WEIGHTS};
    use host_sim::simulate::simulate;
    use shared::piece::Order;

    for weight in WEIGHTS {
        for reduction in REDUCTIONS {
            for order in [Order::First, Order::Second, Order::Third, Order::Exact] {
                let by = FeedOverride {
                    weight: Some(weight),
                    reduction: Some(Reduction::Fixed(reduction)),
                    ..FeedOverride::default()
                };
                let job = Job::from_toml("farouki2018.toml", CONTOUR).unwrap().with_feed(by).unwrap();
                let path = Path::new(&job, order).unwrap();
                let mut last = None;
                let outcome =
                    simulate(&path, Units::Mm, 0, Measured::ideal, |sample| last = Some(sample.commanded)).unwrap();
                // 0.1 um.
                assert!(outcome.max_contour_error < 1e-4, "w {weight}, f {reduction}: {}", outcome.max_contour_error);
                assert_eq!(last, Some(path.end()));
            }
        }
    }
}
