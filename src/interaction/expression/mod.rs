//! Expressions: forces as a scene writes them, with their derivatives.
//!
//! ```text
//! sum     = product  { (+ | -) product }
//! product = signed   { (* | /) signed }
//! signed  = [+ | -] signed | power
//! power   = operand [^ signed]                     -x^2 is -(x^2), 2^3^2 is 2^9
//! operand = number | name | function(sum [, sum]) | (sum)
//! ```
//!
//! A derivative is found together with the value, by the rules of differentiation applied to each operation (forward automatic differentiation).

mod dual;
mod node;
mod parser;

use std::collections::BTreeMap;

pub use dual::Dual;
use node::Node;

/// Most characters of an expression, which bounds how deep its brackets are.
const LONGEST: usize = 1000;

/// An expression in named variables, with the values of its constants.
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    text: String,
    root: Node,
}

impl Expression {
    /// The expression of a text in these variables and constants, and in `pi`.
    ///
    /// # Errors
    /// What is wrong with the text, where, and what would be right.
    pub fn parse(text: &str, variables: &[&str], constants: &BTreeMap<String, f64>) -> Result<Expression, String> {
        if text.chars().count() > LONGEST {
            return Err(format!("may have {LONGEST} characters at most"));
        }
        Ok(Expression { text: text.to_owned(), root: parser::parse(text, variables, constants)? })
    }

    /// Whether a constant may have this name beside these variables.
    pub fn can_name_constant(name: &str, variables: &[&str]) -> bool {
        !parser::is_taken(name) && !variables.contains(&name)
    }

    /// Its text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Its value, and its derivative in the direction in which the variables change; they are in the order in which they were named.
    pub fn evaluate(&self, variables: &[Dual]) -> Dual {
        self.root.evaluate(variables)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn at(text: &str, x: f64) -> Dual {
        let constants = BTreeMap::from([("k".to_owned(), 3.0), ("e".to_owned(), 7.0)]);
        Expression::parse(text, &["x", "y"], &constants).unwrap().evaluate(&[Dual::varying(x), Dual::fixed(2.0)])
    }

    #[test]
    fn operations_bind_as_in_mathematics() {
        let cases = [
            ("-x^2", -9.0),
            ("2 - -x", 5.0),
            ("2^3^y", 512.0),
            ("2^-x", 0.125),
            ("2*-x^2/3", -6.0),
            ("12/x/y", 2.0),
            ("1/2*x", 1.5),
            ("8 - x - y", 3.0),
            ("(1 + x)*k", 12.0),
            ("1.5e1 + .5 + 2.", 17.5),
            ("e*x", 21.0),
            ("max(x, y) - min(x, k + 1)", 0.0),
            ("(-y)^x", -8.0),
            ("sqrt(x*x) + log(exp(y)) + abs(-x)", 8.0),
            ("cos(pi) + sin(pi/2)", 0.0),
        ];
        for (text, expected) in cases {
            let found = at(text, 3.0).value;
            assert!((found - expected).abs() < 1e-14, "{text} is {found}, not {expected}");
        }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let texts = [
            "-12*k*y/x^4",
            "k*exp(-(x - 1)/y)*cos(pi*x)",
            "sqrt(x) + log(x)*x^y - y^x + x^x",
            "tanh(x)*sinh(x)/cosh(y) + tan(x/5)",
            "max(x, y)^2 + min(x, y) + abs(y - x) - sin(x)",
            "+x - (y - x)/(x*x)",
        ];
        for (text, x) in texts.into_iter().flat_map(|text| [0.7, 1.3, 2.9].map(|x| (text, x))) {
            let (step, slope) = (1e-5, at(text, x).slope);
            let difference = (at(text, x + step).value - at(text, x - step).value) / (2.0 * step);
            assert!((slope - difference).abs() < 1e-7 * (1.0 + slope.abs()), "{text} at {x}: {slope} and {difference}");
        }
        let [x, k] = [1.7_f64, 3.0];
        assert!((at("-12*k*y/x^4", x).slope - 96.0 * k / x.powi(5)).abs() < 1e-13);
        // what does not change has no slope, however steep the function is there
        assert_eq!(at("sqrt(max(x, 0))", -1.0), Dual { value: 0.0, slope: 0.0 });
    }

    #[test]
    fn what_is_no_expression_is_refused_with_its_place() {
        let refusal = |text: &str| Expression::parse(text, &["x", "y"], &BTreeMap::from([("k".to_owned(), 3.0)])).unwrap_err();
        let cases = [
            ("", "ends where a number, a name or a bracket is expected"),
            ("x +", "ends where a number, a name or a bracket is expected"),
            ("2x", "has 'x' at character 2, where an operator (+ - * / ^) is expected"),
            ("x**2", "has '*' at character 3, where a number, a name or a bracket is expected"),
            ("(x", "ends where ')' is expected"),
            ("x)", "has ')' at character 2, where an operator (+ - * / ^) is expected"),
            ("1.2.3", "has 1.2.3 at character 1, which is no number"),
            ("max(x)", "has ')' at character 6, where ',' is expected"),
            ("sin x", "has 'x' at character 5, where '(' is expected"),
            ("sin(x, y)", "has ',' at character 6, where ')' is expected"),
            ("q*x", "has the unknown name q at character 1; known are x, y, the constant k, pi, and the functions"),
            ("x²", "has '²' at character 2"),
        ];
        for (text, expected) in cases {
            assert!(refusal(text).contains(expected), "{text}: {}", refusal(text));
        }
        assert_eq!(refusal(&"(".repeat(1001)), "may have 1000 characters at most");
        assert!(refusal(&"(".repeat(1000)).starts_with("ends where"));
    }
}
