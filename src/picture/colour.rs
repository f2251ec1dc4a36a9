//! Colour maps whose lightness goes in equal steps of OKLab, so that equal differences of what they show look equal.
//!
//! Source of the space: B. Ottosson, 2020, <https://bottosson.github.io/posts/oklab>.

/// Colours from one end to the other.
pub struct ColourMap([[u8; 3]; 17]);

/// That of a speed: indigo at rest, teal, green, then gold. Lightness rises from 0.36 to 0.84, so that black bodies stand out at the dark end and
/// white lines at the light one.
pub const SEQUENTIAL: ColourMap = ColourMap([
    [49, 51, 120],
    [46, 63, 128],
    [41, 75, 136],
    [36, 87, 143],
    [29, 98, 148],
    [17, 111, 151],
    [12, 123, 151],
    [24, 134, 151],
    [43, 144, 149],
    [47, 156, 149],
    [59, 167, 146],
    [77, 177, 140],
    [100, 186, 133],
    [132, 193, 116],
    [167, 197, 99],
    [202, 199, 83],
    [236, 199, 74],
]);

/// Colours of things without an order, which most eyes tell apart; more things than these take them in turn.
///
/// Source: M. Okabe and K. Ito, 2008, Color universal design, <https://jfly.uni-koeln.de/color/>.
pub const DISTINCT: [[u8; 3]; 7] =
    [[230, 159, 0], [86, 180, 233], [0, 158, 115], [240, 228, 66], [0, 114, 178], [213, 94, 0], [204, 121, 167]];

/// Those of them that stand out as lines on white, the most different first.
pub const LINES: [[u8; 3]; 6] = [DISTINCT[4], DISTINCT[5], DISTINCT[2], DISTINCT[6], DISTINCT[0], DISTINCT[1]];

/// The colour of the thing of this number.
pub fn distinct(number: usize) -> [u8; 3] {
    DISTINCT[number % DISTINCT.len()]
}

/// That of what has either sign: blue below zero, nearly white there, red above. Lightness falls from 0.975 to 0.43 on both sides.
pub const DIVERGING: ColourMap = ColourMap([
    [22, 79, 148],
    [43, 98, 170],
    [65, 119, 190],
    [90, 140, 207],
    [117, 162, 221],
    [146, 183, 233],
    [177, 204, 241],
    [211, 226, 246],
    [247, 247, 247],
    [248, 216, 211],
    [244, 186, 178],
    [235, 157, 148],
    [222, 130, 120],
    [206, 104, 94],
    [187, 79, 71],
    [165, 56, 50],
    [142, 35, 31],
]);

impl ColourMap {
    /// The colour of a value between zero and one, as red, green and blue.
    pub fn shade(&self, value: f64) -> [u8; 3] {
        let table = &self.0;
        let place = value.clamp(0.0, 1.0) * (table.len() - 1) as f64;
        let low = (place as usize).min(table.len() - 2);
        let weight = place - low as f64;
        [0, 1, 2].map(|k| ((1.0 - weight) * f64::from(table[low][k]) + weight * f64::from(table[low + 1][k])).round() as u8)
    }

    /// The colour of a value between zero and one, as SVG writes it.
    pub fn hexadecimal(&self, value: f64) -> String {
        hexadecimal(self.shade(value))
    }
}

/// A colour as SVG writes it.
pub fn hexadecimal([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luminance(map: &ColourMap, k: i32) -> f64 {
        let [red, green, blue] = map.shade(f64::from(k) / 64.0).map(|part| (f64::from(part) / 255.0).powf(2.2));
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }

    #[test]
    fn the_map_of_a_speed_brightens_all_along() {
        assert!((0..64).all(|k| luminance(&SEQUENTIAL, k + 1) > luminance(&SEQUENTIAL, k)));
    }

    #[test]
    fn the_map_of_either_sign_is_lightest_at_zero_and_equally_dark_on_both_sides() {
        assert!((0..32).all(|k| luminance(&DIVERGING, k + 1) > luminance(&DIVERGING, k)));
        assert!((32..64).all(|k| luminance(&DIVERGING, k + 1) < luminance(&DIVERGING, k)));
        assert!((0..32).all(|k| (luminance(&DIVERGING, k) - luminance(&DIVERGING, 64 - k)).abs() < 0.06));
    }

    #[test]
    fn values_out_of_range_take_the_end_colours() {
        assert_eq!(SEQUENTIAL.shade(-1.0), SEQUENTIAL.0[0]);
        assert_eq!(SEQUENTIAL.shade(2.0), SEQUENTIAL.0[16]);
    }
}
