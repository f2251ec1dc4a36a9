//! Words of other programs for what a scene says otherwise, or does not say: the answer to a key that is unknown.

/// Words, and the answer to them, with keys of a scene between backticks.
const ANSWERS: [(&[&str], &str); 27] = [
    (&["dt", "timestep", "time_step", "deltat"], "the length of a step is `time.step`, automatic without it"),
    (&["t_end", "tend", "end_time", "tmax", "duration"], "the end of a run is `time.end`"),
    (&["viscosity", "eta", "nu", "dynamic_viscosity"], "the viscosity of the fluid is `flow.viscosity`"),
    (&["rho", "fluid_density", "rho_f"], "the density of the fluid is `flow.density`, that of bodies `bodies.density`"),
    (
        &["friction", "mu", "mu_s", "friction_coefficient"],
        "the coefficient of friction is `contact.friction`, that of a group `bodies.friction`",
    ),
    (&["restitution", "e_n"], "contacts are inelastic (`contact.model`): bodies do not rebound"),
    (
        &["k_n", "kn", "k_t", "stiffness"],
        "contacts are rigid and have no stiffness; a repulsion that has one is `contact.model` = \"repulsion\" with `contact.stiffness`",
    ),
    (&["shear_rate", "shear", "gamma_dot", "rate"], "the shear rate is `flow.drive.shear_rate`"),
    (
        &["extension_rate", "elongation_rate", "extension", "elongation", "extensional", "planar_extension"],
        "there is no planar extension; a shear is `flow.drive.shear_rate`",
    ),
    (&["shear_stress", "stress"], "a shear at a given stress is `flow.drive.shear_stress`"),
    (&["phi", "volume_fraction", "concentration", "fraction"], "the fraction that a group fills is `bodies.fraction`"),
    (&["n", "particles", "nparticles", "spheres", "disks"], "bodies are groups `bodies`, with `bodies.count` or `bodies.fraction`"),
    (
        &["potential", "pair_style", "pair_coeff", "hamaker", "debye", "attraction", "dipole"],
        "a force between two bodies is an expression, `interactions.pair_force`",
    ),
    (&["bidisperse", "polydispersity", "size_ratio"], "bodies of several sizes are `bodies.sizes`"),
    (&["temperature", "kt", "brownian", "peclet"], "there is no Brownian motion"),
    (
        &[
            "ellipsoid",
            "ellipsoids",
            "ellipse",
            "ellipses",
            "aspect_ratio",
            "superquadric",
            "superquadrics",
            "rod",
            "rods",
            "polygon",
            "polygons",
            "clump",
            "clumps",
        ],
        "bodies are disks and spheres; rigid bodies of other shapes are `clusters` of them",
    ),
    (&["fiber", "fibers", "fibre", "fibres", "filament", "filaments", "polymer", "polymers"], "flexible fibres are `chains` of beads"),
    (&["vesicle", "vesicles", "capsule", "capsules", "red_cells", "rbc"], "bodies with a membrane are `cells`"),
    (&["diameter", "diameters", "d"], "the size of a body is its radius, `bodies.radius`, half the diameter"),
    (&["radii"], "the radius of a group is `bodies.radius`; bodies of several sizes are `bodies.sizes`"),
    (&["mass", "masses"], "the mass of a body follows from its density, `bodies.density`"),
    (&["position", "positions", "coordinates", "x0"], "the places of bodies are `bodies.centers`, or a table, `bodies.file`"),
    (&["omega", "angular_velocity"], "the turning rate at the start is `bodies.spin`"),
    (
        &["reynolds", "re"],
        "the Reynolds number follows from `flow.density`, `flow.viscosity`, sizes and velocities, and is a column of series.csv",
    ),
    (&["boundary", "boundaries", "periodic", "bc"], "each axis has its own boundary: `domain.x`, `domain.y`, `domain.z`"),
    (&["box", "lx", "ly", "lz"], "the edges of the box are `domain.size`"),
    (&["dx", "h", "grid", "mesh", "nx", "cells"], "the grid follows from `resolution.cells_per_radius` or `resolution.spacing`"),
];

/// Keys, words that they do not know, and the answer to these.
const ANSWERS_TO_VALUES: [(&str, &[&str], &str); 4] = [
    ("flow.model", &["dry", "granular", "dem", "off"], "did you mean \"none\"?"),
    ("flow.model", &["ns", "navier_stokes", "inertia", "inertial"], "did you mean \"navier-stokes\"?"),
    (
        "contact.model",
        &["hertz", "hertzian", "hookean", "hooke", "linear", "spring", "dashpot", "hertz-mindlin", "soft", "dem"],
        "for a force law take \"repulsion\", or an expression in [[interactions]]",
    ),
    ("contact.model", &["rigid", "hard", "nsc", "contact-dynamics"], "did you mean \"inelastic\"?"),
];

/// What to answer a value of this key that is none of its words.
pub(super) fn answer_to_value(key: &str, word: &str) -> Option<&'static str> {
    let word = word.to_lowercase();
    let found = ANSWERS_TO_VALUES.iter().find(|(of, words, _)| *of == key && words.contains(&word.as_str()));
    found.map(|(_, _, answer)| *answer)
}

/// What to answer a key of this name, which the table at this path does not have.
pub(super) fn answer(name: &str) -> Option<String> {
    let name = name.to_lowercase();
    let found = ANSWERS.iter().find(|(words, _)| words.contains(&name.as_str()));
    found.map(|(_, answer)| answer.replace('`', ""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SECTIONS;

    #[test]
    fn answers_name_keys_that_are_there_and_words_stand_once() {
        let key = |path: &str| match path.rsplit_once('.') {
            Some((section, name)) => SECTIONS.iter().any(|known| known.name == section && known.keys.iter().any(|key| key.name == name)),
            None => SECTIONS.iter().any(|known| known.name == path),
        };
        for (_, answer) in &ANSWERS {
            let named: Vec<&str> = answer.split('`').skip(1).step_by(2).collect();
            assert!(named.iter().all(|path| key(path)), "{answer}");
        }
        for (path, words, _) in &ANSWERS_TO_VALUES {
            assert!(key(path) && !words.is_empty(), "{path}");
        }
        let words: Vec<&str> = ANSWERS.iter().flat_map(|(words, _)| words.iter().copied()).collect();
        assert!((1..words.len()).all(|place| !words[..place].contains(&words[place])));
    }
}
