//! One image, one conversation, until it ends.

use std::path::Path;

use rigless::chip::uart::Peer;
use rigless::device::ResetCause;
use rigless::emulator::{Driver, Start, run as emulate};
use rigless::image::Image as Placed;
use rigless::machine::stm32h743_bench::Stm32h743Bench;
use rigless::session::Session;
use rigless::soc::stm32h743::peripherals::usart;
use rigless::time::VirtualNanos;
use shared::piece::{Header, Piece};

use crate::Error;
use crate::image::{Image, PENDING};
use crate::line::{JobTalker, Line, Shared, Talker, lock, share};
use crate::machine::{Machine, Mounting};
use crate::probe::{Probe, Seen, Tick};

/// The port that the firmware's link uses: the ST-Link's.
const PORT: &str = "USART3";

/// Where the factory writes the size of the flash, and what that is in KiB; RM0433 rev 9 section 61.2.
const FLASH_SIZE: u32 = 0x1ff1_e880;
const FLASH_KIB: u16 = 2_048;

/// Marks a machine that was sent before a restart; see `firmware/src/restart.rs`.
const IMAGE_MARK: u32 = 0x4d41_4348;

/// Virtual time that a job may take beyond what it was expected to.
const PATIENCE_S: f64 = 30.0;

/// A job's run.
pub struct JobRun {
    /// What was seen.
    pub seen: Seen,
    /// The machine as the run left it.
    pub machine: Machine,
    /// What the controller reported at the end: ticks, residual time in s, hash of the setpoints.
    pub finished: (u32, f32, u64),
    /// Commands that had to be sent again.
    pub resent: u32,
    /// The most stack that the whole program used, in bytes, by its own measure.
    pub stack: u32,
}

/// Runs `image` in its `mounting` with `talker` at the far end of its line, until the talker is done or `seconds` of virtual time have passed.
///
/// `prepare` may ask the probe for more than it does by itself.
pub fn run(
    image: &Image,
    mounting: &Mounting,
    talker: Shared<dyn Talker>,
    seconds: f64,
    prepare: impl FnOnce(&mut Probe),
) -> Result<(Seen, Machine), Error> {
    let machine = mounting.machine()?;
    let mut session = board(Line::new(talker.clone()), &machine)?;
    let mut probe = Probe::new(image, machine, talker, seconds)?;
    prepare(&mut probe);
    probe.watch(&mut session);
    let (Probe { mut seen, machine, calls, .. }, restarts) = execute(image, mounting, session, probe)?;
    seen.restarts = restarts;
    seen.calls = calls.map(|calls| calls.seen).unwrap_or_default();
    Ok((seen, machine))
}

/// A board in a machine, with `peer` at the far end of its line, before its first instruction.
pub(crate) fn board(peer: impl Peer, machine: &Machine) -> Result<Session<Stm32h743Bench>, Error> {
    let mut bench = Stm32h743Bench::new().map_err(|error| failed(&error))?;
    let nth = usart::INSTANCES.iter().position(|&name| name == PORT);
    let nth = nth.ok_or_else(|| Error::new(format!("the virtual board has no {PORT}")))?;
    bench.mcu.usart[nth].attach(peer);
    machine.switches.power_up(&mut bench);
    Session::new(Box::new(bench), 0, VirtualNanos(0)).map_err(|error| failed(&error))
}

/// Runs `image` until `driver` ends the run, and gives the driver back, with the restarts that somebody has asked for: the program, or the
/// reset pin. Errors: what the firmware did that it must not.
pub(crate) fn execute<R: Driver<Stm32h743Bench> + 'static>(
    image: &Image,
    mounting: &Mounting,
    session: Session<Stm32h743Bench>,
    driver: R,
) -> Result<(R, Vec<(u64, String)>), Error> {
    let place = |name: &str, bytes: Vec<u8>, at: u32| {
        Placed::new(Path::new(name), bytes, Some(at.into())).map_err(|error| failed(&error))
    };
    let mut images = vec![Placed::read(image.path(), None).map_err(|error| failed(&error))?];
    images.push(place("factory", FLASH_KIB.to_le_bytes().to_vec(), FLASH_SIZE)?);
    if !mounting.image.is_empty() {
        let words = [IMAGE_MARK, 0].iter().flat_map(|word| word.to_le_bytes());
        images.push(place("machine", words.chain(mounting.image.iter().copied()).collect(), image.symbol(PENDING)?)?);
    }
    let mut finished = emulate(session, &Start::new(&images), driver).map_err(|error| failed(&error))?;
    if let Some(error) = finished.session.take_error() {
        return Err(failed(&error));
    }
    if let Some(first) = finished.session.unmapped().first() {
        return Err(Error::new(format!("the firmware left its memory: {first}")));
    }
    let resets = finished.session.resets();
    if let Some(reset) = resets.iter().find(|reset| !matches!(reset.cause, ResetCause::Core | ResetCause::Pin)) {
        return Err(Error::new(format!("the controller was reset at {} ns by {:?}", reset.at.0, reset.cause)));
    }
    let restarts = resets.iter().map(|reset| (reset.at.0, format!("{:?}", reset.cause))).collect();
    Ok((finished.driver, restarts))
}

fn failed(error: &dyn std::fmt::Display) -> Error {
    Error::new(format!("the virtual board: {error}"))
}

/// Sends a job to `image` in its `mounting` and waits for its end. `seconds` is how long it should take.
pub fn run_job(
    image: &Image,
    mounting: &Mounting,
    header: Header<f32>,
    pieces: Vec<Piece<f32>>,
    seconds: f64,
    prepare: impl FnOnce(&mut Probe),
) -> Result<JobRun, Error> {
    let talker = share(JobTalker::new(header, pieces));
    let (seen, machine) = run(image, mounting, talker.clone(), seconds + PATIENCE_S, prepare)?;
    let talker = lock(&talker);
    if let Some((at, cause)) = seen.restarts.first() {
        return Err(Error::new(format!("the controller was reset at {at} ns by {cause}")));
    }
    if let Some(error) = talker.error() {
        return Err(Error::new(error.to_string()));
    }
    if let Some(ending) = talker.ended {
        return Err(Error::new(ending.to_string()));
    }
    let Some(finished) = talker.finished else {
        return Err(Error::new(format!("the job did not end within {:.0} s of virtual time", seconds + PATIENCE_S)));
    };
    let stack = talker.telemetry.map_or(0, |telemetry| telemetry.stack);
    Ok(JobRun { seen, machine, finished, resent: talker.resent(), stack })
}

/// The setpoints of a run, as `--setpoints` of both commands writes them.
pub fn setpoints_csv(ticks: &[Tick]) -> String {
    let mut text = String::from("tick,x,y,z\n");
    for (k, Tick { setpoint: [x, y, z], .. }) in ticks.iter().enumerate() {
        text.push_str(&format!("{},{x},{y},{z}\n", k + 1));
    }
    text
}
