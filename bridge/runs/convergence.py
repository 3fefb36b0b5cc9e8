"""How far a scenario's results depend on the step: the same run at dt, dt/2, dt/4, compared signal by signal."""

import math
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.recording.reader import read
from bridge.runs.in_process import record_in_process
from bridge.scenario import Scenario
from bridge.scenario.bands import SIGNALS
from bridge.scenario.units import shown
from twin.topology import OBSERVED

QUIET = {"noise": 0.0, "quantise": False}  # a card's counts would hide the plant's error
ROUNDING = 1e-12  # relative to the greatest value; below this the difference is rounding
LEFT_OUT = ("oil", "mass", "friction")  # what counts, or jumps where the piston stops
COMPARED = [name for name in OBSERVED if not name.startswith(LEFT_OUT)]


class Row(NamedTuple):
    """One signal: errors of dt against dt/4, rms and greatest, and how fast they fall."""

    signal: str
    rms: float  # [SI]
    greatest: float  # [SI]
    order: float  # log2 of (dt - dt/2)/(dt/2 - dt/4), rms; NaN where nothing is left to fall

    def words(self) -> tuple[str, str, str, str]:
        """As people read it."""
        factor, unit = shown(SIGNALS[self.signal])
        order = f"{self.order:.2f}" if math.isfinite(self.order) else "-"
        return self.signal, f"{self.rms * factor:.3g} {unit}", f"{self.greatest * factor:.3g} {unit}", order

    def plain(self) -> dict[str, Any]:
        """For JSON, which knows no NaN."""
        return self._asdict() | {"order": self.order if math.isfinite(self.order) else None}


def convergence(scenario: Scenario) -> list[Row]:
    """Run a scenario three times; the card reads without noise and steps."""
    coarse, middle, fine = (_signals(scenario, divisor) for divisor in (1, 2, 4))
    return [_row(name, coarse[name], middle[name], fine[name]) for name in COMPARED if coarse[name].any()]


def _signals(scenario: Scenario, divisor: int) -> dict[str, NDArray[Any]]:
    loop = scenario.loop.model_copy(update={"step": scenario.loop.step / divisor})
    refined = scenario.model_copy(update={"loop": loop, "daq": scenario.daq.model_copy(update=QUIET)})
    with TemporaryDirectory() as folder:
        path = record_in_process(refined, Path(folder) / "run.mcap").path
        return read(path, ("state",)).columns("state")


def _row(name: str, coarse: NDArray[Any], middle: NDArray[Any], fine: NDArray[Any]) -> Row:
    error, first, second = coarse - fine, _rms(coarse - middle), _rms(middle - fine)
    rounding = ROUNDING * float(np.abs(fine).max())
    order = math.log2(first / second) if min(first, second) > rounding else math.nan
    return Row(name, _rms(error), float(np.abs(error).max()), order)


def _rms(values: NDArray[Any]) -> float:
    return float(np.sqrt(np.mean(values**2)))
