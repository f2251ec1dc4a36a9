//! The bonds of the chains and cells of a scene.

use std::{f64::consts::TAU, ops::Range, rc::Rc};

use nalgebra::{Vector2, Vector3};

use crate::{
    body::{Body, Membrane, biconcave, turns},
    interaction::{Bend, Bonds, Conserved, Hinge, JointedChain, Joints, Measure, Stretch, enclosed},
    scene::{Chain, ChainShape, Joint, Scene},
};

/// What bonds are made of.
#[derive(Default)]
struct Parts {
    stretches: Vec<Stretch>,
    bends: Vec<Bend>,
    hinges: Vec<Hinge>,
    conserved: Vec<Conserved>,
    chains: Vec<Range<usize>>,
}

/// The bonds of the chains and cells of a scene, whose bodies are these, each with its group; none without any.
pub fn bonds<const D: usize>(scene: &Scene, bodies: &[(usize, Body<D>)]) -> Option<Bonds> {
    let mut parts = Parts::default();
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
    let Parts { stretches, bends, hinges, conserved, chains } = parts;
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

impl Parts {
    /// A line or a ring, the outline of a cell included.
    fn add_chain<const D: usize>(&mut self, chain: &Chain, beads: &[(usize, Body<D>)], start: usize) {
        let bead = |number: usize| start + number % chain.beads;
        let radius = |number: usize| beads[number % chain.beads].1.ball.radius;
        let length = |bond: usize| chain.spacing * (radius(bond) + radius(bond + 1));
        let ring = chain.shape.closed();
        let bonds = if ring { chain.beads } else { chain.beads - 1 };
        let stiffness = chain.stretch.unwrap_or(f64::INFINITY);
        self.stretches.extend((0..bonds).map(|bond| Stretch { bodies: [bead(bond), bead(bond + 1)], length: length(bond), stiffness }));
        let turns = if ring { bonds } else { bonds - 1 };
        let angles = angles(chain, length(0), beads);
        let bend = |bond: usize| {
            let bodies = [bead(bond), bead(bond + 1), bead(bond + 2)];
            Bend { bodies, stiffness: chain.bend, angle: angles[(bond + 1) % chain.beads] }
        };
        self.bends.extend((0..turns).map(bend));
        if chain.shape == ChainShape::Cell {
            let value = enclosed(&biconcave(chain.beads, length(0)));
            self.conserved.push(Conserved { bodies: start..start + chain.beads, measure: Measure::EnclosedArea, value });
        }
    }

    /// A cell in space: its edges are springs and hinges; volume and surface stay as they are.
    fn add_membrane(&mut self, chain: &Chain, membrane: &Membrane, start: usize) {
        let place = |corner: usize| membrane.places[corner];
        for edge in membrane.edges() {
            let ([one, two], length) = (edge.ends, (place(edge.ends[0]) - place(edge.ends[1])).norm());
            self.stretches.push(Stretch { bodies: [start + one, start + two], length, stiffness: chain.stretch.unwrap_or(f64::INFINITY) });
            let mut hinge = Hinge { ends: edge.ends, wings: edge.wings, rest: 0.0, stiffness: chain.bend };
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
        ChainShape::Cell => turns(&biconcave(chain.beads, link)),
        ChainShape::Ring if chain.angle == TAU / chain.beads as f64 => vec![chain.angle.copysign(enclosed(&ring(beads))); chain.beads],
        ChainShape::Line | ChainShape::Ring => vec![chain.angle; chain.beads],
    }
}
