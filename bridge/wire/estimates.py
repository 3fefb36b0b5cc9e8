"""What the messages of a twin beside a rig hold, from the tables of what it estimates."""

from enum import IntEnum

from bridge.wire.definitions import floats
from twin.estimation.quantities import ESTIMATED, UNKNOWNS, Standing, Use
from twin.topology import CHANNELS

DEVIATION = "_sd"  # behind the name of what it is the standard deviation of
OF_UNKNOWN = "unknown_"  # before the name of one of UNKNOWNS


def codes(kind: type[IntEnum]) -> str:
    """What the numbers of a code mean, in a comment."""
    return ", ".join(f"{code.value} {code.name.lower()}" for code in kind)


def _with_deviation(name: str, unit: str, words: str = "") -> dict[str, str]:
    return {name: f"[{unit}]{words}", name + DEVIATION: f"[{unit}], standard deviation"}


def _estimated() -> dict[str, str]:
    found: dict[str, str] = {}
    for name, unit in ESTIMATED.items():
        found |= _with_deviation(name, unit or "share")
    for name, unknown in UNKNOWNS.items():
        found |= _with_deviation(OF_UNKNOWN + name, unknown.unit or "factor", f", {unknown.words}; NaN: not estimated")
    return found


def _innovations() -> dict[str, str]:
    found: dict[str, str] = {}
    for name, channel in CHANNELS.items():
        found |= _with_deviation(name, channel.unit)
        found |= {f"{name}_use": f"{codes(Use)}"}
        found |= {f"{name}_nis": "mean square, 1 for a right model", f"{name}_whiteness": "correlation, 0 for one"}
    return found


ESTIMATE_MESSAGES = {
    "Estimate": f"""\
# What a twin beside the rig makes of its measurements, after a correction: means and standard deviations.
uint64 run_id
uint64 sequence
uint64 tick       # of the measurement
int64 stamp       # of it [ns]
uint64 standing   # {codes(Standing)}
"""
    + floats(_estimated()),
    "Innovation": """\
# Whether measurements and estimate agree: of each channel the reading less what was expected of it, and what is made
# of it; over the last 1000 readings the mean square of the whitened innovations, and their correlation from one to the
# next.
uint64 run_id
uint64 sequence
uint64 tick       # of the measurement
int64 stamp       # of it [ns]
"""
    + floats(_innovations()),
}
