//! Blocks, words and digits.

use std::io::Write;

use super::WriteError;

/// The highest number of a block.
const HIGHEST: u32 = 99_999;

/// Writes blocks; a block is gathered and then written whole.
#[derive(Debug)]
pub struct Blocks<W> {
    out: W,
    step: Option<u32>,
    number: u32,
    block: String,
}

impl<W: Write> Blocks<W> {
    /// Begins.
    pub fn new(out: W, step: Option<u32>) -> Self {
        Self { out, step, number: 0, block: String::new() }
    }

    /// Adds a word to the block.
    pub fn word(&mut self, word: &str) {
        self.valued(word, "");
    }

    /// Adds a word with a value.
    pub fn valued(&mut self, word: &str, value: &str) {
        if !self.block.is_empty() {
            self.block.push(' ');
        }
        self.block.push_str(word);
        self.block.push_str(value);
    }

    /// Writes the block.
    pub fn end(&mut self) -> Result<(), WriteError> {
        let failed = |error: std::io::Error| WriteError::Io(error.kind());
        if let Some(step) = self.step {
            self.number =
                if self.number > HIGHEST.saturating_sub(step) { step.min(HIGHEST) } else { self.number + step };
            write!(self.out, "N{} ", self.number).map_err(failed)?;
        }
        self.block.push('\n');
        self.out.write_all(self.block.as_bytes()).map_err(failed)?;
        self.block.clear();
        Ok(())
    }

    /// Gives back what was written to.
    pub fn finish(mut self) -> Result<W, WriteError> {
        self.out.flush().map_err(|error| WriteError::Io(error.kind()))?;
        Ok(self.out)
    }
}

/// A length with ten decimals, no zeros behind them and no minus before a zero.
pub fn decimals(value: f64) -> String {
    let text = format!("{value:.10}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_string() } else { text.to_string() }
}

/// What a reader finds in [`decimals`] of a length, but for its last bits.
pub fn rounded(value: f64) -> f64 {
    const STEPS: f64 = 1e10;
    (value * STEPS).round() / STEPS
}

/// A number with ten digits that say something: for feeds, which come out of a division by 60.
pub fn significant(value: f64) -> String {
    // The text has an exponent, which programs do not; it is a number that the standard library reads back.
    format!("{value:.9e}").parse::<f64>().unwrap_or(value).to_string()
}
