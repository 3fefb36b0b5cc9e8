"""Control laws: from one sample of the rig and the target to the spool reference of the proportional valve.

A law is a pure function of sample, target, memory and its own gains; a user's own law has the same signature. Sign: a
positive spool reference lifts the piston. The thesis, chapter 5: u = -(s y1 + d y2), so the derivative acts on the
velocity of the piston and not on that of the error. A NaN in the sample gives a NaN command, which the plant refuses.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, Protocol

from controller.reference import Target


class Readings(dict[str, float]):
    """What further channels of the card read, by name, SI."""

    def __missing__(self, name: str) -> float:
        chosen = ", ".join(self) or "none"
        raise KeyError(f"{name} is not a channel of this scenario: put it into daq.channels (chosen: {chosen})")


NO_CHANNELS = Readings()
CLOSING = 0.25  # of the rest, at which a valve that has opened shuts again; assumed, docs/campaigns.md


class Sample(NamedTuple):
    stamp_ns: int  # [ns] since the start of the run
    position: float  # [m]
    velocity: float  # [m/s], tachometer; NaN when absent
    p1: float  # [Pa], before the relief valve
    p2: float  # [Pa], lower chamber
    p3: float  # [Pa], upper chamber
    channels: Mapping[str, float] = NO_CHANNELS  # further channels of the card, where the scenario chooses any


class TrueSample(NamedTuple):
    """A sample for a law that asks for what no card reads."""

    stamp_ns: int
    position: float
    velocity: float
    p1: float
    p2: float
    p3: float
    channels: Mapping[str, float]
    true: Any  # the true state of the rig at the stamp, by the names of the message PlantState


class Gains(NamedTuple):
    """Of `pd`, and what a user's law is given."""

    proportional: float  # P [1/m], spool (-1..1) per metre of error
    derivative: float  # D [s/m], spool per metre a second
    source: str  # of the velocity: "measured" | "backward" | "filtered"
    filter_time: float  # [s], lag of the filtered difference; 0.0 leaves the plain one
    sample_period: float  # T [s], > 0
    limit: float  # of the spool reference, 0..1
    overlap: float  # of the valve lands to jump over, 0..1 of travel; 0.0: no dead-band compensation
    rest: float = 0.0  # of h up to which a valve that is shut stays shut; 0.0: it is never at rest


class UserGains(NamedTuple):
    """What a user's law is given: the gains of `pd`, which it may use or not, and its own parameters."""

    proportional: float
    derivative: float
    source: str
    filter_time: float
    sample_period: float
    limit: float
    overlap: float
    rest: float
    parameters: Any  # by name, SI: as its module declares them, else what the scenario has under controller.parameters


class CGains(NamedTuple):
    """What a law in C is given."""

    sample_period: float  # T [s], > 0
    limit: float  # of the spool reference, 0..1
    overlap: float  # of the valve lands to jump over, 0..1 of travel; 0.0: no dead-band compensation
    parameters: dict[str, float]  # by name, SI


class RelayGains(NamedTuple):
    """Of `relay`."""

    derivative_time: float  # T_d [s], lead of the switching line
    source: str  # of the velocity, as in Gains
    filter_time: float  # [s], as in Gains
    sample_period: float  # T [s], > 0
    limit: float  # the spool reference in either direction, 0..1


class OpenLoopGains(NamedTuple):
    """Of `open_loop`."""

    limit: float  # of the spool reference, 0..1


class Jump(Protocol):
    """How the dead band is jumped over: part of the gains of `pd` and `pid`."""

    @property
    def limit(self) -> float: ...
    @property
    def overlap(self) -> float: ...
    @property
    def rest(self) -> float: ...


class Estimate(Protocol):
    """How the velocity is got: part of the gains of every law that needs it."""

    @property
    def source(self) -> str: ...
    @property
    def filter_time(self) -> float: ...
    @property
    def sample_period(self) -> float: ...


class Memory(NamedTuple):
    position: float  # [m], at the previous sample
    velocity: float  # [m/s], its estimate there
    opened: bool = False  # was the valve told to leave its rest?


Answer = tuple[float, Any] | tuple[float, Any, Any]  # spool, memory and, of a user's law, signals to be recorded
Law = Callable[[Sample, Target, Any, Any], Answer]  # memory is the law's own affair, None at first


def pd(sample: Sample, target: Target, memory: Memory | None, gains: Gains) -> tuple[float, Memory]:
    """Spool reference in proportion to h, dead band jumped over, then saturated."""
    opened = memory is not None and memory.opened
    h, memory = pd_output(sample, target, memory, gains)
    u, opened = jumped(h, opened, gains)
    return u, memory._replace(opened=opened)


def relay(sample: Sample, target: Target, memory: Memory | None, gains: RelayGains) -> tuple[float, Memory]:
    """Full limit in the direction of h = (x_ref - x) - T_d v, nothing at h = 0; the limit is what it says, with any
    overlap."""
    v = velocity(sample, memory, gains)
    h = target.position - sample.position - gains.derivative_time * v
    return gains.limit * sign(h), Memory(sample.position, v)


def open_loop(sample: Sample, target: Target, memory: Memory | None, gains: OpenLoopGains) -> tuple[float, Memory]:
    """The target is the spool reference itself, -1..1: only saturated, no dead band jumped over."""
    return saturate(target.position, gains.limit), Memory(sample.position, 0.0)


def pd_output(sample: Sample, target: Target, memory: Memory | None, gains: Gains) -> tuple[float, Memory]:
    """h = P (x_ref - x) - D v, before dead band and saturation."""
    v = velocity(sample, memory, gains)
    h = gains.proportional * (target.position - sample.position) - gains.derivative * v
    return h, Memory(sample.position, v)


def velocity(sample: Sample, memory: Memory | None, gains: Estimate) -> float:
    """Piston velocity [m/s] from the chosen source; a difference needs two samples and is 0 at the first.

    Raises ValueError when a tachometer is asked for and absent, and for an unknown source.
    """
    match gains.source:
        case "measured":
            return _measured(sample)
        case "backward":
            return _backward(sample, memory, gains.sample_period)
        case "filtered":
            return _filtered(sample, memory, gains)
    raise ValueError(f"velocity source {gains.source!r} is none of 'measured', 'backward', 'filtered'")


def _measured(sample: Sample) -> float:
    if math.isnan(sample.velocity):
        raise ValueError(
            f"velocity source 'measured', but the sample at {sample.stamp_ns} ns has no tachometer signal (NaN); "
            "use 'backward' or 'filtered'"
        )
    return sample.velocity


def _backward(sample: Sample, memory: Memory | None, sample_period: float) -> float:
    return 0.0 if memory is None else (sample.position - memory.position) / sample_period


def _filtered(sample: Sample, memory: Memory | None, gains: Estimate) -> float:
    """First-order lag of the backward difference, exact for a difference held over T: v = a v + (1-a) dx/T."""
    if memory is None:
        return 0.0
    a = math.exp(-gains.sample_period / gains.filter_time) if gains.filter_time > 0.0 else 0.0
    return a * memory.velocity + (1.0 - a) * _backward(sample, memory, gains.sample_period)


def compensate(u: float, overlap: float) -> float:
    """Spool reference that opens the valve as a valve without overlap would at u: the lands are jumped over."""
    return sign(u) * (overlap + (1.0 - overlap) * abs(u))


def jumped(h: float, opened: bool, gains: Jump) -> tuple[float, bool]:
    """The spool reference of h, the dead band jumped over, then saturated; and whether the valve has left its rest.

    A valve that jumps at every change of the sign of h never rests: noise of one reading sends it from land to land.
    With `rest` it is shut until |h| exceeds that, and shut again when |h| has come down to CLOSING of it.
    """
    u = saturate(compensate(h, gains.overlap), gains.limit)
    if gains.rest == 0.0:
        return u, False
    opened = not abs(h) <= gains.rest * (CLOSING if opened else 1.0)  # in this order a NaN stays NaN
    return (u if opened else 0.0), opened


def saturate(u: float, limit: float) -> float:
    """u within [-limit, limit]."""
    return max(min(u, limit), -limit)  # in this order a NaN stays NaN instead of opening the valve fully


def sign(u: float) -> float:
    """-1, 0 or 1; NaN stays NaN."""
    return math.copysign(1.0, u) if abs(u) > 0.0 else u


def per_metre(volts_per_percent: float, stroke: float, full_scale: float) -> float:
    """Proportional gain [1/m] from S [V per % of the stroke]; stroke [m], full scale of the valve's input [V]."""
    return volts_per_percent * 100.0 / (stroke * full_scale)


def volts_per_percent(per_metre: float, stroke: float, full_scale: float) -> float:
    """S [V per % of the stroke] from a proportional gain [1/m]; stroke [m], full scale of the valve's input [V]."""
    return per_metre * stroke * full_scale / 100.0
