//! One number for all setpoints of a run, by which two machines can tell that they moved alike.

use crate::fixed::Fixed;

/// FNV-1a with 64 bits [Fowler, Noll & Vo], taking a coordinate of 32 bits at a time instead of an octet: a third of a tick's hash is
/// then one exclusive-or and one multiplication.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetpointHash(u64);

impl SetpointHash {
    /// The hash of no setpoints.
    pub const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Takes in the setpoint of one tick: the coordinates of all axes in turn.
    #[inline(always)]
    pub fn add(&mut self, setpoint: impl IntoIterator<Item = Fixed>) {
        for coordinate in setpoint {
            self.0 = (self.0 ^ u64::from(coordinate.0 as u32)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// The hash of all setpoints so far.
    pub const fn value(self) -> u64 {
        self.0
    }
}

impl Default for SetpointHash {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixed::Fixed;

    fn hash(setpoints: &[[i32; 3]]) -> u64 {
        let mut hash = SetpointHash::new();
        for setpoint in setpoints {
            hash.add(setpoint.map(Fixed));
        }
        hash.value()
    }

    /// Coordinates that are octets make it plain FNV-1a, whose test vectors are published: "", "abc" and "foobar".
    #[test]
    fn octets_give_the_published_vectors() {
        let [a, b, c, f, o, r] = (*b"abcfor").map(i32::from);
        assert_eq!(hash(&[]), 0xcbf2_9ce4_8422_2325);
        assert_eq!(hash(&[[a, b, c]]), 0xe71f_a219_0541_574b);
        assert_eq!(hash(&[[f, o, o], [b, a, r]]), 0x8594_4171_f739_67e8);
    }

    /// A negative coordinate is taken as its 32 bits, not extended to 64: the definition, in arithmetic that cannot wrap.
    #[test]
    fn negative_coordinates_are_32_bits() {
        let step = |hash: u128, word: u128| ((hash ^ word) * 0x0000_0100_0000_01b3) % (1 << 64);
        let expected = [1, 0, 0xffff_ffff].into_iter().fold(0xcbf2_9ce4_8422_2325, step);
        assert_eq!(u128::from(hash(&[[1, 0, -1]])), expected);
    }
}
