//! Numbers on their way into a picture: fewer points with the same peaks, round ticks, short texts.

/// A point of a series or of a picture.
pub type Point = (f64, f64);

/// At most two points for each of `columns` even columns over `span`: the lowest and the highest of it, in their order; and the
/// series' first and last point. A line through them shows every peak that a line through all would show.
pub fn decimate(points: impl IntoIterator<Item = Point>, span: (f64, f64), columns: usize) -> Vec<Point> {
    let per_column = columns as f64 / (span.1 - span.0).max(f64::MIN_POSITIVE);
    let mut kept = Vec::new();
    let mut column: Option<(i64, usize, Point, usize, Point)> = None;
    let mut close = |column: Option<(i64, usize, Point, usize, Point)>| {
        if let Some((_, low_at, low, high_at, high)) = column {
            match low_at.cmp(&high_at) {
                std::cmp::Ordering::Less => kept.extend([low, high]),
                std::cmp::Ordering::Equal => kept.push(low),
                std::cmp::Ordering::Greater => kept.extend([high, low]),
            }
        }
    };
    let mut ends: Option<(Point, Point)> = None;
    for (at, point) in points.into_iter().filter(|p| p.0.is_finite() && p.1.is_finite()).enumerate() {
        ends = Some((ends.map_or(point, |(first, _)| first), point));
        let number = ((point.0 - span.0) * per_column).floor() as i64;
        column = match column {
            Some((same, low_at, low, high_at, high)) if same == number => {
                let (low_at, low) = if point.1 < low.1 { (at, point) } else { (low_at, low) };
                let (high_at, high) = if point.1 > high.1 { (at, point) } else { (high_at, high) };
                Some((number, low_at, low, high_at, high))
            }
            before => {
                close(before);
                Some((number, at, point, at, point))
            }
        };
    }
    close(column);
    if let Some((first, last)) = ends {
        if kept.first() != Some(&first) {
            kept.insert(0, first);
        }
        if kept.last() != Some(&last) {
            kept.push(last);
        }
    }
    kept
}

/// The lowest and the highest value of a series, zero among them.
pub fn extent<'a>(points: impl IntoIterator<Item = &'a Point>) -> (f64, f64) {
    points.into_iter().fold((0.0, 0.0), |(low, high), point| (low.min(point.1), high.max(point.1)))
}

/// The smallest of 1, 2, 5 times a power of ten that is at least `least`.
pub fn round_step(least: f64) -> f64 {
    if !(least > 0.0 && least.is_finite()) {
        return 1.0;
    }
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0]
        .map(|digit| digit * power)
        .into_iter()
        .find(|&step| step >= least * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// The multiples of `step` within `low..=high`, with the text of each.
pub fn ticks(low: f64, high: f64, step: f64) -> Vec<(f64, String)> {
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let slack = 1e-9 * step;
    let first = ((low - slack) / step).ceil() as i64;
    let last = ((high + slack) / step).floor() as i64;
    // A picture has room for a few dozen ticks; more would be a fault of the step.
    (first..=last.min(first + 200)).map(|k| (k as f64 * step, number(k as f64 * step, decimals))).collect()
}

/// `value` with so many decimals, with a true minus sign and without a negative zero.
pub fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| matches!(c, '0' | '.')) => rest.to_string(),
        Some(rest) => format!("\u{2212}{rest}"),
        None => text,
    }
}

/// `value` with three figures that count, for a maximum beside its curve.
pub fn three_figures(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return number(0.0, 0);
    }
    number(value, (2.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A peak of one sample among a hundred thousand stays, upwards and downwards, wherever it is.
    #[test]
    fn decimation_keeps_extremes() {
        let count = 100_000;
        for peak in [0, 1, 777, 50_000, 99_998, 99_999] {
            for height in [9.0, -9.0] {
                let series = (0..count).map(|k| {
                    let y = if k == peak { height } else { (f64::from(k) * 0.37).sin() };
                    (f64::from(k), y)
                });
                let kept = decimate(series, (0.0, f64::from(count)), 500);
                assert!(kept.contains(&(f64::from(peak), height)), "peak {peak}");
                assert!(kept.len() <= 2 * 500 + 2);
                assert!(kept.is_sorted_by(|a, b| a.0 < b.0));
            }
        }
    }

    /// Every column keeps its own lowest and highest value.
    #[test]
    fn decimation_keeps_every_columns_extremes() {
        let series: Vec<Point> =
            (0..6000).map(|k| (f64::from(k), (f64::from(k * k % 7919)) * (0.5 - f64::from(k % 3)))).collect();
        let kept = decimate(series.iter().copied(), (0.0, 6000.0), 60);
        for column in 0..60 {
            let within = |p: &&Point| (p.0 / 100.0) as i32 == column;
            assert_eq!(extent(series.iter().filter(within)), extent(kept.iter().filter(within)), "column {column}");
        }
    }

    #[test]
    fn short_series_stay_whole() {
        let series = [(0.0, 1.0), (1.0, 3.0), (2.0, 2.0)];
        assert_eq!(decimate(series, (0.0, 2.0), 500), series);
        assert_eq!(decimate([], (0.0, 2.0), 500), []);
    }

    #[test]
    fn ticks_are_round_and_cover_the_span() {
        assert_eq!(round_step(0.03), 0.05);
        assert_eq!(round_step(0.2), 0.2);
        assert_eq!(round_step(700.0), 1000.0);
        let texts = |low, high, step| ticks(low, high, step).into_iter().map(|t| t.1).collect::<Vec<_>>();
        assert_eq!(texts(-0.1, 0.2, 0.1), ["\u{2212}0.1", "0.0", "0.1", "0.2"]);
        assert_eq!(texts(0.0, 1600.0, 500.0), ["0", "500", "1000", "1500"]);
    }

    #[test]
    fn numbers_read_well() {
        assert_eq!(number(-0.0004, 2), "0.00");
        assert_eq!(number(-34.2, 1), "\u{2212}34.2");
        assert_eq!(three_figures(0.001_234), "0.00123");
        assert_eq!(three_figures(1599.8), "1600");
        assert_eq!(three_figures(0.0), "0");
    }
}
