//! Colours and measures that all pictures share.
//!
//! Lines differ in lightness as well as in hue, and the feed scale is viridis (even to the eye, rising in lightness), so
//! that everything can still be told apart in grey print.

use plotters::style::RGBColor;

/// Text and axes.
pub const INK: RGBColor = RGBColor(0x22, 0x26, 0x2b);
/// Tick labels.
pub const SOFT: RGBColor = RGBColor(0x55, 0x5b, 0x63);
/// Frames and base lines.
pub const FRAME: RGBColor = RGBColor(0xa9, 0xae, 0xb5);
/// Grid lines.
pub const GRID: RGBColor = RGBColor(0xe4, 0xe6, 0xe9);
/// The part inside a closed contour, and spans that do not count.
pub const GROUND: RGBColor = RGBColor(0xf1, 0xf0, 0xec);
/// What was measured, and the trimmed offset.
pub const MAIN: RGBColor = RGBColor(0x1c, 0x5d, 0x99);
/// What was commanded, and the untrimmed offset.
pub const OTHER: RGBColor = RGBColor(0xe0, 0x86, 0x2c);
/// Material that the tool leaves.
pub const LEFT: RGBColor = RGBColor(0xd9, 0x8c, 0x8c);
/// Paper.
pub const PAPER: RGBColor = RGBColor(0xff, 0xff, 0xff);

/// The height of text in units of a picture 640 wide: 9 px where such a picture is shown 360 px wide.
pub const TEXT: f64 = 16.0;
/// The width of every picture, in its own units.
pub const WIDTH: f64 = 640.0;

/// Viridis at nine even steps, from dark to light.
const VIRIDIS: [[f64; 3]; 9] = [
    [68.0, 1.0, 84.0],
    [71.0, 45.0, 123.0],
    [59.0, 82.0, 139.0],
    [44.0, 114.0, 142.0],
    [33.0, 145.0, 140.0],
    [40.0, 174.0, 128.0],
    [94.0, 201.0, 98.0],
    [173.0, 220.0, 48.0],
    [253.0, 231.0, 37.0],
];

/// The colour for `fraction` of the scale; what lies outside 0..=1 gets the colour of the end.
pub fn viridis(fraction: f64) -> RGBColor {
    let last = VIRIDIS.len() - 1;
    let place = if fraction.is_finite() { fraction.clamp(0.0, 1.0) * last as f64 } else { 0.0 };
    let below = (place as usize).min(last - 1);
    let part = place - below as f64;
    let [red, green, blue] =
        [0, 1, 2].map(|k| (VIRIDIS[below][k] * (1.0 - part) + VIRIDIS[below + 1][k] * part).round() as u8);
    RGBColor(red, green, blue)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Grey print keeps the order of the scale: its luma only rises.
    #[test]
    fn scale_rises_in_lightness() {
        let luma = |k: u32| {
            let RGBColor(r, g, b) = viridis(f64::from(k) / 100.0);
            0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b)
        };
        assert!((0..100).all(|k| luma(k + 1) > luma(k)));
    }

    #[test]
    fn scale_holds_at_its_ends() {
        assert_eq!(viridis(-1.0), viridis(0.0));
        assert_eq!(viridis(7.0), RGBColor(253, 231, 37));
        assert_eq!(viridis(f64::NAN), viridis(0.0));
    }
}
