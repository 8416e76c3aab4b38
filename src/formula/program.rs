//! Formulas as short programs: computed in SIMD lanes, and differentiated by the numbers that they are computed with.

use super::{Formula, Function, Instruction, Operation};
use crate::simd::Real;

/// Most steps of a program, and most numbers that wait at a time.
const LONGEST: usize = 48;
const DEEPEST: usize = 8;

/// A formula of two variables, with all other names replaced by numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Program {
    steps: [Step; LONGEST],
    length: usize,
}

/// One step of a computation on a stack.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    /// Puts a number on it.
    Number(f64),
    /// Puts a variable on it.
    Variable(usize),
    /// Adds a number to the last one.
    AddNumber(f64),
    /// Multiplies the last number by one.
    MultiplyBy(f64),
    /// The last number to a whole power.
    Power(i32),
    /// The last number, which is positive, to any power.
    RealPower(f64),
    Negative,
    Exp,
    Log,
    Sqrt,
    Abs,
    /// Replace the last two numbers by one.
    Add,
    Subtract,
    Multiply,
    Divide,
    Min,
    Max,
}

/// A formula as a tree.
enum Node {
    Number(f64),
    Variable(usize),
    One(Function, Box<Self>),
    Two(Operation, Box<Self>, Box<Self>),
}

impl Formula {
    /// The program of this formula, whose variables after the first two have these values.
    ///
    /// # Errors
    /// A sentence about a function that programs do not have, or about the length of the formula.
    pub fn program(&self, numbers: &[f64]) -> Result<Program, String> {
        let mut stack: Vec<Node> = Vec::new();
        for instruction in &self.instructions {
            let node = match *instruction {
                Instruction::Number(number) => Node::Number(number),
                Instruction::Variable(variable) => match variable.checked_sub(2).and_then(|n| numbers.get(n)) {
                    Some(number) => Node::Number(*number),
                    None => Node::Variable(variable),
                },
                Instruction::One(function) => {
                    let Some(of) = stack.pop() else { break };
                    match of {
                        Node::Number(number) => Node::Number(function.of(number)),
                        of => Node::One(function, Box::new(of)),
                    }
                }
                Instruction::Two(operation) => {
                    let (Some(other), Some(one)) = (stack.pop(), stack.pop()) else { break };
                    match (one, other) {
                        (Node::Number(one), Node::Number(other)) => Node::Number(operation.of(one, other)),
                        (one, other) => Node::Two(operation, Box::new(one), Box::new(other)),
                    }
                }
            };
            stack.push(node);
        }
        let mut steps = Vec::new();
        stack.pop().unwrap_or(Node::Number(0.0)).write(&mut steps)?;
        Program::of(&steps)
    }
}

impl Node {
    /// Appends the steps that compute it.
    fn write(self, steps: &mut Vec<Step>) -> Result<(), String> {
        match self {
            Self::Number(number) => steps.push(Step::Number(number)),
            Self::Variable(variable) => steps.push(Step::Variable(variable)),
            Self::One(function, of) => {
                of.write(steps)?;
                match function {
                    Function::Negative => steps.push(Step::Negative),
                    Function::Exp => steps.push(Step::Exp),
                    Function::Log => steps.push(Step::Log),
                    Function::Log10 => steps.extend([Step::Log, Step::MultiplyBy(std::f64::consts::LOG10_E)]),
                    Function::Sqrt => steps.push(Step::Sqrt),
                    Function::Abs => steps.push(Step::Abs),
                    _ => {
                        return Err(
                            "an energy has the functions exp, log, ln, log10, sqrt, abs, min and max alone".to_owned()
                        );
                    }
                }
            }
            Self::Two(operation, one, other) => Self::write_two(operation, (*one, *other), steps)?,
        }
        Ok(())
    }

    fn write_two(operation: Operation, pair: (Self, Self), steps: &mut Vec<Step>) -> Result<(), String> {
        let then = match (operation, pair) {
            (Operation::Add, (of, Self::Number(number)) | (Self::Number(number), of)) => {
                of.write(steps)?;
                vec![Step::AddNumber(number)]
            }
            (Operation::Multiply, (of, Self::Number(number)) | (Self::Number(number), of)) => {
                of.write(steps)?;
                vec![Step::MultiplyBy(number)]
            }
            (Operation::Subtract, (of, Self::Number(number))) => {
                of.write(steps)?;
                vec![Step::AddNumber(-number)]
            }
            (Operation::Subtract, (Self::Number(number), of)) => {
                of.write(steps)?;
                vec![Step::Negative, Step::AddNumber(number)]
            }
            (Operation::Divide, (of, Self::Number(number))) => {
                of.write(steps)?;
                vec![Step::MultiplyBy(1.0 / number)]
            }
            (Operation::Divide, (Self::Number(number), of)) => {
                of.write(steps)?;
                vec![Step::Power(-1), Step::MultiplyBy(number)]
            }
            (Operation::Power, (of, Self::Number(number))) => {
                of.write(steps)?;
                let whole = number.round();
                if whole == number && number.abs() <= 64.0 {
                    vec![Step::Power(whole as i32)]
                } else {
                    vec![Step::RealPower(number)]
                }
            }
            // a^b = exp(b ln a).
            (Operation::Power, (base, exponent)) => {
                base.write(steps)?;
                steps.push(Step::Log);
                exponent.write(steps)?;
                vec![Step::Multiply, Step::Exp]
            }
            (operation, (one, other)) => {
                one.write(steps)?;
                other.write(steps)?;
                match operation {
                    Operation::Add => vec![Step::Add],
                    Operation::Subtract => vec![Step::Subtract],
                    Operation::Multiply => vec![Step::Multiply],
                    Operation::Divide => vec![Step::Divide],
                    Operation::Min => vec![Step::Min],
                    Operation::Max => vec![Step::Max],
                    _ => return Err("an energy has no atan2 and no hypot".to_owned()),
                }
            }
        };
        steps.extend(then);
        Ok(())
    }
}

impl Program {
    fn of(steps: &[Step]) -> Result<Self, String> {
        let mut depth = 0_usize;
        for step in steps {
            match step {
                Step::Number(_) | Step::Variable(_) => depth += 1,
                Step::Add | Step::Subtract | Step::Multiply | Step::Divide | Step::Min | Step::Max => depth -= 1,
                _ => {}
            }
            if depth > DEEPEST {
                return Err(format!("more than {DEEPEST} numbers wait for an operation: use fewer brackets"));
            }
        }
        if steps.len() > LONGEST {
            return Err(format!("it takes {} operations, more than {LONGEST}", steps.len()));
        }
        let mut program = Self { steps: [Step::Number(0.0); LONGEST], length: steps.len() };
        program.steps[..steps.len()].copy_from_slice(steps);
        Ok(program)
    }

    /// The same and a number, if that is not zero and there is room for it.
    #[must_use]
    pub fn plus(&self, number: f64) -> Self {
        let mut sum = *self;
        if number != 0.0 && self.length < LONGEST {
            sum.steps[self.length] = Step::AddNumber(number);
            sum.length += 1;
        }
        sum
    }

    /// Its value at two variables.
    #[inline(always)]
    pub fn compute<R: Real>(&self, variables: [R; 2]) -> R {
        let mut stack = [variables[0]; DEEPEST];
        let mut top = 0;
        for step in &self.steps[..self.length] {
            match *step {
                Step::Number(number) => {
                    stack[top] = variables[0].of(number);
                    top += 1;
                }
                Step::Variable(number) => {
                    stack[top] = variables[usize::from(number == 1)];
                    top += 1;
                }
                Step::AddNumber(number) => stack[top - 1] = stack[top - 1] + number,
                Step::MultiplyBy(number) => stack[top - 1] = stack[top - 1] * number,
                Step::Power(exponent) => stack[top - 1] = whole_power(stack[top - 1], exponent),
                Step::RealPower(exponent) => stack[top - 1] = stack[top - 1].power(exponent),
                Step::Negative => stack[top - 1] = -stack[top - 1],
                Step::Exp => stack[top - 1] = stack[top - 1].exponential(),
                Step::Log => stack[top - 1] = stack[top - 1].logarithm(),
                Step::Sqrt => stack[top - 1] = stack[top - 1].sqrt(),
                Step::Abs => {
                    let of = stack[top - 1];
                    stack[top - 1] = of.if_less(of.of(0.0), -of, of);
                }
                Step::Add => {
                    top -= 1;
                    stack[top - 1] = stack[top - 1] + stack[top];
                }
                Step::Subtract => {
                    top -= 1;
                    stack[top - 1] = stack[top - 1] - stack[top];
                }
                Step::Multiply => {
                    top -= 1;
                    stack[top - 1] = stack[top - 1] * stack[top];
                }
                Step::Divide => {
                    top -= 1;
                    stack[top - 1] = stack[top - 1] / stack[top];
                }
                Step::Min => {
                    top -= 1;
                    let (one, other) = (stack[top - 1], stack[top]);
                    stack[top - 1] = other.if_less(one, other, one);
                }
                Step::Max => {
                    top -= 1;
                    let (one, other) = (stack[top - 1], stack[top]);
                    stack[top - 1] = one.if_less(other, other, one);
                }
            }
        }
        stack[0]
    }
}

/// x^n by squares.
#[inline(always)]
fn whole_power<R: Real>(x: R, exponent: i32) -> R {
    let (mut left, mut square, mut product) = (exponent.unsigned_abs(), x, None);
    while left > 0 {
        if left & 1 == 1 {
            product = Some(match product {
                Some(product) => square * product,
                None => square,
            });
        }
        left >>= 1;
        if left > 0 {
            square = square * square;
        }
    }
    let product = product.unwrap_or(x.of(1.0));
    if exponent < 0 { x.of(1.0) / product } else { product }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a failing test should panic")]
mod tests {
    use super::*;
    use crate::simd::Jet;

    #[test]
    fn a_program_has_the_values_and_derivatives_of_its_formula() {
        let names = ["x", "y", "c"];
        for text in [
            "c/2*(x - 2 - 2*log(y)) + 3*log(y)^2",
            "x^3 - 2*y^-2 + 1/(x*y) - (1 - x)",
            "x^(1/3)*y^1.5 + y^x",
            "exp(-x) + sqrt(x*y) + log10(x) + abs(x - 5) + 2^3",
            "min(x, y*2) + max(c, x) - min(x, 1)",
            "c - -c*x",
            "7",
        ] {
            let formula = Formula::parse(text, &names).unwrap();
            let program = formula.program(&[1.7]).unwrap();
            for (x, y) in [(2.3, 0.8), (1.2, 1.4)] {
                let (value, slopes) = formula.derivatives(&[x, y, 1.7]);
                let jet = program.compute([Jet::variable(x, 0), Jet::variable(y, 1)]);
                let near = |found: f64, known: f64| (found - known).abs() < 1e-13 * (1.0 + known.abs());
                assert!(near(jet.value, value), "{text}: {} {value}", jet.value);
                assert!(near(program.compute([x, y]), value), "{text}");
                assert!((0..2).all(|axis| near(jet.first[axis], slopes[axis])), "{text}: {:?} {slopes:?}", jet.first);
                // The second derivatives are the slopes of the first.
                let h = 1e-5;
                let first =
                    |dx: f64, dy: f64| program.compute([Jet::variable(x + dx, 0), Jet::variable(y + dy, 1)]).first;
                let by_x = [0, 1].map(|axis| (first(h, 0.0)[axis] - first(-h, 0.0)[axis]) / (2.0 * h));
                let by_y = [0, 1].map(|axis| (first(0.0, h)[axis] - first(0.0, -h)[axis]) / (2.0 * h));
                for (found, known) in jet.second.into_iter().zip([by_x[0], by_x[1], by_y[1]]) {
                    assert!((found - known).abs() < 1e-7 * (1.0 + known.abs()), "{text}: {found} {known}");
                }
            }
        }
    }

    #[test]
    fn what_programs_do_not_have_is_refused_in_words() {
        let program = |text: &str| Formula::parse(text, &["x", "y"]).unwrap().program(&[]);
        for text in ["sin(x)", "floor(y)", "hypot(x, y)"] {
            assert!(program(text).unwrap_err().contains("an energy has"), "{text}");
        }
        assert!(program("x*y+".repeat(30).trim_end_matches('+')).unwrap_err().contains("operations"));
        let deep = format!("{}x{}", "x-(y*".repeat(9), ")".repeat(9));
        assert!(program(&deep).unwrap_err().contains("brackets"), "{:?}", program(&deep));
    }
}
