//! What one inclusion adds to the linear system.

use crate::constraint::{
    body::{BodyBlocks, FreeInverse},
    method::Method,
    placed::Placed,
    rows::Rows,
};

/// The blocks of an inclusion: C, J and E as those of a body in a fluid, and the rest.
pub struct InclusionBlocks<const D: usize> {
    /// C, J and E.
    pub body: Box<dyn BodyBlocks<D>>,
    /// The rest.
    pub inclusion: Inclusion,
}

/// What an inclusion has besides C, J and E.
pub struct Inclusion {
    /// The values that a constant has when it is tested.
    pub constant: Vec<f64>,
    /// Flux of a multiplier that is constant over the inclusion: the area of its surface, or the volume of a cell, over what testing takes.
    pub measure: f64,
    /// Value that stands for a unit of the constant multiplier, whose row says that nothing flows net out.
    pub reaction: f64,
    /// What is added to rows by a unit source outside of it, besides one everywhere: each cell that it changes or touches, once.
    pub source: Rows,
    /// What a unit source adds to tested values through the jumps; empty without jumps.
    pub by_source: Vec<f64>,
    /// What stands for the inverse of `J A^{-1} C + E` of a lonely inclusion, for values without a constant.
    pub alone: Box<dyn FreeInverse>,
}

/// The value on the surface per unit of each multiplier.
struct ModeValues(Vec<f64>);

impl FreeInverse for ModeValues {
    fn apply(&self, input: &[f64], output: &mut [f64]) {
        output.iter_mut().zip(input.iter().zip(&self.0)).for_each(|(output, (value, of))| *output = value / of);
    }
}

/// A method for inclusions.
pub type InclusionMethod<const D: usize> = dyn Method<D, InclusionBlocks<D>>;

impl Inclusion {
    /// One whose multipliers are modes of its surface.
    pub fn on_surface<const D: usize>(placed: &Placed<D>, source: Rows, by_source: Vec<f64>) -> Inclusion {
        let modes = &placed.surface.modes;
        let values: Vec<f64> = modes.isolated_mobility(modes.radius()).diagonal().iter().copied().collect();
        let constant = (0..modes.count()).map(|mode| if mode == 0 { 1.0 } else { 0.0 }).collect();
        let (measure, reaction) = (placed.surface.area(), values[0]);
        Inclusion { constant, measure, reaction, source, by_source, alone: Box::new(ModeValues(values)) }
    }

    /// The part of the constant in tested values or multipliers.
    pub fn constant_part(&self, tested: &[f64]) -> f64 {
        let square: f64 = self.constant.iter().map(|one| one * one).sum();
        self.constant.iter().zip(tested).map(|(one, value)| one * value).sum::<f64>() / square
    }

    /// Adds a multiple of the constant to tested values or multipliers.
    pub fn add_constant(&self, factor: f64, tested: &mut [f64]) {
        tested.iter_mut().zip(&self.constant).for_each(|(value, one)| *value += factor * one);
    }

    /// Net flux of multipliers.
    pub fn flux(&self, c: &[f64]) -> f64 {
        self.measure * self.constant.iter().zip(c).map(|(one, c)| one * c).sum::<f64>()
    }
}
