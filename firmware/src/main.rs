//! The Hodograph motion controller.
//!
//! One RTIC application for every board. What runs when, from the most urgent:
//!
//! | task | priority | woken by | does |
//! | --- | --- | --- | --- |
//! | `stop_button` | 15 | the button | takes the drives' power and the pulses, in hardware registers, before anything else |
//! | `tick` | 14 | TIM2, 1024 times a second | inputs, safety, one setpoint, every axis |
//! | `usart3` or `usart2` | 8 | the line's serial port, which is the board's | moves bytes between the line and two queues |
//! | `link` | 2 | the line and `idle` | reads frames, validates pieces, answers, reports |
//! | `idle` | 0 | every interrupt | sleeps; wakes `link` for reports |
//!
//! Between them stand single-producer single-consumer queues and the [`mailbox`], so that no task waits for a slower one. Everything
//! that can be wrong with a job is found in `link`; the tick gets validated pieces only. The machine comes from the flash, where
//! [`kept`] looks for it at the start.
#![no_std]
#![no_main]

mod control;
mod hardware;
mod kept;
mod link;
mod mailbox;
mod panic;
mod restart;
mod stack;
mod telemetry;

use defmt_rtt as _;

// RTIC's generated items have no documentation; everything written by hand has.
#[allow(missing_docs)]
#[rtic::app(device = crate::hardware::pac, peripherals = true, dispatchers = [UART5])]
mod app {
    use core::sync::atomic::AtomicU32;

    use heapless::spsc::Queue;
    use shared::machine::image::Image;
    use shared::supply::{Sink, Source};

    use crate::control::{DIRECTIVES, Directives, Hands, PIECES, PieceQueue, Tick};
    use crate::hardware::{self, Cycles, SerialPort, StopInput, TickTimer, Watchdog};
    use crate::link::{Lines, Link, RX_BYTES, TX_BYTES};
    use crate::mailbox::MAILBOX;
    use crate::{kept, restart};

    /// The link looks after its reports every so many ticks, 4 ms.
    const REPORT_TICKS: u32 = 4;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        timer: TickTimer,
        watchdog: Watchdog,
        tick: Tick,
        #[cfg(feature = "nucleo-h743zi2")]
        usart3: SerialPort,
        #[cfg(feature = "nucleo-f446re")]
        usart2: SerialPort,
        stop: StopInput,
        link: Link,
    }

    #[init(local = [
        pieces: PieceQueue = Queue::new(),
        horizon: AtomicU32 = AtomicU32::new(0),
        directives: Directives = Queue::new(),
        received: Queue<u8, RX_BYTES> = Queue::new(),
        to_send: Queue<u8, TX_BYTES> = Queue::new(),
        image: Image = Image::new(),
    ])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let (piece_producer, piece_consumer) = cx.local.pieces.split();
        let (directive_producer, directive_consumer) = cx.local.directives.split();
        let (received_producer, received_consumer) = cx.local.received.split();
        let (to_send_producer, to_send_consumer) = cx.local.to_send.split();

        let mut early = hardware::start(cx.core, cx.device);
        let cause = restart::cause(early.cause);
        let machine = kept::machine(early.flash.unlocked(), cx.local.image);
        let board = early.finish(&machine, received_producer, to_send_consumer);
        let hardware::Board { timer, inputs, encoders, drives, ring, enables, watchdog, port, stop, lamp } = board;
        MAILBOX.set_button(stop.is_pressed());
        defmt::info!("hodograph {}: {} axes, {} pieces", env!("CARGO_PKG_VERSION"), machine.axes.len(), PIECES);

        let horizon: &'static AtomicU32 = cx.local.horizon;
        let (sink, source) = (Sink::new(piece_producer, horizon), Source::new(piece_consumer, horizon));
        let lines = Lines { to_send: to_send_producer, pieces: sink, directives: directive_producer };
        let hands = Hands { inputs, encoders, drives, ring, enables };
        let tick = Tick::new(&machine, cause, hands, source, directive_consumer);
        let link = Link::new(received_consumer, lines, machine, cx.local.image, lamp);
        let local = Local {
            timer,
            watchdog,
            tick,
            #[cfg(feature = "nucleo-h743zi2")]
            usart3: port,
            #[cfg(feature = "nucleo-f446re")]
            usart2: port,
            stop,
            link,
        };
        (Shared {}, local)
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

    /// The button: the drives are off a few instructions after the contact, and the next tick knows.
    #[task(binds = EXTI15_10, priority = 15, local = [stop])]
    fn stop_button(cx: stop_button::Context) {
        let pressed = cx.local.stop.acknowledge();
        if pressed {
            hardware::off();
        }
        MAILBOX.set_button(pressed);
    }

    /// The tick: 1024 times a second, above everything but the button.
    ///
    /// Must end within half a period (488 us); `budget.toml` holds what it takes. It reads switches and encoders, asks what the machine may
    /// do, walks the path by one period or looks for home, has the axes follow, which is a command for each drive and the next half of the
    /// step ring, feeds the watchdog, and leaves numbers for the reporter. No lock that a slower task holds, no logging, no panic.
    #[task(binds = TIM2, priority = 14, local = [timer, watchdog, tick])]
    fn tick(cx: tick::Context) {
        let cycles = Cycles::start();
        cx.local.timer.acknowledge();
        let [sensed, decided] = cx.local.tick.tick(&MAILBOX, cycles);
        cx.local.watchdog.feed();
        MAILBOX.close([sensed, decided, cycles.elapsed()]);
    }

    /// The line of the NUCLEO-H743ZI2, see [`exchange`].
    #[cfg(feature = "nucleo-h743zi2")]
    #[task(binds = USART3, priority = 8, local = [usart3])]
    fn usart3(cx: usart3::Context) {
        exchange(cx.local.usart3);
    }

    /// The line of the NUCLEO-F446RE, see [`exchange`].
    #[cfg(feature = "nucleo-f446re")]
    #[task(binds = USART2, priority = 8, local = [usart2])]
    fn usart2(cx: usart2::Context) {
        exchange(cx.local.usart2);
    }

    /// Bytes from the line into a queue, and from a queue to the line.
    fn exchange(port: &mut SerialPort) {
        if port.exchange() {
            // A frame has ended. An error says that the link is awake already.
            let _ = link::spawn();
        }
    }

    /// Reads frames, loads pieces, answers and reports.
    #[task(priority = 2, local = [link])]
    async fn link(cx: link::Context) {
        // A board that receives by DMA brings here what has come since; at the end it leaves with what there is to say.
        rtic::pend(hardware::LINE);
        cx.local.link.serve();
        rtic::pend(hardware::LINE);
    }

    // Named in a type of `Local` only through others; RTIC wants to see it used.
    const _: usize = DIRECTIVES;
}
