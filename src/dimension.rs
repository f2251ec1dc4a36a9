//! Code for both dimensions that is compiled with this crate, and not again in each program and test that calls it.
//!
//! Generic functions are compiled where they are called. What builds the parts of a run goes through functions of no parameters, one in the plane and one in
//! space, which are compiled here: behind them are traits, whose code is then here too.

use std::any::Any;

/// A value of a type that has another name where the dimension is known.
///
/// # Panics
/// If the types are two.
pub fn same<A: 'static, B: 'static>(value: A) -> B {
    let mut value = Some(value);
    (&mut value as &mut dyn Any).downcast_mut::<Option<B>>().and_then(Option::take).expect("values are of the dimension that is asked for")
}

/// The same of what is borrowed.
///
/// # Panics
/// If the types are two.
pub fn same_ref<A: 'static, B: 'static>(value: &A) -> &B {
    (value as &dyn Any).downcast_ref().expect("values are of the dimension that is asked for")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_goes_through_unchanged() {
        fn sum<const D: usize>(values: [f64; D]) -> f64 {
            if D == 2 { same::<_, [f64; 2]>(values).iter().sum() } else { same_ref::<_, [f64; 3]>(&values).iter().sum() }
        }
        assert_eq!((sum([1.0, 2.0]), sum([1.0, 2.0, 3.0])), (3.0, 6.0));
    }
}
