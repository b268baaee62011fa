//! All figures of an image together.

use std::collections::BTreeMap;

use serde::Serialize;
use shared::piece::Order;

use crate::Error;
use crate::calls::Calls;
use crate::image::Image;
use crate::jobs::{Kind, diagonal, job};
use crate::machine::Mounting;
use crate::probe::EXCEPTION_FRAME;
use crate::reach::Reach;
use crate::run::run_job;
use crate::stages::Stages;

/// Ticks of each job over which the stages are counted: the middle of a ramp, where every term of the feed law is alive.
const RAMP_TICKS: std::ops::Range<u32> = 40..72;

/// The function that fits the feed correction polynomial of a spline piece when it is loaded, in three dimensions.
const FIT: &str = "shared::spline::fit::fit::<f32, 3>";

/// The row of that.
const FIT_ROW: &str = "fit of a cubic";

/// Every figure.
#[derive(Clone, Debug, Serialize)]
pub struct Budget {
    /// By kind of piece and order, such as `ph 1` or, along a profile, `ph profile`: instructions per stage in the middle of a ramp; and of the whole
    /// interrupt the median, the tick that crosses a node, and the most of all, those at rest and at the start among them. One row is what
    /// loading a spline piece takes beside.
    pub instructions: BTreeMap<String, BTreeMap<String, u32>>,
    /// The most stack of the interrupt, in bytes, with the frame that the processor stacks.
    pub stack_bytes: u32,
    /// Flash, in bytes.
    pub flash_bytes: u32,
    /// RAM without the stack, in bytes.
    pub ram_bytes: u32,
    /// Functions that the tick reaches and must not.
    pub forbidden: Vec<String>,
    /// Calls through a register that the tick can reach.
    pub indirect: Vec<String>,
    /// Functions that the tick reaches.
    pub reached: Vec<String>,
}

/// Measures `image` in a machine of servo axes; `progress` is told what is measured next.
pub fn measure(image: &Image, servos: &Mounting, mut progress: impl FnMut(&str)) -> Result<Budget, Error> {
    let reach = Reach::of_tick(image)?;
    let stages = Stages::new(image)?;
    let addresses = reach.instructions(image);
    let mut instructions = BTreeMap::new();
    let mut stack = 0;
    for kind in Kind::ALL {
        for &(order, order_name) in kind.orders() {
            let name = format!("{} {order_name}", kind.name());
            progress(&name);
            let (header, pieces) = job(kind, order);
            let counted = run_job(image, servos, header, pieces, 1.0, |probe| {
                probe.count_instructions(addresses.clone(), RAMP_TICKS);
            })?;
            let ticks = &counted.seen.ticks;
            let mut row: BTreeMap<String, u32> = stages
                .attribute(&counted.seen.executed, counted.seen.counted_ticks)
                .into_iter()
                .map(|(stage, count)| (stage.to_owned(), count))
                .collect();
            row.insert("median".to_owned(), median(ticks.iter().map(|tick| tick.instructions)));
            let node =
                ticks.windows(2).find(|pair| pair[0].pieces != pair[1].pieces).map_or(0, |pair| pair[1].instructions);
            row.insert("node".to_owned(), node);
            row.insert("most".to_owned(), counted.seen.worst);
            instructions.insert(name, row);
            stack = stack.max(counted.seen.handler_stack);
        }
    }
    progress(FIT_ROW);
    instructions.insert(FIT_ROW.to_owned(), fit(image, servos)?);
    let sizes = image.sizes();
    Ok(Budget {
        instructions,
        stack_bytes: stack + EXCEPTION_FRAME,
        flash_bytes: sizes.flash,
        ram_bytes: sizes.ram,
        forbidden: reach.forbidden().into_iter().map(str::to_owned).collect(),
        indirect: reach.indirect.iter().map(|(name, address)| format!("{name} at {address:#010x}")).collect(),
        reached: reach.functions.iter().map(|function| function.name.clone()).collect(),
    })
}

/// What it takes to fit the feed correction polynomial of a cubic, once for each piece that is loaded: all of it, and the parts of it that
/// are square roots and that make sure that the curve and the polynomial go on everywhere.
fn fit(image: &Image, servos: &Mounting) -> Result<BTreeMap<String, u32>, Error> {
    let stages = Stages::new(image)?;
    let calls = Calls::new(image, image.function_named(FIT)?)?;
    let (header, pieces) = job(Kind::Spline, Order::First);
    let run = run_job(image, servos, header, pieces, 1.0, |probe| probe.count_calls(calls))?;
    // Both pieces are the same curve; an interrupt may have come into one of their fits.
    let whole = run.seen.calls.iter().find(|call| call.is_whole());
    let whole = whole.ok_or_else(|| Error::new(format!("none of {} fits was left alone", run.seen.calls.len())))?;
    let part = |functions: &[&str]| {
        let counts = whole.executed.iter();
        counts.filter(|&(&address, _)| stages.is_within(address, functions)).map(|(_, count)| count).sum()
    };
    Ok(BTreeMap::from([
        ("most".to_owned(), whole.instructions()),
        ("roots".to_owned(), part(&["::sqrt"])),
        ("checks".to_owned(), part(&["::moves", "::grows", "::sign"])),
    ]))
}

/// The rows of `image` in a machine of three step axes: the interrupt along an offset PH piece, and at rest, in instructions.
pub fn measure_steps(
    image: &Image,
    steps: &Mounting,
    mut progress: impl FnMut(&str),
) -> Result<BTreeMap<String, BTreeMap<String, u32>>, Error> {
    let (mut rows, mut stack) = (BTreeMap::new(), 0);
    for (rate, name) in [(900_000.0, "steps 3 x 900000/s"), (100_000.0, "steps 3 x 100000/s")] {
        progress(name);
        let (header, pieces) = diagonal(rate);
        let counted = run_job(image, steps, header, pieces, 1.0, |_| {})?;
        stack = stack.max(counted.seen.handler_stack);
        let ticks = &counted.seen.ticks;
        let whole = |median, most| BTreeMap::from([("median".to_owned(), median), ("most".to_owned(), most)]);
        let most = ticks.iter().map(|tick| tick.instructions).max().unwrap_or(0);
        rows.insert(name.to_owned(), whole(median(ticks.iter().map(|tick| tick.instructions)), most));
        let rest = &counted.seen.resting;
        rows.insert("steps at rest".to_owned(), BTreeMap::from([("median".to_owned(), median(rest.iter().copied()))]));
    }
    rows.insert("steps stack bytes".to_owned(), BTreeMap::from([("most".to_owned(), stack + EXCEPTION_FRAME)]));
    Ok(rows)
}

/// The middle one of some counts; the upper of two.
pub fn median(counts: impl Iterator<Item = u32>) -> u32 {
    let mut counts: Vec<u32> = counts.collect();
    counts.sort_unstable();
    counts.get(counts.len() / 2).copied().unwrap_or(0)
}
