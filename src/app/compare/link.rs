//! Translates commands between two panes whose meshes may differ.

use crate::{command::Command, sandbox::Sandbox, study::counterpart, untangle::Tangle};

/// Commands for `to` that correspond to a command that `from` is about to apply.
pub fn twins(command: &Command, from: &Sandbox, to: &Sandbox) -> Vec<Command> {
    let (here, there) = (from.simulation().scene(), to.simulation().scene());
    match *command {
        Command::Grab(vertex, target) => {
            counterpart(here, there, vertex).map(|vertex| Command::Grab(vertex, target)).into_iter().collect()
        }
        // A pinned vertex is freed in `to` at every pin whose nearest vertex in `from` is this one. A free vertex is pinned once.
        Command::TogglePin(vertex) if here.pins.contains(&(vertex as u32)) => {
            let pins = there.pins.iter().map(|pin| *pin as usize);
            pins.filter(|pin| counterpart(there, here, *pin) == Some(vertex)).map(Command::TogglePin).collect()
        }
        Command::TogglePin(vertex) => {
            let twin = counterpart(here, there, vertex).filter(|twin| !there.pins.contains(&(*twin as u32)));
            twin.map(Command::TogglePin).into_iter().collect()
        }
        Command::SetMaterial(body, material) => {
            let model = to.shown.bodies.get(body).map_or(material.model(), |body| body.material.model());
            vec![Command::SetMaterial(body, material.with_model(model))]
        }
        // It is possible that only one of the two panes has inverted triangles or folds.
        Command::Untangle if !Tangle::of_all(there, &to.simulation().state().x).is_some() => Vec::new(),
        ref same => vec![same.clone()],
    }
}
