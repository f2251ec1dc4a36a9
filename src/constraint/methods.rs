//! The methods, each in one line, by the words of scene files.

use std::rc::Rc;

use super::{
    adjoint::{AdjointWithInertia, Distributed, MeanValue, Penalty},
    kept_values::Precision,
    method::{FlowMethod, Method},
    sharp::{Sharp, SharpWithInertia},
};

/// The method of a word for a problem whose bodies have blocks `B`, with a small parameter if it is given and the method has one; nothing for an
/// unknown word.
pub fn method_of<const D: usize, B>(word: &str, epsilon: Option<f64>, precision: Precision) -> Option<Rc<dyn Method<D, B>>>
where
    Sharp: Method<D, B>,
    MeanValue: Method<D, B>,
    Distributed: Method<D, B>,
    Penalty: Method<D, B>,
{
    Some(match word {
        "sharp" => Rc::new(Sharp { precision }),
        "mean-value" => Rc::new(MeanValue),
        "distributed" => Rc::new(Distributed::default()),
        "penalty" => Rc::new(Penalty::new(epsilon, 0.0)),
        _ => return None,
    })
}

/// The method of a word for bodies in a flow with inertia whose operator has a shift, with a small parameter as in [`method_of`]; `spin_up_of` are the
/// spin-ups `rho w' / mu` that a unit multiplier of rotation gives each body, zero for prescribed motion, and `inside` is whether each moves
/// as the fluid inside it does.
pub fn method_with_inertia<const D: usize>(
    word: &str,
    epsilon: Option<f64>,
    precision: Precision,
    shift: f64,
    spin_up_of: Vec<f64>,
    inside: Vec<bool>,
) -> Option<Rc<FlowMethod<D>>> {
    Some(match word {
        "sharp" => Rc::new(SharpWithInertia { precision, spin_up_of, inside }),
        "mean-value" => Rc::new(AdjointWithInertia { method: MeanValue, spin_up_of }),
        "distributed" => Rc::new(AdjointWithInertia { method: Distributed { shift }, spin_up_of }),
        "penalty" => Rc::new(AdjointWithInertia { method: Penalty::new(epsilon, shift), spin_up_of }),
        _ => return None,
    })
}
