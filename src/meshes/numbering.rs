//! Renumbering of vertices.

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
