//! Mesh of a rectangle in equal cells.

use super::{Files, Mesh, MeshError, MeshSource, Whole, error::MOST_TRIANGLES};
use crate::quantity::{Cells, Coordinate, Height, Point, Quantity, Width};

/// How each cell of a [`Rectangle`] is cut into triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Diagonals {
    /// Every cell by the same diagonal, from lower left to upper right: two triangles. Stiffer across than along it.
    Grid,
    /// By one diagonal and the other in turn: two triangles, and the mesh prefers no direction.
    Alternating,
    /// By both diagonals, with a vertex where they cross: four triangles. Locks least when nearly incompressible.
    #[default]
    Crossed,
}

/// A rectangle of `columns` x `rows` cells. Vertices are numbered row by row from the lower left, then the crossings.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rectangle {
    /// Size along x \[m\].
    pub width: Width,
    /// Size along y \[m\].
    pub height: Height,
    /// Cells along x; there is one vertex more.
    pub columns: Whole<Cells>,
    /// Cells along y; there is one vertex more.
    pub rows: Whole<Cells>,
    /// How cells are cut.
    #[serde(default)]
    pub diagonals: Diagonals,
    /// The lower left corner \[m\].
    #[serde(default = "origin")]
    pub corner: Point,
}

/// The point (0, 0).
fn origin() -> Point {
    Point(Coordinate::literal(0.0), Coordinate::literal(0.0))
}

impl Default for Rectangle {
    fn default() -> Self {
        Self {
            width: Width::literal(0.6),
            height: Height::literal(0.3),
            columns: Whole::literal(Cells::literal(20.0)),
            rows: Whole::literal(Cells::literal(10.0)),
            diagonals: Diagonals::default(),
            corner: Point(Coordinate::literal(0.2), Coordinate::literal(0.35)),
        }
    }
}

impl MeshSource for Rectangle {
    fn build(&self, _: &dyn Files) -> Result<Mesh, MeshError> {
        let (columns, rows) = (self.columns.count(), self.rows.count());
        let wanted = columns as usize * rows as usize * if self.diagonals == Diagonals::Crossed { 4 } else { 2 };
        if wanted > MOST_TRIANGLES {
            return Err(MeshError::TooMany(wanted));
        }
        let mut points: Vec<_> = (0..=rows)
            .flat_map(|row| (0..=columns).map(move |column| self.at(f64::from(column), f64::from(row))))
            .collect();
        let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        if self.diagonals == Diagonals::Crossed {
            points.extend(cells.clone().map(|(row, column)| self.at(f64::from(column) + 0.5, f64::from(row) + 0.5)));
        }
        let triangles = cells.flat_map(|(row, column)| self.cut(row, column)).collect();
        Mesh::new(points, triangles)
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.width, &mut self.height, &mut self.columns, &mut self.rows]
    }
}

impl Rectangle {
    /// Point at a number of cells right of and above the corner \[m\].
    fn at(&self, columns: f64, rows: f64) -> [f64; 2] {
        let [x, y] = self.corner.get();
        [
            x + self.width.get() * columns / f64::from(self.columns.count()),
            y + self.height.get() * rows / f64::from(self.rows.count()),
        ]
    }

    /// Triangles of a cell.
    fn cut(&self, row: u32, column: u32) -> Vec<[u32; 3]> {
        let columns = self.columns.count();
        let a = row * (columns + 1) + column;
        let [b, c, d] = [a + 1, a + columns + 2, a + columns + 1];
        match self.diagonals {
            Diagonals::Alternating if (row + column) % 2 == 1 => vec![[a, b, d], [b, c, d]],
            Diagonals::Grid | Diagonals::Alternating => vec![[a, b, c], [a, c, d]],
            Diagonals::Crossed => {
                let centre = (columns + 1) * (self.rows.count() + 1) + row * columns + column;
                vec![[a, b, centre], [b, c, centre], [c, d, centre], [d, a, centre]]
            }
        }
    }
}
