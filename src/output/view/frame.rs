//! The columns of a frame.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion};
use serde_json::json;

use super::chunk::Chunk;
use crate::{
    body::planes,
    contact::Partner,
    observe::FrameBody,
    output::{
        AXES,
        frames::{FlowLayer, FrameContact, FrameSurroundings, StoredFrame},
    },
};

/// Positions are known to this part of the smallest radius.
const RESOLUTION: f64 = 1e-3;
/// Cells of the flow that a frame keeps at most.
const MOST_CELLS: usize = 1 << 15;
/// Numbers that fill their range in 65535 steps, however wide that is.
const ANY: f64 = f64::INFINITY;

/// A frame with all that is shown of it.
///
/// # Errors
/// What is wrong, when a number is not finite.
pub fn chunk<const D: usize>(frame: &StoredFrame<D>, around: &FrameSurroundings) -> Result<Chunk, String> {
    let mut chunk = Chunk::default();
    chunk.fact("time", json!(frame.time));
    chunk.fact("step", json!(frame.step));
    chunk.fact("offset", json!(frame.offset));
    add_bodies(&mut chunk, &frame.bodies)?;
    if let Some(contacts) = &frame.contacts {
        add_contacts(&mut chunk, contacts)?;
    }
    for (place, name) in ["bond_from", "bond_to", "bond_chain"].into_iter().enumerate() {
        chunk.wholes(name, around.bonds.iter().map(|bond| bond[place] as i64));
    }
    chunk.wholes("face_size", around.faces.iter().map(|face| face.len() as i64));
    chunk.wholes("face_body", around.faces.iter().flatten().map(|body| *body as i64));
    if let Some(flow) = &around.flow {
        add_flow(&mut chunk, &thinned(flow))?;
    }
    Ok(chunk)
}

fn add_bodies<const D: usize>(chunk: &mut Chunk, bodies: &[FrameBody<D>]) -> Result<(), String> {
    let column = |number: &dyn Fn(&FrameBody<D>) -> f64| bodies.iter().map(number).collect::<Vec<f64>>();
    let smallest = bodies.iter().fold(f64::INFINITY, |smallest, body| smallest.min(body.radius));
    chunk.reals("radius", &column(&|body| body.radius), RESOLUTION * smallest)?;
    for (axis, name) in AXES.into_iter().enumerate().take(D) {
        chunk.reals(name, &column(&|body| body.center[axis]), RESOLUTION * smallest)?;
        chunk.reals(&format!("velocity_{name}"), &column(&|body| body.velocity[axis]), ANY)?;
        chunk.reals(&format!("force_{name}"), &column(&|body| body.force[axis]), ANY)?;
    }
    let planes = planes::<D>();
    for (plane, name) in planes.iter().zip(&AXES[3 - planes.len()..]) {
        chunk.reals(&format!("spin_{name}"), &column(&|body| body.spin[*plane]), ANY)?;
    }
    if D == 2 {
        chunk.reals("angle", &column(&|body| body.rotation[(1, 0)].atan2(body.rotation[(0, 0)])), ANY)?;
    } else {
        for (axis, name) in AXES.into_iter().enumerate() {
            chunk.reals(&format!("turn_{name}"), &column(&|body| quaternion(body)[axis]), ANY)?;
        }
    }
    chunk.wholes("touches", bodies.iter().map(|body| body.contacts as i64));
    Ok(())
}

/// The parts along the axes of the unit quaternion of a rotation whose real part is not negative.
fn quaternion<const D: usize>(body: &FrameBody<D>) -> [f64; 3] {
    let matrix = Matrix3::from_fn(|row, column| body.rotation[(row, column)]);
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix));
    let sign = if turn.w < 0.0 { -1.0 } else { 1.0 };
    [sign * turn.i, sign * turn.j, sign * turn.k]
}

fn add_contacts<const D: usize>(chunk: &mut Chunk, contacts: &[FrameContact<D>]) -> Result<(), String> {
    let column = |number: &dyn Fn(&FrameContact<D>) -> f64| contacts.iter().map(number).collect::<Vec<f64>>();
    let partner = |contact: &FrameContact<D>| match contact.partner {
        Partner::Body(other) => other as i64,
        Partner::Wall { axis, upper } => -1 - 2 * axis as i64 - i64::from(upper),
    };
    chunk.wholes("contact_body", contacts.iter().map(|contact| contact.body as i64));
    chunk.wholes("contact_partner", contacts.iter().map(partner));
    for (axis, name) in AXES.into_iter().enumerate().take(D) {
        chunk.reals(&format!("contact_{name}"), &column(&|contact| contact.normal[axis]), ANY)?;
    }
    chunk.reals("contact_gap", &column(&|contact| contact.gap), ANY)?;
    chunk.reals("contact_force", &column(&|contact| contact.force), ANY)?;
    let friction = |contact: &FrameContact<D>| contact.friction.map_or(0.0, |friction| friction.norm());
    if contacts.iter().any(|contact| contact.friction.is_some()) {
        chunk.reals("contact_friction", &column(&friction), ANY)
    } else {
        Ok(())
    }
}

fn add_flow(chunk: &mut Chunk, flow: &FlowLayer) -> Result<(), String> {
    chunk.fact("flow", json!({ "cells": flow.cells, "depth": flow.depth }));
    for (values, name) in flow.velocity.iter().zip(["across", "up", "normal"]) {
        chunk.reals(&format!("flow_{name}"), values, ANY)?;
    }
    chunk.reals("flow_pressure", &flow.pressure, ANY)
}

/// Means over squares of cells, as small as leave few enough.
fn thinned(flow: &FlowLayer) -> FlowLayer {
    let [columns, rows] = flow.cells;
    let side = (1..).find(|side| columns.div_ceil(*side) * rows.div_ceil(*side) <= MOST_CELLS).expect("one cell is few enough");
    let cells = flow.cells.map(|cells| cells.div_ceil(side));
    let mean = |values: &Vec<f64>, place: usize| {
        let start = [place % cells[0] * side, place / cells[0] * side];
        let end = [0, 1].map(|axis| (start[axis] + side).min(flow.cells[axis]));
        let sum: f64 = (start[1]..end[1]).map(|row| values[row * columns..][start[0]..end[0]].iter().sum::<f64>()).sum();
        sum / ((end[0] - start[0]) * (end[1] - start[1])) as f64
    };
    let thin = |values: &Vec<f64>| (0..cells[0] * cells[1]).map(|place| mean(values, place)).collect::<Vec<f64>>();
    FlowLayer { cells, depth: flow.depth, velocity: flow.velocity.iter().map(thin).collect(), pressure: thin(&flow.pressure) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fine_flow_is_thinned_to_means() {
        let cells = [300, 201];
        let values: Vec<f64> = (0..cells[0] * cells[1]).map(|place| (place % cells[0]) as f64).collect();
        let flow = FlowLayer { cells, depth: 0.5, velocity: vec![values.clone(); 2], pressure: values };
        let thin = thinned(&flow);
        assert_eq!(thin.cells, [150, 101]);
        assert_eq!((thin.pressure[0], thin.pressure[1], thin.pressure[150 * 101 - 1]), (0.5, 2.5, 298.5));
        let coarse = FlowLayer { cells: [2, 1], depth: 0.5, velocity: vec![vec![1.0, 2.0]; 2], pressure: vec![3.0, 4.0] };
        assert_eq!(thinned(&coarse), coarse);
    }
}
