"""Every message, in one table: type, key, rate, direction, reliability.

Payloads are ROS 2 messages in CDR. Those of the loop are flat: 8-byte fields after the 4-byte CDR header, so that
`struct` alone can read and write them.
"""

import re
from collections.abc import Iterator
from enum import StrEnum
from functools import cache
from typing import Any, NamedTuple

from bridge.wire.definitions import LOOP_MESSAGES, OTHER_MESSAGES, STANDARD_MESSAGES
from bridge.wire.estimates import ESTIMATE_MESSAGES
from bridge.wire.health import HEALTH_MESSAGES
from twin.topology import PRESSURES

PACKAGE = "hydrotwin_msgs/msg"


class Mode(StrEnum):
    """What paces the loop."""

    INPROCESS = "inprocess"
    LOCKSTEP = "lockstep"
    REALTIME = "realtime"


class SafetyState(StrEnum):
    """How far a plant trusts its loop: docs/safety.md."""

    RUNNING = "running"
    DEGRADED = "degraded"  # an alarm is there; commands act, as far as `safety.degraded_limit` lets them
    SAFE = "safe"  # commands do not act; the next valid one ends it, once no alarm keeps it
    LATCHED = "latched"  # commands do not act until somebody says reset


class OnOverrun(StrEnum):
    """What a plant in real time does when a tick came a period late, or later."""

    CATCH_UP = "catch-up"  # missed ticks follow back to back until it is in time again
    SKIP = "skip"  # it goes on at the pace of the clock, and stays behind it by whole periods
    STOP = "stop"  # the run ends once more or longer ones than `real_time` allows have happened


class OnTrip(StrEnum):
    """What the valve does in the safe state."""

    SHUT_OFF = "shut-off"  # it loses its power: springs centre it, a servo valve goes to `power_off`
    CENTRE = "centre"  # it keeps its power and is told 0
    HOLD = "hold"  # the last command goes on
    RAMP = "ramp"  # from the last command to 0 over `safety.ramp`
    RETREAT = "retreat"  # `safety.retreat_spool` until the piston is at `safety.retreat_position`, then 0


class Phase(StrEnum):
    """How a process is doing, as its status says."""

    RUNNING = "running"
    DEGRADED = "degraded"
    SAFE = "safe"
    LATCHED = "latched"
    ENDED = "ended"
    INTERRUPTED = "interrupted"
    FAILED = "failed"


GOING = (Phase.RUNNING, Phase.DEGRADED, Phase.SAFE, Phase.LATCHED)  # the others are last words


class EventKind(StrEnum):
    """What has happened in a run."""

    STARTED = "started"
    ENDED = "ended"
    LATE = "late"
    MISSED = "missed"  # commands of a controller never came, or were refused without an event of their own
    REFUSED = "refused"
    SAFE = "safe"  # commands do not act any more: the plant is safe, or latched where it takes a reset
    LATCHED = "latched"  # a plant that was safe is latched now
    DEGRADED = "degraded"  # an alarm is there, and the plant goes on
    RESTORED = "restored"  # the last alarm of a degraded plant is gone
    ALARM = "alarm"  # an alarm has come that changes no state
    CLEARED = "cleared"  # an alarm is gone, which changes no state
    RESET = "reset"
    RESUMED = "resumed"
    CHANGED = "changed"  # a number of the rig or of the controller: by the timeline, or set by somebody
    FAULT = "fault"  # one begins or ends, or somebody has injected one
    DIFFERS = "differs"  # a controller runs another scenario than the plant
    SAID = "said"  # a law has printed or logged a line: the only one of a controller, on a topic of its own


COMING = (EventKind.SAFE, EventKind.LATCHED, EventKind.DEGRADED, EventKind.ALARM)  # with a number: an alarm has come
ALARMING = (  # of the plant's safety, besides `safe` and what ends it
    *(EventKind.DEGRADED, EventKind.LATCHED, EventKind.RESTORED, EventKind.ALARM, EventKind.CLEARED),
)


class Reason(StrEnum):
    """Why a command was refused."""

    UNDECODABLE = "undecodable"
    LATCHED = "latched"
    ALARM = "alarm"
    FOREIGN_RUN = "foreign run"
    NOT_FINITE = "not finite"
    OUT_OF_RANGE = "out of range"
    SECOND_CONTROLLER = "second controller"
    OUT_OF_ORDER = "out of order"
    STALE = "stale"
    IMPOSSIBLE_TIME = "impossible time"
    FAR_FUTURE = "far future"
    OFF_THE_GRID = "off the grid"


class Ending(StrEnum):
    """How a run came to its end."""

    COMPLETE = "complete"
    INTERRUPTED = "interrupted"
    FAILED = "failed"
    CUT_OFF = "cut off"  # the recording does not say


class Topic(NamedTuple):
    """One key of a rig and what travels on it."""

    name: str  # below the rig's name
    type: str  # ROS 2 type
    publisher: str
    rate: str
    data: bool  # simulated quantities only: identical between lockstep, in-process and a clean real-time run
    express: bool  # sent at once, in real time at the highest priority
    delivery: str = "drop what does not fit"  # in real time; in lockstep all are reliable and block


def _own(name: str) -> str:
    return f"{PACKAGE}/{name}"


TEXTS = {
    _own(name): text for name, text in (LOOP_MESSAGES | ESTIMATE_MESSAGES | HEALTH_MESSAGES | OTHER_MESSAGES).items()
} | STANDARD_MESSAGES
CHANNELS_TOPIC = "channels"
ESTIMATE, INNOVATION, HEALTH = "estimate", "innovation", "health"
VARYING = _own("Channels")  # the type whose fields follow from the scenario
RULE = "=" * 80  # between the types of a schema


def of_tap(tap: str) -> str:
    """The topic of a pressure for viewers."""
    return f"pressure/{tap}"


TOPICS: dict[str, Topic] = {
    topic.name: topic
    for topic in (
        Topic("measurement", _own("Measurement"), "plant", "DAQ period", True, True),
        Topic(CHANNELS_TOPIC, _own("Channels"), "plant", "DAQ period, with daq.channels", True, True),
        Topic("command", _own("ValveCommand"), "controller", "sample period", True, True),
        Topic("reference", _own("Reference"), "controller", "sample period", True, False),
        Topic("signals", _own("Signals"), "controller", "sample period, of a law that logs any", True, False),
        Topic("said", _own("Event"), "controller", "as a law prints or logs a line", True, False),
        Topic("state", _own("PlantState"), "plant", "DAQ period", True, False),
        Topic("event", _own("Event"), "plant", "as it happens", True, False),
        Topic("joint", "sensor_msgs/msg/JointState", "plant", "viewer period", True, False),
        *(
            Topic(of_tap(tap), "sensor_msgs/msg/FluidPressure", "plant", "viewer period", True, False)
            for tap in PRESSURES
        ),
        Topic("lines", _own("LineProfile"), "plant", "viewer period", True, False),
        Topic("timing", _own("LoopTiming"), "plant", "DAQ period, real time only", False, False),
        Topic(
            "status",
            _own("Status"),
            "all",
            "10 Hz of wall time, and at the end",
            False,
            False,
            "drop; the last one blocks",
        ),
        Topic(ESTIMATE, _own("Estimate"), "follower", "correction, 5 DAQ periods", True, False),
        Topic(INNOVATION, _own("Innovation"), "follower", "correction, 5 DAQ periods", True, False),
        Topic(HEALTH, _own("Health"), "follower", "0.5 s, of one that judges", True, False),
        Topic("residual", _own("Residual"), "replay", "as the replay goes", False, False),
        Topic("reset", "std_msgs/msg/Empty", "anybody", "to leave the safe state", False, False, "block"),
    )
}


class Outgoing(NamedTuple):
    """A message on its way: topic name, log time [ns of simulated time], publisher's sequence, message."""

    topic: str
    log_time: int
    sequence: int
    message: Any


def encoding(kind: str) -> str:
    """What a publication says of its payload."""
    return f"application/cdr;{kind}"


def definition(kind: str) -> str:
    """The `.msg` text of a type, with those it needs: a `ros2msg` schema."""
    first, *needed = dict.fromkeys(_with_needed(kind))
    return _bare(first) + "".join(f"{RULE}\nMSG: {_short(name)}\n{_bare(name)}" for name in needed)


def _with_needed(kind: str) -> Iterator[str]:
    yield kind
    for field in fields_of(kind):
        if "/" in field.type:
            yield from _with_needed(field.type.replace("/", "/msg/"))


def _bare(kind: str) -> str:
    return "".join(f"{field.type} {field.name}\n" for field in fields_of(kind))


def _short(kind: str) -> str:
    return kind.replace("/msg/", "/")


def described(kind: str) -> str:
    """The `.msg` text of a type for people: ours with its comments."""
    return TEXTS[kind] if kind.startswith(PACKAGE) else definition(kind)


class Field(NamedTuple):
    """One field of a message."""

    type: str
    name: str


def fields_of(kind: str) -> list[Field]:
    """The fields of a message type, in order."""
    return [Field(*found) for found in _FIELD.findall(TEXTS[kind])]


_FIELD = re.compile(r"^([\w/\[\]]+) +(\w+)", re.MULTILINE)
_CODES = {"uint64": "Q", "int64": "q", "float64": "d"}


@cache
def struct_format(kind: str) -> str | None:
    """The `struct` format of a flat message, header skipped; None for one with strings or arrays."""
    codes = [_CODES.get(field.type, "") for field in fields_of(kind)]
    return "<4x" + "".join(codes) if codes and all(codes) else None


def flat_size(kind: str) -> int | None:
    """Bytes of a flat message, header included; None for others, and where it depends on the scenario."""
    layout = None if kind == VARYING else struct_format(kind)
    return None if layout is None else 4 + 8 * (len(layout) - 3)


def field_names(kind: str) -> list[str]:
    """The names of a message type's fields, in order."""
    return [field.name for field in fields_of(kind)]


OF_SOME_RUNS = (
    CHANNELS_TOPIC,
    "signals",
    "said",
    ESTIMATE,
    INNOVATION,
    HEALTH,
)  # topics that most runs do not have, nor their recordings
SOURCED = ("command", "reference", "signals", "said")  # topics on which several sources may speak
TOLD = ("event", "said")  # topics of events
