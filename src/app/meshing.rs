//! Meshes large bodies in the background.

use super::compare::Pane;
use crate::clock::Instant;
use crate::{
    level::{BodyLevel, Level},
    meshes::{MeshKind, NoFiles},
    quantity::{Cells, Rings, Triangles},
    scene::{Body, Scene},
};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Number of triangles above which a mesh is generated in the background. This many take about a tenth of a second.
const LARGE: f64 = 5000.0;

/// Request of a mesh for a body.
#[derive(Clone, Debug)]
pub struct Wanted {
    /// Pane of the body.
    pub pane: Pane,
    /// Number of the body.
    pub body: usize,
    /// Parameters of the mesh.
    pub mesh: MeshKind,
    /// The body at the time of the request. If it changes, the request is void.
    before: BodyLevel,
    /// Time of the first request.
    since: Instant,
}

/// Progress of a mesh that is being made.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Number of the body.
    pub body: usize,
    /// Parameters of the mesh.
    pub mesh: MeshKind,
    /// Approximate number of triangles.
    pub triangles: usize,
    /// Time since the request \[s\].
    pub seconds: f64,
}

/// State of meshing: at most one mesh is generated at a time, and at most one more is requested.
#[derive(Default)]
pub struct Meshing {
    wanted: Option<Wanted>,
    job: Option<Job>,
}

/// A thread that generates a mesh. It cannot be stopped; a cancelled mesh is dropped when it is finished.
struct Job {
    mesh: MeshKind,
    result: Receiver<Result<Body, String>>,
}

impl Meshing {
    /// Takes a request for another mesh of a body if its generation takes long. A small mesh cancels an earlier request.
    pub fn takes(&mut self, pane: Pane, body: usize, mesh: &MeshKind, before: &BodyLevel) -> bool {
        let large = cfg!(not(target_arch = "wasm32"))
            && triangles(mesh) * if before.element.has_six_nodes() { 4.0 } else { 1.0 } > LARGE
            && mesh.clone().kind_mut().path_mut().is_none();
        if !large || before.mesh == *mesh {
            self.wanted = None;
            return false;
        }
        let since = self.wanted.take().map_or_else(Instant::now, |wanted| wanted.since);
        self.wanted = Some(Wanted { pane, body, mesh: mesh.clone(), before: before.clone(), since });
        true
    }

    /// Cancels the request.
    pub fn cancel(&mut self) {
        self.wanted = None;
    }

    /// Progress of the request.
    pub fn progress(&self) -> Option<Progress> {
        let Wanted { body, mesh, since, .. } = self.wanted.as_ref()?;
        let (triangles, seconds) = (triangles(mesh) as usize, since.elapsed().as_secs_f64());
        Some(Progress { body: *body, mesh: mesh.clone(), triangles, seconds })
    }

    /// Returns the requested mesh when it is finished, and starts its generation once the slider is `released`. `now` returns the
    /// present body of a request; if it differs from the body at the request, the request is void.
    pub fn poll<'a>(
        &mut self,
        released: bool,
        now: impl FnOnce(Pane, usize) -> Option<&'a BodyLevel>,
    ) -> Option<(Wanted, Result<Body, String>)> {
        self.wanted.take_if(|wanted| now(wanted.pane, wanted.body) != Some(&wanted.before));
        if let Some(job) = &self.job {
            let made = match job.result.try_recv() {
                Ok(made) => Some(made),
                Err(TryRecvError::Disconnected) => Some(Err("no mesh could be made from this recipe".to_owned())),
                Err(TryRecvError::Empty) => return None,
            };
            let mesh = self.job.take().map(|job| job.mesh);
            if let Some(wanted) = self.wanted.take_if(|wanted| mesh.as_ref() == Some(&wanted.mesh)) {
                return Some((wanted, made?));
            }
        }
        if let Some(wanted) = self.wanted.as_ref().filter(|_| released) {
            self.job = Some(Job::start(wanted));
        }
        None
    }
}

impl Job {
    fn start(wanted: &Wanted) -> Self {
        let (sender, result) = channel();
        let body =
            BodyLevel { mesh: wanted.mesh.clone(), pins: Vec::new(), slides: Vec::new(), ..wanted.before.clone() };
        let work = move || {
            let level = Level { bodies: vec![body], ..Level::default() };
            let scene = Scene::build(&level, level.mode, &NoFiles, None).map_err(|error| error.to_string());
            let body = scene.and_then(|mut scene| scene.bodies.pop().ok_or_else(String::new));
            // The receiver may have been dropped.
            let _ = sender.send(body);
        };
        #[cfg(not(target_arch = "wasm32"))]
        std::thread::spawn(work);
        #[cfg(target_arch = "wasm32")]
        work();
        Self { mesh: wanted.mesh.clone(), result }
    }
}

/// Approximate number of triangles from the parameters of a mesh.
pub fn triangles(mesh: &MeshKind) -> f64 {
    let mut mesh = mesh.clone();
    let (mut cells, mut count) = (1.0, 0.0_f64);
    for parameter in mesh.kind_mut().parameters() {
        let (name, value) = (parameter.spec().name, parameter.get());
        if name == Triangles::SPEC.name {
            count = value;
        } else if name == Cells::SPEC.name {
            cells *= value;
            count = 2.0 * cells;
        } else if name == Rings::SPEC.name {
            count = 6.0 * value * value;
        }
    }
    count
}
