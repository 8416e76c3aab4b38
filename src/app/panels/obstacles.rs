//! Obstacles of an effect: added, copied, moved by numbers, and removed.

use super::{View, apply_response, widgets};
use crate::{
    app::language::tr,
    command::Command,
    level::EffectLevel,
    obstacles::{ObstacleKind, Similarity, placed},
    quantity::{Coordinate, Reach},
    snapshot::Snapshot,
};
use eframe::egui::{Align, Layout, RichText, Ui};

/// Distance of a copy or a new obstacle from all that is there, as a share of the size of the scene.
const APART: f64 = 0.1;

/// A change of the list of obstacles.
enum Change {
    Remove(usize),
    Copy(usize),
    Add(ObstacleKind),
}

/// Draws the obstacles of an effect that can have some, in a section that is closed at first.
pub fn show(
    ui: &mut Ui,
    (index, effect): (usize, &EffectLevel),
    now: &Snapshot,
    view: &mut View,
    commands: &mut Vec<Command>,
) {
    let mut changed = effect.clone();
    let Some(obstacles) = changed.effect.kind_mut().obstacles_mut() else { return };
    let mut outcome = widgets::SliderResponse::default();
    let list = |ui: &mut Ui| {
        let mut change = None;
        for (number, title) in ObstacleKind::titles(obstacles).iter().enumerate() {
            ui.horizontal(|ui| {
                ui.label(RichText::new(title).small());
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    let remove = ui.small_button(tr("Remove")).on_hover_text(tr("Removes the obstacle."));
                    if remove.accessible_name(format!("Remove {title}")).clicked() {
                        change = Some(Change::Remove(number));
                    }
                    if obstacles.get(number).is_some_and(|kind| !kind.is_endless()) {
                        let copy =
                            ui.small_button(tr("Copy")).on_hover_text(tr("Adds a copy on the right of everything."));
                        if copy.accessible_name(format!("Copy {title}")).clicked() {
                            change = Some(Change::Copy(number));
                        }
                    }
                });
            });
            if let Some(obstacle) = obstacles.get_mut(number) {
                place(ui, (title, obstacle), now.dimension, &mut outcome);
            }
        }
        ui.menu_button(tr("Add an obstacle"), |ui| {
            let is_offered =
                |kind: &ObstacleKind| kind.kind().dimension() == now.dimension && kind.kind().path().is_none();
            for kind in ObstacleKind::all().into_iter().filter(is_offered) {
                if ui.button(tr(&kind.title())).clicked() {
                    change = Some(Change::Add(kind));
                }
            }
        });
        change
    };
    let section = ui.indent("obstacles", |ui| ui.collapsing(tr("Arrange obstacles"), list)).inner;
    let help = "Where the obstacles are. The tool Arrange moves and scales those that have an end by hand, and turns them in flat scenes.";
    section.header_response.on_hover_text(tr(help));
    let change = section.body_returned.flatten();
    let ends = change.is_some();
    match change {
        Some(Change::Remove(number)) => drop(obstacles.remove(number)),
        Some(Change::Copy(number)) => {
            let copy = obstacles.get(number).and_then(|kind| beside(kind, now));
            obstacles.extend(copy);
        }
        Some(Change::Add(kind)) => obstacles.push(fitted(&kind, now).unwrap_or(kind)),
        None => {}
    }
    outcome.changed |= ends;
    outcome.ended |= ends;
    apply_response(outcome, Some(Command::SetEffect(index, changed)), view, commands);
}

/// Draws the coordinates of an obstacle.
fn place(
    ui: &mut Ui,
    (title, obstacle): (&str, &mut ObstacleKind),
    dimension: usize,
    outcome: &mut widgets::SliderResponse,
) {
    let (at, spec) = (obstacle.kind().place(), &Coordinate::SPEC);
    for (axis, letter) in ["x", "y", "z"].into_iter().enumerate().take(dimension) {
        let (name, help) = (format!("{title}: {letter}"), format!("{}\nAllowed: {}.", spec.help.trim(), spec.range()));
        let options = widgets::SliderOptions {
            name: &name,
            unit: spec.unit,
            range: spec.slider,
            logarithmic: spec.logarithmic,
            help: &help,
        };
        let Some(typed) = widgets::typed_as(ui, letter, &options, at[axis], outcome) else { continue };
        let mut to = at;
        to[axis] = typed;
        match obstacle.arranged(&Similarity { from: at, to, ..Similarity::NONE }) {
            Some(arranged) => (*obstacle, outcome.changed) = (arranged, true),
            None => outcome.refused = Some(format!("{name}: allowed are {}", spec.range())),
        }
    }
}

/// Least and greatest coordinates \[m\].
type Extents = [[f64; 2]; 3];

/// Those of some points; `None` if there are none.
fn extents(points: impl Iterator<Item = [f64; 3]>) -> Option<Extents> {
    let around = |all: Option<Extents>, point: [f64; 3]| {
        let all = all.unwrap_or(point.map(|along| [along, along]));
        Some([0, 1, 2].map(|axis| [all[axis][0].min(point[axis]), all[axis][1].max(point[axis])]))
    };
    points.fold(None, around)
}

/// Extents of an obstacle as it is now; `None` for one without an end.
fn extents_of(kind: &ObstacleKind, now: &Snapshot) -> Option<Extents> {
    if kind.kind().dimension() == 2 {
        return extents(kind.outline_at(now.time).into_iter().map(|[x, y]| [x, y, 0.0]));
    }
    let surface = kind.kind().triangulation(&now.elements.surfaces).moved(&placed(&kind.kind().motions(), now.time));
    surface.endless_about.is_none().then(|| extents(surface.points.into_iter()))?
}

/// Size of what can move \[m\]; 1 m if there is nothing.
fn size(now: &Snapshot) -> f64 {
    let all = extents(vertices(now)).unwrap_or_default();
    let size = all.iter().map(|[least, greatest]| greatest - least).fold(0.0, f64::max);
    if size > 0.0 { size } else { 1.0 }
}

fn vertices(now: &Snapshot) -> impl Iterator<Item = [f64; 3]> {
    let along = |point: &[f64], axis: usize| point.get(axis).copied().unwrap_or(0.0);
    now.positions.chunks_exact(now.dimension).map(move |point| [0, 1, 2].map(|axis| along(point, axis)))
}

/// Extents of everything that is there now: vertices, and obstacles that have an end.
fn everything(now: &Snapshot) -> Extents {
    let corners = |[x, y, z]: Extents| [[x[0], y[0], z[0]], [x[1], y[1], z[1]]];
    let obstacles = now.level.effects.iter().flat_map(|effect| effect.effect.kind().obstacles());
    let obstacles = obstacles.filter_map(|kind| extents_of(kind, now)).flat_map(corners);
    extents(vertices(now).chain(obstacles)).unwrap_or_default()
}

/// An obstacle on the right of everything, or a plane below it; `None` if a number would leave its range.
fn beside(kind: &ObstacleKind, now: &Snapshot) -> Option<ObstacleKind> {
    let (all, apart) = (everything(now), APART * size(now));
    let [[_, right], [low, _], _] = all;
    let middle = |[least, greatest]: [f64; 2]| 0.5 * (least + greatest);
    let (from, to) = match extents_of(kind, now) {
        Some([x, y, z]) => ([x[0], middle(y), middle(z)], [right + apart, middle(all[1]), middle(all[2])]),
        None => (kind.kind().place(), [middle(all[0]), low - apart, middle(all[2])]),
    };
    kind.arranged(&Similarity { from, to, ..Similarity::NONE })
}

/// A new obstacle beside everything, with a size and a contact margin in proportion to it.
fn fitted(kind: &ObstacleKind, now: &Snapshot) -> Option<ObstacleKind> {
    let size = size(now);
    let mut fitted = kind.arranged(&Similarity { scale: size, ..Similarity::NONE })?;
    for number in fitted.kind_mut().parameters() {
        if number.spec().name == Reach::SPEC.name {
            number.set(size * number.get()).ok()?;
        }
    }
    beside(&fitted, now)
}
