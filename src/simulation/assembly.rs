//! Bodies in their places: their blocks, and what of an earlier assembly still holds.

use std::{collections::HashMap, rc::Rc};

use nalgebra::SVector;

use super::{basis::Basis, bodies::Bodies, links::medium, touching::Medium};
use crate::{
    constraint::{
        self, AdjointBlocks, AdjointBody, Blocks, Crowd, INTERPOLATION_REACH, Layout, Method, NearPairs, Neighbour, Placed, SharpBlocks,
        Situation, Workspace, lubrication::Films,
    },
    error::{Error, Result},
    geometry::Ball,
    parallel::World,
};

/// Net force or torque of a film on a pair, over its force, that is rounding.
const LARGEST_IMBALANCE: f64 = 1e-9;

/// Bodies in their places.
pub struct Assembly<const D: usize> {
    centers: Vec<SVector<f64, D>>,
    /// The bodies in the box.
    pub placed: Rc<Vec<Placed<D>>>,
    /// Who is near whom.
    pub crowd: Rc<Crowd<D>>,
    /// Who holds which multipliers.
    pub layout: Layout,
    /// The blocks of this rank's bodies.
    pub blocks: Blocks<D>,
    /// Bodies of this rank whose blocks are new.
    pub assembled: usize,
    /// Near pairs, if multipliers are coefficients of surface modes.
    pub pairs: Option<NearPairs>,
    /// The films of this rank's bodies.
    pub films: Films<D>,
    /// What bodies resist besides films and contacts, where near pairs answer to motions.
    pub medium: Option<Medium>,
    /// The velocity of the flow without bodies, tested with the rows of this rank's bodies.
    pub undisturbed: Vec<f64>,
}

impl<const D: usize> Assembly<D> {
    /// The assembly of bodies with the given centres; of an earlier one all that did not move is used again.
    pub fn of(basis: &Basis<D>, centers: &[SVector<f64, D>], earlier: Option<Assembly<D>>) -> Result<Assembly<D>> {
        match earlier {
            Some(assembly) if assembly.centers == centers => Ok(Assembly { assembled: 0, ..assembly }),
            earlier => Assembly::anew(basis, centers, earlier.map(|earlier| earlier.blocks)),
        }
    }

    fn anew(basis: &Basis<D>, centers: &[SVector<f64, D>], earlier: Option<Blocks<D>>) -> Result<Assembly<D>> {
        let (session, fluid, method) = (&basis.session, &basis.undisturbed.0, basis.setup.blocks());
        let placed = Rc::new(basis.kinds.place(&basis.setup, centers));
        let crowd = Rc::new(crowd(basis, &placed));
        let (layout, blocks, assembled) = match (method, earlier) {
            (Method::Sharp, Some(Blocks::Sharp(earlier))) => sharp(basis, (&placed, &crowd), Some(earlier))?,
            (Method::Sharp, _) => sharp(basis, (&placed, &crowd), None)?,
            (_, Some(Blocks::Adjoint(earlier))) => adjoint(basis, &placed, earlier.into_bodies())?,
            _ => adjoint(basis, &placed, Vec::new())?,
        };
        let mut blocks = blocks;
        let bodies = Bodies::new((&basis.setup, &basis.grid, &basis.kinds), (placed.clone(), crowd.clone()), layout);
        let undisturbed = bodies.undisturbed(&mut blocks, fluid, |body, point| {
            // a body that has left a sheared box goes on as fast as the image of the box in which it is
            basis.background(point) + basis.setup.domain.image_velocity(&centers[body])
        })?;
        let pairs = if method.on_surfaces() { Some(bodies.near_pairs(session)?) } else { None };
        let (films, medium) = (balanced(session.world(), bodies.films())?, medium(basis, &bodies, centers, pairs.as_ref()));
        let (centers, layout) = (centers.to_vec(), bodies.layout);
        Ok(Assembly { centers, placed, crowd, layout, blocks, assembled, pairs, films, medium, undisturbed })
    }
}

/// Films whose forces are opposite and without torque on each pair, as they must be.
fn balanced<const D: usize>(world: &World, films: Films<D>) -> Result<Films<D>> {
    let imbalance = world.max(films.imbalance);
    match imbalance < LARGEST_IMBALANCE {
        true => Ok(films),
        false => Err(Error::Diverged(format!("a film acts on its pair with a net force or torque of {imbalance:.1e} of its force"))),
    }
}

/// The bodies with all that any part of the simulation takes for near.
fn crowd<const D: usize>(basis: &Basis<D>, placed: &[Placed<D>]) -> Crowd<D> {
    let balls: Vec<Ball<D>> = placed.iter().map(Placed::ball).collect();
    let orders = basis.setup.bodies.iter().map(|suspended| suspended.order).collect();
    let (method, films) = (basis.setup.blocks(), basis.setup.interactions.resist());
    let of_bodies = if method.on_surfaces() || films { Crowd::reach(&balls) } else { 0.0 };
    let of_stencils = if method == Method::Sharp { INTERPOLATION_REACH * basis.grid.spacing().max() } else { 0.0 };
    let reach = of_bodies.max(of_stencils);
    Crowd::new(&basis.setup.domain, balls, orders, reach)
}

/// Who holds which of the bodies, with so many multipliers each.
fn layout<const D: usize>(basis: &Basis<D>, placed: &[Placed<D>], counts: &[usize]) -> Layout {
    let centers: Vec<SVector<f64, D>> = placed.iter().map(|placed| placed.center).collect();
    Layout::new(&basis.grid, &centers, counts, basis.session.world().rank())
}

/// Blocks of the sharp method, with the number of those that are new; bodies that did not move, nor their neighbours, keep theirs.
fn sharp<const D: usize>(
    basis: &Basis<D>,
    (placed, crowd): (&[Placed<D>], &Crowd<D>),
    earlier: Option<SharpBlocks<D>>,
) -> Result<(Layout, Blocks<D>, usize)> {
    let counts: Vec<usize> = placed.iter().map(|placed| placed.surface.modes.count()).collect();
    let (layout, neighbours) = (layout(basis, placed, &counts), neighbours(basis, (placed, crowd)));
    let (mut workspace, mut kept) = (Workspace::default(), HashMap::new());
    for blocks in earlier.into_iter().flat_map(SharpBlocks::into_bodies) {
        let body = blocks.situation.body;
        if layout.holds(body) && blocks.situation == Situation::of((body, &placed[body]), &neighbours[body]) {
            kept.insert(body, blocks);
        } else {
            workspace.recycle(blocks);
        }
    }
    let assembled = layout.local_bodies.len() - kept.len();
    let assemble = |&body: &usize| {
        let anew = || constraint::assemble(&basis.grid, (body, &placed[body]), &neighbours[body], &mut workspace);
        kept.remove(&body).unwrap_or_else(anew)
    };
    let bodies = layout.local_bodies.iter().map(assemble).collect();
    let blocks = SharpBlocks::new(&basis.session, &basis.undisturbed.0, &layout, bodies)?;
    Ok((layout, Blocks::Sharp(blocks), assembled))
}

/// For each body, those whose inside the interpolation on its surface may meet.
fn neighbours<const D: usize>(basis: &Basis<D>, (placed, crowd): (&[Placed<D>], &Crowd<D>)) -> Vec<Vec<Neighbour<D>>> {
    let reach = INTERPOLATION_REACH * basis.grid.spacing().max();
    let mut neighbours: Vec<Vec<Neighbour<D>>> = vec![Vec::new(); placed.len()];
    for pair in crowd.pairs.iter().filter(|pair| pair.gap < reach) {
        for (body, other, separation) in [(pair.first, pair.second, pair.separation), (pair.second, pair.first, -pair.separation)] {
            let image = Placed { center: placed[body].center + separation, surface: placed[other].surface.clone() };
            neighbours[body].push((other, image));
        }
    }
    neighbours
}

/// Blocks of the other methods, with the number of those that are new; bodies that did not move keep theirs. Collective.
fn adjoint<const D: usize>(basis: &Basis<D>, placed: &[Placed<D>], earlier: Vec<AdjointBody<D>>) -> Result<(Layout, Blocks<D>, usize)> {
    let (grid, method, world) = (&basis.grid, basis.setup.blocks(), basis.session.world());
    let mut kept: HashMap<usize, AdjointBody<D>> = earlier.into_iter().map(|body| (body.body, body)).collect();
    kept.retain(|&body, earlier| earlier.center == placed[body].center && grid.owner(&earlier.center) == world.rank());
    let held = kept.len();
    let own = placed.iter().enumerate().filter(|(_, placed)| grid.owner(&placed.center) == world.rank());
    let bodies: Vec<AdjointBody<D>> = own
        .map(|(body, placed)| kept.remove(&body).unwrap_or_else(|| constraint::assemble_adjoint(method, grid, (body, placed))))
        .collect();
    let found = world.gather(&bodies.iter().flat_map(|body| [body.body as f64, body.count() as f64]).collect::<Vec<f64>>());
    let mut counts = vec![0; placed.len()];
    found.chunks(2).for_each(|found| counts[found[0] as usize] = found[1] as usize);
    let (layout, assembled) = (layout(basis, placed, &counts), bodies.len() - held);
    let blocks = AdjointBlocks::new(&basis.undisturbed.0, &layout, bodies)?;
    Ok((layout, Blocks::Adjoint(blocks), assembled))
}
