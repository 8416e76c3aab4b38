"""Tests of the package, where it is installed: examples, hashes of states, errors, and the notebook."""

import doctest
import json
import pathlib
import tempfile
import threading

import gingerbread
import numpy as np

HERE = pathlib.Path(__file__).parent


def examples_hold():
    for failed, tried in [
        doctest.testfile(str(HERE / "README.md"), module_relative=False),
        doctest.testmod(gingerbread),
    ]:
        assert tried > 0 and failed == 0, f"{failed} of {tried} examples failed"


def states_are_those_of_the_program():
    """The record has the hash of each level in each mode after 2 s; large ones take long."""
    checked = 0
    for line in (HERE / "../tests/level_hashes.txt").read_text().splitlines():
        name, mode, expected = line.split()
        name = name.removesuffix(".ron")
        if name in SMALL:
            level = gingerbread.Level(name).replace(mode=mode.capitalize())
            simulation = gingerbread.Simulation(level)
            simulation.run_for(2.0)
            assert simulation.state_hash == expected, line
            checked += 1
    assert checked == 2 * len(SMALL), checked


SMALL = ["chain", "gingerbread", "gingerbread_house", "jelly_disk", "pendulum"]


def every_level_has_its_shape():
    for name in gingerbread.built_in_levels():
        level = gingerbread.Level(name)
        simulation = gingerbread.Simulation(level)
        positions, velocities = simulation.positions, simulation.velocities
        assert np.isfinite(positions).all() and np.isfinite(velocities).all(), name
        if positions.ndim == 2:
            assert positions.shape == velocities.shape and len(simulation.masses) == len(positions), name
            assert positions.shape[1] in (2, 3), name
            corners = simulation.triangles
            assert corners.shape[1] == 3 and (corners.size == 0 or corners.max() < len(positions)), name
        assert gingerbread.Level.from_dict(level.to_dict()) == level, name
        assert gingerbread.Level.from_text(level.to_text()) == level, name


def arrays_do_not_change():
    simulation = gingerbread.Simulation(gingerbread.Level("gingerbread_pulled"))
    before = simulation.positions
    copy = before.copy()
    simulation.step(100)
    assert (before == copy).all() and (simulation.positions != copy).any()


def a_probe_is_the_position_of_its_vertex():
    simulation = gingerbread.Simulation(gingerbread.Level("gingerbread_pulled"))
    simulation.step(100)
    for vertex in (0, 17, len(simulation.masses) - 1):
        probe = simulation.probe(f"vertex:{vertex}")
        assert [probe[f"vertex_{vertex}_x"], probe[f"vertex_{vertex}_y"]] == simulation.positions[vertex].tolist()
    assert simulation.probe("energy")["energy"] == simulation.energies["total"]


def a_pull_moves_its_vertex():
    simulation = gingerbread.Simulation(gingerbread.Level("gingerbread"))
    start = simulation.positions
    simulation.pull(3, (start[3] + 0.2).tolist())
    simulation.run_for(0.5)
    moved = np.linalg.norm(simulation.positions - start, axis=1)
    assert moved[3] > 0.1, moved[3]
    simulation.release()


def errors_name_their_place():
    level = gingerbread.Level("gingerbread")
    simulation = gingerbread.Simulation(level)
    for wanted, act in [
        ("there is no such file", lambda: gingerbread.Level("no_such_level")),
        ("level:1:", lambda: gingerbread.Level.from_text('(name: "a", bodys: [])')),
        ("bodys", lambda: gingerbread.Level.from_dict({"name": "a", "bodys": []})),
        ("bodies[0].material: Poisson's ratio", lambda: gingerbread.Level.from_dict(wrong_poisson(level))),
        ("model: expected one of", lambda: level.replace(model="Rubber")),
        ("integrator: expected one of", lambda: level.replace(integrator="Euler")),
        ("step: expected", lambda: level.replace(step=1.0)),
        ("mode: expected", lambda: level.replace(mode="Edit")),
        ("seconds", lambda: simulation.run_for(float("nan"))),
        ("vertex: expected", lambda: simulation.pull(10**6, [0.0, 0.0])),
        ("target: expected", lambda: simulation.pull(0, [0.0, 0.0, 0.0])),
        ("its vertices are", lambda: simulation.probe("vertex:100000")),
        ("expected energy", lambda: simulation.probe("colour")),
        ("width and height", lambda: gingerbread.picture(level, width=1)),
    ]:
        try:
            act()
        except ValueError as error:
            assert wanted in str(error), f"{error} should say {wanted}"
        else:
            raise AssertionError(f"nothing says {wanted}")


def wrong_poisson(level):
    wrong = level.to_dict()
    wrong["bodies"][0]["material"]["poisson"] = 0.7
    return wrong


def one_simulation_is_not_stepped_twice_at_once():
    simulation = gingerbread.Simulation(gingerbread.Level("gingerbread_house"))
    thread = threading.Thread(target=simulation.run_for, args=(30.0,))
    thread.start()
    refused = 0
    while thread.is_alive() and not refused:
        try:
            simulation.time
        except RuntimeError:
            refused += 1
    thread.join()
    assert refused and round(simulation.time, 6) == 30.0


def files_and_links_lead_back():
    level = gingerbread.Level("chain")
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "chain.ron"
        level.save(path)
        assert gingerbread.Level(path) == level
    assert gingerbread.Level("https://example.org/" + level.to_link()) == level


def the_notebook_runs():
    import matplotlib

    matplotlib.use("Agg")
    names = {}
    for cell in json.loads((HERE / "work_precision.ipynb").read_text())["cells"]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    lines = names["axes"].get_lines()
    assert len(lines) == 4
    for line in lines:
        errors = line.get_ydata()
        assert errors[-1] < errors[0], f"{line.get_label()} gets no more exact"


if __name__ == "__main__":
    for test in [
        examples_hold,
        states_are_those_of_the_program,
        every_level_has_its_shape,
        arrays_do_not_change,
        a_probe_is_the_position_of_its_vertex,
        a_pull_moves_its_vertex,
        errors_name_their_place,
        one_simulation_is_not_stepped_twice_at_once,
        files_and_links_lead_back,
        the_notebook_runs,
    ]:
        test()
        print("ok", test.__name__, flush=True)
