from os import PathLike
from typing import Any, Sequence

import numpy as np
from numpy.typing import NDArray

def built_in_levels() -> list[str]:
    """Names of the built-in levels."""

def picture(
    level: Level, *, width: int = 480, height: int = 480, dark: bool = False, wireframe: bool = False
) -> NDArray[np.uint8]:
    """A picture of a level at its start or where it was saved: rows, columns, and red, green and blue."""

def work_precision(
    level: Level, seconds: float, integrators: Sequence[str] | None = None
) -> list[dict[str, float | str | None]]:
    """Error against cost: each integrator with a ladder of steps or tolerances, against a reference."""

def work_precision_csv(level: Level, seconds: float, integrators: Sequence[str] | None = None) -> str:
    """The same as the text of a table."""

class Level:
    """A level: bodies, nets, membranes, effects and settings. It does not change."""

    def __init__(self, path: str | PathLike[str]) -> None:
        """A level from a file, by the name of a built-in one, or from a link."""
    @staticmethod
    def from_text(text: str) -> Level:
        """A level from the text of a file."""
    @staticmethod
    def from_dict(level: dict[str, Any]) -> Level:
        """A level from a dictionary with the names of the level format."""
    def to_dict(self) -> dict[str, Any]:
        """The level as a dictionary with the names of the level format."""
    def to_text(self) -> str:
        """The text of a file of the level."""
    def to_link(self) -> str:
        """A link to the level, to follow the address of a page."""
    def save(self, path: str | PathLike[str]) -> None:
        """Saves the level."""
    def replace(
        self,
        *,
        model: str | None = None,
        integrator: str | None = None,
        step: float | None = None,
        mode: str | None = None,
    ) -> Level:
        """The level with another constitutive model, integrator, longest step [s], or mode ("Simulate" or "Collide")."""
    @property
    def name(self) -> str:
        """Its name."""

class Simulation:
    """A running level. Vertices and triangles have the order of the level."""

    def __init__(self, level: Level) -> None:
        """Builds a level and begins at its start, or where it was saved."""
    def step(self, steps: int = 1) -> int:
        """Takes so many steps; returns how many were taken, which are fewer where time has stopped with a fault."""
    def run_for(self, seconds: float) -> int:
        """Takes the steps of a time [s]; returns how many were taken."""
    @property
    def time(self) -> float:
        """Simulated time [s]."""
    @property
    def steps(self) -> int:
        """Number of steps since the start."""
    @property
    def dt(self) -> float:
        """Length of a step [s]."""
    @property
    def critical_step(self) -> float | None:
        """The longest stable step of symplectic Euler in the present state [s]; None where nothing limits it."""
    @property
    def positions(self) -> NDArray[np.float64]:
        """Positions [m]: a row for each vertex, or the numbers of a toy. The array is a copy."""
    @property
    def velocities(self) -> NDArray[np.float64]:
        """Velocities [m/s]: a row for each vertex. The array is a copy."""
    @property
    def masses(self) -> NDArray[np.float64]:
        """Masses of the vertices [kg]."""
    @property
    def triangles(self) -> NDArray[np.int64]:
        """Corners of all triangles of bodies and membranes, by the numbers of the vertices: a row for each triangle."""
    @property
    def energies(self) -> dict[str, float]:
        """Energies [J] by kind, and their sum as "total"."""
    def probe(self, probe: str) -> dict[str, float]:
        """Numbers of a probe by their names, such as those of "energy", "momentum", "vertex:12" or "triangle:7"."""
    @property
    def fault(self) -> str | None:
        """Why time has stopped, or None."""
    @property
    def state_hash(self) -> str:
        """Hash of positions, velocities and time: equal hashes are equal bits."""
    def pull(self, vertex: int, target: Sequence[float]) -> None:
        """Pulls a vertex towards a point [m] with the mouse spring of the level."""
    def release(self) -> None:
        """Ends the pull."""
    def saved(self) -> Level:
        """The level with the present state: a simulation of it goes on to the same bits."""
