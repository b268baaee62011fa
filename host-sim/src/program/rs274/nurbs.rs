//! The control points between G5.2 and G5.3, and the knots that LinuxCNC makes for them.

use super::fault::Fault;

/// The most control points of one curve: memory is bounded, and no curve of a part has so many.
const MOST: usize = 100_000;
/// The order where no L says another one.
const ORDER: usize = 3;

/// A curve while its points are read; it keeps its memory for the next one.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    /// The degree and one.
    pub order: usize,
    /// Control points, the first being where the tool was.
    pub points: Vec<[f64; 3]>,
    /// Their weights.
    pub weights: Vec<f64>,
    /// The knots, once the curve is closed.
    pub knots: Vec<f64>,
}

impl Curve {
    /// Whether a curve has begun.
    pub fn is_open(&self) -> bool {
        !self.points.is_empty()
    }

    /// Begins a curve at a place.
    pub fn begin(&mut self, place: [f64; 3], weight: f64) {
        self.clear();
        self.order = ORDER;
        self.points.push(place);
        self.weights.push(weight);
    }

    /// Adds a control point. Errors: there are too many.
    pub fn add(&mut self, point: [f64; 3], weight: f64) -> Result<(), Fault> {
        if self.points.len() >= MOST {
            return Err(Fault::NurbsMany(MOST));
        }
        self.points.push(point);
        self.weights.push(weight);
        Ok(())
    }

    /// Makes the knots: `order` of them at either end and whole numbers between, so that the curve goes through its ends.
    /// Errors: too few points.
    pub fn close(&mut self) -> Result<(), Fault> {
        let (count, order) = (self.points.len(), self.order);
        if count < order {
            return Err(Fault::NurbsFew(count, order));
        }
        let last = count - order + 1;
        self.knots.clear();
        self.knots.extend((0..count + order).map(|k| (k + 1).saturating_sub(order).min(last) as f64));
        Ok(())
    }

    /// Forgets the curve.
    pub fn clear(&mut self) {
        self.points.clear();
        self.weights.clear();
    }
}
