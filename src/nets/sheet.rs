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
        let diagonal = (dx * dx + dy * dy).sqrt();
        let mut links = Vec::new();
        for row in 0..=rows {
            for column in 0..=columns {
                let here = row * (columns + 1) + column;
                let mut link = |right: u32, up: u32, stiffness: f64, rest: f64, role: Role| {
                    if column + right <= columns && row + up <= rows {
                        let ends = [here, here + up * (columns + 1) + right];
                        links.push(Link { ends, stiffness, rest, role });
                    }
                };
                link(1, 0, self.structural.get(), dx, Role::Structural);
                link(0, 1, self.structural.get(), dy, Role::Structural);
                link(1, 1, self.shear.get(), diagonal, Role::Shear);
                link(2, 0, self.flexion.get(), 2.0 * dx, Role::Flexion);
                link(0, 2, self.flexion.get(), 2.0 * dy, Role::Flexion);
                if column < columns && row < rows {
                    let ends = [here + 1, here + columns + 1];
                    links.push(Link { ends, stiffness: self.shear.get(), rest: diagonal, role: Role::Shear });
                }
            }
        }
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
