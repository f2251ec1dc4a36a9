//! The methods, each in one line, by the words of scene files.

use std::rc::Rc;

use super::{
    adjoint::{Distributed, MeanValue, Penalty},
    method::Method,
    sharp::Sharp,
};

/// The method of a word for a problem whose bodies have blocks `B`, with a small parameter if it is given and the method has one; nothing for an
/// unknown word.
pub fn method_of<const D: usize, B>(word: &str, epsilon: Option<f64>) -> Option<Rc<dyn Method<D, B>>>
where
    Sharp: Method<D, B>,
    MeanValue: Method<D, B>,
    Distributed: Method<D, B>,
    Penalty: Method<D, B>,
{
    Some(match word {
        "sharp" => Rc::new(Sharp),
        "mean-value" => Rc::new(MeanValue),
        "distributed" => Rc::new(Distributed),
        "penalty" => Rc::new(Penalty::new(epsilon)),
        _ => return None,
    })
}
