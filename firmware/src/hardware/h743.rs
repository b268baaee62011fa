//! NUCLEO-H743ZI2: clocks, pins, and who gets what.

use heapless::spsc::{Consumer, Producer};
use shared::link::MotionState;
use stm32h7xx_hal::gpio::{Output, PB0, PushPull, Speed};
use stm32h7xx_hal::pac;
use stm32h7xx_hal::prelude::*;

#[cfg(feature = "steps")]
use super::StepRing;
use super::{Cycles, SerialPort, StopInput, TickTimer, Watchdog};
#[cfg(not(feature = "steps"))]
use super::{Drives, Encoders};
use crate::mailbox::MAILBOX;

/// Bits per second of the line.
const BAUD: u32 = 921_600;

/// Everything that the application uses of the board.
pub struct Board {
    /// Interrupts 1024 times a second.
    pub timer: TickTimer,
    /// What moves the axes.
    pub actuators: Actuators,
    /// Waits for the tick to fail.
    pub watchdog: Watchdog,
    /// The line to the host.
    pub port: SerialPort,
    /// The emergency stop.
    pub stop: StopInput,
    /// For people.
    pub lamp: Lamp,
}

/// What moves servo axes.
#[cfg(not(feature = "steps"))]
pub struct Actuators {
    /// Where the axes are.
    pub encoders: Encoders,
    /// Where they are told to go.
    pub drives: Drives,
}

/// What moves step axes.
#[cfg(feature = "steps")]
pub struct Actuators {
    /// The steps of the next tick.
    pub ring: StepRing,
}

/// The green LED.
pub struct Lamp(PB0<Output<PushPull>>);

impl Lamp {
    /// On while something moves.
    pub fn show(&mut self, state: MotionState) {
        show(&mut self.0, matches!(state, MotionState::Running | MotionState::Starved));
    }
}

/// Any output will do for a lamp.
fn show(pin: &mut impl stm32h7xx_hal::hal::digital::v2::OutputPin, on: bool) {
    // A lamp that fails to light is no reason to stop.
    let _ = if on { pin.set_high() } else { pin.set_low() };
}

/// Brings the board up: the core at 384 MHz from the ST-Link's 8 MHz, buses at 192 MHz, peripherals at 96 MHz, timers at 192 MHz.
pub fn start(
    mut core: cortex_m::Peripherals,
    device: pac::Peripherals,
    received: Producer<'static, u8>,
    to_send: Consumer<'static, u8>,
) -> Board {
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
    let rec = ccdr.peripheral;

    core.SCB.enable_icache();
    Cycles::enable(&mut core.DCB, &mut core.DWT);

    #[cfg(not(feature = "steps"))]
    let a = device.GPIOA.split(rec.GPIOA);
    let b = device.GPIOB.split(rec.GPIOB);
    let c = device.GPIOC.split(rec.GPIOC);
    let d = device.GPIOD.split(rec.GPIOD);
    let e = device.GPIOE.split(rec.GPIOE);

    let _ = e.pe2.into_push_pull_output();
    #[cfg(not(feature = "steps"))]
    let actuators = {
        let (_, _) = (a.pa4.into_analog(), a.pa5.into_analog());
        let (_, _) = (c.pc6.into_alternate::<2>(), c.pc7.into_alternate::<2>());
        let (_, _) = (d.pd12.into_alternate::<2>(), d.pd13.into_alternate::<2>());
        Actuators {
            encoders: Encoders::new(device.TIM3, rec.TIM3, device.TIM4, rec.TIM4),
            drives: Drives::new(device.DAC, rec.DAC12),
        }
    };
    #[cfg(feature = "steps")]
    let actuators = {
        let (_, _) = (d.pd3.into_push_pull_output(), d.pd4.into_push_pull_output());
        let (_, _) = (d.pd5.into_push_pull_output(), d.pd6.into_push_pull_output());
        let (_, _) = (d.pd7.into_push_pull_output(), d.pd0.into_push_pull_output());
        Actuators { ring: StepRing::new((device.TIM8, rec.TIM8), (device.DMA1, rec.DMA1), device.DMAMUX1) }
    };

    let pins = (d.pd8.into_alternate::<7>().speed(Speed::High), d.pd9.into_alternate::<7>());
    let serial = match device.USART3.serial(pins, BAUD.bps(), rec.USART3, &ccdr.clocks) {
        Ok(serial) => serial,
        // The rate is a constant above, within reach of the clock above.
        Err(_) => cortex_m::asm::udf(),
    };
    let (tx, rx) = serial.split();

    let (mut syscfg, mut exti) = (device.SYSCFG, device.EXTI);
    let stop = StopInput::new(c.pc13.into_floating_input(), &mut syscfg, &mut exti);
    MAILBOX.set_stop(stop.is_pressed());

    Board {
        actuators,
        port: SerialPort::new(rx, tx, received, to_send),
        stop,
        lamp: Lamp(b.pb0.into_push_pull_output()),
        timer: TickTimer::new(device.TIM2, rec.TIM2),
        watchdog: Watchdog::start(device.IWDG),
    }
}
