//! Numbers of vertices and triangles: renumbering, and the order of recipes.
//!
//! Recipes number so that neighbours in the plane are near in memory. The element loop runs a third faster with it.
//! Scenes renumber large meshes once more, in the order in which they are stepped.

/// Permutation of vertices and elements. Their names are their numbers in the file or level. The default is the
/// identity.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Numbering {
    /// Name of each vertex.
    names: Vec<u32>,
    /// Vertex of each name.
    vertices: Vec<u32>,
    /// Name of each element.
    elements: Vec<u32>,
}

impl Numbering {
    /// Numbering from the names of all vertices and of all elements, in their new order.
    pub fn new(names: Vec<u32>, elements: Vec<u32>) -> Self {
        let mut vertices = vec![0; names.len()];
        for (vertex, name) in names.iter().enumerate() {
            vertices[*name as usize] = vertex as u32;
        }
        Self { names, vertices, elements }
    }

    /// Whether the numbering is the identity.
    pub const fn is_as_listed(&self) -> bool {
        self.names.is_empty()
    }

    /// Name of a vertex.
    pub fn name(&self, vertex: u32) -> u32 {
        self.names.get(vertex as usize).copied().unwrap_or(vertex)
    }

    /// Vertex of a name.
    pub fn vertex(&self, name: u32) -> u32 {
        self.vertices.get(name as usize).copied().unwrap_or(name)
    }

    /// Name of an element: a triangle or a spring.
    pub fn element_name(&self, element: usize) -> usize {
        self.elements.get(element).map_or(element, |name| *name as usize)
    }

    /// Values of the vertices in the new order.
    pub(crate) fn vertices_of<T: Clone>(&self, listed: &[T]) -> Vec<T> {
        self.names.iter().map(|name| listed[*name as usize].clone()).collect()
    }

    /// Values of the elements in the new order.
    pub(crate) fn elements_of<T: Clone>(&self, listed: &[T]) -> Vec<T> {
        self.elements.iter().map(|name| listed[*name as usize].clone()).collect()
    }
}

/// Base-2 logarithm of the cells along each side of the square that the Hilbert curve visits.
const ORDER: u32 = 16;

/// Renumbers vertices along a Hilbert curve and sorts triangles by their lowest vertex.
pub(super) fn by_place(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> (Vec<[f64; 2]>, Vec<[u32; 3]>) {
    let [low, high] = super::mesh::bounds(points);
    let cells = f64::from((1_u32 << ORDER) - 1);
    let scale = cells / (high[0] - low[0]).max(high[1] - low[1]).max(f64::MIN_POSITIVE);
    let cell = |point: &[f64; 2]| [0, 1].map(|axis| ((point[axis] - low[axis]) * scale).min(cells) as u32);
    let mut order: Vec<(u64, u32)> =
        points.iter().enumerate().map(|(vertex, point)| (hilbert(cell(point)), vertex as u32)).collect();
    order.sort_unstable();
    let mut renamed = vec![0; points.len()];
    for (new, &(_, old)) in order.iter().enumerate() {
        renamed[old as usize] = new as u32;
    }
    let mut triangles: Vec<_> =
        triangles.iter().map(|corners| lowest_first(corners.map(|vertex| renamed[vertex as usize]))).collect();
    triangles.sort_unstable();
    (order.iter().map(|&(_, old)| points[old as usize]).collect(), triangles)
}

/// Same triangle, with its lowest vertex first.
fn lowest_first([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Distance of a cell along the Hilbert curve.
fn hilbert([mut x, mut y]: [u32; 2]) -> u64 {
    let mut distance = 0;
    let mut size = 1 << (ORDER - 1);
    while size > 0 {
        let (right, upper) = (u32::from(x & size > 0), u32::from(y & size > 0));
        distance += u64::from(size) * u64::from(size) * u64::from((3 * right) ^ upper);
        // Each quarter holds a rotated or mirrored copy of the curve.
        if upper == 0 {
            if right == 1 {
                x = (size - 1).wrapping_sub(x) & (size - 1);
                y = (size - 1).wrapping_sub(y) & (size - 1);
            }
            std::mem::swap(&mut x, &mut y);
        }
        size >>= 1;
    }
    distance
}
