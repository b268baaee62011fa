//! What statements do.

use super::fault::{Fault, Misplaced};
use super::statement::{Value, Word};
use crate::program::arc::Ends;
use crate::program::item::{Compensation, Coolant, Cutter, Side, Speed, Spindle, Turning};
use crate::program::output::{Output, Refused};
use crate::program::{Action, Arc, Feed, Motion, Plane};
use crate::units::Units;

/// How far a unit vector may be from an axis: files have six decimals.
const UPRIGHT: f64 = 2e-6;
/// Seconds in a minute.
const MINUTE: f64 = 60.0;

/// A circle that waits for the end of its arc.
#[derive(Clone, Copy, Debug)]
struct Circle {
    centre: [f64; 3],
    plane: Plane,
    anticlockwise: bool,
}

/// A file while it is read.
#[derive(Clone, Debug)]
pub struct Reader {
    units: Units,
    place: [f64; 3],
    feed: Feed,
    /// Whether the next motion is a rapid.
    rapid: bool,
    circle: Option<Circle>,
    spindle: Spindle,
    coolant: Coolant,
}

/// What a statement returns: whether the file has ended.
type Done = Result<bool, Misplaced>;

impl Reader {
    /// At the beginning of a file.
    pub fn new(units: Units) -> Self {
        Self {
            units,
            place: [0.0; 3],
            feed: Feed::Unset,
            rapid: false,
            circle: None,
            spindle: Spindle { turning: Turning::Off, speed: Speed::Turns(0.0) },
            coolant: Coolant::default(),
        }
    }

    /// Does what a statement says.
    pub fn statement(&mut self, words: &[Word], out: &mut Output<'_, '_>) -> Done {
        let Some((major, minors)) = words.split_first() else { return Ok(false) };
        let Value::Name(name) = &major.value else { return major.fail(Fault::NoMajor) };
        if self.circle.is_some() && name != "GOTO" {
            return major.fail(Fault::LooseCircle);
        }
        let event = match name.as_str() {
            "UNITS" => {
                self.units = match only_name(major, minors, "MM or INCHES")? {
                    "MM" => Units::Mm,
                    "INCHES" | "INCH" => Units::Inch,
                    _ => return major.fail(Fault::Takes("MM or INCHES")),
                };
                return Ok(false);
            }
            "RAPID" => {
                self.rapid = true;
                return Ok(false);
            }
            "FEDRAT" => return self.feed(major, minors),
            "FROM" => {
                self.place = self.point(major, minors)?;
                return Ok(false);
            }
            "CIRCLE" => return self.begin_circle(major, minors),
            "GOTO" => {
                let to = self.point(major, minors)?;
                return self.go(major, to, out);
            }
            "GODLTA" => {
                let by = match numbers(minors)?.as_slice() {
                    // One number goes along the tool.
                    [z] => [0.0, 0.0, *z],
                    [x, y, z] => [*x, *y, *z],
                    _ => return major.fail(Fault::Takes("three numbers, or one along the tool")),
                };
                let to = std::array::from_fn(|axis| self.place[axis] + by[axis] * self.units.mm());
                return self.go(major, to, out);
            }
            "SPINDL" => Action::Spindle(self.spindle(major, minors)?),
            "COOLNT" => {
                self.coolant = match only_name(major, minors, "ON, FLOOD, MIST or OFF")? {
                    "ON" | "FLOOD" => Coolant { flood: true, ..self.coolant },
                    "MIST" => Coolant { mist: true, ..self.coolant },
                    "OFF" => Coolant::default(),
                    _ => return major.fail(Fault::Takes("ON, FLOOD, MIST or OFF")),
                };
                Action::Coolant(self.coolant)
            }
            "CUTCOM" => {
                let on = |side| Compensation::On { side, cutter: Cutter::Loaded };
                Action::Compensation(
                    match only_name(major, minors.get(..1).unwrap_or_default(), "LEFT, RIGHT or OFF")? {
                        "LEFT" => on(Side::Left),
                        "RIGHT" => on(Side::Right),
                        "OFF" => Compensation::Off,
                        _ => return major.fail(Fault::Takes("LEFT, RIGHT or OFF")),
                    },
                )
            }
            "LOADTL" => match minors.first().map(|word| &word.value) {
                Some(Value::Number(tool)) if *tool >= 0.0 && *tool <= 99_999.0 && tool.fract() == 0.0 => {
                    self.give(major, Action::ToolSelect(*tool as u32), out)?;
                    Action::ToolChange(*tool as u32)
                }
                _ => return major.fail(Fault::Takes("the number of a tool")),
            },
            "DELAY" => match numbers(minors)?.as_slice() {
                [seconds] if *seconds >= 0.0 => Action::Dwell(*seconds),
                _ => return major.fail(Fault::Takes("a number of seconds")),
            },
            "STOP" => Action::Stop { optional: false },
            "OPSTOP" => Action::Stop { optional: true },
            "END" | "FINI" => return self.end(out, major.at).map(|()| true),
            _ => return major.fail(Fault::Unknown),
        };
        self.give(major, event, out)?;
        Ok(false)
    }

    /// The end of the file, which the byte at `at` of the line asks for.
    pub fn end(&mut self, out: &mut Output<'_, '_>, at: usize) -> Result<(), Misplaced> {
        let line = out.line;
        if self.circle.is_some() {
            return Err(Misplaced { line, at, fault: Fault::LooseCircle });
        }
        let given = out.give(at, self.place, self.feed, Action::End);
        given.map_err(|Refused| Misplaced { line, at, fault: Fault::Refused })
    }

    fn give(&self, word: &Word, action: Action<'_>, out: &mut Output<'_, '_>) -> Result<(), Misplaced> {
        out.give(word.at, self.place, self.feed, action).or_else(|Refused| word.fail(Fault::Refused))
    }

    /// A point, of which the axis of the tool may be named too.
    fn point(&self, major: &Word, minors: &[Word]) -> Result<[f64; 3], Misplaced> {
        let place = match numbers(minors)?[..] {
            [x, y, z] => [x, y, z],
            [x, y, z, i, j, k] if along(2, [i, j, k]) == Some(true) => [x, y, z],
            [_, _, _, _, _, _] => return major.fail(Fault::Tilted),
            _ => return major.fail(Fault::Takes("three numbers, and three more for an upright tool")),
        };
        Ok(place.map(|c| c * self.units.mm()))
    }

    /// FEDRAT, with its unit before or behind the number.
    fn feed(&mut self, major: &Word, minors: &[Word]) -> Done {
        let (mut rate, mut mm) = (None, self.units.mm());
        for word in minors {
            match &word.value {
                Value::Number(value) if *value >= 0.0 && rate.is_none() => rate = Some(*value),
                Value::Number(_) => return word.fail(Fault::Minor),
                Value::Name(unit) => match unit.as_str() {
                    "MMPM" => mm = Units::Mm.mm(),
                    "IPM" => mm = Units::Inch.mm(),
                    "PERMIN" => {}
                    "MMPR" | "IPR" | "PERREV" => return word.fail(Fault::PerTurn),
                    _ => return word.fail(Fault::Minor),
                },
            }
        }
        let Some(rate) = rate else { return major.fail(Fault::Takes("a number, and MMPM or IPM")) };
        self.feed = Feed::Rate(rate * mm / MINUTE);
        self.rapid = false;
        Ok(false)
    }

    /// SPINDL: a speed in turns a minute and a direction, or ON or OFF.
    fn spindle(&mut self, major: &Word, minors: &[Word]) -> Result<Spindle, Misplaced> {
        if minors.is_empty() {
            return major.fail(Fault::Takes("a speed with CLW or CCLW, or OFF"));
        }
        let mut turning = match self.spindle.turning {
            Turning::Off => Turning::Clockwise,
            turning => turning,
        };
        for word in minors {
            match &word.value {
                Value::Number(value) if *value >= 0.0 => self.spindle.speed = Speed::Turns(value / MINUTE),
                Value::Number(_) => return word.fail(Fault::Minor),
                Value::Name(name) => match name.as_str() {
                    "RPM" | "ON" => {}
                    "CLW" => turning = Turning::Clockwise,
                    "CCLW" => turning = Turning::Anticlockwise,
                    "OFF" => turning = Turning::Off,
                    _ => return word.fail(Fault::Minor),
                },
            }
        }
        self.spindle.turning = turning;
        Ok(self.spindle)
    }

    /// CIRCLE: centre, axis and radius; what stands behind are tolerances and the tool's measures.
    fn begin_circle(&mut self, major: &Word, minors: &[Word]) -> Done {
        let [x, y, z, i, j, k, _, ..] = numbers(minors)?[..] else {
            return major.fail(Fault::Takes("seven numbers or more: a centre, an axis and a radius"));
        };
        let planes = [Plane::Yz, Plane::Zx, Plane::Xy].into_iter().enumerate();
        let found = planes.filter_map(|(axis, plane)| along(axis, [i, j, k]).map(|positive| (plane, positive))).next();
        let Some((plane, anticlockwise)) = found else { return major.fail(Fault::Oblique) };
        let centre = [x, y, z].map(|c| c * self.units.mm());
        self.circle = Some(Circle { centre, plane, anticlockwise });
        Ok(false)
    }

    /// GOTO and GODLTA.
    fn go(&mut self, major: &Word, to: [f64; 3], out: &mut Output<'_, '_>) -> Done {
        let circle = self.circle.take();
        let rapid = std::mem::take(&mut self.rapid) && circle.is_none();
        if !rapid && !matches!(self.feed, Feed::Rate(rate) if rate > 0.0) {
            return major.fail(Fault::NoFeed);
        }
        let motion = match circle {
            None if rapid => Motion::Rapid { to },
            None => Motion::Line { to },
            Some(circle) => Motion::Arc(self.arc(circle, to).or_else(|fault| major.fail(fault))?),
        };
        self.give(major, Action::Motion(motion), out)?;
        self.place = to;
        Ok(false)
    }

    fn arc(&self, circle: Circle, to: [f64; 3]) -> Result<Arc, Fault> {
        let [first, second, _] = circle.plane.axes();
        let flat = |point: [f64; 3]| [point[first], point[second]];
        let ends = Ends { from: flat(self.place), to: flat(to), anticlockwise: circle.anticlockwise, turns: 0 };
        let centre = flat(circle.centre);
        let sweep = ends.about(centre, self.units.mm()).map_err(Fault::Arc)?;
        Ok(Arc { plane: circle.plane, centre, to, sweep, turns: 0 })
    }
}

/// Whether a vector points along an axis or against it; none if it does neither.
fn along(axis: usize, vector: [f64; 3]) -> Option<bool> {
    let length = vector.iter().map(|c| c * c).sum::<f64>().sqrt();
    let across = vector.iter().enumerate().filter(|&(other, _)| other != axis).map(|(_, c)| c.abs());
    let value = vector.get(axis)?;
    (length > 0.0 && across.fold(0.0, f64::max) <= UPRIGHT * length).then_some(*value > 0.0)
}

/// Words that are all numbers.
fn numbers(words: &[Word]) -> Result<Vec<f64>, Misplaced> {
    let number = |word: &Word| if let Value::Number(value) = word.value { Ok(value) } else { word.fail(Fault::Minor) };
    words.iter().map(number).collect()
}

/// The name that is the only word.
fn only_name<'w>(major: &Word, words: &'w [Word], takes: &'static str) -> Result<&'w str, Misplaced> {
    match words {
        [Word { value: Value::Name(name), .. }] => Ok(name),
        _ => major.fail(Fault::Takes(takes)),
    }
}

impl Word {
    /// A fault at this word, as the error of a result.
    fn fail<T>(&self, fault: Fault) -> Result<T, Misplaced> {
        Err(Misplaced { line: self.line, at: self.at, fault })
    }
}
