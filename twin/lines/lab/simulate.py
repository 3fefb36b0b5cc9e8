"""One door to all schemes: a case, a scheme by its name, a friction by its name; both ends over time.

moc                        characteristics, Courant number 1 or less
SPACE/TIME                 method of lines, such as fem/esdirk4; a step, or a tolerance for the esdirk pairs
ends, nodes, lumped        the rig's real-time lines
exact                      by Laplace transform
"""

from typing import NamedTuple

import numpy as np

from twin.lines.lab.exact import exact_history, kind_of
from twin.lines.lab.friction import Friction, friction
from twin.lines.lab.integrate import TIMES, march, march_adaptive
from twin.lines.lab.network import characteristics
from twin.lines.lab.pipe import Case, History
from twin.lines.lab.rig_line import NEVER, rig_line
from twin.lines.lab.space import SPACES, grid
from twin.lines.lab.system import line_system
from twin.lines.spec import MODELS

CELLS = 50
SCHEMES = ("moc", *(f"{space}/{time}" for space in SPACES for time in TIMES), *MODELS, "exact")


class Resolution(NamedTuple):
    """How finely. Zeros choose: 50 cells, the step of a wave through a cell."""

    cells: int = CELLS
    step: float = 0.0  # [s]; of moc the Courant number decides
    courant: float = 1.0  # of moc
    tolerance: float = 0.0  # [Pa], rms of an esdirk step; 0 for equal steps
    poles: int = 100  # of friction zielke


def simulate(
    case: Case, scheme: str, model: str, span: float, fine: Resolution | None = None, vapour_pressure: float = NEVER
) -> History:
    """Run a case for a span [s]. ValueError: names, a friction the scheme does not have, cells or steps too coarse."""
    fine = fine or Resolution()
    if scheme not in SCHEMES:
        raise ValueError(f"scheme {scheme!r} unknown; known: moc, SPACE/TIME, {', '.join(MODELS)}, exact; "
                         f"SPACE: {', '.join(SPACES)}; TIME: {', '.join(TIMES)}")  # fmt: skip
    if fine.cells < 1 or not span > 0.0:
        raise ValueError(f"{fine.cells} cells and a span of {span} s: take one cell or more, and a span above 0 s")
    if vapour_pressure > NEVER and scheme not in MODELS:
        raise ValueError(f"scheme {scheme} knows no cavitation; take ends or nodes")
    step = fine.step or case.pipe.travel_time / fine.cells
    chosen = model_of(case, model, fine, step)
    if scheme == "exact":
        return exact_history(case, kind_of(chosen), span, max(1, round(span / step)))
    if scheme == "moc":
        return characteristics(case, chosen, fine.cells, span, fine.courant)
    if scheme in MODELS:
        return rig_line(case, chosen, scheme, step, span, vapour_pressure).ends
    space, time = scheme.split("/")
    return method_of_lines(case, chosen, space, time, fine._replace(step=step), span)


def model_of(case: Case, name: str, fine: Resolution, step: float) -> Friction:
    """A friction model for a case and a step [s]."""
    pipe = case.pipe
    reynolds = abs(case.velocity) * pipe.diameter / pipe.viscosity
    return friction(name, fine.poles, pipe.viscous_time, step, reynolds)


def method_of_lines(case: Case, model: Friction, space: str, time: str, fine: Resolution, span: float) -> History:
    """Both ends at every step, equal or chosen by the error."""
    system, start = line_system(case, grid(space, fine.cells, case.pipe.length), model)
    steps = round(span / fine.step)
    if fine.tolerance > 0.0:
        course = march_adaptive(system, start, time, fine.tolerance, span)
    else:
        course = (found for found, _ in zip(march(system, start, time, fine.step), range(steps + 1), strict=False))
    n = system.nodes
    at = [0, n - 1, n, 2 * n - 1]
    rows = np.array([(t, *state.y[at]) for t, state in course])
    rows[:, 3:] /= case.pipe.hammer
    return History(*rows.T)
