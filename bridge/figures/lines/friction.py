"""Figure 2.27: friction models on a water hammer, and how far each is from the exact line after ten periods.

Source: 2.5.4; L = 40 m, d = 20 mm, a = 1319 m/s, rho = 1000 kg/m^3, nu = 1.46e-6 m^2/s, 0.1 m/s shut in 10 ms at the
inlet, 10 bar at the outlet, FEM and ESDIRK4 with 50 cells. The thesis had ten true poles of Zielke's weight, which is
not enough: the panels on the right say how many are, by height and by time of the peaks.
"""

import numpy as np

from bridge.drawing.canvas import (
    Columns,
    Sheet,
    label,
    shades,
    sheet,
)
from twin.lines.lab.exact import exact_history
from twin.lines.lab.friction import Friction, friction
from twin.lines.lab.network import characteristics
from twin.lines.lab.peaks import Peaks, peaks_of
from twin.lines.lab.pipe import VELOCITY, Case, End, History, Pipe, ramp, reservoir
from twin.lines.lab.simulate import Resolution, method_of_lines

PIPE = Pipe(40.0, 0.02, 1319.0, 1000.0, 1.46e-6)
CASE = Case(PIPE, End(VELOCITY, ramp(0.1, 0.0, 0.01)), reservoir(10e5), 0.1, 10e5)
CELLS, PEAKS = 50, 10
STEP = PIPE.travel_time / CELLS
SPAN = (4 * PEAKS + 2) * PIPE.travel_time
EXACT_POINTS = 20000
AGAINST = "middle and right: by characteristics, 50 cells, against the exact line; grey: ±1 %; at the tenth peak:"
DRAWN = {"none": "black", "steady": "tab:red", "zielke": "tab:blue"}  # by FEM and ESDIRK4, as in the thesis; Re 1370


def models() -> dict[str, Friction]:
    """All that have a memory, and Brunone's."""
    poles = {f"{n} poles": friction("zielke", poles=n) for n in (5, 10, 20, 50, 100, 200)}
    named = {name: friction(name) for name in ("trikha", "schohl", "kagawa")}
    fit = friction("fit", viscous_time=PIPE.viscous_time, step=STEP)
    return poles | named | {"own fit": fit, "convolution": friction("convolution"), "brunone": friction("brunone")}


def exact() -> History:
    """The dissipative line."""
    return exact_history(CASE, "unsteady", SPAN, EXACT_POINTS)


def errors(right: Peaks, found: History) -> tuple[np.ndarray, np.ndarray]:
    """Of the peaks: amplitude, relative; end, [s]."""
    peaks = peaks_of(CASE, found, PEAKS)
    return peaks.amplitude / right.amplitude - 1.0, peaks.end - right.end


def drawn() -> dict[str, History]:
    """What the thesis draws."""
    fine = Resolution(cells=CELLS, step=STEP)
    return {name: method_of_lines(CASE, friction(name), "fem", "esdirk4", fine, SPAN) for name in DRAWN}


def draw() -> tuple[Columns, Sheet]:
    """Left the course of the inlet's pressure, then the errors of ten peaks; the table has all courses."""
    exactly, by_lines, tried = exact(), drawn(), models()
    by_characteristics = {name: characteristics(CASE, model, CELLS, SPAN) for name, model in tried.items()}
    right = peaks_of(CASE, exactly, PEAKS)
    page, (course, decay, phase) = sheet("2.27  Friction on a water hammer", panels=3)
    for name, history in by_lines.items():
        text = {"none": "frictionless", "steady": "quasi-steady", "zielke": "Zielke, 100 poles"}[name]
        course.plot(history.time, 1e-5 * history.p_1, color=DRAWN[name], linewidth=0.8, label=f"{text}, FEM/ESDIRK4")
    course.plot(exactly.time, 1e-5 * exactly.p_1, "--", color="tab:orange", linewidth=0.9, label="exact, with memory")
    course.set_ylim(8.4, 12.6)
    course.legend(frameon=False, fontsize=8, loc="upper center")
    label(course, "t [s]", "inlet pressure [bar]")
    number = np.arange(1, PEAKS + 1)
    for (name, history), colour in zip(by_characteristics.items(), shades(range(len(tried))), strict=True):
        off, late = errors(right, history)
        text = f"{name}: {100.0 * off[-1]:+.1f} %, {1e3 * late[-1]:+.1f} ms"
        decay.plot(number, 100.0 * off, "o-", color=colour, markersize=3, linewidth=0.9, label=text)
        phase.plot(number, 1e3 * late, "o-", color=colour, markersize=3, linewidth=0.9)
    decay.axhspan(-1.0, 1.0, color="0.9", zorder=0)
    for axes in (decay, phase):
        axes.set_xticks(number)
    decay.set_yscale("symlog", linthresh=1.0)
    decay.set_yticks([-1, 0, 1, 3, 10, 30], ["−1", "0", "1", "3", "10", "30"])
    label(decay, "peak", "error of its amplitude [%]")
    label(phase, "peak", "its end after the exact one [ms]")
    handles, names = decay.get_legend_handles_labels()
    page.legend(handles, names, title=AGAINST, loc="outside lower center", ncols=4, frameon=False, fontsize=8)
    page.set_size_inches(13.0, 6.0)
    time = by_characteristics["10 poles"].time
    table: Columns = {"time [s]": time, "exact [Pa]": np.interp(time, exactly.time, exactly.p_1)}
    table |= {f"{name} by fem/esdirk4 [Pa]": np.interp(time, h.time, h.p_1) for name, h in by_lines.items()}
    return table | {f"{name} by moc [Pa]": h.p_1 for name, h in by_characteristics.items()}, page
