//! Net of particles and springs, checked.

use crate::meshes::{NEAR, Numbering, size};

/// Net: particles at their start, and the springs between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Net {
    points: Vec<[f64; 2]>,
    /// Distance of each particle from the plane of the net \[m\]; empty if all are in it.
    heights: Vec<f64>,
    links: Vec<Link>,
    /// Triangles that fill its cells, for drawing; empty if it has none.
    faces: Vec<[u32; 3]>,
    numbering: Numbering,
}

/// Spring between two particles with the force `k (length - rest)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Particles, counted from 0.
    pub ends: [u32; 2],
    /// k [N/m].
    pub stiffness: f64,
    /// Rest length \[m\].
    pub rest: f64,
    /// Role in the net.
    pub role: Role,
}

impl Link {
    /// Length for flat positions `x` \[m\].
    pub fn length(&self, x: &[f64]) -> f64 {
        let [a, b] = self.ends.map(|end| 2 * end as usize);
        let (dx, dy) = (x[b] - x[a], x[b + 1] - x[a + 1]);
        (dx * dx + dy * dy).sqrt()
    }
}

/// Role of a spring in a net. The force does not depend on it; a drawing may.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Role {
    /// Between neighbours.
    #[default]
    Structural,
    /// Along a cell's diagonal.
    Shear,
    /// Between every other particle of a row, so that the row does not fold.
    Flexion,
}

/// Greatest number of springs of a net.
pub const MOST_SPRINGS: usize = 2_000_000;

/// Error of a net. Particles and springs count from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NetError {
    /// No spring at all.
    #[error("the net has no springs; give it at least one")]
    Empty,
    /// More than `MOST_SPRINGS`.
    #[error("the net would have {0} springs; ask for at most {MOST_SPRINGS}")]
    TooMany(usize),
    /// A coordinate is infinite or not a number.
    #[error("particle {0} has a coordinate that is not a finite number; correct it")]
    NotFinite(usize),
    /// A spring names a particle that is not there.
    #[error("spring {spring} names particle {particle}, but the last particle is {last}; correct the number")]
    NoSuchParticle {
        /// The spring.
        spring: usize,
        /// The number it names.
        particle: u32,
        /// The largest number it may name.
        last: usize,
    },
    /// A spring from a particle to itself.
    #[error("spring {spring} goes from particle {particle} to itself; name two different particles")]
    SelfLink {
        /// The spring.
        spring: usize,
        /// The particle.
        particle: u32,
    },
    /// Particles without a spring.
    #[error("no spring holds particle {particle} ({count} such in all); remove unused particles or connect them")]
    Unused {
        /// The first of them.
        particle: usize,
        /// Their number.
        count: usize,
    },
}

impl Net {
    /// Checked net of particles at these points \[m\].
    ///
    /// # Errors
    /// [`NetError`] names the invalid particle or spring.
    pub fn new(points: Vec<[f64; 2]>, links: Vec<Link>) -> Result<Self, NetError> {
        if links.is_empty() || points.is_empty() {
            return Err(NetError::Empty);
        }
        if links.len() > MOST_SPRINGS {
            return Err(NetError::TooMany(links.len()));
        }
        if let Some(particle) = points.iter().position(|point| !point.iter().all(|value| value.is_finite())) {
            return Err(NetError::NotFinite(particle));
        }
        let mut held = vec![false; points.len()];
        for (spring, &Link { ends, .. }) in links.iter().enumerate() {
            for particle in ends {
                let last = points.len() - 1;
                let no_such = NetError::NoSuchParticle { spring, particle, last };
                *held.get_mut(particle as usize).ok_or(no_such)? = true;
            }
            if ends[0] == ends[1] {
                return Err(NetError::SelfLink { spring, particle: ends[0] });
            }
        }
        match held.iter().position(|held| !held) {
            Some(particle) => Err(NetError::Unused { particle, count: held.iter().filter(|held| !**held).count() }),
            None => Ok(Self { points, heights: Vec::new(), links, faces: Vec::new(), numbering: Numbering::default() }),
        }
    }

    /// The net with all lengths multiplied by a factor, which must be positive. Stiffnesses stay.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let points = self.points.iter().map(|point| point.map(|along| factor * along)).collect();
        let heights = self.heights.iter().map(|height| factor * height).collect();
        let links = self.links.iter().map(|link| Link { rest: factor * link.rest, ..*link }).collect();
        Self { points, heights, links, ..self.clone() }
    }

    /// Same net with particles and springs in another order.
    #[must_use]
    pub fn renumbered(&self, numbering: Numbering) -> Self {
        let link = |link: Link| Link { ends: link.ends.map(|end| numbering.vertex(end)), ..link };
        let links = numbering.elements_of(&self.links).into_iter().map(link).collect();
        let faces = self.faces.iter().map(|face| face.map(|corner| numbering.vertex(corner))).collect();
        let heights = if self.is_flat() { Vec::new() } else { numbering.vertices_of(&self.heights) };
        Self { points: numbering.vertices_of(&self.points), heights, links, faces, numbering }
    }

    /// The net with triangles between its particles, by which it is drawn in space. They carry no force.
    #[must_use]
    pub(super) fn with_faces(self, faces: Vec<[u32; 3]>) -> Self {
        Self { faces, ..self }
    }

    /// The net with particles at these distances in front of its plane \[m\], which must be finite.
    #[must_use]
    pub(super) fn with_heights(self, heights: Vec<f64>) -> Self {
        Self { heights, ..self }
    }

    /// Whether all particles are in its plane. Others are in space alone.
    pub fn is_flat(&self) -> bool {
        self.heights.is_empty()
    }

    /// Start position of each particle, with its distance from the plane of the net \[m\].
    pub fn points_in_space(&self) -> impl Iterator<Item = [f64; 3]> {
        let heights = self.heights.iter().copied().chain(std::iter::repeat(0.0));
        self.points.iter().zip(heights).map(|([x, y], height)| [*x, *y, height])
    }

    /// Triangles between its particles, by which it is drawn in space; empty if it is drawn by its springs.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Numbers of particles and springs in the original list.
    pub const fn numbering(&self) -> &Numbering {
        &self.numbering
    }

    /// Start positions of the particles \[m\].
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// Messages about a usable net, for the user.
    pub fn messages(&self) -> Vec<String> {
        // Where not all particles are in one plane, their distances in it say nothing.
        if !self.is_flat() {
            return Vec::new();
        }
        let near = NEAR * size(&self.points);
        let flat = self.points.as_flattened();
        // A spring without a rest length pulls two particles together, wherever they are.
        let short = |link: &&Link| link.length(flat) < near && link.rest > near;
        let mut short = self.links.iter().filter(short);
        let Some(first) = short.next() else { return Vec::new() };
        let [a, b] = first.ends.map(|end| self.numbering.name(end));
        vec![format!(
            "particles {a} and {b} are {:.1e} m apart, and the spring between them has a rest length of {} m ({} such in all): its \
             direction is not sure; merge them or move them apart",
            first.length(flat),
            first.rest,
            1 + short.count()
        )]
    }

    /// Springs.
    pub fn links(&self) -> &[Link] {
        &self.links
    }
}
