//! The names of the entities in a file: pairs of lines, a code and a value, of which code 0 begins something.

use std::collections::BTreeMap;

/// Parts of another entity.
const PARTS: [&str; 3] = ["VERTEX", "SEQEND", "ATTRIB"];

/// How many entities there are of each name; none if there is no section ENTITIES.
pub fn names(bytes: &[u8]) -> Option<BTreeMap<String, usize>> {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = text.trim_start_matches('\u{feff}').lines().map(str::trim);
    let (mut names, mut found) = (BTreeMap::new(), false);
    // The name of the section that is read; empty behind SECTION, where it comes next.
    let mut section: Option<String> = None;
    while let (Some(code), Some(value)) = (lines.next(), lines.next()) {
        match (code, value) {
            ("0", "SECTION") => section = Some(String::new()),
            ("0", "ENDSEC" | "EOF") => section = None,
            ("2", name) if section.as_ref().is_some_and(String::is_empty) => {
                found |= name == "ENTITIES";
                section = Some(name.to_string());
            }
            ("0", name) if section.as_deref() == Some("ENTITIES") && !PARTS.contains(&name) => {
                *names.entry(name.to_string()).or_default() += 1;
            }
            _ => {}
        }
    }
    found.then_some(names)
}
