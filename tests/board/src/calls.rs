//! Counts what a function takes that the program calls outside the tick, such as what prepares a piece.
//!
//! Every instruction that the function can reach is watched. An interrupt may come in between, and what it runs is not the function's: a call
//! counts as whole only where the watched instructions are all that ran between its first and its last one.

use std::collections::{BTreeMap, BTreeSet};

use crate::Error;
use crate::image::{Function, Image, Instruction};
use crate::reach::Reach;

/// One call from its first instruction to its return, both counted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Call {
    /// How often each instruction ran.
    pub executed: BTreeMap<u32, u32>,
    /// What ran altogether, interrupts among it.
    pub elapsed: u64,
}

impl Call {
    /// Instructions of the function and of all that it called.
    pub fn instructions(&self) -> u32 {
        self.executed.values().sum()
    }

    /// Whether no interrupt came in between.
    pub fn is_whole(&self) -> bool {
        u64::from(self.instructions()) == self.elapsed
    }
}

/// Watches the calls of one function.
#[derive(Clone, Debug)]
pub struct Calls {
    entry: u32,
    ends: Vec<u32>,
    watched: BTreeSet<u32>,
    /// The instruction count at the first instruction of the call that is under way.
    entered: Option<u64>,
    running: BTreeMap<u32, u32>,
    /// The calls that returned.
    pub seen: Vec<Call>,
}

impl Calls {
    /// Of `function` of `image`. Errors: a call that cannot be followed, so that its instructions would not be watched.
    pub fn new(image: &Image, function: &Function) -> Result<Self, Error> {
        let reach = Reach::of(image, function);
        if let Some((name, address)) = reach.indirect.first() {
            return Err(Error::new(format!(
                "{} calls through a register, in {name} at {address:#010x}",
                function.name
            )));
        }
        let ends = image.instructions(function).into_iter().filter(Instruction::is_return);
        Ok(Self {
            entry: function.range.start,
            ends: ends.map(|end| end.address).collect(),
            watched: reach.instructions(image).into_iter().collect(),
            entered: None,
            running: BTreeMap::new(),
            seen: Vec::new(),
        })
    }

    /// The instructions to stop at.
    pub fn addresses(&self) -> impl Iterator<Item = &u32> {
        self.watched.iter()
    }

    /// The instruction at `address` is about to run, after `count` others since power-up.
    pub fn hit(&mut self, address: u32, count: u64) {
        if address == self.entry {
            self.entered = Some(count);
            self.running.clear();
        }
        let Some(entered) = self.entered else { return };
        if !self.watched.contains(&address) {
            return;
        }
        *self.running.entry(address).or_default() += 1;
        if self.ends.contains(&address) {
            self.entered = None;
            let executed = std::mem::take(&mut self.running);
            self.seen.push(Call { executed, elapsed: count - entered + 1 });
        }
    }
}
