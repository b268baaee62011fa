//! One image, one conversation, until it ends.

use rigless::chip::uart::Peer;
use rigless::emulator::{Driver, Start, run as emulate};
use rigless::image::Image as Placed;
use rigless::machine::stm32h743_bench::Stm32h743Bench;
use rigless::session::Session;
use rigless::soc::stm32h743::peripherals::usart;
use rigless::time::VirtualNanos;
use shared::piece::{Header, Piece};

use crate::Error;
use crate::image::Image;
use crate::line::{JobTalker, Line, Shared, Talker, lock, share};
use crate::machine::Machine;
use crate::machine::switches::Switches;
use crate::probe::{Probe, Seen, Tick};

/// The port that the firmware's link uses: the ST-Link's.
const PORT: &str = "USART3";

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

/// Runs `image` with `talker` at the far end of its line, until the talker is done or `seconds` of virtual time have passed.
///
/// `prepare` may ask the probe for more than it does by itself.
pub fn run(
    image: &Image,
    talker: Shared<dyn Talker>,
    seconds: f64,
    prepare: impl FnOnce(&mut Probe),
) -> Result<(Seen, Machine), Error> {
    let mut session = board(Line::new(talker.clone()))?;
    let mut probe = Probe::new(image, talker, seconds)?;
    prepare(&mut probe);
    probe.watch(&mut session);
    let Probe { seen, machine, .. } = execute(image, session, probe)?;
    Ok((seen, machine))
}

/// A board with `peer` at the far end of its line, before its first instruction.
pub(crate) fn board(peer: impl Peer) -> Result<Session<Stm32h743Bench>, Error> {
    let mut bench = Stm32h743Bench::new().map_err(|error| failed(&error))?;
    let nth = usart::INSTANCES.iter().position(|&name| name == PORT);
    let nth = nth.ok_or_else(|| Error::new(format!("the virtual board has no {PORT}")))?;
    bench.mcu.usart[nth].attach(peer);
    Switches::rest(&mut bench);
    Session::new(Box::new(bench), 0, VirtualNanos(0)).map_err(|error| failed(&error))
}

/// Runs `image` until `driver` ends the run, and gives the driver back. Errors: what the firmware did that it must not.
pub(crate) fn execute<R: Driver<Stm32h743Bench> + 'static>(
    image: &Image,
    session: Session<Stm32h743Bench>,
    driver: R,
) -> Result<R, Error> {
    let images = [Placed::read(image.path(), None).map_err(|error| failed(&error))?];
    let mut finished = emulate(session, &Start::new(&images), driver).map_err(|error| failed(&error))?;
    if let Some(error) = finished.session.take_error() {
        return Err(failed(&error));
    }
    if let Some(first) = finished.session.unmapped().first() {
        return Err(Error::new(format!("the firmware left its memory: {first}")));
    }
    if let Some(reset) = finished.session.resets().first() {
        return Err(Error::new(format!("the controller was reset at {} ns by {:?}", reset.at.0, reset.cause)));
    }
    Ok(finished.driver)
}

fn failed(error: &dyn std::fmt::Display) -> Error {
    Error::new(format!("the virtual board: {error}"))
}

/// Sends a job to `image` and waits for its end. `seconds` is how long it should take.
pub fn run_job(
    image: &Image,
    header: Header<f32>,
    pieces: Vec<Piece<f32>>,
    seconds: f64,
    prepare: impl FnOnce(&mut Probe),
) -> Result<JobRun, Error> {
    let talker = share(JobTalker::new(header, pieces));
    let (seen, machine) = run(image, talker.clone(), seconds + PATIENCE_S, prepare)?;
    let talker = lock(&talker);
    if let Some(error) = talker.error() {
        return Err(Error::new(error.to_string()));
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
