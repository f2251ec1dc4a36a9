//! The units in which a scene is told, and the place at which it lies in its box.

/// Factors of length, time and mass (2D: mass per length), and cells by which everything lies further along each axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    pub length: f64,
    pub time: f64,
    pub mass: f64,
    pub cells: [i32; 3],
}

impl Units {
    pub const PLAIN: Units = Units { length: 1.0, time: 1.0, mass: 1.0, cells: [0; 3] };

    /// Powers of two: a scene in them has the same digits, unless a number in the program has a unit of its own.
    pub fn of_powers(length: i32, time: i32, mass: i32) -> Units {
        let [length, time, mass] = [length, time, mass].map(|power| 2_f64.powi(power));
        Units { length, time, mass, ..Units::PLAIN }
    }

    /// The plain units, everything so many cells further along the axes.
    pub fn moved(cells: [i32; 3]) -> Units {
        Units { cells, ..Units::PLAIN }
    }

    /// A number whose unit has these powers of length, time and mass.
    pub fn number(self, value: f64, powers: [i32; 3]) -> f64 {
        value * self.length.powi(powers[0]) * self.time.powi(powers[1]) * self.mass.powi(powers[2])
    }
}

/// Powers of length, time and mass in the units of what a scene holds, by the dimension of space.
pub mod powers {
    pub const LENGTH: [i32; 3] = [1, 0, 0];
    pub const TIME: [i32; 3] = [0, 1, 0];
    pub const RATE: [i32; 3] = [0, -1, 0];
    pub const VELOCITY: [i32; 3] = [1, -1, 0];
    pub const ACCELERATION: [i32; 3] = [1, -2, 0];
    pub const FORCE: [i32; 3] = [1, -2, 1];
    pub const ENERGY: [i32; 3] = [2, -2, 1];
    /// Of the bending modulus of a membrane in the plane.
    pub const BENDING_MODULUS: [i32; 3] = [3, -2, 1];
    pub const STIFFNESS: [i32; 3] = [0, -2, 1];

    pub fn viscosity(dimension: usize) -> [i32; 3] {
        [2 - dimension as i32, -1, 1]
    }

    pub fn density(dimension: usize) -> [i32; 3] {
        [-(dimension as i32), 0, 1]
    }

    /// Of a force per volume, which is that of a pressure gradient.
    pub fn body_force(dimension: usize) -> [i32; 3] {
        [1 - dimension as i32, -2, 1]
    }
}
