//! Parameters: `#1` to `#5602`, `#<name>`, and those that the machine keeps itself.

use std::collections::HashMap;

use super::fault::Fault;

/// The number of the last parameter.
pub const LAST: u16 = 5602;
/// The numbers from here on tell of the machine: probe, home, shifts, coordinate systems, position.
const FIRST_KEPT: u16 = 5061;
/// The most named parameters that are held, so that no program can fill the memory.
const MOST_NAMES: usize = 4096;

/// Which parameter is meant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Key {
    /// By its number, in 1..=[`LAST`].
    Number(u16),
    /// By its name, in small letters and without blanks.
    Name(String),
}

/// Parameters that the machine keeps: they can be read and not set.
pub trait Kept {
    /// By number; none if there is none.
    fn numbered(&self, number: u16) -> Option<f64>;
    /// By name; none if there is none.
    fn named(&self, name: &str) -> Option<f64>;
}

/// The parameters that a program sets.
#[derive(Clone, Debug, Default)]
pub struct Parameters {
    numbered: HashMap<u16, f64>,
    named: HashMap<String, f64>,
}

impl Parameters {
    /// The value; numbered ones are 0 until they are set. Errors: a name without value.
    pub fn get(&self, key: &Key, kept: &dyn Kept) -> Result<f64, Fault> {
        match key {
            Key::Number(number) => {
                let value = kept.numbered(*number).or_else(|| self.numbered.get(number).copied());
                Ok(value.unwrap_or(0.0))
            }
            Key::Name(name) => kept.named(name).or_else(|| self.named.get(name).copied()).ok_or(Fault::NoName),
        }
    }

    /// Whether there is such a parameter.
    pub fn exists(&self, key: &Key, kept: &dyn Kept) -> bool {
        match key {
            Key::Number(_) => true,
            Key::Name(name) => kept.named(name).is_some() || self.named.contains_key(name),
        }
    }

    /// Whether a program may set it. Errors: the machine keeps it.
    pub fn may_set(key: &Key, kept: &dyn Kept) -> Result<(), Fault> {
        let is_kept = match key {
            Key::Number(number) => (FIRST_KEPT..=LAST).contains(number) && *number < 5599,
            Key::Name(name) => kept.named(name).is_some(),
        };
        if is_kept { Err(Fault::Kept) } else { Ok(()) }
    }

    /// Sets a value. Errors: too many names.
    pub fn set(&mut self, key: Key, value: f64) -> Result<(), Fault> {
        match key {
            Key::Number(number) => {
                self.numbered.insert(number, value);
            }
            Key::Name(name) => {
                if self.named.len() >= MOST_NAMES && !self.named.contains_key(&name) {
                    return Err(Fault::TooManyNames(MOST_NAMES));
                }
                self.named.insert(name, value);
            }
        }
        Ok(())
    }
}
