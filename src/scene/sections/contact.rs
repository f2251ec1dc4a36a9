//! What happens between bodies of a scene that are close.

use crate::error::Result;
use crate::scene::entry::Entry;
use crate::scene::key::Key;
use crate::scene::table::Table;
use crate::{contact::FRICTION_TOLERANCE, friction::FrictionLaw};

/// Keys of `[contact]`.
pub(in crate::scene) const KEYS: [Key; 8] = [
    Key::new(
        "model",
        "\"none\", \"inelastic\", \"repulsion\" or \"gluey\"",
        "\"inelastic\"",
        "The law of contact. Inelastic: nothing overlaps, \
        nothing rebounds, friction as asked for. Repulsion: a smooth force before touch. Gluey: sticky contact, what was pressed together \
        sticks until it was pulled apart as much.",
    )
    .default("\"none\"")
    .needs("time.end = 1.0"),
    Key::new(
        "friction",
        "number or table",
        "0.5",
        "Coefficient of Coulomb friction of all surfaces for which no other is given, the largest tangential force of a contact over the normal force, or \
        { coefficient = 0.5, rolling = 0.1, twisting = 0.05, critical_load = 1.0 }. Of surfaces that differ the smaller numbers count.",
    )
    .unit("ratio")
    .default("0")
    .range("at least 0")
    .needs("time.end = 1.0; contact.model = \"inelastic\""),
    Key::new("wall_friction", "number or table", "0.3", "Friction of walls, as `contact.friction`; of a contact the smaller numbers of its two surfaces count.")
        .unit("ratio")
        .default("that of `contact.friction`")
        .range("at least 0")
        .needs("time.end = 1.0; contact.model = \"inelastic\"; contact.friction = 0.5"),
    Key::new("roughness", "number", "1e-2", "Gap at which bodies in a fluid touch, over the mean of their radii. Walls are smooth: half of it counts there.")
        .unit("radii")
        .default("0; with friction `lubrication.roughness`")
        .range("at least 0, at most 0.1")
        .needs("time.end = 1.0; contact.model = \"inelastic\""),
    Key::new(
        "tolerance",
        "number",
        "1e-3",
        "Residual to which the forces of dry bodies with friction are found, the natural map of the exact law over the largest velocity that contacts would have without \
        forces. Nothing overlaps whatever it is.",
    )
    .unit("ratio")
    .default("1e-9")
    .range("at least 1e-12, at most 0.1")
    .needs("flow.model = \"none\"; bodies.0.density = 1.0; time.end = 1.0; contact.model = \"inelastic\"; contact.friction = 0.5"),
    Key::new(
        "stiffness",
        "number",
        "50",
        "Force of the repulsion at touch, over the largest force that drives a body (dry: over the energy of \
        the hardest impact per radius).",
    )
    .unit("ratio")
    .default("100")
    .range("above 0")
    .needs("time.end = 1.0; contact.model = \"repulsion\""),
    Key::new("range", "number", "0.05", "Largest gap at which bodies repel each other.")
        .unit("radii of the smaller")
        .default("0.1")
        .range("above 0")
        .needs("time.end = 1.0; contact.model = \"repulsion\""),
    Key::new("gamma_min", "number", "-0.5", "Lower bound of the memory of a contact.")
        .unit("impulse over viscosity; dry: velocity")
        .default("no bound")
        .range("at most 0")
        .needs("time.end = 1.0; contact.model = \"gluey\""),
];

/// Keys of `contact.friction`.
pub(in crate::scene) const FRICTION_KEYS: [Key; 5] = [
    Key::new("coefficient", "number", "0.5", "Largest tangential force of a contact over its normal force.")
        .unit("ratio")
        .default("required")
        .range("at least 0")
        .needs(INELASTIC),
    Key::new(
        "rolling",
        "number",
        "0.1",
        "Largest couple of a contact against rolling, over the normal force times the reduced radius (at a wall the radius of the body): a ball \
        rests on slopes up to this tangent.",
    )
    .unit("ratio")
    .default("0")
    .range("at least 0")
    .needs(RUBBING),
    Key::new("twisting", "number", "0.05", "The same of the couple against spin about the normal, in three dimensions.")
        .unit("ratio")
        .default("0")
        .range("at least 0")
        .needs(TWISTING),
    Key::new("critical_load", "number", "1.0", "Normal force up to which a contact does not rub: of greater ones the excess counts.")
        .unit("force")
        .default("0")
        .range("at least 0")
        .needs(RUBBING),
    Key::new(
        "law",
        "\"exact\" or \"convex\"",
        "\"convex\"",
        "Exact: Coulomb's law. Convex: the approximation of many programs of contact dynamics, in which a contact that slips opens by its slip times the \
        coefficient, for comparison (dry or by Euler's rule); its error is of first order in the step. Of two surfaces that differ the convex one counts.",
    )
    .default("\"exact\"")
    .needs(BY_EULER),
];

const INELASTIC: &str = "time.end = 1.0; contact.model = \"inelastic\"";
const RUBBING: &str = "time.end = 1.0; contact.model = \"inelastic\"; contact.friction.coefficient = 0.5";
const BY_EULER: &str = "time.end = 1.0; time.scheme = \"euler\"; contact.model = \"inelastic\"; contact.friction.coefficient = 0.5";
const TWISTING: &str = "time.end = 1.0; contact.model = \"inelastic\"; contact.friction.coefficient = 0.5; domain.size = [8.0, 8.0, 8.0]";

/// What happens between bodies that touch.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSection {
    /// The law of contact.
    pub model: ContactModel,
    /// Friction of all surfaces for which no other is given; of coefficient 0 without friction.
    pub friction: FrictionLaw,
    /// Friction of walls, if it is another.
    pub wall_friction: Option<FrictionLaw>,
    /// Gap at which bodies in a fluid touch, over the mean of their radii, if it is given.
    pub roughness: Option<f64>,
    /// Residual to which the forces of dry bodies with friction are found.
    pub tolerance: f64,
}

impl Default for ContactSection {
    fn default() -> Self {
        let (model, friction) = (ContactModel::None, FrictionLaw::default());
        ContactSection { model, friction, wall_friction: None, roughness: None, tolerance: FRICTION_TOLERANCE }
    }
}

/// The law of contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ContactModel {
    /// Bodies do not notice contact.
    #[default]
    None,
    /// Bodies do not overlap at the end of a step and do not bounce.
    Inelastic,
    /// Bodies push each other apart before they touch, and bounce without loss where nothing else takes their energy.
    Repulsion {
        /// Force at touch, over the largest force that drives a body (a dry one: over the hardest impact's energy per radius).
        stiffness: f64,
        /// Largest gap at which they push, in radii of the smaller one.
        range: f64,
    },
    /// As inelastic, but what was pressed together sticks until it was pulled apart as much: lubrication as viscosity vanishes.
    Gluey {
        /// Least memory of a contact, not positive; none if contacts remember everything. In a dry run a velocity (impulse over the
        /// reduced mass), in a fluid an impulse over the viscosity.
        gamma_min: Option<f64>,
    },
}

/// Keys that only one law of contact has.
const OF_ONE_LAW: [(&str, &str); 7] = [
    ("friction", "inelastic"),
    ("tolerance", "inelastic"),
    ("wall_friction", "inelastic"),
    ("roughness", "inelastic"),
    ("stiffness", "repulsion"),
    ("range", "repulsion"),
    ("gamma_min", "gluey"),
];

/// Largest roughness, in radii.
const LARGEST_ROUGHNESS: f64 = 0.1;

/// Stiffness and range of a repulsion that says nothing of them.
const REPULSION: [f64; 2] = [100.0, 0.1];

impl ContactSection {
    pub(in crate::scene) fn read(root: &Table) -> Result<Self> {
        let table = root.section("contact", &KEYS)?;
        let positive = |name: &str, default: f64| table.get(name).map_or(Ok(default), |entry| entry.positive());
        let [stiffness, range] = REPULSION;
        let repulsion = ContactModel::Repulsion { stiffness: positive("stiffness", stiffness)?, range: positive("range", range)? };
        let gamma_min = table.get("gamma_min").map(|entry| not_positive(&entry)).transpose()?;
        let models = [
            ("none", ContactModel::None),
            ("inelastic", ContactModel::Inelastic),
            ("repulsion", repulsion),
            ("gluey", ContactModel::Gluey { gamma_min }),
        ];
        let model = table.get("model").map_or(Ok(ContactSection::default().model), |entry| entry.choice(&models, &[]))?;
        let friction = table.get("friction").map_or(Ok(FrictionLaw::default()), |entry| friction(&entry))?;
        for (key, law) in OF_ONE_LAW.into_iter().filter(|(_, law)| *law != model.word()) {
            // no friction is none by any law
            if let Some(entry) = table.get(key).filter(|_| key != "friction" || friction.coefficient > 0.0) {
                return Err(entry.refuse(&format!("only contact.model = {law:?} has it; set contact.model = {law:?}, or remove it")));
            }
        }
        let roughness = table.get("roughness").map(|entry| roughness(&entry)).transpose()?;
        let wall_friction = table.get("wall_friction").map(|entry| self::friction(&entry)).transpose()?;
        let tolerance = table.get("tolerance").map_or(Ok(FRICTION_TOLERANCE), |entry| friction_tolerance(&entry))?;
        Ok(ContactSection { model, friction, wall_friction, roughness, tolerance })
    }
}

impl ContactModel {
    /// Whether contacts stick.
    pub fn gluey(&self) -> bool {
        matches!(self, ContactModel::Gluey { .. })
    }

    /// The word for it in a scene.
    pub fn word(&self) -> &'static str {
        match self {
            ContactModel::None => "none",
            ContactModel::Inelastic => "inelastic",
            ContactModel::Repulsion { .. } => "repulsion",
            ContactModel::Gluey { .. } => "gluey",
        }
    }
}

/// Friction of surfaces: a coefficient, or a table.
pub(in crate::scene) fn friction(entry: &Entry) -> Result<FrictionLaw> {
    if !entry.value.is_inline_table() {
        return Ok(FrictionLaw::plain(entry.not_negative()?));
    }
    let table = Table::of(entry, &FRICTION_KEYS)?;
    let coefficient = table.require("coefficient", "0.5")?.not_negative()?;
    let other = |key: &str| {
        let Some(entry) = table.get(key) else { return Ok(0.0) };
        let number = entry.not_negative()?;
        entry.expect(number, number == 0.0 || coefficient > 0.0, "surfaces of coefficient 0 do not rub; give coefficient, or remove it")
    };
    let law = FrictionLaw {
        coefficient,
        rolling: other("rolling")?,
        twisting: other("twisting")?,
        critical_load: other("critical_load")?,
        convex: table.get("law").map_or(Ok(false), |entry| entry.choice(&[("exact", false), ("convex", true)], &[]))?,
    };
    match ["rolling", "twisting", "critical_load"].into_iter().filter_map(|key| table.get(key)).next() {
        Some(entry) if law.convex => {
            Err(entry.refuse("the convex law is there for a coefficient alone; remove it, or take law = \"exact\""))
        }
        _ => Ok(law),
    }
}

fn friction_tolerance(entry: &Entry) -> Result<f64> {
    let number = entry.number()?;
    entry.expect(number, (1e-12..=0.1).contains(&number), "must be at least 1e-12 and at most 0.1")
}

fn roughness(entry: &Entry) -> Result<f64> {
    let number = entry.not_negative()?;
    entry.expect(number, number <= LARGEST_ROUGHNESS, "must be at most 0.1: bodies touch far apart")
}

fn not_positive(entry: &Entry) -> Result<f64> {
    let number = entry.number()?;
    entry.expect(number, number <= 0.0, "must not be positive")
}
