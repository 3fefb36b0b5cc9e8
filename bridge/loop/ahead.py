"""What would happen: the twins of an estimate run on, each with a controller of its own, in which a number is changed.

The spread of the futures is that of the estimate as its deviations are stated: states and unknowns, which stand still
meanwhile. Each card has its own noise. Disturbances of the future are not in it.
"""

import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import ScenarioError, UsageError
from bridge.loop.controller import ControllerSide, sample_of
from bridge.loop.follower import FollowerSide
from bridge.scenario import Scenario
from bridge.scenario.tunable import CONTROLLER, in_si, tunable
from bridge.wire.events import setting
from bridge.wire.messages import EventKind, SafetyState
from controller.grid import NS, is_sample
from controller.metrics import Signals
from twin.sensors import NOISE_ROWS, noise_block
from twin.topology import CHANNELS, OBSERVED

Array = NDArray[np.float64]
SEEN = ("position", "p1", "p_lower", "p_upper", "spool")  # what is kept of each future
AT = [list(OBSERVED).index(name) for name in SEEN]
NOISE_SEED = 77  # of the futures' cards, assumed


class Change(NamedTuple):
    """What the plant has said has changed, by somebody or by its timeline."""

    text: str
    entry: int  # of the timeline; 0: somebody has set it
    apply_at: int  # [ns]


class Past(NamedTuple):
    """What the loop's controller knows by now."""

    measurements: list[Any]  # the newest last
    changes: list[Change]


class Question(NamedTuple):
    """What is to be tried."""

    changes: Mapping[str, Any]  # of the controller's numbers, or the reference
    horizon: int  # [ns]


def look_ahead(side: FollowerSide, scenario: Scenario, past: Past, question: Question) -> list[Signals]:
    """The signals of each member's future.

    Raises UsageError where there is no estimate yet, commands do not act, or the law needs what no estimate has.
    """
    if side.state in (SafetyState.SAFE, SafetyState.LATCHED):
        raise UsageError(f"what if: the plant is {side.state}, so no command acts; ask again when it is running")
    if side.filter.members is None or side.latest is None:
        raise UsageError("what if: there is no estimate yet to go on from")
    if scenario.controller.sees_truth or scenario.controller.reads_channels:
        raise UsageError("what if: the law reads the true state or further channels, which an estimate does not have")
    controllers = [_controller(scenario, past, question, side.now) for _ in range(len(side.filter.z))]
    return _Futures(side, controllers).run(question.horizon)


def _controller(scenario: Scenario, past: Past, question: Question, now: int) -> ControllerSide:
    """A controller that has seen what came before now, and is told of the changes now."""
    controller = ControllerSide(scenario, 0)
    for change in past.changes:
        controller.learn(*change)
    for measurement in past.measurements:
        if measurement.stamp < now:
            controller.answer(measurement)
    for name, value in question.changes.items():
        entry = tunable(name, scenario)
        if entry.owner != CONTROLLER:
            raise ScenarioError(f"{name}: only numbers of the controller and the reference can be tried")
        controller.learn(setting(name, in_si(value, entry, scenario)), 0, now + 1)
    return controller


def changes_of(event: Any) -> list[Change]:
    """What an event of the plant says has changed, if anything."""
    return [Change(event.text, event.command, event.apply_at)] if event.kind == EventKind.CHANGED else []


class _Futures:
    """All members, side by side."""

    def __init__(self, side: FollowerSide, controllers: list[ControllerSide]) -> None:
        self._side, self._controllers = side, controllers
        self._members: Any = side.filter.members
        held = side.held()
        self._value = np.full(len(controllers), held.value)
        self._pending = [(at, np.full(len(controllers), value)) for at, value in held.waiting()]
        self._daq, self._grid = side.scenario.daq, side.grid
        self._sensors = side.filter.sensors
        self._number, self._noise = -1, np.zeros(0)

    def run(self, horizon: int) -> list[Signals]:
        """From now to the horizon [ns]; the estimate is as it was afterwards."""
        kept = self._side.filter.begin_futures()
        begin = self._side.now
        ticks = horizon // self._grid.daq
        found, wanted = np.zeros((ticks, len(self._controllers), len(SEEN))), np.zeros(ticks)
        for tick in range(ticks):
            now = begin + tick * self._grid.daq
            wanted[tick] = self._controllers[0].target(now).position
            if is_sample(now, self._grid):
                self._answer(now)
            for reference, steps in self._segments(now, now + self._grid.daq):
                self._members.run(self._put_out(reference), steps)
            found[tick] = self._members.seen[:, AT]
        self._side.filter.end_futures(kept)
        time = (begin + (1 + np.arange(ticks)) * self._grid.daq) / NS
        return [Signals(time, f[:, 0], wanted, *(f[:, i] for i in range(1, len(SEEN)))) for f in found.swapaxes(0, 1)]

    def _answer(self, now: int) -> None:
        """Let each controller answer what its card reads."""
        answers, limit = np.zeros(len(self._controllers)), min(1.0, self._side.limit)
        for m, (controller, row) in enumerate(zip(self._controllers, self._read(now).tolist(), strict=True)):
            spool, _ = controller.decide(sample_of(now, dict(zip(CHANNELS, row, strict=True))))
            answers[m] = min(max(spool, -limit), limit) if math.isfinite(spool) else 0.0
        self._pending.append((now + self._grid.delay, answers))

    def _read(self, now: int) -> Array:
        """What the cards read, with a noise of each member and tick."""
        number, place = divmod(now // self._grid.daq, NOISE_ROWS)
        if number != self._number:
            blocks = [noise_block(NOISE_SEED + m, number) for m in range(len(self._controllers))]
            self._number, self._noise = number, np.stack(blocks, axis=1)
        return self._sensors.read(self._members.taps, self._side.filter.unknowns.offsets, self._noise[place])

    def _segments(self, begin: int, end: int) -> Iterator[tuple[Array, int]]:
        while self._pending and self._pending[0][0] < end:
            at, value = self._pending.pop(0)
            if at > begin:
                yield self._value, (at - begin) // self._grid.step
                begin = at
            self._value = value
        yield self._value, (end - begin) // self._grid.step

    def _put_out(self, reference: Array) -> Array:
        if not self._daq.quantise_output:
            return reference
        lsb = 2.0 / 2.0**self._daq.output_bits
        return np.minimum(-1.0 + lsb * np.floor((reference + 1.0) / lsb + 0.5), 1.0 - lsb)
