//! Net: a rectangular sheet with structural, shear and flexion springs.

use super::{Link, Net, NetError, NetSource, Role, net::MOST_SPRINGS};
use crate::{
    meshes::Whole,
    quantity::{Cells, Coordinate, FlexionSpring, Height, Point, Quantity, ShearSpring, StructuralSpring, Width},
};

/// A sheet of `columns` x `rows` cells with a particle at every corner, numbered row by row from the lower left.
///
/// Structural springs run along the sides of the cells, shear springs along both diagonals, and flexion springs from
/// each particle to the second next in its row and column (X. Provot, *Deformation Constraints in a Mass-Spring Model
/// to Describe Rigid Cloth Behavior*, Graphics Interface 1995). All are at rest at the start.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sheet {
    /// Size along x \[m\].
    pub width: Width,
    /// Size along y \[m\].
    pub height: Height,
    /// Cells along x; there is one particle more.
    pub columns: Whole<Cells>,
    /// Cells along y; there is one particle more.
    pub rows: Whole<Cells>,
    /// k along the sides of cells [N/m].
    pub structural: StructuralSpring,
    /// k along their diagonals [N/m].
    pub shear: ShearSpring,
    /// k between every other particle [N/m].
    pub flexion: FlexionSpring,
    /// The lower left corner \[m\].
    pub corner: Point,
    /// Order of the springs.
    #[serde(default, skip_serializing_if = "SpringOrder::is_by_particle")]
    pub order: SpringOrder,
}

/// Order in which a [`Sheet`] lists its springs. A [`crate::effects::Projection`] depends on it, forces only by round-off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum SpringOrder {
    /// Particle by particle.
    #[default]
    ByParticle,
    /// First the structural springs along the four edges, which come twice; then all structural, all shear and all flexion springs,
    /// those to the row above before those in the row. It is the list of the cloth of Princeton's course COS 426.
    EdgesFirst,
}

impl SpringOrder {
    const fn is_by_particle(&self) -> bool {
        matches!(self, Self::ByParticle)
    }
}

impl Default for Sheet {
    fn default() -> Self {
        let cells = Whole::literal(Cells::literal(4.0));
        Self {
            width: Width::literal(0.4),
            height: Height::literal(0.4),
            columns: cells,
            rows: cells,
            structural: StructuralSpring::literal(100.0),
            shear: ShearSpring::literal(100.0),
            flexion: FlexionSpring::literal(100.0),
            corner: Point(Coordinate::literal(0.3), Coordinate::literal(0.3)),
            order: SpringOrder::ByParticle,
        }
    }
}

impl NetSource for Sheet {
    fn build(&self) -> Result<Net, NetError> {
        let (columns, rows) = (self.columns.count(), self.rows.count());
        // Estimate: two sides, two diagonals and two flexion springs per cell.
        let wanted = (columns as usize).saturating_mul(rows as usize).saturating_mul(6);
        if wanted > MOST_SPRINGS {
            return Err(NetError::TooMany(wanted));
        }
        let [x, y] = self.corner.get();
        let (dx, dy) = (self.width.get() / f64::from(columns), self.height.get() / f64::from(rows));
        let points = (0..=rows).flat_map(|row| (0..=columns).map(move |column| (f64::from(column), f64::from(row))));
        let points = points.map(|(column, row)| [x + dx * column, y + dy * row]).collect();
        let links = match self.order {
            SpringOrder::ByParticle => self.by_particle([dx, dy]),
            SpringOrder::EdgesFirst => self.edges_first([dx, dy]),
        };
        let cell = |row: u32, column: u32| {
            let here = row * (columns + 1) + column;
            let [a, b, c, d] = [here, here + 1, here + columns + 2, here + columns + 1];
            [[a, b, c], [a, c, d]]
        };
        let faces = (0..rows).flat_map(|row| (0..columns).flat_map(move |column| cell(row, column))).collect();
        Ok(Net::new(points, links)?.with_faces(faces))
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.structural, &mut self.shear, &mut self.flexion]
    }
}

impl Sheet {
    /// Adds the spring of a particle to the one some columns to the right and some rows up, if that is there. Cells have
    /// the size `[dx, dy]` \[m\].
    fn add(&self, links: &mut Vec<Link>, cell: [f64; 2], [column, row]: [u32; 2], [right, up]: [u32; 2]) {
        let (columns, rows) = (self.columns.count(), self.rows.count());
        if column + right > columns || row + up > rows {
            return;
        }
        let (stiffness, role) = match [right, up] {
            [1, 1] => (self.shear.get(), Role::Shear),
            [1, 0] | [0, 1] => (self.structural.get(), Role::Structural),
            _ => (self.flexion.get(), Role::Flexion),
        };
        let rest = match [right, up] {
            [1, 1] => diagonal(cell),
            _ => f64::from(right) * cell[0] + f64::from(up) * cell[1],
        };
        let here = row * (columns + 1) + column;
        links.push(Link { ends: [here, here + up * (columns + 1) + right], stiffness, rest, role });
    }

    /// Adds the spring of a cell from its lower right to its upper left corner.
    fn add_falling(&self, links: &mut Vec<Link>, cell: [f64; 2], [column, row]: [u32; 2]) {
        let (columns, rows) = (self.columns.count(), self.rows.count());
        if column < columns && row < rows {
            let here = row * (columns + 1) + column;
            let ends = [here + 1, here + columns + 1];
            links.push(Link { ends, stiffness: self.shear.get(), rest: diagonal(cell), role: Role::Shear });
        }
    }

    fn particles(&self) -> impl Iterator<Item = [u32; 2]> + use<> {
        let (columns, rows) = (self.columns.count(), self.rows.count());
        (0..=rows).flat_map(move |row| (0..=columns).map(move |column| [column, row]))
    }

    fn by_particle(&self, cell: [f64; 2]) -> Vec<Link> {
        let mut links = Vec::new();
        for particle in self.particles() {
            for step in [[1, 0], [0, 1], [1, 1], [2, 0], [0, 2]] {
                self.add(&mut links, cell, particle, step);
            }
            self.add_falling(&mut links, cell, particle);
        }
        links
    }

    fn edges_first(&self, cell: [f64; 2]) -> Vec<Link> {
        let mut links = Vec::new();
        let (columns, rows) = (self.columns.count(), self.rows.count());
        for particle in self.particles() {
            let is_on_edge = [[0, columns].contains(&particle[0]), [0, rows].contains(&particle[1])];
            for (_, step) in is_on_edge.into_iter().zip([[0, 1], [1, 0]]).filter(|(is_on_edge, _)| *is_on_edge) {
                self.add(&mut links, cell, particle, step);
            }
        }
        for particle in self.particles() {
            self.add(&mut links, cell, particle, [0, 1]);
            self.add(&mut links, cell, particle, [1, 0]);
        }
        for particle in self.particles() {
            self.add(&mut links, cell, particle, [1, 1]);
            self.add_falling(&mut links, cell, particle);
        }
        for particle in self.particles() {
            self.add(&mut links, cell, particle, [0, 2]);
            self.add(&mut links, cell, particle, [2, 0]);
        }
        links
    }
}

/// Length of a cell's diagonal \[m\].
fn diagonal([dx, dy]: [f64; 2]) -> f64 {
    (dx * dx + dy * dy).sqrt()
}
