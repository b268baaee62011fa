//! Chains whose ends meet become one: a drawing has its curves in any order and direction.
//!
//! In the order of the drawing each chain that is not closed is continued at its end and then at its start, as far as it
//! goes; where more than two ends meet, the first of the drawing goes on. Ends are found in a grid of cells no smaller than
//! the tolerance, so that the time grows with the number of curves and not with its square.

use std::collections::HashMap;

use super::curve::{Chain, distance};

/// Cells of a finer grid would have numbers that cannot be told apart for far places.
const FINEST: f64 = 1e-9;

type Cell = [i64; 3];

/// Chains that wait, and where their ends are.
struct Loose {
    chains: Vec<Option<Chain>>,
    ends: HashMap<Cell, Vec<usize>>,
    tolerance: f64,
}

/// Joins chains whose ends are no farther apart than `tolerance`, in mm. Ends that meet become one place.
pub fn join(chains: Vec<Chain>, tolerance: f64) -> Vec<Chain> {
    let mut loose = Loose { chains: Vec::with_capacity(chains.len()), ends: HashMap::new(), tolerance };
    for (index, chain) in chains.into_iter().enumerate() {
        if let (Some(start), Some(end)) = (chain.start(), chain.end())
            && distance(start, end) > tolerance
        {
            for place in [start, end] {
                loose.ends.entry(loose.cell(place)).or_default().push(index);
            }
        }
        loose.chains.push((!chain.0.is_empty()).then_some(chain));
    }
    let mut joined = Vec::new();
    for index in 0..loose.chains.len() {
        let Some(mut chain) = loose.chains.get_mut(index).and_then(Option::take) else { continue };
        loose.extend(&mut chain);
        // Backwards, unless it is closed by now.
        chain.turn();
        loose.extend(&mut chain);
        chain.turn();
        close(&mut chain, tolerance);
        joined.push(chain);
    }
    joined
}

/// Makes the ends of a closed chain one place.
fn close(chain: &mut Chain, tolerance: f64) {
    if let (Some(start), Some(last)) = (chain.start(), chain.0.last_mut())
        && last.to() != start
        && distance(last.to(), start) <= tolerance
    {
        last.end_at(start);
    }
}

impl Loose {
    fn cell(&self, place: [f64; 3]) -> Cell {
        place.map(|x| (x / self.tolerance.max(FINEST)).floor() as i64)
    }

    /// Continues a chain at its end as far as it goes.
    fn extend(&mut self, chain: &mut Chain) {
        while let (Some(start), Some(end)) = (chain.start(), chain.end()) {
            if distance(start, end) <= self.tolerance {
                return;
            }
            let Some(mut next) = self.take_at(end) else { return };
            let begins = next.start().map_or(f64::INFINITY, |start| distance(start, end));
            if begins > self.tolerance {
                next.turn();
            }
            chain.append(next);
        }
    }

    /// The first chain with an end at a place, which no longer waits then.
    fn take_at(&mut self, place: [f64; 3]) -> Option<Chain> {
        let [x, y, z] = self.cell(place);
        let near = |chain: &Chain| {
            [chain.start(), chain.end()].into_iter().flatten().any(|end| distance(end, place) <= self.tolerance)
        };
        let mut found: Option<usize> = None;
        for dx in -1..=1_i64 {
            for dy in -1..=1_i64 {
                for dz in -1..=1_i64 {
                    let cell = [x.saturating_add(dx), y.saturating_add(dy), z.saturating_add(dz)];
                    for &index in self.ends.get(&cell).map_or(&[][..], Vec::as_slice) {
                        let waits = self.chains[index].as_ref().is_some_and(near);
                        if waits && found.is_none_or(|first| index < first) {
                            found = Some(index);
                        }
                    }
                }
            }
        }
        self.chains[found?].take()
    }
}
