"""What the messages on the health of a rig hold, from the table of what can be wrong with it."""

from bridge.wire.definitions import floats
from bridge.wire.estimates import DEVIATION, codes
from twin.estimation.hypotheses import HYPOTHESES, Verdict
from twin.estimation.quantities import UNKNOWNS

DEVIATE, SIZE = "_deviate", "_size"  # behind the name of a hypothesis
PLACES = tuple(HYPOTHESES)  # of the hypotheses in `suspects` and `first`


def _findings() -> dict[str, str]:
    found: dict[str, str] = {}
    for name, hypothesis in HYPOTHESES.items():
        unit = UNKNOWNS[hypothesis.unknown].unit
        found[name + DEVIATE] = f"normal deviate, {hypothesis.words}; NaN: not known"
        found[name + SIZE] = f"[{unit}]" if unit else "ln of the factor since the commissioning"
        found[name + SIZE + DEVIATION] = f"[{unit}], standard deviation" if unit else "standard deviation"
    return found


HEALTH_MESSAGES = {
    "Health": f"""\
# Which fault explains how the unknowns of the estimate have left their baseline.
uint64 run_id
uint64 sequence
uint64 tick       # of the measurement
int64 stamp       # of it [ns]
uint64 verdict    # {codes(Verdict)}
uint64 suspects   # a bit for each that is likely: {", ".join(f"{1 << k} {name}" for k, name in enumerate(PLACES))}
int64 first       # the likeliest, the number of its bit; -1 none
"""
    + "uint64 explained  # 1: the estimate agrees with the readings, sizes are to be believed\n"
    + floats({"limit": "of the deviates, beyond which it is an alarm"})
    + floats({"confidence": "share of the first in the likelihood of all", "since": "[s], beyond the limit since"})
    + floats(_findings())
}
