//! The controller's end of the link: the queues that `shared`'s endpoint speaks through.

use heapless::spsc::{Consumer, Producer};
use shared::active::ActivePiece;
use shared::executor::State;
use shared::fixed::Fixed;
use shared::link::{Action, Answer, End, Ending, Endpoint, Frame, Identity, Machine, Refusal, Telemetry};
use shared::loader::Motion;
use shared::motion::MotionCommand;
use shared::supply::Sink;

use crate::axes::AXES;
use crate::control::Directive;
use crate::hardware::Lamp;
use crate::mailbox::MAILBOX;
use crate::telemetry::{Reporter, motion_state};

/// Received bytes that may wait for the link: more than the sender's window.
pub const RX_BYTES: usize = 2048;

/// Bytes that may wait for the line.
pub const TX_BYTES: usize = 1024;

/// Whether a host that vanishes leaves a machine that brakes; otherwise it finishes what is queued and rests.
const BRAKE_IF_ALONE: bool = true;

/// See the module.
pub struct Link {
    received: Consumer<'static, u8>,
    endpoint: Endpoint,
    queues: Queues,
}

/// What the endpoint speaks through.
struct Queues {
    to_send: Producer<'static, u8>,
    pieces: Sink<'static, f32>,
    capacity: u16,
    directives: Producer<'static, Directive>,
    lamp: Lamp,
    reporter: Reporter,
    percent: u8,
}

impl Link {
    /// A link between these queues.
    pub fn new(
        received: Consumer<'static, u8>,
        to_send: Producer<'static, u8>,
        pieces: Sink<'static, f32>,
        directives: Producer<'static, Directive>,
        lamp: Lamp,
    ) -> Self {
        let capacity = pieces.room() as u16;
        let reporter = Reporter::default();
        let queues = Queues { to_send, pieces, capacity, directives, lamp, reporter, percent: 100 };
        Self { received, endpoint: Endpoint::new(), queues }
    }

    /// Answers everything that was received, and reports what is due.
    pub fn serve(&mut self) {
        while let Some(byte) = self.received.dequeue() {
            self.endpoint.receive(&mut self.queues, MAILBOX.uptime(), byte);
        }
        self.endpoint.poll(&mut self.queues, MAILBOX.uptime());
    }
}

impl Queues {
    /// Hands a directive to the tick, and waits for the tick that takes it: a period at most, since nothing here can hold it up.
    /// So whatever is loaded next belongs to what comes after the directive.
    fn direct(&mut self, directive: Directive) {
        let mut waiting = self.directives.enqueue(directive).is_ok();
        while waiting {
            cortex_m::asm::wfi();
            waiting = !self.directives.is_empty();
        }
    }
}

impl Machine for Queues {
    fn identity(&self) -> Identity {
        Identity { firmware: [0, 1, 0], axes: AXES as u8, capacity: self.capacity }
    }

    fn room(&self) -> u16 {
        self.pieces.room() as u16
    }

    fn ready(&self) -> Result<(), Refusal> {
        if MAILBOX.is_stopped() { Err(Refusal::Stopped) } else { Ok(()) }
    }

    fn clear(&mut self) {
        self.direct(Directive::Stop);
        self.pieces.restart();
    }

    fn push(&mut self, piece: ActivePiece<f32>) -> bool {
        self.pieces.push(piece).is_ok()
    }

    fn start(&mut self, motion: &Motion<f32>, at: [Fixed; 2]) -> Result<(), Refusal> {
        defmt::info!("run");
        self.direct(Directive::Start(*motion, at));
        Ok(())
    }

    fn stop(&mut self) {
        self.direct(Directive::Stop);
    }

    /// The tick refuses what its motion does not allow; telemetry shows that nothing came of it.
    fn act(&mut self, action: Action) -> Result<Answer, Refusal> {
        match action {
            Action::Motion(command) => {
                if let MotionCommand::Override { percent } = command {
                    self.percent = percent;
                }
                self.direct(Directive::Command(command));
                Ok(Answer::Done)
            }
            Action::Acknowledge => {
                MAILBOX.release();
                self.ready().map(|()| Answer::Done)
            }
            Action::Home | Action::WriteImage { .. } | Action::CommitImage { .. } | Action::ReadImage { .. } => {
                Err(Refusal::Unsupported)
            }
        }
    }

    fn end(&self) -> Option<End> {
        let snapshot = MAILBOX.read();
        match snapshot.state {
            _ if MAILBOX.is_stopped() => Some(End::Early(Ending::Stopped)),
            state if state == State::Finished as u32 => {
                Some(End::Finished { ticks: snapshot.ticks, residual: snapshot.residual, hash: snapshot.hash })
            }
            state if state == State::Cancelled as u32 => Some(End::Early(Ending::Cancelled)),
            _ => None,
        }
    }

    fn telemetry(&mut self, loading: bool) -> Telemetry {
        let snapshot = MAILBOX.read();
        self.lamp.show(motion_state(&snapshot, loading));
        Telemetry { percent: self.percent, ..self.reporter.report(&snapshot, loading) }
    }

    fn host_vanished(&mut self) {
        defmt::warn!("the host has vanished");
        if BRAKE_IF_ALONE {
            self.direct(Directive::Command(MotionCommand::Hold));
        }
    }

    /// Half a frame would only spoil the next one.
    fn send(&mut self, frame: &Frame) {
        if self.to_send.capacity() - self.to_send.len() < frame.len() {
            return;
        }
        for &byte in frame {
            // There is room, and nobody else writes here.
            let _ = self.to_send.enqueue(byte);
        }
    }
}
