//! NUCLEO-F446RE: clocks, and who gets what. The pins are in [`pins`].
//!
//! It waits for hardware: it has been built and held against the manuals, RM0390 rev 6 and DS10693 rev 10, and has not run yet.

mod drives;
mod enables;
mod encoders;
mod flash;
mod inputs;
mod pins;
mod reset;
mod serial;
mod step_ring;
mod stop;
mod timer;
mod watchdog;

use heapless::spsc::{Consumer, Producer};
use shared::machine::Machine;
use shared::safety::ResetCause;
use stm32f4xx_hal::gpio::{Output, PC11, PinState, PushPull, Speed};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Rcc};
use stm32f4xx_hal::serial::{Serial2, config};

pub use drives::Drives;
pub use enables::{Enables, off};
pub use encoders::Encoders;
pub use flash::Flash;
pub use inputs::InputPins;
pub use pins::{AXES, PINS, PORTS};
pub use serial::SerialPort;
pub use step_ring::{SLOTS, StepRing};
pub use stm32f4xx_hal::pac;
pub use stop::StopInput;
pub use timer::TickTimer;
pub use watchdog::Watchdog;

use super::{Board, Cycles};

/// The clock of APB1, in Hz.
const PCLK1_HZ: u32 = 40_000_000;

/// Bits per second of the line.
const BAUD: u32 = 921_600;

/// Clocks in a bit of the line, RM0390 rev 6 section 25.4.4: 43, which makes 930 233 baud, 0.94 % too many.
const BIT: u32 = (PCLK1_HZ + BAUD / 2) / BAUD;

// The ST-Link's own rate is off by less than 0.2 %, and a receiver takes 3.3 %, RM0390 rev 6 section 25.4.5.
const _: () = assert!((PCLK1_HZ / BIT).abs_diff(BAUD) < BAUD / 50);

/// The line's interrupt.
pub const LINE: pac::Interrupt = pac::Interrupt::USART2;

/// Where a machine's settings are kept in [`Early::flash`]: sectors 6 and 7, RM0390 rev 6 table 5.
pub const KEPT_RANGE: core::ops::Range<u32> = 0x4_0000..0x8_0000;

/// An LED that is not on the board.
pub struct Lamp(PC11<Output<PushPull>>);

impl Lamp {
    /// On while something moves.
    pub fn show(&mut self, on: bool) {
        self.0.set_state(PinState::from(on));
    }
}

/// A board whose clocks run and whose flash can be written; no pin is anything yet.
pub struct Early {
    /// Why the processor started.
    pub cause: ResetCause,
    /// The flash, program and all.
    pub flash: Flash,
    rcc: Rcc,
    parts: Parts,
}

/// The peripherals that are given out later.
struct Parts {
    gpio: (pac::GPIOA, pac::GPIOB, pac::GPIOC),
    timers: (pac::TIM1, pac::TIM2, pac::TIM3, pac::TIM4, pac::TIM5, pac::TIM8, pac::TIM14),
    dac: pac::DAC,
    dma: (pac::DMA1, pac::DMA2),
    line: pac::USART2,
    interrupts: (pac::SYSCFG, pac::EXTI),
    watchdog: pac::IWDG,
}

/// Brings the clocks up: the core at 160 MHz from the ST-Link's 8 MHz, APB1 at 40 MHz with timers at 80 MHz, APB2 at 80 MHz with timers
/// at 160 MHz. That is within what voltage scale 1, which a reset selects, and five wait states allow, RM0390 rev 6 sections 5.1.3 and 3.4.1.
pub fn start(mut core: cortex_m::Peripherals, device: pac::Peripherals) -> Early {
    let cause = reset::reset_cause(&device.RCC);
    let clocks = Config::hse(8.MHz())
        .bypass_hse_oscillator()
        .sysclk(160.MHz())
        .hclk(160.MHz())
        .pclk1(PCLK1_HZ.Hz())
        .pclk2(80.MHz());
    let rcc = device.RCC.freeze(clocks);
    if rcc.clocks.timclk1().raw() != timer::TIMER_HZ || rcc.clocks.timclk2().raw() != step_ring::SLOT_TIMER_HZ {
        // The HAL takes the nearest clocks that it finds; a tick of another length is none.
        cortex_m::asm::udf();
    }
    Cycles::enable(&mut core.DCB, &mut core.DWT);

    let parts = Parts {
        gpio: (device.GPIOA, device.GPIOB, device.GPIOC),
        timers: (device.TIM1, device.TIM2, device.TIM3, device.TIM4, device.TIM5, device.TIM8, device.TIM14),
        dac: device.DAC,
        dma: (device.DMA1, device.DMA2),
        line: device.USART2,
        interrupts: (device.SYSCFG, device.EXTI),
        watchdog: device.IWDG,
    };
    Early { cause, flash: Flash::new(device.FLASH), rcc, parts }
}

impl Early {
    /// Makes the pins what they are for this machine, and starts the ticks and the watchdog.
    pub fn finish(self, machine: &Machine, received: Producer<'static, u8>, to_send: Consumer<'static, u8>) -> Board {
        let Self { flash, mut rcc, parts, .. } = self;
        flash.close();
        let Parts { gpio, timers, dac, dma, line, interrupts, watchdog } = parts;
        let (dma1, dma2) = dma;
        let (tim1, tim2, tim3, tim4, tim5, tim8, tim14) = timers;
        let a = gpio.0.split(&mut rcc);
        let b = gpio.1.split(&mut rcc);
        let c = gpio.2.split(&mut rcc);

        let _ = (b.pb13.into_pull_up_input(), b.pb14.into_pull_up_input(), b.pb15.into_pull_up_input());
        let _ = (b.pb8.into_pull_up_input(), b.pb9.into_pull_up_input(), b.pb10.into_pull_up_input());
        let _ = (c.pc8.into_pull_up_input(), c.pc9.into_pull_up_input(), c.pc10.into_pull_up_input());
        let _ = (b.pb0.into_pull_up_input(), b.pb1.into_pull_up_input(), b.pb5.into_pull_up_input());
        let _ = b.pb12.into_alternate::<1>().internal_pull_up(true);
        let enables = Enables::new(tim1, machine, &mut rcc);
        let _ = (a.pa8.into_alternate::<1>(), a.pa9.into_alternate::<1>(), a.pa10.into_alternate::<1>());

        let _ = (a.pa4.into_analog(), a.pa5.into_analog());
        let _ = (a.pa7.into_alternate::<9>(), a.pa6.into_push_pull_output());
        let drives = Drives::new(dac, tim14, &mut rcc);
        let _ =
            (c.pc6.into_alternate::<2>().internal_pull_up(true), c.pc7.into_alternate::<2>().internal_pull_up(true));
        let _ =
            (b.pb6.into_alternate::<2>().internal_pull_up(true), b.pb7.into_alternate::<2>().internal_pull_up(true));
        let _ =
            (a.pa0.into_alternate::<2>().internal_pull_up(true), a.pa1.into_alternate::<2>().internal_pull_up(true));
        let encoders = Encoders::new(tim3, tim4, tim5, &mut rcc);

        let _ = (c.pc0.into_push_pull_output(), c.pc1.into_push_pull_output());
        let _ = (c.pc2.into_push_pull_output(), c.pc3.into_push_pull_output());
        let _ = (c.pc4.into_push_pull_output(), c.pc5.into_push_pull_output());
        let ring = StepRing::new(tim8, dma2, &mut rcc);

        let pins = (a.pa2.into_alternate::<7>().speed(Speed::High), a.pa3.into_alternate::<7>());
        let settings = config::Config::default().baudrate(BAUD.bps()).dma(config::DmaConfig::Rx);
        let usart = match Serial2::<u8>::new(line, pins, settings, &mut rcc) {
            Ok(serial) => serial.release().0,
            // The rate is a constant above, within reach of the clock above.
            Err(_) => cortex_m::asm::udf(),
        };
        let port = SerialPort::new(usart, dma1, received, to_send, &mut rcc);
        let (syscfg, mut exti) = interrupts;
        let mut syscfg = syscfg.constrain(&mut rcc);
        Board {
            inputs: InputPins::new(),
            encoders,
            drives,
            ring,
            enables,
            port,
            stop: StopInput::new(c.pc13.into_floating_input(), &mut syscfg, &mut exti),
            lamp: Lamp(c.pc11.into_push_pull_output()),
            timer: TickTimer::new(tim2, &mut rcc),
            watchdog: Watchdog::start(watchdog),
        }
    }
}
