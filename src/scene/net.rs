//! Builds the nets of a scene.

use super::{Scene, numbering, pinned};
use crate::{elements::Springs, level::NetLevel, meshes::Numbering};
use std::{ops::Range, sync::Arc};

/// One net of a scene.
#[derive(Clone)]
pub struct Net {
    /// Name from the level.
    pub name: String,
    /// Its particles in the scene.
    pub vertices: Range<usize>,
    /// Its elements.
    pub springs: Arc<Springs>,
    /// Names of its particles and springs in the level.
    pub numbering: Numbering,
}

impl Scene {
    pub(super) fn add_net(&mut self, level: &NetLevel) -> Result<(), String> {
        let net = numbering::net(level.net.kind().build().map_err(|error| error.to_string())?);
        let first = self.rest.len() / self.dimension;
        let vertices = first..first + net.points().len();
        let points = net.points().as_flattened();
        let pins = pinned(&level.pins, points, net.numbering())?;
        let (vx, vy) = (level.velocity.0.get(), level.velocity.1.get());
        self.rest.extend(points);
        self.start.x.extend(points);
        self.start.v.extend(vertices.clone().flat_map(|_| [vx, vy]));
        self.mass.extend(std::iter::repeat_n(level.mass.get(), self.dimension * vertices.len()));
        Arc::make_mut(&mut self.pins).extend(pins.iter().map(|pin| pin + first as u32));
        self.messages.extend(net.messages().iter().map(|message| format!("{}: {message}", level.name)));
        let springs = Arc::new(Springs::new(&net, vertices.clone()));
        self.nets.push(Net { name: level.name.clone(), vertices, springs, numbering: net.numbering().clone() });
        Ok(())
    }
}
