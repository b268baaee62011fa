//! What the tick can call, or another function, from the machine code of the linked image.
//!
//! From the interrupt's handler, every direct call and every jump out of a function is followed. Calls through a register cannot be: they
//! are listed, and a tick has to do without them. A jump through a table stays in its function and is none.

use std::collections::{BTreeMap, BTreeSet};

use crate::Error;
use crate::image::{Function, Image, Instruction};

/// What was found.
#[derive(Clone, Debug, Default)]
pub struct Reach {
    /// Every function that can be reached, the first one first.
    pub functions: Vec<Function>,
    /// Where a call goes through a register: the function and the address.
    pub indirect: Vec<(String, u32)>,
    /// Calls into something that is no function of the symbol table.
    pub unknown: Vec<u32>,
}

impl Reach {
    /// Follows every call from the tick's handler.
    pub fn of_tick(image: &Image) -> Result<Self, Error> {
        Ok(Self::of(image, image.tick_handler()?))
    }

    /// Follows every call from `function`.
    pub fn of(image: &Image, function: &Function) -> Self {
        let mut reach = Self::default();
        let mut seen = BTreeSet::new();
        let mut waiting = vec![function.clone()];
        while let Some(function) = waiting.pop() {
            if !seen.insert(function.range.start) {
                continue;
            }
            for instruction in image.instructions(&function) {
                match transfer(&instruction) {
                    Some(Transfer::Indirect) => reach.indirect.push((function.name.clone(), instruction.address)),
                    Some(Transfer::To(target)) if !function.range.contains(&target) => {
                        match image.function_at(target) {
                            Some(called) => waiting.push(called.clone()),
                            None => reach.unknown.push(target),
                        }
                    }
                    _ => {}
                }
            }
            reach.functions.push(function);
        }
        reach
    }

    /// Reached functions that no tick may reach: double precision in software, and everything that panics.
    pub fn forbidden(&self) -> Vec<&str> {
        let is_forbidden = |name: &&str| {
            name.starts_with("__aeabi_d")
                || ["__adddf3", "__subdf3", "__muldf3", "__divdf3"].iter().any(|double| name.contains(double))
                || ["panic", "unwrap_failed", "expect_failed", "slice_index", "slice_start", "slice_end"]
                    .iter()
                    .any(|word| name.contains(word))
        };
        self.functions.iter().map(|function| function.name.as_str()).filter(is_forbidden).collect()
    }

    /// All instructions that can be reached.
    pub fn instructions(&self, image: &Image) -> Vec<u32> {
        let all = self.functions.iter().flat_map(|function| image.instructions(function));
        all.map(|instruction| instruction.address).collect()
    }

    /// Bytes of code of each reached function.
    pub fn sizes(&self) -> BTreeMap<&str, u32> {
        self.functions
            .iter()
            .map(|function| (function.name.as_str(), function.range.end - function.range.start))
            .collect()
    }
}

enum Transfer {
    To(u32),
    Indirect,
}

/// Where an instruction may go besides the next one; section A7.7 of the ARMv7-M manual has the encodings.
fn transfer(instruction: &Instruction) -> Option<Transfer> {
    let Instruction { address, first, second } = *instruction;
    let from = address.wrapping_add(4);
    let Some(second) = second else {
        return match first {
            // B<c>: eight bits of halfwords; conditions 14 and 15 are UDF and SVC.
            _ if first & 0xf000 == 0xd000 && first & 0x0e00 != 0x0e00 => {
                Some(Transfer::To(from.wrapping_add_signed(i32::from(first as u8 as i8) * 2)))
            }
            // B: eleven bits of halfwords.
            _ if first & 0xf800 == 0xe000 => {
                Some(Transfer::To(from.wrapping_add_signed(sign_extend(first & 0x7ff, 11) * 2)))
            }
            // BLX Rm, and BX Rm other than the link register.
            _ if first & 0xff87 == 0x4780 || first & 0xff87 == 0x4700 && first != 0x4770 => Some(Transfer::Indirect),
            // MOV PC, Rm.
            _ if first & 0xff87 == 0x4687 => Some(Transfer::Indirect),
            _ => None,
        };
    };
    if first & 0xf800 != 0xf000 || second & 0x8000 == 0 {
        // LDR.W PC, [..] other than a return's.
        let loads_pc = first & 0xff70 == 0xf850 && second & 0xf000 == 0xf000 && !instruction.is_return();
        return loads_pc.then_some(Transfer::Indirect);
    }
    let (s, j1, j2) = (u32::from(first >> 10 & 1), u32::from(second >> 13 & 1), u32::from(second >> 11 & 1));
    let low = u32::from(second & 0x7ff);
    if second & 0x5000 == 0x0000 {
        // B<c>.W, unless it is one of the system instructions that share the encoding.
        let condition = first >> 6 & 0xf;
        let high = u32::from(first & 0x3f);
        let offset = s << 19 | j2 << 18 | j1 << 17 | high << 11 | low;
        return (condition < 14).then(|| Transfer::To(from.wrapping_add_signed(sign_extend_wide(offset, 20) * 2)));
    }
    // B.W, BL: 24 bits of halfwords, two of them mixed with the sign.
    let (i1, i2) = (1 ^ j1 ^ s, 1 ^ j2 ^ s);
    let offset = s << 23 | i1 << 22 | i2 << 21 | u32::from(first & 0x3ff) << 11 | low;
    Some(Transfer::To(from.wrapping_add_signed(sign_extend_wide(offset, 24) * 2)))
}

fn sign_extend(value: u16, bits: u32) -> i32 {
    sign_extend_wide(u32::from(value), bits)
}

fn sign_extend_wide(value: u32, bits: u32) -> i32 {
    ((value << (32 - bits)) as i32) >> (32 - bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target(address: u32, first: u16, second: Option<u16>) -> Option<u32> {
        match transfer(&Instruction { address, first, second }) {
            Some(Transfer::To(target)) => Some(target),
            _ => None,
        }
    }

    /// Encodings as an assembler writes them.
    #[test]
    fn branches_are_followed() {
        // b .; b .-6; beq .+8; bl .+0x1000; bl .-0x1000; b.w .+0x2000; bne.w .+0x100
        assert_eq!(target(0x100, 0xe7fe, None), Some(0x100));
        assert_eq!(target(0x100, 0xe7fb, None), Some(0xfa));
        assert_eq!(target(0x100, 0xd002, None), Some(0x108));
        assert_eq!(target(0x0800_0000, 0xf000, Some(0xfffe)), Some(0x0800_1000));
        assert_eq!(target(0x0800_2000, 0xf7fe, Some(0xfffe)), Some(0x0800_1000));
        assert_eq!(target(0x100, 0xf001, Some(0xbffe)), Some(0x2100));
        assert_eq!(target(0x100, 0xf040, Some(0x807e)), Some(0x200));
        // movw r0, #0 and udf are none; blx r3 and bx r2 go who knows where; bx lr returns.
        assert!(transfer(&Instruction { address: 0, first: 0xf240, second: Some(0) }).is_none());
        assert!(transfer(&Instruction { address: 0, first: 0xde00, second: None }).is_none());
        assert!(matches!(transfer(&Instruction { address: 0, first: 0x4798, second: None }), Some(Transfer::Indirect)));
        assert!(matches!(transfer(&Instruction { address: 0, first: 0x4710, second: None }), Some(Transfer::Indirect)));
        assert!(transfer(&Instruction { address: 0, first: 0x4770, second: None }).is_none());
    }
}
