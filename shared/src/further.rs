//! Axes beside the plane: Z and others, which move with a piece and linearly in its arc length. An arc with a travel in Z is a
//! helix.
//!
//! With u the covered fraction of the piece's length on C, a further axis is at to - (1 - u) way: exactly at `to` in the end. In f32
//! that is good to 12 nm on 200 mm; on a PH curve, where u is a quintic, to four roundoffs, 50 nm (test
//! `four_axes_follow_the_arc_length_of_a_curve`).

use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeTuple;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::fixed::{Fixed, Position};
use crate::real::Real;

/// Where `F` further axes begin and end a piece, exactly: what is sent, so that a chain of pieces adds up no errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Travel<const F: usize = 1> {
    /// Where the axes are at the start.
    pub from: [Fixed; F],
    /// Where they are at the end.
    pub to: [Fixed; F],
}

impl<const F: usize> Travel<F> {
    /// Whether all of it is within the range of machine coordinates.
    pub fn is_in_reach(&self) -> bool {
        self.from.iter().chain(&self.to).all(|c| c.is_in_reach())
    }
}

/// As 2 F coordinates, the first ones first: serde knows no arrays of any length.
impl<const F: usize> Serialize for Travel<F> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(2 * F)?;
        for coordinate in self.from.iter().chain(&self.to) {
            tuple.serialize_element(coordinate)?;
        }
        tuple.end()
    }
}

impl<'de, const F: usize> Deserialize<'de> for Travel<F> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Coordinates<const F: usize>;

        impl<'de, const F: usize> Visitor<'de> for Coordinates<F> {
            type Value = Travel<F>;

            fn expecting(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                write!(f, "{} coordinates", 2 * F)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Travel<F>, A::Error> {
                let mut travel = Travel { from: [Fixed(0); F], to: [Fixed(0); F] };
                for (k, coordinate) in travel.from.iter_mut().chain(&mut travel.to).enumerate() {
                    *coordinate = seq.next_element()?.ok_or_else(|| A::Error::invalid_length(k, &self))?;
                }
                Ok(travel)
            }
        }

        deserializer.deserialize_tuple(2 * F, Coordinates)
    }
}

/// A [`Travel`] as the tick uses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear<T, const F: usize> {
    to: [Fixed; F],
    way: [T; F],
}

impl<T: Real, const F: usize> Linear<T, F> {
    /// Prepares coordinates that are within reach. Load time.
    pub fn activate(travel: &Travel<F>) -> Self {
        let mut linear = Self { to: travel.to, way: [T::ZERO; F] };
        for ((way, from), to) in linear.way.iter_mut().zip(travel.from).zip(travel.to) {
            *way = to.minus(from);
        }
        linear
    }

    /// Where the axes are with the fraction `rest` of the piece's length to go.
    #[inline(always)]
    pub fn before_end(&self, rest: T) -> [Fixed; F] {
        let mut at = self.to;
        for (coordinate, way) in at.iter_mut().zip(self.way) {
            *coordinate = coordinate.offset_by(-(way * rest));
        }
        at
    }

    /// Where the axes are at the end, to the unit.
    #[inline(always)]
    pub fn end(&self) -> [Fixed; F] {
        self.to
    }

    /// How far the first axis goes, in mm; none where there is none.
    pub fn first_way(&self) -> Option<T> {
        self.way.first().copied()
    }

    /// The length of the way of all axes together, in mm. Load time.
    pub fn length(&self) -> T {
        self.way.iter().fold(T::ZERO, |sum, way| sum + *way * *way).sqrt()
    }
}

/// A setpoint of a machine with `F` axes beside its plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setpoint<const F: usize = 1> {
    /// x and y.
    pub plane: [Fixed; 2],
    /// z and whatever follows it.
    pub further: [Fixed; F],
}

impl From<Setpoint> for Position {
    #[inline(always)]
    fn from(setpoint: Setpoint) -> Self {
        let Setpoint { plane: [x, y], further: [z] } = setpoint;
        [x, y, z]
    }
}

impl From<Position> for Setpoint {
    #[inline(always)]
    fn from([x, y, z]: Position) -> Self {
        Self { plane: [x, y], further: [z] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four further axes are eight coordinates on the wire and nothing else, and come back.
    #[test]
    fn a_travel_is_its_coordinates() {
        let travel = Travel { from: [1, -2, 3, i32::MIN].map(Fixed), to: [5, 6, i32::MAX, 0].map(Fixed) };
        let mut buffer = [0; 64];
        let bytes = postcard::to_slice(&travel, &mut buffer).unwrap();
        let mut plain = [0; 64];
        let expected = [1, -2, 3, i32::MIN, 5, 6, i32::MAX, 0];
        assert_eq!(bytes, postcard::to_slice(&expected, &mut plain).unwrap());
        assert_eq!(postcard::from_bytes::<Travel<4>>(bytes), Ok(travel));
        assert!(postcard::from_bytes::<Travel<4>>(&bytes[..bytes.len() - 1]).is_err());
        assert!(!travel.is_in_reach());
    }

    /// The end to the unit; the start and the middle to one unit in f64, in which a roundoff of 8 m is none.
    #[test]
    fn the_ends_are_met() {
        for (from, to) in [(0, 7), (-1_000_001, 52_428_800), (1_048_000_000, -1_048_000_000), (5, 5)] {
            let linear = Linear::<f64, 1>::activate(&Travel { from: [Fixed(from)], to: [Fixed(to)] });
            for (rest, expected) in [(1.0, from), (0.0, to), (0.5, from + (to - from) / 2)] {
                assert!((linear.before_end(rest)[0].0 - expected).abs() <= 1, "{from}..{to} with {rest} to go");
            }
            assert_eq!((linear.end(), linear.before_end(0.0)), ([Fixed(to)], [Fixed(to)]));
        }
    }
}
