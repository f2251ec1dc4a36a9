//! The tree of operations of an expression.

use super::dual::Dual;

/// An operation with what it is applied to.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Node {
    /// A number.
    Number(f64),
    /// The variable of this place.
    Variable(usize),
    /// The negative of something.
    Negative(Box<Node>),
    /// An operation on two numbers.
    Binary(Operator, Box<[Node; 2]>),
    /// A function of one number.
    Call(Function, Box<Node>),
}

/// Operations on two numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Smaller,
    Larger,
}

/// Functions of one number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Function {
    Abs,
    Cos,
    Cosh,
    Exp,
    Log,
    Sin,
    Sinh,
    Sqrt,
    Tan,
    Tanh,
}

impl Node {
    pub(super) fn evaluate(&self, variables: &[Dual]) -> Dual {
        match self {
            Node::Number(number) => Dual::fixed(*number),
            Node::Variable(place) => variables[*place],
            Node::Negative(node) => -node.evaluate(variables),
            Node::Binary(operator, nodes) => {
                let [one, other] = [&nodes[0], &nodes[1]].map(|node| node.evaluate(variables));
                operator.apply(one, other)
            }
            Node::Call(function, node) => function.apply(node.evaluate(variables)),
        }
    }
}

impl Operator {
    fn apply(self, one: Dual, other: Dual) -> Dual {
        match self {
            Operator::Add => one + other,
            Operator::Subtract => one - other,
            Operator::Multiply => one * other,
            Operator::Divide => one / other,
            Operator::Power => one.power(other),
            // a number that is none stays so
            Operator::Smaller if other.value < one.value || other.value.is_nan() => other,
            Operator::Larger if other.value > one.value || other.value.is_nan() => other,
            Operator::Smaller | Operator::Larger => one,
        }
    }
}

impl Function {
    fn apply(self, argument: Dual) -> Dual {
        let x = argument.value;
        let (value, derivative) = match self {
            Function::Abs => (x.abs(), x.signum()),
            Function::Cos => (x.cos(), -x.sin()),
            Function::Cosh => (x.cosh(), x.sinh()),
            Function::Exp => (x.exp(), x.exp()),
            Function::Log => (x.ln(), 1.0 / x),
            Function::Sin => (x.sin(), x.cos()),
            Function::Sinh => (x.sinh(), x.cosh()),
            Function::Sqrt => (x.sqrt(), 0.5 / x.sqrt()),
            Function::Tan => (x.tan(), 1.0 + x.tan().powi(2)),
            Function::Tanh => (x.tanh(), 1.0 - x.tanh().powi(2)),
        };
        argument.chain(value, derivative)
    }
}
