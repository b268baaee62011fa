//! Decimal numbers as programs write them: digits with one point at most, blanks anywhere, no exponent.
//!
//! `str::parse` would need the digits without blanks, and is half of the time of reading a program. Up to 19 digits are
//! therefore gathered in an integer: where that is below 2^53 and the power of ten at most 22, both are exact in `f64` and
//! their one division is correctly rounded. Everything else goes to `str::parse`, so every value is the nearest `f64`.

/// The powers of ten that `f64` holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];
/// Digits that a `u64` holds whatever they are.
const DIGITS: u32 = 19;

/// The number without sign that begins at `from`, and the place behind it; none where there is no digit.
pub fn decimal(text: &[u8], from: usize) -> Option<(f64, usize)> {
    let (mut mantissa, mut digits, mut seen) = (0_u64, 0_u32, false);
    let (mut decimals, mut point) = (0_usize, false);
    let (mut at, mut end) = (from, from);
    while let Some(&byte) = text.get(at) {
        match byte {
            b'0'..=b'9' => {
                seen = true;
                // Zeros in front say nothing.
                digits += u32::from(digits > 0 || byte != b'0');
                if digits <= DIGITS {
                    mantissa = mantissa * 10 + u64::from(byte - b'0');
                }
                decimals += usize::from(point);
            }
            b'.' if !point => point = true,
            // A blank is part of the number only if more of it follows.
            b' ' | b'\t' => {
                at += 1;
                continue;
            }
            _ => break,
        }
        at += 1;
        end = at;
    }
    if !seen {
        return None;
    }
    match POWERS.get(decimals) {
        Some(power) if digits <= DIGITS && mantissa < 1 << f64::MANTISSA_DIGITS => Some((mantissa as f64 / power, end)),
        _ => Some((by_parse(text.get(from..end)?)?, end)),
    }
}

/// The number by the standard library, without the blanks.
fn by_parse(text: &[u8]) -> Option<f64> {
    let text: String = text.iter().filter(|byte| !byte.is_ascii_whitespace()).map(|&byte| char::from(byte)).collect();
    text.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn blanks_and_points_stand_where_they_like() {
        for (text, value, end) in [
            ("1", 1.0, 1),
            ("0.5X", 0.5, 3),
            (".5", 0.5, 2),
            ("5.", 5.0, 2),
            ("0. 12 34y", 0.1234, 8),
            ("12 Y", 12.0, 2),
            ("1.2.3", 1.2, 3),
            ("007", 7.0, 3),
        ] {
            assert_eq!(decimal(text.as_bytes(), 0), Some((value, end)), "{text}");
        }
        for text in ["", ".", "X", " ", "-1"] {
            assert_eq!(decimal(text.as_bytes(), 0), None, "{text}");
        }
    }

    proptest! {
        /// Every number is the `f64` that the standard library finds.
        #[test]
        fn as_the_standard_library_reads_it(text in "[0-9]{0,25}\\.?[0-9]{1,30}") {
            prop_assert_eq!(decimal(text.as_bytes(), 0), Some((text.parse().unwrap(), text.len())));
        }
    }
}
