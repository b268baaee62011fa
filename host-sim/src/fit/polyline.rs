//! A polyline by the way along it.

use crate::vector::Vector;

/// Points, and the way to each of them.
#[derive(Clone, Debug)]
pub(super) struct Polyline<'a> {
    pub points: &'a [Vector],
    pub ways: Vec<f64>,
    /// The first and the second derivative by the way that a curve must have at the start and at the end, where something is given: closed
    /// loops go on there.
    pub held: [Option<[Vector; 2]>; 2],
}

impl<'a> Polyline<'a> {
    pub(super) fn new(points: &'a [Vector]) -> Self {
        let mut way = 0.0;
        let mut ways = Vec::with_capacity(points.len());
        for (k, point) in points.iter().enumerate() {
            way += if k > 0 { (*point - points[k - 1]).norm() } else { 0.0 };
            ways.push(way);
        }
        Self { points, ways, held: [None; 2] }
    }

    pub(super) fn length(&self) -> f64 {
        self.ways.last().copied().unwrap_or(0.0)
    }

    /// The number of the segment on which a way ends.
    pub(super) fn segment(&self, way: f64) -> usize {
        self.ways.partition_point(|&at| at <= way).clamp(1, self.points.len() - 1) - 1
    }

    /// The point at a way that ends on segment `k`.
    pub(super) fn on(&self, k: usize, way: f64) -> Vector {
        let step = self.ways[k + 1] - self.ways[k];
        self.points[k].toward(self.points[k + 1], ((way - self.ways[k]) / step).clamp(0.0, 1.0))
    }

    /// The vertices strictly between two ways.
    pub(super) fn between(&self, from: f64, to: f64) -> std::ops::Range<usize> {
        let first = self.ways.partition_point(|&at| at <= from);
        first..self.ways.partition_point(|&at| at < to).max(first)
    }
}
