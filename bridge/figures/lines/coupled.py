"""A line with steps of its own choice, solved together with the cylinder, compared with the rig's own model.

Claim 2a of 2.7. The rig runs at its fixed step: the valve opens and shuts in 1 ms, line 3 fills the lower chamber, the
piston rises and stops. Line 3, the lower chamber and the piston are then solved anew by the method of lines and an
ESDIRK pair, driven by what the rig had around them: the pressure at the valve's end of the line and that in the upper
chamber. Without seal friction and the minor losses of that line.
"""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from bridge.drawing.canvas import Array, Columns, Sheet, label, remark, stack
from bridge.loop.exchange import exchange, sides
from bridge.scenario import Scenario, load
from bridge.scenario.circuit import circuit_of
from twin.circuit.kinds import of_kind
from twin.circuit.step import Circuit
from twin.cylinder import Cylinder
from twin.lines.lab.attached import chamber, given
from twin.lines.lab.coupled import CoupledLine, march_coupled
from twin.lines.lab.friction import friction
from twin.lines.lab.pipe import Pipe, elastic
from twin.lines.lab.space import grid
from twin.load import Load
from twin.oil import fluid_modulus, kinematic_viscosity

READ, SPAN = 1e-4, 0.3  # [s], from reading to reading, and of the run
CELLS, TOLERANCE = 30, 2e3  # [-], [Pa] rms per step
TOLERATED = (2e-11, 1e-7, 1e-5)  # [m^3], [m], [m/s] per step: stored oil, position, speed
MOST = 20_000  # steps
TABLE = "time_s,position_m\n0,0\n0.019,0\n0.02,1\n0.149,1\n0.15,0"
SIGNALS = ("stamp", "p_a", "p_lower", "p_upper", "position", "velocity", "flow_3")


class Courses(NamedTuple):
    """Both models, an entry per step of the lab; the rig interpolated to it."""

    time: Array  # [s]
    lower: Array  # pressure in the lower chamber [Pa], by the method of lines
    position: Array  # [m]
    flow: Array  # out of the line [m^3/s]
    rig_lower: Array
    rig_position: Array
    rig_flow: Array
    driven: Array  # pressure at the valve's end [Pa], the same for both


def scenario() -> Scenario:
    """The rig's run: up for 0.13 s, without what the method of lines does not have."""
    changes = [
        "rig.seal.limit=0", "rig.minor_losses.pipe_3=0", "rig.pump.ripple=none", f"duration={SPAN}", "expect=[]",
        f"loop.daq_period={READ}", f"reference.csv={TABLE}", "start.position=60 mm",
    ]  # fmt: skip
    return load("valve-slam", changes)


@cache
def rig_run() -> dict[str, Array]:
    """True signals of the rig's run."""
    plant, controller = sides(scenario())
    ticks = exchange(plant, controller, scenario().ticks)
    states = [out.message for messages in ticks for out in messages if out.topic == "state"]
    seen: dict[str, Array] = {name: np.array([getattr(state, name) for state in states]) for name in SIGNALS}
    seen["stamp"] = 1e-9 * seen["stamp"]
    return seen


def pipe_of(name: str) -> Pipe:
    """A line of the scenario's rig for the laboratory."""
    rig = scenario().rig_values()
    oil, steel, own = rig["oil"], rig["pipe_1"], rig[name]
    measured = oil["density"] * oil["wave_speed"] ** 2
    modulus = fluid_modulus(measured, *(steel[key] for key in ("diameter", "wall", "young")))
    bare = Pipe(own["length"], own["diameter"], 1.0, oil["density"], kinematic_viscosity(oil["temperature"]))
    return elastic(bare, modulus, own["wall"], own["young"])


def smooth(time: Array, values: Array) -> Callable[[float], float]:
    """A cubic through readings at even times."""
    from scipy.interpolate import CubicSpline

    c, begin, gap, last = (
        CubicSpline(time, values).c.T.tolist(),
        float(time[0]),
        float(time[1] - time[0]),
        len(time) - 2,
    )

    def at(t: float) -> float:
        i = min(max(int((t - begin) / gap), 0), last)
        s = t - begin - i * gap
        a, b, d, e = c[i]
        return ((a * s + b) * s + d) * s + e

    return at


def coupled_line(circuit: Circuit, seen: dict[str, Array], cells: int = CELLS) -> CoupledLine:
    """Line 3 from the valve's end to the lower chamber with the piston."""
    cylinder, weight = of_kind(circuit.parts.cylinder, Cylinder), of_kind(circuit.parts.load, Load)
    upper, at_valve = (smooth(seen["stamp"], seen[name]) for name in ("p_upper", "p_a"))
    piston = chamber(
        cylinder.area_lower, cylinder.dead_lower, cylinder.bulk_modulus, weight.mass,
        lambda t: -cylinder.area_upper * upper(t) - weight.mass * weight.gravity,
        lambda t, p: cylinder.leakage * (p - upper(t)),
        float(seen["position"][0]), float(seen["p_lower"][0]), TOLERATED,
    )  # fmt: skip
    own = pipe_of("pipe_3")
    places = grid("fem", cells, own.length)
    return CoupledLine(own, places, friction("kagawa"), (given(at_valve), piston),
                       float(seen["p_lower"][0]))  # fmt: skip


@cache
def courses(tolerance: float = TOLERANCE) -> Courses:
    """The run by both."""
    seen = rig_run()
    line = coupled_line(circuit_of(scenario()), seen)
    found = list(march_coupled(line, "esdirk4", tolerance, SPAN, MOST))
    time = np.array([t for t, _ in found])
    own = (
        np.array([w.p[1] for _, w in found]),
        np.array([w.z[1] for _, w in found]),
        np.array([w.q[1] for _, w in found]),
    )
    rig = (np.interp(time, seen["stamp"], seen[name]) for name in ("p_lower", "position", "flow_3", "p_a"))
    return Courses(time, *own, *rig)


class Difference(NamedTuple):
    """How far the two are apart."""

    pressure: float  # rms in the lower chamber over its span
    position: float  # greatest [m]
    steps: int
    fixed_steps: int  # of the rig
    shortest: float  # [s]
    longest: float


def difference(found: Courses) -> Difference:
    """Numbers; means over time, since steps are unequal."""
    even = np.linspace(0.0, SPAN, 3001)
    off = np.interp(even, found.time, found.lower - found.rig_lower)
    steps = np.diff(found.time)
    return Difference(
        float(np.sqrt(np.mean(off**2)) / np.ptp(found.rig_lower)),
        float(np.abs(found.position - found.rig_position).max()),
        len(steps), round(SPAN / scenario().loop.step), float(steps.min()), float(steps.max()),
    )  # fmt: skip


def draw() -> tuple[Columns, Sheet]:
    """Pressures, position and steps of both."""
    found = courses()
    told = difference(found)
    page, (upper, middle, lower) = stack("A line of variable steps together with the cylinder", (1.4, 0.8, 0.8))
    upper.plot(found.time, 1e-5 * found.driven, color="0.6", linewidth=0.7, label="at the valve, given to both")
    upper.plot(found.time, 1e-5 * found.rig_lower, color="tab:green", linewidth=2.0, label="lower chamber, the rig")
    upper.plot(found.time, 1e-5 * found.lower, "--", color="black", linewidth=0.9, label="the same, method of lines")
    upper.legend(frameon=False, fontsize=8, loc="upper right")
    middle.plot(found.time, 1e3 * found.rig_position, color="tab:green", linewidth=2.0)
    middle.plot(found.time, 1e3 * found.position, "--", color="black", linewidth=0.9)
    lower.step(found.time[1:], 1e6 * np.diff(found.time), color="black", linewidth=0.8, label="method of lines")
    lower.axhline(1e6 * scenario().loop.step, color="tab:green", linewidth=1.2, label="the rig")
    lower.set_yscale("log")
    lower.legend(frameon=False, fontsize=8, loc="upper right", ncols=2)
    label(upper, "", "p [bar]")
    label(middle, "", "x [mm]")
    label(lower, "t [s]", "step [µs]")
    remark(
        page,
        f"rms difference {100.0 * told.pressure:.2f} % of the chamber's span, position within "
        f"{1e3 * told.position:.3f} mm; {told.steps} steps of {1e6 * told.shortest:.0f} to {1e6 * told.longest:.0f} µs "
        f"against {told.fixed_steps}",
    )
    units = {"time": "s", "flow": "m^3/s", "rig_flow": "m^3/s", "position": "m", "rig_position": "m"}
    return {f"{name.replace('_', ' ')} [{units.get(name, 'Pa')}]": v for name, v in found._asdict().items()}, page
