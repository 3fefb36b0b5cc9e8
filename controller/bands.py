"""What a run can be asked to keep: bands of its control metrics, and of statistics of a signal within a part of it.

Plain words and numbers without numpy, for whoever reads, lists or refuses them.
"""

import operator
from typing import NamedTuple

RELATIONS = {"<=": operator.le, ">=": operator.ge}
STATISTICS = ("mean", "least", "greatest", "rms")
START, END = "start", "end"  # moments that every run has


class Metrics(NamedTuple):
    rise_time: float  # [s], 10..90 % of the step
    overshoot: float  # fraction of the step
    settling_time: float  # [s], from the step until within 2 % of it for good
    steady_error: float  # [m], reference - position, mean of the last 10 % of the last constant stretch
    rms_error: float  # [m]
    max_error: float  # [m], absolute
    limit_cycle_amplitude: float  # [m], half of peak to peak, of the worst constant stretch; 0.0: none
    limit_cycle_frequency: float  # [Hz]; 0.0: none
    limit_cycle_begin: float  # [s], of that stretch
    limit_cycle_end: float  # [s]
    phase_lag: float  # [rad], of the position behind a sine
    time_lag: float  # [s], of the position behind a reference that moves
    amplitude_ratio: float  # of the position's sine to the reference's
    peak_p1: float  # [Pa]
    peak_p_lower: float  # [Pa]
    peak_p_upper: float  # [Pa]
    min_p_lower: float  # [Pa]
    min_p_upper: float  # [Pa]
    valve_travel: float  # sum of |d spool|; 1.0 is the way from the centre to one end


class Moment(NamedTuple):
    """A moment of the run and an offset from it."""

    name: str
    offset: float  # [s]


WHOLE = (Moment(START, 0.0), Moment(END, 0.0))


class Band(NamedTuple):
    """What a metric must keep to, of the whole run or between two moments."""

    metric: str  # field of Metrics
    relation: str  # "<=" | ">="
    limit: float  # in the unit of the metric
    begin: Moment = WHOLE[0]
    end: Moment = WHOLE[1]


class BandResult(NamedTuple):
    metric: str
    value: float
    relation: str
    limit: float
    passed: bool


class WindowBand(NamedTuple):
    """What a signal must keep to between two moments."""

    statistic: str  # of STATISTICS
    signal: str
    begin: Moment
    end: Moment
    relation: str  # "<=" | ">="
    limit: float  # in the unit of the signal
    unit: str = ""  # SI, of a signal that only the run knows


def judge(metrics: Metrics, bands: list[Band]) -> list[BandResult]:
    """One result per band; NaN never passes. Raises ValueError for an unknown metric or relation."""
    return [_result(metrics, band) for band in bands]


def _result(metrics: Metrics, band: Band) -> BandResult:
    if band.metric not in Metrics._fields:
        raise ValueError(f"no metric {band.metric!r}; there are {', '.join(Metrics._fields)}")
    if band.relation not in RELATIONS:
        raise ValueError(f"relation {band.relation!r} of {band.metric} is none of {', '.join(RELATIONS)}")
    value = getattr(metrics, band.metric)
    return BandResult(band.metric, value, band.relation, band.limit, RELATIONS[band.relation](value, band.limit))
