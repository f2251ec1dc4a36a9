//! The scalar problem on a fitted mesh: each inclusion has one unknown, which all nodes on it share.

use super::{Mesh, Place, System};
use crate::error::Result;

/// What a node's value is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Value {
    Unknown(usize),
    Zero,
}

/// The numbering of the unknowns: inclusions, then nodes of the fluid.
pub struct ScalarNumbering {
    values: Vec<Value>,
    unknowns: usize,
}

impl ScalarNumbering {
    /// Numbers the unknowns of a mesh.
    pub fn new(mesh: &Mesh) -> ScalarNumbering {
        let mut unknowns = mesh.disks.len();
        let mut number = |place: &Place| match place {
            Place::Surface(disk) => Value::Unknown(*disk),
            Place::Wall(_) => Value::Zero,
            Place::Fluid => {
                unknowns += 1;
                Value::Unknown(unknowns - 1)
            }
        };
        let values = mesh.places.iter().map(&mut number).collect();
        ScalarNumbering { values, unknowns }
    }

    /// How many there are.
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// The values at all nodes.
    pub fn values(&self, found: &[f64]) -> Vec<f64> {
        let value = |value: &Value| match value {
            Value::Unknown(unknown) => found[*unknown],
            Value::Zero => 0.0,
        };
        self.values.iter().map(value).collect()
    }

    /// Adds the rows of `-Lap u = source` to a system.
    ///
    /// # Errors
    /// A triangle has collapsed.
    pub fn assemble(&self, mesh: &Mesh, source: f64, system: &mut System) -> Result<()> {
        for triangle in &mesh.triangles {
            let numbers = triangle.nodes.map(|node| match self.values[node] {
                Value::Unknown(unknown) => Some(unknown),
                Value::Zero => None,
            });
            if !numbers.iter().flatten().any(|&row| system.holds(row)) {
                continue;
            }
            for sample in mesh.shape(triangle).samples()? {
                for (i, row) in numbers.iter().enumerate() {
                    let Some(row) = *row else { continue };
                    system.load(row, source * sample.weight * sample.values[i]);
                    for (j, column) in numbers.iter().enumerate() {
                        let Some(column) = *column else { continue };
                        system.add(row, column, sample.weight * sample.gradients[i].dot(&sample.gradients[j]));
                    }
                }
            }
        }
        Ok(())
    }
}
