//! The way of items to the sink, with their places.

use super::lines::column;
use super::{Action, Feed, Item};

/// That the sink takes no more; its reason is kept in [`Output::refusal`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refused;

/// Where the items of one line go.
pub struct Output<'a, 'b> {
    /// The number of the line.
    pub line: usize,
    text: &'a [u8],
    sink: &'a mut (dyn FnMut(&Item<'_>) -> Result<(), String> + 'b),
    /// What the sink said when it refused an item.
    pub refusal: Option<String>,
}

impl<'a, 'b> Output<'a, 'b> {
    /// For a line.
    pub fn new(line: usize, text: &'a [u8], sink: &'a mut (dyn FnMut(&Item<'_>) -> Result<(), String> + 'b)) -> Self {
        Self { line, text, sink, refusal: None }
    }

    /// Gives an item that the word at `at` asks for.
    pub fn give(&mut self, at: usize, from: [f64; 3], feed: Feed, action: Action<'_>) -> Result<(), Refused> {
        self.give_before(self.place(at), from, feed, action)
    }

    /// The line and column of the byte at `at` of this line.
    pub fn place(&self, at: usize) -> (usize, usize) {
        (self.line, column(self.text, at))
    }

    /// Gives an item that a line and column, this line's or another one's, ask for.
    pub fn give_before(
        &mut self,
        (line, column): (usize, usize),
        from: [f64; 3],
        feed: Feed,
        action: Action<'_>,
    ) -> Result<(), Refused> {
        let item = Item { line, column, from, feed, action };
        match (self.sink)(&item) {
            Ok(()) => Ok(()),
            Err(reason) => {
                self.refusal = Some(reason);
                Err(Refused)
            }
        }
    }
}
