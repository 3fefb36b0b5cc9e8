"""Impedance p/Q at the inlet of one of the rig's lines, its outlet held: exact, and what each scheme makes of it.

Every scheme with 20 cells and the step of a wave through one; the rig's real-time line at its own 50 us.
"""

import numpy as np

from bridge.drawing.canvas import (
    Array,
    Columns,
    Sheet,
    label,
    remark,
    sheet,
)
from twin.lines.lab.friction import friction
from twin.lines.lab.pipe import Pipe
from twin.lines.lab.response import (
    characteristics_response,
    exact_response,
    impedance,
    lines_response,
    rig_response,
)
from twin.lines.lab.space import grid

PIPE = Pipe(2.5, 0.011, 1137.0, 878.0, 40e-6)  # the rig's line 2
CELLS, RIG_STEP = 20, 50e-6
STEP = PIPE.travel_time / CELLS
FREQUENCIES = np.concatenate([np.arange(2.0, 10.0, 2.0), np.arange(10.0, 1401.0, 10.0)])  # [Hz]
LINES = (("cds3", "bdf2"), ("cds5", "esdirk4"), ("fem", "backward-euler"), ("fem", "esdirk4"))
BAR_PER_LITRE = 1e-5 * 1e-3 / 60.0  # [bar/(l/min)] of Pa s/m^3


def responses(frequencies: Array = FREQUENCIES) -> dict[str, Array]:
    """Impedance by scheme at frequencies [Hz], complex."""
    omega = 2.0 * np.pi * frequencies
    fit = friction("fit", viscous_time=PIPE.viscous_time, step=STEP)
    rig_fit = friction("fit", viscous_time=PIPE.viscous_time, step=RIG_STEP)
    found = {"exact": exact_response(PIPE, "unsteady", omega)}
    found["moc"] = characteristics_response(PIPE, fit, CELLS, omega)
    found["moc at Courant 0.5"] = characteristics_response(PIPE, fit, CELLS, omega, 0.5)
    for space, time in LINES:
        found[f"{space}/{time}"] = lines_response(PIPE, grid(space, CELLS, PIPE.length), time, fit, STEP, omega)
    found["rig ends"] = rig_response(PIPE, rig_fit, RIG_STEP, omega)
    return {name: impedance(matrices) for name, matrices in found.items()}


def draw() -> tuple[Columns, Sheet]:
    """Left the impedance, right its error."""
    found = responses()
    page, (size, error) = sheet("Impedance of a line of 2.5 m at its inlet, outlet held", panels=2)
    for i, (name, z) in enumerate(found.items()):
        colour = "black" if name == "exact" else f"C{i - 1}"
        size.semilogy(
            FREQUENCIES, BAR_PER_LITRE * np.abs(z), color=colour, linewidth=1.6 if i == 0 else 0.9, label=name
        )
        if i:
            off = 100.0 * np.abs(z / found["exact"] - 1.0)
            error.semilogy(FREQUENCIES, off, color=colour, linewidth=0.9)
    error.set_ylim(1e-2, 1e3)
    label(size, "f [Hz]", "|p/Q| [bar/(l/min)]")
    label(error, "f [Hz]", "relative error [%]")
    handles, names = size.get_legend_handles_labels()
    page.legend(handles, names, loc="outside right center", frameon=False, fontsize=8)
    remark(page, "20 cells, steps of Δx/a = 110 µs; rig: 50 µs; laminar friction with memory")
    table: Columns = {"frequency [Hz]": FREQUENCIES}
    for name, z in found.items():
        table |= {f"{name} real [Pa s/m^3]": z.real, f"{name} imaginary [Pa s/m^3]": z.imag}
    return table, page
