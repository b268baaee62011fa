//! What a program comes to: motions along exact curves, and events between them.
//!
//! Lengths are mm, times seconds, angles radians. Points are of the tool's tip in the program's frame
//! ([module documentation](super)).

/// One thing that a program does, and where the program says so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Item<'a> {
    /// The line, from 1.
    pub line: usize,
    /// The column, in characters from 1, of the word that asks for it.
    pub column: usize,
    /// Where the tool is before it: where the last motion ended, unless the length of the tool has changed since.
    pub from: [f64; 3],
    /// The feed that holds, for motions other than rapids.
    pub feed: Feed,
    /// What is done.
    pub action: Action<'a>,
}

/// How fast a motion is asked to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Feed {
    /// Nothing was said yet.
    Unset,
    /// Along the path, in mm/s.
    Rate(f64),
    /// The whole motion takes this long, in s (inverse time).
    Duration(f64),
}

/// A motion or an event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action<'a> {
    /// The tool moves.
    Motion(Motion<'a>),
    /// The motion behind this one also takes an axis other than X, Y and Z along.
    Further {
        /// `A`, `B`, `C` (degrees), `U`, `V` or `W` (mm).
        axis: char,
        /// Where the axis is at the end of that motion.
        to: f64,
    },
    /// Everything rests for so many seconds.
    Dwell(f64),
    /// How exactly what follows is to be run.
    PathMode(PathMode),
    /// What follows is the contour and no longer the tool's path, or the other way round.
    Compensation(Compensation),
    /// The length of the tool in use changes: its tip is so far from where it was measured without one, in mm.
    ToolLength([f64; 3]),
    /// The tool of this number is wanted next.
    ToolSelect(u32),
    /// The tool of this number is put in; 0 is none.
    ToolChange(u32),
    /// The spindle turns in another way.
    Spindle(Spindle),
    /// The coolant runs in another way.
    Coolant(Coolant),
    /// The program waits for a person.
    Stop {
        /// Only where the person asked for it.
        optional: bool,
    },
    /// The program has ended; nothing follows.
    End,
}

/// A motion of the tool from [`Item::from`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion<'a> {
    /// As fast as the machine can.
    Rapid {
        /// Its end.
        to: [f64; 3],
    },
    /// Straight.
    Line {
        /// Its end.
        to: [f64; 3],
    },
    /// Along a circle or helix.
    Arc(Arc),
    /// A polynomial curve.
    Bezier {
        /// The control points behind the start, the end being the last: two for a quadratic curve, three for a cubic one.
        points: &'a [[f64; 3]],
    },
    /// A rational B-spline.
    Nurbs(Nurbs<'a>),
}

/// A part of a circle or helix, or several turns of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// The plane of the circle.
    pub plane: Plane,
    /// The centre, along the two axes of the plane.
    pub centre: [f64; 2],
    /// The end. Its distance from the centre may differ a little from the start's: programs are rounded.
    pub to: [f64; 3],
    /// The angle in all, whole turns included; positive from the plane's first axis to the second.
    pub sweep: f64,
    /// How many whole turns are made before the part that the ends alone would give.
    pub turns: u32,
}

/// A non-uniform rational B-spline. There are as many weights as points, and `order` more knots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nurbs<'a> {
    /// The degree and one.
    pub order: usize,
    /// The control points; the first is where the tool is.
    pub points: &'a [[f64; 3]],
    /// The weight of each point, positive.
    pub weights: &'a [f64],
    /// The knots, never falling.
    pub knots: &'a [f64],
}

/// The plane of arcs and of cutter compensation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// G17.
    Xy,
    /// G18; Z comes first, so that the three axes are right-handed.
    Zx,
    /// G19.
    Yz,
}

impl Plane {
    /// The numbers of its first and second axis and of the axis across.
    pub fn axes(self) -> [usize; 3] {
        match self {
            Self::Xy => [0, 1, 2],
            Self::Zx => [2, 0, 1],
            Self::Yz => [1, 2, 0],
        }
    }
}

/// How exactly a path is to be run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathMode {
    /// On the path, as fast as that allows (G61).
    Exact,
    /// On the path, with a rest at the end of each motion (G61.1).
    Stop,
    /// Off the path, to be faster (G64).
    Blend {
        /// By no more than this (P); without it as far as speed asks for.
        tolerance: Option<f64>,
        /// Points that are nearer than this to a line may be left out (Q).
        thinning: Option<f64>,
    },
}

/// On which side of the programmed path the tool runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Compensation {
    /// On it.
    Off,
    /// Beside it, seen in the direction of travel.
    On {
        /// The side.
        side: Side,
        /// The tool.
        cutter: Cutter,
    },
}

/// A side of the path, seen in the direction of travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// G41.
    Left,
    /// G42.
    Right,
}

/// What says how far the tool's centre is from the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cutter {
    /// The tool that is in the spindle.
    Loaded,
    /// This entry of the tool table.
    Number(u32),
    /// A tool of this diameter in mm.
    Diameter(f64),
}

/// What the spindle does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spindle {
    /// Whether and how it turns.
    pub turning: Turning,
    /// How fast, when it does.
    pub speed: Speed,
}

/// Whether and how a spindle turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turning {
    /// It stands.
    Off,
    /// M3.
    Clockwise,
    /// M4.
    Anticlockwise,
}

/// How fast a spindle turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Speed {
    /// In turns/s (G97).
    Turns(f64),
    /// So that the cut has this speed in mm/s (G96).
    Surface {
        /// The speed of the cut in mm/s.
        speed: f64,
        /// The most turns/s.
        most: Option<f64>,
    },
}

/// Which coolant runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coolant {
    /// M7.
    pub mist: bool,
    /// M8.
    pub flood: bool,
}

impl Motion<'_> {
    /// Where it ends; none for a curve without points, which no reader gives.
    pub fn to(&self) -> Option<[f64; 3]> {
        match *self {
            Self::Rapid { to } | Self::Line { to } | Self::Arc(Arc { to, .. }) => Some(to),
            Self::Bezier { points } | Self::Nurbs(Nurbs { points, .. }) => points.last().copied(),
        }
    }
}
