//! The units that people meet. Inside, lengths are mm; a file and all that is reported of it have a unit of their own.

use serde::{Deserialize, Serialize};
use shared::complex::Complex;

/// The unit of lengths in a job's file and in what is reported of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Units {
    /// Millimetres; feeds in mm/min.
    Mm,
    /// Inches; feeds in inch/min.
    Inch,
}

impl Units {
    /// Millimetres in one unit.
    pub fn mm(self) -> f64 {
        match self {
            Self::Mm => 1.0,
            Self::Inch => 25.4,
        }
    }

    /// As it is written after a number.
    pub fn short(self) -> &'static str {
        match self {
            Self::Mm => "mm",
            Self::Inch => "in",
        }
    }

    /// A length in mm as a sentence names it, with its unit.
    pub fn length(self, mm: f64) -> String {
        format!("{} {}", plain(mm / self.mm()), self.short())
    }

    /// A point in mm as a sentence names it.
    pub fn point(self, place: Complex<f64>) -> String {
        coordinates([place.re, place.im].map(|mm| mm / self.mm()))
    }
}

/// A number as a sentence names it: at most six decimals and no zeros behind them; a smaller one with its power of ten.
pub fn plain(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-4 { format!("{value:.3e}") } else { decimals(value) }
}

/// A point as a sentence names it.
pub fn coordinates([x, y]: [f64; 2]) -> String {
    format!("({}, {})", decimals(x), decimals(y))
}

/// At most six decimals, no zeros behind them, no minus before a zero.
fn decimals(value: f64) -> String {
    let text = format!("{value:.6}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_string() } else { text.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_sentences_are_short() {
        assert_eq!(Units::Inch.length(25.4), "1 in");
        assert_eq!(Units::Mm.length(0.1 + 0.2), "0.3 mm");
        assert_eq!(Units::Mm.length(1.234_567_89), "1.234568 mm");
        assert_eq!(Units::Mm.length(2.5e-7), "2.500e-7 mm");
        assert_eq!(Units::Mm.point(Complex::new(-40.0, -1e-9)), "(-40, 0)");
    }
}
