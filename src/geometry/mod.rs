//! Where things are: the box and its images, balls, what boxes they fill and who is near whom. It knows no fluid and no forces.

mod ball;
mod bounds;
mod cells;
mod delaunay;
mod domain;
mod fractions;
mod inflow;
mod lees_edwards;
mod levels;
mod overlap;
mod pairs;
mod protocol;

pub use ball::Ball;
pub use bounds::Bounds;
pub use delaunay::{Corner, Edges, delaunay, position};
pub use domain::{Axis, Domain};
pub use fractions::{fraction, touches};
pub use inflow::Inflow;
pub use lees_edwards::LeesEdwards;
pub use levels::Levels;
pub use overlap::{InvalidConfiguration, first_fault};
pub use pairs::{Pair, WallPair, near_pairs, near_walls, visit_near_pairs};
pub use protocol::{Oscillation, Protocol, RateStep};
