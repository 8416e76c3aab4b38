//! Formulas of named variables, typed as text, with exact first derivatives.
//!
//! ```
//! use gingerbread::formula::Formula;
//!
//! let formula = Formula::parse("-2*x^2 + sin(t)", &["x", "t"])?;
//! assert_eq!(formula.value(&[3.0, 0.0]), -18.0);
//! assert_eq!(formula.derivatives(&[3.0, 0.0]), (-18.0, [-12.0, 1.0]));
//! assert_eq!(Formula::parse("2*y", &["x"]).unwrap_err().to_string(), "column 3: there is no `y`; the names are x");
//! # Ok::<(), gingerbread::formula::FormulaError>(())
//! ```
//!
//! Libraries for this take `-x^2` as `(-x)^2`; here it is `-(x^2)`, as in mathematics, and `2^3^2` is `2^(3^2)`.

mod program;

pub use program::Program;

use std::ops::Range;

/// A formula of numbered variables.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    /// What is done to a stack of numbers, in this order.
    instructions: Vec<Instruction>,
}

/// Error of a text that is no formula.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("column {column}: {what}")]
pub struct FormulaError {
    /// Where, in characters from 1.
    pub column: usize,
    /// What is wrong, in words.
    pub what: String,
    /// The name that is not known, if that is what is wrong.
    pub unknown: Option<String>,
}

/// Functions of one number, by their names.
const FUNCTIONS: [(&str, Function); 17] = [
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tan", Function::Tan),
    ("asin", Function::Asin),
    ("acos", Function::Acos),
    ("atan", Function::Atan),
    ("sinh", Function::Sinh),
    ("cosh", Function::Cosh),
    ("tanh", Function::Tanh),
    ("exp", Function::Exp),
    ("log", Function::Log),
    ("ln", Function::Log),
    ("log10", Function::Log10),
    ("sqrt", Function::Sqrt),
    ("abs", Function::Abs),
    ("sign", Function::Sign),
    ("floor", Function::Floor),
];

/// Functions of two numbers, by their names.
const PAIRS: [(&str, Operation); 4] =
    [("min", Operation::Min), ("max", Operation::Max), ("atan2", Operation::Atan2), ("hypot", Operation::Hypot)];

const CONSTANTS: [(&str, f64); 3] =
    [("pi", std::f64::consts::PI), ("tau", std::f64::consts::TAU), ("e", std::f64::consts::E)];

/// Longest text, in characters.
const LONGEST: usize = 1000;
/// Most numbers that wait at a time, in brackets or for an operation of lower precedence.
const DEEPEST: usize = 32;

/// One step of a computation on a stack.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Instruction {
    /// Puts a number on it.
    Number(f64),
    /// Puts a variable on it, by its number.
    Variable(usize),
    /// Replaces the last number.
    One(Function),
    /// Replaces the last two numbers by one.
    Two(Operation),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Function {
    Negative,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Log,
    Log10,
    Sqrt,
    Abs,
    Sign,
    Floor,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Operation {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Min,
    Max,
    Atan2,
    Hypot,
}

impl Formula {
    /// Reads a formula of variables with these names, which come before those of constants.
    ///
    /// # Errors
    /// [`FormulaError`], if the text is none.
    pub fn parse(text: &str, names: &[&str]) -> Result<Self, FormulaError> {
        let mut parser = Parser { text, names, at: 0, instructions: Vec::new(), depth: 0 };
        if text.chars().count() > LONGEST {
            return Err(parser.error(0, format!("a formula has at most {LONGEST} characters")));
        }
        parser.sum()?;
        match parser.peek() {
            None => Ok(Self { instructions: parser.instructions }),
            Some(next) => Err(parser.error(parser.at, format!("expected an operator, found `{next}`"))),
        }
    }

    /// The number zero.
    pub fn zero() -> Self {
        Self { instructions: vec![Instruction::Number(0.0)] }
    }

    /// Whether it contains a variable, by its number.
    pub fn uses(&self, variable: usize) -> bool {
        self.instructions.contains(&Instruction::Variable(variable))
    }

    /// Whether it is the number zero.
    pub fn is_zero(&self) -> bool {
        self.instructions == [Instruction::Number(0.0)]
    }

    /// Value at these variables: as many as there are names.
    pub fn value(&self, variables: &[f64]) -> f64 {
        self.compute(|variable| variables[variable])
    }

    /// Value and derivatives by all variables. Where a function has a corner, its derivative is that of one side, or zero; where its slope is infinite, so is the
    /// derivative.
    pub fn derivatives<const N: usize>(&self, variables: &[f64; N]) -> (f64, [f64; N]) {
        let Dual { value, slope } = self.compute(|variable| {
            let mut slope = [0.0; N];
            slope[variable] = 1.0;
            Dual { value: variables[variable], slope }
        });
        (value, slope)
    }

    fn compute<T: Number>(&self, variable: impl Fn(usize) -> T) -> T {
        let mut stack = [T::constant(0.0); DEEPEST];
        let mut top = 0;
        for instruction in &self.instructions {
            match *instruction {
                Instruction::Number(number) => stack[top] = T::constant(number),
                Instruction::Variable(number) => stack[top] = variable(number),
                Instruction::One(function) => {
                    stack[top - 1] = function.of(stack[top - 1]);
                    continue;
                }
                Instruction::Two(operation) => {
                    top -= 1;
                    stack[top - 1] = operation.of(stack[top - 1], stack[top]);
                    continue;
                }
            }
            top += 1;
        }
        stack[0]
    }
}

/// Recursive descent: `sum := product (('+' | '-') product)*`, `product := sign (('*' | '/') sign)*`, `sign := '-' sign | power`,
/// `power := operand ('^' sign)?`.
struct Parser<'a> {
    text: &'a str,
    names: &'a [&'a str],
    /// Byte that is read next.
    at: usize,
    instructions: Vec<Instruction>,
    /// Numbers that wait on the stack, and calls that wait for this one.
    depth: usize,
}

impl Parser<'_> {
    /// Error at a byte.
    fn error(&self, at: usize, what: String) -> FormulaError {
        FormulaError { column: self.text[..at].chars().count() + 1, what, unknown: None }
    }

    /// Next character that is no space.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    /// Takes the next character if it is this one.
    fn take(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        if found {
            self.at += wanted.len_utf8();
        }
        found
    }

    /// Takes all characters that follow and fit.
    fn take_while(&mut self, fits: impl Fn(char) -> bool) -> Range<usize> {
        let rest = &self.text[self.at..];
        let begin = self.at;
        self.at += rest.find(|letter| !fits(letter)).unwrap_or(rest.len());
        begin..self.at
    }

    fn sum(&mut self) -> Result<(), FormulaError> {
        self.product()?;
        loop {
            let operation = match self.peek() {
                Some('+') => Operation::Add,
                Some('-') => Operation::Subtract,
                _ => return Ok(()),
            };
            self.at += 1;
            self.second(operation, Self::product)?;
        }
    }

    fn product(&mut self) -> Result<(), FormulaError> {
        self.sign()?;
        loop {
            let operation = match self.peek() {
                Some('*') => Operation::Multiply,
                Some('/') => Operation::Divide,
                _ => return Ok(()),
            };
            self.at += 1;
            self.second(operation, Self::sign)?;
        }
    }

    fn sign(&mut self) -> Result<(), FormulaError> {
        if !self.take('-') {
            return self.power();
        }
        self.deeper(Self::sign)?;
        self.instructions.push(Instruction::One(Function::Negative));
        Ok(())
    }

    fn power(&mut self) -> Result<(), FormulaError> {
        self.operand()?;
        if self.take('^') { self.second(Operation::Power, Self::sign) } else { Ok(()) }
    }

    /// Reads the second number of an operation.
    fn second(
        &mut self,
        operation: Operation,
        read: fn(&mut Self) -> Result<(), FormulaError>,
    ) -> Result<(), FormulaError> {
        self.deeper(read)?;
        self.instructions.push(Instruction::Two(operation));
        Ok(())
    }

    /// Reads while something waits.
    fn deeper(&mut self, read: fn(&mut Self) -> Result<(), FormulaError>) -> Result<(), FormulaError> {
        self.depth += 1;
        if self.depth >= DEEPEST {
            return Err(self.error(
                self.at,
                format!("{DEEPEST} or more brackets, signs and waiting operations within each other"),
            ));
        }
        read(self)?;
        self.depth -= 1;
        Ok(())
    }

    fn operand(&mut self) -> Result<(), FormulaError> {
        let next = self.peek();
        let begin = self.at;
        match next {
            Some('(') => {
                self.at += 1;
                self.deeper(Self::sum)?;
                self.close()
            }
            Some('0'..='9' | '.') => self.number(),
            Some(letter) if letter.is_alphabetic() || letter == '_' => self.name(),
            Some(other) => Err(self.error(begin, format!("expected a number, a name or a bracket, found `{other}`"))),
            None => Err(self.error(begin, "expected a number, a name or a bracket, found the end".to_owned())),
        }
    }

    fn close(&mut self) -> Result<(), FormulaError> {
        if self.take(')') {
            return Ok(());
        }
        let found = self.peek().map_or("the end".to_owned(), |next| format!("`{next}`"));
        Err(self.error(self.at, format!("expected `)`, found {found}")))
    }

    fn number(&mut self) -> Result<(), FormulaError> {
        let begin = self.at;
        self.take_while(|letter| letter.is_ascii_digit() || letter == '.');
        let exponent = self.at;
        if self.text[exponent..].starts_with(['e', 'E']) {
            self.at += 1;
            let signed = self.text[self.at..].starts_with(['+', '-']);
            self.at += usize::from(signed);
            if self.take_while(|letter| letter.is_ascii_digit()).is_empty() {
                self.at = exponent;
            }
        }
        let written = &self.text[begin..self.at];
        match written.parse::<f64>() {
            Ok(number) if number.is_finite() => {
                self.instructions.push(Instruction::Number(number));
                Ok(())
            }
            _ => Err(self.error(begin, format!("`{written}` is not a number"))),
        }
    }

    fn name(&mut self) -> Result<(), FormulaError> {
        let span = self.take_while(|letter| letter.is_alphanumeric() || letter == '_');
        let name = &self.text[span.clone()];
        if self.peek() == Some('(') {
            self.at += 1;
            if let Some((_, function)) = FUNCTIONS.iter().find(|(known, _)| *known == name) {
                self.deeper(Self::sum)?;
                self.close()?;
                self.instructions.push(Instruction::One(*function));
                return Ok(());
            }
            if let Some((_, operation)) = PAIRS.iter().find(|(known, _)| *known == name) {
                self.deeper(Self::sum)?;
                if !self.take(',') {
                    return Err(self.error(self.at, format!("`{name}` takes two numbers, as {name}(1, 2)")));
                }
                self.depth += 1;
                self.second(*operation, Self::sum)?;
                self.depth -= 1;
                return self.close();
            }
            let known = FUNCTIONS.iter().map(|(name, _)| *name).chain(PAIRS.iter().map(|(name, _)| *name));
            let known: Vec<_> = known.collect();
            let what = format!("there is no function `{name}`; the functions are {}", known.join(", "));
            return Err(self.error(span.start, what));
        }
        let instruction = if let Some(variable) = self.names.iter().position(|known| *known == name) {
            Instruction::Variable(variable)
        } else if let Some((_, number)) = CONSTANTS.iter().find(|(known, _)| *known == name) {
            Instruction::Number(*number)
        } else {
            let what = format!("there is no `{name}`; the names are {}", self.names.join(", "));
            return Err(FormulaError { unknown: Some(name.to_owned()), ..self.error(span.start, what) });
        };
        self.instructions.push(instruction);
        Ok(())
    }
}

/// A number, alone or with derivatives.
trait Number: Copy {
    fn constant(value: f64) -> Self;
    fn value(self) -> f64;
    /// A function of it with this value and derivative.
    fn chain(self, value: f64, slope: impl FnOnce() -> f64) -> Self;
    /// A function of two with this value and derivatives.
    fn combine(self, other: Self, value: f64, slopes: impl FnOnce() -> [f64; 2]) -> Self;
}

impl Number for f64 {
    fn constant(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }

    fn chain(self, value: f64, _: impl FnOnce() -> f64) -> Self {
        value
    }

    fn combine(self, _: Self, value: f64, _: impl FnOnce() -> [f64; 2]) -> Self {
        value
    }
}

/// A number and its derivatives by N variables.
#[derive(Clone, Copy)]
struct Dual<const N: usize> {
    value: f64,
    slope: [f64; N],
}

/// Product in which a zero stays zero: what does not depend on a variable has no derivative, even beside an infinite one, and a factor of zero leaves nothing
/// of that.
fn times(factor: f64, slope: f64) -> f64 {
    if slope == 0.0 || factor == 0.0 { 0.0 } else { factor * slope }
}

impl<const N: usize> Number for Dual<N> {
    fn constant(value: f64) -> Self {
        Self { value, slope: [0.0; N] }
    }

    fn value(self) -> f64 {
        self.value
    }

    fn chain(self, value: f64, slope: impl FnOnce() -> f64) -> Self {
        let factor = slope();
        Self { value, slope: self.slope.map(|slope| times(factor, slope)) }
    }

    fn combine(self, other: Self, value: f64, slopes: impl FnOnce() -> [f64; 2]) -> Self {
        let [one, two] = slopes();
        Self { value, slope: std::array::from_fn(|n| times(one, self.slope[n]) + times(two, other.slope[n])) }
    }
}

impl Function {
    fn of<T: Number>(self, number: T) -> T {
        let v = number.value();
        match self {
            Self::Negative => number.chain(-v, || -1.0),
            Self::Sin => number.chain(libm::sin(v), || libm::cos(v)),
            Self::Cos => number.chain(libm::cos(v), || -libm::sin(v)),
            Self::Tan => {
                let tan = libm::tan(v);
                number.chain(tan, || 1.0 + tan * tan)
            }
            Self::Asin => number.chain(libm::asin(v), || 1.0 / (1.0 - v * v).sqrt()),
            Self::Acos => number.chain(libm::acos(v), || -1.0 / (1.0 - v * v).sqrt()),
            Self::Atan => number.chain(libm::atan(v), || 1.0 / (1.0 + v * v)),
            Self::Sinh => number.chain(libm::sinh(v), || libm::cosh(v)),
            Self::Cosh => number.chain(libm::cosh(v), || libm::sinh(v)),
            Self::Tanh => {
                let tanh = libm::tanh(v);
                number.chain(tanh, || 1.0 - tanh * tanh)
            }
            Self::Exp => {
                let exp = libm::exp(v);
                number.chain(exp, || exp)
            }
            Self::Log => number.chain(libm::log(v), || 1.0 / v),
            Self::Log10 => number.chain(libm::log10(v), || std::f64::consts::LOG10_E / v),
            Self::Sqrt => {
                let sqrt = v.sqrt();
                number.chain(sqrt, || 0.5 / sqrt)
            }
            Self::Abs => number.chain(v.abs(), || if v < 0.0 { -1.0 } else { 1.0 }),
            Self::Sign => number.chain(if v == 0.0 { 0.0 } else { v.signum() }, || 0.0),
            Self::Floor => number.chain(libm::floor(v), || 0.0),
        }
    }
}

impl Operation {
    fn of<T: Number>(self, one: T, other: T) -> T {
        let (a, b) = (one.value(), other.value());
        match self {
            Self::Add => one.combine(other, a + b, || [1.0, 1.0]),
            Self::Subtract => one.combine(other, a - b, || [1.0, -1.0]),
            Self::Multiply => one.combine(other, a * b, || [b, a]),
            Self::Divide => one.combine(other, a / b, || [1.0 / b, -a / (b * b)]),
            Self::Power => {
                let power = libm::pow(a, b);
                one.combine(other, power, || {
                    let by_base = if b == 0.0 { 0.0 } else { b * libm::pow(a, b - 1.0) };
                    [by_base, power * libm::log(a)]
                })
            }
            Self::Min if b < a => one.combine(other, b, || [0.0, 1.0]),
            Self::Max if b > a => one.combine(other, b, || [0.0, 1.0]),
            Self::Min | Self::Max => one.combine(other, a, || [1.0, 0.0]),
            Self::Atan2 => {
                let square = a * a + b * b;
                one.combine(other, libm::atan2(a, b), || [b / square, -a / square])
            }
            Self::Hypot => {
                let length = libm::hypot(a, b);
                // The cone has no slope at its tip.
                one.combine(other, length, || if length == 0.0 { [0.0, 0.0] } else { [a / length, b / length] })
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a failing test should panic")]
mod tests {
    use super::Formula;

    fn value(text: &str) -> f64 {
        Formula::parse(text, &["x", "y"]).unwrap().value(&[3.0, -2.0])
    }

    #[test]
    fn precedence_is_that_of_mathematics() {
        for (text, known) in [
            ("-x^2", -9.0),
            ("2^3^2", 512.0),
            ("2^-1", 0.5),
            ("x - 1 - 1", 1.0),
            ("x/2/2", 0.75),
            ("1 + 2*x^2", 19.0),
            ("-x*-y", -6.0),
            ("(1 + x)*y", -8.0),
            ("1e-3*x", 0.003),
            (".5 + 2.", 2.5),
            ("max(x, y) + min(x, y)", 1.0),
            ("atan2(0, 1) + hypot(3, 4)", 5.0),
            ("log(exp(2)) + log10(100) + sqrt(16) + abs(y) + sign(y)", 9.0),
            ("2*e - e*2 + cos(pi) + cos(tau)", 0.0),
        ] {
            assert!((value(text) - known).abs() < 1e-12, "{text}: {}", value(text));
        }
    }

    #[test]
    fn derivatives_are_slopes() {
        let texts = [
            "sin(x)*cos(y)",
            "tan(x/5)",
            "asin(x/5)",
            "acos(x/5)",
            "atan(x*y)",
            "sinh(x)",
            "cosh(y)",
            "tanh(x*y/9)",
            "exp(y)",
            "log(x)",
            "log10(x)",
            "sqrt(x)",
            "abs(y)",
            "sign(y)",
            "floor(x + 0.5)",
            "x^y",
            "y^3",
            "x/y",
            "min(x, y*2)",
            "max(x, y)",
            "atan2(x, y)",
            "hypot(x, y)",
            "-x - y",
        ];
        for text in texts {
            let formula = Formula::parse(text, &["x", "y"]).unwrap();
            let at = [3.0, -2.0];
            let (value, slopes) = formula.derivatives(&at);
            assert_eq!(value, formula.value(&at), "{text}");
            for axis in 0..2 {
                let along = |by: f64| {
                    let mut moved = at;
                    moved[axis] += by;
                    formula.value(&moved)
                };
                let slope = (along(1e-5) - along(-1e-5)) / 2e-5;
                // The logarithm of a negative base is taken only where the exponent varies.
                let has_slope = !(text == "x^y" && axis == 1 && at[0] < 0.0);
                assert!(
                    !has_slope || (slope - slopes[axis]).abs() < 1e-8 * (1.0 + slope.abs()),
                    "{text} {axis}: {slopes:?}"
                );
            }
        }
        // What does not depend on a variable has no derivative by it, wherever the others are.
        let (_, slopes) = Formula::parse("sqrt(x) + y", &["x", "y"]).unwrap().derivatives(&[0.0, 1.0]);
        assert_eq!(slopes, [f64::INFINITY, 1.0]);
        for (text, known) in [
            ("hypot(x, y)", [0.0; 2]),
            ("x^0 + y", [0.0, 1.0]),
            ("x*sqrt(abs(x))", [0.0; 2]),
            ("max(0, sqrt(x - 1))", [0.0; 2]),
        ] {
            assert_eq!(Formula::parse(text, &["x", "y"]).unwrap().derivatives(&[0.0; 2]).1, known, "{text}");
        }
    }

    #[test]
    fn wrong_text_is_refused_with_its_column() {
        let deep = "(".repeat(40) + "x";
        let long = "1+".repeat(600) + "1";
        for (text, column, words) in [
            ("", 1, "found the end"),
            ("x +", 4, "found the end"),
            ("2 x", 3, "expected an operator, found `x`"),
            ("(x", 3, "expected `)`, found the end"),
            ("x)", 2, "expected an operator"),
            ("3 * q", 5, "there is no `q`; the names are x, y"),
            ("foo(x)", 1, "there is no function `foo`"),
            ("max(x)", 6, "takes two numbers"),
            ("1.2.3", 1, "`1.2.3` is not a number"),
            ("1e999", 1, "is not a number"),
            ("x ** 2", 4, "found `*`"),
            ("sin x", 1, "there is no `sin`"),
            ("ä+", 1, "there is no `ä`"),
            (&deep, 33, "32 or more brackets"),
            (&long, 1, "at most 1000 characters"),
        ] {
            let error = Formula::parse(text, &["x", "y"]).unwrap_err();
            assert!(error.column == column && error.what.contains(words), "{text:?}: {error}");
        }
    }

    /// Any text is read or refused; what is read can be computed.
    #[test]
    fn random_text_never_panics() {
        let pieces =
            ["x", "y", "1", ".", "e", "e-", "+", "-", "*", "/", "^", "(", ")", ",", "sin(", "max(", " ", "é", "pi"];
        let mut numbers = crate::random::stream(3);
        let mut read = 0;
        for _ in 0..20_000 {
            let mut choose = |most: usize| ((numbers.next().unwrap() + 1.0) * 0.5 * most as f64) as usize;
            let text: String = (0..=choose(12)).map(|_| pieces[choose(pieces.len())]).collect();
            if let Ok(formula) = Formula::parse(&text, &["x", "y"]) {
                read += 1;
                let _ = formula.derivatives(&[1.0, 2.0]);
            }
        }
        assert!(read > 500, "{read}");
    }
}
