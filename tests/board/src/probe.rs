//! Watches the run between two instructions: what each tick costs, what it puts out, how deep its stack goes.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use rigless::emulator::{Driver, Hit, Host, Settled, Stop, Watch};
use rigless::machine::stm32h743_bench::Stm32h743Bench;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::VirtualNanos;
use shared::control::PathEnd;

use crate::Error;
use crate::calls::{Call, Calls};
use crate::image::{Image, Instruction, MAILBOX};
use crate::line::{Shared, Talker, lock};
use crate::machine::Machine;
use crate::machine::step_drivers::StepDrivers;
use crate::machine::wiring::Fault;

/// How often the run is looked at from outside, in virtual nanoseconds.
const LOOK: u64 = 1_000_000;

/// Bytes below the interrupt's first stack pointer that are painted before each tick; more than it may ever take.
const PAINTED: u32 = 2_048;

/// The stack is measured at every so manieth interrupt.
const PAINT_EVERY: u32 = 128;

/// How many instants of the handler's entry are kept.
const KEPT_ENTRIES: usize = 4_096;

const PAINT: u64 = 0xa5a5_5a5a;

/// What the processor itself stacks on an exception's entry with the floating point unit in use: 26 words, ARMv7-M section B1.5.7,
/// and one more where the stack was not aligned to eight bytes.
pub const EXCEPTION_FRAME: u32 = 108;

/// One tick of the job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tick {
    /// The setpoint, in units of `shared::fixed`.
    pub setpoint: [i32; 3],
    /// Instructions from the handler's first to its last, both counted.
    pub instructions: u32,
    /// Pieces of the job that were entered so far.
    pub pieces: u32,
    /// What each axis was told: a servo's command in mm/s as the bits of an f32, or a position in steps.
    pub outputs: [u32; 3],
}

/// Everything that was seen.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// The job's ticks, in order.
    pub ticks: Vec<Tick>,
    /// Every interrupt since the start, the job's or not.
    pub interrupts: u32,
    /// How many of them came before the job's first tick; the last of these took the job's start.
    pub idle: u32,
    /// The most instructions of any of them.
    pub worst: u32,
    /// The most stack that any of them used, without [`EXCEPTION_FRAME`].
    pub handler_stack: u32,
    /// Instants of the handler's first instruction, in ns; the first few.
    pub entries: Vec<u64>,
    /// How often each watched instruction ran, in the job's ticks that are counted: see [`Probe::count_instructions`].
    pub executed: BTreeMap<u32, u32>,
    /// How many ticks `executed` counts.
    pub counted_ticks: u32,
    /// Instructions of the interrupts before the first job's first tick.
    pub resting: Vec<u32>,
    /// Any setpoint, at any time, that was not at rest at the origin.
    pub moved: bool,
    /// Every change of the machine's status, and in which interrupt, counted from 0, the end of which is the instant in ns.
    pub statuses: Vec<(u32, u64, Status)>,
    /// Where the axes shall be and are, in machine coordinates, after the last interrupt.
    pub position: [[i32; 3]; 2],
    /// The axes whose position is known then; bit k is axis k.
    pub known: u8,
    /// When the controller was started again, in ns, and by what.
    pub restarts: Vec<(u64, String)>,
    /// The calls of a function that was watched: see [`Probe::count_calls`].
    pub calls: Vec<Call>,
}

/// What the mailbox says of the machine as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status {
    /// The number of `shared::safety::State`.
    pub machine: u32,
    /// What became of the path.
    pub path: PathEnd,
    /// What is wrong.
    pub fault: Option<shared::safety::Fault>,
}

/// Words of the mailbox that are of interest here, in its order.
#[derive(Clone, Copy, Debug)]
struct Mail {
    ticks: u32,
    pieces: u32,
    setpoint: [i32; 3],
    outputs: [u32; 3],
    status: Status,
}

/// The driver of a run.
pub struct Probe {
    talker: Shared<dyn Talker>,
    entry: u32,
    ends: Vec<u32>,
    mailbox: u64,
    stack: Range<u32>,
    deadline: VirtualNanos,
    counted: Vec<u32>,
    count_range: Range<u32>,
    pub(crate) calls: Option<Calls>,
    /// The instruction count at the handler's first instruction, while it runs.
    entered: Option<u64>,
    /// The stack pointer there.
    stack_pointer: Option<u32>,
    /// What ran since, of what is counted.
    ran: Vec<u32>,
    last_ticks: u32,
    /// What happens so many ns after the job's first tick.
    after: Vec<(u64, Fault)>,
    /// When the run ends, in ns after the job's first tick.
    end_after: Option<u64>,
    /// When the reset pin is pulled, in ns.
    restart_at: Option<u64>,
    /// The instant of what is looked at, in ns.
    at: u64,
    /// What hangs on the board's pins.
    pub machine: Machine,
    /// What was seen.
    pub seen: Seen,
}

impl Probe {
    /// A probe of `image` that ends the run when `talker` is done, or after `seconds` of virtual time.
    pub fn new(image: &Image, machine: Machine, talker: Shared<dyn Talker>, seconds: f64) -> Result<Self, Error> {
        let handler = image.tick_handler()?;
        let ends = image.instructions(handler).into_iter().filter(Instruction::is_return);
        Ok(Self {
            talker,
            entry: handler.range.start,
            ends: ends.map(|end| end.address).collect(),
            mailbox: u64::from(image.symbol(MAILBOX)?),
            stack: image.stack_bottom()?..image.stack_top()?,
            deadline: VirtualNanos((seconds * 1e9) as u64),
            counted: Vec::new(),
            count_range: 0..0,
            calls: None,
            entered: None,
            stack_pointer: None,
            ran: Vec::new(),
            last_ticks: 0,
            after: Vec::new(),
            end_after: None,
            machine,
            restart_at: None,
            at: 0,
            seen: Seen::default(),
        })
    }

    /// Counts each of `instructions` in the job's ticks `range`, counted from 0. The run is slow while it does.
    pub fn count_instructions(&mut self, instructions: Vec<u32>, range: Range<u32>) {
        self.counted = instructions;
        self.count_range = range;
    }

    /// Watches the calls of a function outside the tick. The run is slow while it is called.
    pub fn count_calls(&mut self, calls: Calls) {
        self.calls = Some(calls);
    }

    /// Looks at the pins of step drivers in every slot. The run is slow then.
    pub fn look_at_pins(&mut self) {
        self.machine.step_drivers = Some(StepDrivers::default());
    }

    /// Lets `fault` begin so many nanoseconds after the job's first tick, and holds it. [`Machine::switches`] takes instants since
    /// power-up.
    pub fn inject_after(&mut self, nanoseconds: u64, fault: Fault) {
        self.after.push((nanoseconds, fault));
    }

    /// Pulls the reset pin at the instant `at`, in ns since power-up.
    pub fn restart_at(&mut self, at: u64) {
        self.restart_at = Some(at);
    }

    /// Ends the run so many nanoseconds after the job's first tick.
    pub fn end_after(&mut self, nanoseconds: u64) {
        self.end_after = Some(nanoseconds);
    }

    /// Asks the session to stop where this probe wants to look, and to come back in time.
    pub fn watch(&self, session: &mut Session<Stm32h743Bench>) {
        let calls = self.calls.iter().flat_map(Calls::addresses);
        let all: BTreeSet<u32> =
            [self.entry].iter().chain(&self.ends).chain(&self.counted).chain(calls).copied().collect();
        for address in all {
            session.watch(Watch::Instruction(u64::from(address)));
        }
        session.run_until(VirtualNanos(LOOK));
    }

    fn hit(&mut self, host: &mut dyn Host, address: u32, hit: Hit) {
        if let Some(calls) = &mut self.calls {
            calls.hit(address, hit.instruction_count);
        }
        if address == self.entry {
            self.entered = Some(hit.instruction_count);
            self.ran.clear();
            if self.seen.entries.len() < KEPT_ENTRIES {
                self.seen.entries.push(hit.at.0);
            }
            self.paint(host);
        }
        let Some(entered) = self.entered else { return };
        if self.counted.len() > 1 {
            self.ran.push(address);
        }
        if self.ends.contains(&address) {
            self.entered = None;
            self.leave(host, (hit.instruction_count - entered + 1) as u32);
        }
    }

    /// The handler's last instruction is about to run: everything it had to do is done.
    fn leave(&mut self, host: &mut dyn Host, instructions: u32) {
        self.seen.interrupts += 1;
        self.seen.worst = self.seen.worst.max(instructions);
        self.measure_stack(host);
        let Some(mail) = self.read_mail(host) else { return };
        self.seen.moved |= mail.setpoint != [0; 3];
        if self.seen.statuses.last().is_none_or(|(_, _, before)| *before != mail.status) {
            self.seen.statuses.push((self.seen.interrupts - 1, self.at, mail.status));
        }
        // A new job starts to count from 1 again; between jobs the count stands.
        if mail.ticks != self.last_ticks && mail.ticks > 0 {
            let Mail { setpoint, pieces, outputs, .. } = mail;
            let tick = Tick { setpoint, instructions, pieces, outputs };
            if self.seen.ticks.is_empty() {
                self.seen.idle = self.seen.interrupts - 1;
            }
            if self.count_range.contains(&(self.seen.ticks.len() as u32)) {
                self.seen.counted_ticks += 1;
                for address in &self.ran {
                    *self.seen.executed.entry(*address).or_default() += 1;
                }
            }
            self.seen.ticks.push(tick);
        }
        if self.seen.ticks.is_empty() {
            self.seen.resting.push(instructions);
        }
        self.last_ticks = mail.ticks;
    }

    /// Paints the stack below the interrupted task, where nothing is alive: before each of the first interrupts, where a path
    /// begins, and then before some, since it takes longer than the tick itself.
    fn paint(&mut self, host: &mut dyn Host) {
        let wanted = self.seen.interrupts.is_multiple_of(PAINT_EVERY) || self.seen.ticks.len() < 8;
        self.stack_pointer = if wanted { stack_pointer(host, self.entry, &self.stack) } else { None };
        for address in self.painted() {
            // The stack is RAM; a write there cannot fail.
            let _ = host.write(address, Width::W32, PAINT);
        }
    }

    fn measure_stack(&mut self, host: &mut dyn Host) {
        let Some(top) = self.stack_pointer else { return };
        let used = self.painted().find(|&address| !matches!(host.read(address, Width::W32), Ok(PAINT)));
        if let Some(deepest) = used {
            self.seen.handler_stack = self.seen.handler_stack.max(top - deepest as u32);
        }
    }

    fn painted(&self) -> impl Iterator<Item = u64> + use<> {
        let top = self.stack_pointer.unwrap_or(0);
        let bottom = top.saturating_sub(PAINTED).max(self.stack.start);
        (bottom.min(top)..top).step_by(4).map(u64::from)
    }

    /// The mailbox, word by word in the order of `firmware/src/mailbox.rs`.
    fn read_mail(&mut self, host: &mut dyn Host) -> Option<Mail> {
        let mut word = |index: u64| host.read(self.mailbox + 4 * index, Width::W32).ok().map(|word| word as u32);
        let mut three = |from: u64| Some([word(from)?, word(from + 1)?, word(from + 2)?]);
        let signed = |words: [u32; 3]| words.map(|word| word as i32);
        let (setpoint, outputs) = (signed(three(4)?), three(10)?);
        let (position, actual) = (signed(three(19)?), signed(three(22)?));
        let status = Status {
            machine: word(15)?,
            path: PathEnd::from_word(word(16)?),
            fault: shared::safety::Fault::from_word(word(17)?),
        };
        let known = word(18)? as u8;
        let (ticks, pieces) = (word(2)?, word(3)?);
        self.seen.position = [position, actual];
        self.seen.known = known;
        Some(Mail { ticks, pieces, setpoint, outputs, status })
    }
}

impl Driver<Stm32h743Bench> for Probe {
    fn on_settled(&mut self, session: &mut Session<Stm32h743Bench>, host: &mut dyn Host, settled: Settled) {
        match settled {
            Settled::Hit(hit) => {
                self.at = hit.at.0;
                self.hit(host, hit.address as u32, hit);
                if !self.seen.ticks.is_empty() {
                    for (after, fault) in self.after.drain(..) {
                        self.machine.switches.inject(hit.at.0 + after, fault);
                    }
                    if let Some(after) = self.end_after.take() {
                        self.deadline = self.deadline.min(VirtualNanos(hit.at.0 + after));
                    }
                }
            }
            Settled::Access { access, value } => self.machine.see(session.board_mut(), &access, value),
            _ => return,
        }
        if let Some(next) = self.machine.next()
            && next < session.until().0
        {
            session.run_until(VirtualNanos(next));
        }
    }

    fn on_stop(
        &mut self,
        session: &mut Session<Stm32h743Bench>,
        stop: Stop,
        host: &mut dyn Host,
    ) -> Option<VirtualNanos> {
        self.machine.act(session.board_mut(), stop.at);
        if self.restart_at.is_some_and(|at| at <= stop.at.0) {
            self.restart_at = None;
            session.reset_by_pin(stop.at, stop.instruction_count, host);
        }
        let is_over = stop.at >= self.deadline || lock(&*self.talker).is_done();
        let look = stop.at.0 + LOOK;
        (!is_over).then(|| VirtualNanos(self.machine.next().map_or(look, |next| next.min(look))))
    }
}

/// The stack pointer at an instruction that is about to run.
///
/// The emulator shows registers to a debugger only; but a stop's saved state holds them: sixteen in a row, each as postcard writes a
/// word, the last of them the program counter. They are found by that, and a state of another form gives none.
fn stack_pointer(host: &mut dyn Host, program_counter: u32, stack: &Range<u32>) -> Option<u32> {
    let state = host.save_state().ok()?;
    (0..state.len().min(64)).find_map(|start| {
        let mut rest = state.get(start..)?;
        let mut registers = [0; 16];
        for register in &mut registers {
            *register = varint(&mut rest)?;
        }
        let [.., sp, _, pc] = registers;
        (pc == program_counter && sp > stack.start && sp <= stack.end).then_some(sp)
    })
}

/// A word of 32 bits as postcard writes it: seven bits a byte, the lowest first.
fn varint(bytes: &mut &[u8]) -> Option<u32> {
    let mut value = 0_u32;
    for shift in (0..35).step_by(7) {
        let (&byte, rest) = bytes.split_first()?;
        *bytes = rest;
        value |= u32::from(byte & 0x7f).checked_shl(shift)?;
        if byte & 0x80 == 0 {
            return Some(value);
        }
    }
    None
}
