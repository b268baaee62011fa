//! Chains whose ends meet become one: a drawing has its curves in any order and direction.
//!
//! In the order of the drawing each chain that is not closed is continued at its end and then at its start, as far as it
//! goes; where more than two ends meet, the first of the drawing goes on. Ends are found in a grid of cells no smaller than
//! the tolerance, so that the time grows with the number of curves and not with its square.

use std::collections::{HashMap, VecDeque};

use super::curve::{Chain, distance};

/// Cells of a finer grid would have numbers that cannot be told apart for far places.
const FINEST: f64 = 1e-9;

type Cell = [i64; 3];

/// Chains that wait, and where their ends are.
struct Loose {
    chains: Vec<Option<Chain>>,
    /// In the order of the drawing, some of those that no longer wait among them.
    ends: HashMap<Cell, VecDeque<usize>>,
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
                loose.ends.entry(loose.cell(place)).or_default().push_back(index);
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
        let tolerance = self.tolerance;
        let near = |chain: &Chain| {
            [chain.start(), chain.end()].into_iter().flatten().any(|end| distance(end, place) <= tolerance)
        };
        let mut found: Option<usize> = None;
        for dx in -1..=1_i64 {
            for dy in -1..=1_i64 {
                for dz in -1..=1_i64 {
                    let cell = [x.saturating_add(dx), y.saturating_add(dy), z.saturating_add(dz)];
                    let Some(ends) = self.ends.get_mut(&cell) else { continue };
                    // However many ends there are in one place, each is passed over once.
                    while ends.front().is_some_and(|&index| self.chains[index].is_none()) {
                        ends.pop_front();
                    }
                    let first = ends.iter().copied().find(|&index| self.chains[index].as_ref().is_some_and(near));
                    found = found.into_iter().chain(first).min();
                }
            }
        }
        self.chains[found?].take()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::drawing::curve::Curve;
    use proptest::prelude::*;

    fn line(from: [f64; 3], to: [f64; 3]) -> Chain {
        Chain(vec![Curve::line(from, to)])
    }

    proptest! {
        /// A path that is cut up, shuffled and turned is one chain again; without cuts it has the same places.
        #[test]
        fn a_shuffled_path_is_one_chain(
            keys in prop::collection::vec((any::<u32>(), any::<bool>()), 1..60),
            closed in any::<bool>(),
        ) {
            let count = keys.len();
            // On a parabola no two places are one.
            let at = |k: usize| if closed && k == count { [0.0; 3] } else { [k as f64, (k * k) as f64, 1e-7 * (k % 3) as f64] };
            let mut pieces: Vec<_> = keys.into_iter().enumerate().map(|(k, (key, turn))| {
                let mut chain = line(at(k), at(k + 1));
                if turn {
                    chain.turn();
                }
                (key, chain)
            }).collect();
            pieces.sort_by_key(|(key, _)| *key);
            let joined = join(pieces.into_iter().map(|(_, chain)| chain).collect(), 1e-6);
            prop_assert_eq!(joined.len(), 1);
            prop_assert_eq!(joined[0].0.len(), count);
            prop_assert!(joined[0].0.windows(2).all(|pair| pair[0].to() == pair[1].from));
            prop_assert!(!closed || count < 3 || joined[0].start() == joined[0].end());
        }
    }

    /// Many ends in one place take no time that grows with their square: this is over at once.
    #[test]
    fn a_star_is_half_as_many_chains() {
        let count = 100_000;
        let rays = (0..count).map(|k| line([0.0; 3], [1.0 + k as f64, 1.0, 0.0])).collect();
        assert_eq!(join(rays, 1e-6).len(), count / 2);
    }
}
