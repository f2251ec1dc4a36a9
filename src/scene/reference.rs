//! All sections of a scene file with their keys: the tables by which files are read, as a reference of them.

use crate::scene::file;
use crate::scene::groups::keys::{BODY_KEYS, CELL_KEYS, CHAIN_KEYS, CLUSTER_KEYS, MOTION_KEYS, SIZES_KEYS};
use crate::scene::key::Key;
use crate::scene::sections::{
    AXIS_KEYS, CONTACT_KEYS, DOMAIN_KEYS, DRIVE_KEYS, FACTOR_OSCILLATION_KEYS, FACTOR_STEP_KEYS, FLOW_KEYS, FRICTION_KEYS,
    INTERACTION_KEYS, LUBRICATION_KEYS, METHOD_KEYS, OSCILLATION_KEYS, OUTPUT_KEYS, RESOLUTION_KEYS, SPACING_KEYS, STEP_KEYS,
    STRESS_STEP_KEYS, TIME_KEYS, UNTIL_KEYS,
};

/// A table of a scene file and the keys that it may have.
#[derive(Debug, Clone, Copy)]
pub struct KeySection {
    /// Its name: that of its table, `top` for the top of the file.
    pub name: &'static str,
    /// How the file writes it.
    pub written: &'static str,
    /// What it is about.
    pub about: &'static str,
    /// Its keys.
    pub keys: &'static [Key],
}

/// All sections, in the order of a scene file.
pub const SECTIONS: [KeySection; 26] = [
    KeySection { name: "top", written: "the top of the file", about: "What stands before the first section.", keys: &file::KEYS },
    KeySection { name: "domain", written: "[domain]", about: "The box and what bounds it.", keys: &DOMAIN_KEYS },
    KeySection {
        name: "domain.y",
        written: "y = { .. } of [domain]",
        about: "An axis that two moving walls bound, or one along which fluid enters and leaves; the same for x and z.",
        keys: &AXIS_KEYS,
    },
    KeySection { name: "flow", written: "[flow]", about: "The fluid and what drives it.", keys: &FLOW_KEYS },
    KeySection { name: "flow.drive", written: "drive = { .. } of [flow]", about: "One drive.", keys: &DRIVE_KEYS },
    KeySection {
        name: "flow.drive.shear_rate",
        written: "shear_rate = { .. } of drive",
        about: "A shear that oscillates.",
        keys: &OSCILLATION_KEYS,
    },
    KeySection {
        name: "flow.drive.shear_rate.0",
        written: "shear_rate = [{ .. }, ..] of drive",
        about: "A step of a shear whose rate jumps.",
        keys: &STEP_KEYS,
    },
    KeySection {
        name: "flow.drive.shear_stress.0",
        written: "shear_stress = [{ .. }, ..] of drive",
        about: "A step of a shear whose stress jumps.",
        keys: &STRESS_STEP_KEYS,
    },
    KeySection {
        name: "flow.drive.factor",
        written: "factor = { .. } of drive",
        about: "A pressure gradient or a body force that oscillates.",
        keys: &FACTOR_OSCILLATION_KEYS,
    },
    KeySection {
        name: "flow.drive.factor.0",
        written: "factor = [{ .. }, ..] of drive",
        about: "A step of a pressure gradient or a body force that jumps.",
        keys: &FACTOR_STEP_KEYS,
    },
    KeySection {
        name: "resolution",
        written: "[resolution]",
        about: "How fine the grid and the multipliers are; absent with accuracy and in dry scenes.",
        keys: &RESOLUTION_KEYS,
    },
    KeySection {
        name: "resolution.spacing",
        written: "spacing = { .. } of [resolution]",
        about: "The edge of a grid cell where it has to be this one.",
        keys: &SPACING_KEYS,
    },
    KeySection { name: "method", written: "[method]", about: "How the equations are solved.", keys: &METHOD_KEYS },
    KeySection { name: "bodies", written: "[[bodies]]", about: "A group of disks or spheres that are alike.", keys: &BODY_KEYS },
    KeySection {
        name: "bodies.sizes",
        written: "sizes = { .. } of [[bodies]]",
        about: "How radii differ: two sizes (ratio, share) or a log-normal distribution (deviation, smallest, largest).",
        keys: &SIZES_KEYS,
    },
    KeySection {
        name: "bodies.motion",
        written: "motion = { .. } of [[bodies]]",
        about: "A prescribed motion: steady (velocity, spin), oscillating (amplitude, rotation, frequency, phase) or along a path.",
        keys: &MOTION_KEYS,
    },
    KeySection { name: "chains", written: "[[chains]]", about: "A group of chains or rings of beads.", keys: &CHAIN_KEYS },
    KeySection { name: "cells", written: "[[cells]]", about: "A group of red cells: membranes of beads.", keys: &CELL_KEYS },
    KeySection { name: "clusters", written: "[[clusters]]", about: "A group of rigid bodies made of balls.", keys: &CLUSTER_KEYS },
    KeySection {
        name: "interactions",
        written: "[[interactions]]",
        about: "A force on bodies that is given by an expression; any number of them act together.",
        keys: &INTERACTION_KEYS,
    },
    KeySection { name: "contact", written: "[contact]", about: "What happens between bodies that touch.", keys: &CONTACT_KEYS },
    KeySection {
        name: "contact.friction",
        written: "friction = { .. } of [contact]",
        about: "Friction at contacts; also of `wall_friction`, and of `friction` in [[bodies]].",
        keys: &FRICTION_KEYS,
    },
    KeySection {
        name: "lubrication",
        written: "[lubrication]",
        about: "Lubrication films between bodies that nearly touch.",
        keys: &LUBRICATION_KEYS,
    },
    KeySection {
        name: "time",
        written: "[time]",
        about: "End and steps of the run; without it, one instantaneous solve.",
        keys: &TIME_KEYS,
    },
    KeySection { name: "time.until", written: "until = { .. } of [time]", about: "What ends the run before its end.", keys: &UNTIL_KEYS },
    KeySection { name: "output", written: "[output]", about: "What the run writes besides its summary.", keys: &OUTPUT_KEYS },
];

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::error::Result;
    use crate::scene::{Locations, Scene};

    const BASE: &str = "domain.size = [8.0, 8.0]\nresolution.cells_per_radius = 4\n";

    /// The text of a scene in which a section can stand.
    fn text(section: &KeySection) -> String {
        let group = match section.name {
            "chains" => "[[chains]]\ncount = 1\nbeads = 4\nradius = 0.4\nstretch = \"rigid\"\n[time]\nend = 1.0",
            "cells" => "[[cells]]\ncount = 1\nbeads = 24\nradius = 0.15\nstretch = \"rigid\"\nbend = 0.1\n[time]\nend = 1.0",
            "clusters" => "[[clusters]]\ncount = 1\nshape = \"rod\"\nbeads = 3\nradius = 0.4",
            "interactions" => {
                "[[interactions]]\npair_force = \"k / r\"\nreach = 1.0\nconstants = { k = 1.0 }\n[[bodies]]\nradius = 0.5\ncount = 2"
            }
            "domain.y" => "domain.y = { lower = [0.0, 0.0], upper = [0.0, 0.0] }\n[[bodies]]\nradius = 0.5\ncount = 2",
            "time.until" => "[[bodies]]\nradius = 0.5\ncount = 2\n[time]\nend = 1.0",
            "flow.drive.shear_rate" => "flow.drive.shear_rate = { amplitude = 0.1, frequency = 1.0 }\n[[bodies]]\nradius = 0.5\ncount = 2",
            "flow.drive.shear_rate.0" => "flow.drive.shear_rate = [{ rate = 1.0 }]\n[[bodies]]\nradius = 0.5\ncount = 2",
            "flow.drive.shear_stress.0" => {
                "flow.drive.shear_stress = [{ stress = 1.0 }]\ntime.end = 1.0\n[[bodies]]\nradius = 0.5\ncount = 2"
            }
            "flow.drive.factor" => {
                "flow.drive = { pressure_gradient = [-1.0, 0.0], factor = { amplitude = 1.0, frequency = 1.0 } }\n[[bodies]]\nradius = 0.5\ncount = 2"
            }
            "flow.drive.factor.0" => {
                "flow.drive = { pressure_gradient = [-1.0, 0.0], factor = [{ value = 1.0 }] }\n[[bodies]]\nradius = 0.5\ncount = 2"
            }
            _ => "[[bodies]]\nradius = 0.5\ncount = 2",
        };
        format!("{BASE}{group}")
    }

    /// The path of a key in overrides.
    fn path(section: &KeySection, key: &str) -> String {
        match (section.name, section.name.split_once('.')) {
            ("top", _) => key.to_owned(),
            ("bodies" | "chains" | "cells" | "clusters" | "interactions", _) => format!("{}.0.{key}", section.name),
            (_, Some(("bodies", table))) => format!("bodies.0.{table}.{key}"),
            (name, _) => format!("{name}.{key}"),
        }
    }

    /// The scene of a section with what a key needs and with more overrides, without its place in a file.
    fn scene(section: &KeySection, key: &Key, more: &[String]) -> Result<Scene> {
        let needs = key.needs.split("; ").filter(|need| !need.is_empty()).map(str::to_owned);
        let overrides: Vec<String> = needs.chain(more.iter().cloned()).collect();
        let mut text = text(section);
        if key.needs.contains("flow.model = \"none\"") {
            // a dry scene has no grid
            text = text.replace("resolution.cells_per_radius = 4\n", "");
        }
        let read = Scene::parse("scene", Path::new("examples"), &text, &overrides)?;
        Ok(Scene { text: String::new(), locations: Locations::default(), ..read })
    }

    fn every_key(of: impl Fn(&KeySection, &Key) -> Option<String>) {
        let failures: Vec<String> = SECTIONS.iter().flat_map(|section| section.keys.iter().filter_map(|key| of(section, key))).collect();
        assert!(failures.is_empty(), "{}", failures.join("\n"));
    }

    #[test]
    fn the_example_of_every_key_is_accepted() {
        every_key(|section, key| {
            let change = format!("{}={}", path(section, key.name), key.example);
            scene(section, key, std::slice::from_ref(&change)).err().map(|error| format!("{change}: {error}"))
        });
    }

    #[test]
    fn the_default_of_every_key_is_what_holds_without_it() {
        let tested = std::cell::Cell::new(0);
        every_key(|section, key| {
            if !key.default_is_a_value() {
                return None;
            }
            tested.set(tested.get() + 1);
            let change = format!("{}={}", path(section, key.name), key.default);
            match (scene(section, key, &[]), scene(section, key, std::slice::from_ref(&change))) {
                (Ok(without), Ok(with)) if without == with => None,
                (without, with) => Some(format!("{change}: {:?}, {:?}", without.map(drop), with.map(drop))),
            }
        });
        assert!(tested.get() > 40, "only {} defaults", tested.get());
    }

    #[test]
    fn every_table_that_a_key_may_hold_is_a_section_and_knows_no_other_keys() {
        every_key(|section, key| {
            let table = key.kind.contains("table");
            let name = if section.name == "top" { key.name.to_owned() } else { format!("{}.{}", section.name, key.name) };
            // the three axes are alike
            let name = name.replace("domain.x", "domain.y").replace("domain.z", "domain.y");
            // and so is friction
            let name = name.replace("contact.wall_friction", "contact.friction").replace("bodies.friction", "contact.friction");
            let is_section = |name: &str| SECTIONS.iter().any(|section| section.name == name);
            let steps = is_section(&format!("{name}.0"));
            let found = is_section(&name) || steps;
            (table != found || steps && !key.kind.contains("list of tables")).then(|| format!("{name}: {}", key.kind))
        });
        for section in SECTIONS {
            let key = Key::new("stranger", "", "", "");
            let names: Vec<&str> = section.keys.iter().map(|key| key.name).collect();
            let error = scene(&section, &key, &[format!("{}=1", path(&section, "stranger"))]).unwrap_err().to_string();
            assert!(error.ends_with(&format!("known keys: {}", names.join(", "))), "{}: {error}", section.name);
        }
    }
}
