//! A look at a controller, in no session: whoever sends a job meanwhile does not notice. A session is opened with the first thing that is
//! asked for.

use std::time::{Duration, Instant};

use shared::link::{
    Action, Answer, Command, Decoder, Event, NO_SESSION, Refusal, Report, Sender, SenderError, Telemetry, encode,
};

use crate::stream::{StreamError, new_session};
use crate::transport::Transport;

/// A controller that is silent for so long is not there.
const PATIENCE: Duration = Duration::from_secs(2);

/// What is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sight<'a> {
    /// How it goes.
    Telemetry(&'a Telemetry),
    /// What came of an action.
    Done(Action, Result<Answer, Refusal>),
    /// No session could be had, and what was asked for was not done.
    Refused(SenderError),
}

/// What somebody who looks on wants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Want {
    /// Nothing.
    Nothing,
    /// An action.
    Act(Action),
    /// To look no longer.
    Leave,
}

/// Looks on. `look` sees what happens and says whether to go on; `want` is asked again and again for what a person wants.
///
/// Errors: the line is gone, or nobody answers.
pub fn monitor(
    line: &mut dyn Transport,
    every: Duration,
    mut look: impl FnMut(Sight<'_>) -> bool,
    mut want: impl FnMut() -> Want,
) -> Result<(), StreamError> {
    let start = Instant::now();
    let mut decoder = Decoder::new();
    let mut session: Option<Sender<'static>> = None;
    let mut buffer = [0; 1024];
    let (mut heard, mut asked) = (start, None::<Instant>);
    line.send(&[0])?;
    loop {
        match want() {
            Want::Nothing => {}
            Want::Act(action) => {
                // Too many keys at a time: the last ones are none.
                session.get_or_insert_with(|| Sender::without_job(new_session())).act(action);
            }
            Want::Leave => return Ok(()),
        }
        let now_us = start.elapsed().as_micros() as u64;
        if let Some(sender) = &mut session {
            while let Some(frame) = sender.poll(now_us) {
                line.send(&frame)?;
            }
            if let Some(error) = sender.error() {
                session = None;
                if !look(Sight::Refused(error)) {
                    return Ok(());
                }
            }
        }
        if asked.is_none_or(|asked| asked.elapsed() >= every) {
            asked = Some(Instant::now());
            if let Some(frame) = encode(NO_SESSION, 0, &Command::Status) {
                line.send(&frame)?;
            }
        }
        let count = line.receive(&mut buffer)?;
        for &byte in buffer.iter().take(count) {
            let outside = decoder.push::<Report>(byte).and_then(Result::ok).map(|said| said.message);
            let inside = session.as_mut().and_then(|sender| sender.receive(now_us, byte));
            heard = if outside.is_some() || inside.is_some() { Instant::now() } else { heard };
            let goes_on = match (outside, inside) {
                (Some(Report::Telemetry(telemetry)), _) => look(Sight::Telemetry(&telemetry)),
                (_, Some(Event::Done(action, outcome))) => look(Sight::Done(action, outcome)),
                _ => true,
            };
            if !goes_on {
                return Ok(());
            }
        }
        if heard.elapsed() > PATIENCE.max(2 * every) {
            return Err(StreamError::silent());
        }
    }
}
