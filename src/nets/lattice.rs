//! Net: a block of particles in space.

use super::{Link, Net, NetError, NetSource, Role, net::MOST_SPRINGS};
use crate::{
    meshes::Whole,
    quantity::{
        Cells, Coordinate, Depth, FlexionSpring, Height, Point, Quantity, ShearSpring, StructuralSpring, Width,
    },
};

/// A block of `columns` x `rows` x `layers` cells in space with a particle at every corner, numbered layer by layer and row by row. The
/// first layer is in the plane of the net, the last one in front of it.
///
/// Structural springs run along the edges of the cells, shear springs along both diagonals of their faces, and flexion springs from
/// each particle to its second neighbour along the edges, as in a [`Sheet`](super::Sheet). All are at rest at the start.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lattice {
    /// Size along x of the net \[m\].
    pub width: Width,
    /// Size along y of the net \[m\].
    pub height: Height,
    /// Size perpendicular to the plane of the net \[m\].
    pub depth: Depth,
    /// Cells along x; there is one particle more.
    pub columns: Whole<Cells>,
    /// Cells along y; there is one particle more.
    pub rows: Whole<Cells>,
    /// Cells across the plane; there is one particle more.
    pub layers: Whole<Cells>,
    /// Stiffness of the springs along the edges of cells [N/m].
    pub structural: StructuralSpring,
    /// Stiffness of those along the diagonals of their faces [N/m].
    pub shear: ShearSpring,
    /// Stiffness of those between second neighbours [N/m].
    pub flexion: FlexionSpring,
    /// The lower left corner of the first layer \[m\].
    pub corner: Point,
}

impl Default for Lattice {
    fn default() -> Self {
        let cells = Whole::literal(Cells::literal(3.0));
        Self {
            width: Width::literal(0.4),
            height: Height::literal(0.4),
            depth: Depth::literal(0.4),
            columns: cells,
            rows: cells,
            layers: cells,
            structural: StructuralSpring::literal(100.0),
            shear: ShearSpring::literal(100.0),
            flexion: FlexionSpring::literal(100.0),
            corner: Point(Coordinate::literal(0.3), Coordinate::literal(0.3)),
        }
    }
}

/// Steps from a particle to the other end of each of its springs.
const STEPS: [[i64; 3]; 12] = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 1, 0],
    [-1, 1, 0],
    [1, 0, 1],
    [-1, 0, 1],
    [0, 1, 1],
    [0, -1, 1],
    [2, 0, 0],
    [0, 2, 0],
    [0, 0, 2],
];

impl Lattice {
    fn cells(&self) -> [u32; 3] {
        [self.columns.count(), self.rows.count(), self.layers.count()]
    }

    /// Number of a particle.
    fn number(&self, [column, row, layer]: [u32; 3]) -> u32 {
        let [columns, rows, _] = self.cells();
        (layer * (rows + 1) + row) * (columns + 1) + column
    }

    fn link(&self, particle: [u32; 3], step: [i64; 3], size: [f64; 3]) -> Option<Link> {
        let (cells, mut other) = (self.cells(), particle);
        for axis in 0..3 {
            let place = i64::from(particle[axis]) + step[axis];
            other[axis] = u32::try_from(place).ok().filter(|place| *place <= cells[axis])?;
        }
        let along: [f64; 3] = std::array::from_fn(|axis| step[axis] as f64 * size[axis]);
        let rest = along.iter().map(|along| along * along).sum::<f64>().sqrt();
        let (stiffness, role) = match step.map(i64::abs) {
            [1, 0, 0] | [0, 1, 0] | [0, 0, 1] => (self.structural.get(), Role::Structural),
            [2, ..] | [_, 2, _] | [.., 2] => (self.flexion.get(), Role::Flexion),
            _ => (self.shear.get(), Role::Shear),
        };
        Some(Link { ends: [self.number(particle), self.number(other)], stiffness, rest, role })
    }

    /// Triangles of the six sides, counter-clockwise from outside.
    fn faces(&self) -> Vec<[u32; 3]> {
        let cells = self.cells();
        let mut faces = Vec::new();
        for normal in 0..3 {
            let (u, v) = ((normal + 1) % 3, (normal + 2) % 3);
            for (end, is_far) in [(0, false), (cells[normal], true)] {
                for (i, j) in (0..cells[u]).flat_map(|i| (0..cells[v]).map(move |j| (i, j))) {
                    let at = |di: u32, dj: u32| {
                        let mut particle = [0; 3];
                        (particle[normal], particle[u], particle[v]) = (end, i + di, j + dj);
                        self.number(particle)
                    };
                    let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
                    faces.extend(if is_far { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
                }
            }
        }
        faces
    }
}

impl NetSource for Lattice {
    fn build(&self) -> Result<Net, NetError> {
        let cells = self.cells();
        let begins = |step: &[i64; 3]| {
            (0..3).fold(1, |count: usize, axis| {
                count.saturating_mul((cells[axis] as usize + 1).saturating_sub(step[axis].unsigned_abs() as usize))
            })
        };
        let wanted = STEPS.iter().fold(0, |wanted: usize, step| wanted.saturating_add(begins(step)));
        if wanted > MOST_SPRINGS {
            return Err(NetError::TooMany(wanted));
        }
        let [columns, rows, layers] = cells;
        let particles = (0..=layers)
            .flat_map(|layer| (0..=rows).flat_map(move |row| (0..=columns).map(move |column| [column, row, layer])));
        let size = [self.width.get(), self.height.get(), self.depth.get()];
        let size: [f64; 3] = std::array::from_fn(|axis| size[axis] / f64::from(cells[axis]));
        let [x, y] = self.corner.get();
        let place = |[column, row, _]: [u32; 3]| [x + size[0] * f64::from(column), y + size[1] * f64::from(row)];
        let points = particles.clone().map(place).collect();
        let heights = particles.clone().map(|[.., layer]| size[2] * f64::from(layer)).collect();
        let links = particles.flat_map(|particle| STEPS.map(|step| self.link(particle, step, size)));
        Ok(Net::new(points, links.flatten().collect())?.with_faces(self.faces()).with_heights(heights))
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.structural, &mut self.shear, &mut self.flexion]
    }
}
