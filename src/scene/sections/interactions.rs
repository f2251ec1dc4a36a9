//! Forces on bodies that a scene gives by expressions.

use std::collections::BTreeMap;

use crate::error::Result;
use crate::interaction::{BodyForceLaw, Expression, PairForceLaw};
use crate::scene::entry::Entry;
use crate::scene::key::Key;
use crate::scene::table::Table;

/// Keys of `[[interactions]]`.
pub(in crate::scene) const KEYS: [Key; 6] = [
    Key::new("name", "text", "\"dipoles\"", "What plans and messages call it.").default(NAME_IN_QUOTES),
    Key::new(
        "pair_force",
        "text",
        "\"-12 * k * (a + b) / r^4\"",
        "Force between two bodies along the line of their centres, positive if it pushes them apart: an expression in r (distance of the centres), gap, a and b \
        (the smaller and the larger radius) and constants. It does not act between bodies and walls.",
    )
    .unit("force; 2D: force/length")
    .default(ONE),
    Key::new("reach", "number", "2.0", "Largest gap at which the pair force acts; beyond it the force is zero, whatever the expression gives there.")
        .unit("length")
        .default("required with `pair_force`")
        .range("above 0"),
    Key::new(
        "body_force",
        "list of texts",
        "[\"0\", \"-k * radius^2 * sin(2 * pi * time)\"]",
        "Force on each free body: an expression an axis, in x, y, (3D: z), the place of its centre in the box, radius, time and constants.",
    )
    .unit("force; 2D: force/length")
    .default(ONE),
    Key::new("torque", "text; 3D: list of 3 texts", "\"k * cos(time)\"", "Torque on each free body, counterclockwise positive, in the variables of `body_force`.")
        .unit("torque; 2D: torque/length"),
    Key::new("constants", "names with numbers", "{ k = 3.0 }", "Constants of its expressions: words of letters, digits and underscores."),
];

const ONE: &str = "one of `pair_force`, `body_force` and `torque` is required";

/// The name of one that has no other.
const NAME: &str = "custom force";
const NAME_IN_QUOTES: &str = "\"custom force\"";

/// Most characters of a name.
const LONGEST_NAME: usize = 40;

/// A force that a scene gives by expressions.
#[derive(Debug, Clone, PartialEq)]
pub struct InteractionSection {
    /// Its name.
    pub name: String,
    /// The texts of its expressions.
    pub force: ForceTexts,
    /// What their constants are.
    pub constants: BTreeMap<String, f64>,
}

/// The expressions of a force, as texts; whether they can be read is checked with the scene.
#[derive(Debug, Clone, PartialEq)]
pub enum ForceTexts {
    /// Along the line of centres of two bodies, in [`PairForceLaw::VARIABLES`].
    Pair {
        /// The force, positive if it pushes them apart.
        force: String,
        /// Largest gap at which it acts.
        reach: f64,
    },
    /// On single bodies, in [`BodyForceLaw::variables`].
    Body {
        /// The force, a text an axis.
        force: Vec<String>,
        /// The torque, if there is one: a text in 2D, three texts in 3D.
        torque: Vec<String>,
    },
}

impl InteractionSection {
    pub(in crate::scene) fn read_all(root: &Table, dimension: usize) -> Result<Vec<Self>> {
        let Some(entry) = root.get("interactions") else { return Ok(Vec::new()) };
        entry.list()?.iter().map(|entry| Self::read(&Table::of(entry, &KEYS)?, dimension)).collect()
    }

    fn read(table: &Table, dimension: usize) -> Result<Self> {
        let name = table.get("name").map_or(Ok(NAME.to_owned()), |entry| name(&entry))?;
        let force = match (table.get("body_force"), table.get("torque")) {
            (None, Some(torque)) if table.get("pair_force").is_none() => {
                ForceTexts::Body { force: vec!["0".to_owned(); dimension], torque: torque_texts(&torque, dimension)? }
            }
            (_, torque) => match table.exactly_one(&["pair_force", "body_force"], "pair_force = \"-3 / r^4\"")? {
                ("pair_force", entry) => {
                    torque.map_or(Ok(()), |torque| Err(torque.refuse("acts on single bodies; remove it or pair_force")))?;
                    ForceTexts::Pair { force: text(&entry)?, reach: table.require("reach", "2.0")?.positive()? }
                }
                (_, entry) => {
                    let torque = torque.map_or(Ok(Vec::new()), |torque| torque_texts(&torque, dimension))?;
                    ForceTexts::Body { force: texts(&entry, dimension)?, torque }
                }
            },
        };
        if let (ForceTexts::Body { .. }, Some(reach)) = (&force, table.get("reach")) {
            return Err(reach.refuse("is that of a pair force; remove it"));
        }
        let constants = table.get("constants").map_or(Ok(BTreeMap::new()), |entry| constants(&entry, &force.variables(dimension)))?;
        Ok(InteractionSection { name, force, constants })
    }
}

impl ForceTexts {
    /// The variables of its expressions.
    pub fn variables(&self, dimension: usize) -> Vec<&'static str> {
        match self {
            ForceTexts::Pair { .. } => PairForceLaw::VARIABLES.to_vec(),
            ForceTexts::Body { .. } => BodyForceLaw::variables(dimension),
        }
    }
}

fn name(entry: &Entry) -> Result<String> {
    let name = entry.text()?;
    let right = (1..=LONGEST_NAME).contains(&name.chars().count()) && !name.contains(char::is_control);
    entry.expect(name.to_owned(), right, "must have 1 to 40 characters on one line")
}

/// An expression; a number is one.
fn text(entry: &Entry) -> Result<String> {
    if entry.value.is_integer() || entry.value.is_float() { Ok(entry.number()?.to_string()) } else { Ok(entry.text()?.to_owned()) }
}

fn texts(entry: &Entry, count: usize) -> Result<Vec<String>> {
    let texts = entry.list()?;
    entry.expect((), texts.len() == count, &format!("must be a list of {count} expressions, one for each dimension of domain.size"))?;
    texts.iter().map(text).collect()
}

fn torque_texts(entry: &Entry, dimension: usize) -> Result<Vec<String>> {
    if dimension == 2 { Ok(vec![text(entry)?]) } else { texts(entry, 3) }
}

fn constants(entry: &Entry, variables: &[&str]) -> Result<BTreeMap<String, f64>> {
    let table = entry.value.as_inline_table().ok_or_else(|| entry.mistyped("a table of names with numbers"))?;
    let constant = |(name, value): (&str, _)| {
        let entry = Entry { value, key: format!("{}.{name}", entry.key), locations: entry.locations };
        let remedy = "must be a word of letters, digits and underscores that is no variable and no function; choose another name";
        entry.expect((), Expression::can_name_constant(name, variables), remedy)?;
        Ok((name.to_owned(), entry.number()?))
    };
    table.iter().map(constant).collect()
}
