//! Dates and lengths of time in words.

use std::time::{SystemTime, UNIX_EPOCH};

const DAY: u64 = 86_400;

/// The date and time of day, such as `2026-03-01 12:00:05 UTC`.
pub fn date(time: SystemTime) -> String {
    let seconds = time.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let ([year, month, day], rest) = (civil(seconds / DAY), seconds % DAY);
    format!("{year}-{month:02}-{day:02} {:02}:{:02}:{:02} UTC", rest / 3600, rest / 60 % 60, rest % 60)
}

/// The same as ISO 8601 has it, such as `2026-03-01T12:00:05+00:00`.
pub fn iso_date(time: SystemTime) -> String {
    date(time).replacen(' ', "T", 1).replace(" UTC", "+00:00")
}

/// A length of time in seconds, minutes and hours, such as `2 h 5 min`.
pub fn duration(seconds: f64) -> String {
    match seconds {
        short if short < 9.95 => format!("{short:.1} s"),
        short if short < 99.5 => format!("{short:.0} s"),
        middle if middle < 3600.0 => format!("{} min {} s", middle as u64 / 60, middle as u64 % 60),
        long => format!("{} h {} min", long as u64 / 3600, long as u64 / 60 % 60),
    }
}

/// Year, month and day of so many days after the first of January 1970.
///
/// Source: H. Hinnant, 2021, <https://howardhinnant.github.io/date_algorithms.html>.
fn civil(days: u64) -> [u64; 3] {
    let days = days + 719_468;
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    [year + era * 400 + u64::from(month <= 2), month, day]
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        let at = |seconds| date(UNIX_EPOCH + Duration::from_secs(seconds));
        assert_eq!(at(0), "1970-01-01 00:00:00 UTC");
        assert_eq!(at(951_827_696), "2000-02-29 12:34:56 UTC");
        assert_eq!(iso_date(UNIX_EPOCH + Duration::from_secs(951_827_696)), "2000-02-29T12:34:56+00:00");
        assert_eq!(at(1_772_366_399), "2026-03-01 11:59:59 UTC");
    }

    #[test]
    fn times_are_told_in_fitting_units() {
        assert_eq!([0.25, 42.4, 135.0, 7260.0].map(duration), ["0.2 s", "42 s", "2 min 15 s", "2 h 1 min"]);
    }
}
