//! Numbers as people read them.

/// Decimals of a viscosity and its parts.
pub const DECIMALS: usize = 4;

/// Half the width of a bar, in two digits.
pub fn bar(half: f64) -> String {
    let decimals = decimals_of_bar(half);
    format!("{half:.decimals$}")
}

/// A value and half the width of its bar, in two digits, to the same decimals; both with one power of ten if the value is very large or small.
pub fn with_bar(value: f64, half: f64) -> String {
    let larger = value.abs().max(half);
    let exponent = if larger == 0.0 || (1e-3..1e6).contains(&larger) { 0 } else { larger.log10().floor() as i32 };
    let [value, half] = [value, half].map(|number| number / 10f64.powi(exponent));
    let decimals = decimals(half);
    let value = fixed(value, decimals);
    let text = match exponent {
        0 => format!("{value} ± {half:.decimals$}"),
        exponent => format!("({value} ± {half:.decimals$})e{exponent}"),
    };
    text.replace('-', "\u{2212}")
}

/// Decimals of a value with such a bar.
pub fn decimals(half: f64) -> usize {
    if half > 0.0 { decimals_of_bar(half) } else { DECIMALS }
}

fn decimals_of_bar(half: f64) -> usize {
    if half > 0.0 { (1.0 - half.log10().floor()).clamp(0.0, 12.0) as usize } else { 0 }
}

/// Components in six digits; those that are rounding beside the largest are 0.
pub fn vector(components: &[f64]) -> String {
    let largest = components.iter().fold(0.0_f64, |largest, component| largest.max(component.abs()));
    let shown = |&component: &f64| if component.abs() <= 1e-12 * largest { "0".to_owned() } else { number(component, 6) };
    format!("({})", components.iter().map(shown).collect::<Vec<_>>().join(", "))
}

/// A number in so many digits, with a power of ten if it is very large or small.
pub fn number(value: f64, digits: usize) -> String {
    let scientific = format!("{value:.*e}", digits - 1);
    // of the rounded number: 0.99999999 has the digits of 1
    let exponent = scientific.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok()).unwrap_or(0);
    let text = match (1e-3..1e6).contains(&value.abs()) {
        _ if value == 0.0 => "0".to_owned(),
        true => format!("{value:.*}", (digits as i32 - 1 - exponent).max(0) as usize),
        false => scientific,
    };
    text.replace('-', "\u{2212}")
}

/// A number in so many decimals; what rounds to zero has no sign.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(size) if size.bytes().all(|sign| matches!(sign, b'0' | b'.')) => size.to_owned(),
        _ => text,
    }
}

/// A number without what rounding leaves beyond its tenth digit.
pub fn plain(value: f64) -> f64 {
    format!("{value:.9e}").parse().unwrap_or(value)
}

/// The shortest and the longest step in four digits, once where they are the same.
pub fn lengths_of_steps(shortest_longest: [f64; 2]) -> String {
    let [shortest, longest] = shortest_longest.map(|length| match format!("{length:.3e}") {
        rounded if (1e-3..1e4).contains(&length) => rounded.parse::<f64>().map_or(rounded, |length| length.to_string()),
        rounded => rounded,
    });
    if shortest == longest { shortest } else { format!("{shortest} to {longest}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_is_written_in_two_digits() {
        assert_eq!([0.01234, 1.2, 123.4, 0.0].map(bar), ["0.012", "1.2", "123", "0"]);
    }

    #[test]
    fn a_value_has_as_many_decimals_as_its_bar() {
        let values = [(2.438_912, 0.012_34), (45.81, 67.2), (-0.135, 0.27), (1.5, 0.0), (2.345_6e-12, 1.2e-14), (0.0, 0.0)];
        let written =
            ["2.439 ± 0.012", "46 ± 67", "\u{2212}0.14 ± 0.27", "1.5000 ± 0.0000", "(2.346 ± 0.012)e\u{2212}12", "0.0000 ± 0.0000"];
        assert_eq!(values.map(|(value, half)| with_bar(value, half)), written);
    }

    #[test]
    fn components_that_are_rounding_are_zero() {
        assert_eq!(vector(&[-1.25, 1e-16, 1e-7]), "(\u{2212}1.25000, 0, 1.00000e\u{2212}7)");
        assert_eq!(vector(&[0.0, 0.0]), "(0, 0)");
    }

    #[test]
    fn no_zero_has_a_sign() {
        assert_eq!([-0.0, -1e-6, -0.01, 1.0].map(|value| fixed(value, 3)), ["0.000", "0.000", "-0.010", "1.000"]);
        assert_eq!((with_bar(-1e-3, 0.1), number(-0.0, 3)), ("0.00 ± 0.10".into(), "0".into()));
        assert_eq!([0.999_999_99, 0.012_345_6, 123.456].map(|value| number(value, 4)), ["1.000", "0.01235", "123.5"]);
    }

    #[test]
    fn a_sum_of_steps_is_told_without_its_rounding() {
        assert_eq!(plain(0.099_999_999_999_999_99).to_string(), "0.1");
        assert_eq!(plain(0.123_456_789_1).to_string(), "0.1234567891");
    }

    #[test]
    fn steps_of_one_length_are_told_once() {
        assert_eq!(lengths_of_steps([0.025, 0.025 * (1.0 + 1e-12)]), "0.025");
        assert_eq!(lengths_of_steps([1.349e-3, 0.065_672]), "0.001349 to 0.06567");
        assert_eq!(lengths_of_steps([2e-5, 12_345.0]), "2.000e-5 to 1.234e4");
    }
}
