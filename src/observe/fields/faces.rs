//! Velocities on the faces of a rank's cells and of some layers around them, for stencils.

use crate::{
    constraint::IndexBox,
    error::Result,
    flow::OpenEnds,
    grid::{
        Grid, Index, Node,
        operators::signed,
        stencil::{Site, Term},
    },
    petsc::{Scatter, Vector},
};

/// Layers of cells around those of a rank that [`FaceValues::dense`] may need to know.
pub const LAYERS: usize = 2;

/// Weights in the value half a cell and one and a half beyond a wall of that of the wall and those half a cell and one and a half before it: parabolas.
const BEYOND: [[f64; 3]; 2] = [[8.0 / 3.0, -2.0, 1.0 / 3.0], [8.0, -9.0, 2.0]];

/// Brings these velocities to this rank; made once for a grid.
pub struct NearFaces<const D: usize> {
    faces: Scatter,
    cells: IndexBox<D>,
    /// For each cell and each component the place of the lower face among those that are fetched; none where the velocity is zero, on walls.
    places: Vec<Option<usize>>,
}

/// The velocities of one flow.
pub struct FaceValues<'a, const D: usize> {
    grid: &'a Grid<D>,
    faces: &'a [f64],
    cells: &'a IndexBox<D>,
    places: &'a [Option<usize>],
    ends: Option<OpenEnds<D>>,
}

/// Velocities at all indices of these cells, those beyond walls included.
pub struct DenseFaces<'a, const D: usize> {
    cells: &'a IndexBox<D>,
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
        let [start, end] =
            [(block.start, -(layers as isize)), (block.end, layers as isize)].map(|(corner, far)| signed(corner).map(|index| index + far));
        let cells = IndexBox::between(start, end);
        let (mut wanted, mut places) = (Vec::new(), Vec::new());
        for index in cells.indices() {
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
        Ok(FaceValues { grid, faces: self.faces.fetch(fluid)?, cells: &self.cells, places: &self.places, ends })
    }
}

impl<'a, const D: usize> FaceValues<'a, D> {
    /// All of them; beyond a wall a component goes on as it does before it, that across the wall evenly. The box has no open ends.
    pub fn dense(&self) -> DenseFaces<'a, D> {
        let values = (0..D).map(|component| self.cells.indices().map(|index| self.at(component, index)).collect()).collect();
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
            let (true, Some(walls)) = (beyond >= 0, domain.axes[axis].ends()) else { continue };
            let [wall, near, far] = BEYOND[beyond as usize];
            let before = |steps: isize| self.at(component, with(if upper { cells - 1 - steps } else { steps }));
            return wall * walls[usize::from(upper)][component] + near * before(0) + far * before(1);
        }
        self.known(component, index)
    }

    /// A component at an index of its lattice that is not beyond a wall.
    fn known(&self, component: usize, index: Index<D>) -> f64 {
        self.places[D * self.cells.place(index) + component].map_or(0.0, |place| self.faces[place])
    }

    /// What a term of a stencil contributes.
    pub fn value(&self, term: &Term<D>) -> f64 {
        term.weight
            * match (self.ends.as_ref().and_then(|ends| ends.at_site(self.grid, &term.site)), term.site) {
                (Some(value), _) | (None, Site::Wall { value, .. }) => value,
                (None, Site::Lattice { field, index }) => self.known(field, index),
            }
    }
}

impl<const D: usize> DenseFaces<'_, D> {
    /// All values of a component, and the place of that at an index.
    pub fn of(&self, component: usize, index: Index<D>) -> (&[f64], usize) {
        (&self.values[component], self.cells.place(index))
    }

    /// Distances between the places of neighbours along each axis.
    pub fn strides(&self) -> [usize; D] {
        self.cells.strides()
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
