"""What the report needs to know of one recording."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import UsageError
from bridge.recording.columns import followed
from bridge.recording.frames import profiles
from bridge.recording.imported import is_measured
from bridge.recording.reader import Recording, read
from bridge.recording.seen import instants, seen
from bridge.recording.summarise import known_or_made
from bridge.recording.summary import Summary
from bridge.recording.verdict import verdict
from bridge.runs.check import Judgement, judge_run
from bridge.scenario import Scenario
from controller.grid import NS


class Run(NamedTuple):
    """One recorded run, looked at."""

    recording: Recording
    scenario: Scenario
    summary: Summary
    verdicts: list[Judgement]
    faults: list[str]
    state: dict[str, NDArray]
    time: NDArray[np.float64]  # [s], of the state
    reference: NDArray[np.float64]  # [m], NaN where the law follows none

    @property
    def name(self) -> str:
        """How people call it: its file."""
        return self.recording.path.stem

    @property
    def measured(self) -> bool:
        """Was it measured on a rig, so that the state is what sensors have read, else NaN?"""
        return is_measured(self.recording)

    def knows(self, field: str) -> bool:
        """Is there any value of a field of the state?"""
        return field in self.state and bool(np.isfinite(self.state[field]).any())

    @property
    def passed(self) -> bool:
        """Did the run and every band go well?"""
        return not self.faults and all(verdict.passed for verdict in self.verdicts)

    def along(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Times [s] and pressures [Pa] along the lines, (n, 6, places)."""
        stamps, pressure, _ = profiles(self.recording)
        return stamps / NS, pressure


def load_run(path: Path) -> Run:
    """Read a recording. Raises UsageError when there is nothing in it to report on."""
    recording = read(path)
    if instants(recording) < 2:
        raise UsageError(f"{path}: the recording holds no state of a plant, so there is nothing to report")
    scenario = recording.scenario()
    summary = known_or_made(recording, scenario)
    faults, verdicts = verdict(summary, scenario), judge_run(scenario, summary, path)
    state = seen(recording)
    time = state["stamp"] / NS
    return Run(recording, scenario, summary, verdicts, faults, state, time, followed(recording, scenario, time))


def named_apart(runs: list[Run]) -> list[str]:
    """A name for each run: its file's, with a number where two are the same."""
    names = [run.name for run in runs]
    return [f"{name} ({i})" if names.count(name) > 1 else name for i, name in enumerate(names, 1)]
