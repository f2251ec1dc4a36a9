//! The methods, each in one line, by the words of scene files.

use std::rc::Rc;

use super::{
    adjoint::{Distributed, MeanValue, Penalty},
    method::FlowMethod,
    scalar::InclusionMethod,
    sharp::Sharp,
};

/// The method of a word for bodies in a fluid, with a small parameter if it is given and the method has one; nothing for an unknown word.
pub fn flow_method<const D: usize>(word: &str, epsilon: Option<f64>) -> Option<Rc<FlowMethod<D>>> {
    Some(match word {
        "sharp" => Rc::new(Sharp),
        "mean-value" => Rc::new(MeanValue),
        "distributed" => Rc::new(Distributed),
        "penalty" => Rc::new(Penalty::new(epsilon)),
        _ => return None,
    })
}

/// The method of a word for inclusions in a scalar, as [`flow_method`].
pub fn inclusion_method<const D: usize>(word: &str, epsilon: Option<f64>) -> Option<Rc<InclusionMethod<D>>> {
    Some(match word {
        "sharp" => Rc::new(Sharp),
        "mean-value" => Rc::new(MeanValue),
        "distributed" => Rc::new(Distributed),
        "penalty" => Rc::new(Penalty::new(epsilon)),
        _ => return None,
    })
}
