//! Meshes large bodies in the background.

use super::compare::Pane;
use crate::{
    level::{BodyLevel, Level},
    meshes::{MeshKind, NoFiles},
    quantity::{Cells, Rings, Triangles},
    scene::{Body, Scene},
};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use web_time::Instant;

/// Meshes with more triangles than these are made in the background: so many take about a tenth of a second.
const LARGE: f64 = 5000.0;

/// A mesh that is wanted for a body.
#[derive(Clone, Debug)]
pub struct Wanted {
    /// The pane whose body it is for.
    pub pane: Pane,
    /// The body.
    pub body: usize,
    /// The recipe.
    pub mesh: MeshKind,
    /// What the body is now; another mesh or level there makes the request void.
    before: BodyLevel,
    /// When it was first asked for.
    since: Instant,
}

/// Progress of a mesh that is being made.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// The body.
    pub body: usize,
    /// The recipe.
    pub mesh: MeshKind,
    /// About how many triangles it will have.
    pub triangles: usize,
    /// For how long it has been on its way [s].
    pub seconds: f64,
}

/// At most one mesh is made at a time, and at most one more is wanted.
#[derive(Default)]
pub struct Meshing {
    wanted: Option<Wanted>,
    job: Option<Job>,
}

/// A thread that makes a mesh. It cannot be stopped; a cancelled mesh is dropped when it is done.
struct Job {
    mesh: MeshKind,
    result: Receiver<Result<Body, String>>,
}

impl Meshing {
    /// Takes a request for another mesh of a body, if making it takes long. A small one cancels an earlier request.
    pub fn takes(&mut self, pane: Pane, body: usize, mesh: &MeshKind, before: &BodyLevel) -> bool {
        let large = cfg!(not(target_arch = "wasm32"))
            && triangles(mesh) > LARGE
            && mesh.clone().kind_mut().path_mut().is_none();
        if !large || before.mesh == *mesh {
            self.wanted = None;
            return false;
        }
        let since = self.wanted.take().map_or_else(Instant::now, |wanted| wanted.since);
        self.wanted = Some(Wanted { pane, body, mesh: mesh.clone(), before: before.clone(), since });
        true
    }

    /// Gives up.
    pub fn cancel(&mut self) {
        self.wanted = None;
    }

    /// What is on its way.
    pub fn progress(&self) -> Option<Progress> {
        let Wanted { body, mesh, since, .. } = self.wanted.as_ref()?;
        let (triangles, seconds) = (triangles(mesh) as usize, since.elapsed().as_secs_f64());
        Some(Progress { body: *body, mesh: mesh.clone(), triangles, seconds })
    }

    /// Looks whether the wanted mesh is ready, and begins to make it once the slider is `released`. `now` finds the body that a
    /// request is for; another one there makes the request void.
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
            // Whoever asked may be gone.
            let _ = sender.send(body);
        };
        #[cfg(not(target_arch = "wasm32"))]
        std::thread::spawn(work);
        #[cfg(target_arch = "wasm32")]
        work();
        Self { mesh: wanted.mesh.clone(), result }
    }
}

/// About how many triangles a recipe gives, as far as its numbers tell.
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
