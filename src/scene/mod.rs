//! What to simulate: plain data read from a scene file, checked at the door, never changed.
//!
//! It knows no grid, no solver and no dimension in its types: every vector is a `Vec<f64>` whose length was checked.
//! Whether bodies overlap or fit into the box is checked where they are placed, with [`Scene::refuse`].

mod accuracy;
mod affine;
mod check;
mod demand;
mod difference;
mod elsewhere;
mod energy;
mod entry;
mod file;
mod force_laws;
mod groups;
mod key;
mod keys;
mod load;
mod locations;
mod nearest;
mod overrides;
mod plane;
mod protocol;
mod reference;
mod regions;
mod scalar;
mod sections;
mod table;
mod warning;

pub use affine::AffineFlow;
pub use difference::Difference;
pub use force_laws::ForceLaw;
pub use groups::bodies::{BodyGroup, Motion, Placement, Shape};
pub use groups::chains::{Chain, ChainShape, Joint};
pub use groups::clusters::{Cluster, ClusterForm};
pub use groups::region::Region;
pub use groups::sizes::SizeDistribution;
pub use key::Key;
pub use locations::Locations;
pub use nearest::{all_nearest, nearest};
pub use reference::{KeySection, SECTIONS};
pub use sections::{
    AxisSection, Colour, ConstraintMethod, ContactModel, ContactSection, DomainSection, Drive, FlowModel, FlowSection, ForceTexts,
    InteractionSection, LubricationModel, LubricationSection, MOST_WITH_FORCES, MethodSection, Modes, MultiplierSolver, NormalLoad,
    OutputSection, ResolutionSection, Scheme, Spacing, Step, TimeSection, Tolerance, Until,
};

use crate::error::Error;

/// Frames of a run that does not say how far they are apart.
const FRAMES: f64 = 100.0;

/// Everything a scene file says.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The file's name without its ending.
    pub name: String,
    /// One line for people; empty unless given.
    pub title: String,
    /// Seed of every random number of the run.
    pub seed: u64,
    /// Acceleration of bodies and fluid; absent means none.
    pub gravity: Option<Vec<f64>>,
    /// The box.
    pub domain: DomainSection,
    /// The fluid and what drives it.
    pub flow: FlowSection,
    /// Relative error that the answers may have, if the program is to choose the resolution itself.
    pub accuracy: Option<f64>,
    /// How fine the grid and the multipliers are; absent from dry scenes, and from those whose accuracy is yet to choose it.
    pub resolution: Option<ResolutionSection>,
    /// How the equations are solved.
    pub method: MethodSection,
    /// Groups of bodies that are alike, in the order of the file.
    pub bodies: Vec<BodyGroup>,
    /// Forces on bodies that are given by expressions.
    pub interactions: Vec<InteractionSection>,
    /// What happens between bodies that touch.
    pub contact: ContactSection,
    /// What happens between bodies that nearly touch.
    pub lubrication: LubricationSection,
    /// How far bodies go; absent means one instantaneous solve.
    pub time: Option<TimeSection>,
    /// What a run writes besides its summary.
    pub output: OutputSection,
    /// Where each key was written.
    pub locations: Locations,
    /// The file's text with the overrides applied: a scene file that gives this scene again.
    pub text: String,
}

impl Scene {
    /// An empty box of this size, periodic along each axis, that Stokes flow fills: a scene to fill in, and then to [check](Scene::checked).
    pub fn new(name: &str, size: &[f64]) -> Scene {
        Scene {
            name: name.to_owned(),
            title: String::new(),
            seed: 1,
            gravity: None,
            domain: DomainSection { size: size.to_vec(), axes: vec![AxisSection::Periodic; size.len()], load: None },
            flow: FlowSection::default(),
            accuracy: None,
            resolution: None,
            method: MethodSection::default(),
            bodies: Vec::new(),
            interactions: Vec::new(),
            contact: ContactSection::default(),
            lubrication: LubricationSection::default(),
            time: None,
            output: OutputSection::default(),
            locations: Locations::default(),
            text: String::new(),
        }
    }

    /// The dimension of space, 2 or 3.
    pub fn dimension(&self) -> usize {
        self.domain.size.len()
    }

    /// The time at which a run in time ends; 0 for an instantaneous solve.
    pub fn end(&self) -> f64 {
        self.time.as_ref().map_or(0.0, |time| time.end)
    }

    /// The time between frames.
    pub fn frame_interval(&self) -> f64 {
        self.output.every.unwrap_or(self.end() / FRAMES)
    }

    /// Whether frames hold the flow on the grid.
    pub fn stores_fields(&self) -> bool {
        self.flow.model.fluid() && self.output.fields.unwrap_or(self.time.is_some())
    }

    /// Whether frames hold the vorticity.
    pub fn stores_vorticity(&self) -> bool {
        self.stores_fields() && (self.output.vorticity || self.output.colour == Colour::Vorticity)
    }

    /// Whether chains, cells and clusters have tables, where there are any.
    pub fn writes_objects(&self) -> bool {
        self.output.objects != Some(false)
    }

    /// Its title, or else its name.
    pub fn shown_title(&self) -> &str {
        if self.title.is_empty() { &self.name } else { &self.title }
    }

    /// Whether there is no fluid: bodies then have inertia and only touch each other.
    pub fn dry(&self) -> bool {
        self.flow.model == FlowModel::None
    }

    /// Whether surfaces have coefficients of friction of their own.
    pub fn frictions_differ(&self) -> bool {
        self.contact.wall_friction.is_some() || self.bodies.iter().any(|bodies| bodies.friction.is_some())
    }

    /// Whether a scalar around inclusions takes the place of the fluid.
    pub fn scalar(&self) -> bool {
        self.flow.model == FlowModel::Scalar
    }

    /// This scene with the resolution and the tolerance that its accuracy chose.
    pub fn resolved(&self, resolution: ResolutionSection, tolerance: Tolerance) -> Scene {
        let method = MethodSection { tolerance, ..self.method.clone() };
        Scene { resolution: Some(resolution), method, ..self.clone() }
    }

    /// The refusal of a key's value: place, key, value and what would be right.
    ///
    /// `key` is written `bodies[0].radius` or `bodies.0.radius`. The place is the line that holds the key, an
    /// override if one gave it, or the line of the innermost table around a key that nobody wrote.
    pub fn refuse(&self, key: &str, value: impl std::fmt::Display, remedy: &str) -> Error {
        self.locations.refuse(key, value, remedy)
    }
}
