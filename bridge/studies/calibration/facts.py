"""What the thesis measured, as numbers that a run of the twin has too. Each has a range; a miss counts in its scale.

Ranges are numbers of the text of 2.3 and 2.6, or those of printed axes: an axis that the plotting program has chosen
ends at the first tick beyond the greatest value. How each is read stands beside it.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root_scalar

from bridge.studies.calibration.experiment import LIFT, RESTART, SPEEDS, UP, Course, circuit_for, run
from twin.circuit.kinds import of_kind
from twin.circuit.step import Circuit
from twin.load import Load
from twin.orifice import quadratic_flow
from twin.relief.network import Relief
from twin.relief.poppet import pilot_opening
from twin.seal import Seal, friction

BAR = 1e5
LOADS = (165.0, 213.0, 243.0, 299.0, 334.0)  # [kg], 2.3
SLOW = 2e-3  # [m/s], where the friction is greatest in the measured range (2.4 spans -0.03 .. 0.03 m/s)
SETTLED = 0.35  # [s] after the stop: t = 2 s of the slowest test
FAST = max(SPEEDS)
PLACE = 0.1  # [m], where the piston waits, if nothing else is said
Rig = Mapping[str, Mapping[str, Any]]


class Fact(NamedTuple):
    """A measured range."""

    name: str
    unit: str
    low: float
    high: float
    scale: float  # a miss of so much counts as one
    source: str


FACTS = (
    *(Fact(f"held, {n} rpm", "bar", 27.0, 32.0, 1.0, "2.6: p2 - p3 in the middle of the rest") for n in SPEEDS),
    *(Fact(f"at restart, {n} rpm", "bar", 27.6, 29.6, 1.0, "2.6: 25.6 + about 3") for n in SPEEDS),
    Fact("friction, five loads", "N", 800.0, 1000.0, 50.0, "Fig. 2.4, 2.5: axis to 1000 by 200"),
    Fact("difference, five loads", "bar", 35.0, 40.0, 1.0, "Fig. 2.5: axis to 40 by 5"),
    Fact("restart: peak of p2", "bar", 65.0, 75.0, 2.0, "2.6: about 70"),
    Fact("restart: least p2", "bar", 20.0, 29.6, 2.0, "2.6: slight depression; Fig. 2.30: axis from 20"),
    Fact("impingement: greatest p3", "bar", 0.0, 30.0, 2.0, "Fig. 2.30: axis"),
    Fact("impingement: least p2", "bar", 20.0, 80.0, 2.0, "Fig. 2.30: axis"),
    Fact("impingement: greatest p2", "bar", 60.0, 80.0, 5.0, "Fig. 2.30: axis to 80 by 20; peaks are uncertain there"),
    Fact("speed before the stop", "m/s", 0.375, 0.385, 0.005, "2.6: 0.38"),
    Fact("relief flow after contact", "l/min", 0.5, 40.0, 0.5, "2.6: it opens"),
    Fact("relief flow, 0.2 s later", "l/min", 0.0, 0.0, 0.5, "2.6: it shuts again"),
    Fact("greatest p1", "bar", 0.0, 100.0, 5.0, "Fig. 2.29: axis"),
    Fact("contact after the command", "ms", 94.0, 114.0, 5.0, "2.6: 0.976 s, 1.08 s; the start, assumed, fits it"),
    Fact("force of 2.18", "N", 20.0, 25.0, 0.5, "Fig. 2.18: axis, at 0.2 mm and 100 bar"),
)


def evaluate(rig: Rig, speeds: Sequence[int] = SPEEDS) -> dict[str, float]:
    """Facts of a rig, by name, in their unit: all, or those of some pump speeds [rpm], the highest among them.

    Its part "start" has the place where the piston waits.
    """
    place = rig.get("start", {}).get("position", PLACE)
    circuit = circuit_for({part: entries for part, entries in rig.items() if part != "start"})
    courses = {speed: run(circuit, speed, place) for speed in speeds}
    found: dict[str, float] = {}
    for speed, course in courses.items():
        found |= _at_rest(course, speed)
    return found | _friction(circuit) | _restart(courses[FAST]) | _contact(courses[FAST], circuit) | _pilot(circuit)


def _at_rest(course: Course, speed: int) -> dict[str, float]:
    stop, restart = UP + LIFT[speed], RESTART[speed]
    middle = stop + SETTLED

    def held(begin: float, end: float) -> float:
        return float((course.between("p_lower", begin, end) - course.between("p_upper", begin, end)).mean()) / BAR

    return {
        f"held, {speed} rpm": held(middle - 0.05, middle + 0.05),
        f"at restart, {speed} rpm": held(restart - 0.1, restart - 2e-3),
    }


def _friction(circuit: Circuit) -> dict[str, float]:
    """Of a piston that rises slowly, no pressure above it: A_l p = m g + F(p)."""
    area, gravity = circuit.parts.cylinder.area_lower, circuit.parts.load.gravity
    seal = of_kind(circuit.parts.seal, Seal)
    most, differences = 0.0, []
    for mass in LOADS:

        def surplus(p: float, mass: float = mass) -> float:
            return area * p - mass * gravity - friction(SLOW, p, seal)[0]

        p = root_scalar(surplus, bracket=(1e5, 500e5)).root
        differences.append(p / BAR)
        most = max(most, *(friction(v, p, seal)[0] for v in (SLOW, -SLOW)))
    return {"friction, five loads": most, "difference, five loads": max(differences)}


def _restart(course: Course) -> dict[str, float]:
    begin, end = RESTART[FAST], float(course.time[-1])
    stroke = course.columns["position"].max()
    impact = float(course.time[np.argmax(course.columns["position"] >= stroke - 1e-4)])
    p2, p3 = (course.between(name, begin, impact - 5e-3) / BAR for name in ("p_lower", "p_upper"))
    peak = int(np.argmax(p2))
    late = course.between("p_lower", begin, end) / BAR
    speed = course.between("velocity", impact - 0.1, impact - 0.01)
    return {
        "restart: peak of p2": float(p2[peak]),
        "restart: least p2": float(p2[: peak + 1].min()),
        "impingement: greatest p3": float(p3.max()),
        "impingement: least p2": float(late.min()),
        "impingement: greatest p2": float(late.max()),
        "speed before the stop": float(speed.mean()) if len(speed) else 0.0,
    }


def _contact(course: Course, circuit: Circuit) -> dict[str, float]:
    support = of_kind(circuit.parts.load, Load).support
    contact = float(course.time[np.argmax(course.columns["position"] >= support)])
    relieved = 6e4 * course.between("flow_relief", contact, contact + 0.1)
    later = 6e4 * course.between("flow_relief", contact + 0.1, UP + LIFT[FAST])
    return {
        "relief flow after contact": float(relieved.max()),
        "relief flow, 0.2 s later": float(later[len(later) // 2 :].max(initial=0.0)),
        "greatest p1": float(course.columns["p1"].max()) / BAR,
        "contact after the command": 1e3 * (contact - UP),
    }


def _pilot(circuit: Circuit) -> dict[str, float]:
    """A p2 at a lift of 0.2 mm, 100 bar before orifice 2, which is orifices 1 and 2 less one like 3."""
    valve = of_kind(circuit.parts.relief, Relief)
    orifices = valve.orifices
    conductance, area = pilot_opening(0.2e-3, valve.pilot)
    a, b = orifices.a_12 - orifices.a_3, orifices.b_12 - orifices.b_3
    flow = quadratic_flow(100.0 * BAR, a + 1.0 / conductance**2, b)
    return {"force of 2.18": area * (flow / conductance) ** 2}


def misses(found: Mapping[str, float], weights: Mapping[str, float] | None = None) -> NDArray[np.float64]:
    """How far each fact is missed, in its scale; signed. weights: of facts that count other than 1."""
    weights = weights or {}
    return np.array([weights.get(f.name, 1.0) * _miss(f, found[f.name]) for f in FACTS if f.name in found])


def _miss(fact: Fact, value: float) -> float:
    return (min(0.0, value - fact.low) + max(0.0, value - fact.high)) / fact.scale
