//! The summary of what a run has come to.

use std::path::Path;

use super::{column::SeriesEntry, motion_view::MotionView, view::View};
use crate::{
    contact::FrictionReport,
    error::Result,
    output::{
        BODY_TABLE, BodySummary, ContactSummary, FrictionSummary, GlueSummary, QuantitySummary, Summary, viscosity_too_short, write_bodies,
    },
    parallel::World,
    scene::{ContactModel, Scene},
};

/// The numbers of what is seen, without those of the run as a whole; collective.
pub fn summary<const D: usize>(view: &View<D>) -> Summary {
    let mut summary = match (&view.flow, &view.motion) {
        (Some(flow), _) => Summary::of_flow(view.scene, flow.solver, flow.solution, view.viscosity, view.world),
        (None, Some(motion)) => Summary::of_granular(view.scene, motion.simulation, view.world),
        (None, None) => unreachable!("a run evaluates something before it ends"),
    };
    summary.quantities = view.row.iter().filter(|entry| entry.column.physical).map(quantity).collect();
    let Some(motion) = &view.motion else { return summary };
    (summary.time, summary.steps) = (motion.state().time, motion.state().steps);
    if view.scene.contact.model != ContactModel::None {
        summary.contact = Some(contacts(view.world, view.scene, motion));
    }
    if let Some(parts) = summary.viscosity.as_mut().filter(|_| view.scene.changing_shear().is_none()) {
        parts.mean = view.history.mean().copied();
        parts.too_short = viscosity_too_short(view.history.points()).filter(|_| parts.mean.is_none());
    }
    summary
}

/// A quantity as it is now.
fn quantity(SeriesEntry { column, number }: &SeriesEntry) -> (String, QuantitySummary) {
    (column.name.clone(), QuantitySummary::new(&column.unit, &column.meaning, number.value()))
}

/// Bodies of a dry run that are written to the table at once.
const AT_ONCE: usize = 100_000;

/// Writes the table of all bodies if the summary lists only some, and gives its name; collective.
///
/// # Errors
/// It cannot be written.
pub fn table_of_bodies<const D: usize>(view: &View<D>, summary: &Summary, folder: &Path) -> Result<Option<String>> {
    if summary.other_bodies.is_none() {
        return Ok(None);
    }
    let path = folder.join(BODY_TABLE);
    match (&view.flow, &view.motion) {
        (Some(flow), _) => view.world.on_first_rank(|| write_bodies(&path, D, BodySummary::of_flow(flow.solver.setup(), flow.solution)))?,
        (None, Some(motion)) => {
            let (simulation, count) = (motion.simulation, motion.state().count());
            let part = |first: usize| simulation.whole_part(first..(first + AT_ONCE).min(count));
            let mut bodies = (0..count).step_by(AT_ONCE).flat_map(|first| BodySummary::of_granular(motion.domain(), part(first)));
            let written = if view.world.rank() == 0 { write_bodies(&path, D, &mut bodies) } else { Ok(()) };
            // each part comes from all ranks, whether it can be written or not
            bodies.for_each(drop);
            view.world.agree(written)?;
        }
        (None, None) => {}
    }
    Ok(Some(BODY_TABLE.to_owned()))
}

/// Contacts now, and how well they were kept on the way. Collective.
fn contacts<const D: usize>(world: &World, scene: &Scene, motion: &MotionView<D>) -> ContactSummary {
    let (model, totals, kept) = (scene.contact.model, motion.contact_totals(world), motion.statistics.contacts());
    let (residual, steps_above_tolerance) = kept.friction;
    ContactSummary {
        model: model.word(),
        pairs: kept.pairs,
        active: totals.active,
        smallest_gap: kept.smallest_gap,
        kkt_residual: (!matches!(model, ContactModel::Repulsion { .. })).then_some(kept.kkt_residual),
        total_force: totals.force + 0.0,
        glue: model.gluey().then_some(GlueSummary { stuck: totals.adhesive, gamma: totals.gamma }),
        friction: (scene.contact.friction.coefficient > 0.0).then_some(FrictionSummary {
            residual,
            steps_above_tolerance,
            tolerance: match scene.dry() {
                true => FrictionReport::tolerance_of(scene.contact.tolerance),
                false => FrictionReport::TOLERANCE_IN_FLOW,
            },
        }),
    }
}
