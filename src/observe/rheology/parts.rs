//! The parts that a stress or a viscosity is the sum of: a part is named here, and computed where its [`Stress`](super::stress::Stress) is.

use std::{collections::BTreeMap, iter::Sum};

use serde::{Deserialize, Deserializer, Serialize, Serializer, ser::SerializeMap};

/// What exerts a part of the stress.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The fluid and the stresslets of the resolved flow.
    Hydrodynamic,
    /// Lubrication beyond the resolved flow.
    Lubrication,
    /// Forces at a distance, given torques (half the couple per volume), and between walls given forces along them.
    Interaction,
    /// Bonds of chains and membranes.
    Bonds,
    /// Fluctuations that fluid and bodies with inertia carry along: `-mean of rho v_x v_y`.
    Reynolds,
    /// Contact forces `f` between centres a distance `r n` apart, normal ones where there is friction: `-sum f r n n / V`.
    Contact,
    /// Tangential contact forces `t`: the symmetric part of `-sum r n t / V`.
    Friction,
}

impl Part {
    /// All of them, in the order in which they are listed and added.
    pub const ALL: [Part; 7] =
        [Part::Hydrodynamic, Part::Lubrication, Part::Interaction, Part::Bonds, Part::Reynolds, Part::Contact, Part::Friction];

    /// Its name in files; columns have `viscosity_` before it.
    pub fn name(self) -> &'static str {
        ["hydrodynamic", "lubrication", "interaction", "bonds", "reynolds", "contact", "friction"][self as usize]
    }

    /// What it is of a viscosity, in a sentence.
    pub fn meaning(self) -> &'static str {
        match self {
            Part::Hydrodynamic => "1 plus the part of the resolved stresslets",
            Part::Lubrication => "part of the lubrication films that multipliers do not resolve",
            Part::Interaction => {
                "part of forces at a distance: forces of one's own, given torques (half the couple per volume) and, between walls, given \
                 forces along them (less force times height over the middle)"
            }
            Part::Bonds => "part of the bonds of chains, cells and clusters",
            Part::Reynolds => "part of fluctuations of the momentum, with inertia",
            Part::Contact => "part of contact forces and of repulsion, of normal ones with friction",
            Part::Friction => "part of tangential contact forces, with friction in a fluid",
        }
    }

    /// Its name in sentences and charts.
    pub fn words(self) -> &'static str {
        ["flow", "lubrication", "forces at a distance", "bonds", "inertia", "contacts", "friction"][self as usize]
    }
}

/// For each part what it amounts to, if there is anything that exerts it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parts<T>([Option<T>; Part::ALL.len()]);

impl<T: Copy> Parts<T> {
    /// What each part amounts to.
    pub fn of(amount: impl FnMut(Part) -> Option<T>) -> Parts<T> {
        Parts(Part::ALL.map(amount))
    }

    /// What a part amounts to.
    pub fn get(&self, part: Part) -> Option<T> {
        self.0[part as usize]
    }

    /// The parts that there are.
    pub fn each(&self) -> impl Iterator<Item = (Part, T)> {
        Part::ALL.into_iter().zip(self.0).filter_map(|(part, amount)| Some((part, amount?)))
    }

    /// The same parts, measured otherwise.
    pub fn map<U: Copy>(&self, amount: impl Fn(T) -> U) -> Parts<U> {
        Parts::of(|part| self.get(part).map(&amount))
    }

    /// The sum of all parts.
    pub fn total(&self) -> T
    where
        T: Sum,
    {
        self.each().map(|(_, amount)| amount).sum()
    }
}

impl Parts<f64> {
    /// Parts and their names in sentences.
    pub fn in_words(&self) -> Vec<(&'static str, f64)> {
        self.each().map(|(part, amount)| (part.words(), amount)).collect()
    }
}

impl Serialize for Parts<f64> {
    /// Every part by its name, nothing for those that there are not.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(Part::ALL.len()))?;
        Part::ALL.into_iter().try_for_each(|part| map.serialize_entry(part.name(), &self.get(part)))?;
        map.end()
    }
}

impl<'de> Deserialize<'de> for Parts<f64> {
    fn deserialize<S: Deserializer<'de>>(deserializer: S) -> Result<Parts<f64>, S::Error> {
        let amounts = BTreeMap::<String, Option<f64>>::deserialize(deserializer)?;
        Ok(Parts::of(|part| amounts.get(part.name()).copied().flatten()))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_read_back_as_they_were_written_and_make_up_the_whole() {
        let parts = Parts::of(|part| match part {
            Part::Hydrodynamic => Some(1.5),
            Part::Contact => Some(0.25),
            _ => None,
        });
        let text = serde_json::to_string(&parts).unwrap();
        assert!(text.starts_with("{\"hydrodynamic\":1.5,\"lubrication\":null,"), "{text}");
        assert_eq!(serde_json::from_str::<Parts<f64>>(&text).unwrap(), parts);
        assert_eq!(parts.total(), 1.75);
        assert_eq!(parts.in_words(), [("flow", 1.5), ("contacts", 0.25)]);
    }
}
