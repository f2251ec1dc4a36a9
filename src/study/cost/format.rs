//! Numbers as people read them.

/// Percentages below it are written as powers of ten.
const SMALLEST: f64 = 1e-4;

/// A part of one as percent with two digits.
pub fn percent(part: f64) -> String {
    let percent = 100.0 * part.abs();
    if percent > 0.0 && percent < SMALLEST { format!("{percent:.0e} %") } else { format!("{} %", two_digits(percent)) }
}

/// The same with its sign.
pub fn signed(part: f64) -> String {
    format!("{}{}", if part < 0.0 { "-" } else { "+" }, percent(part))
}

/// A positive number with two digits, or as many as it has before the point.
pub fn two_digits(number: f64) -> String {
    if number == 0.0 || !number.is_finite() {
        return number.to_string();
    }
    let decimals = (1.0 - number.log10().floor()).clamp(0.0, 8.0) as usize;
    format!("{number:.decimals$}")
}

/// Seconds with three digits.
pub fn seconds(seconds: f64) -> String {
    let decimals = if seconds > 0.0 { (2.0 - seconds.log10().floor()).clamp(0.0, 4.0) as usize } else { 0 };
    format!("{seconds:.decimals$}")
}

/// A count, in thousands where it is large.
pub fn thousands(count: f64) -> String {
    if count < 1e4 { format!("{count:.0}") } else { format!("{:.0} k", count / 1e3) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_matter() {
        assert_eq!([0.01, 0.000321, 0.5, 1.234, 0.0, 2e-9].map(percent), ["1.0 %", "0.032 %", "50 %", "123 %", "0 %", "2e-7 %"]);
        assert_eq!([0.00212, 0.0123, 1.5, 123.4].map(seconds), ["0.0021", "0.0123", "1.50", "123"]);
        assert_eq!(signed(-0.00172), "-0.17 %");
        assert_eq!([450.0, 136_107.0].map(thousands), ["450", "136 k"]);
    }
}
