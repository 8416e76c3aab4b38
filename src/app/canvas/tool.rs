//! Tools: what a click or a drag on the stage does.

/// What a click or a drag on the stage does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// In edit mode a click pins or frees a vertex. In the other modes a drag pulls one.
    #[default]
    Hand,
    /// A drag pushes what is near where it begins, in the direction of the drag.
    Push,
    /// A click blows apart what is near.
    Burst,
    /// A click probes.
    Probe,
    /// Draws the outline of a body.
    Outline,
    /// A drag pins or frees all vertices in a box.
    PinBox,
    /// A drag pins or frees all vertices inside a line.
    PinLine,
    /// Clicks or a drag place the points of a ruler.
    Ruler,
    /// A click or a drag divides triangles.
    Refine,
    /// A click places a note.
    Note,
    /// A drag prescribes the path of a vertex.
    DrawnPath,
    /// A click chooses a body, a cloth or an obstacle; drags of it and of its handles move, turn and scale it.
    Arrange,
}

impl Tool {
    /// The tools in the menu on the stage.
    pub const CHOICES: [Self; 11] = [
        Self::Hand,
        Self::Push,
        Self::Burst,
        Self::Probe,
        Self::Ruler,
        Self::Note,
        Self::Arrange,
        Self::PinBox,
        Self::PinLine,
        Self::DrawnPath,
        Self::Refine,
    ];

    /// Its name in the menu.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hand => "Hand",
            Self::Push => "Push",
            Self::Burst => "Burst",
            Self::Probe => "Probe",
            Self::Outline => "Draw",
            Self::PinBox => "Pin in a box",
            Self::PinLine => "Pin inside a line",
            Self::Ruler => "Ruler",
            Self::Refine => "Refine",
            Self::Note => "Note",
            Self::DrawnPath => "Move along a path",
            Self::Arrange => "Arrange",
        }
    }

    /// What it does.
    pub const fn about(self) -> &'static str {
        match self {
            Self::Hand => "In edit mode a click pins or frees a vertex. While time runs a drag pulls one.",
            Self::Push => {
                "Drag to push what is near where you press, in the direction of the drag, however long it is. [Arrows]"
            }
            Self::Burst => "A click blows apart what is near. [X]",
            Self::Probe => "The next click probes a vertex or a triangle; then the hand is back. [P]",
            Self::Outline => "Draws the outline of a body.",
            Self::PinBox => {
                "Drag a box: pins the vertices in it, or frees them if all are pinned. [Shift+drag in edit mode]"
            }
            Self::PinLine => "Draw a line: pins the vertices inside, or frees them if all are pinned.",
            Self::Ruler => "Measures distances and angles.",
            Self::Refine => "Divides triangles into smaller ones; the scene goes on as it is.",
            Self::DrawnPath => {
                "Drag a vertex: from now on it is held, and follows the path of the drag at the same speed. If it is pinned, all pins of its body move with it."
            }
            Self::Arrange => {
                "Moves, turns and scales bodies, cloth and obstacles by handles. With a body or a cloth the scene starts over; its pinned vertices stay pinned. With an obstacle it goes on."
            }
            Self::Note => {
                "The next click places a note, which is saved with the level. A note on a vertex moves with it."
            }
        }
    }

    /// What to do with it, shown on the stage.
    pub const fn hint(self) -> Option<&'static str> {
        match self {
            Self::Hand | Self::Probe => None,
            Self::Push => {
                Some("Drag to push what is near, in the direction of the drag. Nothing moves in edit mode. Esc ends.")
            }
            Self::Burst => Some("Click to blow apart what is near. Nothing moves in edit mode. Esc ends."),
            Self::Outline => Some(
                "Draw a closed line, or click corner after corner. The first corner or Enter ends the outline; Esc cancels.",
            ),
            Self::PinBox => Some("Draw a box around vertices: they are pinned, or freed if all are pinned. Esc ends."),
            Self::PinLine => {
                Some("Draw a line around vertices: they are pinned, or freed if all are pinned. Esc ends.")
            }
            Self::Ruler => Some(
                "Drag, or click two points. A third click adds the angle at the second. A point on a vertex moves with it. Esc ends.",
            ),
            Self::DrawnPath => Some(
                "Drag a vertex: from now on it follows that path at the same speed. If it is pinned, all pins of its body move with it. Esc ends.",
            ),
            Self::Arrange => Some(
                "Click a body, a cloth or an obstacle, then drag it, a corner to scale it, or the handle above to turn it (Shift: in steps of 15°). In space arrows move along an axis. Esc ends.",
            ),
            Self::Note => Some(
                "Click where the note should be. A note on a vertex moves with it. Its text is in the right panel. Esc ends.",
            ),
            Self::Refine => Some(
                "Click a triangle, or drag over some: each is divided into four, and neighbours as needed. Esc ends.",
            ),
        }
    }
}
