//! A machine's file: `machine.toml`, read and checked as the controller will check it again.

mod path_settings;
mod summary;
pub mod transfer;

use std::ops::Range;

use heapless::{String, Vec};
use serde::Deserialize;
use shared::machine::{AxisSettings, HostLost, Input, MachineError, MachineSettings, NAME_SIZE, image};
use shared::steps::MOST_AXES;
use toml::de::{DeTable, DeValue};

use crate::input::{InputError, Source};

pub use path_settings::PathSettings;
pub use summary::{AxisSummary, DriveSummary, HomingSummary, Summary};

/// Reads and checks a machine's file. Errors name file, line and column.
pub fn read(name: &str) -> Result<MachineSettings, InputError> {
    from_source(&Source::read(name)?)
}

/// The same with what it says of the path, for a plan.
pub fn read_for_plan(name: &str) -> Result<(MachineSettings, PathSettings), InputError> {
    both(&Source::read(name)?)
}

/// Reads and checks a machine from a text that is at hand; `name` stands in errors.
pub fn from_toml(name: &str, text: &str) -> Result<MachineSettings, InputError> {
    from_source(&Source { name: name.to_string(), text: text.to_string() })
}

/// The text of a machine's file.
pub fn to_toml(settings: &MachineSettings) -> Result<std::string::String, toml::ser::Error> {
    toml::to_string(settings)
}

/// The image that the controller keeps.
pub fn to_image(settings: &MachineSettings) -> Result<std::vec::Vec<u8>, image::ImageError> {
    image::encode(settings).map(|image| image.to_vec())
}

/// A machine's file: what the controller keeps, and what only the planner on the host reads.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: String<NAME_SIZE>,
    #[serde(default)]
    host_lost: HostLost,
    estop: Input,
    debounce: f64,
    release: f64,
    axis: Vec<AxisSettings, MOST_AXES>,
    #[serde(default)]
    path: PathSettings,
}

fn from_source(source: &Source) -> Result<MachineSettings, InputError> {
    both(source).map(|(settings, _)| settings)
}

fn both(source: &Source) -> Result<(MachineSettings, PathSettings), InputError> {
    let File { name, host_lost, estop, debounce, release, axis, path } = toml::from_str(&source.text)
        .map_err(|error| source.error(&error.span().unwrap_or(0..0), error.message().trim().replace('\n', "; ")))?;
    let settings = MachineSettings { name, host_lost, estop, debounce, release, axes: axis };
    settings.check().map_err(|error| {
        let message = match error.axis().and_then(|axis| settings.axes.get(usize::from(axis))) {
            Some(axis) => format!("axis {}: {error}", axis.name.letter()),
            None => error.to_string(),
        };
        source.error(&locate(&source.text, error), message)
    })?;
    if let Some((key, value, needed)) = path.fault() {
        let span = DeTable::parse(&source.text)
            .ok()
            .and_then(|document| {
                let (_, value) = document.get_ref().get("path")?.get_ref().as_table()?.get_key_value(key)?;
                Some(value.span())
            })
            .unwrap_or(0..0);
        return Err(source.error(&span, format_args!("path.{key} is {value}; it must be {needed}")));
    }
    Ok((settings, path))
}

/// The place of the value at fault, or of the innermost table that should hold it.
fn locate(text: &str, error: MachineError) -> Range<usize> {
    let Ok(document) = DeTable::parse(text) else { return 0..0 };
    let mut span = 0..0;
    let mut table = Some(document.get_ref());
    if let Some(axis) = error.axis() {
        let axes = document.get_ref().get("axis").and_then(|axes| axes.get_ref().as_array());
        let axis = axes.and_then(|axes| axes.get(usize::from(axis)));
        span = axis.map_or(0..0, |axis| axis.span());
        table = axis.and_then(|axis| axis.get_ref().as_table());
    }
    let mut path = error.path().to_vec();
    if let MachineError::Servo { error, .. } = error {
        // What a drive's command means has a table of its own.
        match error.key() {
            key @ ("lag" | "velocity_gain" | "limit") => {
                let kinds = ["velocity", "acceleration"];
                let drive =
                    find(table, &path).and_then(|control| control.get("drive")).and_then(|d| d.get_ref().as_table());
                let kind = kinds.into_iter().find(|kind| drive.is_some_and(|drive| drive.contains_key(*kind)));
                path.extend(["drive"].into_iter().chain(kind).chain([key]));
            }
            key => path.push(key),
        }
    }
    for key in path {
        let Some((name, value)) = table.and_then(|table| table.get_key_value(key)) else { break };
        span = if matches!(value.get_ref(), DeValue::Table(_)) { name.span() } else { value.span() };
        table = value.get_ref().as_table();
    }
    span
}

fn find<'a, 'i>(table: Option<&'a DeTable<'i>>, path: &[&str]) -> Option<&'a DeTable<'i>> {
    path.iter().try_fold(table?, |table, key| table.get(*key)?.get_ref().as_table())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed test says where")]

    use super::*;

    const ROUTER: &str = include_str!("../../../examples/machine.toml");

    fn refused(old: &str, new: &str) -> std::string::String {
        let text = ROUTER.replacen(old, new, 1);
        assert_ne!(text, ROUTER, "{old}");
        let error = from_toml("machine.toml", &text).unwrap_err();
        let (line, column) = error.position.unwrap();
        let marked: std::string::String = text.lines().nth(line - 1).unwrap().chars().skip(column - 1).collect();
        let marked = marked.split('#').next().unwrap().trim_end();
        let message = error.to_string();
        format!("{marked} <- {}", message.splitn(4, ':').nth(3).unwrap().trim())
    }

    #[test]
    fn the_example_is_kept_whole() {
        let settings = from_toml("machine.toml", ROUTER).unwrap();
        assert_eq!(image::decode(&to_image(&settings).unwrap()), Ok(settings.clone()));
        assert_eq!(settings.axes.len(), 3);
        let text = to_toml(&settings).unwrap();
        assert_eq!(from_toml("again", &text), Ok(settings), "it can be written as a file again");
    }

    #[test]
    fn errors_stand_at_the_value_that_they_are_about() {
        let found = refused("velocity = 80.0", "velocity = 0.0");
        assert_eq!(found, "0.0 <- axis x: velocity is 0; it must be 0.001 to 10000 mm/s");
        let found = refused("debounce = 0.005", "debounce = 5.0");
        assert_eq!(found, "5.0 <- debounce is 5; it must be 0 to 0.1 s");
        let found = refused("slow = 1.0", "slow = 100.0");
        assert!(found.starts_with("100.0 <- axis x: homing.slow is 100 mm/s; it must be at most 25"), "{found}");
        let found = refused("name = \"y\"", "name = \"x\"");
        assert!(found.starts_with("\"x\" <- axis x: an axis before this one has the same name"), "{found}");
        let found = refused("travel = [0.0, 600.0]", "travel = [0.0, 0.0]");
        assert!(found.starts_with("[0.0, 0.0] <- axis x: the travel ends"), "{found}");
        let found = refused("velocity = 80.0", "speed = 80.0");
        assert!(found.contains("<- unknown field `speed`"), "{found}");
    }
}
