//! The machine that is kept in flash, as one item of a map that sequential-storage keeps: it survives a loss of power while it is written.

use embedded_storage::nor_flash::NorFlash;
use sequential_storage::cache::Cache;
use sequential_storage::map::{MapConfig, MapStorage};
use shared::control::Axes;
use shared::machine::image::{IMAGE_SIZE, Image, decode, whole};
use shared::machine::{Axis, Drive, Machine};

use crate::hardware::{AXES, Blocking, KEPT_RANGE, PINS, PORTS, SLOTS};
use crate::restart;

/// The map's one key.
const KEY: u8 = 0;

/// Room for the item, its key, and what a word of the flash takes more.
const BUFFER_SIZE: usize = IMAGE_SIZE + 64;

/// The machine of an image. Errors: none that this board can drive.
pub fn machine_of(image: &[u8]) -> Option<Machine> {
    let machine = decode(image).ok()?.activate().ok()?;
    let is_driven = Axes::<AXES, PORTS, SLOTS>::new(&machine, &PINS).is_ok() && machine.axes.iter().all(keeps_up);
    is_driven.then_some(machine)
}

/// Whether the slots of this board are short enough for an axis's pulses at its highest velocity.
fn keeps_up(axis: &Axis) -> bool {
    let Drive::Step(drive) = axis.drive else { return true };
    let settings = drive.on_pins((0, 0), (0, 0), SLOTS);
    let slots = f64::from(settings.pulse) + f64::from(settings.gap);
    f64::from(axis.velocity) * drive.steps_per_mm * slots <= SLOTS as f64 / f64::from(shared::TICK)
}

/// The machine to run, whose image is left in `image`: one that was sent before the restart, which is kept first; or the one that is
/// kept; or none. Before the ticks start: an erasure takes a second.
pub fn machine(flash: impl NorFlash, image: &mut Image) -> Machine {
    let mut buffer = [0_u8; BUFFER_SIZE];
    let config = MapConfig::try_new(KEPT_RANGE);
    let Ok(config) = config else { return Machine::none() };
    let mut map = MapStorage::<u8, _, _>::new(Blocking(flash), config, Cache::new_uncached());
    if restart::take_image(image)
        && let Some(machine) = machine_of(image)
    {
        // The memory behind it is not part of it: a host would read back more than it has written.
        let length = whole(image).map_or(0, <[u8]>::len);
        image.truncate(length);
        let kept = embassy_futures::block_on(map.store_item(&mut buffer, &KEY, &image.as_slice()));
        if kept.is_err() {
            defmt::error!("the flash did not take the machine");
        }
        return machine;
    }
    image.clear();
    let kept = embassy_futures::block_on(map.fetch_item::<&[u8]>(&mut buffer, &KEY));
    if let Ok(Some(bytes)) = kept
        && let Some(machine) = machine_of(bytes)
        && image.extend_from_slice(bytes).is_ok()
    {
        return machine;
    }
    defmt::warn!("no machine is kept");
    image.clear();
    Machine::none()
}
