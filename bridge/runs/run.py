"""Run a scenario in any mode and gather what came of it."""

from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from bridge.errors import RunError, writing
from bridge.loop.controller import ControllerSide
from bridge.loop.plant_tuning import refuse_impossible
from bridge.machine.process import Stop
from bridge.processes.options import SLOW, RunOptions
from bridge.recording.reader import Recording, read
from bridge.recording.remarks import remarks
from bridge.recording.summarise import NEEDED, known_or_made
from bridge.recording.summary import Summary
from bridge.recording.verdict import ENDED_EARLY, verdict
from bridge.runs.in_process import RecordingError, record_in_process
from bridge.runs.progress import Progress
from bridge.scenario import Scenario
from bridge.scenario.circuit import circuit_of
from bridge.scenario.describe import warnings
from bridge.wire.messages import Mode

if TYPE_CHECKING:
    from bridge.studies.stability.operating import OperatingPoint


class Outcome(NamedTuple):
    """What a run left behind."""

    scenario: Scenario
    options: RunOptions
    faults: list[str]  # empty for a good run
    notes: list[str]  # what people should know, without being a failure
    interrupted: bool  # by somebody, before its time
    summary: Summary | None = None  # None when no recording was written
    data: Recording | None = None  # what the summary was made of
    picture: Path | None = None
    compared: bool = False  # with the linear theory
    stability: "OperatingPoint | None" = None  # what that says; None where it knows no such loop

    @property
    def recording(self) -> Path | None:
        """The file of the run; None when none was written."""
        return None if self.summary is None else self.options.recording

    @property
    def priority(self) -> str | None:
        """What the plant was granted; None without a clock."""
        told = self.data.metadata["run"]["host"] if self.data and self.options.mode == Mode.REALTIME else {}
        return told.get("priority")

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        words = {"faults": self.faults, "notes": self.notes}
        if self.summary is None:
            return {"scenario": self.scenario.name} | words
        options = self.options
        how = {"mode": options.mode, "speed": options.speed, "recording": str(options.recording)}
        how |= {"priority": self.priority} if self.priority else {}
        point = {"stability": self.stability and self.stability.plain()} if self.compared else {}
        return self.summary.plain() | how | words | point


def ready_to_run(scenario: Scenario) -> None:
    """Raises UsageError for a rig that cannot be built, and for a law that is not there or does not load."""
    circuit_of(scenario)
    refuse_impossible(scenario)
    ControllerSide(scenario, 0)


def run_scenario(scenario: Scenario, options: RunOptions) -> Outcome:
    """Run and summarise. A failed run has faults, and its recording as far as it goes."""
    coarse = warnings(scenario)  # refuses numbers that make no circuit before anything is started
    if not options.external:
        ready_to_run(scenario)
    stop = Stop()
    try:
        recording, faults, notes = _run(scenario, options, stop)
    finally:
        stop.leave()
    notes = [*coarse, *notes]
    if recording is None:
        return Outcome(scenario, options, faults, notes, stop.asked)
    notes += remarks(recording)
    summary = known_or_made(recording, scenario)
    faults = in_order(faults, verdict(summary, scenario))
    return Outcome(scenario, options, faults, notes, stop.asked, summary, recording)


def in_order(seen: list[str], found: list[str]) -> list[str]:
    """What was seen of the processes and what their recording says: the main reason first, each once."""
    slow = [fault for fault in seen if SLOW in fault]
    quick = [fault for fault in seen if fault not in slow]
    further = [fault for fault in found if not (quick and fault.startswith(ENDED_EARLY))]  # which follows from those
    return [*quick, *further, *slow]


def shown(outcome: Outcome) -> Outcome:
    """The outcome for people: with a picture, and with where it stands among the stable gains of its loop."""
    if outcome.data is None or outcome.summary is None or outcome.interrupted:
        return outcome
    from bridge.scenario.plausible import DELAY
    from bridge.scenario.relief_swing import swing_notes
    from bridge.studies.stability.notes import timing_notes
    from bridge.studies.stability.operating import operating_point

    scenario, metrics = outcome.scenario, outcome.summary.metrics
    timed = timing_notes(scenario) if scenario.loop.delay <= DELAY.high else []  # a longer one is noted already
    notes = [*outcome.notes, *timed, *swing_notes(scenario)]
    picture, refused = _picture(scenario, outcome.data)
    point = None if outcome.options.external else operating_point(scenario, metrics)  # of the scenario's own law
    faults = [*outcome.faults, *refused]
    return outcome._replace(faults=faults, notes=notes, picture=picture, compared=True, stability=point)


def _run(scenario: Scenario, options: RunOptions, stop: Stop) -> tuple[Recording | None, list[str], list[str]]:
    """The recording if there is one, what went wrong, and what else people should know."""
    with Progress(scenario) as progress:
        if options.mode == Mode.INPROCESS:
            try:
                recorded = record_in_process(
                    scenario, options.recording, progress.tick, lambda: stop.listen()(), progress.tell
                )
                return recorded, [], []
            except RecordingError as error:
                return None, [str(error)], []
            except RunError as error:  # of the law: what was recorded until then is whole
                return read(options.recording, NEEDED), [str(error)], []
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
