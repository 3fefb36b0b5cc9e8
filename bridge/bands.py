"""What a scenario expects, in words: "overshoot <= 5 %", "limit cycle: none", "peak p_lower <= 80 bar"."""

import difflib
import re
from typing import NamedTuple

from bridge.units import quantity
from controller.metrics import Band, Metrics


class Shown(NamedTuple):
    """How a metric is written for people."""

    words: str
    unit: str  # SI
    factor: float  # from SI to what is shown
    shown_unit: str


METRICS = {
    "rise_time": Shown("rise time (10-90 %)", "s", 1e3, "ms"),
    "overshoot": Shown("overshoot", "", 1e2, "%"),
    "settling_time": Shown("settling time (2 %)", "s", 1e3, "ms"),
    "steady_error": Shown("steady error", "m", 1e3, "mm"),
    "rms_error": Shown("rms error", "m", 1e3, "mm"),
    "max_error": Shown("largest error", "m", 1e3, "mm"),
    "limit_cycle_amplitude": Shown("limit cycle amplitude", "m", 1e3, "mm"),
    "limit_cycle_frequency": Shown("limit cycle frequency", "Hz", 1.0, "Hz"),
    "peak_p1": Shown("peak p1", "Pa", 1e-5, "bar"),
    "peak_p_lower": Shown("peak p_lower", "Pa", 1e-5, "bar"),
    "peak_p_upper": Shown("peak p_upper", "Pa", 1e-5, "bar"),
    "min_p_lower": Shown("least p_lower", "Pa", 1e-5, "bar"),
    "min_p_upper": Shown("least p_upper", "Pa", 1e-5, "bar"),
    "valve_travel": Shown("valve travel", "", 1.0, "travels"),
}
assert set(METRICS) == set(Metrics._fields)
_BAND = re.compile(r"\s*(.+?)\s*(<=|>=)\s*(.+?)\s*")
_CYCLE = re.compile(r"\s*limit cycle\s*:\s*(\w+)\s*")
SMALLEST_CYCLE = 1e-9  # [m]; what the metrics call no limit cycle is exactly zero


def value_with_unit(metric: str, value: float | None) -> str:
    """A metric as people read it."""
    shown = METRICS[metric]
    return "-" if value is None or value != value else f"{value * shown.factor:.4g} {shown.shown_unit}"


def parse_band(text: str) -> Band:
    """The band that a text states. Raises ValueError naming the nearest valid metric or unit."""
    if cycle := _CYCLE.fullmatch(text):
        return _cycle_band(text, cycle[1])
    match = _BAND.fullmatch(text)
    if match is None:
        raise ValueError(
            f"expect {text!r}: write 'metric <= value unit', 'metric >= value unit' or 'limit cycle: none'"
        )
    metric = match[1].replace(" ", "_").replace("-", "_")
    if metric not in METRICS:
        near = difflib.get_close_matches(metric, METRICS, n=1, cutoff=0.0)[0].replace("_", " ")
        valid = ", ".join(name.replace("_", " ") for name in METRICS)
        raise ValueError(f"expect {text!r}: no metric {match[1]!r}; nearest: {near!r} (valid: {valid})")
    try:
        return Band(metric, match[2], quantity(match[3], METRICS[metric].unit))
    except ValueError as error:
        raise ValueError(f"expect {text!r}: {error}") from None


def _cycle_band(text: str, word: str) -> Band:
    if word == "none":
        return Band("limit_cycle_amplitude", "<=", 0.0)
    if word == "present":
        return Band("limit_cycle_amplitude", ">=", SMALLEST_CYCLE)
    raise ValueError(f"expect {text!r}: a limit cycle is 'none' or 'present'")
