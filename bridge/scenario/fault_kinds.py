"""The kinds of faults: what each target can suffer, and the numbers that describe it.

A number's unit "*" is that of the channel it concerns. All defaults are assumed.
"""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

LONGEST = 10.0  # [s], of delays and memories
REQUIRED = None
LAWS = ("constant", "uniform", "normal", "exponential", "bursts", "growing")


class Size(NamedTuple):
    """One number of a fault."""

    unit: str
    default: float | None  # None: has to be given
    low: float
    high: float
    words: str


class Kind(NamedTuple):
    """A kind of fault."""

    words: str
    sizes: Mapping[str, Size] = MappingProxyType({})
    lasting: bool = False  # it has to end: `lasts` is required


def _share(default: float | None, words: str, high: float = 1.0) -> Size:
    return Size("", default, 0.0, high, words)


def _time(default: float | None, words: str, low: float = 0.0, high: float = LONGEST) -> Size:
    return Size("s", default, low, high, words)


def _factor(default: float, words: str, low: float = 0.0, high: float = 1e6) -> Size:
    return Size("", default, low, high, words)


OVER = {"over": _time(0.0, "time in which it comes about, linearly", high=1e6)}
SPELLS = {
    "share": _share(0.2, "of the time", 0.99),
    "length": _time(20e-3, "mean time of one spell", 1e-6),
}
LINK: dict[str, Kind] = {
    "delay": Kind(
        "messages come later; none overtakes another, as over TCP",
        {
            "time": _time(5e-3, "delay; of law 'bursts' in a burst; of 'growing' at the start"),
            "spread": _time(0.0, "uniform: +- this; normal: standard deviation; exponential: mean, added to time"),
            "share": _share(0.1, "law 'bursts': of the messages", 0.99),
            "length": Size("", 10.0, 1.0, 1e6, "law 'bursts': mean length, messages"),
            "growth": Size("", 0.0, 0.0, 100.0, "law 'growing': seconds per second"),
        },
    ),
    "loss": Kind("messages are lost, each by itself", {"share": _share(0.1, "of the messages")}),
    "burst-loss": Kind(
        "messages are lost in bursts: Gilbert (1960), Elliott (1963), all in a bad state and none in a good one",
        {
            "share": _share(0.1, "of the messages, in the mean", 0.99),
            "length": Size("", 5.0, 1.0, 1e6, "mean length of a burst, messages"),
        },
    ),
    "duplicate": Kind(
        "messages come twice",
        {"share": _share(0.1, "of the messages"), "time": _time(0.0, "the copy comes so much later")},
    ),
    "reorder": Kind(
        "some messages are held back, so that others overtake them",
        {"share": _share(0.1, "of the messages"), "time": _time(20e-3, "held back for so long")},
    ),
    "freeze": Kind("nothing passes; at the end all comes at once", lasting=True),
    "clock": Kind(
        "the sender's clock is wrong: the times in its messages",
        {
            "offset": _time(0.0, "it is ahead by this", -LONGEST),
            "drift": Size("", 0.0, -0.5, 0.5, "and gains so many seconds per second"),
        },
    ),
}
SENSOR: dict[str, Kind] = {
    "off": Kind("reads 0"),
    "stuck": Kind("keeps its last value"),
    "bias": Kind("reads too much", {"size": Size("*", REQUIRED, -math.inf, math.inf, "added")}),
    "drift": Kind("reads more and more", {"rate": Size("*", REQUIRED, -math.inf, math.inf, "added per second")}),
    "gain": Kind("reads a multiple", {"factor": Size("", 1.1, -100.0, 100.0, "of the true value")}),
    "noise": Kind("more noise", {"size": Size("*", REQUIRED, 0.0, math.inf, "standard deviation, white")}),
    "spikes": Kind(
        "single wrong scans",
        {"size": Size("*", REQUIRED, -math.inf, math.inf, "added"), "share": _share(0.01, "of the scans")},
    ),
    "quantisation": Kind("a coarser resolution", {"size": Size("*", REQUIRED, 1e-12, math.inf, "of one step")}),
    "saturation": Kind(
        "a narrower range",
        {
            "low": Size("*", -math.inf, -math.inf, math.inf, "its end"),
            "high": Size("*", math.inf, -math.inf, math.inf, ""),
        },
    ),
    "wrong-channel": Kind("wired to another transducer, `instead`; the volts are that one's"),
    "delay": Kind("reads what was", {"time": _time(20e-3, "so long ago")}),
    "intermittent": Kind("reads 0 in spells", SPELLS),
}
VALVE: dict[str, Kind] = {
    "stuck": Kind("the spool stays where it is"),
    "slow": Kind("the spool's dynamics and rate are slower", {"factor": _factor(0.2, "of its speed", 1e-3, 1.0)}),
    "dead-band": Kind("small commands do nothing", {"width": _share(0.05, "of the travel, to either side", 0.99)}),
    "bias": Kind("an offset of the command", {"size": Size("", 0.05, -1.0, 1.0, "share of the travel")}),
    "saturated": Kind("large commands are cut", {"limit": _share(0.3, "of the travel, to either side")}),
    "hysteresis": Kind("play between command and spool", {"width": _share(0.05, "of the travel, whole")}),
    "power-loss": Kind("the spool goes where it goes without power"),
    "reversed": Kind("the wiring is reversed"),
    "contaminated": Kind("the spool sticks in spells", SPELLS),
}
BURST = {
    "burst": Kind(
        "a hole to the outside at the cylinder's end", {"diameter": Size("m", 1e-3, 1e-6, 0.1, "of the hole")}
    )
}
PLANT: dict[str, dict[str, Kind]] = {
    "pump": {
        "speed-drop": Kind("it turns slower", {"factor": _factor(0.5, "of its speed", 0.0, 1.0), **OVER}),
        "stop": Kind("it runs down", {"over": _time(0.3, "time to standstill, linearly", high=1e6)}),
        "wear": Kind("it leaks more", {"factor": _factor(5.0, "of its leakage", 1.0), **OVER}),
    },
    "oil": {
        "temperature": Kind("the oil warms or cools", {"to": Size("degC", REQUIRED, -20.0, 80.0, ""), **OVER}),
        "air": Kind(
            "air is trapped in the chambers, which makes their oil softer",
            {"factor": _factor(0.3, "of the bulk modulus", 1e-3, 1.0), **OVER},
        ),
    },
    "cylinder": {
        "leak": Kind("it leaks more across the piston", {"factor": _factor(10.0, "of its leakage"), **OVER}),
        "seal-wear": Kind(
            "a worn seal: less friction, more leakage",
            {
                "friction": _factor(0.5, "of its friction", 0.0, 10.0),
                "factor": _factor(10.0, "of its leakage"),
                **OVER,
            },
        ),
    },
    "pipe_3": {
        "burst": Kind("a hole to the outside at the cylinder", {"diameter": Size("m", 1e-3, 1e-6, 0.1, "of the hole")})
    },
    "pipe_4": {
        "burst": Kind("a hole to the outside at the cylinder", {"diameter": Size("m", 1e-3, 1e-6, 0.1, "of the hole")})
    },
    "filter": {"blocked": Kind("its resistance grows", {"factor": _factor(20.0, "of its pressure drop", 1.0), **OVER})},
    "relief": {
        "stuck-open": Kind(
            "its spring is broken, of two stages that of the pilot: a hundredth of its stiffness is left"
        ),
        "stuck-shut": Kind("it opens only at ten times its setting"),
        "setting": Kind("its setting is wrong", {"to": Size("Pa", REQUIRED, 1e3, 1e9, "opening pressure"), **OVER}),
    },
    "load": {
        "jump": Kind(
            "mass and force jump",
            {"mass": Size("kg", 0.0, -1e6, 1e6, "added"), "force": Size("N", 0.0, -1e9, 1e9, "added, upwards")},
        ),
        "lost": Kind("most of the mass falls off", {"factor": _factor(0.2, "of the mass that is left", 0.01, 1.0)}),
        "impact": Kind(
            "a blow from outside, as a constant force",
            {"impulse": Size("N s", REQUIRED, -1e6, 1e6, "upwards; over the time that it lasts")},
            lasting=True,
        ),
    },
    "valve": VALVE,
}
PROCESS: dict[str, Kind] = {
    "freeze": Kind("it is suspended", lasting=True),
    "crash": Kind("it is killed"),
    "restart": Kind("it is killed, and started again after `time`", {"time": _time(0.5, "of wall time")}),
    "slow": Kind("it loses a part of its processor", {"share": _share(0.5, "of the time in which it stands", 0.99)}),
}
PROCESSES = ("controller", "recorder", "network")
DIRECTIONS = ("measurement", "command")  # plant to controller, controller to plant
