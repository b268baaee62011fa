//! The Hodograph motion controller.
//!
//! One RTIC application. What runs when, from the most urgent:
//!
//! | task | priority | woken by | does |
//! | --- | --- | --- | --- |
//! | `emergency_stop` | 15 | the stop input | switches the drives and the pulses off, in hardware registers, before anything else |
//! | `tick` | 14 | TIM2, 1024 times a second | one setpoint, two servo axes or three step axes |
//! | `serial` | 8 | USART3 | moves bytes between the line and two queues |
//! | `link` | 2 | `serial` and `idle` | reads frames, validates pieces, answers, reports |
//! | `idle` | 0 | every interrupt | sleeps; wakes `link` for reports |
//!
//! Between them stand single-producer single-consumer queues and the [`mailbox`], so that no task waits for a slower one. Everything
//! that can be wrong with a job is found in `link`; the tick gets validated pieces only.
#![no_std]
#![no_main]

mod axes;
mod control;
mod hardware;
mod link;
mod mailbox;
mod panic;
mod stack;
mod telemetry;

use defmt_rtt as _;

// RTIC's generated items have no documentation; everything written by hand has.
#[allow(missing_docs)]
#[rtic::app(device = stm32h7xx_hal::pac, peripherals = true, dispatchers = [LPTIM1])]
mod app {
    use core::sync::atomic::AtomicU32;

    use heapless::spsc::Queue;
    use shared::supply::{Sink, Source};

    use crate::axes::Axes;
    use crate::control::{Control, DIRECTIVES, Directive, Directives, PIECES, PieceQueue};
    use crate::hardware::{self, Cycles, SerialPort, StopInput, TickTimer, Watchdog};
    use crate::link::{Link, RX_BYTES, TX_BYTES};
    use crate::mailbox::MAILBOX;

    /// The link looks after its reports every so many ticks, 8 ms.
    const REPORT_TICKS: u32 = 8;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        timer: TickTimer,
        watchdog: Watchdog,
        control: Control,
        port: SerialPort,
        stop: StopInput,
        link: Link,
    }

    #[init(local = [
        pieces: PieceQueue = Queue::new(),
        horizon: AtomicU32 = AtomicU32::new(0),
        directives: Directives = Queue::new(),
        received: Queue<u8, RX_BYTES> = Queue::new(),
        to_send: Queue<u8, TX_BYTES> = Queue::new(),
    ])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let (piece_producer, piece_consumer) = cx.local.pieces.split();
        let (directive_producer, directive_consumer) = cx.local.directives.split();
        let (received_producer, received_consumer) = cx.local.received.split();
        let (to_send_producer, to_send_consumer) = cx.local.to_send.split();

        let board = hardware::start(cx.core, cx.device, received_producer, to_send_consumer);
        let hardware::Board { timer, actuators, watchdog, port, stop, lamp } = board;
        defmt::info!("hodograph {}: {} pieces, {} directives", env!("CARGO_PKG_VERSION"), PIECES, DIRECTIVES);

        let horizon: &'static AtomicU32 = cx.local.horizon;
        let (sink, source) = (Sink::new(piece_producer, horizon), Source::new(piece_consumer, horizon));
        let link = Link::new(received_consumer, to_send_producer, sink, directive_producer, lamp);
        let control = Control::new(source, directive_consumer, Axes::new(actuators));
        (Shared {}, Local { timer, watchdog, control, port, stop, link })
    }

    /// Sleeps between interrupts, and lets the link report.
    #[idle]
    fn idle(_: idle::Context) -> ! {
        let mut reported = 0_u32;
        loop {
            cortex_m::asm::wfi();
            let now = MAILBOX.uptime();
            if now.wrapping_sub(reported) >= REPORT_TICKS {
                reported = now;
                // An error says that the link is awake already.
                let _ = link::spawn();
            }
        }
    }

    /// The stop input: the drives are off a few instructions after the contact, and every motion is given up.
    #[task(binds = EXTI15_10, priority = 15, local = [stop])]
    fn emergency_stop(cx: emergency_stop::Context) {
        let pressed = cx.local.stop.acknowledge();
        if pressed {
            hardware::off();
        }
        MAILBOX.set_stop(pressed);
    }

    /// The tick: 1024 times a second, above everything but the stop input.
    ///
    /// Must end within half a period (488 us); `budget.toml` holds what it takes. It looks where the axes are, walks the path by one
    /// period, has the axes follow, which is a command for each drive or the next half of the step ring, feeds the watchdog, and leaves
    /// numbers for the reporter. Axes that cannot follow are switched off. No lock that a slower task holds, no logging, no panic.
    #[task(binds = TIM2, priority = 14, local = [timer, watchdog, control])]
    fn tick(cx: tick::Context) {
        let cycles = Cycles::start();
        cx.local.timer.acknowledge();
        if let Err(fault) = cx.local.control.tick(MAILBOX.is_stopped()) {
            hardware::off();
            MAILBOX.set_fault(fault);
        }
        cx.local.watchdog.feed();
        cx.local.control.publish(&MAILBOX, cycles.elapsed());
    }

    /// Bytes from the line into a queue, and from a queue to the line. A quarter of a tick's period passes between two bytes.
    #[task(binds = USART3, priority = 8, local = [port])]
    fn serial(cx: serial::Context) {
        if cx.local.port.exchange() {
            // A frame has ended. An error says that the link is awake already.
            let _ = link::spawn();
        }
    }

    /// Reads frames, loads pieces, answers and reports.
    #[task(priority = 2, local = [link])]
    async fn link(cx: link::Context) {
        cx.local.link.serve();
        rtic::pend(stm32h7xx_hal::pac::Interrupt::USART3);
    }

    // `Directive` is named in a type of `Local` only through `Control`; RTIC wants to see it used.
    const _: Option<Directive> = None;
}
