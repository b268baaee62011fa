//! One tick of the controller, from the inputs at its pins to what its drives get: safety, path or homing, axes.
//!
//! [`Control::tick`] is the whole of it, on a board, in the simulator, and in tests: levels and counts go in, commands and enable levels come
//! out, and pulses go into a [`Ring`]. In every tick
//!
//! 1. the axes are sensed: a servo too far from its setpoint, or a ring that was not filled in time, is a fault;
//! 2. [`Safety`] says what holds for this tick, with one event: a fault first, then news of the motion, then what was asked for;
//! 3. the path is walked, or the search for home goes on, or nothing moves;
//! 4. the axes follow, or, without power, rest where they are.
//!
//! So a fault acts in the tick whose inputs show it: no pulse of a later tick is played, commands are zero, enables are off.
//!
//! Paths have coordinates of their own: a path in machine coordinates begins where the machine stands, one from here is moved so that it
//! does. A path that does not speak of z leaves z where it is.
//!
//! Cost: that of its parts, see `budget.toml`; no heap, no panic path, no loop but over axes and over the pieces that are dropped.

mod axes;
mod directive;
mod ring;
mod status;
mod words;

pub use axes::{Axes, AxesError, Commands, StepPins, step_settings};
pub use directive::{Directive, DirectiveError, Start};
pub use ring::{Late, Ring};
pub use status::{PathEnd, Status};
pub use words::{answer_of, answer_word};

use crate::executor::{Executor, Pieces};
use crate::fixed::{Fixed, Position, UNITS_PER_MM};
use crate::hash::SetpointHash;
use crate::homing::{Homing, HomingPlan, Step};
use crate::machine::Machine;
use crate::motion;
use crate::motion::MotionCommand;
use crate::safety::{Coordinates, Event, Fault, Levels, Refused, ResetCause, Safety, SafetyConfig, State, Wiring};
use crate::steps::MOST_AXES;

/// How far from the first point of a path in machine coordinates the machine may stand, in mm: a distance that no drive notices.
pub const AWAY_MM: f64 = 1e-3;

/// What the tick sees.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<const AXES: usize> {
    /// The levels at the pins, polarity not applied.
    pub pins: Levels,
    /// Whether the emergency stop acted since the tick before, however shortly.
    pub stopped: bool,
    /// What the encoders' counters read.
    pub counts: [i32; AXES],
}

/// What comes of a tick, beside the pulses.
#[derive(Clone, Copy, Debug)]
pub struct Outputs<const AXES: usize> {
    /// Whether the drives have power. Without it, commands are zero and no pulse is played.
    pub drives: bool,
    /// The levels of the enable outputs, polarity applied; bit k is axis k.
    pub enables: u8,
    /// What the drives get.
    pub commands: Commands<AXES>,
    /// What came of a directive that was taken in this tick.
    pub answer: Option<Result<(), DirectiveError>>,
}

/// What moves the axes.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "there is one, and no heap")]
enum Activity {
    /// Nothing.
    Rest,
    /// The executor.
    Path,
    /// A search for home, and what its last tick came to.
    Homing(Homing, Option<Step>),
}

/// The state of everything that moves. `AXES` is how many connectors the board has.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Control<const AXES: usize, const PORTS: usize, const SLOTS: usize> {
    // What every tick reads comes first, within reach of one load each.
    executor: Executor<f32>,
    axes: Axes<AXES, PORTS, SLOTS>,
    wiring: Wiring,
    config: SafetyConfig,
    enables: u8,
    enables_low: u8,
    plan: HomingPlan,
    safety: Safety,
    powered: bool,
    activity: Activity,
    /// What the path's coordinates need to become the machine's.
    offset: Position,
    /// An axis that could not keep up in the tick before, or that left its travel, which the checks before motion should not have let it.
    late: Option<Fault>,
    path: PathEnd,
    hash: SetpointHash,
    ticks: u32,
}

impl<const AXES: usize, const PORTS: usize, const SLOTS: usize> Control<AXES, PORTS, SLOTS> {
    /// A machine after a reset: at rest, with every position unknown. Load time. Errors: a machine that this controller cannot drive.
    pub fn new(machine: &Machine, pins: &[StepPins; AXES], cause: ResetCause) -> Result<Self, AxesError> {
        Ok(Self {
            wiring: machine.wiring,
            config: machine.safety,
            enables: machine.enables,
            enables_low: machine.enables_low,
            plan: machine.homing,
            safety: Safety::after_reset(cause),
            powered: false,
            executor: Executor::new(crate::TICK, [Fixed(0); 3]),
            activity: Activity::Rest,
            offset: [Fixed(0); 3],
            axes: Axes::new(machine, pins)?,
            late: None,
            path: PathEnd::None,
            hash: SetpointHash::new(),
            ticks: 0,
        })
    }

    /// One tick. `next` is asked for a directive where there is time for one.
    #[inline(always)]
    pub fn tick(
        &mut self,
        inputs: &Inputs<AXES>,
        next: impl FnOnce() -> Option<Directive>,
        pieces: &mut impl Pieces<f32>,
        ring: &mut impl Ring<PORTS, SLOTS>,
    ) -> Outputs<AXES> {
        let mut levels = self.wiring.levels(inputs.pins);
        levels.estop |= inputs.stopped;
        let sensed = self.axes.sense(inputs.counts);
        let half = if ring.is_played() { ring.next_half().map(Some) } else { Ok(None) };

        // A stop's interrupt has stopped the ring already: that it was not filled since is the stop's doing.
        let (event, directive) = self.event(sensed, half.is_err() && !levels.estop, next);
        let away = directive.as_ref().and_then(|directive| self.away(directive));
        let event = if away.is_some() { None } else { event };
        let allowed = self.safety.step(&self.config, levels, event);
        self.take_power(allowed.drives, allowed.advance, allowed.fault, pieces, ring);

        let mut started = false;
        let answer = directive.map(|directive| match away.or(allowed.refused) {
            Some(refused) => Err(DirectiveError::Machine(refused)),
            None => {
                started = matches!(directive, Directive::Start(_));
                self.obey(&directive, levels, pieces)
            }
        });
        let targets = if started { self.axes.targets() } else { self.advance(allowed.state, &levels, pieces) };
        let on_path = matches!(self.activity, Activity::Path);
        let left = if on_path { self.axes.leaving(&targets, allowed.known) } else { None };

        let mut commands = Commands::ZERO;
        if allowed.drives {
            let half = if ring.is_played() { half.unwrap_or(None) } else { None };
            let (found, followed) = self.axes.follow(targets, half, ring);
            commands = found;
            self.late = followed.err().or(left.map(|axis| Fault::SoftLimit { axis }));
        } else {
            self.axes.go_limp();
        }
        self.powered = allowed.drives;
        let on = if allowed.drives { self.enables } else { 0 };
        Outputs { drives: allowed.drives, enables: on ^ self.enables_low, commands, answer }
    }

    /// The event of this tick, and the directive if that is where it comes from.
    #[inline(always)]
    fn event(
        &mut self,
        sensed: Result<(), Fault>,
        is_late: bool,
        next: impl FnOnce() -> Option<Directive>,
    ) -> (Option<Event>, Option<Directive>) {
        if self.powered {
            let fault = sensed.err().or(self.late.take()).or(is_late.then_some(Fault::LateTick));
            if let Some(fault) = fault {
                return (Some(Event::Trip(fault)), None);
            }
        }
        if let Some(news) = self.news() {
            return (Some(news), None);
        }
        let directive = next();
        (directive.as_ref().and_then(|directive| directive.event(self.plan.axes())), directive)
    }

    /// What the last tick's motion has come to. Each is told once.
    #[inline(always)]
    fn news(&mut self) -> Option<Event> {
        match &mut self.activity {
            Activity::Rest => None,
            Activity::Path => {
                let (event, path) = match self.executor.state() {
                    motion::State::Finished => (Event::End, PathEnd::Finished),
                    motion::State::Cancelled => (Event::AtRest, PathEnd::Cancelled),
                    _ => return None,
                };
                (self.activity, self.path) = (Activity::Rest, path);
                Some(event)
            }
            Activity::Homing(_, step) => {
                let found = step.as_mut()?;
                if let Some((axis, fault)) = found.fault {
                    return Some(Event::Trip(Fault::Homing { axis, fault }));
                }
                if found.homed != 0 {
                    let axes = core::mem::take(&mut found.homed);
                    return Some(Event::AxisHomed { axes });
                }
                let event = match self.safety.state() {
                    State::Braking if found.at_rest => Event::AtRest,
                    _ if found.done => Event::Homed,
                    _ => return None,
                };
                self.activity = Activity::Rest;
                Some(event)
            }
        }
    }

    /// The axis that is not where a path in machine coordinates begins.
    #[inline(always)]
    fn away(&self, directive: &Directive) -> Option<Refused> {
        let Directive::Start(Start { coordinates: Coordinates::Machine, at: [x, y], further, .. }) = directive else {
            return None;
        };
        if self.safety.start_refusal(&self.config, Coordinates::Machine).is_some() {
            // It is refused for that.
            return None;
        }
        let [hx, hy, hz] = self.here();
        let z = further.map_or(hz, |[z]| z);
        let slack = (AWAY_MM * UNITS_PER_MM) as u32;
        (0..).zip([(hx, *x), (hy, *y), (hz, z)]).find_map(|(axis, (here, at))| {
            (here.0.wrapping_sub(at.0).unsigned_abs() > slack).then_some(Refused::Away { axis })
        })
    }

    /// Where the machine shall be now.
    #[inline(always)]
    fn here(&self) -> Position {
        self.axes.position(&self.axes.targets())
    }

    /// What power or its absence means for everything that moves.
    #[inline(always)]
    fn take_power(
        &mut self,
        drives: bool,
        advance: bool,
        fault: Option<Fault>,
        pieces: &mut impl Pieces<f32>,
        ring: &mut impl Ring<PORTS, SLOTS>,
    ) {
        if !advance && !matches!(self.activity, Activity::Rest) {
            self.give_up(fault, pieces);
        }
        match (self.powered, drives) {
            (_, false) => ring.stop(),
            (false, true) => self.axes.play(ring),
            (true, true) => {}
        }
    }

    #[cold]
    #[inline(never)]
    fn give_up(&mut self, fault: Option<Fault>, pieces: &mut impl Pieces<f32>) {
        if matches!(self.activity, Activity::Path) {
            self.path = fault.map_or(PathEnd::Stopped, PathEnd::Faulted);
        }
        self.activity = Activity::Rest;
        self.executor.abort();
        pieces.discard();
    }

    /// Carries out what safety has allowed.
    #[inline(always)]
    fn obey(
        &mut self,
        directive: &Directive,
        levels: Levels,
        pieces: &mut impl Pieces<f32>,
    ) -> Result<(), DirectiveError> {
        match *directive {
            Directive::Motion(command) => return self.change(command),
            Directive::Start(start) => self.start(&start),
            Directive::Home { axes } => self.home(axes, &levels),
            Directive::Clear => return self.clear(pieces),
            Directive::Acknowledge => {}
        }
        Ok(())
    }

    #[inline(always)]
    fn change(&mut self, command: MotionCommand) -> Result<(), DirectiveError> {
        let outside = matches!(self.activity, Activity::Homing(..));
        if outside && matches!(command, MotionCommand::Hold | MotionCommand::Resume | MotionCommand::Cancel) {
            // The search comes to rest because of the machine's state.
            return Ok(());
        }
        self.executor.command(command).map_err(DirectiveError::Motion)
    }

    #[cold]
    #[inline(never)]
    fn start(&mut self, start: &Start) {
        let [x, y] = start.at;
        let [z] = start.further.unwrap_or([Fixed(0)]);
        let at = [x, y, z];
        let here = self.here();
        self.offset = match (start.coordinates, start.further) {
            (Coordinates::Machine, Some(_)) => [Fixed(0); 3],
            // Its z is its own, and that of the machine rests.
            (Coordinates::Machine, None) => [Fixed(0), Fixed(0), here[2]],
            (Coordinates::Relative, _) => sum(here, at.map(|Fixed(c)| Fixed(c.wrapping_neg()))),
        };
        self.executor.stand_at(at);
        self.executor.begin(&start.motion);
        (self.activity, self.path) = (Activity::Path, PathEnd::Running);
        (self.hash, self.ticks) = (SetpointHash::new(), 0);
    }

    #[cold]
    #[inline(never)]
    fn home(&mut self, axes: u8, levels: &Levels) {
        let axes = if axes == 0 { self.plan.axes() } else { axes };
        let mut position = [Fixed(0); MOST_AXES];
        position.iter_mut().zip(self.axes.targets()).for_each(|(place, target)| *place = target);
        let search = Homing::begin(&self.plan, axes, position, self.plan.switches(levels));
        for axis in 0..AXES {
            if axes >> axis & 1 != 0 {
                self.axes.stand_at(axis, Fixed(0));
            }
        }
        self.activity = Activity::Homing(search, None);
    }

    #[cold]
    #[inline(never)]
    fn clear(&mut self, pieces: &mut impl Pieces<f32>) -> Result<(), DirectiveError> {
        if matches!(self.activity, Activity::Path) {
            return Err(DirectiveError::Machine(Refused::State { state: self.safety.state() }));
        }
        self.executor.abort();
        self.path = PathEnd::None;
        pieces.discard();
        Ok(())
    }

    /// Where the axes shall be at the next tick.
    #[inline(always)]
    fn advance(&mut self, state: State, levels: &Levels, pieces: &mut impl Pieces<f32>) -> [Fixed; AXES] {
        match &mut self.activity {
            Activity::Rest => self.axes.targets(),
            Activity::Path => {
                self.walk(pieces);
                self.axes.of_position(&sum(self.executor.setpoint(), self.offset))
            }
            Activity::Homing(search, last) => {
                let step = search.step(&self.plan, self.plan.switches(levels), state == State::Braking);
                *last = Some(step);
                self.follow_search(&step)
            }
        }
    }

    /// A function of its own: the arithmetic of a curve wants all registers for itself.
    #[inline(never)]
    fn walk(&mut self, pieces: &mut impl Pieces<f32>) {
        if self.executor.state().is_moving() || self.executor.state() == motion::State::Held {
            self.hash.add(self.executor.tick(pieces));
            self.ticks = self.ticks.wrapping_add(1);
        }
    }

    #[cold]
    #[inline(never)]
    fn follow_search(&mut self, step: &Step) -> [Fixed; AXES] {
        let mut targets = self.axes.targets();
        for (axis, (target, setpoint)) in targets.iter_mut().zip(step.setpoint).enumerate() {
            if step.homed >> axis & 1 != 0 {
                self.axes.stand_at(axis, setpoint);
            }
            *target = setpoint;
        }
        targets
    }

    /// How the machine stands after this tick, which had these outputs.
    #[inline(always)]
    pub fn status(&self, outputs: &Outputs<AXES>) -> Status<AXES> {
        let (state, fault, known) = self.safety.summary();
        Status {
            machine: state,
            motion: self.executor.state(),
            path: self.path,
            fault,
            known,
            percent: self.executor.percent(),
            ticks: self.ticks,
            pieces: self.executor.place().map_or(0, |place| place.piece.wrapping_add(1)),
            setpoint: self.executor.setpoint(),
            position: self.here(),
            actual: self.axes.position(&self.axes.actual()),
            hash: self.hash.value(),
            residual: self.executor.spare_time(),
            told: self.axes.told(&outputs.commands),
        }
    }
}

/// The sum of two positions, coordinate by coordinate.
#[inline(always)]
fn sum(a: Position, b: Position) -> Position {
    let ([ax, ay, az], [bx, by, bz]) = (a, b);
    let add = |a: Fixed, b: Fixed| Fixed(a.0.wrapping_add(b.0));
    [add(ax, bx), add(ay, by), add(az, bz)]
}
