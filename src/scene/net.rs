//! Builds the nets of a scene.

use super::{Scene, numbering};
use crate::{
    elements::{NetSprings, Springs},
    level::NetLevel,
    meshes::{Numbering, pinned},
    nets::Link,
};
use std::{ops::Range, sync::Arc};

/// One net of a scene.
#[derive(Clone)]
pub struct Net {
    /// Name from the level.
    pub name: String,
    /// Its particles in the scene.
    pub vertices: Range<usize>,
    /// Its elements.
    pub springs: NetSprings,
    /// Triangles by which it is drawn in space, by the numbers of the scene; empty if it is drawn by its springs.
    pub faces: Arc<Vec<[u32; 3]>>,
    /// Positions of its particles at rest in its own plane \[m\].
    pub points: Arc<Vec<[f64; 2]>>,
    /// Names of its particles and springs in the level.
    pub numbering: Numbering,
}

impl Scene {
    pub(super) fn add_net(&mut self, level: &NetLevel) -> Result<(), String> {
        let net = numbering::net(level.net.kind().build().map_err(|error| error.to_string())?);
        let scale = level.space.map_or(1.0, |place| place.scale.get());
        let net = if scale == 1.0 { net } else { net.scaled(scale) };
        let first = self.rest.len() / self.dimension;
        let vertices = first..first + net.points().len();
        let points = net.points().as_flattened();
        let pins = pinned(&level.pins, points, net.numbering())?;
        if level.space.is_none() && !net.is_flat() {
            return Err(format!(
                "{:?} is a block of particles in space: say where, with `space: ()`",
                level.net.name()
            ));
        }
        let (vx, vy) = (level.velocity.0.get(), level.velocity.1.get());
        let velocity = [vx, vy];
        if let Some(place) = level.space {
            let rest: Vec<_> = net.points_in_space().flat_map(|point| place.placed_from_plane(point)).collect();
            let ([x, y, z], (dx, dy, dz)) = (place.turned(velocity), place.velocity);
            self.start.v.extend(vertices.clone().flat_map(|_| [x + dx.get(), y + dy.get(), z + dz.get()]));
            self.start.x.extend(&rest);
            self.rest.extend(rest);
        } else {
            self.rest.extend(points);
            self.start.x.extend(points);
            self.start.v.extend(vertices.clone().flat_map(|_| velocity));
        }
        self.mass.extend(std::iter::repeat_n(level.mass.get(), self.dimension * vertices.len()));
        Arc::make_mut(&mut self.pins).extend(pins.iter().map(|pin| pin + first as u32));
        self.messages.extend(net.messages().iter().map(|message| format!("{}: {message}", level.name)));
        let springs = if level.space.is_some() {
            let first = vertices.start as u32;
            let links = net.links().iter().map(|link| Link { ends: link.ends.map(|end| end + first), ..*link });
            NetSprings::Space(Arc::new(Springs::of_links(links.collect(), vertices.clone())))
        } else {
            NetSprings::Plane(Arc::new(Springs::new(&net, vertices.clone())))
        };
        let faces = net.faces().iter().map(|face| face.map(|corner| corner + first as u32)).collect();
        let (name, faces, numbering) = (level.name.clone(), Arc::new(faces), net.numbering().clone());
        let points = Arc::new(net.points().to_vec());
        self.nets.push(Net { name, vertices, springs, faces, points, numbering });
        Ok(())
    }
}
