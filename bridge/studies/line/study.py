"""One pipe with one scheme, compared with the exact line: course, picture, table, summary."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from bridge.drawing.canvas import (
    Array,
    Columns,
    Sheet,
    label,
    remark,
    stack,
)
from bridge.drawing.files import write_columns
from bridge.errors import UsageError, writing
from bridge.studies.line.branch import BranchHistory, branch_of, with_branch
from bridge.studies.line.case import LineOptions, amount, case_of
from twin.lines.lab.exact import exact_history, kind_of
from twin.lines.lab.pipe import VELOCITY, Case, History
from twin.lines.lab.rig_line import NEVER
from twin.lines.lab.simulate import Resolution, model_of, simulate
from twin.rig import values

MOST_CELLS, MOST_STEPS, MOST_POLES = 2000, 2_000_000, 2000


class Study(NamedTuple):
    """A case and its answers."""

    case: Case
    request: LineOptions
    history: History
    exact: History | None  # None where there is none: turbulent, Brunone's, cavitation, a branch
    branch: BranchHistory | None = None

    @property
    def error(self) -> float:
        """rms of both ends' pressure against the exact line, over the Joukowsky pressure; NaN without one."""
        if self.exact is None:
            return float("nan")
        found, right = self.history, self.exact
        off = [
            np.interp(right.time, found.time, mine) - yours
            for mine, yours in ((found.p_1, right.p_1), (found.p_2, right.p_2))
        ]
        return float(np.sqrt(np.mean(np.square(off)))) / scale(self)


def scale(study: Study) -> float:
    """The Joukowsky pressure of what is done to the line [Pa]."""
    case = study.case
    end = [e for e, kind in zip((case.left, case.right), (study.request.left, study.request.right), strict=True)
           if kind in ("shut", "open", "push")]  # fmt: skip
    if not end:
        return max(case.pipe.hammer * abs(case.velocity), 1.0)
    change = abs(end[0].course(1e9) - end[0].course(0.0)) or max(abs(end[0].course(0.0)), 1e-9)
    return change * (case.pipe.hammer if end[0].holds == VELOCITY else 1.0)


def study(request: LineOptions) -> Study:
    """Run what was asked for. UsageError: one line that says what cannot be and the way out."""
    try:
        case, span = case_of(request), 0.0
        span = amount(request, "span", "s") if request.span else 20.0 * case.pipe.travel_time
        fine = Resolution(
            request.cells,
            amount(request, "step", "s") if request.step else _own_step(request, case),
            request.courant,
            amount(request, "tolerance", "Pa") if request.tolerance else 0.0,
            request.poles,
        )
        _checked(case, request, fine, span)
        if request.branch:
            found = _branched(case, request, fine, span)
            return Study(case, request, found.ends, None, found)
        vapour = values()["oil"]["vapour_pressure"] if request.cavitation else NEVER
        history = simulate(case, request.scheme, request.friction, span, fine, float(vapour))
        return Study(case, request, history, _exact(case, request, fine, span))
    except ValueError as error:
        raise UsageError(str(error)) from None


def _branched(case: Case, request: LineOptions, fine: Resolution, span: float) -> BranchHistory:
    """The pipe with its branch. ValueError: a scheme that has no junctions, or a place outside the pipe."""
    if request.scheme != "moc":
        raise ValueError(f"scheme {request.scheme} has no junctions; with --branch take moc")
    branch = branch_of(case, request.branch or "", request.branch_diameter, request.branch_at, request.branch_end)
    model = model_of(case, request.friction, fine, case.pipe.travel_time / fine.cells)
    return with_branch(case, branch, model, fine.cells, span, fine.courant)


def _own_step(request: LineOptions, case: Case) -> float:
    """The rig's lines are not tied to cells: 50 us, or an eighth of a short pipe's travel time."""
    if request.scheme in ("ends", "nodes", "lumped"):
        return min(50e-6, case.pipe.travel_time / 8.0)
    return 0.0


def _checked(case: Case, request: LineOptions, fine: Resolution, span: float) -> None:
    if not 1 <= request.cells <= MOST_CELLS:
        raise ValueError(f"--cells {request.cells} is outside 1 .. {MOST_CELLS}")
    if not 1 <= request.poles <= MOST_POLES:
        raise ValueError(f"--poles {request.poles} is outside 1 .. {MOST_POLES}")
    step = fine.step or case.pipe.travel_time / fine.cells
    if span / step > MOST_STEPS:
        raise ValueError(
            f"--span {span:g} s is {span / step:.2g} steps, limit {MOST_STEPS:g}; take a shorter one or fewer cells"
        )
    if span < step:
        raise ValueError(f"--span {span:g} s is shorter than a step of {step:.3g} s; take a longer one")


def _exact(case: Case, request: LineOptions, fine: Resolution, span: float) -> History | None:
    """The exact line with the friction that was asked for; of truncated weights, the one they stand for."""
    model = model_of(case, request.friction, fine, fine.step or case.pipe.travel_time / fine.cells)
    reynolds = abs(case.velocity) * case.pipe.diameter / case.pipe.viscosity
    if request.cavitation or model.brunone or (model.turbulent and reynolds > 2300.0):
        return None
    kind = "steady" if model.turbulent else kind_of(model)
    return exact_history(case, kind, span, min(20000, max(1000, round(span / case.pipe.travel_time) * 50)))


def table(found: Study) -> Columns:
    """Columns of the CSV: the scheme's own times; exact ones interpolated to them."""
    h = found.history
    out: Columns = {
        "time [s]": h.time,
        "pressure left [Pa]": h.p_1,
        "pressure right [Pa]": h.p_2,
        "velocity left [m/s]": h.v_1,
        "velocity right [m/s]": h.v_2,
    }
    if found.exact is not None:
        e = found.exact
        out["exact pressure left [Pa]"] = np.interp(h.time, e.time, e.p_1)
        out["exact pressure right [Pa]"] = np.interp(h.time, e.time, e.p_2)
    if found.branch is not None:
        b = found.branch
        out |= {
            "pressure junction [Pa]": b.junction,
            "pressure branch end [Pa]": b.far,
            "flow into branch [m^3/s]": b.inflow,
        }
    return out


def facts(found: Study) -> list[tuple[str, str]]:
    """What the run says, for people."""
    pipe, h = found.case.pipe, found.history
    rows = [
        ("wave speed", f"{pipe.speed:.0f} m/s"),
        ("travel time L/a", f"{1e3 * pipe.travel_time:.3f} ms"),
        ("viscosity", f"{1e6 * pipe.viscosity:.2f} mm^2/s"),
        ("Reynolds number before", f"{abs(found.case.velocity) * pipe.diameter / pipe.viscosity:.0f}"),
        ("Joukowsky pressure", f"{1e-5 * scale(found):.3f} bar"),
    ]
    for name, p in (("left", h.p_1), ("right", h.p_2)):
        rows.append((f"pressure {name}", f"{1e-5 * p.min():.3f} .. {1e-5 * p.max():.3f} bar"))
    if found.branch is not None:
        for name, p in (("junction", found.branch.junction), ("branch end", found.branch.far)):
            rows.append((f"pressure {name}", f"{1e-5 * p.min():.3f} .. {1e-5 * p.max():.3f} bar"))
        parts = ", ".join(f"{c:.3f}" for c in found.branch.courant)
        rows.append(("Courant numbers: left, right, branch", parts))
    if found.exact is not None:
        rows.append(("rms error against the exact line", f"{100.0 * found.error:.2f} % of Joukowsky's pressure"))
    return rows


def picture(found: Study) -> Sheet:
    """Pressures above, velocities below."""
    r, pipe = found.request, found.case.pipe
    page, (upper, lower) = stack(f"{pipe.length:g} m, {1e3 * pipe.diameter:g} mm: {r.scheme}, {r.friction}", (1.2, 0.8))
    unit, per = ("ms", 1e3) if found.history.time[-1] < 1.0 else ("s", 1.0)
    if found.exact is not None:
        for p in (found.exact.p_1, found.exact.p_2):
            upper.plot(per * found.exact.time, 1e-5 * p, color="0.7", linewidth=2.2)
        upper.plot([], [], color="0.7", linewidth=2.2, label="exact")
    _pair(upper, per * found.history.time, 1e-5 * found.history.p_1, 1e-5 * found.history.p_2)
    if found.branch is not None:
        for p, colour, name in (
            (found.branch.junction, "tab:green", "junction"),
            (found.branch.far, "tab:orange", "branch end"),
        ):
            upper.plot(per * found.history.time, 1e-5 * p, color=colour, linewidth=0.9, label=name)
    _pair(lower, per * found.history.time, found.history.v_1, found.history.v_2)
    upper.legend(frameon=False, fontsize=8, ncols=4, loc="upper right")
    label(upper, "", "pressure [bar]")
    label(lower, f"t [{unit}]", "velocity [m/s]")
    remark(
        page, f"left: {r.left}, right: {r.right}; " + "; ".join(f"{name} {value}" for name, value in facts(found)[:2])
    )
    return page


def _pair(axes, time: Array, left: Array, right: Array) -> None:
    axes.plot(time, left, color="tab:blue", linewidth=0.9, label="left end")
    axes.plot(time, right, color="tab:red", linewidth=0.9, label="right end")


def write(found: Study, directory: Path) -> tuple[Path, Path]:
    """line.png and line.csv in a directory, made if absent."""
    image, text = directory / "line.png", directory / "line.csv"
    with writing(image):
        picture(found).savefig(image)
    write_columns(text, table(found))
    return image, text
