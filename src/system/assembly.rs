//! Bodies in their places: their blocks, and what of an earlier assembly still holds.

use std::rc::Rc;

use nalgebra::SVector;

use super::{bodies::Bodies, fixed_operators::FixedOperators, pair_constraints::Medium, pair_resistance::medium};
use crate::{
    constraint::{
        Assembled, Blocks, MultiplierLayout, Neighbourhood, PairPreconditioner, Placed, lubrication::LubricationPairs, neighbours,
        rotations, surrounded,
    },
    error::{Error, Result},
    geometry::Ball,
    parallel::World,
    petsc::Vector,
    setup::room::CELLS_AT_ENDS,
};

/// Net force or torque of a film on a pair, over its force, that is rounding.
const LARGEST_IMBALANCE: f64 = 1e-9;

/// Bodies in their places.
pub struct Assembly<const D: usize> {
    centers: Vec<SVector<f64, D>>,
    /// The bodies in the box.
    pub placed: Rc<Vec<Placed<D>>>,
    /// Who is near whom.
    pub neighbourhood: Rc<Neighbourhood<D>>,
    /// Who holds which multipliers.
    pub layout: MultiplierLayout,
    /// The blocks of this rank's bodies.
    pub blocks: Blocks<D>,
    /// Bodies of this rank whose blocks are new.
    pub assembled: usize,
    /// Near pairs, if multipliers are coefficients of surface modes.
    pub pairs: Option<PairPreconditioner>,
    /// The films of this rank's bodies.
    pub films: LubricationPairs<D>,
    /// What bodies resist besides films and contacts, where near pairs answer to motions.
    pub medium: Option<Medium>,
    /// The velocity of the flow without bodies, and of known spin-ups, tested with the rows of this rank's bodies.
    pub undisturbed: Vec<f64>,
    /// Damping of this rank's bodies; nothing where none is damped.
    pub damping: Vec<f64>,
}

impl<const D: usize> Assembly<D> {
    /// The assembly of bodies with the given centres; of an earlier one all that did not move is used again.
    pub fn of(fixed: &FixedOperators<D>, centers: &[SVector<f64, D>], earlier: Option<Assembly<D>>) -> Result<Assembly<D>> {
        match earlier {
            Some(assembly) if assembly.centers == centers && fixed.body_types.placed_so(&assembly.placed) => {
                Ok(Assembly { assembled: 0, ..assembly })
            }
            earlier => Assembly::anew(fixed, centers, earlier.map(|earlier| earlier.blocks)),
        }
    }

    fn anew(fixed: &FixedOperators<D>, centers: &[SVector<f64, D>], earlier: Option<Blocks<D>>) -> Result<Assembly<D>> {
        refuse_open_ends(fixed, centers)?;
        let (session, method) = (&fixed.session, fixed.method.as_ref());
        let placed = Rc::new(fixed.body_types.place(&fixed.setup, centers));
        let neighbourhood = Rc::new(neighbourhood(fixed, &placed));
        let neighbours = neighbours(&placed, &neighbourhood.pairs, method.reach() * fixed.grid.spacing().max());
        let Assembled { layout, blocks, new: assembled } =
            Assembled::new(&fixed.grid, &fixed.stokes.vector()?, method, &surrounded(&placed, &neighbours), earlier)?;
        let bodies = Bodies::new(&fixed.setup, &fixed.grid, &fixed.body_types, placed.clone(), neighbourhood.clone(), layout);
        let known_pairs = method.on_surfaces() && fixed.setup.inertia.is_none() && fixed.body_types.are_balls();
        let pairs = if known_pairs { Some(bodies.near_pairs(session)?) } else { None };
        let (films, medium) = (balanced(session.world(), bodies.films())?, medium(fixed, &bodies, centers, pairs.as_ref()));
        let (centers, layout) = (centers.to_vec(), bodies.layout);
        let (undisturbed, damping) = (Vec::new(), Vec::new());
        let mut assembly =
            Assembly { centers, placed, neighbourhood, layout, blocks, assembled, pairs, films, medium, undisturbed, damping };
        // with inertia that flow is another one in every step
        if fixed.setup.inertia.is_none() {
            assembly.meet_flow(fixed)?;
        }
        Ok(assembly)
    }

    /// Reads the flow without bodies on the surfaces.
    pub fn meet_flow(&mut self, fixed: &FixedOperators<D>) -> Result<()> {
        let (placed, neighbourhood, layout) = (self.placed.clone(), self.neighbourhood.clone(), self.layout.clone());
        let bodies = Bodies::new(&fixed.setup, &fixed.grid, &fixed.body_types, placed, neighbourhood, layout);
        let known = |body: usize, point: &SVector<f64, D>| {
            // a body that has left a sheared box goes on as fast as the image of the box in which it is
            fixed.background(point) + fixed.setup.domain.image_velocity(&self.centers[body])
        };
        self.undisturbed = bodies.undisturbed(&mut self.blocks, fixed.undisturbed.0.as_ref(), known)?;
        if !fixed.spin_ups.is_empty() {
            self.blocks.add_spin_up(&self.known_spin_ups(fixed)?, &mut self.undisturbed)?;
        }
        Ok(())
    }

    /// Spin-ups that are known, in the places of multipliers of rotations.
    pub fn known_spin_ups(&self, fixed: &FixedOperators<D>) -> Result<Vector> {
        let mut spin_ups = Vector::new(&fixed.session, self.layout.local_unknowns())?;
        let mut places = spin_ups.local_mut()?;
        for &body in &self.layout.local_bodies {
            places[self.layout.local(body)..][rotations::<D>()].copy_from_slice(&fixed.spin_ups[body]);
        }
        drop(places);
        Ok(spin_ups)
    }
}

/// Ends a run in which bodies come to an inflow or an outflow, whose velocity is given whatever they do.
fn refuse_open_ends<const D: usize>(fixed: &FixedOperators<D>, centers: &[SVector<f64, D>]) -> Result<()> {
    let (grid, bodies) = (&fixed.grid, &fixed.setup.bodies);
    let Some((axis, _)) = grid.domain().open() else { return Ok(()) };
    let room = |body: usize| bodies[body].body.ball.radius + CELLS_AT_ENDS * grid.spacing()[axis];
    let near = |body: usize| centers[body][axis] < room(body) || centers[body][axis] > grid.domain().size[axis] - room(body);
    match (0..centers.len()).find(|&body| near(body)) {
        Some(body) => Err(Error::Diverged(format!(
            "body {body} comes within {CELLS_AT_ENDS} cells of where fluid flows in or out; set an earlier time.end, or enlarge domain.size"
        ))),
        None => Ok(()),
    }
}

/// Films whose forces are opposite and without torque on each pair, as they must be.
fn balanced<const D: usize>(world: &World, films: LubricationPairs<D>) -> Result<LubricationPairs<D>> {
    let imbalance = world.max(films.imbalance);
    match imbalance < LARGEST_IMBALANCE {
        true => Ok(films),
        false => {
            Err(Error::Diverged(format!("a lubrication film acts on its pair with a net force or torque of {imbalance:.1e} of its force")))
        }
    }
}

/// The bodies with all that any part of the simulation takes for near.
fn neighbourhood<const D: usize>(fixed: &FixedOperators<D>, placed: &[Placed<D>]) -> Neighbourhood<D> {
    let balls: Vec<Ball<D>> = placed.iter().map(Placed::ball).collect();
    let orders = fixed.setup.bodies.iter().map(|suspended| suspended.order).collect();
    let (method, films) = (&fixed.method, fixed.setup.interactions.resist());
    let of_bodies = if method.on_surfaces() || films { Neighbourhood::reach(&balls) } else { 0.0 };
    let reach = of_bodies.max(method.reach() * fixed.grid.spacing().max());
    let (grid, rank) = (&fixed.grid, fixed.session.world().rank());
    let own: Vec<usize> = (0..balls.len()).filter(|&body| grid.owner(&balls[body].center) == rank).collect();
    Neighbourhood::new(&fixed.setup.domain, balls, orders, reach, &own, &grid.middle())
}
