//! Quantities: what is measured at each instant of a run. Each is declared once, with unit and meaning, and becomes columns of `series.csv`, entries
//! of the summary and rows of the manual.

use std::{borrow::Cow, marker::PhantomData, rc::Rc};

use nalgebra::SMatrix;

use super::{
    column::{Number, SeriesColumn, SeriesEntry},
    view::View,
};
use crate::{
    error::{Error, Result},
    observe::Viscosity,
    output::AXES,
};

/// What a quantity may be: a number, a vector or a symmetric tensor.
pub trait QuantityValue<const D: usize> {
    /// What follows the name of the quantity in the names of its columns.
    fn endings() -> Vec<String>;

    /// A number for each column.
    fn numbers(self) -> Vec<Number>;
}

/// A number that does not exist at times: its cell is empty where it is not finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finite(pub f64);

/// A value that does not exist at times: its cells are empty then.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Perhaps<M>(pub Option<M>);

type Measurement<const D: usize> = Box<dyn Fn(&View<D>) -> Result<Option<Vec<Number>>>>;

/// A quantity that is measured at each instant of a run.
pub struct Quantity<const D: usize> {
    columns: Vec<Rc<SeriesColumn>>,
    of: Measurement<D>,
}

impl<const D: usize> Quantity<D> {
    /// A quantity of this name, unit and meaning. All ranks measure it together, and all get the same: `of` is collective. It gives nothing where the
    /// quantity does not exist, which is so in all instants of a run or in none.
    pub fn new<M: QuantityValue<D>>(
        name: impl AsRef<str>,
        unit: impl Into<Cow<'static, str>>,
        meaning: impl Into<Cow<'static, str>>,
        of: impl Fn(&View<D>) -> Option<M> + 'static,
    ) -> Quantity<D> {
        Quantity::fallible(name, unit, meaning, move |view| Ok(of(view)))
    }

    /// The same of a measurement that can fail.
    pub fn fallible<M: QuantityValue<D>>(
        name: impl AsRef<str>,
        unit: impl Into<Cow<'static, str>>,
        meaning: impl Into<Cow<'static, str>>,
        of: impl Fn(&View<D>) -> Result<Option<M>> + 'static,
    ) -> Quantity<D> {
        let (unit, meaning) = (unit.into(), meaning.into());
        let column = |ending: String| {
            let name = name.as_ref().to_owned() + &ending;
            Rc::new(SeriesColumn { name, unit: unit.clone(), meaning: meaning.clone(), physical: true })
        };
        Quantity { columns: M::endings().into_iter().map(column).collect(), of: Box::new(move |view| Ok(of(view)?.map(M::numbers))) }
    }

    /// The same of a sheared suspension of free bodies, over viscosity and rate.
    pub fn of_shear<M: QuantityValue<D>>(
        name: impl AsRef<str>,
        meaning: impl Into<Cow<'static, str>>,
        of: impl Fn(&Viscosity) -> Option<M> + 'static,
    ) -> Quantity<D> {
        let of = move |found: &Viscosity| {
            let numbers = of(found)?.numbers();
            Some(Shown(if found.at_rest { vec![Number::Missing; numbers.len()] } else { numbers }, PhantomData::<M>))
        };
        Quantity::new(name, "ratio", meaning, move |view| of(view.viscosity.as_ref()?))
    }

    /// The same, about how the run went: it has no entry in the summary.
    pub fn of_run(mut self) -> Quantity<D> {
        self.columns.iter_mut().for_each(|column| *column = Rc::new(SeriesColumn { physical: false, ..(**column).clone() }));
        self
    }

    /// Its columns.
    pub fn columns(&self) -> &[Rc<SeriesColumn>] {
        &self.columns
    }

    /// What it is at an instant, a number for each column; nothing where it does not exist. Collective.
    ///
    /// # Errors
    /// It cannot be measured.
    pub fn measure(&self, view: &View<D>) -> Result<Vec<SeriesEntry>> {
        let entry = |(column, number): (&Rc<SeriesColumn>, Number)| SeriesEntry { column: column.clone(), number };
        Ok((self.of)(view)?.map_or(Vec::new(), |numbers| self.columns.iter().zip(numbers).map(entry).collect()))
    }

    /// Refuses names that are no names of columns, or that others have.
    ///
    /// # Errors
    /// Which.
    pub fn check(&self, others: &[Quantity<D>]) -> Result<()> {
        for SeriesColumn { name, .. } in self.columns.iter().map(AsRef::as_ref) {
            let good = name.starts_with(|sign: char| sign.is_ascii_lowercase())
                && name.bytes().all(|sign| sign == b'_' || sign.is_ascii_lowercase() || sign.is_ascii_digit());
            if !good {
                return Err(Error::refused(format!(
                    "quantity {name}: is no name of a column; use small letters, digits and _, a letter first"
                )));
            }
            if others.iter().flat_map(|other| &other.columns).any(|column| column.name == *name) {
                return Err(Error::refused(format!("quantity {name}: series.csv has a column of that name; choose another")));
            }
        }
        Ok(())
    }
}

/// The numbers of a value of which some may be missing.
struct Shown<M>(Vec<Number>, PhantomData<M>);

impl<const D: usize, M: QuantityValue<D>> QuantityValue<D> for Shown<M> {
    fn endings() -> Vec<String> {
        M::endings()
    }

    fn numbers(self) -> Vec<Number> {
        self.0
    }
}

impl<const D: usize, M: QuantityValue<D>> QuantityValue<D> for Perhaps<M> {
    fn endings() -> Vec<String> {
        M::endings()
    }

    fn numbers(self) -> Vec<Number> {
        self.0.map_or_else(|| vec![Number::Missing; M::endings().len()], M::numbers)
    }
}

fn one_number() -> Vec<String> {
    vec![String::new()]
}

impl<const D: usize> QuantityValue<D> for f64 {
    fn endings() -> Vec<String> {
        one_number()
    }

    fn numbers(self) -> Vec<Number> {
        vec![Number::Real(self)]
    }
}

impl<const D: usize> QuantityValue<D> for Finite {
    fn endings() -> Vec<String> {
        one_number()
    }

    fn numbers(self) -> Vec<Number> {
        vec![if self.0.is_finite() { Number::Real(self.0) } else { Number::Missing }]
    }
}

impl<const D: usize> QuantityValue<D> for usize {
    fn endings() -> Vec<String> {
        one_number()
    }

    fn numbers(self) -> Vec<Number> {
        vec![Number::Count(self)]
    }
}

/// A vector, which has one column, or a tensor, of which the upper triangle is told.
impl<const D: usize, const C: usize> QuantityValue<D> for SMatrix<f64, D, C> {
    fn endings() -> Vec<String> {
        let second = |axis: usize| if C == 1 { "" } else { AXES[axis] };
        components::<D, C>().map(|(row, column)| format!("_{}{}", AXES[row], second(column))).collect()
    }

    fn numbers(self) -> Vec<Number> {
        components::<D, C>().map(|place| Number::Real(self[place])).collect()
    }
}

fn components<const D: usize, const C: usize>() -> impl Iterator<Item = (usize, usize)> {
    (0..D).flat_map(|row| (if C == 1 { 0 } else { row }..C).map(move |column| (row, column)))
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix2, Matrix3, Vector3};

    use super::*;

    #[test]
    fn vectors_and_tensors_have_a_column_for_each_component() {
        let tensor = Quantity::<2>::new("fabric", "", "a tensor", |_| Some(Matrix2::new(1.0, 2.0, 3.0, 4.0)));
        let names: Vec<&str> = tensor.columns().iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["fabric_xx", "fabric_xy", "fabric_yy"]);
        assert_eq!(QuantityValue::<2>::numbers(Matrix2::new(1.0, 2.0, 3.0, 4.0)), [1.0, 2.0, 4.0].map(Number::Real));
        assert_eq!(<Matrix3<f64> as QuantityValue<3>>::endings(), ["_xx", "_xy", "_xz", "_yy", "_yz", "_zz"]);
        assert_eq!(<Vector3<f64> as QuantityValue<3>>::endings(), ["_x", "_y", "_z"]);
        assert_eq!(QuantityValue::<2>::numbers(Finite(f64::INFINITY)), [Number::Missing]);
    }

    #[test]
    fn names_that_are_taken_or_none_are_refused() {
        let quantity = |name: &str| Quantity::<2>::new(name, "", "", |_| Some(1.0));
        let refusal = |name: &str| quantity(name).check(&[quantity("time")]).expect_err("is refused").to_string();
        assert!(quantity("mean_gap_2").check(&[quantity("time")]).is_ok());
        assert!(refusal("time").contains("choose another"), "{}", refusal("time"));
        for name in ["Gap", "2d", "a,b", "a b", ""] {
            assert!(refusal(name).contains("small letters"), "{}", refusal(name));
        }
    }
}
