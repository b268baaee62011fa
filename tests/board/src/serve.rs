//! The virtual board behind a TCP listener, so that everything that speaks to a board can be tried without one.

use std::net::TcpListener;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

use rigless::emulator::{Driver, Host, Settled, Stop};
use rigless::machine::stm32h743_bench::Stm32h743Bench;
use rigless::session::Session;
use rigless::time::VirtualNanos;

use crate::Error;
use crate::image::Image;
use crate::line::{POWER_UP_US, Shared, lock, share};
use crate::machine::{Machine, Mounting};
use crate::run::{board, execute};
use crate::socket::{Socket, Traffic, Wire};

/// How often the socket is looked at, and virtual time held against real time, in virtual nanoseconds.
const LOOK: u64 = 1_000_000;

/// How far a board that is not paced may run ahead of a host that says nothing, in virtual nanoseconds. A controller whose host was
/// silent for 1.5 s takes it to have vanished; a host asks for the status four times a second of its own time.
const AHEAD: u64 = 1_000_000_000;

/// Real time that cannot be caught up with any more is let go.
const BEHIND: Duration = Duration::from_millis(50);

/// How the board's time passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// As fast as a clock on the wall, or slower where the emulator is.
    Real,
    /// As fast as it goes while a host speaks; as the wall's otherwise.
    Fast,
}

/// What a service came to.
#[derive(Clone, Copy, Debug)]
pub struct Served {
    /// What passed over the line.
    pub traffic: Traffic,
    /// Virtual seconds.
    pub virtual_s: f64,
    /// Real seconds.
    pub real_s: f64,
}

/// Runs `image` in its `mounting` with whoever connects to `listener` at the far end of its line, until `ended` is set or `limit` has passed.
///
/// Errors: what the firmware did that it must not, such as a reset by its watchdog.
pub fn serve(
    image: &Image,
    mounting: &Mounting,
    listener: TcpListener,
    pace: Pace,
    limit: Option<Duration>,
    ended: Arc<AtomicBool>,
) -> Result<Served, Error> {
    let failed = |error: &dyn std::fmt::Display| Error::new(format!("the listener: {error}"));
    let socket = share(Socket::new(listener).map_err(|error| failed(&error))?);
    let machine = mounting.machine()?;
    let mut session = board(Wire(socket.clone()), &machine)?;
    session.run_until(VirtualNanos(POWER_UP_US * 1_000));
    let start = Instant::now();
    let keeper = Keeper {
        socket: socket.clone(),
        pace,
        ended,
        end: limit.map(|limit| start + limit),
        clock: None,
        heard: 0,
        now: 0,
        look: POWER_UP_US * 1_000,
        machine,
    };
    let (keeper, _) = execute(image, mounting, session, keeper)?;
    let traffic = lock(&socket).traffic();
    Ok(Served { traffic, virtual_s: keeper.now as f64 * 1e-9, real_s: start.elapsed().as_secs_f64() })
}

/// The driver of a served board.
struct Keeper {
    socket: Shared<Socket>,
    pace: Pace,
    ended: Arc<AtomicBool>,
    end: Option<Instant>,
    /// A virtual instant and when it was; paces what comes after.
    clock: Option<(u64, Instant)>,
    /// When the host was last heard, in ns.
    heard: u64,
    now: u64,
    /// When to look at the socket next, in ns.
    look: u64,
    machine: Machine,
}

impl Keeper {
    /// Waits until it is `now` on the wall, too.
    fn hold(&mut self, now: u64) {
        let (from, at) = *self.clock.get_or_insert_with(|| (now, Instant::now()));
        let due = at + Duration::from_nanos(now - from);
        match due.checked_duration_since(Instant::now()) {
            Some(early) => sleep(early),
            None if due.elapsed() > BEHIND => self.clock = None,
            None => {}
        }
    }
}

impl Driver<Stm32h743Bench> for Keeper {
    fn on_settled(&mut self, session: &mut Session<Stm32h743Bench>, _: &mut dyn Host, settled: Settled) {
        let Settled::Access { access, value } = settled else { return };
        self.machine.see(session.board_mut(), &access, value);
        if let Some(next) = self.machine.next()
            && next < session.until().0
        {
            session.run_until(VirtualNanos(next));
        }
    }

    fn on_stop(&mut self, session: &mut Session<Stm32h743Bench>, stop: Stop, _: &mut dyn Host) -> Option<VirtualNanos> {
        self.now = stop.at.0;
        self.machine.act(session.board_mut(), stop.at);
        let next = |look: u64, machine: &Machine| VirtualNanos(machine.next().map_or(look, |next| next.min(look)));
        if self.now < self.look {
            return Some(next(self.look, &self.machine));
        }
        if self.ended.load(Ordering::Relaxed) || self.end.is_some_and(|end| Instant::now() >= end) {
            return None;
        }
        let look = lock(&self.socket).look();
        if look.heard {
            self.heard = self.now;
        }
        if self.pace == Pace::Fast && look.connected && self.now - self.heard < AHEAD {
            self.clock = None;
        } else {
            self.hold(self.now);
        }
        self.look = self.now + LOOK;
        Some(next(self.look, &self.machine))
    }
}
