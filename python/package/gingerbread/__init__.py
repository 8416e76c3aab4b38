"""Deformable bodies in the plane and cloth in space, and what accuracy costs.

>>> import gingerbread
>>> simulation = gingerbread.Simulation(gingerbread.Level("gingerbread"))
>>> simulation.step(600)
600
>>> simulation.positions.shape == (len(simulation.masses), 2)
True
"""

import csv as _csv

from ._gingerbread import Level, Simulation, built_in_levels, picture, work_precision_csv

__all__ = ["Level", "Simulation", "built_in_levels", "picture", "work_precision", "work_precision_csv"]


def work_precision(level, seconds, integrators=None):
    """Error against cost: each integrator with a ladder of steps or tolerances, against a reference.

    Returns a list with a dictionary for each run; its names are those of the table that
    ``gingerbread study --csv`` writes. Numbers are numbers, and what is missing is ``None``.
    """
    text = work_precision_csv(level, seconds, integrators)
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    return [{name: _value(value) for name, value in row.items()} for row in _csv.DictReader(lines)]


def _value(text):
    if not text:
        return None
    try:
        return float(text)
    except ValueError:
        return text
