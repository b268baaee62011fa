//! NUCLEO-H743ZI2: clocks, and who gets what. The pins are in [`pins`].

mod drives;
mod enables;
mod encoders;
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
use stm32h7xx_hal::flash::{FlashExt, LockedFlashBank};
use stm32h7xx_hal::gpio::{Output, PB0, PushPull, Speed};
use stm32h7xx_hal::prelude::*;
use stm32h7xx_hal::rcc::Ccdr;

pub use drives::Drives;
pub use enables::{Enables, off};
pub use encoders::Encoders;
pub use inputs::InputPins;
pub use pins::{AXES, PINS, PORTS};
pub use serial::SerialPort;
pub use step_ring::{SLOTS, StepRing};
pub use stm32h7xx_hal::pac;
pub use stop::StopInput;
pub use timer::TickTimer;
pub use watchdog::Watchdog;

use super::{Board, Cycles};

/// Bits per second of the line.
const BAUD: u32 = 921_600;

/// The line's interrupt.
pub const LINE: pac::Interrupt = pac::Interrupt::USART3;

/// Where a machine's settings are kept in [`Early::flash`]: the last two sectors.
pub const KEPT_RANGE: core::ops::Range<u32> = 0xc_0000..0x10_0000;

/// The green LED.
pub struct Lamp(PB0<Output<PushPull>>);

impl Lamp {
    /// On while something moves.
    pub fn show(&mut self, on: bool) {
        show(&mut self.0, on);
    }
}

/// Any output will do for a lamp.
fn show(pin: &mut impl stm32h7xx_hal::hal::digital::v2::OutputPin, on: bool) {
    // A lamp that fails to light is no reason to stop.
    let _ = if on { pin.set_high() } else { pin.set_low() };
}

/// A board whose clocks run and whose flash can be written; no pin is anything yet.
pub struct Early {
    /// Why the processor started.
    pub cause: ResetCause,
    /// The upper bank of the flash: the program runs in the lower one.
    pub flash: LockedFlashBank,
    ccdr: Ccdr,
    parts: Parts,
}

/// The peripherals that are given out later.
struct Parts {
    gpio: (pac::GPIOA, pac::GPIOB, pac::GPIOC, pac::GPIOD, pac::GPIOE, pac::GPIOF),
    timers: (pac::TIM1, pac::TIM2, pac::TIM3, pac::TIM4, pac::TIM8, pac::TIM14, pac::TIM15),
    dac: pac::DAC,
    dma: (pac::DMA1, pac::DMAMUX1),
    line: pac::USART3,
    interrupts: (pac::SYSCFG, pac::EXTI),
    watchdog: pac::IWDG,
}

/// Brings the clocks up: the core at 384 MHz from the ST-Link's 8 MHz, buses at 192 MHz, peripherals at 96 MHz, timers at 192 MHz.
pub fn start(mut core: cortex_m::Peripherals, device: pac::Peripherals) -> Early {
    let cause = reset::reset_cause(&device.RCC);
    let power = device.PWR.constrain().freeze();
    let ccdr = device
        .RCC
        .constrain()
        .use_hse(8.MHz())
        .bypass_hse()
        .sys_ck(384.MHz())
        .hclk(192.MHz())
        .pclk1(96.MHz())
        .pclk2(96.MHz())
        .pclk3(96.MHz())
        .pclk4(96.MHz())
        .freeze(power, &device.SYSCFG);

    core.SCB.enable_icache();
    Cycles::enable(&mut core.DCB, &mut core.DWT);

    let (lower, upper) = device.FLASH.split();
    let gpio = (device.GPIOA, device.GPIOB, device.GPIOC, device.GPIOD, device.GPIOE, device.GPIOF);
    let timers = (device.TIM1, device.TIM2, device.TIM3, device.TIM4, device.TIM8, device.TIM14, device.TIM15);
    let parts = Parts {
        gpio,
        timers,
        dac: device.DAC,
        dma: (device.DMA1, device.DMAMUX1),
        line: device.USART3,
        interrupts: (device.SYSCFG, device.EXTI),
        watchdog: device.IWDG,
    };
    Early { cause, flash: upper.unwrap_or(lower), ccdr, parts }
}

impl Early {
    /// Makes the pins what they are for this machine, and starts the ticks and the watchdog.
    pub fn finish(self, machine: &Machine, received: Producer<'static, u8>, to_send: Consumer<'static, u8>) -> Board {
        let Self { ccdr, parts, .. } = self;
        let Parts { gpio, timers, dac, dma, line, interrupts, watchdog } = parts;
        let (dma1, dmamux) = dma;
        let (tim1, tim2, tim3, tim4, tim8, tim14, tim15) = timers;
        let rec = ccdr.peripheral;
        let a = gpio.0.split(rec.GPIOA);
        let b = gpio.1.split(rec.GPIOB);
        let c = gpio.2.split(rec.GPIOC);
        let d = gpio.3.split(rec.GPIOD);
        let e = gpio.4.split(rec.GPIOE);
        let f = gpio.5.split(rec.GPIOF);

        let _ = (f.pf0.into_pull_up_input(), f.pf1.into_pull_up_input(), f.pf2.into_pull_up_input());
        let _ = (f.pf3.into_pull_up_input(), f.pf4.into_pull_up_input(), f.pf5.into_pull_up_input());
        let _ = (f.pf6.into_pull_up_input(), f.pf7.into_pull_up_input(), f.pf8.into_pull_up_input());
        let _ = (e.pe7.into_pull_up_input(), e.pe8.into_pull_up_input(), e.pe10.into_pull_up_input());
        let _ = e.pe3.into_alternate::<4>().internal_pull_up(true);
        let enables = Enables::new(tim15, rec.TIM15, machine);
        let _ = (e.pe4.into_alternate::<4>(), e.pe5.into_alternate::<4>(), e.pe6.into_alternate::<4>());

        let _ = (a.pa4.into_analog(), a.pa5.into_analog());
        let _ = (f.pf9.into_alternate::<9>(), f.pf10.into_push_pull_output());
        let drives = Drives::new((dac, rec.DAC12), (tim14, rec.TIM14));
        let _ =
            (c.pc6.into_alternate::<2>().internal_pull_up(true), c.pc7.into_alternate::<2>().internal_pull_up(true));
        let _ =
            (d.pd12.into_alternate::<2>().internal_pull_up(true), d.pd13.into_alternate::<2>().internal_pull_up(true));
        let _ =
            (e.pe9.into_alternate::<1>().internal_pull_up(true), e.pe11.into_alternate::<1>().internal_pull_up(true));
        let encoders = Encoders::new((tim3, rec.TIM3), (tim4, rec.TIM4), (tim1, rec.TIM1));

        let _ = (d.pd3.into_push_pull_output(), d.pd4.into_push_pull_output());
        let _ = (d.pd5.into_push_pull_output(), d.pd6.into_push_pull_output());
        let _ = (d.pd7.into_push_pull_output(), d.pd0.into_push_pull_output());
        let ring = StepRing::new((tim8, rec.TIM8), (dma1, rec.DMA1), dmamux);

        let pins = (d.pd8.into_alternate::<7>().speed(Speed::High), d.pd9.into_alternate::<7>());
        let serial = match line.serial(pins, BAUD.bps(), rec.USART3, &ccdr.clocks) {
            Ok(serial) => serial,
            // The rate is a constant above, within reach of the clock above.
            Err(_) => cortex_m::asm::udf(),
        };
        let (tx, rx) = serial.split();
        let (mut syscfg, mut exti) = interrupts;
        Board {
            inputs: InputPins::new(),
            encoders,
            drives,
            ring,
            enables,
            port: SerialPort::new(rx, tx, received, to_send),
            stop: StopInput::new(c.pc13.into_floating_input(), &mut syscfg, &mut exti),
            lamp: Lamp(b.pb0.into_push_pull_output()),
            timer: TickTimer::new(tim2, rec.TIM2),
            watchdog: Watchdog::start(watchdog),
        }
    }
}
