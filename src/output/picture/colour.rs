//! The colour map of the speed: indigo at rest, teal, green, then gold.
//!
//! Lightness rises in equal steps of OKLab from 0.36 to 0.84, so that equal differences of speed look equal, black bodies stand out
//! at the dark end and white lines at the light one. Source of the space: B. Ottosson, 2020, <https://bottosson.github.io/posts/oklab>.

const TABLE: [[u8; 3]; 17] = [
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
];

/// The colour of a value between zero and one, as red, green and blue.
pub fn shade(value: f64) -> [u8; 3] {
    let place = value.clamp(0.0, 1.0) * (TABLE.len() - 1) as f64;
    let low = (place as usize).min(TABLE.len() - 2);
    let weight = place - low as f64;
    [0, 1, 2].map(|k| ((1.0 - weight) * f64::from(TABLE[low][k]) + weight * f64::from(TABLE[low + 1][k])).round() as u8)
}

/// The colour of a value between zero and one, as SVG writes it.
pub fn hexadecimal(value: f64) -> String {
    let [red, green, blue] = shade(value);
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_brightens_all_along() {
        let luminance = |k: i32| {
            let [red, green, blue] = shade(f64::from(k) / 64.0).map(|part| (f64::from(part) / 255.0).powf(2.2));
            0.2126 * red + 0.7152 * green + 0.0722 * blue
        };
        assert!((0..64).all(|k| luminance(k + 1) > luminance(k)));
    }

    #[test]
    fn values_out_of_range_take_the_end_colours() {
        assert_eq!(shade(-1.0), TABLE[0]);
        assert_eq!(shade(2.0), TABLE[16]);
    }
}
