"""Figure 2.23: a suddenly opened inlet by characteristics, at Courant number 1 and, interpolated, at 0.5.

Source: 2.5.3; L = 10 m, a = 1000 m/s, cells of 1 m, from rest at 10 bar, inlet at 0.1 m/s, outlet at 10 bar, no
friction. The density is not printed there; with 876.56 kg/m^3 of 2.2.3 the steps are +-0.877 bar.
"""

import numpy as np

from bridge.drawing.canvas import (
    Columns,
    Sheet,
    label,
    remark,
    stack,
)
from twin.lines.lab.friction import friction
from twin.lines.lab.network import characteristics
from twin.lines.lab.pipe import VELOCITY, Case, End, History, Pipe, constant, reservoir

PIPE = Pipe(10.0, 0.02, 1000.0, 876.56, 40e-6)  # diameter and viscosity do not matter without friction
CASE = Case(PIPE, End(VELOCITY, constant(0.1)), reservoir(10e5), 0.0, 10e5)
CELLS, SPAN = 10, 0.06  # [-], [s]


def histories() -> tuple[History, History]:
    """At Courant number 1 and 0.5."""
    none = friction("none")
    return characteristics(CASE, none, CELLS, SPAN), characteristics(CASE, none, CELLS, SPAN, 0.5)


def columns() -> Columns:
    """Both on the times of the finer; the coarser holds its values between its steps."""
    whole, half = histories()
    at = np.searchsorted(whole.time, half.time + 1e-9) - 1
    return {
        "time [s]": half.time,
        "inlet pressure at Courant 1 [Pa]": whole.p_1[at],
        "inlet pressure at Courant 0.5 [Pa]": half.p_1,
        "outlet velocity at Courant 1 [m/s]": whole.v_2[at],
        "outlet velocity at Courant 0.5 [m/s]": half.v_2,
    }


def draw() -> tuple[Columns, Sheet]:
    """Inlet pressure above, outlet velocity below."""
    whole, half = histories()
    page, (upper, lower) = stack("2.23  Characteristics: whole steps, and half steps with interpolation", (1.0, 1.0))
    for axes, name, factor in ((upper, "p_1", 1e-5), (lower, "v_2", 1.0)):
        for history, colour, text in ((whole, "black", "Δt = Δx/a, exact"), (half, "tab:red", "Δt = Δx/(2a)")):
            values = factor * getattr(history, name)
            axes.step(1e3 * history.time, values, where="post", color=colour, linewidth=1.2, label=text)
    upper.legend(frameon=False, fontsize=8, loc="upper right", ncols=2)
    upper.set_ylim(8.8, 11.5)
    label(upper, "", "inlet pressure $p_u$ [bar]")
    label(lower, "t [ms]", "outlet velocity $v_d$ [m/s]")
    remark(page, "10 m, 1000 m/s, 10 cells; inlet opened to 0.1 m/s at t = 0, outlet held at 10 bar; no friction")
    return columns(), page
