//! Published tables with what came out here, cell by cell, as HTML.

use super::page::escape;
use super::series::number;
use crate::reproduce::farouki2018::{REDUCTIONS, Table, WEIGHTS};

/// How far a cell is from its published figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distance {
    /// Within 1 %.
    Equal,
    /// Within 10 %.
    Near,
    /// Within 25 %.
    Apart,
    /// Farther.
    Far,
}

impl Distance {
    /// Of a relative difference.
    pub fn of(relative: f64) -> Self {
        match relative.abs() {
            r if r <= 0.01 => Self::Equal,
            r if r <= 0.10 => Self::Near,
            r if r <= 0.25 => Self::Apart,
            _ => Self::Far,
        }
    }

    fn class(self) -> &'static str {
        match self {
            Self::Equal => "equal",
            Self::Near => "near",
            Self::Apart => "apart",
            Self::Far => "far",
        }
    }
}

/// What the marks mean.
pub const LEGEND: &str = "<p class=\"legend\">Difference: <span class=\"equal\">within 1&nbsp;%</span> \
    <span class=\"near\">within 10&nbsp;%</span> <span class=\"apart\">within 25&nbsp;%</span> \
    <span class=\"far\">farther</span></p>";

/// The cell of a table that is farthest from its published figure: relative difference, w, f.
pub fn worst(table: &Table) -> (f64, f64, f64) {
    let cells = table.measured.iter().flatten().zip(table.published.iter().flatten());
    let names = WEIGHTS.iter().flat_map(|w| REDUCTIONS.iter().map(move |f| (*w, *f)));
    cells
        .zip(names)
        .map(|((here, paper), (w, f))| (here / paper - 1.0, w, f))
        .fold((0.0, 0.0, 0.0), |worst, cell| if cell.0.abs() > worst.0.abs() { cell } else { worst })
}

/// The table with a group of rows for each weight.
pub fn html(table: &Table) -> String {
    let row = |name: &str, class: &str, cells: &[f64; 4], decimals: usize| {
        let cells: String = cells.iter().map(|cell| format!("<td>{}</td>", number(*cell, decimals))).collect();
        format!("<tr class=\"{class}\"><th scope=\"row\">{}</th>{cells}</tr>", escape(name))
    };
    let head: String = REDUCTIONS.iter().map(|f| format!("<th scope=\"col\">f = {f}</th>")).collect();
    let paper = published_decimals(table);
    let mut groups = String::new();
    for (number_of, weight) in WEIGHTS.iter().enumerate() {
        let (here, published) = (&table.measured[number_of], &table.published[number_of]);
        groups += &format!("<tbody><tr class=\"group\"><th scope=\"rowgroup\" colspan=\"5\">w = {weight}</th></tr>");
        groups += &row("here", "here", here, table.decimals);
        groups += &row("published", "published", published, paper);
        groups += "<tr class=\"difference\"><th scope=\"row\">difference</th>";
        for (here, published) in here.iter().zip(published) {
            let relative = here / published - 1.0;
            let class = Distance::of(relative).class();
            groups += &format!("<td><span class=\"{class}\">{}</span></td>", signed_percent(relative));
        }
        groups += "</tr>";
        if let Some((name, cells)) = &table.beside {
            groups += &row(name, "beside", &cells[number_of], table.decimals);
        }
        groups += "</tbody>";
    }
    format!(
        "<table><caption>{}, {}</caption><thead><tr><td></td>{head}</tr></thead>{groups}</table>",
        escape(table.title),
        escape(table.unit)
    )
}

/// How many decimals the paper gives: as many as its longest figure has.
fn published_decimals(table: &Table) -> usize {
    let decimals = |cell: &f64| cell.to_string().split_once('.').map_or(0, |(_, decimals)| decimals.len());
    table.published.iter().flatten().map(decimals).max().unwrap_or(0)
}

/// A relative difference as a person reads it.
pub fn signed_percent(relative: f64) -> String {
    let text = number(100.0 * relative, 1);
    let sign = if relative > 0.0 && text.chars().any(|c| c.is_ascii_digit() && c != '0') { "+" } else { "" };
    format!("{sign}{text}\u{a0}%")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_signed() {
        assert_eq!(signed_percent(0.280_4), "+28.0\u{a0}%");
        assert_eq!(signed_percent(-0.342), "\u{2212}34.2\u{a0}%");
        assert_eq!(signed_percent(0.000_1), "0.0\u{a0}%");
    }

    #[test]
    fn marks_follow_their_bars() {
        assert_eq!(Distance::of(-0.0099), Distance::Equal);
        assert_eq!(Distance::of(0.0101), Distance::Near);
        assert_eq!(Distance::of(-0.2), Distance::Apart);
        assert_eq!(Distance::of(0.251), Distance::Far);
        assert_eq!(Distance::of(f64::NAN), Distance::Far);
    }

    /// The paper prints 9.20 s beside 12.67 s, though a number forgets the zero.
    #[test]
    fn tables_hold_every_figure_and_mark_the_worst() {
        let mut measured = [[2.0; 4]; 3];
        measured[1][2] = 3.5;
        let mut published = [[2.0; 4]; 3];
        published[0][0] = 2.01;
        let beside = Some(("exact <integral>", [[7.25; 4]; 3]));
        let table = Table { title: "T", unit: "s", decimals: 3, published, measured, beside };
        let text = html(&table);
        for figure in ["3.500", "2.000", "2.01", "2.00<", "7.250", "+75.0\u{a0}%", "exact &lt;integral&gt;"] {
            assert!(text.contains(figure), "{figure} in {text}");
        }
        assert_eq!(worst(&table), (0.75, 0.5, 0.75));
        super::super::page::tests::assert_balanced(&text);
    }
}
