"""The drive `ehla` beside an independent model of the same equations.

`tests/data/ehla.csv.gz` has every tenth millisecond of that model: RK4 at 1 us, oil counted by mass, friction as an
automaton; pressures absolute, the tank at 1 bar. `python -m tests.support.ehla FILE [STEP]` compares with another file
of the same columns, and prints the largest deviations after the first second.
"""

import csv
import gzip
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bridge.loop.exchange import exchange, sides
from bridge.scenario import load

MODEL = Path(__file__).parents[1] / "data" / "ehla.csv.gz"
AMBIENT = 1e5  # [Pa]
SETTLED = 1.0  # [s], until when pressures at rest hang on a micrometre of spool
COMPARED = {  # column: our signal, what is added to ours
    "position_m": ("position", 0.0),
    "p_supply_Pa_abs": ("p_p", AMBIENT),
    "p_A_Pa_abs": ("p_lower", AMBIENT),
    "p_B_Pa_abs": ("p_upper", AMBIENT),
    "p_T_Pa_abs": ("p_t", AMBIENT),
}
Columns = dict[str, NDArray[np.float64]]


def columns(path: Path) -> Columns:
    """A file's columns by name."""
    with gzip.open(path, "rt") as file:
        names, *rows = csv.reader(file)
    return dict(zip(names, np.array(rows, float).T, strict=True))


def trajectory(step: float, *changes: str) -> Columns:
    """True values of the drive at a step [s], in the other model's columns, every millisecond."""
    scenario = load("ehla", [f"loop.step={step!r}", *changes])
    states = [m.message for tick in exchange(*sides(scenario), scenario.ticks) for m in tick if m.topic == "state"]
    found = {name: np.array([getattr(s, own) for s in states], float) + add for name, (own, add) in COMPARED.items()}
    return {"time_s": 1e-3 * np.arange(float(len(states))), **found}


def deviations(ours: Columns, model: Columns) -> dict[str, float]:
    """Largest absolute difference in each column after SETTLED."""
    rows = np.round(1e3 * model["time_s"]).astype(int)
    later = (model["time_s"] > SETTLED) & (rows < len(ours["time_s"]))
    return {name: float(np.abs(ours[name][rows[later]] - model[name][later]).max()) for name in COMPARED}


if __name__ == "__main__":
    path, step = Path(sys.argv[1]), float(sys.argv[2]) if len(sys.argv) > 2 else 50e-6
    for name, most in deviations(trajectory(step), columns(path)).items():
        print(f"{name}: {most * 1e3:.4f} mm" if name == "position_m" else f"{name}: {most / 1e5:.3f} bar")
