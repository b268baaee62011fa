//! What outlives a restart, in RAM that nothing initializes: a machine on its way into the flash, and the program's last words.
//!
//! A flash that is written stops the processor on some parts, and with it the tick. So a machine that was sent waits here, the
//! controller restarts, and the flash is written before anything can move. The virtual board puts its machines here too: it finds the
//! place by the symbol `HODOGRAPH_PENDING`, a mark and the image.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use shared::machine::image::{IMAGE_SIZE, Image};
use shared::safety::ResetCause;

/// Marks an image.
const IMAGE_MARK: u32 = 0x4d41_4348;
/// Marks a program that failed.
const FAILED_MARK: u32 = 0x4641_494c;

/// Two words and an image, in the order of the fields.
#[repr(C)]
struct Pending {
    image_mark: u32,
    failed_mark: u32,
    image: [u8; IMAGE_SIZE],
}

#[repr(transparent)]
struct Memory(UnsafeCell<MaybeUninit<Pending>>);

// SAFETY: it is touched before the tasks start, and by whoever is about to restart the processor with all interrupts off.
unsafe impl Sync for Memory {}

#[unsafe(no_mangle)]
#[unsafe(link_section = ".uninit.HODOGRAPH_PENDING")]
static HODOGRAPH_PENDING: Memory = Memory(UnsafeCell::new(MaybeUninit::uninit()));

fn pending() -> *mut Pending {
    HODOGRAPH_PENDING.0.get().cast()
}

/// Why the processor started: the program's own failure goes before what the hardware says. To be asked once.
pub fn cause(hardware: ResetCause) -> ResetCause {
    // SAFETY: a word of memory that exists; the tasks have not started. Volatile, since no one has initialized it.
    let mark = unsafe { (&raw const (*pending()).failed_mark).read_volatile() };
    // SAFETY: as above.
    unsafe { (&raw mut (*pending()).failed_mark).write_volatile(0) };
    if mark == FAILED_MARK { ResetCause::HardFault } else { hardware }
}

/// The machine that was sent before the restart, once. Anything may be in it.
pub fn take_image(place: &mut Image) -> bool {
    // SAFETY: as in `cause`.
    let mark = unsafe { (&raw const (*pending()).image_mark).read_volatile() };
    if mark != IMAGE_MARK {
        return false;
    }
    place.clear();
    for k in 0..IMAGE_SIZE {
        // SAFETY: as in `cause`, and within the array.
        let byte = unsafe { (&raw const (*pending()).image).cast::<u8>().add(k).read_volatile() };
        let _ = place.push(byte);
    }
    // SAFETY: as in `cause`.
    unsafe { (&raw mut (*pending()).image_mark).write_volatile(0) };
    true
}

/// Restarts with a machine.
pub fn with_image(image: &[u8]) -> ! {
    cortex_m::interrupt::disable();
    for (k, byte) in image.iter().take(IMAGE_SIZE).enumerate() {
        // SAFETY: within the array, with all interrupts off.
        unsafe { (&raw mut (*pending()).image).cast::<u8>().add(k).write_volatile(*byte) };
    }
    // SAFETY: as above.
    unsafe { (&raw mut (*pending()).image_mark).write_volatile(IMAGE_MARK) };
    cortex_m::peripheral::SCB::sys_reset()
}

/// Restarts because the program has failed.
pub fn as_failed() -> ! {
    cortex_m::interrupt::disable();
    // SAFETY: with all interrupts off.
    unsafe { (&raw mut (*pending()).failed_mark).write_volatile(FAILED_MARK) };
    cortex_m::peripheral::SCB::sys_reset()
}
