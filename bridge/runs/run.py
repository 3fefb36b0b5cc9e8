"""Run a scenario in any mode and gather what came of it."""

from pathlib import Path
from typing import Any, NamedTuple

from bridge.machine.process import Stop
from bridge.recording.reader import Recording, read
from bridge.recording.summary import NEEDED, summarise, verdict
from bridge.runs.in_process import record_in_process
from bridge.runs.progress import Progress
from bridge.scenario import Scenario
from bridge.scenario.describe import warnings
from bridge.studies.stability.operating import left_out, operating_point


class RunRequest(NamedTuple):
    """How to run."""

    mode: str  # inprocess, lockstep, realtime
    speed: float
    fifo: bool
    recording: Path
    patience: float
    external: bool
    listen: str | None


class Outcome(NamedTuple):
    """What a run left behind."""

    scenario: Scenario
    summary: dict[str, Any]
    faults: list[str]  # empty for a good run
    recording: Path | None  # None when none was written
    picture: Path | None


def run_scenario(scenario: Scenario, request: RunRequest) -> Outcome:
    """Run, summarise, draw. A failed run has faults, and its recording as far as it goes."""
    coarse = warnings(scenario)  # refuses numbers that make no circuit before anything is started
    stop = Stop()
    try:
        recording, faults, notes = _run(scenario, request, stop)
    finally:
        stop.leave()
    notes = [*coarse, *notes, *filter(None, [left_out(scenario)])]
    if recording is None:
        return Outcome(scenario, {"scenario": scenario.name, "faults": faults, "notes": notes}, faults, None, None)
    summary = recording.metadata.get("summary") or summarise(recording, scenario, {})
    faults = [*faults, *verdict(summary, scenario)]
    summary |= {"stability": None if stop.asked else operating_point(scenario, summary["metrics"])}
    summary = summary | {"mode": request.mode, "speed": request.speed, "recording": str(request.recording)}
    picture = None if stop.asked else _picture(scenario, recording)
    return Outcome(scenario, summary | {"faults": faults, "notes": notes}, faults, request.recording, picture)


def _run(scenario: Scenario, request: RunRequest, stop: Stop) -> tuple[Recording | None, list[str], list[str]]:
    """The recording if there is one, what went wrong, and what else people should know."""
    with Progress(scenario) as progress:
        if request.mode == "inprocess":
            return record_in_process(scenario, request.recording, progress.tick, lambda: stop.listen()()), [], []
        from bridge.processes.supervisor import RunOptions, Supervisor

        options = RunOptions(
            request.mode,
            request.speed,
            request.fifo,
            request.recording,
            request.patience,
            request.external,
            request.listen,
        )
        supervisor = Supervisor(scenario, options, progress.show, stop.listen())
        faults = supervisor.run()
    return (read(request.recording, NEEDED) if supervisor.recorded else None), faults, supervisor.notes


def _picture(scenario: Scenario, recording: Recording) -> Path | None:
    from bridge.runs.picture import draw

    if recording.counts.get("state", 0) < 2:
        return None
    return draw(recording, scenario, recording.path.with_suffix(".png"))
