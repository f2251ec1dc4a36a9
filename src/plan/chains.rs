//! The bonds of the chains and cells of a scene.

use std::{f64::consts::TAU, ops::Range, rc::Rc};

use nalgebra::{Vector2, Vector3};

use crate::{
    body::{Body, Membrane},
    interaction::{Bend, Bonds, Conserved, Hinge, JointedChain, Joints, Measure, Stretch, enclosed},
    scene::{Chain, ChainShape, Joint, Scene},
};

/// What bonds are made of.
#[derive(Default)]
struct BondedParts {
    stretches: Vec<Stretch>,
    bends: Vec<Bend>,
    hinges: Vec<Hinge>,
    conserved: Vec<Conserved>,
    chains: Vec<Range<usize>>,
}

/// The bonds of the chains and cells of a scene, whose bodies are these, each with its group; none without any.
pub fn bonds<const D: usize>(scene: &Scene, bodies: &[(usize, Body<D>)]) -> Option<Bonds> {
    let mut parts = BondedParts::default();
    for Beads { chain, first, beads: group } in chained(scene, bodies) {
        for (number, beads) in group.chunks(chain.beads).enumerate() {
            let start = first + number * chain.beads;
            // beads of a cell are alike
            let link = || 2.0 * beads[0].1.ball.radius * chain.spacing;
            let membrane = if D == 3 && chain.shape == ChainShape::Cell { Membrane::biconcave(chain.beads, link()) } else { None };
            parts.chains.push(start..start + chain.beads);
            match &membrane {
                Some(membrane) => parts.add_membrane(chain, membrane, start),
                None => parts.add_chain(chain, beads, start),
            }
        }
    }
    let BondedParts { stretches, bends, hinges, conserved, chains } = parts;
    (!stretches.is_empty()).then(|| Bonds {
        stretches: Rc::new(stretches),
        bends: Rc::new(bends),
        hinges: Rc::new(hinges),
        conserved: Rc::new(conserved),
        chains: Rc::new(chains),
    })
}

/// The joints of the chains of a scene whose beads turn with them; none without any.
pub fn joints<const D: usize>(scene: &Scene, bodies: &[(usize, Body<D>)]) -> Option<Joints> {
    let fixed = chained(scene, bodies).into_iter().filter(|group| group.chain.joints == Joint::Fixed);
    let of_group = |group: Beads<D>| {
        let (beads, ring) = (group.chain.beads, group.chain.shape.closed());
        (group.first..group.first + group.beads.len()).step_by(beads).map(move |start| JointedChain { beads: start..start + beads, ring })
    };
    let chains: Vec<JointedChain> = fixed.flat_map(of_group).collect();
    (!chains.is_empty()).then(|| Joints { chains: Rc::new(chains) })
}

/// The beads of all chains of a group.
struct Beads<'a, const D: usize> {
    chain: &'a Chain,
    /// The number of the first.
    first: usize,
    beads: &'a [(usize, Body<D>)],
}

/// The groups of chains and cells of a scene, whose bodies are these, each with its group.
fn chained<'a, const D: usize>(scene: &'a Scene, bodies: &'a [(usize, Body<D>)]) -> Vec<Beads<'a, D>> {
    let (mut found, mut first) = (Vec::new(), 0);
    for beads in bodies.chunk_by(|one, next| one.0 == next.0) {
        found.extend(scene.bodies[beads[0].0].chain.as_ref().map(|chain| Beads { chain, first, beads }));
        first += beads.len();
    }
    found
}

impl BondedParts {
    /// A line or a ring, the outline of a cell included.
    fn add_chain<const D: usize>(&mut self, chain: &Chain, beads: &[(usize, Body<D>)], start: usize) {
        let bead = |number: usize| start + number % chain.beads;
        let radius = |number: usize| beads[number % chain.beads].1.ball.radius;
        let length = |bond: usize| chain.spacing * (radius(bond) + radius(bond + 1));
        let ring = chain.shape.closed();
        let bonds = if ring { chain.beads } else { chain.beads - 1 };
        let stiffness = |bond: usize| chain.stiffnesses(length(bond), D).0;
        self.stretches.extend((0..bonds).map(|bond| Stretch {
            bodies: [bead(bond), bead(bond + 1)],
            length: length(bond),
            stiffness: stiffness(bond),
        }));
        let (_, bending) = chain.stiffnesses(length(0), D);
        let turns = if ring { bonds } else { bonds - 1 };
        let angles = angles(chain, length(0), beads);
        let bend = |bond: usize| {
            let bodies = [bead(bond), bead(bond + 1), bead(bond + 2)];
            Bend { bodies, stiffness: bending, angle: angles[(bond + 1) % chain.beads] }
        };
        self.bends.extend((0..turns).map(bend));
        if chain.shape == ChainShape::Cell {
            let value = enclosed(&chain.outline.places(chain.beads, length(0)));
            self.conserved.push(Conserved { bodies: start..start + chain.beads, measure: Measure::EnclosedArea, value });
        }
    }

    /// A cell in space: its edges are springs and hinges; volume and surface stay as they are.
    fn add_membrane(&mut self, chain: &Chain, membrane: &Membrane, start: usize) {
        let (stiffness, bending) = chain.stiffnesses(0.0, 3);
        let place = |corner: usize| membrane.places[corner];
        for edge in membrane.edges() {
            let ([one, two], length) = (edge.ends, (place(edge.ends[0]) - place(edge.ends[1])).norm());
            self.stretches.push(Stretch { bodies: [start + one, start + two], length, stiffness });
            let mut hinge = Hinge { ends: edge.ends, wings: edge.wings, rest: 0.0, stiffness: bending };
            hinge.rest = hinge.angle(&place);
            let moved = |corners: [usize; 2]| corners.map(|corner| start + corner);
            self.hinges.push(Hinge { ends: moved(hinge.ends), wings: moved(hinge.wings), ..hinge });
        }
        let triangles = Rc::new(membrane.triangles.clone());
        for measure in [Measure::Volume(Rc::clone(&triangles)), Measure::Surface(triangles)] {
            let mut conserved = Conserved { bodies: 0..chain.beads, measure, value: 0.0 };
            conserved.value = conserved.measured::<3>(&|corner: usize| -> Vector3<f64> { place(corner) });
            self.conserved.push(Conserved { bodies: start..start + chain.beads, ..conserved });
        }
    }
}

/// The turns of a chain of these beads at rest: a ring that is given clockwise turns that way.
fn angles<const D: usize>(chain: &Chain, link: f64, beads: &[(usize, Body<D>)]) -> Vec<f64> {
    let ring = |beads: &[(usize, Body<D>)]| -> Vec<Vector2<f64>> {
        beads.iter().map(|(_, bead)| bead.ball.center.fixed_rows::<2>(0).into_owned()).collect()
    };
    match chain.shape {
        ChainShape::Cell => chain.outline.turns(chain.beads, link),
        ChainShape::Ring if chain.angle == TAU / chain.beads as f64 => vec![chain.angle.copysign(enclosed(&ring(beads))); chain.beads],
        ChainShape::Line | ChainShape::Ring => vec![chain.angle; chain.beads],
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use nalgebra::{SVector, Vector2};

    use super::*;
    use crate::{
        interaction::{Spring, Ties},
        parallel::Peers,
        setup::placement,
    };

    /// The bonds of a cell in the middle of a box, and the places of its beads.
    fn cell<const D: usize>(keys: &str) -> (Bonds, Vec<SVector<f64, D>>) {
        let all = |number: &str| vec![number; D].join(", ");
        let text = format!(
            "domain.size = [{}]\ntime.end = 1.0\n[resolution]\ncells_per_radius = 2\n[[cells]]\ncenters = [[{}]]\n{keys}",
            all("24.0"),
            all("12.0")
        );
        let scene = Scene::parse("cell", Path::new(""), &text, &[]).unwrap();
        let bodies = placement::bodies::<D>(Peers::Alone, &scene, &placement::domain(&scene)).unwrap();
        (bonds(&scene, &bodies).unwrap(), bodies.iter().map(|(_, body)| body.ball.center).collect())
    }

    fn energy<const D: usize>(bonds: &Bonds, places: &[SVector<f64, D>]) -> f64 {
        bonds.springs(&(0..usize::MAX), &|body: usize| places[body]).iter().map(Spring::energy).sum()
    }

    /// `bend/2` times the integral of the square of what the curvature differs from that of the circle by, along an ellipse with these half axes.
    fn bent(bend: f64, [a, b]: [f64; 2], perimeter: f64) -> f64 {
        let (count, natural) = (20_000, TAU / perimeter);
        let part = |point: usize| {
            let (sin, cos) = f64::sin_cos(TAU * point as f64 / count as f64);
            let speed = (a * sin).hypot(b * cos);
            0.5 * bend * (a * b / speed.powi(3) - natural).powi(2) * speed * TAU / count as f64
        };
        (0..count).map(part).sum()
    }

    #[test]
    fn bend_and_stretch_of_a_cell_are_moduli_of_its_membrane_however_many_beads_it_has() {
        let error = |beads: usize| {
            let keys = format!("rest = \"circle\"\nreduced_area = 0.8\ndiameter = 4.0\nbeads = {beads}\nstretch = 7.0\nbend = 0.3\n");
            let (bonds, places) = cell::<2>(&keys);
            let middle = places.iter().sum::<Vector2<f64>>() / beads as f64;
            let half = |axis: usize| places.iter().map(|place| (place - middle)[axis].abs()).fold(0.0, f64::max);
            let perimeter: f64 = (0..beads).map(|bead| (places[(bead + 1) % beads] - places[bead]).norm()).sum();
            let at_rest = energy(&bonds, &places);
            let wider: Vec<Vector2<f64>> = places.iter().map(|place| place * 1.01).collect();
            assert!((half(0) - 2.0).abs() < 1e-3, "{}", half(0));
            // the area is kept by a row without energy
            let drawn = (energy(&bonds, &wider) - at_rest) / (0.5 * 7.0 * 1e-4 * perimeter) - 1.0;
            assert!(drawn.abs() < 1e-6, "{drawn}");
            at_rest / bent(0.3, [half(0), half(1)], perimeter) - 1.0
        };
        let errors = [48, 96, 192].map(error);
        assert!(errors[2].abs() < 3e-3 && errors[1].abs() < 0.4 * errors[0].abs(), "{errors:?}");
    }

    /// A membrane of equal triangles whose area grows by a part `2 e` stores `2 K e^2` over its area, where `K = 3/4 stretch`; the triangles of a cell are not all
    /// alike, which makes it stiffer by 9 %: half the sum of the squares of all edges over the surface is that much more than in equal triangles.
    #[test]
    fn the_springs_of_a_membrane_in_space_have_its_modulus() {
        for (beads, expected) in [(162, 1.0897), (642, 1.0863)] {
            let (bonds, places) = cell::<3>(&format!("diameter = 8.0\nbeads = {beads}\nstretch = 7.0\nbend = 0.3\n"));
            let wider: Vec<Vector3<f64>> = places.iter().map(|place| place * 1.01).collect();
            let surface = bonds.conserved.iter().find(|conserved| matches!(conserved.measure, Measure::Surface(_))).unwrap().value;
            let over = (energy(&bonds, &wider) - energy(&bonds, &places)) / (2.0 * 0.75 * 7.0 * 1e-4 * surface);
            assert!((over - expected).abs() < 2e-4, "{beads}: {over}");
        }
    }
}
