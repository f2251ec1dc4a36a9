//! Contacts, and how well their laws were kept in the step that led here.

use crate::{
    contact::{FrictionReport, KktReport, Solver},
    run::{
        quantity::{Finite, Perhaps, Quantity},
        view::View,
    },
    scene::ContactModel,
};

/// Of which contacts it is counted whether they slide.
const WHEN: &str = " in the step that led here; in row 0 of a flow, at its time";

/// Forces of contacts and the quadratic program.
pub fn contacts<const D: usize>() -> Vec<Quantity<D>> {
    let mut all = network();
    all.extend(program());
    all
}

/// Which contacts there are.
fn network<const D: usize>() -> Vec<Quantity<D>> {
    vec![
        Quantity::new("contacts", "", "contacts that bear a force or stick", |view| {
            contact(view).and_then(|_| Some(view.contacts()?.active))
        }),
        Quantity::new(
            "contact_number",
            "",
            "mean number of such contacts of a body: the coordination number of the network of contacts",
            |view| contact(view).and_then(|_| Some(view.contacts()?.ends as f64 / view.motion?.state().count() as f64)),
        ),
        Quantity::new(
            "fabric",
            "",
            "in a flow the mean of `n n` over the normals of contacts that press: the fabric tensor; empty where none does",
            |view| contact(view).and(view.flow).and(view.motion).map(|motion| Perhaps(motion.fabric())),
        ),
        Quantity::new("stuck", "", "contacts that stick (sticky contact, `gluey`)", |view| {
            contact(view)?.gluey().then(|| Some(view.contacts()?.adhesive))?
        }),
    ]
}

/// Gaps, forces and how they were found.
fn program<const D: usize>() -> Vec<Quantity<D>> {
    let gap = "smallest gap between bodies, or of a body to a wall; negative: overlap; empty: no two are near, or the start of a run without a fluid";
    vec![
        Quantity::new("smallest_gap", "radii of the smaller body", gap, |view| {
            contact(view).map(|_| Finite(kept(view).map(|kept| kept.smallest_gap).or_else(|| gap_at_start(view)).unwrap_or(f64::INFINITY)))
        }),
        Quantity::new("kkt_residual", "", "residual of the optimality conditions of the contact problem", |view| {
            projected(view).map(|kept| kept.map_or(0.0, |kept| kept.kkt_residual))
        })
        .of_run(),
        Quantity::new("contact_force", "force", "sum of the normal forces of contacts; those that push are positive", |view| {
            projected(view).and_then(|_| Some(view.contacts()?.force))
        }),
        Quantity::new("contact_iterations", "", "iterations of the contact solver", |view| {
            projected(view).map(|kept| kept.map_or(0, |kept| kept.iterations))
        })
        .of_run(),
        Quantity::new(
            "contact_solver",
            "",
            "which solver of contacts: 0 a formula, 1 parts of islands by the sparse interior point and active set, 2 clarabel",
            |view| projected(view).map(|kept| kept.map_or(Solver::Formula, |kept| kept.solver) as usize),
        )
        .of_run(),
    ]
}

/// The law of friction.
pub fn friction<const D: usize>() -> Vec<Quantity<D>> {
    let residual = "residual of the law of friction in the step that led here";
    vec![
        Quantity::new("friction_residual", "ratio", residual, |view| Some(slid(view)?.residual)).of_run(),
        Quantity::new("sticking", "", format!("contacts that press and do not slide{WHEN}"), |view| Some(slid(view)?.sticking)),
        Quantity::new("slipping", "", format!("contacts that press and slide{WHEN}"), |view| Some(slid(view)?.slipping)),
        Quantity::new(
            "contact_work",
            "energy; 2D: energy/length",
            "work of contact forces on free bodies in the step: with that of other forces the change of their kinetic energy",
            |view| Some(slid(view)?.work),
        ),
        Quantity::new("friction_sweeps", "", "most sweeps over an island with friction", |view| Some(slid(view)?.sweeps)).of_run(),
        Quantity::new("friction_iterations", "", "most iterations of the interior point on one", |view| Some(slid(view)?.iterations))
            .of_run(),
    ]
}

/// The contact model of a run in time, if there is one.
fn contact<const D: usize>(view: &View<D>) -> Option<ContactModel> {
    view.motion.map(|_| view.scene.contact.model).filter(|model| *model != ContactModel::None)
}

/// How contacts were kept in the last step, if there was one.
fn kept<const D: usize>(view: &View<D>) -> Option<KktReport> {
    view.motion?.statistics.last()?.kkt_report
}

/// The same where velocities are projected.
fn projected<const D: usize>(view: &View<D>) -> Option<Option<KktReport>> {
    matches!(contact(view)?, ContactModel::Inelastic | ContactModel::Gluey { .. }).then(|| kept(view))
}

/// The smallest gap at the start of a run in a flow.
fn gap_at_start<const D: usize>(view: &View<D>) -> Option<f64> {
    view.motion.filter(|motion| motion.state().steps == 0)?.simulation.smallest_gap()
}

/// How friction was kept, where there is friction.
fn slid<const D: usize>(view: &View<D>) -> Option<FrictionReport> {
    let motion = view.motion.filter(|_| view.scene.contact.friction.coefficient != 0.0)?;
    let at_start = || motion.observation.friction.filter(|_| motion.state().steps == 0);
    Some(kept(view).and_then(|kept| kept.friction).or_else(at_start).unwrap_or_default())
}
