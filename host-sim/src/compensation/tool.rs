//! Tool tables in LinuxCNC's text form: a tool a line, words like `T1 P1 Z0.5 D0.0625`, and a comment behind `;`.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::input::{InputError, Source};
use crate::units::Units;

/// The tools of a machine by their numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolTable {
    tools: BTreeMap<u32, Tool>,
}

/// One tool.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tool {
    /// Its diameter in mm; a negative one takes the tool to the other side.
    pub diameter: f64,
    /// Its length offset along X, Y and Z in mm.
    pub length: [f64; 3],
}

/// The words of an entry: pocket, axes, diameter, angles of lathe tools and their orientation.
const WORDS: &str = "TPXYZABCUVWDIJQ";

impl ToolTable {
    /// Reads a file whose lengths are in `units`, those of the machine. Errors: it cannot be read, or as [`Self::parse`].
    pub fn read(name: &str, units: Units) -> Result<Self, InputError> {
        Self::parse(&Source::read(name)?, units)
    }

    /// Reads a table whose lengths are in `units`. Errors: a word that is none, or an entry without or with another one's T.
    pub fn parse(source: &Source, units: Units) -> Result<Self, InputError> {
        let mut table = Self::default();
        let mut start = 0;
        for line in source.text.split('\n') {
            let words = line.split_once(';').map_or(line, |(words, _)| words);
            table.entry(source, words, start, units)?;
            start += line.len() + 1;
        }
        Ok(table)
    }

    fn entry(&mut self, source: &Source, words: &str, start: usize, units: Units) -> Result<(), InputError> {
        let mut number: Option<(u32, Range<usize>)> = None;
        let mut tool = Tool::default();
        let mut first = None;
        for (span, word) in spans(words, start) {
            first.get_or_insert_with(|| span.clone());
            let mut letters = word.chars();
            let letter = letters.next().map_or(' ', |c| c.to_ascii_uppercase());
            if !WORDS.contains(letter) {
                let message = format!(
                    "\"{word}\" is no word of a tool; T, P, D, X, Y, Z and a number are, and ; before a comment"
                );
                return Err(source.error(&span, message));
            }
            let value = letters.as_str();
            if letter == 'T' {
                let Ok(value) = value.parse() else {
                    return Err(
                        source.error(&span, format!("\"{value}\" is no number of a tool; give a whole one, as in T1"))
                    );
                };
                number = Some((value, span));
                continue;
            }
            let value = match value.parse::<f64>() {
                Ok(value) if value.is_finite() => value,
                _ => return Err(source.error(&span, format!("{letter} needs a number, as in {letter}0.5"))),
            };
            match letter {
                'D' => tool.diameter = value * units.mm(),
                'X' => tool.length[0] = value * units.mm(),
                'Y' => tool.length[1] = value * units.mm(),
                'Z' => tool.length[2] = value * units.mm(),
                _ => {}
            }
        }
        match (number, first) {
            (Some((number, span)), _) => match self.tools.insert(number, tool) {
                Some(_) => Err(source.error(&span, format!("tool {number} stands here twice; leave one entry out"))),
                None => Ok(()),
            },
            (None, Some(span)) => Err(source.error(&span, "this entry has no T; give the number of its tool")),
            (None, None) => Ok(()),
        }
    }

    /// The tool of this number.
    pub fn tool(&self, number: u32) -> Option<Tool> {
        self.tools.get(&number).copied()
    }

    /// Puts a tool in, or in the place of another.
    pub fn insert(&mut self, number: u32, tool: Tool) {
        self.tools.insert(number, tool);
    }

    /// All tools in the order of their numbers.
    pub fn tools(&self) -> impl Iterator<Item = (u32, Tool)> + '_ {
        self.tools.iter().map(|(&number, &tool)| (number, tool))
    }
}

/// The words between blanks, with their places in the text.
fn spans(line: &str, start: usize) -> impl Iterator<Item = (Range<usize>, &str)> {
    line.split_ascii_whitespace().map(move |word| {
        // `split_ascii_whitespace` gives parts of `line`.
        let at = start + (word.as_ptr() as usize - line.as_ptr() as usize);
        (at..at + word.len(), word)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str, units: Units) -> Result<ToolTable, InputError> {
        ToolTable::parse(&Source { name: "mill.tbl".to_string(), text: text.to_string() }, units)
    }

    #[test]
    fn entries_are_read_in_the_machines_unit() {
        let text = "T1 P1 Z0.5 D0.0625;first tool\n; nothing\n\nt32 p32 z+0.5 d-1.0 I15 Q3 ;last";
        let found = table(text, Units::Inch).unwrap();
        assert_eq!(found.tool(1), Some(Tool { diameter: 0.0625 * 25.4, length: [0.0, 0.0, 12.7] }));
        assert_eq!(found.tool(32).unwrap().diameter, -25.4);
        assert_eq!(found.tool(2), None);
        assert_eq!(table(text, Units::Mm).unwrap().tool(1).unwrap().diameter, 0.0625);
    }

    #[test]
    fn each_fault_is_at_its_place() {
        let sentence = |text| table(text, Units::Mm).unwrap_err().to_string();
        assert_eq!(sentence("T1 D1\nT2 Dx"), "mill.tbl:2:4: D needs a number, as in D0.5");
        assert_eq!(sentence("T1.5 D1"), "mill.tbl:1:1: \"1.5\" is no number of a tool; give a whole one, as in T1");
        assert_eq!(sentence("T1 D1\n  T1 D2"), "mill.tbl:2:3: tool 1 stands here twice; leave one entry out");
        assert_eq!(sentence("P1 D1"), "mill.tbl:1:1: this entry has no T; give the number of its tool");
        assert!(sentence("T1 D1 endmill").starts_with("mill.tbl:1:7: \"endmill\" is no word of a tool;"));
    }
}
