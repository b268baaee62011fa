//! The largest tool that touches C at a given point and cuts nowhere into it.
//!
//! A disc of radius D that touches at r stands at r + D m. It is clear of a point q of C as long as
//! |q - r|^2 >= 2 D m . (q - r), so every q allows radii up to |q - r|^2 / (2 m . (q - r)), and the disc of the next try is the
//! one that the nearest point of C to the centre allows: it shrinks until nothing is inside (the shrinking ball of medial
//! axis programs). At r itself the limit is the radius of curvature.
//!
//! For the trimming this says more than the clearance of a removed point does. That is at most |d| by construction, for
//! right and wrong trimmings alike; the largest touching radius is above |d| exactly where a point should have been kept.

use shared::complex::Complex;

use super::nearest::Nearest;

/// Discs tried before the last one is taken for the answer; each is far nearer to it than the one before.
const TRIES: u32 = 64;
/// Roundoffs of a distance, in parts of the coordinates' size.
const ROUNDOFF: f64 = 8.0 * f64::EPSILON;
/// Two contacts that form a larger angle than this, as seen from the disc, are told apart to roundoffs.
const CLOSE: f64 = 0.1;
/// Where C bends beside a contact by this part of the disc's curvature or more, a second contact may be arbitrarily close.
const TIGHT: f64 = 0.999;

/// A contact, and the directions from which a tool comes to it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    /// The point of C, in mm.
    pub(super) point: Complex<f64>,
    /// The unit normal towards the tool.
    pub(super) normal: Complex<f64>,
    /// The curvature of C that limits the tool, positive where C bends towards it, in 1/mm; 0 at a corner that the tool goes
    /// around.
    pub(super) bend: f64,
    /// The largest curvature just beside the contact: the same inside a segment, that of the neighbours at a corner.
    pub(super) beside: f64,
}

/// The largest radius up to `most` of a disc that touches at `contact` and has no point of the contour inside: what is certain
/// of it, without what rounding leaves open. In mm.
pub(super) fn touching_radius(nearest: &Nearest<'_>, contact: Contact, most: f64) -> f64 {
    let Contact { point, normal, bend, beside } = contact;
    let limit = if bend * most > 1.0 { 1.0 / bend } else { most };
    let mut radius = limit;
    // The angle at the centre between this contact and the one that stopped the disc before.
    let mut angle: f64 = 0.0;
    let rounding = ROUNDOFF * (nearest.size() + most);
    for _ in 0..TRIES {
        let foot = nearest.at(point + normal * radius);
        if foot.distance >= radius - rounding {
            break;
        }
        let chord = foot.point - point;
        let ahead = chord.dot(normal);
        let next = chord.norm_sqr() / (2.0 * ahead);
        // A foot that rounding has put level with the contact, or behind it, is the contact.
        if !(ahead > 0.0 && next < radius) {
            break;
        }
        radius = next;
        angle = 2.0 * (chord.norm() / (2.0 * radius)).min(1.0).asin();
    }
    // With a second contact at the angle t, a disc that is too large by the part x overlaps C by x t^2/2 of its radius: what is
    // below rounding is not seen. Beside a tight bend t may be anything, but then the bend limits x to t^2: the worst t is where
    // both meet.
    let part = rounding / radius;
    let seen = if angle > 0.0 { angle.min(CLOSE) } else { CLOSE };
    let open = if beside * radius < TIGHT { 2.0 * part / (seen * seen) } else { 4.0 * part.sqrt() };
    radius * (1.0 - open)
}
