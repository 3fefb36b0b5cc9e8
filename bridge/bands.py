"""What a scenario expects, in words: "overshoot <= 5 %", "limit cycle: none", "peak p_lower <= 80 bar"."""

import difflib
import re

from bridge.units import quantity
from controller.metrics import Band, Metrics

METRIC_UNITS = {
    "rise_time": "s",
    "overshoot": "",
    "settling_time": "s",
    "steady_error": "m",
    "rms_error": "m",
    "max_error": "m",
    "limit_cycle_amplitude": "m",
    "limit_cycle_frequency": "Hz",
    "peak_p1": "Pa",
    "peak_p_lower": "Pa",
    "peak_p_upper": "Pa",
    "min_p_lower": "Pa",
    "min_p_upper": "Pa",
    "valve_travel": "",
}
assert set(METRIC_UNITS) == set(Metrics._fields)
_BAND = re.compile(r"\s*(.+?)\s*(<=|>=)\s*(.+?)\s*")
_CYCLE = re.compile(r"\s*limit cycle\s*:\s*(\w+)\s*")
SMALLEST_CYCLE = 1e-9  # [m]; what the metrics call no limit cycle is exactly zero


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
    if metric not in METRIC_UNITS:
        near = difflib.get_close_matches(metric, METRIC_UNITS, n=1, cutoff=0.0)[0].replace("_", " ")
        valid = ", ".join(name.replace("_", " ") for name in METRIC_UNITS)
        raise ValueError(f"expect {text!r}: no metric {match[1]!r}; nearest: {near!r} (valid: {valid})")
    try:
        return Band(metric, match[2], quantity(match[3], METRIC_UNITS[metric]))
    except ValueError as error:
        raise ValueError(f"expect {text!r}: {error}") from None


def _cycle_band(text: str, word: str) -> Band:
    if word == "none":
        return Band("limit_cycle_amplitude", "<=", 0.0)
    if word == "present":
        return Band("limit_cycle_amplitude", ">=", SMALLEST_CYCLE)
    raise ValueError(f"expect {text!r}: a limit cycle is 'none' or 'present'")
