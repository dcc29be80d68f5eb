"""Positioning axes with dry friction: design, certificates and simulation, as the `breakaway` command has them.

Every function takes the TOML file of the command of its name, as a path or as text (a `str` with a line break in it),
and gives what the command writes as JSON, as a dictionary; names carry SI units. Samples come beside it as numpy
arrays, which are read-only where they look into the library's own memory instead of copying it.

    >>> import breakaway
    >>> run = breakaway.simulate("sim/scenarios/can_axis.toml")
    >>> run.figures["settled"], run.axes["axis"].position_m[-1]

What cannot be used is refused by InputError, whose text names the place and the remedy, and what is of a wrong type by
TypeError. Ctrl-C ends what takes long on its way.
"""

import json as _json
import os as _os
import types as _types

import numpy as _np

from . import _core
from ._core import InputError

__version__ = _core.version
__all__ = ["InputError", "Attraction", "Basin", "Identification", "Simulation", "Tuning", "attract", "basin", "design",
           "identify", "k3", "kick_table", "simulate", "study", "tune"]


class _Result:
    """Named fields that are set once."""

    def __init__(self, **fields):
        self.__dict__.update(fields)

    def __repr__(self):
        return f"{type(self).__name__}({', '.join(self.__dict__)})"


class Simulation(_Result):
    """What a run gave: `figures`, and the samples. An axis behind its drive has them in `axes` by its name, each with
    time_s, position_m, velocity_m_s, force_N, friction_level_N, target_m, bus_load and mode, a list of names, and behind
    a spring load_position_m; a machine has time_s, and q and v of shape (samples, coordinates)."""


class Tuning(_Result):
    """`figures`, and the `text` of the file with the numbers that were chosen."""


class Identification(_Result):
    """`figures`, and the `text` of the file with what was found in it."""


class Attraction(_Result):
    """`figures`, and the cells of the region: `level` (the side of a cell is 2 window / 2**level), `column`, `row`
    from the lower left, and `proved`: 1 attracted, 0 lost, -1 undecided."""


class Basin(_Result):
    """`figures`; `fates`, an array of int8 of shape (points, points): 1 attracted, 0 lost, -1 undecided; `times_s`,
    when that was certain, of the same shape; and `coordinates`, those of columns and rows."""


def _text_and_name(file):
    if isinstance(file, str) and "\n" in file:
        return file, "<text>"
    path = _os.fspath(file)
    try:
        with open(path, encoding="utf-8") as opened:
            return opened.read(), str(path)
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not text in UTF-8") from None


def k3(position_m, *, mass_kg, k1_N_per_m, k22_Ns_per_m, friction_lower_N):
    """The impulse in N s that sends an axis which rests off its target by position_m back to it, and the time in s
    that this takes: two arrays in the shape of position_m.

    All must be above 0, and k22**2 > 4 mass k1. Van de Wouw & Leine, "Impulsive Control of Mechanical Motion Systems
    with Uncertain Friction", (12) to (15).

    >>> impulse_Ns, time_s = breakaway.k3([-0.1, 1e-6], mass_kg=1, k1_N_per_m=1, k22_Ns_per_m=3, friction_lower_N=2.5)
    """
    impulse, time = _core.k3(_np.asarray(position_m, dtype=float), mass_kg, k1_N_per_m, k22_Ns_per_m, friction_lower_N)
    return impulse, time


def kick_table(file, distance_m, *, axis=""):
    """The pulses of a braked axis for distances from its target, 0 or more: force_N, periods and cut_periods of each,
    and how far it moves an axis of the class at most and at least, most_m and least_m; arrays in the shape of
    distance_m. least_distance_m and reach_m are the ends of the table, and nearer and further away the pulse is that of
    the end. Of several axes one is named; those of a [coupling] have no table.

    >>> table = breakaway.kick_table("sim/scenarios/braked_axis.toml", [2e-6, 1e-4, 1e-2])
    """
    return _types.SimpleNamespace(**_core.kick_table(*_text_and_name(file), _np.asarray(distance_m, dtype=float), axis))


def design(file):
    """Every check of a node's certificate with its margin, what it promises, and what that rests on: as
    `breakaway design --json`.

    >>> breakaway.design("sim/scenarios/braked_axis.toml")["certified"]
    """
    return _json.loads(_core.design(*_text_and_name(file)))


def simulate(file, *, trace=True, accuracy_m=None):
    """Simulates an axis or a machine: a Simulation. Without `trace` no samples are kept. accuracy_m: allow this error,
    and take the cheapest method that holds it.

    >>> breakaway.simulate("sim/scenarios/two_mass_example.toml").q
    """
    text, arrays = _core.simulate(*_text_and_name(file), trace, accuracy_m)
    if "q" in arrays:
        return Simulation(figures=_json.loads(text), **arrays)
    axes = {name: _types.SimpleNamespace(**columns) for name, columns in arrays.items()}
    return Simulation(figures=_json.loads(text), axes=axes)


def study(file, *, starts=(), laws=100, seed=1, threads=0, axis=""):
    """Runs an axis under every friction law of its class: as `breakaway study --json`. starts: pairs of a position in
    m and a velocity in m/s; without any, far, near and very near. laws: up to a million. threads: 1 to 1024, or 0 for
    all processors.

    >>> breakaway.study("sim/scenarios/can_axis.toml", starts=[(-0.1, 0)])["rows"][0]["worst_settling_s"]
    """
    pairs = [(float(position), float(velocity)) for position, velocity in starts]
    return _json.loads(_core.study(*_text_and_name(file), pairs, laws, seed, threads, axis))


def tune(file, *, objective="time", laws=100, seed=1, threads=0, axis=""):
    """Chooses coast, gains and tolerance of an axis from what it is, certified: a Tuning. objective: "time",
    "accuracy" or "gentle". laws: up to 100,000. threads as for study.

    >>> breakaway.tune("sim/scenarios/can_axis.toml").figures["chosen"]
    """
    figures, text = _core.tune(*_text_and_name(file), objective, laws, seed, threads, axis)
    return Tuning(figures=_json.loads(figures), text=text)


def identify(file, *, record=None, lowest_m=None, highest_m=None, duration_s=60, axis=""):
    """Finds mass, friction and latency of an axis by an experiment on its emulated drive, or from `record`, the CSV
    file of a run: an Identification. Of an experiment only: lowest_m and highest_m, the travel, where the file has no
    [limits] of position; duration_s, 2 to 3600.

    >>> breakaway.identify("sim/scenarios/braked_axis.toml", lowest_m=-4.5, highest_m=-3.5).figures["mass_kg"]
    """
    csv, record_name = _text_and_name(record) if record is not None else ("", "")
    figures, text = _core.identify(*_text_and_name(file), csv, record_name, lowest_m, highest_m, duration_s, axis)
    return Identification(figures=_json.loads(figures), text=text)


def attract(file, *, plane=(0, 1), window=0, depth=10, threads=0):
    """Where a machine with friction is certain to come to rest: an Attraction. plane: two places of (q, v), from 0.
    window: the axes reach from minus to plus this; 0: what fits. depth: cells are halved at most so often, 0 to 14.
    threads as for study. Van de Wouw & Leine, "Stability Properties of
    Equilibrium Sets of Controlled Linear Mechanical Systems with Dry Friction", Theorem 1 and beyond.

    >>> breakaway.attract("sim/scenarios/two_mass_example.toml", depth=6).figures["rho_star_J"]
    """
    figures, cells = _core.attract(*_text_and_name(file), plane, window, depth, threads)
    return Attraction(figures=_json.loads(figures), **cells)


def basin(file, *, points, window, plane=(0, 1), threads=0):
    """The region of attraction of a machine on a grid, by simulation: a Basin. points: along each axis, 2 to 10000.
    window, above 0: the axes reach from minus to plus this. plane as for attract, threads as for study.

    >>> breakaway.basin("sim/scenarios/two_mass_example.toml", points=101, window=6).fates.mean()
    """
    figures, fates, times_s = _core.basin(*_text_and_name(file), points, window, plane, threads)
    return Basin(figures=_json.loads(figures), fates=fates, times_s=times_s,
                 coordinates=_np.linspace(-window, window, points))
