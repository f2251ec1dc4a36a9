//! The summary of what a run has come to.

use super::output::{Evaluated, EvaluatedMotion};
use crate::{
    output::{ContactSummary, GlueSummary, Summary},
    scene::ContactModel,
};

/// The numbers of what is seen, without those of the run as a whole; collective.
pub fn summary<const D: usize>(seen: &Evaluated<D>) -> Summary {
    let mut summary = match (&seen.flow, &seen.motion) {
        (Some(flow), _) => Summary::of_flow(seen.scene, flow.solver, flow.solution, seen.viscosity, seen.world),
        (None, Some(motion)) => {
            let (state, balls) = (motion.simulation.whole_state(), motion.simulation.whole_balls());
            Summary::of_granular(seen.scene, motion.domain(), &state, &balls, seen.world)
        }
        (None, None) => unreachable!("a run evaluates something before it ends"),
    };
    let Some(motion) = &seen.motion else { return summary };
    (summary.time, summary.steps) = (motion.state().time, motion.state().steps);
    if seen.scene.contact.model != ContactModel::None {
        summary.contact = Some(contacts(seen.scene.contact.model, motion));
        if let (Some(parts), Some(viscosity)) = (&mut summary.viscosity, seen.viscosity) {
            parts.contact = Some(viscosity.contact);
            parts.particle_pressure_contact = Some(viscosity.normal.contact_pressure);
        }
    }
    if let Some(parts) = &mut summary.viscosity {
        parts.mean = seen.history.mean().copied();
    }
    summary
}

/// Contacts now, and how well they were kept on the way. Collective.
fn contacts<const D: usize>(model: ContactModel, motion: &EvaluatedMotion<D>) -> ContactSummary {
    let (state, held, kept) = (motion.simulation.whole_state(), motion.held(), motion.statistics.contacts());
    let glue = || GlueSummary { stuck: state.stuck.len(), gamma: state.stuck.iter().map(|stuck| stuck.gamma).fold(0.0, f64::min) };
    ContactSummary {
        model: model.word(),
        pairs: kept.pairs,
        active: held.len(),
        smallest_gap: kept.smallest_gap,
        kkt_residual: (!matches!(model, ContactModel::Repulsion { .. })).then_some(kept.kkt_residual),
        total_force: held.iter().map(|held| held.force).sum(),
        glue: model.gluey().then(glue),
    }
}
