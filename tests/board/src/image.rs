//! The linked image: what is where in it.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};
use serde::Serialize;

use crate::Error;

/// The handler of the tick's interrupt; the PAC names interrupts after their peripherals.
pub const TICK_HANDLER: &str = "TIM2";

/// Where the tick leaves its results; see `firmware/src/mailbox.rs`.
pub const MAILBOX: &str = "HODOGRAPH_MAILBOX";

/// Where the program looks for a machine that it was sent before a restart; see `firmware/src/restart.rs`.
pub const PENDING: &str = "HODOGRAPH_PENDING";

/// A function of the image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Function {
    /// Its name, demangled.
    pub name: String,
    /// Its bytes in flash.
    pub range: Range<u32>,
}

/// One instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// Where it is.
    pub address: u32,
    /// Its first halfword.
    pub first: u16,
    /// Its second halfword, of one that has 32 bits.
    pub second: Option<u16>,
}

impl Instruction {
    /// Whether it ends a function by loading the program counter from the link register or the stack.
    pub fn is_return(&self) -> bool {
        match self.second {
            // BX LR; POP {.., PC}
            None => self.first == 0x4770 || self.first & 0xff00 == 0xbd00,
            // POP.W {.., PC}; LDR PC, [SP], #4
            Some(second) => {
                self.first == 0xe8bd && second & 0x8000 != 0 || self.first == 0xf85d && second & 0xf000 == 0xf000
            }
        }
    }
}

/// An ELF file of the firmware.
#[derive(Clone, Debug)]
pub struct Image {
    path: PathBuf,
    functions: BTreeMap<u32, Function>,
    symbols: BTreeMap<String, u32>,
    /// Places where code (true) or data (false) begins, from the mapping symbols.
    mapping: BTreeMap<u32, bool>,
    sections: Vec<Section>,
}

#[derive(Clone, Debug)]
struct Section {
    name: String,
    address: u32,
    size: u32,
    is_stored: bool,
    data: Vec<u8>,
}

/// Memory that an image takes, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Sizes {
    /// Flash: vectors, code, constants, and the start values of variables.
    pub flash: u32,
    /// RAM without the stack.
    pub ram: u32,
}

impl Image {
    /// Reads the file at `path`.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let failed = |error: &dyn std::fmt::Display| Error::new(format!("{}: {error}", path.display()));
        let bytes = std::fs::read(path).map_err(|error| failed(&error))?;
        let file = object::File::parse(&*bytes).map_err(|error| failed(&error))?;
        let (mut functions, mut symbols, mut mapping) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
        for symbol in file.symbols() {
            let Ok(name) = symbol.name() else { continue };
            let address = symbol.address() as u32;
            match name.get(..2) {
                Some("$t") => mapping.insert(address, true),
                Some("$d") => mapping.insert(address, false),
                _ => None,
            };
            if symbol.kind() == SymbolKind::Text && symbol.size() > 0 {
                let start = address & !1;
                let name = demangle(name);
                functions.insert(start, Function { name, range: start..start + symbol.size() as u32 });
            }
            symbols.insert(name.to_owned(), address);
        }
        let sections = file
            .sections()
            .filter(|section| is_loaded(section.flags()) && section.size() > 0)
            .map(|section| Section {
                name: section.name().unwrap_or_default().to_owned(),
                address: section.address() as u32,
                size: section.size() as u32,
                is_stored: section.file_range().is_some(),
                data: section.data().unwrap_or_default().to_vec(),
            })
            .collect();
        Ok(Self { path: path.to_owned(), functions, symbols, mapping, sections })
    }

    /// Where the file is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The address of a symbol.
    pub fn symbol(&self, name: &str) -> Result<u32, Error> {
        let found = self.symbols.get(name).copied();
        found.ok_or_else(|| Error::new(format!("{} has no symbol {name}", self.path.display())))
    }

    /// The function at or around `address`.
    pub fn function_at(&self, address: u32) -> Option<&Function> {
        let (_, function) = self.functions.range(..=address).next_back()?;
        function.range.contains(&address).then_some(function)
    }

    /// The function of this name, as a person writes it.
    pub fn function_named(&self, name: &str) -> Result<&Function, Error> {
        let found = self.functions.values().find(|function| function.name == name);
        found.ok_or_else(|| Error::new(format!("{} has no function {name}", self.path.display())))
    }

    /// The handler of the tick's interrupt.
    pub fn tick_handler(&self) -> Result<&Function, Error> {
        let address = self.symbol(TICK_HANDLER)? & !1;
        self.function_at(address).ok_or_else(|| Error::new("the tick's handler has no code"))
    }

    /// The instructions of a function, without the constants between them.
    pub fn instructions(&self, function: &Function) -> Vec<Instruction> {
        let mut found = Vec::new();
        let mut address = function.range.start;
        while address < function.range.end {
            let is_code = self.mapping.range(..=address).next_back().is_none_or(|(_, &code)| code);
            let Some(first) = self.halfword(address) else { break };
            if !is_code {
                address += 2;
                continue;
            }
            // A3.1 of the ARMv7-M manual: these three prefixes open a pair.
            let second = if first >> 11 >= 0b11101 { self.halfword(address + 2) } else { None };
            found.push(Instruction { address, first, second });
            address += if second.is_some() { 4 } else { 2 };
        }
        found
    }

    /// The word at `address`, of what is stored in flash.
    pub fn word(&self, address: u32) -> Option<u32> {
        Some(u32::from(self.halfword(address)?) | u32::from(self.halfword(address + 2)?) << 16)
    }

    fn halfword(&self, address: u32) -> Option<u16> {
        let section =
            self.sections.iter().find(|s| s.is_stored && (s.address..s.address + s.size).contains(&address))?;
        let at = (address - section.address) as usize;
        Some(u16::from_le_bytes([*section.data.get(at)?, *section.data.get(at + 1)?]))
    }

    /// Where the initial stack pointer is: the top of the stack.
    pub fn stack_top(&self) -> Result<u32, Error> {
        self.symbol("_stack_start")
    }

    /// Where the stack must end at the latest.
    pub fn stack_bottom(&self) -> Result<u32, Error> {
        self.symbol("_stack_end")
    }

    /// Memory that the image takes.
    pub fn sizes(&self) -> Sizes {
        let is_ram = |section: &&Section| section.address >= 0x2000_0000;
        let sum = |sections: &mut dyn Iterator<Item = &Section>| sections.map(|section| section.size).sum();
        let flash = sum(&mut self.sections.iter().filter(|s| s.is_stored && (!is_ram(s) || s.name == ".data")));
        let ram = sum(&mut self.sections.iter().filter(is_ram));
        Sizes { flash, ram }
    }
}

fn is_loaded(flags: object::SectionFlags) -> bool {
    matches!(flags, object::SectionFlags::Elf { sh_flags, .. } if sh_flags.0 & object::elf::SHF_ALLOC.0 != 0)
}

/// A name as a person writes it.
fn demangle(name: &str) -> String {
    addr2line::demangle_auto(name.into(), None).into_owned()
}
