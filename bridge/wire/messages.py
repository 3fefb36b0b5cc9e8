"""Every message, in one table: type, key, rate, direction, reliability.

Payloads are ROS 2 messages in CDR. Those of the loop are flat: 8-byte fields after the 4-byte CDR header, so that
`struct` alone can read and write them.
"""

import re
from collections.abc import Iterator
from enum import StrEnum
from functools import cache
from typing import Any, NamedTuple

from twin.topology import CHAMBERS, CHANNELS, HOLLOWS, LINES, OBSERVED, POINTS, PORTS, PRESSURES

PACKAGE = "hydrotwin_msgs/msg"
MEASURED = {name: f"[{channel.unit}]{channel.note}" for name, channel in CHANNELS.items()}
COMPARABLE = {name: f"[{channel.unit}]" for name, channel in CHANNELS.items()}


def _floats(comments: dict[str, str]) -> str:
    """Lines of a message definition, their comments one below the other."""
    width = max(map(len, comments))
    return "".join(f"float64 {name:{width}}  # {comment}\n" for name, comment in comments.items())


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


LOOP_MESSAGES: dict[str, str] = {
    "Measurement": """\
# One scan of the data acquisition: what the card read.
uint64 run_id
uint64 sequence
uint64 tick       # stamp = tick * DAQ period
int64 stamp       # simulated time since the start of the run [ns]
"""
    + _floats(MEASURED),
    "ValveCommand": """\
# One command to the proportional valve, held until the next one acts.
uint64 run_id
uint64 source        # random, one per controller: the first valid one owns the plant
uint64 sequence      # counts this controller's commands
int64 sample_stamp   # stamp of the measurement it answers [ns]
int64 apply_at       # when it acts [ns], a whole number of internal steps
float64 spool        # spool reference, -1 .. 1; positive lifts
""",
    "Reference": """\
# What the controller wanted at a sample.
uint64 run_id
uint64 source
uint64 sequence
int64 stamp       # [ns]
float64 position  # [m]; NaN for a law that follows none
float64 velocity  # [m/s]
""",
    "PlantState": "# The true state, unseen by the card.\nuint64 run_id\nuint64 sequence\nuint64 tick\nint64 stamp\n"
    + "float64 reference  # spool reference in force, -1 .. 1\n"
    + "".join(f"float64 {name}  # [{unit or 'share'}]\n" for name, unit in OBSERVED.items()),
    "LoopTiming": """\
# One tick in real time: wall-clock things, never part of the data.
uint64 run_id
uint64 sequence
uint64 tick
int64 stamp       # [ns] simulated
int64 lateness    # of the wake-up [ns] wall
int64 cost        # of integrating, sampling and publishing the measurement [ns] wall
int64 round_trip  # measurement out to its command in [ns] wall; -1 without a new one
int64 slack       # how long before it was needed the last command came [ns] wall; negative: late; 0 without one
""",
    "Residual": """\
# What came out of a replay, less what was recorded; NaN where there is nothing to compare.
uint64 run_id     # of the recorded run
uint64 sequence
int64 stamp       # [ns] of the measurement, of a command the sample it answers
"""
    + _floats(COMPARABLE | {"position": "[m], of measurements", "spool": "spool reference, of commands"}),
}

OTHER_MESSAGES: dict[str, str] = {
    "Channels": """\
# Further channels of the card, sampled at the stamp of the measurement with the same sequence.
# Then a float64 for each of the scenario's daq.channels, in their order.
# `hydrotwin messages --scenario X` prints the whole.
uint64 run_id
uint64 sequence
uint64 tick
int64 stamp       # [ns]
""",
    "Event": """\
# Something worth knowing about a run.
uint64 run_id
uint64 sequence
int64 stamp       # simulated [ns]
string kind       # started, ended, late, missed, refused, changed, fault, differs; of a controller: said;
                  # of the plant's safety: safe, latched, degraded, restored, alarm, cleared, reset, resumed
uint64 source     # of the command it is about, or of the controller that speaks, else 0
uint64 command    # its sequence; or the number of the timeline's entry, of the alarm; else 0
int64 apply_at    # when the command was to act [ns], else 0
int64 applied_at  # when it acted [ns], else 0
string text
""",
    "Signals": """\
# Numbers that a law logs at a sample, under names of its own: the same in every message of a run.
uint64 run_id
uint64 source
uint64 sequence
int64 stamp       # of the measurement it answers [ns]
string[] names    # letters, digits and _
string[] units    # SI; of a number without one, empty
float64[] values
""",
    "LineProfile": f"""\
# Pressure along the six lines, and where there is a cavity.
uint64 run_id
uint64 sequence
uint64 tick
int64 stamp          # simulated [ns]
uint64 places        # in a line ({POINTS}), evenly spaced from its first end, behind a fitting, to its second
float64[] pressure   # [Pa] gauge, line after line, in each place after place: that of line i at place j, from 0,
                     # is pressure[i * places + j]
float64[] cavity     # [m^3] of vapour, in this order: {", ".join(CHAMBERS)} (chambers);
                     # {", ".join(PORTS)} (line ends); {HOLLOWS[-LINES]} .. {HOLLOWS[-1]} (inside)
""",
    "Status": """\
# How a process is doing.
uint64 run_id
uint64 sequence
int64 stamp       # simulated [ns]
string role       # plant, controller, recorder
string phase      # running, degraded, safe, latched; at the end: ended, interrupted, failed
uint64 pid
string[] names    # of the values
float64[] values
string text       # what else there is to say; of a failure the reason
""",
}

STANDARD_MESSAGES: dict[str, str] = {  # of ROS 2, for its tools
    "builtin_interfaces/msg/Time": "int32 sec\nuint32 nanosec\n",
    "std_msgs/msg/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    "std_msgs/msg/Empty": "",
    "sensor_msgs/msg/JointState": """\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
""",
    "sensor_msgs/msg/FluidPressure": "std_msgs/Header header\nfloat64 fluid_pressure\nfloat64 variance\n",
}


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


TEXTS = {_own(name): text for name, text in (LOOP_MESSAGES | OTHER_MESSAGES).items()} | STANDARD_MESSAGES
CHANNELS_TOPIC = "channels"
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


OF_SOME_RUNS = (CHANNELS_TOPIC, "signals", "said")  # topics that most runs do not have, nor their recordings
SOURCED = ("command", "reference", "signals", "said")  # topics on which several sources may speak
TOLD = ("event", "said")  # topics of events
