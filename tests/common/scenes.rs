//! Small scenes.

/// Disks between walls in shear.
pub const SHEARED: &str = r#"
seed = 2
[domain]
size = [8.0, 6.0]
y = { lower = [-3.0, 0.0], upper = [3.0, 0.0] }
[resolution]
cells_per_radius = 4
[method]
inverse = "hypre"
tolerance = 1e-8
[[bodies]]
radius = 1.0
fraction = 0.5
gap = 0.02
[contact]
model = "inelastic"
[time]
end = 0.32
[output]
every = 0.08
picture = false
"#;

/// A chain of rods and a ring of springs between walls in shear, with films and contacts; the chain lies across an end of the box.
pub const CHAINS: &str = r#"
[domain]
size = [8.0, 6.0]
y = { lower = [-3.0, 0.0], upper = [3.0, 0.0] }
[resolution]
cells_per_radius = 3
[method]
inverse = "hypre"
tolerance = 1e-8
[lubrication]
model = "pairwise"
[[chains]]
centers = [[7.2, 1.2], [0.0, 1.5], [0.8, 1.8], [1.6, 2.1]]
beads = 4
radius = 0.4
stretch = "rigid"
bend = 5.0
[[chains]]
centers = [[3.5, 3.5], [4.5, 3.4], [4.1, 4.4]]
beads = 3
radius = 0.4
spacing = 1.3
stretch = 40.0
bend = 5.0
shape = "ring"
[contact]
model = "inelastic"
[time]
end = 0.32
[output]
every = 0.08
picture = false
"#;

/// Dry chains that fall on each other.
pub const DRY_CHAINS: &str = r#"
seed = 1
gravity = [0.0, -1.0]
[domain]
size = [6.0, 9.0]
y = "walls"
[flow]
model = "none"
[[chains]]
count = 4
beads = 6
radius = 0.3
stretch = "rigid"
bend = 0.2
[[chains]]
count = 2
beads = 5
radius = 0.3
stretch = 20.0
shape = "ring"
[contact]
model = "inelastic"
[time]
end = 4.0
[output]
every = 0.5
picture = false
"#;

/// Dry cells that fall on each other and on disks.
pub const DRY_CELLS: &str = r#"
seed = 1
gravity = [0.0, -1.0]
[domain]
size = [6.0, 9.0]
y = "walls"
[flow]
model = "none"
[[cells]]
count = 2
beads = 24
radius = 0.15
stretch = "rigid"
bend = 0.0315
[[cells]]
count = 1
beads = 24
radius = 0.15
stretch = 15.75
bend = 0.0315
[[bodies]]
count = 3
radius = 0.3
[contact]
model = "inelastic"
[time]
end = 4.0
step = 0.04
[output]
every = 0.5
picture = false
"#;

/// Dry rigid clusters that fall on each other and on a disk.
pub const DRY_CLUSTERS: &str = r#"
seed = 1
gravity = [0.0, -1.0]
[domain]
size = [6.0, 9.0]
y = "walls"
[flow]
model = "none"
[[clusters]]
count = 4
shape = "rod"
beads = 4
radius = 0.3
[[clusters]]
count = 3
offsets = [[0.0, 0.0], [0.6, 0.1], [0.9, -0.5]]
radius = 0.3
[[bodies]]
count = 1
radius = 0.4
[contact]
model = "inelastic"
[time]
end = 4.0
[output]
every = 0.5
picture = false
"#;

/// Red cells of 24 and of 30 beads between walls in shear; the first lies across an end of the box.
pub const CELLS: &str = r#"
[domain]
size = [8.0, 6.0]
y = { lower = [-3.0, 0.0], upper = [3.0, 0.0] }
[resolution]
cells_per_radius = 3
[method]
inverse = "hypre"
tolerance = 1e-8
[[cells]]
centers = [[7.0, 1.5]]
rotation = 0.1
beads = 24
radius = 0.2
stretch = "rigid"
bend = 0.21
[[cells]]
centers = [[3.0, 4.2]]
rotation = -0.1
beads = 30
radius = 0.2
stretch = 42.0
bend = 0.21
[contact]
model = "inelastic"
[time]
end = 0.32
[output]
every = 0.08
picture = false
"#;

/// Rigid clusters, two of which touch, among single disks.
pub const CLUSTERS: &str = r#"
[domain]
size = [8.0, 6.0]
y = { lower = [-3.0, 0.0], upper = [3.0, 0.0] }
[resolution]
cells_per_radius = 3
[method]
inverse = "hypre"
tolerance = 1e-8
[lubrication]
model = "pairwise"
[[clusters]]
shape = "rod"
beads = 4
radius = 0.4
centers = [[0.2, 1.5]]
rotation = 0.4
[[clusters]]
offsets = [[0.0, 0.0], [0.9, 0.1], [0.5, -0.8]]
radius = 0.4
centers = [[3.5, 3.0], [3.4, 4.9]]
[[bodies]]
radius = 0.4
centers = [[5.5, 1.5], [5.9, 4.0]]
[contact]
model = "inelastic"
[time]
end = 0.32
[output]
every = 0.08
picture = false
"#;

/// Disks in a box whose images slide.
pub const SLIDING: &str = r#"
seed = 2
[domain]
size = [8.0, 8.0]
[flow]
drive = { shear_rate = 1.0, periodic = "sheared" }
[resolution]
cells_per_radius = 4
[method]
inverse = "hypre"
tolerance = 1e-8
[[bodies]]
radius = 1.0
fraction = 0.45
gap = 0.02
[contact]
model = "inelastic"
[time]
end = 0.625
[output]
every = 0.0625
picture = false
"#;

/// Disks lighter and heavier than the fluid in a box whose images slide, all of which have inertia.
pub const SLIDING_INERTIA: &str = r#"
seed = 2
[domain]
size = [8.0, 8.0]
[flow]
model = "navier-stokes"
density = 1.0
drive = { shear_rate = 1.0, periodic = "sheared" }
[resolution]
cells_per_radius = 4
[method]
inverse = "transform"
tolerance = 1e-8
[[bodies]]
radius = 1.0
count = 4
gap = 0.02
density = 2.0
[[bodies]]
radius = 1.0
count = 4
gap = 0.02
density = 0.5
[contact]
model = "inelastic"
[lubrication]
model = "pairwise"
[time]
end = 0.625
[output]
every = 0.0625
picture = false
"#;

/// Disks lighter and heavier than the fluid between walls, all of which have inertia.
pub const INERTIA: &str = r#"
gravity = [0.0, -20.0]
[domain]
size = [6.0, 6.0]
y = { lower = [-1.0, 0.0], upper = [1.0, 0.0] }
[flow]
model = "navier-stokes"
viscosity = 0.5
density = 1.0
[resolution]
cells_per_radius = 3
[method]
inverse = "hypre"
tolerance = 1e-8
[[bodies]]
radius = 1.0
centers = [[1.5, 1.4], [4.3, 3.4]]
density = 3.0
[[bodies]]
radius = 0.8
centers = [[3.6, 1.6]]
density = 0.5
[contact]
model = "inelastic"
[time]
end = 0.64
[output]
every = 0.08
picture = false
"#;

/// A stream with inertia past a disk that stays and one that is moved, between walls; its frames hold the vorticity.
pub const OBSTACLE: &str = r#"
[domain]
size = [6.0, 4.0]
y = "walls"
[flow]
model = "navier-stokes"
viscosity = 0.1
density = 2.0
drive = { mean_velocity = [1.0, 0.0] }
[resolution]
cells_per_radius = 4
[method]
inverse = "transform"
tolerance = 1e-8
[[bodies]]
radius = 0.5
centers = [[1.5, 2.2]]
motion = "fixed"
[[bodies]]
radius = 0.4
centers = [[4.0, 3.2]]
[[bodies]]
radius = 0.5
centers = [[4.5, 1.2]]
motion = { velocity = [0.0, 0.5], spin = 1.0 }
[time]
end = 0.32
[output]
every = 0.08
colour = "vorticity"
reference_velocity = [2.0, 0.0]
"#;

/// Spheres in a background shear.
pub const SPHERES: &str = r#"
seed = 1
[domain]
size = [4.0, 4.0, 4.0]
y = { lower = [-2.0, 0.0, 0.0], upper = [2.0, 0.0, 0.0] }
[resolution]
cells_per_radius = 3
modes = 2
[method]
inverse = "hypre"
tolerance = 1e-8
[[bodies]]
radius = 1.0
count = 3
gap = 0.02
[contact]
model = "inelastic"
[time]
end = 0.32
[output]
every = 0.16
picture = false
"#;

/// Disks that fall into a heap, from rank to rank: a box that is higher than wide is cut across its height.
pub const DRY: &str = r#"
seed = 4
gravity = [0.0, -1.0]
[domain]
size = [8.0, 8.5]
x = "walls"
y = "walls"
[flow]
model = "none"
[[bodies]]
radius = 0.5
count = 12
gap = 0.1
density = 1.0
[contact]
model = "inelastic"
[time]
end = 1.6
[output]
every = 0.16
"#;

/// Disks that fall on a floor and stick, some under others; the run ends while they do.
pub const GLUEY: &str = r#"
seed = 4
gravity = [0.3, -1.0]
[domain]
size = [6.0, 6.0]
y = "walls"
[flow]
model = "none"
[[bodies]]
radius = 0.5
count = 12
gap = 0.1
density = 1.0
[contact]
model = "gluey"
[time]
end = 2.4
[output]
every = 0.24
"#;

/// Three disks in shear whose step is quick, with a checkpoint after every step.
pub const QUICK: &str = r#"
[domain]
size = [4.0, 3.0]
y = { lower = [-1.5, 0.0], upper = [1.5, 0.0] }
[resolution]
spacing = 0.16666666666666667
modes = 2
[method]
inverse = "hypre"
tolerance = 1e-9
[[bodies]]
radius = 0.5
centers = [[0.7, 1.0], [2.0, 1.3], [3.2, 2.2]]
[contact]
model = "inelastic"
[time]
end = 0.9
[output]
every = 0.1
picture = false
checkpoint = 0
"#;

/// A channel with a disk that stays, one that falls and one that is moved to and fro, from rest; its balance of energy is written.
pub const BALANCE: &str = r#"
gravity = [0.0, -2.0]
[domain]
size = [6.0, 4.0]
y = "walls"
[flow]
model = "navier-stokes"
viscosity = 0.5
density = 1.0
drive = { pressure_gradient = [-4.0, 0.0] }
[resolution]
cells_per_radius = 5
[method]
inverse = "transform"
tolerance = 1e-8
[[bodies]]
radius = 0.5
centers = [[1.5, 2.2]]
motion = "fixed"
[[bodies]]
radius = 0.5
centers = [[3.4, 3.0]]
density = 5.0
[[bodies]]
radius = 0.5
centers = [[4.7, 1.2]]
motion = { amplitude = [0.0, 0.3], frequency = 0.5 }
[contact]
model = "inelastic"
[time]
end = 0.6
[output]
energy = true
picture = false
"#;

/// Disks near each other that something shears, with its balance of energy.
pub const SHEARED_BALANCE: &str = r#"
[domain]
size = [8.0, 6.0]
[flow]
model = "navier-stokes"
density = 1.0
[resolution]
cells_per_radius = 5
[method]
inverse = "transform"
tolerance = 1e-8
[lubrication]
model = "pairwise"
[[bodies]]
radius = 1.0
centers = [[2.0, 2.6], [4.04, 3.0], [6.2, 3.6]]
density = 2.0
[contact]
model = "inelastic"
[time]
end = 0.4
[output]
energy = true
picture = false
"#;

/// One sphere at an instant, 16 cells along each side of its box.
pub const SPHERE: &str = r#"
domain.size = [1.0, 1.0, 1.0]
flow.drive = { mean_velocity = [0.0, 0.0, 2.0] }
resolution = { spacing = 0.0625, modes = 2 }
[[bodies]]
radius = 0.25
motion = "fixed"
centers = [[0.5, 0.5, 0.5]]
[output]
fields = true
plane = "xz"
"#;
