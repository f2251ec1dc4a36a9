//! Where the box of a picture lies on its page. Pixels count from the upper left corner; this is the only place that knows that `y` points down.

use super::Picture;

pub const LARGEST: [f64; 2] = [900.0, 1400.0];
pub const SIDE: f64 = 22.0;
/// Room for the axes to the left and below.
pub const AXIS: [f64; 2] = [70.0, 54.0];
/// Narrowest page.
const LEAST_WIDTH: f64 = 420.0;
pub const BAR_ROOM: f64 = 118.0;
pub const WALL: f64 = 6.0;
/// The colour of text, bodies and walls.
pub const INK: &str = "#14171f";

/// Where the box lies on the page, in pixels.
pub struct PictureFrame {
    pub page: [f64; 2],
    pub left: f64,
    pub top: f64,
    pub size: [f64; 2],
    /// Width of the widest wall, from which axes keep off.
    pub wall: f64,
    pub scale: f64,
}

impl PictureFrame {
    pub fn new(picture: &Picture) -> Self {
        let top = match (picture.title.is_empty(), picture.subtitle.is_empty() && picture.legend.is_empty()) {
            (true, true) => SIDE,
            (false, true) => 56.0,
            (_, false) => 76.0,
        };
        let room = [LARGEST[0] - AXIS[0] - BAR_ROOM, LARGEST[1] - top - AXIS[1]];
        let scale = (room[0] / picture.size[0]).min(room[1] / picture.size[1]);
        let size = picture.size.map(|length| (length * scale).max(1.0));
        let page = [(size[0] + AXIS[0] + BAR_ROOM).max(LEAST_WIDTH), size[1] + top + AXIS[1]].map(f64::ceil);
        let wall = if picture.walls == [false, false] { 0.0 } else { WALL };
        PictureFrame { page, left: AXIS[0], top, size, wall, scale }
    }

    pub fn place(&self, x: [f64; 2]) -> [f64; 2] {
        [self.left + x[0] * self.scale, self.top + self.size[1] - x[1] * self.scale]
    }

    /// The attributes of a rectangle that covers the box.
    pub fn rectangle(&self) -> String {
        format!("x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\"", self.left, self.top, self.size[0], self.size[1])
    }
}
