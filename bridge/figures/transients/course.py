"""The runs of figures 2.28 to 2.30, computed: pressures, position, relief valve and vapour over time.

Source: 2.6. 2.28 is read at 1 kHz, as the thesis's card did; 2.29 and 2.30 at 10 kHz, since a wave is back after 2 to
6 ms. Values are true ones: the card reads no pressure below the tank's. Periods are the thesis's: (a) and (b) at rest,
which here are one, as a run starts at rest; then (c) on its way up with its own load, (d) with the weight, or at the
stop; (e) stopped.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.drawing.canvas import Columns
from bridge.loop.exchange import exchange, sides
from bridge.recording.columns import vapour
from bridge.scenario import Scenario, load
from bridge.scenario.circuit import circuit_of
from twin.circuit.reading import moments
from twin.topology import OBSERVED

SPEEDS = (502, 800, 1035, 1230)  # [rpm]
LIFT = {502: 0.69, 800: 0.39, 1035: 0.29, 1230: 0.24}  # [s] up: to about half-way from the weight to the stop
START, LENGTH = 0.971, 4.5  # [s], start as in the load change
RESTART = {502: 3.0, 800: 2.595, 1035: 2.595, 1230: 2.595}  # [s], as in the impingement; the slowest as in the thesis
SWITCHING = 1e-3  # [s] between two rows of a table
CARD, FINE = 1e-3, 1e-4  # [s] from reading to reading
SIGNALS = ("stamp", "p1", "p_lower", "p_upper", "position", "mass", "spool", "flow_relief")
HOLLOW = tuple(name for name in OBSERVED if name.startswith("cavity_"))

Array = NDArray[np.float64]


class Transient(NamedTuple):
    """A run over time, an entry per reading."""

    time: Array  # [s]
    p1: Array  # [Pa], relief valve's inlet
    p2: Array  # [Pa], lower chamber
    p3: Array  # [Pa], upper chamber
    position: Array  # [m]
    mass: Array  # carried [kg]
    spool: Array  # of the switching valve
    relieved: Array  # flow over the relief valve [m^3/s]
    cavities: Array  # vapour in all places [m^3]


class Excerpt(NamedTuple):
    """A part of a transient with the periods of the thesis."""

    transient: Transient
    bounds: tuple[float, ...]  # [s]: begin of the first period, of each further one, end of the last
    letters: tuple[str, ...]


def schedule(speed: int) -> str:
    """Spool reference over time at a pump speed [rpm], as the text of a scenario's table: up, hold, up for good."""
    rows = [(0.0, 0)]
    for at, to in ((START, 1), (START + LIFT[speed], 0), (RESTART[speed], 1)):
        rows += [(at - SWITCHING, rows[-1][1]), (at, to)]
    return "\n".join(["time_s,position_m", *(f"{time:.3f},{spool}" for time, spool in rows)])


def combined(speed: int) -> Scenario:
    """The load change at a pump speed [rpm], then on into the upper stop."""
    name = "load-change" if speed == max(SPEEDS) else f"load-change-{speed}"
    changes = [f"reference.csv={schedule(speed)}", f"duration={LENGTH}", f"loop.daq_period={CARD}", "expect=[]"]
    return load(name, changes)


def run(scenario: Scenario) -> Transient:
    """A scenario in process, its true states."""
    plant, controller = sides(scenario)
    ticks = exchange(plant, controller, scenario.ticks)
    states = [out.message for messages in ticks for out in messages if out.topic == "state"]
    seen = {name: np.array([getattr(state, name) for state in states]) for name in (*SIGNALS, *HOLLOW)}
    seen["stamp"] = 1e-9 * seen["stamp"]
    return Transient._make([*(seen[name] for name in SIGNALS), vapour(seen)])


@cache
def experiment(speed: int) -> Transient:
    """Figure 2.28 at a pump speed [rpm]."""
    return run(combined(speed))


@cache
def load_change() -> Excerpt:
    """Figure 2.29."""
    return _excerpt("load-change", 0.9, 1.5, "contact", ("a, b", "c", "d", "e"))


@cache
def impingement() -> Excerpt:
    """Figure 2.30."""
    return _excerpt("impingement", 2.4, 3.3, "impact", ("a, b", "c", "d"))


def _excerpt(name: str, begin: float, end: float, event: str, letters: tuple[str, ...]) -> Excerpt:
    scenario = load(name, [f"duration={end}", f"loop.daq_period={FINE}", "expect=[]"])
    course = run(scenario)
    circuit = circuit_of(scenario)
    happened = moments(course.time, {"position": course.position}, circuit)[event]
    travel = np.diff(course.spool)
    bounds = begin, _first(course.time, travel > 0.0), happened, _first(course.time, travel < 0.0), end
    inside = (course.time >= begin - 0.5 * FINE) & (course.time <= end + 0.5 * FINE)
    part = Transient(*(column[inside] for column in course))
    return Excerpt(part, tuple(bound for bound in bounds if np.isfinite(bound)), letters)


def _first(time: Array, happening: NDArray[np.bool_]) -> float:
    return float(time[np.argmax(happening)]) if happening.any() else np.nan


def columns_of(transient: Transient) -> Columns:
    """A transient as a table."""
    return {
        "time [s]": transient.time,
        "p1 [Pa]": transient.p1,
        "p2 [Pa]": transient.p2,
        "p3 [Pa]": transient.p3,
        "position [m]": transient.position,
        "carried mass [kg]": transient.mass,
        "relief flow [m^3/s]": transient.relieved,
        "relief valve [0 shut; 1 open]": (transient.relieved > 0.0).astype(float),
        "cavities [m^3]": transient.cavities,
    }


def experiment_columns() -> Columns:
    """Figure 2.28: one run after the other."""
    tables = [_speed_column(speed) | columns_of(experiment(speed)) for speed in SPEEDS]
    return {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}


def _speed_column(speed: int) -> Columns:
    return {"pump speed [1/s]": np.full(len(experiment(speed).time), speed / 60.0)}


def excerpt_columns(excerpt: Excerpt) -> Columns:
    """Figure 2.29 or 2.30, with the number of the period."""
    period = np.searchsorted(excerpt.bounds[1:-1], excerpt.transient.time, side="right") + 1.0
    words = "; ".join(f"{number} {letter.replace(', ', ' and ')}" for number, letter in enumerate(excerpt.letters, 1))
    return columns_of(excerpt.transient) | {f"period [{words}]": period}
