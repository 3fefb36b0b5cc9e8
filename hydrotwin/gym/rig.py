"""The environment: one step is one sample period of the loop, and the agent is its controller."""

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bridge.errors import UsageError
from bridge.loop.stepped import SteppedLoop
from bridge.recording.reader import Entry
from bridge.recording.writer import entries_of
from bridge.runs.in_process import in_memory_recording
from bridge.scenario import Scenario
from bridge.scenario.circuit import in_memory, rest_of
from bridge.wire.messages import Outgoing
from controller.grid import NS
from hydrotwin.gym.bands import bands_of
from hydrotwin.gym.randomise import DELAY, SEED, Numbers, drawn, ranges_of, refuse_key, with_changes
from hydrotwin.gym.reward import Reward, Step, Tracking
from hydrotwin.policy import Array, Policy, PolicyLaw, after, command_of, interface_of
from hydrotwin.runs import Changes, Run, load
from twin.topology import OBSERVED

try:
    import gymnasium
except ModuleNotFoundError as missing:
    if missing.name != "gymnasium":
        raise
    raise ImportError("hydrotwin.gym needs the package gymnasium: pip install 'hydrotwin[gym]'") from None

ID = "hydrotwin/Rig-v0"
POSITION, VELOCITY = ([*OBSERVED].index(name) for name in ("position", "velocity"))
SEEDS = 2**62


class Rig(gymnasium.Env[Array, Any]):
    """A scenario's rig, its card, its hold and its delay; docs/gymnasium.md says what is seen and what it is worth."""

    metadata = {"render_modes": []}  # noqa: RUF012 # as gymnasium declares it

    def __init__(
        self,
        scenario: Scenario | str | Path = "step",
        changes: Changes = (),
        *,
        bands: Iterable[str] = (),
        limits: Iterable[str] = (),
        randomise: Mapping[str, Any] | None = None,
        reward: Reward | None = None,
        compensate_overlap: bool | None = None,
        actions: int | None = None,
        record: bool = False,
    ) -> None:
        """bands: broken ones cost; limits: a broken one ends the episode; record: keep the messages of an episode."""
        self.base = scenario if isinstance(scenario, Scenario) else load(scenario, changes)
        if isinstance(scenario, Scenario) and changes:
            raise UsageError("changes go with the name of a scenario: load(name, changes) makes the changed one")
        rest_of(self.base)
        self.scenario = self.base  # of the episode
        self._bands, self._limits = bands_of("bands", bands), bands_of("limits", limits)
        self._ranges = ranges_of(self.base, randomise or {})
        self._reward = Tracking() if reward is None else reward
        longest = [{DELAY: asked.high} for asked in self._ranges if asked.key == DELAY]
        slowest = with_changes(self.base, longest[0]) if longest else self.base
        self._interface = interface_of(slowest, compensate_overlap, actions)
        self._record = record
        self._entries: list[Entry] = []
        self._loop: SteppedLoop | None = None
        self._ended = True
        self._memory = self._interface.start
        self.observation_space = gymnasium.spaces.Box(-self._interface.most, self._interface.most, dtype=np.float32)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (1,), np.float32)

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Begin an episode on a rig that is drawn anew; options: numbers for it that are not drawn.

        The information has the numbers drawn, in SI, under "drawn".
        """
        super().reset(seed=seed)
        numbers = dict(drawn(self._ranges, self.np_random, self.base.loop.step))
        noise = int(self.np_random.integers(SEEDS))
        self.scenario = self._scenario({SEED: noise, **numbers, **_checked(options or {})})
        with in_memory():
            self._loop = SteppedLoop(self.scenario, lean=not self._record)
        self._memory, self._entries, self._ended = self._interface.start, [], False
        for out in self._loop.start():
            self._keep(out)
        return self._observation(self._loop), self._facts(self._loop) | {"drawn": numbers}

    def step(self, action: Any) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Command the spool for one sample period."""
        loop, command, previous = self._running(), command_of(action), self._memory.actions[0]
        observed, grid, begin = loop.plant.observed, loop.plant.grid, loop.plant.tick_number
        rows = np.empty((grid.sample // grid.daq, len(OBSERVED)))
        for out in loop.advance(self._interface.spool(command)):
            self._keep(out)
            rows[loop.plant.tick_number - begin - 1] = observed  # the answers come first, and are written over
        self._memory = after(self._memory, command)
        step = self._judged(loop, command, previous, rows[: loop.plant.tick_number - begin])
        facts = self._facts(loop) | {"broken": len(step.broken), "ended": step.ended}
        terminated, truncated = bool(step.ended), loop.over
        if terminated or truncated:
            self._keep(loop.finish())
            self._ended = True
        return self._observation(loop), self._worth(step), terminated, truncated, facts

    def law(self, policy: Policy) -> PolicyLaw:
        """A policy as a control law for `hydrotwin.run`: it sees and does what it saw and did here."""
        return PolicyLaw(self._interface, policy)

    def episode(self) -> Run:
        """The last episode as a run, with signals, metrics and a recording to save. Raises UsageError without it."""
        if not self._record:
            raise UsageError("no episode is kept: make the environment with record=True")
        if self._loop is None or not self._ended:
            raise UsageError("no episode has ended: step until one is terminated or truncated")
        plant = self._loop.plant
        return Run(in_memory_recording(self.scenario, self._entries, plant.run_id, plant.status()), self.scenario)

    def _scenario(self, changes: Numbers) -> Scenario:
        try:
            return with_changes(self.base, changes)
        except UsageError as error:
            given = ", ".join(f"{key} = {value}" for key, value in changes.items() if key != SEED)
            raise UsageError(f"no rig with {given}: {' '.join(str(error).split())}") from None

    def _running(self) -> SteppedLoop:
        if self._loop is None or self._ended:
            raise UsageError("there is no episode, or it has ended: call reset() before step()")
        return self._loop

    def _keep(self, out: list[Outgoing]) -> None:
        if self._record:
            self._entries += entries_of(out)

    def _observation(self, loop: SteppedLoop) -> Array:
        observation, self._memory = self._interface.observe(loop.sample, loop.target, self._memory)
        return observation

    def _facts(self, loop: SteppedLoop) -> dict[str, Any]:
        position = float(loop.plant.observed[POSITION])
        return {"time": loop.plant.now / NS, "position": position, "error": loop.target.position - position}

    def _judged(self, loop: SteppedLoop, action: float, previous: float, rows: Any) -> Step:
        scenario, observed, target = self.scenario, loop.plant.observed, loop.target
        position, velocity = float(observed[POSITION]), float(observed[VELOCITY])
        error = target.position - position
        return Step(
            scenario=scenario,
            time=loop.plant.now / NS,
            target=target,
            position=position,
            velocity=velocity,
            action=action,
            previous=previous,
            bands=len(self._bands),
            broken=[band.text for band in self._bands if band.broken(rows, error)],
            ended=_unsafe(loop) or ", ".join(band.text for band in self._limits if band.broken(rows, error)),
            left=math.ceil((scenario.duration * NS - loop.plant.now) / loop.plant.grid.sample),
            rows=rows,
        )

    def _worth(self, step: Step) -> float:
        reward = self._reward(step)
        try:
            found = float(reward)
        except (TypeError, ValueError):
            found = math.nan
        if not math.isfinite(found):
            raise UsageError(f"the reward at {step.time:g} s is {reward!r:.40}, expected a finite number")
        return found


def _unsafe(loop: SteppedLoop) -> str:
    """What has gone wrong with the commands, if anything."""
    inlet = loop.plant.inlet
    if inlet.safe:
        return "the plant is in its safe state"
    return f"the plant refused a command: {', '.join(inlet.refused)}" if inlet.refused else ""


def _checked(options: Mapping[str, Any]) -> Mapping[str, Any]:
    for key in options:
        if key != SEED:
            refuse_key("options", key)
    return options


gymnasium.register(ID, entry_point="hydrotwin.gym.rig:Rig")
