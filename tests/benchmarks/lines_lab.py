"""The laboratory of lines: error against time for every scheme, and characteristics beside TSNet's published rates.

`python -m tests.benchmarks.lines_lab FILE.png` draws the former.
"""

import math
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bridge.drawing.canvas import lattice
from bridge.figures.lines.friction import CASE as SOURCE
from bridge.figures.lines.friction import SPAN as SOURCE_SPAN
from tests.benchmarks.plant import Row
from twin.lines.lab.exact import exact_history
from twin.lines.lab.friction import friction
from twin.lines.lab.integrate import PAIRS, TIMES
from twin.lines.lab.network import Net, characteristics, march_net
from twin.lines.lab.peaks import peaks_of
from twin.lines.lab.pipe import VELOCITY, Array, Case, End, History, Pipe, ramp, reservoir
from twin.lines.lab.simulate import Resolution, simulate
from twin.lines.lab.space import SPACES

LINE = Pipe(2.5, 0.011, 1137.0, 878.0, 40e-6)  # the rig's line 2
T = LINE.travel_time
SPAN = 10.0 * T
CELLS = (10, 20, 40, 80)
FULL = (8, 12, 16, 24, 36)  # of Chebyshev
FINER = (10, 20, 40, 80, 160, 320, 640)  # of characteristics
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5)  # over rho a v; of chosen steps on 80 cells
GOAL = 0.01  # rms of the inlet's pressure over rho a v
PUBLISHED = (1e5, 4e5)  # node-steps per second of TSNet, whose inner loops are Python
RATES = {"steady": "steady", "quasi-steady": "quasi-steady", "brunone": "unsteady (Brunone)"}  # ours: TSNet's class


class Problem(NamedTuple):
    """A case and the right pressure at end 1."""

    case: Case
    model: str
    right: Callable[[Array], Array]


class Point(NamedTuple):
    """One run."""

    seconds: float
    error: float  # of GOAL


def by_images(course: Callable[[float], float]) -> Callable[[Array], Array]:
    """p_1 without friction, end 2 held: u_1 and its echoes, + 2 (-1)^k u_1(t - 2 k T)."""

    def at(t: float) -> float:
        echoes = sum(2.0 * (-1.0) ** k * course(t - 2.0 * k * T) for k in range(1, int(t / (2.0 * T)) + 1))
        return LINE.hammer * (course(t) + echoes)

    return lambda times: np.array([at(float(t)) for t in times])


def smooth(t: float) -> float:
    """Pulses from t = 0 on, three times differentiable [m/s]."""
    return math.sin(math.pi * t / (1.46 * T)) ** 4 if t > 0.0 else 0.0


def steep(t: float) -> float:
    """One front, tanh(10 (a t/L - 0.9)) [m/s]."""
    return 0.5 * (1.0 + math.tanh(10.0 * (t / T - 0.9))) if t > 0.0 else 0.0


def problems() -> dict[str, Problem]:
    """Smooth, steep, and a water hammer with laminar memory: shut in half a travel time."""
    out = {
        name: Problem(Case(LINE, End(VELOCITY, course), reservoir(0.0), 0.0, 0.0), "none", by_images(course))
        for name, course in (("smooth", smooth), ("steep", steep))
    }
    hammer = Case(LINE, End(VELOCITY, ramp(1.0, 0.0, 0.5 * T)), reservoir(20e5), 1.0, 20e5)
    exact = exact_history(hammer, "unsteady", SPAN, 40000, 2**18)
    out["hammer"] = Problem(hammer, "fit", lambda times: np.interp(times, exact.time, exact.p_1))
    return out


def settings(scheme: str) -> list[Resolution]:
    """From coarse to fine."""
    if scheme in ("ends", "nodes"):
        return [Resolution(step=T / n) for n in (8, 16, 32, 64, 128)]
    if scheme.startswith("moc"):
        return [Resolution(cells=n, courant=0.5 if "0.5" in scheme else 1.0) for n in FINER]
    if scheme.endswith("chosen"):
        return [Resolution(cells=80, tolerance=share * LINE.hammer) for share in TOLERANCES]
    return [Resolution(cells=n) for n in (FULL if scheme.startswith("chebyshev") else CELLS)]


SCHEMES = (
    *(f"{space}/{time}" for space in SPACES for time in TIMES),
    *(f"cds5/{time}, steps chosen" for time in PAIRS),
    "moc", "moc, Courant 0.5", "nodes", "ends",
)  # fmt: skip


def run(problem: Problem, scheme: str, fine: Resolution) -> Point:
    """Time and error; what takes less than 50 ms runs three times, and the best counts."""
    best, history, runs = math.inf, None, 0
    while runs < 1 or (runs < 3 and best < 0.05):
        start = time.process_time()
        history = simulate(problem.case, scheme.split(",")[0], problem.model, SPAN, fine)
        best, runs = min(best, time.process_time() - start), runs + 1
    return Point(best, _error(problem, history))


def _error(problem: Problem, history: History | None) -> float:
    assert history is not None
    off = history.p_1 - problem.right(history.time)
    weights = np.gradient(history.time)  # steps differ
    return float(np.sqrt(weights @ off**2 / weights.sum())) / LINE.hammer


def curves(problem: Problem) -> dict[str, list[Point]]:
    """Every scheme from coarse to fine."""
    for scheme in ("moc", "ends", "nodes"):  # compiles
        run(problem, scheme, settings(scheme)[0])
    return {scheme: [run(problem, scheme, fine) for fine in settings(scheme)] for scheme in SCHEMES}


def time_for(points: list[Point], goal: float = GOAL) -> float:
    """Seconds to an error, straight between points in logarithms; infinite if none reaches it."""
    for before, after in zip([points[0], *points], points, strict=False):
        if after.error <= goal:
            if before.error <= goal:
                return after.seconds
            share = math.log(before.error / goal) / math.log(before.error / after.error)
            return before.seconds * (after.seconds / before.seconds) ** share
    return math.inf


def node_steps(name: str) -> float:
    """Nodes times steps per second of characteristics, 200 cells, with a friction."""
    case = Case(LINE, End(VELOCITY, ramp(1.0, 0.0, 1e-3)), reservoir(20e5), 1.0, 20e5)
    cells, steps = 200, 300 if name == "convolution" else 4000
    model = friction(name, 100, LINE.viscous_time, T / cells)
    best = math.inf
    for _ in range(3):
        start = time.process_time()
        characteristics(case, model, cells, steps * T / cells)
        best = min(best, time.process_time() - start)
    return (cells + 1) * steps / best


def net_node_steps() -> float:
    """The same of a net: 20 lines of 40 cells in a chain, steady friction."""
    pipes = (LINE._replace(length=LINE.length / 5.0),) * 20
    net = Net(pipes, tuple((i, i + 1) for i in range(20)), (1, *([0] * 20)))
    values = np.zeros((3001, 21))
    values[:, 0], values[:, 20] = 20e5, -1e-5
    start = time.process_time()
    step = pipes[0].travel_time / 40
    march_net(net, [friction("steady")] * 20, step, [40] * 20, values, [np.full(41, 20e5)] * 20, [0.0] * 20)
    return 20 * 41 * 3000 / (time.process_time() - start)


def rows(folder: Path) -> Iterator[Row]:
    """Rates beside TSNet's, figure 2.27 by every scheme, then time to 1 % and best error on every problem."""
    node_steps("steady")
    published = f"TSNet {PUBLISHED[0]:.0e} .. {PUBLISHED[1]:.0e}"
    for name, theirs in RATES.items():
        found = node_steps(name)
        beside = f"{published}, {theirs}"
        yield f"characteristics, friction {name}", f"{found:.2e} node-steps/s", beside, f"{found / PUBLISHED[1]:.0f}"
    for name in ("none", "fit", "kagawa", "zielke", "convolution"):
        yield f"characteristics, friction {name}", f"{node_steps(name):.2e} node-steps/s", "TSNet has none such", ""
    net_node_steps()
    found = net_node_steps()
    yield (
        "the same, 20 lines and junctions, steady",
        f"{found:.2e} node-steps/s",
        published,
        f"{found / PUBLISHED[1]:.0f}",
    )
    yield from hammer_rows()
    for name, problem in problems().items():
        for scheme, points in curves(problem).items():
            took, best = time_for(points), min(points, key=lambda point: point.error)
            ours = f"1 % in {1e3 * took:.2f} ms" if math.isfinite(took) else "1 % not reached"
            yield f"{name}: {scheme}", ours, f"{best.error:.1e} in {1e3 * best.seconds:.1f} ms", ""


def hammer_rows() -> Iterator[Row]:
    """Figure 2.27 by every scheme, 50 cells (Chebyshev 24), our fit, the rig's lines at 100 us: errors of peaks."""
    right = peaks_of(SOURCE, exact_history(SOURCE, "unsteady", SOURCE_SPAN, 20000))
    schemes = (*(f"{space}/{timing}" for space in SPACES for timing in TIMES), "moc", "nodes", "ends")
    for scheme in schemes:
        fine = Resolution(cells=24 if "cheb" in scheme else 50, step=1e-4 if scheme in ("nodes", "ends") else 0.0)
        found = peaks_of(SOURCE, simulate(SOURCE, scheme, "fit", SOURCE_SPAN, fine))
        off = 100.0 * (found.amplitude / right.amplitude - 1.0)
        late = 1e3 * (found.end - right.end)
        heights = " ".join(f"{off[n]:+.2f}" for n in (0, 1, 4, 9))
        times = " ".join(f"{late[n]:+.2f}" for n in (0, 4, 9))
        yield f"2.27, peaks 1, 2, 5, 10: {scheme}", f"{heights} %", f"ends of 1, 5, 10 {times} ms", ""


MARKS = dict(zip(TIMES, "o*+xs", strict=True))


def draw(path: Path) -> None:
    """Work and precision: a row per problem, a column per space; all others grey behind."""
    found = {name: curves(problem) for name, problem in problems().items()}
    page, panels = lattice("Error against CPU time, one pipe over ten travel times", 3, 4)
    for (name, schemes), row in zip(found.items(), panels, strict=True):
        for space, axes in zip(SPACES, row, strict=True):
            for i, timing in enumerate(TIMES):
                points = schemes[f"{space}/{timing}"]
                axes.loglog(*_course(points), MARKS[timing] + "-", color=f"C{i}", lw=0.9, ms=4, label=timing)
            for scheme, colour in (
                ("moc", "black"),
                ("moc, Courant 0.5", "0.6"),
                ("nodes", "0.4"),
                ("ends", "magenta"),
            ):
                axes.loglog(*_course(schemes[scheme]), ".--", color=colour, lw=0.9, ms=4, label=scheme)
            axes.set_title(f"{name}: {space}", fontsize=9)
            axes.set_xlabel("CPU time [ms]", fontsize=8)
        row[0].set_ylabel("rms error over ρ a v", fontsize=8)
    handles, names = panels[0][0].get_legend_handles_labels()
    page.legend(handles, names, loc="outside lower center", ncols=9, frameon=False, fontsize=7)
    page.savefig(path, dpi=110)


def _course(points: list[Point]) -> tuple[list[float], list[float]]:
    return [1e3 * point.seconds for point in points], [max(point.error, 1e-9) for point in points]


if __name__ == "__main__":
    draw(Path(sys.argv[1]))
