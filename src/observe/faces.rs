//! Velocities on the faces of a rank's cells and of some layers around them, for stencils.

use crate::{
    error::Result,
    flow::OpenEnds,
    grid::{
        Grid, Index, Node,
        operators::signed,
        stencil::{Site, Term},
    },
    petsc::{LocalRead, Scatter, Vector},
};

/// Layers of cells around those of a rank that [`FaceValues::dense`] may need to know.
pub const LAYERS: usize = 2;

/// Weights in the value half a cell and one and a half beyond a wall of that of the wall and those half a cell and one and a half before it: parabolas.
const BEYOND: [[f64; 3]; 2] = [[8.0 / 3.0, -2.0, 1.0 / 3.0], [8.0, -9.0, 2.0]];

/// Brings these velocities to this rank; made once for a grid.
pub struct NearFaces<const D: usize> {
    faces: Scatter,
    cells: NearCells<D>,
    /// For each cell and each component the place of the lower face among those that are fetched; none where the velocity is zero, on walls.
    places: Vec<Option<usize>>,
}

/// This rank's cells and layers around them.
#[derive(Debug, Clone, Copy)]
struct NearCells<const D: usize> {
    start: Index<D>,
    extent: [usize; D],
}

/// The velocities of one flow.
pub struct FaceValues<'a, const D: usize> {
    grid: &'a Grid<D>,
    faces: LocalRead<'a>,
    cells: NearCells<D>,
    places: &'a [Option<usize>],
    ends: Option<OpenEnds<D>>,
}

/// Velocities at all indices of these cells, those beyond walls included.
pub struct DenseFaces<const D: usize> {
    cells: NearCells<D>,
    /// Component by component.
    values: Vec<Vec<f64>>,
}

impl<const D: usize> NearFaces<D> {
    /// Plans the exchange of faces between ranks; `fluid` is any fluid vector. Collective.
    ///
    /// # Errors
    /// PETSc fails, here and below.
    pub fn new(grid: &Grid<D>, fluid: &Vector, layers: usize) -> Result<NearFaces<D>> {
        let block = grid.block(D);
        let start: Index<D> = signed(block.start).map(|first| first - layers as isize);
        let cells = NearCells { start, extent: std::array::from_fn(|axis| block.end[axis] - block.start[axis] + 2 * layers) };
        let (mut wanted, mut places) = (Vec::new(), Vec::new());
        for place in 0..cells.extent.iter().product() {
            let index = cells.index(place);
            for component in 0..D {
                places.push(unknown(grid, component, index).map(|unknown| {
                    wanted.push(unknown);
                    wanted.len() - 1
                }));
            }
        }
        Ok(NearFaces { faces: Scatter::new(fluid, &wanted)?, cells, places })
    }

    /// Those of a fluid vector on the grid. Collective.
    pub fn of<'a>(&'a mut self, grid: &'a Grid<D>, fluid: &Vector) -> Result<FaceValues<'a, D>> {
        let ends = OpenEnds::of(grid, fluid)?;
        Ok(FaceValues { grid, faces: self.faces.fetch(fluid)?, cells: self.cells, places: &self.places, ends })
    }
}

impl<const D: usize> FaceValues<'_, D> {
    /// All of them; beyond a wall a component goes on as it does before it, that across the wall evenly. The box has no open ends.
    pub fn dense(&self) -> DenseFaces<D> {
        let count = self.cells.extent.iter().product();
        let values = (0..D).map(|component| (0..count).map(|place| self.at(component, self.cells.index(place))).collect()).collect();
        DenseFaces { cells: self.cells, values }
    }

    fn at(&self, component: usize, index: Index<D>) -> f64 {
        let domain = self.grid.domain();
        for axis in (0..D).filter(|&axis| !domain.periodic(axis)) {
            let cells = self.grid.cells()[axis] as isize;
            let with = |place: isize| std::array::from_fn(|other| if other == axis { place } else { index[other] });
            if axis == component {
                if !(0..=cells).contains(&index[axis]) {
                    return self.at(component, with(if index[axis] < 0 { -index[axis] } else { 2 * cells - index[axis] }));
                }
                continue;
            }
            let upper = index[axis] >= cells;
            let beyond = if upper { index[axis] - cells } else { -1 - index[axis] };
            let (true, Some(walls)) = (beyond >= 0, domain.axes[axis].walls()) else { continue };
            let [wall, near, far] = BEYOND[beyond as usize];
            let before = |steps: isize| self.at(component, with(if upper { cells - 1 - steps } else { steps }));
            return wall * walls[usize::from(upper)][component] + near * before(0) + far * before(1);
        }
        self.places[D * self.cells.place(index) + component].map_or(0.0, |place| self.faces[place])
    }

    /// What a term of a stencil contributes.
    pub fn value(&self, term: &Term<D>) -> f64 {
        term.weight
            * match (self.ends.as_ref().and_then(|ends| ends.at_site(self.grid, &term.site)), term.site) {
                (Some(value), _) | (None, Site::Wall { value, .. }) => value,
                (None, Site::Lattice { field, index }) => {
                    self.places[D * self.cells.place(index) + field].map_or(0.0, |place| self.faces[place])
                }
            }
    }
}

impl<const D: usize> DenseFaces<D> {
    /// All values of a component, and the place of that at an index.
    pub fn of(&self, component: usize, index: Index<D>) -> (&[f64], usize) {
        (&self.values[component], self.cells.place(index))
    }

    /// Distance between the places of neighbours along an axis.
    pub fn stride(&self, axis: usize) -> usize {
        self.cells.extent[..axis].iter().product()
    }
}

impl<const D: usize> NearCells<D> {
    fn index(&self, place: usize) -> Index<D> {
        let (mut index, mut rest) = (self.start, place);
        for (index, extent) in index.iter_mut().zip(self.extent) {
            *index += (rest % extent) as isize;
            rest /= extent;
        }
        index
    }

    fn place(&self, index: Index<D>) -> usize {
        (0..D).rev().fold(0, |place, axis| place * self.extent[axis] + (index[axis] - self.start[axis]) as usize)
    }
}

/// The unknown at the lower face of a cell that may lie outside of the box.
fn unknown<const D: usize>(grid: &Grid<D>, component: usize, index: Index<D>) -> Option<usize> {
    let within = |axis: usize| grid.domain().periodic(axis) || (0..grid.cells()[axis] as isize).contains(&index[axis]);
    match (0..D).all(within).then(|| grid.fluid_node(component, index)) {
        Some(Node::Unknown(unknown)) => Some(unknown),
        _ => None,
    }
}
