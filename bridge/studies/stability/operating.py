"""Where a run stands among the gains that settle, and whether it swung as the theory says."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import ScenarioError
from bridge.scenario import Scenario
from bridge.studies.stability.advised import Stability
from bridge.studies.stability.amplitude import own_row, range_over
from bridge.studies.stability.sampled_law import free_gain, is_asked
from controller.bands import Metrics

ROUND = (0.2, 5.0)  # of the own sampling interval, what the chart spans
PLACES = 7
CHARTED = 20e-3  # [m], the step of the chart


class OperatingPoint(NamedTuple):
    """Where a run stands, and what it did. Gains in `unit`."""

    gain: float
    unit: str  # "V/%", or "x" for a factor on the law's answer
    sample_period: float  # [s]
    delay: float  # [s]
    verdict: Stability
    swings_after: tuple[float, ...]  # steps [m] after which the theory's loop swings
    predicted_frequency: float | None  # [Hz], of the widest of these swings; None: none, or an irregular one
    found_frequency: float | None  # [Hz], of the run's own limit cycle; 0.0: none; None: not known
    found_amplitude: float | None  # [m]

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return self._asdict()


def operating_point(scenario: Scenario, metrics: Metrics | None) -> OperatingPoint | None:
    """At the own gain alone: which gains settle takes longer, and is for `advise`.

    None for a loop without a gain, for a law that `advise` runs itself, such as a function of the user's, and where the
    theory has no answer.
    """
    if is_asked(scenario):
        return None
    try:
        free = free_gain(scenario)
        row, all_of_them = own_row(scenario, free.own)
    except ScenarioError:
        return None
    stability = Stability.BETWEEN if row.swinging else Stability.STABLE
    return OperatingPoint(
        gain=free.own / free.per_unit,
        unit=free.unit,
        sample_period=scenario.loop.sample_period,
        delay=scenario.loop.delay,
        verdict=Stability.UNSTABLE if len(row.swinging) == all_of_them else stability,
        swings_after=row.swinging,
        predicted_frequency=row.frequency if row.swinging and row.frequency else None,
        found_frequency=_known(metrics.limit_cycle_frequency) if metrics else None,
        found_amplitude=_known(metrics.limit_cycle_amplitude) if metrics else None,
    )


__all__ = ["OperatingPoint", "edge_curves", "operating_point", "sentences", "steps_in_words"]


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None


def sentences(at: OperatingPoint) -> list[str]:
    """An operating point in words."""
    first = (
        f"{at.gain:.3g} {at.unit} at {at.sample_period * 1e3:g} ms and {at.delay * 1e3:g} ms delay: by the theory it "
        f"{at.verdict.words}; hydrotwin advise says which gains settle"
    )
    found, amplitude = at.found_frequency, at.found_amplitude
    swing = f"{found:.3g} Hz, {amplitude * 1e3:.3g} mm" if found and amplitude is not None else "none"
    swing = "not applicable, no constant stretch to judge" if found is None else swing
    return [first, f"oscillation predicted: {_predicted(at)}; found: {swing}"]


def _predicted(at: OperatingPoint) -> str:
    if not at.swings_after:
        return "none"
    often = f"{at.predicted_frequency:.3g} Hz" if at.predicted_frequency else "irregular"
    return f"{often} after steps of {steps_in_words(at.swings_after)}"


def steps_in_words(sizes: Sequence[float]) -> str:
    """Signed steps, in mm."""
    return ", ".join(f"{size * 1e3:+g}" for size in sizes) + " mm"


def edge_curves(scenario: Scenario) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Sampling intervals [s] around the run's own; below which gain a step settles, and does not swing widely, (n, 2).

    In the unit of the free gain, inf where there is none. Of steps of CHARTED alone and with one noise, so rougher than
    `advise`.
    """
    free = free_gain(scenario)
    daq, own = scenario.loop.daq_period, scenario.loop.sample_period
    ticks = sorted({max(1, round(t / daq)) for t in (own * np.geomspace(*ROUND, PLACES)).tolist()})
    intervals = np.array(ticks) * daq
    return intervals, np.array([range_over(scenario, t, free.own, CHARTED) for t in intervals.tolist()]) / free.per_unit
