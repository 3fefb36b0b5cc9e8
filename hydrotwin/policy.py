"""What a policy sees of a rig and how it drives it: the same in the environment of `hydrotwin.gym` and as a law.

A policy is a function from an observation to an action, arrays of float32. It needs no gymnasium.
"""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import UsageError
from bridge.scenario import Scenario
from bridge.scenario.gains import scale_of
from controller import law as laws
from controller.law import Sample, compensate, saturate
from controller.reference import Target
from hydrotwin.runs import Changes, load

Array = NDArray[np.float32]
Policy = Callable[[Array], Any]
SIZES = {  # SI: what an entry of an observation is divided by
    "error": 0.01,  # [m], reference - position as measured
    "reference": 0.1,  # [m]
    "reference velocity": 0.1,  # [m/s]
    "position": 0.1,  # [m], as the card read it
    "velocity": 0.1,  # [m/s], as the scenario's controller gets it
    "p1": 1e7,  # [Pa], as the card read it
    "p2": 1e7,  # [Pa]
    "p3": 1e7,  # [Pa]
}  # and the last actions, the newest first
LIMIT = 10.0  # of every entry, either way
_SIZES = tuple(SIZES.values())


class Estimate(NamedTuple):
    """How the velocity is got, as the laws of `controller.law` take it."""

    source: str
    filter_time: float  # [s]
    sample_period: float  # [s]


class Memory(NamedTuple):
    """What is carried from sample to sample."""

    seen: laws.Memory | None  # at the previous sample
    actions: tuple[float, ...]  # the newest first


class Interface(NamedTuple):
    """Between a policy and a rig: observations one way, spool references the other."""

    estimate: Estimate
    overlap: float  # of the valve's lands that is jumped over, 0..1 of travel
    limit: float  # of the spool reference, 0..1
    actions: int  # last actions in an observation

    @property
    def start(self) -> Memory:
        """Before the first sample: the valve is centred."""
        return Memory(None, (0.0,) * self.actions)

    @property
    def most(self) -> Array:
        """The greatest observation; the least is its negative."""
        return np.array([LIMIT] * len(SIZES) + [1.0] * self.actions, np.float32)

    def observe(self, sample: Sample, target: Target, memory: Memory) -> tuple[Array, Memory]:
        """The observation at a sample."""
        v, error = laws.velocity(sample, memory.seen, self.estimate), target.position - sample.position
        wanted, pressures = (target.position, target.velocity), (sample.p1, sample.p2, sample.p3)
        values = zip((error, *wanted, sample.position, v, *pressures), _SIZES, strict=True)
        seen = [saturate(value / size, LIMIT) for value, size in values]  # numpy would take longer
        return np.array([*seen, *memory.actions], np.float32), Memory(laws.Memory(sample.position, v), memory.actions)

    def spool(self, action: float) -> float:
        """The spool reference of an action, -1..1."""
        return saturate(compensate(action, self.overlap), self.limit)


def interface_of(scenario: Scenario, compensate_overlap: bool | None = None, actions: int | None = None) -> Interface:
    """Of a scenario: the velocity as its controller has it, the overlap jumped as there unless it is said.

    actions: how many of the last are seen; as many as may be on their way to the valve, and one at least.
    """
    loop, controller, scale = scenario.loop, scenario.controller, scale_of(scenario)
    if not controller.follows:
        raise UsageError(
            f"{scenario.name}: its reference is a spool position, so there is no error to see; take a scenario whose "
            "reference is a position, or set controller.kind = 'pd'"
        )
    if loop.offset >= scenario.duration:
        raise UsageError(
            f"{scenario.name}: loop.offset {loop.offset:g} s is not before the end at {scenario.duration:g} s: "
            "there is no sample to act on"
        )
    share = controller.jumped_share if compensate_overlap is None else float(compensate_overlap)
    source = getattr(controller, "velocity", "measured" if scenario.daq.tachometer else "backward")
    estimate = Estimate(source, getattr(controller, "filter_time", 0.0), loop.sample_period)
    return Interface(estimate, share * scale.overlap, controller.limit, _number(actions, under_way(loop)))


def under_way(loop: Any) -> int:
    """How many commands a delay of the loop keeps on their way at most."""
    return max(1, math.ceil(loop.delay / loop.sample_period - 1e-9))


def _number(actions: Any, own: int) -> int:
    if actions is None:
        return own
    if isinstance(actions, bool) or not isinstance(actions, int) or actions < 1:
        raise UsageError(f"actions {actions!r}: how many of the last an observation holds, 1 or more")
    return actions


def command_of(action: Any) -> float:
    """The number in an action, -1..1; what is beyond is cut off. Raises UsageError for what is not one number."""
    try:
        found = np.asarray(action, np.float64)
    except (TypeError, ValueError):
        raise UsageError(f"action {action!r:.60} is not an array of numbers") from None
    if found.shape != (1,):
        raise UsageError(f"action has shape {found.shape}, expected (1,): the spool command, -1 to 1")
    number = float(found[0])
    if not math.isfinite(number):
        raise UsageError(f"action is {number}, expected a number from -1 to 1")
    return min(max(number, -1.0), 1.0)


class PolicyLaw:
    """A policy as a control law."""

    def __init__(self, interface: Interface, policy: Policy) -> None:
        self._interface = interface
        self._policy = policy

    def __call__(self, sample: Sample, target: Target, memory: Memory | None, gains: Any) -> tuple[float, Memory]:
        """The spool reference for a sample."""
        observation, memory = self._interface.observe(sample, target, memory or self._interface.start)
        action = command_of(self._policy(observation))
        return self._interface.spool(action), after(memory, action)


def after(memory: Memory, action: float) -> Memory:
    """The memory when an action has been taken."""
    return memory._replace(actions=(action, *memory.actions[:-1]))


def law(
    policy: Policy,
    scenario: Scenario | str | Path = "step",
    changes: Changes = (),
    compensate_overlap: bool | None = None,
    actions: int | None = None,
) -> PolicyLaw:
    """A policy as a law for `hydrotwin.run` and `controller.law`, with what it was trained on: the options of `Rig`."""
    loaded = scenario if isinstance(scenario, Scenario) else load(scenario, changes)
    return PolicyLaw(interface_of(loaded, compensate_overlap, actions), policy)
