//! Keys of groups of bodies: `[[bodies]]`, `[[chains]]`, `[[cells]]` and `[[clusters]]`.

use crate::scene::key::Key;

const PLACED: &str = "one of the keys that place a group is required";
const FREE: &str = "bodies.0.motion = \"free\"";
const INERTIA: &str = "flow.model = \"navier-stokes\"; flow.density = 1.0; resolution.spacing = 0.1; time.end = 1.0";
const CENTRES_OF_CELLS: &str = "cells.0.centers = [[4.0, 4.0]]";
const CENTRES_OF_CLUSTERS: &str = "clusters.0.centers = [[4.0, 4.0]]";

const COUNT: Key = Key::new("count", "whole number", "2", "How many are placed at random.").default(PLACED).range("at least 1");
const FILE: Key = Key::new(
    "file",
    "text",
    "\"centers.csv\"",
    "Table with the columns x, y, (3D: z) and, if wanted, radius, a row a body, bead, cell or cluster; a radius takes the place of that of the group, for \
    each of its balls; the path starts from the folder of the scene.",
)
.default(PLACED);
const RADIUS: Key = Key::new("radius", "number", "0.1", "Radius of each ball.").unit("length").default("required").range("above 0");
const GAP: Key = Key::new("gap", "number", "0.1", "Smallest gap between bodies that are placed at random.")
    .unit("radii")
    .default("0.05")
    .range("at least 0");
const REGION: Key = Key::new(
    "region",
    "list of lists",
    "[[0.0, 0.0], [8.0, 4.0]]",
    "Lower and upper corner of the part of the box in which those that are placed at random lie wholly; a fraction is then one of this part.",
)
.unit("length")
.default("the box")
.range("within the box");
const DENSITY: Key = Key::new("density", "number", "2.0", "Density of each ball.")
    .unit("mass/volume; 2D: mass/area")
    .default("1.0")
    .range("at least 0; above 0 where bodies have inertia");
const FORCE: Key = Key::new("force", "list of numbers", "[0.0, -1.0]", "External force on each of them.").unit("force; 2D: force/length");
const TORQUE: Key = Key::new("torque", "number; 3D: list of 3", "0.5", "External torque on each of them, counterclockwise positive.")
    .unit("torque; 2D: torque/length");
const STRETCH: Key =
    Key::new("stretch", "\"rigid\" or a number", "50.0", "Force of a bond over the change of its length; rigid bonds keep it.")
        .unit("force/length")
        .default("required")
        .range("above 0");
const SPACING: Key = Key::new("spacing", "number", "1.1", "Distance of the centres of neighbours at rest.")
    .unit("diameters of a bead")
    .default("1.05")
    .range("above 1");
const ROTATION: Key = Key::new(
    "rotation",
    "number; 3D: list of 3",
    "0.5",
    "How those whose centres are given are turned at the start: an angle; 3D: \
    a vector about which, by its length.",
)
.unit("radians");

/// Keys of `[[bodies]]`.
pub(in crate::scene) const BODY_KEYS: [Key; 16] = [
    Key::new("shape", "\"ball\"", "\"ball\"", "A disk in 2D, a sphere in 3D.").default("\"ball\""),
    RADIUS,
    Key::new(
        "sizes",
        "list of numbers or table",
        "[1.0, 1.4]",
        "How the radii of bodies that are placed at random differ: radii each of which fills the same part of the volume of the bodies, two sizes, or a \
        log-normal distribution. The radii depend on no seed.",
    )
    .unit("radii of the group")
    .default("all alike")
    .range("0.01 to 100")
    .needs("bodies.0.count = 4"),
    Key::new("fraction", "number", "0.1", "Part of the box that the group fills, placed at random.")
        .unit("ratio")
        .default(PLACED)
        .range("above 0, below 1"),
    COUNT,
    Key::new("centers", "list of lists", "[[2.0, 2.0], [4.0, 2.0]]", "Centres.").unit("length").default(PLACED),
    FILE,
    GAP,
    REGION.needs("bodies.0.count = 1"),
    DENSITY,
    Key::new(
        "friction",
        "number or table",
        "0.2",
        "Friction of their surfaces, as `contact.friction`; of a contact the smaller numbers of its two surfaces count.",
    )
    .unit("ratio")
    .default("that of `contact.friction`")
    .range("at least 0")
    .needs("time.end = 1.0; contact.model = \"inelastic\"; contact.friction = 0.5"),
    Key::new(
        "motion",
        "\"free\", \"fixed\", \"wall\" or a table",
        "\"fixed\"",
        "How the bodies move: under forces, not at all, with the wall that \
        domain.normal_stress presses, or as prescribed.",
    )
        .default("\"free\""),
    FORCE.needs(FREE),
    TORQUE.needs(FREE),
    Key::new("velocity", "list of numbers", "[1.0, 0.0]", "Velocity at the start of free bodies with inertia.")
        .unit("length/time")
        .needs(INERTIA),
    Key::new("spin", "number; 3D: list of 3", "0.5", "Turning rate at the start of free bodies with inertia, counterclockwise positive.")
        .unit("radians/time")
        .needs(INERTIA),
];

/// Keys of `sizes` of a group of bodies: of two sizes, and from [`LOGNORMAL`] on of a log-normal distribution.
pub(in crate::scene) const SIZES_KEYS: [Key; 5] = [
    Key::new("ratio", "number", "1.4", "The second of two radii.")
        .unit("radii of the group")
        .default("required")
        .range("0.01 to 100")
        .needs(TWO_SIZES),
    Key::new("share", "number", "0.5", "Part of the volume of the bodies that those of the second radius fill.")
        .unit("ratio")
        .default("0.5")
        .range("above 0, below 1")
        .needs(TWO_SIZES),
    Key::new(
        "deviation",
        "number",
        "0.2",
        "Standard deviation of the logarithm of the radii, whose median by number is the radius of the group.",
    )
    .default("required")
    .range("above 0, at most 2")
    .needs(MANY_SIZES),
    Key::new("smallest", "number", "0.5", "No body is smaller.")
        .unit("radii of the group")
        .default("required")
        .range("0.01 to 100")
        .needs(MANY_SIZES),
    Key::new("largest", "number", "2.0", "No body is larger.")
        .unit("radii of the group")
        .default("required")
        .range("0.01 to 100")
        .needs(MANY_SIZES),
];

/// Where the keys of a log-normal distribution begin.
pub(in crate::scene) const LOGNORMAL: usize = 2;

/// Keys of `motion` of a group of bodies: of a steady, of an oscillating and of any other motion.
pub(in crate::scene) const MOTION_KEYS: [Key; 7] = [
    Key::new("velocity", "list of numbers", "[1.0, 0.0]", "Constant velocity.").unit("length/time").default("zero"),
    Key::new("spin", "number; 3D: list of 3", "0.5", "Constant turning rate.").unit("radians/time").default("zero"),
    Key::new("amplitude", "list of numbers", "[0.1, 0.0]", "Displacement a in a (sin(2 pi f t + p) - sin p).")
        .unit("length")
        .default("zero")
        .needs(TO_AND_FRO),
    Key::new("rotation", "number; 3D: list of 3", "0.2", "Angle that takes the place of a in the same law.")
        .unit("radians")
        .default("zero")
        .needs(TO_AND_FRO),
    Key::new("frequency", "number", "2.0", "Frequency f.").unit("1/time").default("required").range("above 0").needs(TO_AND_FRO),
    Key::new("phase", "number", "1.57", "Phase p.").unit("radians").default("0.0").needs(TO_AND_FRO),
    Key::new(
        "path",
        "list of lists or text",
        "[[0, 0, 0], [0.5, 0.1, 0.0], [1.0, 0.2, 0.1]]",
        "Times, each with the displacement then, or the table that has them (time,x,y; 3D time,x,y,z; as in file); a cubic spline \
        goes through them, from rest to rest.",
    )
    .unit("time, length")
    .range("first row zeros, times increasing")
    .needs("time.end = 1.0"),
];

const TWO_SIZES: &str = "bodies.0.count = 4; bodies.0.sizes.ratio = 1.2";
const MANY_SIZES: &str = "bodies.0.count = 4; bodies.0.sizes.deviation = 0.1; bodies.0.sizes.smallest = 0.8; bodies.0.sizes.largest = 1.2";
const TO_AND_FRO: &str = "time.end = 1.0; bodies.0.motion.amplitude = [0.1, 0.0]; bodies.0.motion.frequency = 1.0";

/// Where the keys of an oscillating motion begin, and where those of a path.
pub(in crate::scene) const OSCILLATING: usize = 2;
pub(in crate::scene) const PATH: usize = 6;

/// Keys of `[[chains]]`.
pub(in crate::scene) const CHAIN_KEYS: [Key; 16] = [
    COUNT,
    Key::new("centers", "list of lists", "[[2.0, 2.0], [2.9, 2.0], [3.8, 2.0], [4.7, 2.0]]", "Centres of the beads, chain by chain.")
        .unit("length")
        .default(PLACED)
        .needs("chains.0.radius = 0.4"),
    FILE,
    Key::new("beads", "whole number", "4", "Beads of each chain.").default("required").range("at least 2; in a ring at least 3"),
    RADIUS,
    SPACING,
    STRETCH,
    Key::new("bend", "number", "20.0", "Bending energy b in b/2 (1 - cos t) for a turn by t from one bond to the next.")
        .unit("energy; 2D: energy/length")
        .default("0.0")
        .range("at least 0"),
    Key::new("angle", "number", "0.2", "That turn at rest.")
        .unit("radians")
        .default("0; in a ring 2 pi / beads")
        .range("above -pi, below pi; 3D: at least 0")
        .needs("chains.0.bend = 1.0"),
    Key::new("shape", "\"line\" or \"ring\"", "\"ring\"", "Whether the ends are free or tied to each other.").default("\"line\""),
    Key::new("joints", "\"free\" or \"fixed\"", "\"fixed\"", "Whether beads turn on their own or with the chain.").default("\"free\""),
    GAP,
    REGION.needs("chains.0.count = 1"),
    DENSITY,
    FORCE,
    TORQUE,
];

/// Keys of `[[cells]]`.
pub(in crate::scene) const CELL_KEYS: [Key; 17] = [
    COUNT,
    Key::new("centers", "list of lists", "[[4.0, 4.0]]", "Centres of the cells.").unit("length").default(PLACED),
    FILE,
    ROTATION.needs(CENTRES_OF_CELLS),
    Key::new("beads", "whole number", "48", "Beads of each membrane; in 2D fewer than 48 have not converged.")
        .default("required")
        .range("2D: beads times spacing at least 24; 3D: 42, 92, 162, 252, ..: 10 n n + 2"),
    Key::new("diameter", "number", "3.0", "Twice the largest distance of a bead from the middle of the cell as it is placed; the radius of beads follows.")
        .unit("length")
        .default("this or radius is required")
        .range("above 0"),
    Key::new("radius", "number", "0.1", "Radius of each bead; the size of the cell follows.")
        .unit("length")
        .default("this or diameter is required")
        .range("above 0"),
    SPACING,
    Key::new("rest", "\"biconcave\", \"ellipse\" or \"circle\"", "\"circle\"", "Form in which the membrane does not bend: that of a red cell, or of vesicles a circle (2D).")
        .default("\"biconcave\""),
    Key::new(
        "reduced_area",
        "number",
        "0.7",
        "4 pi area / perimeter^2 of the cell as it is placed: the biconcave outline thinner or thicker, or an ellipse (2D).",
    )
    .unit("ratio")
    .default("that of rest; required for an ellipse")
    .range("above 0, at most 1")
    .needs("cells.0.rest = \"circle\""),
    Key::new(
        "stretch",
        "\"rigid\" or a number",
        "50.0",
        "Tension of the membrane over its strain, however many beads it has (3D: pulled in one direction); rigid bonds keep their length (2D).",
    )
    .unit("force/length")
    .default("required")
    .range("above 0"),
    Key::new("bend", "number", "0.1", "Bending modulus b of the membrane, however many beads it has: b/2 times the integral of the square of the curvature.")
        .unit("energy")
        .default("required")
        .range("above 0"),
    GAP,
    REGION.needs("cells.0.count = 1"),
    DENSITY,
    FORCE,
    TORQUE,
];

/// Keys of `[[clusters]]`.
pub(in crate::scene) const CLUSTER_KEYS: [Key; 14] = [
    COUNT,
    Key::new("centers", "list of lists", "[[4.0, 4.0]]", "Centres of the clusters.").unit("length").default(PLACED),
    FILE,
    ROTATION.needs(CENTRES_OF_CLUSTERS),
    Key::new("shape", "\"rod\", \"cross\", \"triangle\" or \"tetrahedron\"", "\"cross\"", "How the balls lie.")
        .default("this or offsets is required")
        .needs("clusters.0 = { count = 1, shape = \"cross\", radius = 0.4 }"),
    Key::new("beads", "whole number", "5", "Balls of a rod.").default("required for a rod").range("at least 2"),
    Key::new(
        "offsets",
        "list of lists",
        "[[0.0, 0.0], [0.9, 0.0]]",
        "Places of the balls from the centre of the cluster; it is moved to their mean.",
    )
    .unit("length")
    .default("this or shape is required")
    .needs("clusters.0 = { count = 1, radius = 0.4 }"),
    RADIUS,
    Key::new("spacing", "number", "1.2", "Distance of the centres of neighbours in a shape.")
        .unit("diameters of a ball")
        .default("1.0")
        .range("at least 1"),
    GAP,
    REGION.needs("clusters.0.count = 1"),
    DENSITY,
    FORCE,
    TORQUE,
];
