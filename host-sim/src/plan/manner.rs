//! How a path is run: where it rests, and how it begins and ends.

/// How a path goes on from piece to piece, and how it begins and ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manner {
    /// Where it rests on the way.
    pub rests: Rests,
    /// The speeds of the centre at which it begins and ends, in mm/s; none where that is free.
    pub ends: [Option<f64>; 2],
    /// Whether the job's own reductions of the feed at corners hold too.
    pub reductions: bool,
}

impl Manner {
    /// From rest to rest, and through all corners at what they bear.
    pub const USUAL: Self = Self { rests: Rests::Never, ends: [Some(0.0); 2], reductions: false };
}

/// Where a path rests on the way, as RS-274 has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rests {
    /// Nowhere: G64.
    #[default]
    Never,
    /// In every corner: G61.
    InCorners,
    /// Wherever one segment or fill ends and another begins: G61.1.
    AtNodes,
}
