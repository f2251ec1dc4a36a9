//! From the text of an expression to its tree, by recursive descent.

use std::{collections::BTreeMap, f64::consts::PI};

use super::node::{Function, Node, Operator};

/// Functions of one number.
const FUNCTIONS: [(&str, Function); 10] = [
    ("abs", Function::Abs),
    ("cos", Function::Cos),
    ("cosh", Function::Cosh),
    ("exp", Function::Exp),
    ("log", Function::Log),
    ("sin", Function::Sin),
    ("sinh", Function::Sinh),
    ("sqrt", Function::Sqrt),
    ("tan", Function::Tan),
    ("tanh", Function::Tanh),
];

/// Functions of two numbers.
const BINARY_FUNCTIONS: [(&str, Operator); 2] = [("max", Operator::Larger), ("min", Operator::Smaller)];

const OPERAND: &str = "a number, a name or a bracket";
const OPERATOR: &str = "an operator (+ - * / ^)";

type Parsed = Result<Node, String>;

/// Whether a name is that of a function or of pi, or none at all.
pub(super) fn is_taken(name: &str) -> bool {
    let is_word = name.chars().all(is_part_of_a_name) && name.starts_with(begins_a_name);
    !is_word || name == "pi" || functions().any(|function| function == name)
}

pub(super) fn parse(text: &str, variables: &[&str], constants: &BTreeMap<String, f64>) -> Parsed {
    let mut parser = Parser { text: text.chars().collect(), at: 0, variables, constants };
    let root = parser.sum()?;
    if parser.next().is_some() { Err(parser.unexpected(OPERATOR)) } else { Ok(root) }
}

struct Parser<'a> {
    text: Vec<char>,
    /// Characters that are read.
    at: usize,
    variables: &'a [&'a str],
    constants: &'a BTreeMap<String, f64>,
}

impl Parser<'_> {
    fn sum(&mut self) -> Parsed {
        let mut sum = self.product()?;
        while let Some(operator) = self.take_one([('+', Operator::Add), ('-', Operator::Subtract)]) {
            sum = Node::Binary(operator, Box::new([sum, self.product()?]));
        }
        Ok(sum)
    }

    fn product(&mut self) -> Parsed {
        let mut product = self.signed()?;
        while let Some(operator) = self.take_one([('*', Operator::Multiply), ('/', Operator::Divide)]) {
            product = Node::Binary(operator, Box::new([product, self.signed()?]));
        }
        Ok(product)
    }

    fn signed(&mut self) -> Parsed {
        match self.take_one([('-', true), ('+', false)]) {
            Some(true) => Ok(Node::Negative(Box::new(self.signed()?))),
            Some(false) => self.signed(),
            None => self.power(),
        }
    }

    fn power(&mut self) -> Parsed {
        let base = self.operand()?;
        match self.take_one([('^', ())]) {
            Some(()) => Ok(Node::Binary(Operator::Power, Box::new([base, self.signed()?]))),
            None => Ok(base),
        }
    }

    fn operand(&mut self) -> Parsed {
        match self.next() {
            Some('(') => self.in_brackets(),
            Some(sign) if sign.is_ascii_digit() || sign == '.' => self.number(),
            Some(sign) if begins_a_name(sign) => self.name(),
            _ => Err(self.unexpected(OPERAND)),
        }
    }

    fn in_brackets(&mut self) -> Parsed {
        self.expect('(')?;
        let inner = self.sum()?;
        self.expect(')')?;
        Ok(inner)
    }

    fn number(&mut self) -> Parsed {
        let start = self.at;
        self.skip(|sign| sign.is_ascii_digit() || sign == '.');
        if matches!(self.text.get(self.at), Some('e' | 'E')) {
            let signed = matches!(self.text.get(self.at + 1), Some('+' | '-'));
            let digits = self.at + 1 + usize::from(signed);
            if self.text.get(digits).is_some_and(char::is_ascii_digit) {
                self.at = digits;
                self.skip(|sign| sign.is_ascii_digit());
            }
        }
        let number: String = self.text[start..self.at].iter().collect();
        let wrong = |_| format!("has {number} at character {}, which is no number", start + 1);
        number.parse().map(Node::Number).map_err(wrong)
    }

    fn name(&mut self) -> Parsed {
        let start = self.at;
        self.skip(is_part_of_a_name);
        let name: String = self.text[start..self.at].iter().collect();
        if let Some(&(_, function)) = FUNCTIONS.iter().find(|(known, _)| *known == name) {
            return Ok(Node::Call(function, Box::new(self.in_brackets()?)));
        }
        if let Some(&(_, operator)) = BINARY_FUNCTIONS.iter().find(|(known, _)| *known == name) {
            return self.two_in_brackets(operator);
        }
        if let Some(place) = self.variables.iter().position(|variable| *variable == name) {
            return Ok(Node::Variable(place));
        }
        let constant = if name == "pi" { Some(PI) } else { self.constants.get(&name).copied() };
        constant.map(Node::Number).ok_or_else(|| self.unknown(&name, start))
    }

    fn two_in_brackets(&mut self, operator: Operator) -> Parsed {
        self.expect('(')?;
        let one = self.sum()?;
        self.expect(',')?;
        let other = self.sum()?;
        self.expect(')')?;
        Ok(Node::Binary(operator, Box::new([one, other])))
    }

    /// The next character that is no space.
    fn next(&mut self) -> Option<char> {
        self.skip(char::is_whitespace);
        self.text.get(self.at).copied()
    }

    fn skip(&mut self, skipped: impl Fn(char) -> bool) {
        self.at += self.text[self.at..].iter().take_while(|sign| skipped(**sign)).count();
    }

    /// What one of these characters stands for, if it is the next one.
    fn take_one<T: Copy, const N: usize>(&mut self, choices: [(char, T); N]) -> Option<T> {
        let next = self.next()?;
        let found = choices.iter().find(|(sign, _)| *sign == next)?.1;
        self.at += 1;
        Some(found)
    }

    fn expect(&mut self, sign: char) -> Result<(), String> {
        self.take_one([(sign, ())]).ok_or_else(|| self.unexpected(&format!("'{sign}'")))
    }

    fn unexpected(&mut self, expected: &str) -> String {
        match self.next() {
            Some(found) => format!("has '{found}' at character {}, where {expected} is expected", self.at + 1),
            None => format!("ends where {expected} is expected"),
        }
    }

    fn unknown(&self, name: &str, start: usize) -> String {
        let constants = self.constants.keys().map(|name| format!("the constant {name}"));
        let known: Vec<String> = self.variables.iter().map(|name| (*name).to_owned()).chain(constants).collect();
        let functions: Vec<&str> = functions().collect();
        let (known, functions) = (known.join(", "), functions.join(", "));
        format!("has the unknown name {name} at character {}; known are {known}, pi, and the functions {functions}", start + 1)
    }
}

fn functions() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.iter().map(|(name, _)| *name).chain(BINARY_FUNCTIONS.iter().map(|(name, _)| *name))
}

fn begins_a_name(sign: char) -> bool {
    sign.is_ascii_alphabetic() || sign == '_'
}

fn is_part_of_a_name(sign: char) -> bool {
    sign.is_ascii_alphanumeric() || sign == '_'
}
