//! The staggered (MAC) grid: velocity components on faces, pressure at cell centres, and how they are numbered.

use nalgebra::SVector;

use super::partition::{Block, Partition};
use crate::{
    error::{Error, Result},
    geometry::Domain,
    petsc::INDEX_BITS,
};

/// A lattice index before wrapping: it may lie outside the box along periodic axes.
pub type Index<const D: usize> = [isize; D];

/// Fewest cells along an axis: cubic interpolation takes four nodes.
pub const FEWEST_CELLS: usize = 4;

/// Most unknowns, pressure included, that PETSc's indices number, with some left for those of bodies.
pub const MOST_UNKNOWNS: f64 = 0.9 * MOST_INDEX;

/// The last number of PETSc's indices.
pub const MOST_INDEX: f64 = (u64::MAX >> (64 - INDEX_BITS + 1)) as f64;

/// Most entries of a matrix on one rank: MPI and hypre count what a rank holds with 32 bits, whatever the width of PETSc's indices.
const MOST_ENTRIES: f64 = 0.9 * i32::MAX as f64;

/// What helps besides fewer unknowns where they are too many for PETSc's indices.
pub const WIDER_INDICES: &str =
    if INDEX_BITS < 64 { ", or build with 64-bit indices (package libpetsc64-real-dev, TURBID_INDEX_BITS=64)" } else { "" };

/// Part of a displacement, in cells, that is rounding.
const PART_OF_CELL: f64 = 1e-9;

/// What stands at a lattice index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Node {
    /// An unknown, by its index in the vector of its field.
    Unknown(usize),
    /// A wall, where the value is known.
    Wall(f64),
}

/// The staggered grid of a box.
///
/// Fields are numbered `0..D` (velocity components, on the faces normal to their axis) and `D` (pressure, at centres).
/// Face `i` of an axis is the lower face of cell `i`; on a walled axis the faces 0 and n lie on the walls and carry no unknown.
/// In the vector of a field each rank's block is contiguous; in a *fluid vector* each rank holds its parts of all fields in order.
///
/// Where images slide, a row of cells above the box must be a row of the box displaced by whole cells. What the images are displaced by besides, half a cell at
/// most, is spread over the height of the box on a grid that may be [oblique](Self::oblique), as in boxes that are deformed (Evans and
/// Morriss 2008, doi:10.1017/CBO9780511535307, chapter 6), and derivatives along y are those along the lines less the slope times those along x.
#[derive(Debug, Clone)]
pub struct Grid<const D: usize> {
    domain: Domain<D>,
    cells: [usize; D],
    spacing: SVector<f64, D>,
    /// Cells by which the images above the box are displaced along x, from none to less than all.
    shift: usize,
    /// Whether its lines along y may be oblique, so that images may be displaced by parts of a cell.
    may_be_oblique: bool,
    /// The slope of these lines, along x over y: what images are displaced by besides whole cells, at most half a cell over the height of the box.
    slope: f64,
    partition: Partition<D>,
    rank: usize,
    /// `blocks[rank][field]`
    blocks: Vec<Vec<Block<D>>>,
    /// `field_starts[rank][field]`: first index of the rank's block in the vector of the field.
    field_starts: Vec<Vec<usize>>,
    /// `fluid_starts[rank][field]`: first index of the rank's block in a fluid vector.
    fluid_starts: Vec<Vec<usize>>,
}

impl<const D: usize> Grid<D> {
    /// The grid with cells as near to `spacing` as whole numbers of cells allow, cut into blocks for `ranks` ranks, seen from `rank`.
    ///
    /// # Errors
    /// Fewer than four cells along an axis, more unknowns than PETSc's indices can number, more of them on a rank than it can count, a rank
    /// count that does not fit, or images displaced by a part of a cell.
    pub fn new(domain: &Domain<D>, spacing: f64, ranks: usize, rank: usize) -> Result<Grid<D>> {
        Grid::with(domain, spacing, ranks, rank, false)
    }

    /// The same, with lines along y that are oblique where images are displaced by parts of a cell.
    ///
    /// # Errors
    /// The same, but for such images.
    pub fn oblique(domain: &Domain<D>, spacing: f64, ranks: usize, rank: usize) -> Result<Grid<D>> {
        Grid::with(domain, spacing, ranks, rank, true)
    }

    fn with(domain: &Domain<D>, spacing: f64, ranks: usize, rank: usize, may_be_oblique: bool) -> Result<Grid<D>> {
        let cells: [usize; D] = cells_along(&domain.size, spacing).map(|cells| cells as usize).into();
        check_size(cells, spacing)?;
        let partition = Partition::new(cells, ranks)?;
        check_shares(&partition)?;
        let blocks: Vec<Vec<Block<D>>> =
            (0..ranks).map(|rank| (0..=D).map(|field| field_block(domain, partition.block(rank), field)).collect()).collect();
        let (field_starts, fluid_starts) = starts(&blocks);
        let spacing = SVector::from_fn(|axis, _| domain.size[axis] / cells[axis] as f64);
        let (shift, slope) = shift_and_slope(domain, cells[0], spacing[0], may_be_oblique)?;
        let domain = domain.clone();
        Ok(Grid { domain, cells, spacing, shift, may_be_oblique, slope, partition, rank, blocks, field_starts, fluid_starts })
    }

    /// The same grid after its images have slid to where they are in `domain`.
    ///
    /// # Errors
    /// They are displaced by a part of a cell, and the grid may not be oblique.
    pub fn slid(&self, domain: &Domain<D>) -> Result<Grid<D>> {
        let (shift, slope) = shift_and_slope(domain, self.cells[0], self.spacing[0], self.may_be_oblique)?;
        Ok(Grid { domain: domain.clone(), shift, slope, ..self.clone() })
    }

    /// Whether its lines along y may be oblique.
    pub fn may_be_oblique(&self) -> bool {
        self.may_be_oblique
    }

    /// The slope of its lines along y, along x over y; 0 where they are upright.
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// Whether it lies as another one of the same box: nodes are in the same places, and images too.
    pub fn lies_as(&self, other: &Grid<D>) -> bool {
        self.shift == other.shift && self.slope == other.slope
    }

    /// A point in coordinates in which lines along y are straight: along x its distance from that through the origin.
    pub fn straightened(&self, mut point: SVector<f64, D>) -> SVector<f64, D> {
        point[0] -= self.slope * point[1];
        point
    }

    /// Velocity of the frame in which convection at a point is told: in a sheared box that of the image of the box whose bottom is nearest, so that
    /// nothing moves faster there than the shear at half its height. The point, not wrapped into the box, is one of the grid or near it.
    pub fn frame_velocity(&self, point: &SVector<f64, D>) -> SVector<f64, D> {
        // a quarter of a cell off the middle lie no points of the grid
        self.domain.sliding() * ((point[1] - 0.25 * self.spacing[1]) / self.domain.size[1]).round()
    }

    /// The cells along x by which the frames of the points of a component move in an interval: for each index along y in the box.
    pub fn frame_shifts(&self, component: usize, interval: f64) -> Vec<isize> {
        let shift = |row: usize| {
            let mut index = [0; D];
            index[1] = row as isize;
            (self.frame_velocity(&self.position(component, index))[0] * interval / self.spacing[0]).round() as isize
        };
        (0..self.cells[1]).map(shift).collect()
    }

    /// The box.
    pub fn domain(&self) -> &Domain<D> {
        &self.domain
    }

    /// Cells along each axis.
    pub fn cells(&self) -> [usize; D] {
        self.cells
    }

    /// Cells by which the images above the box are displaced along x, from none to less than all.
    pub fn shift(&self) -> usize {
        self.shift
    }

    /// Edge lengths of a cell.
    pub fn spacing(&self) -> SVector<f64, D> {
        self.spacing
    }

    /// Length that stands for the spacing where one number is wanted: the geometric mean over the axes.
    pub fn mean_spacing(&self) -> f64 {
        self.spacing.product().powf(1.0 / D as f64)
    }

    /// How cells are shared out.
    pub fn partition(&self) -> &Partition<D> {
        &self.partition
    }

    /// The rank from which it is seen.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// This rank's lattice indices of a field.
    pub fn block(&self, field: usize) -> Block<D> {
        self.blocks[self.rank][field]
    }

    /// All ranks' lattice indices of a field.
    pub fn lattice(&self, field: usize) -> Block<D> {
        let last = self.blocks.len() - 1;
        Block { start: self.blocks[0][field].start, end: self.blocks[last][field].end }
    }

    /// Number of this rank's unknowns of a field.
    pub fn local_unknowns(&self, field: usize) -> usize {
        self.block(field).len()
    }

    /// Where this rank's part of each field lies in its part of a fluid vector.
    pub fn local_range(&self, field: usize) -> std::ops::Range<usize> {
        let start = self.fluid_starts[self.rank][field] - self.fluid_starts[self.rank][0];
        start..start + self.local_unknowns(field)
    }

    /// Number of this rank's unknowns in a fluid vector.
    pub fn local_fluid_unknowns(&self) -> usize {
        (0..=D).map(|field| self.local_unknowns(field)).sum()
    }

    /// Number of unknowns of all fields on all ranks.
    pub fn fluid_unknowns(&self) -> usize {
        self.blocks.iter().flatten().map(Block::len).sum()
    }

    /// Number of unknowns of a field on all ranks.
    pub fn unknowns(&self, field: usize) -> usize {
        self.blocks.iter().map(|fields| fields[field].len()).sum()
    }

    /// Where a field's value at a lattice index lies in space, not wrapped into the box.
    pub fn position(&self, field: usize, index: Index<D>) -> SVector<f64, D> {
        self.at_straightened(SVector::from_fn(|axis, _| (index[axis] as f64 + self.stagger(field, axis)) * self.spacing[axis]))
    }

    /// Where the centre of a cell, or of its image, lies if the cells of the box are drawn along the axes, whether the grid is oblique or not.
    pub fn upright_center(&self, cell: Index<D>) -> SVector<f64, D> {
        let mut center = SVector::from_fn(|axis, _| (cell[axis] as f64 + 0.5) * self.spacing[axis]);
        center[0] += self.slope * self.domain.size[1] * cell[1].div_euclid(self.cells[1] as isize) as f64;
        center
    }

    /// The point whose [`straightened`](Self::straightened) coordinates these are.
    pub fn at_straightened(&self, mut straight: SVector<f64, D>) -> SVector<f64, D> {
        straight[0] += self.slope * straight[1];
        straight
    }

    /// The middle of this rank's cells.
    pub fn middle(&self) -> SVector<f64, D> {
        let Block { start, end } = self.partition.block(self.rank);
        SVector::from_fn(|axis, _| 0.5 * (start[axis] + end[axis]) as f64 * self.spacing[axis])
    }

    /// Offset of a field's lattice from the lower corners of the cells, in cells.
    pub fn stagger(&self, field: usize, axis: usize) -> f64 {
        if field == axis { 0.0 } else { 0.5 }
    }

    /// What stands at an index of a field; along a walled axis the index must not lie beyond the walls.
    pub fn node(&self, field: usize, index: Index<D>) -> Node {
        self.run(field, index).0
    }

    /// As [`node`](Self::node), with the number of nodes, it included, that follow each other along the last axis and in a vector of the field.
    pub fn run(&self, field: usize, index: Index<D>) -> (Node, usize) {
        self.run_from(&self.field_starts, field, index)
    }

    /// As [`node`](Self::node), numbered as in a fluid vector.
    pub fn fluid_node(&self, field: usize, index: Index<D>) -> Node {
        self.fluid_run(field, index).0
    }

    /// As [`fluid_node`](Self::fluid_node), with the number of nodes, it included, that follow each other along the last axis
    /// and in a fluid vector.
    #[inline]
    pub fn fluid_run(&self, field: usize, index: Index<D>) -> (Node, usize) {
        self.run_from(&self.fluid_starts, field, index)
    }

    #[inline]
    fn run_from(&self, starts: &[Vec<usize>], field: usize, index: Index<D>) -> (Node, usize) {
        match self.unknown_at(field, index) {
            Ok((rank, index)) => {
                let block = &self.blocks[rank][field];
                (Node::Unknown(starts[rank][field] + block.offset(index)), block.end[D - 1] - index[D - 1])
            }
            Err(value) => (Node::Wall(value), 1),
        }
    }

    fn unknown_at(&self, field: usize, index: Index<D>) -> std::result::Result<(usize, [usize; D]), f64> {
        let on_wall = field < D && !self.domain.periodic(field) && (index[field] == 0 || index[field] == self.cells[field] as isize);
        if on_wall {
            // a wall's velocity along its own axis is zero
            return Err(0.0);
        }
        let cell = self.wrapped(index);
        Ok((self.partition.owner(cell), cell))
    }

    /// The index in the box that is an image of this one; along a walled axis it must not lie beyond the walls.
    pub fn wrapped(&self, mut index: Index<D>) -> [usize; D] {
        if self.shift > 0 {
            index[0] -= index[1].div_euclid(self.cells[1] as isize) * self.shift as isize;
        }
        std::array::from_fn(|axis| {
            let cells = self.cells[axis] as isize;
            if (0..cells).contains(&index[axis]) || !self.domain.periodic(axis) {
                index[axis] as usize
            } else {
                index[axis].rem_euclid(cells) as usize
            }
        })
    }

    /// Whether an index of a field along an axis lies between the walls or on them; along a periodic axis every one does.
    pub fn between_walls(&self, field: usize, axis: usize, index: isize) -> bool {
        self.domain.periodic(axis) || (0..self.cells[axis] as isize + isize::from(field == axis)).contains(&index)
    }

    /// Whether two fields have the same lattice and the same boundary conditions, hence the same Laplacian.
    pub fn same_laplacian(&self, first: usize, second: usize) -> bool {
        (0..D).all(|axis| self.domain.periodic(axis) || (first != D && second != D && (first == axis) == (second == axis)))
    }

    /// The rank whose block holds a point of the box.
    pub fn owner(&self, point: &SVector<f64, D>) -> usize {
        let mut point = self.straightened(*point);
        if self.slope != 0.0 {
            point[0] = point[0].rem_euclid(self.domain.size[0]);
        }
        let cell = std::array::from_fn(|axis| ((point[axis] / self.spacing[axis]) as usize).min(self.cells[axis] - 1));
        self.partition.owner(cell)
    }
}

/// Whole numbers of cells that are nearest to a spacing along the axes of a box.
pub fn cells_along<const D: usize>(size: &SVector<f64, D>, spacing: f64) -> SVector<f64, D> {
    size.map(|length| (length / spacing).round())
}

fn check_size<const D: usize>(cells: [usize; D], spacing: f64) -> Result<()> {
    if let Some(axis) = (0..D).find(|&axis| cells[axis] < FEWEST_CELLS) {
        return Err(Error::refused(format!(
            "a spacing of {spacing} leaves {} cells along axis {axis}: at least {FEWEST_CELLS} are needed; refine [resolution] or enlarge domain.size",
            cells[axis]
        )));
    }
    let unknowns = cells.iter().map(|&cells| cells as f64).product::<f64>() * (D + 1) as f64;
    if unknowns > MOST_UNKNOWNS {
        return Err(Error::refused(format!(
            "a grid of {cells:?} cells has more unknowns than {INDEX_BITS}-bit indices number; coarsen [resolution]{WIDER_INDICES}"
        )));
    }
    Ok(())
}

/// Refuses blocks whose matrices have more entries than a rank can count: those of the Laplacian have most.
fn check_shares<const D: usize>(partition: &Partition<D>) -> Result<()> {
    let ranks = partition.blocks();
    let largest = (0..ranks).map(|rank| partition.block(rank).len()).max().unwrap_or(0);
    let entries = (2 * D + 1) as f64 * largest as f64;
    if entries <= MOST_ENTRIES {
        return Ok(());
    }
    let enough = (ranks as f64 * entries / MOST_ENTRIES).ceil();
    Err(Error::refused(format!(
        "a block of {largest} cells on one rank has matrices of {entries:.3e} entries, more than 32 bits count; use {enough} ranks or more, or \
         coarsen [resolution]"
    )))
}

/// The cells of a displacement, without whole turns of the box, and the slope of lines that takes the part of a cell that is left over.
fn shift_and_slope<const D: usize>(domain: &Domain<D>, cells: usize, spacing: f64, may_be_oblique: bool) -> Result<(usize, f64)> {
    let shift = domain.shift() / spacing;
    let whole = shift.round();
    let slope = match (shift - whole).abs() > PART_OF_CELL * (1.0 + shift.abs()) {
        false => 0.0,
        true if may_be_oblique => (shift - whole) * spacing / domain.size[1],
        true => {
            return Err(Error::refused(format!(
                "the images of a sheared box lie {shift} cells aside; only whole cells have stencils across the boundary: choose times at which they are"
            )));
        }
    };
    Ok((whole.rem_euclid(cells as f64) as usize, slope))
}

fn field_block<const D: usize>(domain: &Domain<D>, cells: Block<D>, field: usize) -> Block<D> {
    let mut block = cells;
    if field < D && !domain.periodic(field) {
        block.start[field] = block.start[field].max(1);
    }
    block
}

fn starts<const D: usize>(blocks: &[Vec<Block<D>>]) -> (Vec<Vec<usize>>, Vec<Vec<usize>>) {
    let (mut per_field, mut fluid) = (vec![0; D + 1], 0);
    let mut field_starts = Vec::new();
    let mut fluid_starts = Vec::new();
    for fields in blocks {
        field_starts.push(per_field.clone());
        let mut starts = Vec::new();
        for (field, block) in fields.iter().enumerate() {
            starts.push(fluid);
            fluid += block.len();
            per_field[field] += block.len();
        }
        fluid_starts.push(starts);
    }
    (field_starts, fluid_starts)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::geometry::Axis;

    #[test]
    fn what_one_rank_cannot_count_two_can() {
        let domain = Domain { size: SVector::from([660.0; 3]), axes: [Axis::Periodic; 3] };
        let error = Grid::new(&domain, 1.0, 1, 0).unwrap_err().to_string();
        assert!(error.contains("2.012e9 entries") && error.contains("use 2 ranks or more"), "{error}");
        assert_eq!(Grid::new(&domain, 1.0, 2, 0).unwrap().unknowns(3), 660 * 660 * 660);
    }

    #[test]
    fn unknowns_beyond_the_indices_of_this_build_are_refused() {
        // with three fields, above what 32-bit indices number and below what 64-bit ones do
        let domain = Domain { size: SVector::from([32_000.0; 2]), axes: [Axis::Periodic; 2] };
        let grid = Grid::new(&domain, 1.0, 4, 0);
        if INDEX_BITS == 64 {
            return assert_eq!(grid.unwrap().fluid_unknowns(), 3 * 32_000 * 32_000);
        }
        let error = grid.unwrap_err().to_string();
        assert!(error.contains("32-bit indices") && error.contains("TURBID_INDEX_BITS=64"), "{error}");
    }
}
