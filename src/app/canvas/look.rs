//! From where the stage is seen: the gestures, buttons and keys that turn, move and zoom.

use super::Tool;
use crate::{
    app::draw::{
        Camera, Zoom,
        space::{Orbit, SpaceCamera},
    },
    app::language::tr,
    link,
    snapshot::Snapshot,
};
use eframe::egui::{
    Align2, Area, Button, Order, PointerButton, Pos2, Rect, Response, Ui, Vec2, containers::menu::MenuButton, vec2,
};
use std::{f64::consts::FRAC_PI_2, ops::Range};

/// A change of the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Look {
    /// Closer by a factor, about the pointer or the middle.
    Closer(f64),
    /// The whole scene.
    All,
    /// The part under the pointer, or all parts, as large as possible.
    Part,
    /// The whole of a scene in space, from other angles \[rad\].
    Angles([f64; 2]),
    /// From there, if the scene has as many dimensions.
    From(link::Camera),
}

impl Look {
    /// Closer by one press of a key or button.
    pub const CLOSER: Self = Self::Closer(1.25);
    /// Back by the same.
    pub const FARTHER: Self = Self::Closer(0.8);
}

/// From where a scene is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Viewpoint {
    /// View of a scene in space, and the generation that it was chosen for.
    pub(super) orbit: Option<(u64, Orbit)>,
    /// Part of a scene in the plane; the whole scene without it.
    pub(super) zoom: Option<Zoom>,
}

impl Viewpoint {
    /// As a camera for a link; `None` if the whole of a scene in the plane is seen.
    pub fn camera(&self, dimension: usize) -> Option<link::Camera> {
        if dimension == 2 {
            return self.zoom.map(|zoom| link::Camera::Plane(zoom.centre, zoom.factor));
        }
        self.orbit.map(|(_, orbit)| link::Camera::Space(orbit.centre, orbit.radius, [orbit.yaw, orbit.pitch]))
    }
}

/// The view of a stage.
#[derive(Default)]
pub struct Looking {
    viewpoint: Viewpoint,
    /// Name of the level that is seen.
    level: Option<String>,
    /// Radius with which the scene in space opens \[m\].
    opening_radius: f64,
    /// Changes that wait for the next frame.
    looks: Vec<Look>,
    /// Whether it was changed in the last frame.
    changed: bool,
    /// Tool that was chosen by the buttons.
    tool: Option<Tool>,
}

/// The scene that is seen.
#[derive(Clone, Copy)]
pub struct Seen<'a> {
    pub snapshot: &'a Snapshot,
    /// The part under the pointer, by its vertices.
    pub part: Option<&'a Range<usize>>,
    /// Whether the stage has no buttons.
    pub bare: bool,
    /// The tool that is taken.
    pub tool: Tool,
}

/// Gestures of a frame.
struct Gestures {
    /// Factor of a zoom, and where.
    zoom: f64,
    at: Pos2,
    /// Move of the scene [points].
    moved: Vec2,
    /// Turn of a scene in space [points].
    turned: Vec2,
}

impl Gestures {
    /// In the plane the right button moves as the middle one does.
    fn new(ui: &Ui, response: &Response, dimension: usize) -> Self {
        let (shift, pinch, wheel, fingers) = ui.input(|input| {
            let wheel = f64::from(input.smooth_scroll_delta().y);
            (input.modifiers.shift, f64::from(input.zoom_delta()), wheel, input.multi_touch())
        });
        let by = response.drag_delta();
        let right = response.dragged_by(PointerButton::Secondary);
        let moves = response.dragged_by(PointerButton::Middle) || right && (shift || dimension == 2);
        let hovered = response.contains_pointer();
        let fingers = fingers.filter(|_| hovered).map_or(Vec2::ZERO, |fingers| fingers.translation_delta);
        Self {
            zoom: if hovered { pinch * libm::exp(0.002 * wheel) } else { 1.0 },
            at: response.hover_pos().unwrap_or_else(|| response.rect.center()),
            moved: if moves { by + fingers } else { fingers },
            turned: if right && !moves { by } else { Vec2::ZERO },
        }
    }
}

impl Looking {
    /// From where the scene is seen.
    pub const fn viewpoint(&self) -> Viewpoint {
        self.viewpoint
    }

    /// Sees it from another viewpoint.
    pub const fn see_from(&mut self, viewpoint: Viewpoint) {
        self.viewpoint = viewpoint;
    }

    /// The tool that was chosen by the buttons since the last call.
    pub const fn take_tool(&mut self) -> Option<Tool> {
        self.tool.take()
    }

    /// Changes the view in the next frame.
    pub fn ask(&mut self, look: Look) {
        self.looks.push(look);
    }

    /// Makes two stages show their scenes from the same viewpoint, if one was changed.
    pub fn share(&mut self, other: &mut Self) {
        let (from, to) = if other.changed { (&*other, self) } else { (&*self, other) };
        if from.changed {
            to.viewpoint.zoom = from.viewpoint.zoom;
            if let (Some((_, seen)), Some((_, own))) = (from.viewpoint.orbit, &mut to.viewpoint.orbit) {
                *own = seen;
            }
        }
    }

    /// The camera of a scene in the plane as it is seen now; `home` is that of the whole scene.
    pub fn plane(&self, home: Camera, canvas: Rect) -> Camera {
        self.viewpoint.zoom.map_or(home, |zoom| home.zoomed(canvas, zoom))
    }

    /// The same after the gestures of this frame: a drag of the middle or the right button moves, the wheel or a pinch zooms.
    pub fn follow_plane(&mut self, ui: &Ui, response: &Response, scene: Seen<'_>, home: Camera) -> Camera {
        let canvas = response.rect;
        if self.level.as_ref() != Some(&scene.snapshot.level.name) {
            let is_other = self.level.replace(scene.snapshot.level.name.clone()).is_some();
            self.viewpoint.zoom = self.viewpoint.zoom.filter(|_| !is_other);
        }
        let before = self.viewpoint.zoom;
        let gestures = Gestures::new(ui, response, 2);
        let mut looks = std::mem::take(&mut self.looks);
        if !scene.bare {
            let (look, tool) = buttons(ui, response, scene, &[]);
            looks.extend(look);
            self.tool = tool.or(self.tool);
        }
        let home_zoom = Zoom { centre: home.world_from_screen(canvas.center()), factor: 1.0 };
        let mut zoom = before.unwrap_or(home_zoom);
        let [least, most] = limits(scene.snapshot, home, canvas);
        let closer = |zoom: &mut Zoom, by: f64, at: Pos2| {
            let fixed = home.zoomed(canvas, *zoom).world_from_screen(at);
            zoom.factor = (zoom.factor * by).clamp(least, most);
            let moved = home.zoomed(canvas, *zoom).world_from_screen(at);
            zoom.centre = [0, 1].map(|axis| zoom.centre[axis] + fixed[axis] - moved[axis]);
        };
        if gestures.zoom != 1.0 {
            closer(&mut zoom, gestures.zoom, gestures.at);
        }
        if gestures.moved != Vec2::ZERO {
            zoom.centre = home.zoomed(canvas, zoom).world_from_screen(canvas.center() - gestures.moved);
        }
        for look in looks {
            match look {
                Look::Closer(by) => closer(&mut zoom, by, response.hover_pos().unwrap_or_else(|| canvas.center())),
                Look::All => zoom = home_zoom,
                Look::Part => {
                    let points = part_of(scene);
                    zoom = fitted(points, home, canvas)
                        .map_or(zoom, |zoom| Zoom { factor: zoom.factor.clamp(least, most), ..zoom });
                }
                Look::From(link::Camera::Plane(centre, factor)) => {
                    zoom = Zoom { centre, factor: factor.clamp(least, most) };
                }
                Look::Angles(_) | Look::From(link::Camera::Space(..)) => {}
            }
        }
        self.viewpoint.zoom = (zoom != home_zoom).then_some(zoom);
        self.changed = self.viewpoint.zoom != before;
        self.plane(home, canvas)
    }

    /// The camera of a scene in space, after the gestures of this frame: a drag of the right button turns, one of the middle button or with
    /// Shift moves, and the wheel or a pinch zooms.
    pub fn follow_space(&mut self, ui: &Ui, response: &Response, scene: Seen<'_>) -> SpaceCamera {
        let (canvas, snapshot) = (response.rect, scene.snapshot);
        let all = || Orbit::opening(&snapshot.start);
        let before = self.viewpoint.orbit;
        let known = self.viewpoint.orbit.filter(|(generation, _)| *generation == snapshot.generation);
        let (_, orbit) = self.viewpoint.orbit.insert(known.unwrap_or_else(|| {
            let opening = all();
            let is_same_level = self.level.as_ref() == Some(&snapshot.level.name);
            // What is put elsewhere in a level stays seen from where it was.
            let stays = is_same_level && (0.5..=2.0).contains(&(opening.radius / self.opening_radius));
            self.level = Some(snapshot.level.name.clone());
            self.opening_radius = opening.radius;
            let orbit = before.map_or(opening, |(_, seen)| {
                // Another size does not turn the view.
                if stays { seen } else { Orbit { yaw: seen.yaw, pitch: seen.pitch, ..opening } }
            });
            (snapshot.generation, orbit)
        }));
        let gestures = Gestures::new(ui, response, 3);
        if gestures.moved != Vec2::ZERO {
            let moved = SpaceCamera::new(*orbit, canvas).moved(gestures.moved);
            orbit.centre = [0, 1, 2].map(|axis| orbit.centre[axis] - moved[axis]);
        }
        orbit.turn(gestures.turned);
        let closer = |orbit: &mut Orbit, by: f64| {
            let whole = all().radius;
            orbit.radius = (orbit.radius / by).clamp(1e-3 * whole, 1e3 * whole);
        };
        if gestures.zoom != 1.0 {
            closer(orbit, gestures.zoom);
        }
        let mut looks = std::mem::take(&mut self.looks);
        if !scene.bare {
            let (look, tool) = buttons(ui, response, scene, &ANGLES);
            looks.extend(look);
            self.tool = tool.or(self.tool);
        }
        for look in looks {
            let angles = [orbit.yaw, orbit.pitch];
            match look {
                Look::Closer(by) => closer(orbit, by),
                Look::All => *orbit = Orbit::around(&snapshot.positions, angles),
                Look::Part => *orbit = Orbit::around(part_of(scene), angles),
                Look::Angles(angles) => *orbit = Orbit::around(&snapshot.positions, angles),
                Look::From(link::Camera::Space(centre, radius, [yaw, pitch])) => {
                    *orbit = Orbit { centre, radius, yaw, pitch: pitch.clamp(-FRAC_PI_2, FRAC_PI_2) };
                    closer(orbit, 1.0);
                }
                Look::From(link::Camera::Plane(..)) => {}
            }
        }
        let orbit = *orbit;
        self.changed = self.viewpoint.orbit != before;
        SpaceCamera::new(orbit, canvas)
    }
}

/// Coordinates of the part that is meant, or of all.
fn part_of(scene: Seen<'_>) -> &[f64] {
    let (all, dimension) = (&scene.snapshot.positions, scene.snapshot.dimension);
    let own = scene.part.and_then(|part| all.get(dimension * part.start..dimension * part.end));
    own.unwrap_or(all)
}

/// Least and greatest corner of points in the plane \[m\], if there are any.
fn bounds(points: &[f64]) -> Option<[[f64; 2]; 2]> {
    let along = |axis: usize| points.iter().skip(axis).step_by(2).copied();
    let least = [0, 1].map(|axis| along(axis).fold(f64::INFINITY, f64::min));
    let greatest = [0, 1].map(|axis| along(axis).fold(f64::NEG_INFINITY, f64::max));
    least.iter().chain(&greatest).all(|number| number.is_finite()).then_some([least, greatest])
}

/// A view of points in the plane that fills most of the stage.
fn fitted(points: &[f64], home: Camera, canvas: Rect) -> Option<Zoom> {
    const FILLED: f64 = 0.8;
    let [least, greatest] = bounds(points)?;
    let [width, height] = [0, 1].map(|axis| (greatest[axis] - least[axis]).max(f64::MIN_POSITIVE));
    let scale = (f64::from(canvas.width()) / width).min(f64::from(canvas.height()) / height);
    let centre = [0, 1].map(|axis| 0.5 * (least[axis] + greatest[axis]));
    Some(Zoom { centre, factor: FILLED * scale / home.scale() })
}

/// Least and greatest zoom: from far outside of the world to a small part of the smallest body.
fn limits(snapshot: &Snapshot, home: Camera, canvas: Rect) -> [f64; 2] {
    let parts = snapshot.bodies.iter().map(|body| &body.vertices).chain(snapshot.nets.iter().map(|net| &net.vertices));
    let start = |vertices: &Range<usize>| snapshot.start.get(2 * vertices.start..2 * vertices.end);
    let fits = parts.filter_map(|vertices| fitted(start(vertices)?, home, canvas));
    let closest = fits.map(|zoom| zoom.factor).filter(|factor| factor.is_finite()).fold(1.0, f64::max);
    [0.05, (100.0 * closest).min(1e12)]
}

/// Views of a scene in space: name, tip, angles \[rad\].
const ANGLES: [(&str, &str, Look); 3] = {
    [
        ("Front", "Look along the z axis.", Look::Angles([0.0, 0.0])),
        ("Side", "Look along the x axis.", Look::Angles([FRAC_PI_2, 0.0])),
        ("Top", "Look down.", Look::Angles([0.0, FRAC_PI_2])),
    ]
};

/// Draws the buttons of the view, after some others, and returns what was clicked.
fn buttons(
    ui: &Ui,
    response: &Response,
    scene: Seen<'_>,
    others: &[(&str, &str, Look)],
) -> (Option<Look>, Option<Tool>) {
    let in_space = !others.is_empty();
    let help = if in_space {
        "Drag with the right button to turn, with the middle button or Shift to move; zoom with the wheel."
    } else {
        "Drag with the right or the middle button to move; zoom with the wheel. Z shows what is under the pointer."
    };
    let place = response.rect.right_top() + vec2(-10.0, 10.0);
    let area = Area::new(response.id.with("views")).order(Order::Middle).pivot(Align2::RIGHT_TOP).fixed_pos(place);
    let zooms = [
        ("−", "Zoom out", "[-]", Look::FARTHER),
        ("+", "Zoom in", "[+]", Look::CLOSER),
        ("See all", "See all", "Show the whole scene. [0]", Look::All),
    ];
    let shown = area.constrain_to(response.rect).show(ui.ctx(), |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let (tool, mut clicked) = (tools(ui, scene), None);
            let others = others.iter().map(|(name, about, look)| (*name, *name, *about, *look));
            for (text, name, about, look) in others.chain(zooms) {
                let button = ui
                    .small_button(tr(text))
                    .on_hover_text(format!("{}\n{}", tr(about), tr(help)))
                    .accessible_name(tr(name));
                clicked = button.clicked().then_some(look).or(clicked);
            }
            (clicked, tool)
        })
        .inner
    });
    shown.inner
}

/// Shows the menu of tools. Returns the one that is chosen.
fn tools(ui: &mut Ui, Seen { snapshot, tool, .. }: Seen<'_>) -> Option<Tool> {
    if snapshot.toy.is_some() {
        return None;
    }
    let mut chosen = None;
    let (button, _) = MenuButton::from_button(Button::new(tr(tool.name())).small()).ui(ui, |ui| {
        let can_arrange = snapshot.level.test.is_none();
        for other in Tool::CHOICES.into_iter().filter(|other| *other != Tool::Arrange || can_arrange) {
            if ui.selectable_label(other == tool, tr(other.name())).on_hover_text(tr(other.about())).clicked() {
                chosen = Some(other);
            }
        }
    });
    button
        .on_hover_text(tr("What a click or a drag on the stage does. [Esc takes the hand again]"))
        .accessible_name(tr("Tool"));
    chosen
}
