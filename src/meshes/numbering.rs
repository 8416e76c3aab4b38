//! Renumbering of vertices.

/// Vertices and elements in another order than the one in which a file or a level lists them, and the numbers they have there:
/// their names. By default it is the same order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Numbering {
    /// The name of each vertex.
    names: Vec<u32>,
    /// The vertex of each name.
    vertices: Vec<u32>,
    /// The name of each element.
    elements: Vec<u32>,
}

impl Numbering {
    /// From the names of all vertices and of all elements, in their new order.
    pub fn new(names: Vec<u32>, elements: Vec<u32>) -> Self {
        let mut vertices = vec![0; names.len()];
        for (vertex, name) in names.iter().enumerate() {
            vertices[*name as usize] = vertex as u32;
        }
        Self { names, vertices, elements }
    }

    /// Whether everything is where it is listed.
    pub const fn is_as_listed(&self) -> bool {
        self.names.is_empty()
    }

    /// The name of a vertex.
    pub fn name(&self, vertex: u32) -> u32 {
        self.names.get(vertex as usize).copied().unwrap_or(vertex)
    }

    /// The vertex of a name.
    pub fn vertex(&self, name: u32) -> u32 {
        self.vertices.get(name as usize).copied().unwrap_or(name)
    }

    /// The name of an element: a triangle or a spring.
    pub fn element_name(&self, element: usize) -> usize {
        self.elements.get(element).map_or(element, |name| *name as usize)
    }

    /// What is listed for each vertex, in the new order.
    pub(crate) fn vertices_of<T: Clone>(&self, listed: &[T]) -> Vec<T> {
        self.names.iter().map(|name| listed[*name as usize].clone()).collect()
    }

    /// What is listed for each element, in the new order.
    pub(crate) fn elements_of<T: Clone>(&self, listed: &[T]) -> Vec<T> {
        self.elements.iter().map(|name| listed[*name as usize].clone()).collect()
    }
}
