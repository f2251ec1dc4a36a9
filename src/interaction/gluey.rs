//! Gluey contacts: what is left of a film of fluid between surfaces when its viscosity vanishes.
//!
//! A film between surfaces at a gap `q` resists with `-e q'/q`, so that `q' + e ln q` changes by the other forces only. As `e`
//! goes to zero, `e ln q` becomes a memory `gamma` (Maury, ESAIM Proc. 18 (2007) 133; Lefebvre, M2AN 43 (2009) 53):
//!
//! ```text
//! q' + gamma = q'(0) + (impulse of all forces besides the contact's)      q >= 0   gamma <= 0   q gamma = 0
//! ```
//!
//! A contact that was pressed together holds on until it was pulled apart as much. A step conserves the sum exactly: its contact
//! forces are those of a projection in which a contact may pull, but no more than takes its memory back to zero. A rough
//! surface ends the film at some gap: `gamma` then falls no lower than a given least value.

use std::collections::HashMap;

use super::{Arrangement, ContactLaw, ContactMemory, Interaction, Touch};
use crate::contact::{AdhesiveContact, Contact, ContactForce};

/// Changes of memory below this part of the largest are rounding.
const SMALLEST_CHANGE: f64 = 1e-12;

/// Gluey contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gluey {
    /// The memory of a contact does not fall below this, which is not positive.
    pub least: f64,
}

impl<const D: usize> Interaction<D> for Gluey {
    fn name(&self) -> &'static str {
        "contact"
    }

    fn describe(&self) -> String {
        let least = if self.least.is_finite() { format!("down to {}", self.least) } else { "without limit".into() };
        format!("sticky (gluey), one quadratic program a step, split into islands, and a memory for each contact that sticks, {least}")
    }

    fn contact(&self) -> ContactLaw<'_, D> {
        ContactLaw { memory: Some(self), ..Touch::Hard.into() }
    }
}

impl<const D: usize> ContactMemory<D> for Gluey {
    fn lower_bounds(&self, arrangement: &Arrangement<D>, memory: &[AdhesiveContact<D>], step: f64) -> Vec<ContactForce<D>> {
        let bound = |adhesive: &AdhesiveContact<D>| {
            let contact = Contact::again(arrangement.domain, arrangement.balls, adhesive.identity());
            ContactForce::normal(contact, adhesive.gamma * arrangement.impulse_unit(&contact) / step)
        };
        let mut bounds: Vec<_> = memory.iter().map(bound).collect();
        bounds.sort_unstable_by_key(|bound| bound.contact.identity());
        bounds
    }

    fn remember(
        &self,
        arrangement: &Arrangement<D>,
        memory: &[AdhesiveContact<D>],
        forces: &[ContactForce<D>],
        step: f64,
    ) -> Vec<AdhesiveContact<D>> {
        let before: HashMap<_, _> = memory.iter().map(|adhesive| (adhesive.identity(), adhesive.gamma)).collect();
        let change = |force: &ContactForce<D>| -step * force.force / arrangement.impulse_unit(&force.contact);
        let all = forces.iter().map(change).chain(before.values().copied());
        let rounding = SMALLEST_CHANGE * all.fold(0.0, |largest: f64, part| largest.max(part.abs()));
        let after = |force: &ContactForce<D>| {
            let (body, partner, image) = force.contact.identity();
            let gamma = before.get(&(body, partner, image)).copied().unwrap_or(0.0) + change(force);
            (gamma < -rounding).then_some(AdhesiveContact { body, partner, image, gamma: gamma.max(self.least) })
        };
        forces.iter().filter_map(after).collect()
    }
}
