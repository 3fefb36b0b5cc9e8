"""What can be wrong with a drive, as directions in which the unknowns of an estimate move. Plain data, without numba.

One hypothesis moves one unknown, up, down or either way; the rest of the drive is as it was.
"""

import math
from enum import IntEnum
from typing import NamedTuple

from twin.estimation.quantities import LEAK, UNKNOWNS
from twin.topology import PRESSURES

EITHER, UP, DOWN = 0, 1, -1
SHOWN = {  # units of offsets, for people
    LEAK: (60e3 * 100e5, "l/min at 100 bar"),
    "Pa": (1e-5, "bar"),
    "m": (1e3, "mm"),
    "m/s": (1e3, "mm/s"),
}
CREEP = 3e-10  # [m/(s Pa)], of the piston by the unit of leaks to the outside: 3 mm/s at 100 bar, assumed

WATCHED = {  # deviation at the start and drift per sqrt(s) of unknowns whose faults are looked for, all assumed
    "leakage": (0.5, 0.03),  # leaks grow by factors
    "valve_offset": (0.003, 0.0003),  # of the travel
    "filter_drop": (0.5, 0.03),  # of a filter that becomes dirty
    "mass": (0.0, 0.0),  # certain: another load is found by its weight, as load_force
    **{f"offset_{name}": (0.5e5, 0.03e5) for name in PRESSURES},  # [Pa]: 1 bar in a minute is 0.13 bar per sqrt(min)
}


class Verdict(IntEnum):
    """On the whole drive."""

    NOT_KNOWN = 0  # the estimate is lost, or has not followed for long enough
    COMMISSIONING = 1
    HEALTHY = 2
    ONE_OF = 3  # a fault, of which several are likely
    FAULT = 4


class Hypothesis(NamedTuple):
    """One of them."""

    words: str
    unknown: str  # of UNKNOWNS
    sign: int  # EITHER, UP, DOWN


HYPOTHESES = {
    "leak_across": Hypothesis("leak across the piston", "leakage", UP),
    "leak_outside_lower": Hypothesis("leak of the lower chamber to the outside", "leak_lower", UP),
    "leak_outside_upper": Hypothesis("leak of the upper chamber to the outside", "leak_upper", UP),
    "friction": Hypothesis("friction of the actuator: a worn seal has less, a stiff one more", "friction", EITHER),
    "air_in_oil": Hypothesis("air in the oil, a lower bulk modulus", "bulk_modulus", DOWN),
    "valve_gain": Hypothesis("gain of the directional valve", "valve_gain", EITHER),
    "valve_offset": Hypothesis("offset of the directional valve's spool", "valve_offset", EITHER),
    "filter_blocked": Hypothesis("blocked filter, a larger pressure drop", "filter_drop", UP),
    "pump_wear": Hypothesis("worn pump, a higher leak", "pump_leakage", UP),
    "pump_flow": Hypothesis("slow pump, less flow without a load", "pump_flow", DOWN),
    "relief_setting": Hypothesis("setting of the relief valve", "relief_setting", EITHER),
    "load": Hypothesis("another load", "load_force", EITHER),
    **{
        f"sensor_{name}": Hypothesis(f"offset or drift of the transducer of {name}", f"offset_{name}", EITHER)
        for name in PRESSURES
    },
}


def in_words(name: str, size: float, deviation: float) -> str:
    """What a hypothesis says, with its size since the commissioning: the factor on its unknown, or an offset."""
    unit = UNKNOWNS[HYPOTHESES[name].unknown].unit
    scale, shown = SHOWN.get(unit, (1.0, unit))
    if unit:
        return f"{HYPOTHESES[name].words}, {scale * size + 0.0:+.3g} {shown} (+- {scale * deviation:.2g})"
    low, high = math.exp(size - deviation), math.exp(size + deviation)
    return f"{HYPOTHESES[name].words}, {math.exp(size):.3g} times ({low:.3g} to {high:.3g})"
