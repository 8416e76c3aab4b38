//! Errors of meshes and mesh recipes.

/// Greatest number of triangles of a recipe.
pub const MOST_TRIANGLES: usize = 2_000_000;

/// Error of a mesh. Vertices and triangles count from 0; vertices of OBJ files count from 1, as in the file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// No triangle at all.
    #[error("the mesh has no triangles; give it at least one")]
    Empty,
    /// More than [`MOST_TRIANGLES`].
    #[error("the mesh would have {0} triangles; ask for at most {MOST_TRIANGLES}")]
    TooMany(usize),
    /// A coordinate is infinite or not a number.
    #[error("vertex {vertex} has a coordinate that is not a finite number; correct it")]
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} names vertex {vertex}, but the last vertex is {last}; correct the number")]
    NoSuchVertex {
        /// The triangle.
        triangle: usize,
        /// The number it names.
        vertex: usize,
        /// The largest number it may name.
        last: usize,
    },
    /// A triangle has no area, or almost none.
    #[error("triangle {triangle} ({}, {}, {}) has no area, or next to none; remove it or move its corners apart", corners[0], corners[1], corners[2])]
    NoArea {
        /// The triangle.
        triangle: usize,
        /// Its vertices.
        corners: [usize; 3],
    },
    /// Two corners of a triangle are nearly at the same place.
    #[error(
        "vertices {} and {} of triangle {triangle} are {distance:.1e} m apart, far below the size of the mesh; give both the same number \
         and take out what is left without an area, or move them apart",
        vertices[0],
        vertices[1]
    )]
    Near {
        /// The triangle.
        triangle: usize,
        /// The two vertices.
        vertices: [usize; 2],
        /// Their distance \[m\].
        distance: f64,
    },
    /// More than two triangles meet at an edge.
    #[error("{count} triangles share the edge from vertex {from} to vertex {to}; at most two can lie side by side")]
    CrowdedEdge {
        /// One end of the edge.
        from: usize,
        /// The other end.
        to: usize,
        /// Number of triangles with this edge.
        count: usize,
    },
    /// Two triangles lie on the same side of an edge they share.
    #[error("two triangles lie on the same side of the edge from vertex {from} to vertex {to}; remove the one on top")]
    Overlap {
        /// One end of the edge.
        from: usize,
        /// The other end.
        to: usize,
    },
    /// Two parts of the mesh touch only at a vertex.
    #[error(
        "parts of the mesh touch only at vertex {vertex}; join them along an edge, or give each its own vertex there"
    )]
    BowTie {
        /// The vertex.
        vertex: usize,
    },
    /// Vertices without a triangle. They would have no mass.
    #[error("no triangle uses vertex {vertex} ({count} such in all); remove unused vertices or connect them")]
    Unused {
        /// The first of them.
        vertex: usize,
        /// Their number.
        count: usize,
    },
    /// The sides of an outline cross or touch each other.
    #[error(
        "sides {first} and {second} of the outline cross or touch; move their corners apart so that it bounds one area"
    )]
    Crossing {
        /// A side, numbered by its first point from 0.
        first: usize,
        /// The other side.
        second: usize,
    },
    /// A recipe that cannot be built, explained in a sentence.
    #[error("{0}")]
    Recipe(String),
    /// A file that cannot be read.
    #[error("{path}: {reason}")]
    File {
        /// The path as the level gives it.
        path: String,
        /// Reason.
        reason: String,
    },
    /// A line of a file that cannot be understood.
    #[error("{path}, line {line}: {reason}")]
    Line {
        /// The path as the level gives it.
        path: String,
        /// The line, from 1.
        line: usize,
        /// Reason and expected content.
        reason: String,
    },
}
