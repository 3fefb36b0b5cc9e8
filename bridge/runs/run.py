"""Run a scenario in any mode and gather what came of it."""

from pathlib import Path
from typing import Any, NamedTuple

from bridge.errors import RunError, writing
from bridge.machine.process import Stop
from bridge.processes.options import RunOptions
from bridge.recording.reader import Recording, read
from bridge.recording.summary import NEEDED, summarise, verdict
from bridge.runs.in_process import RecordingError, record_in_process
from bridge.runs.progress import Progress
from bridge.scenario import Scenario
from bridge.scenario.describe import warnings
from bridge.wire.messages import Mode


class Outcome(NamedTuple):
    """What a run left behind."""

    scenario: Scenario
    summary: dict[str, Any]
    faults: list[str]  # empty for a good run
    recording: Path | None  # None when none was written
    picture: Path | None = None
    interrupted: bool = False  # by somebody, before its time
    data: Recording | None = None  # what the summary was made of


def run_scenario(scenario: Scenario, options: RunOptions) -> Outcome:
    """Run and summarise. A failed run has faults, and its recording as far as it goes."""
    coarse = warnings(scenario)  # refuses numbers that make no circuit before anything is started
    stop = Stop()
    try:
        recording, faults, notes = _run(scenario, options, stop)
    finally:
        stop.leave()
    notes = [*coarse, *notes]
    if recording is None:
        summary = {"scenario": scenario.name, "faults": faults, "notes": notes}
        return Outcome(scenario, summary, faults, None, None, stop.asked)
    summary = recording.metadata.get("summary") or summarise(recording, scenario, {})
    faults = [*faults, *verdict(summary, scenario)]
    summary = summary | {"mode": options.mode, "speed": options.speed, "recording": str(options.recording)}
    summary |= {"faults": faults, "notes": notes}
    return Outcome(scenario, summary, faults, options.recording, None, stop.asked, recording)


def shown(outcome: Outcome) -> Outcome:
    """The outcome for people: with a picture, and with where it stands among the stable gains of its loop."""
    if outcome.data is None or outcome.interrupted:
        return outcome
    from bridge.studies.stability.operating import left_out, operating_point

    scenario, summary = outcome.scenario, outcome.summary
    notes = [*summary["notes"], *filter(None, [left_out(scenario)])]
    picture, refused = _picture(scenario, outcome.data)
    faults = [*outcome.faults, *refused]
    theory = {"stability": operating_point(scenario, summary["metrics"]), "notes": notes, "faults": faults}
    return outcome._replace(summary=summary | theory, faults=faults, picture=picture)


def _run(scenario: Scenario, options: RunOptions, stop: Stop) -> tuple[Recording | None, list[str], list[str]]:
    """The recording if there is one, what went wrong, and what else people should know."""
    with Progress(scenario) as progress:
        if options.mode == Mode.INPROCESS:
            try:
                return record_in_process(scenario, options.recording, progress.tick, lambda: stop.listen()()), [], []
            except RecordingError as error:
                return None, [str(error)], []
        from bridge.processes.supervisor import Supervisor

        supervisor = Supervisor(scenario, options, progress.show, stop.listen())
        faults = supervisor.run()
    return (read(options.recording, NEEDED) if supervisor.recorded else None), faults, supervisor.notes


def _picture(scenario: Scenario, recording: Recording) -> tuple[Path | None, list[str]]:
    """The picture, and why there is none although there should be one."""
    from bridge.runs.picture import draw

    if recording.counts.get("state", 0) < 2:
        return None, []
    try:
        with writing(recording.path.with_suffix(".png")) as path:
            return draw(recording, scenario, path), []
    except RunError as error:
        return None, [str(error)]
