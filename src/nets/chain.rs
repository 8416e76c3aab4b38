//! Net: a chain of particles.

use super::{Link, Net, NetError, NetSource, Role, net::MOST_SPRINGS};
use crate::{
    meshes::Whole,
    quantity::{Coordinate, Point, Quantity, RestLength, Spring, Springs},
};

/// Particles in a straight row, each held to the next by a spring. They are numbered from `from` on.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Chain {
    /// Where the first particle starts \[m\].
    pub from: Point,
    /// Where the last one starts \[m\].
    pub to: Point,
    /// Springs in the row; there is one particle more.
    pub springs: Whole<Springs>,
    /// k of each spring [N/m].
    pub stiffness: Spring,
    /// Rest length of each spring \[m\]; without it, the distance at the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest: Option<RestLength>,
}

impl Default for Chain {
    fn default() -> Self {
        let at = |x, y| Point(Coordinate::literal(x), Coordinate::literal(y));
        let springs = Whole::literal(Springs::literal(3.0));
        Self { from: at(0.2, 0.8), to: at(0.8, 0.8), springs, stiffness: Spring::literal(100.0), rest: None }
    }
}

impl NetSource for Chain {
    fn build(&self) -> Result<Net, NetError> {
        let springs = self.springs.count();
        if springs as usize > MOST_SPRINGS {
            return Err(NetError::TooMany(springs as usize));
        }
        let ([ax, ay], [bx, by], count) = (self.from.get(), self.to.get(), f64::from(springs));
        let at = |number: u32| {
            let share = f64::from(number) / count;
            [ax + (bx - ax) * share, ay + (by - ay) * share]
        };
        let apart = ((bx - ax) * (bx - ax) + (by - ay) * (by - ay)).sqrt() / count;
        let rest = self.rest.map_or(apart, RestLength::get);
        let link = |i| Link { ends: [i, i + 1], stiffness: self.stiffness.get(), rest, role: Role::Structural };
        Net::new((0..=springs).map(at).collect(), (0..springs).map(link).collect())
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        let rest = self.rest.iter_mut().map(|rest| rest as &mut dyn Quantity);
        std::iter::once(&mut self.stiffness as &mut dyn Quantity).chain(rest).collect()
    }
}
