//! Values: numbers, parameters, `[…]` with LinuxCNC's operators, and functions. Angles are degrees.
//!
//! Operators, from the one that binds most: `**`, then `* / MOD`, then `+ -`, then `EQ NE GT GE LT LE`, then `AND OR XOR`;
//! those of one row from left to right. True is 1; numbers nearer than 1e-4 are equal, as LinuxCNC has it. A sign belongs
//! to the value behind it, so `-2 ** 2` is 4.

use super::fault::{Checked, Fault, fail};
use super::parameters::{Kept, Key, LAST, Parameters};
use crate::program::number::decimal;

/// How deep brackets and functions may be nested: what is read recursively must not fill the stack.
pub const DEPTH: u32 = 64;
/// Numbers nearer than this are equal.
const EQUAL: f64 = 1e-4;
/// How far from a whole number a parameter's number may be.
const WHOLE: f64 = 1e-4;

/// Reads values from a line.
pub struct Values<'a> {
    /// The line.
    pub text: &'a [u8],
    /// The next byte.
    pub at: usize,
    /// What the program has set.
    pub parameters: &'a Parameters,
    /// What the machine keeps.
    pub kept: &'a dyn Kept,
    depth: u32,
}

impl<'a> Values<'a> {
    /// Begins at a byte of a line.
    pub fn new(text: &'a [u8], at: usize, parameters: &'a Parameters, kept: &'a dyn Kept) -> Self {
        Self { text, at, parameters, kept, depth: 0 }
    }

    /// The next byte that is no blank.
    pub fn peek(&mut self) -> Option<u8> {
        while self.text.get(self.at).is_some_and(|&byte| is_blank(byte)) {
            self.at += 1;
        }
        self.text.get(self.at).copied()
    }

    /// Takes the byte if it is the next one.
    pub fn take(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    /// A value, with its sign.
    pub fn value(&mut self) -> Checked<f64> {
        let at = self.at;
        self.depth += 1;
        if self.depth > DEPTH {
            return fail(at, Fault::TooDeep);
        }
        let value = match self.peek() {
            Some(b'-') => {
                self.at += 1;
                -self.unsigned()?
            }
            Some(b'+') => {
                self.at += 1;
                self.unsigned()?
            }
            _ => self.unsigned()?,
        };
        self.depth -= 1;
        if value.is_finite() { Ok(value) } else { fail(at, Fault::NotFinite) }
    }

    fn unsigned(&mut self) -> Checked<f64> {
        match self.peek() {
            Some(b'0'..=b'9' | b'.') => match decimal(self.text, self.at) {
                Some((value, end)) => {
                    self.at = end;
                    Ok(value)
                }
                None => fail(self.at, Fault::NoValue),
            },
            Some(b'[') => self.bracket(),
            Some(b'#') => {
                let at = self.at;
                let key = self.key()?;
                self.parameters.get(&key, self.kept).or_else(|fault| fail(at, fault))
            }
            Some(byte) if byte.is_ascii_alphabetic() => self.function(),
            _ => fail(self.at, Fault::NoValue),
        }
    }

    /// `[…]`.
    fn bracket(&mut self) -> Checked<f64> {
        let open = self.at;
        if !self.take(b'[') {
            return fail(open, Fault::NoValue);
        }
        let value = self.operation(0)?;
        if self.take(b']') {
            return Ok(value);
        }
        fail(if self.peek().is_none() { open } else { self.at }, self.missing())
    }

    /// What is wrong where an expression stops.
    fn missing(&mut self) -> Fault {
        match self.peek() {
            None | Some(b'\r' | b'\n' | b';' | b'(') => Fault::OpenBracket,
            Some(_) => Fault::NoOperator,
        }
    }

    /// Values with operators between them that bind at least so much.
    fn operation(&mut self, least: u8) -> Checked<f64> {
        let mut left = self.value()?;
        loop {
            let at = self.at;
            let Some((operator, binds, length)) = self.operator() else { return Ok(left) };
            if binds < least {
                return Ok(left);
            }
            self.at += length;
            let right = self.operation(binds + 1)?;
            left = match operator.apply(left, right) {
                Ok(value) if value.is_finite() => value,
                Ok(_) => return fail(at, Fault::NotFinite),
                Err(fault) => return fail(at, fault),
            };
        }
    }

    /// The operator that comes next, how much it binds, and how long it is.
    fn operator(&mut self) -> Option<(Operator, u8, usize)> {
        self.peek()?;
        let rest = self.text.get(self.at..)?;
        OPERATORS
            .iter()
            .find_map(|&(text, operator, binds)| spelled(rest, text).map(|length| (operator, binds, length)))
    }

    /// A function and its argument.
    fn function(&mut self) -> Checked<f64> {
        let at = self.at;
        let rest = self.text.get(at..).unwrap_or_default();
        let length = rest.iter().take_while(|&&byte| byte.is_ascii_alphabetic() || is_blank(byte)).count();
        let letters = rest[..length].iter().filter(|&&byte| !is_blank(byte));
        let name: String = letters.map(|byte| char::from(byte.to_ascii_lowercase())).collect();
        self.at += length;
        if name == "exists" {
            return self.exists();
        }
        if !FUNCTIONS.contains(&name.as_str()) {
            return fail(at, Fault::NoFunction);
        }
        let x = self.argument()?;
        let domain = |holds: bool, value: f64| if holds { Ok(value) } else { fail(at, Fault::Domain(x)) };
        match name.as_str() {
            "abs" => Ok(x.abs()),
            "acos" => domain(x.abs() <= 1.0, x.acos().to_degrees()),
            "asin" => domain(x.abs() <= 1.0, x.asin().to_degrees()),
            "atan" => {
                if !self.take(b'/') {
                    return fail(self.at, Fault::AtanSlash);
                }
                Ok(x.atan2(self.argument()?).to_degrees())
            }
            "cos" => Ok(x.to_radians().cos()),
            "exp" => Ok(x.exp()),
            "fix" => Ok(x.floor()),
            "fup" => Ok(x.ceil()),
            "ln" => domain(x > 0.0, x.ln()),
            "round" => Ok(x.round()),
            "sin" => Ok(x.to_radians().sin()),
            "sqrt" => domain(x >= 0.0, x.sqrt()),
            _ => Ok(x.to_radians().tan()),
        }
    }

    /// `[…]` behind a function.
    fn argument(&mut self) -> Checked<f64> {
        match self.peek() {
            Some(b'[') => self.bracket(),
            _ => fail(self.at, Fault::NoValue),
        }
    }

    /// `EXISTS[#<name>]`: its argument is not looked up.
    fn exists(&mut self) -> Checked<f64> {
        let open = self.at;
        if !self.take(b'[') || self.peek() != Some(b'#') {
            return fail(self.at, Fault::NoValue);
        }
        let key = self.key()?;
        if !self.take(b']') {
            return fail(open, Fault::OpenBracket);
        }
        Ok(f64::from(u8::from(self.parameters.exists(&key, self.kept))))
    }

    /// `#` with a number, an expression or a name.
    pub fn key(&mut self) -> Checked<Key> {
        let hash = self.at;
        self.at += 1;
        if self.take(b'<') {
            let rest = self.text.get(self.at..).unwrap_or_default();
            let Some(length) = rest.iter().position(|&byte| byte == b'>') else {
                return fail(hash, Fault::OpenBracket);
            };
            let name = rest[..length].iter().filter(|byte| !byte.is_ascii_whitespace());
            let name: Vec<u8> = name.map(u8::to_ascii_lowercase).collect();
            self.at += length + 1;
            return Ok(Key::Name(String::from_utf8_lossy(&name).into_owned()));
        }
        let number = self.value()?;
        let whole = number.round();
        if (number - whole).abs() > WHOLE || !(1.0..=f64::from(LAST)).contains(&whole) {
            return fail(hash, Fault::NoParameter(number));
        }
        Ok(Key::Number(whole as u16))
    }
}

/// Blanks have no meaning, not even within a name.
fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t')
}

/// How many bytes spell a name in small letters, blanks and capitals aside; none if they spell another one.
fn spelled(bytes: &[u8], name: &[u8]) -> Option<usize> {
    let mut left = name.iter();
    let mut next = left.next();
    for (at, &byte) in bytes.iter().enumerate() {
        if is_blank(byte) {
            continue;
        }
        if next != Some(&byte.to_ascii_lowercase()) {
            return None;
        }
        next = left.next();
        if next.is_none() {
            return Some(at + 1);
        }
    }
    None
}

const FUNCTIONS: [&str; 13] =
    ["abs", "acos", "asin", "atan", "cos", "exp", "fix", "fup", "ln", "round", "sin", "sqrt", "tan"];

/// What two values are made into.
#[derive(Clone, Copy)]
enum Operator {
    Power,
    Times,
    Over,
    Modulo,
    Plus,
    Minus,
    Equal,
    NotEqual,
    Greater,
    GreaterOrEqual,
    Less,
    LessOrEqual,
    And,
    Or,
    ExclusiveOr,
}

/// `**` stands before `*`, which it begins with.
const OPERATORS: [(&[u8], Operator, u8); 15] = [
    (b"**", Operator::Power, 4),
    (b"*", Operator::Times, 3),
    (b"/", Operator::Over, 3),
    (b"mod", Operator::Modulo, 3),
    (b"+", Operator::Plus, 2),
    (b"-", Operator::Minus, 2),
    (b"eq", Operator::Equal, 1),
    (b"ne", Operator::NotEqual, 1),
    (b"ge", Operator::GreaterOrEqual, 1),
    (b"gt", Operator::Greater, 1),
    (b"le", Operator::LessOrEqual, 1),
    (b"lt", Operator::Less, 1),
    (b"and", Operator::And, 0),
    (b"or", Operator::Or, 0),
    (b"xor", Operator::ExclusiveOr, 0),
];

impl Operator {
    fn apply(self, a: f64, b: f64) -> Result<f64, Fault> {
        let truth = |holds: bool| Ok(f64::from(u8::from(holds)));
        let equal = (a - b).abs() < EQUAL;
        match self {
            Self::Power if a < 0.0 && b.fract() != 0.0 => Err(Fault::Domain(a)),
            Self::Power => Ok(a.powf(b)),
            Self::Times => Ok(a * b),
            Self::Over | Self::Modulo if b == 0.0 => Err(Fault::ByZero),
            Self::Over => Ok(a / b),
            Self::Modulo => Ok(a.rem_euclid(b)),
            Self::Plus => Ok(a + b),
            Self::Minus => Ok(a - b),
            Self::Equal => truth(equal),
            Self::NotEqual => truth(!equal),
            Self::Greater => truth(a > b),
            Self::GreaterOrEqual => truth(equal || a > b),
            Self::Less => truth(a < b),
            Self::LessOrEqual => truth(equal || a < b),
            Self::And => truth(a != 0.0 && b != 0.0),
            Self::Or => truth(a != 0.0 || b != 0.0),
            Self::ExclusiveOr => truth((a != 0.0) != (b != 0.0)),
        }
    }
}
