"""The bulk modulus from the speed of a pressure front in a long steel pipe, measured on the twin.

Source: 2.2.3, (2.8), (2.9). The pipe is filled and shut at its far end; a push at the near end sends a front that comes
back from both ends. The transducer at the far end sees it after 1, 3, 5, .. lengths. A front arrives where the pressure
has made 1 % of its change: friction with memory leans it over, so that half of the change comes later with every pass
and would give too low a speed. Distance over arrival is a line with errors in one coordinate: its slope is the speed.
"""

import math
from functools import cache
from typing import NamedTuple

import numpy as np

from bridge.drawing.canvas import Array, Columns, Sheet, label, remark, sheet
from bridge.figures.oil.line_fit import Line, fit_line
from twin.lines.lab.friction import friction
from twin.lines.lab.pipe import PRESSURE, Case, End, Pipe, closed, elastic, ramp
from twin.lines.lab.rig_line import rig_line
from twin.oil import fluid_modulus, kinematic_viscosity
from twin.rig import values

LENGTH = 10.0  # [m], assumed: "a long steel pipe"
BEFORE, RISE, PUSH = 20e5, 10e5, 1e-3  # [Pa], [Pa], [s], assumed
STEP, CARD = 50e-6, 1e-4  # [s], of the line, and from reading to reading
PASSES = 3
ARRIVED, HALF = 0.01, 0.5  # shares of a front's change
PRINTED_YOUNG = 2.1e10  # [Pa], of the thesis; steel has ten times as much


class Fronts(NamedTuple):
    """What the far transducer read, and the passes of the front through the middle of each rise."""

    time: Array  # [s]
    pressure: Array  # [Pa]
    arrival: Array  # (PASSES,) [s]
    distance: Array  # (PASSES,) [m]


class Moduli(NamedTuple):
    """What follows from a wave speed."""

    effective: float  # B [Pa], rho a^2
    fluid: float  # B_fluid [Pa] with steel's modulus, (2.8)
    fluid_printed: float  # with the thesis's, ten times too small, (2.9)


def pipe() -> Pipe:
    """The rig's steel pipe, longer."""
    oil, steel = values()["oil"], values()["pipe_1"]
    own = Pipe(LENGTH, steel["diameter"], 1.0, oil["density"], kinematic_viscosity(oil["temperature"]))
    return elastic(own, true_moduli().fluid, steel["wall"], steel["young"])


def moduli(speed: float) -> Moduli:
    """Moduli [Pa] from a wave speed [m/s] in the rig's steel pipe."""
    oil, steel = values()["oil"], values()["pipe_1"]
    effective = oil["density"] * speed**2
    wall = steel["diameter"], steel["wall"]
    return Moduli(
        effective,
        fluid_modulus(effective, *wall, steel["young"]),
        fluid_modulus(effective, *wall, PRINTED_YOUNG),
    )


def true_moduli() -> Moduli:
    """Those of the twin's oil."""
    return moduli(float(values()["oil"]["wave_speed"]))


@cache
def measure(share: float = ARRIVED, kind: str = "fit") -> Fronts:
    """The far end's pressure and the arrivals of a share of each front; kind: the friction, `fit` the rig's own."""
    own = pipe()
    case = Case(own, End(PRESSURE, ramp(BEFORE, BEFORE + RISE, PUSH)), closed(), 0.0, BEFORE)
    model = friction(kind, viscous_time=own.viscous_time, step=STEP)
    span = (2 * PASSES + 1) * own.travel_time
    ends = rig_line(case, model, "ends", STEP, span).ends
    every = round(CARD / STEP)
    time, pressure = ends.time[every - 1 :: every], ends.p_2[every - 1 :: every]
    odd = 2 * np.arange(PASSES) + 1
    arrival = [_passing(time, pressure, n * own.travel_time, own, share) for n in odd]
    return Fronts(time, pressure, np.array(arrival), LENGTH * odd)


def _passing(time: Array, pressure: Array, due: float, own: Pipe, share: float) -> float:
    """When the pressure has made a share of its change by the front that is due [s], less what of the push was over."""
    before, after = (float(np.interp(t, time, pressure)) for t in (due, due + 0.5 * own.travel_time))
    near = (time > due - CARD) & (time < due + own.travel_time)
    rising = math.copysign(1.0, after - before)
    crossing = rising * (before + share * (after - before))
    return float(np.interp(crossing, rising * pressure[near], time[near]) - share * PUSH)


def fit(fronts: Fronts) -> Line:
    """Distance over arrival: the slope is the wave speed [m/s]."""
    return fit_line(fronts.arrival, fronts.distance, CARD / math.sqrt(12.0))


def draw_bulk_modulus() -> tuple[Columns, Sheet]:
    """The far end's pressure with the arrivals, and distance over arrival with the line."""
    fronts = measure()
    line, found, true = fit(fronts), moduli(fit(fronts).slope), true_moduli()
    page, (left, right) = sheet(f"Bulk modulus by the wave speed in {LENGTH:g} m of steel pipe, on the twin", panels=2)
    left.plot(1e3 * fronts.time, 1e-5 * fronts.pressure, color="tab:green", linewidth=0.9)
    for share, mark in ((ARRIVED, "o"), (HALF, "x")):
        at = measure(share).arrival + share * PUSH
        words = f"{100.0 * share:.0f} % of a front: {fit(measure(share)).slope:.0f} m/s"
        left.plot(1e3 * at, 1e-5 * np.interp(at, fronts.time, fronts.pressure), mark, color="tab:red", label=words)
    left.legend(frameon=False)
    label(left, "t [ms]", "pressure at the shut end [bar]")
    fitted = line.slope * fronts.arrival + line.intercept
    name = f"Wald: a = {line.slope:.1f} ± {line.slope_deviation:.1f} m/s"
    right.plot(1e3 * fronts.arrival, fitted, color="tab:red", linewidth=1.0, label=name)
    right.plot(1e3 * fronts.arrival, fronts.distance, "o", color="tab:blue", markersize=5, label="passes of the front")
    right.legend(frameon=False)
    label(right, "arrival after the push [ms]", "distance run [m]")
    remark(
        page,
        f"The twin has {values()['oil']['wave_speed']:.0f} m/s. B = ρa² = {found.effective / 1e9:.3f} GPa (true "
        f"{true.effective / 1e9:.3f}); $B_{{fluid}}$ = {found.fluid / 1e9:.3f} GPa with E = 210 GPa (true "
        f"{true.fluid / 1e9:.3f}), {found.fluid_printed / 1e9:.3f} GPa with the thesis's 21 GPa",
    )
    return _columns(fronts, line), page


def _columns(fronts: Fronts, line: Line) -> Columns:
    number = np.searchsorted(fronts.arrival + ARRIVED * PUSH, fronts.time).astype(float)
    found = {"wave speed [m/s]": line.slope, "deviation of it [m/s]": line.slope_deviation}
    found |= {f"modulus {name} [Pa]": value for name, value in moduli(line.slope)._asdict().items()}
    table = {"time [s]": fronts.time, "pressure [Pa]": fronts.pressure, "fronts passed [-]": number}
    return table | {name: np.full(len(number), value) for name, value in found.items()}
