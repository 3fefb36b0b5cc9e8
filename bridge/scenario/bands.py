"""What a scenario expects, in words: "overshoot <= 5 %", "limit cycle: none", "peak p_lower <= 80 bar".

And of a part of the run: "mean p1 from impact + 300 ms to impact + 600 ms >= 66 bar".
"""

import re
from typing import NamedTuple

from bridge.errors import nearest
from bridge.scenario.units import quantity, shown
from controller.bands import END, START, STATISTICS, Band, Metrics, Moment, WindowBand
from twin.topology import BALANCE_UNITS, OBSERVED


class Shown(NamedTuple):
    """How a metric is written for people."""

    words: str
    unit: str  # SI
    factor: float  # from SI to what is shown
    shown_unit: str


METRICS = {
    "rise_time": Shown("rise time (10-90 %)", "s", *shown("s")),
    "overshoot": Shown("overshoot", "", *shown("", "%")),
    "settling_time": Shown("settling time (2 %)", "s", *shown("s")),
    "steady_error": Shown("steady error", "m", *shown("m")),
    "rms_error": Shown("rms error", "m", *shown("m")),
    "max_error": Shown("largest error", "m", *shown("m")),
    "limit_cycle_amplitude": Shown("limit cycle amplitude", "m", *shown("m")),
    "limit_cycle_frequency": Shown("limit cycle frequency", "Hz", *shown("Hz")),
    "peak_p1": Shown("peak p1", "Pa", *shown("Pa")),
    "peak_p_lower": Shown("peak p_lower", "Pa", *shown("Pa")),
    "peak_p_upper": Shown("peak p_upper", "Pa", *shown("Pa")),
    "min_p_lower": Shown("least p_lower", "Pa", *shown("Pa")),
    "min_p_upper": Shown("least p_upper", "Pa", *shown("Pa")),
    "valve_travel": Shown("valve travel", "", 1.0, "travels"),
}
assert set(METRICS) == set(Metrics._fields)
SIGNALS = OBSERVED | BALANCE_UNITS
MOMENTS = (START, END, "contact", "impact")
_BAND = re.compile(r"\s*(.+?)\s*(<=|>=)\s*(.+?)\s*")
_WINDOW = re.compile(rf"({'|'.join(STATISTICS)}) (\S+)(?: from (.+?) to (.+?))?")
_MOMENT = re.compile(r"([a-z]+)(?:\s*([+-])\s*(.+))?")
_CYCLE = re.compile(r"\s*limit cycle\s*:\s*(\w+)\s*")
SMALLEST_CYCLE = 1e-9  # [m]; what the metrics call no limit cycle is exactly zero


def value_with_unit(metric: str, value: float | None) -> str:
    """A metric as people read it."""
    metric_shown = METRICS[metric]
    return "-" if value is None or value != value else f"{value * metric_shown.factor:.4g} {metric_shown.shown_unit}"


def signal_with_unit(signal: str, value: float) -> str:
    """A statistic of a signal as people read it."""
    factor, unit = shown(SIGNALS[signal])
    return "-" if value != value else f"{value * factor:.4g} {unit}".rstrip()


def parse_band(text: str) -> Band | WindowBand:
    """The band that a text states. Raises ValueError naming the nearest valid metric, signal, moment or unit."""
    if cycle := _CYCLE.fullmatch(text):
        return _cycle_band(text, cycle[1])
    match = _BAND.fullmatch(text)
    if match is None:
        raise ValueError(
            f"expect {text!r}: write 'metric <= value unit', 'metric >= value unit' or 'limit cycle: none'"
        )
    if window := _WINDOW.fullmatch(match[1]):
        return _window_band(text, window, match[2], match[3])
    metric = match[1].replace(" ", "_").replace("-", "_")
    if metric not in METRICS:
        known = [name.replace("_", " ") for name in METRICS]
        raise ValueError(f"expect {text!r}: no metric {match[1]!r}{nearest(match[1], known)}")
    try:
        return Band(metric, match[2], quantity(match[3], METRICS[metric].unit))
    except ValueError as error:
        raise ValueError(f"expect {text!r}: {error}") from None


def _window_band(text: str, window: re.Match[str], relation: str, limit: str) -> WindowBand:
    statistic, signal, begin, end = window.groups()
    if signal not in SIGNALS:
        raise ValueError(f"expect {text!r}: no signal {signal!r}{nearest(signal, SIGNALS)}")
    try:
        bounds = _moment(begin or START), _moment(end or END)
        return WindowBand(statistic, signal, *bounds, relation, quantity(limit, SIGNALS[signal]))
    except ValueError as error:
        raise ValueError(f"expect {text!r}: {error}") from None


def _moment(text: str) -> Moment:
    """A time of the run, "3 s", or one counted from a moment, "impact + 300 ms"."""
    match = _MOMENT.fullmatch(text)
    if match is None:
        return Moment(START, quantity(text, "s"))
    if match[1] not in MOMENTS:
        raise ValueError(f"no moment {match[1]!r}{nearest(match[1], MOMENTS, 'or a time')}")
    offset = quantity(match[3], "s") if match[3] else 0.0
    return Moment(match[1], -offset if match[2] == "-" else offset)


def _cycle_band(text: str, word: str) -> Band:
    if word == "none":
        return Band("limit_cycle_amplitude", "<=", 0.0)
    if word == "present":
        return Band("limit_cycle_amplitude", ">=", SMALLEST_CYCLE)
    raise ValueError(f"expect {text!r}: a limit cycle is 'none' or 'present'")
