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
/// Contacts nearer to each other than this angle, as seen from the disc, are hard to tell from the curvature's limit.
const CLOSE: f64 = 0.1;

/// A contact, and the directions from which a tool comes to it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    /// The point of C, in mm.
    pub(super) point: Complex<f64>,
    /// The unit normal towards the tool.
    pub(super) normal: Complex<f64>,
    /// The curvature of C, positive where it bends towards the tool, in 1/mm; 0 at a corner that the tool goes around.
    pub(super) bend: f64,
}

/// The largest radius up to `most` of a disc that touches at `contact` and has no point of the contour inside: what is certain
/// of it, without what rounding leaves open. In mm.
pub(super) fn touching_radius(nearest: &Nearest<'_>, contact: Contact, most: f64) -> f64 {
    let Contact { point, normal, bend } = contact;
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
    // A second contact at the angle t makes a disc that is too large by the part x overlap by x t^2/2 of its radius: what is
    // below rounding is not seen. Where no second contact was met it may be close, but then curvature limits the radius to
    // a part t^2 above: the worst t is where both meet.
    let part = rounding / radius;
    let far = angle > CLOSE && limit > radius * 1.001;
    let open = if far || limit >= most { 2.0 * part / CLOSE.powi(2) } else { 4.0 * part.sqrt() };
    radius * (1.0 - open)
}
