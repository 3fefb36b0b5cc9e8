"""Judge scenarios by the bands they state: what a user's CI calls."""

import math
import time
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any, NamedTuple, TypeGuard

import numpy as np
from numpy.typing import NDArray

from bridge.errors import ScenarioError, nearest, visible
from bridge.processes.options import RunOptions
from bridge.recording.columns import signals, sine_of
from bridge.recording.names import own_name
from bridge.recording.reader import Recording, read
from bridge.recording.seen import judged
from bridge.recording.signals import signals_of
from bridge.recording.summary import Summary
from bridge.runs.run import run_scenario
from bridge.scenario import Scenario
from bridge.scenario.bands import (
    UNDEFINED,
    cycle_words,
    is_own,
    outside,
    parse_band,
    signal_with_unit,
    units_of,
    value_with_unit,
)
from bridge.scenario.circuit import circuit_of
from bridge.scenario.requirements import Expected
from bridge.wire.events import ending_of
from bridge.wire.messages import CHANNELS_TOPIC, Ending, Mode
from controller.bands import END, START, WHOLE, Band, Metrics, WindowBand, judge
from controller.grid import NS
from controller.metrics import Signals, measure
from controller.window import bounds, judge_window, within
from twin.circuit.reading import BALANCES, moments

NOTHING_EXPECTED = "the scenario states no band, so there is nothing to check: write what it must meet in `expect`"
UNKNOWN = Metrics(*(float("nan") for _ in Metrics._fields))  # of a run without any


class Judgement(NamedTuple):
    """One band and how it went."""

    text: str
    found: str
    passed: bool
    id: str = ""  # of the requirement, if one is named
    requirement: str = ""  # in its own words

    @property
    def words(self) -> str:
        """The band, behind the name of its requirement."""
        return Expected(self.text, self.id).words


class CheckResult(NamedTuple):
    """One scenario, judged."""

    name: str  # of the scenario; of one that could not be read as it was asked for
    verdicts: list[Judgement]
    faults: list[str]
    notes: list[str]  # what people should know, without being a failure
    recording: Path | None
    interrupted: bool  # by somebody: what else was to be judged is not
    seconds: float  # of wall time
    refused: bool = False  # it could not be run at all

    @property
    def passed(self) -> bool:
        """Did the run and every band go well?"""
        return not self.faults and all(verdict.passed for verdict in self.verdicts)

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "scenario": self.name,
            "passed": self.passed,
            "bands": [verdict._asdict() for verdict in self.verdicts],
            "faults": self.faults,
            "notes": self.notes,
            "seconds": self.seconds,
            "recording": str(self.recording) if self.recording else None,
        }


def refuse_windows(scenario: Scenario) -> None:
    """Raises ScenarioError for a band about a time that the run does not reach."""
    for text in (expected.band for expected in scenario.expected):
        if wrong := outside(parse_band(text), scenario.duration):
            raise ScenarioError(f"{scenario.name}: expect {text!r}: {wrong}; lengthen duration or move the window")


def refusal(name: str, reason: str) -> CheckResult:
    """Of a scenario that could not be run."""
    return CheckResult(name, [], [reason], [], None, interrupted=False, seconds=0.0, refused=True)


def check_scenario(scenario: Scenario, mode: Mode, folder: Path) -> CheckResult:
    """Run a scenario headless and judge it; its recording overwrites nothing."""
    begin = time.monotonic()
    with own_name(folder / f"{scenario.name}.mcap") as path:
        outcome = run_scenario(scenario, RunOptions(mode, path))
        verdicts = judge_run(scenario, outcome.summary, outcome.recording)
    faults = [*outcome.faults, *([] if scenario.expect else [NOTHING_EXPECTED])]
    seconds = time.monotonic() - begin
    return CheckResult(scenario.name, verdicts, faults, outcome.notes, outcome.recording, outcome.interrupted, seconds)


def junit_xml(results: list[CheckResult], title: str = "hydrotwin check") -> str:
    """The results as JUnit XML: one test case per band, with what was found and its requirement, and one of the run."""
    suites = ET.Element("testsuites", name=title)
    for result in results:
        name, taken = visible(result.name), f"{result.seconds:.3f}"
        if result.refused:
            suite = ET.SubElement(suites, "testsuite", name=name, tests="1", errors="1")
            case = ET.SubElement(suite, "testcase", classname=name, name="scenario")
            ET.SubElement(case, "error", message=visible("; ".join(result.faults)))
            continue
        failures = sum(not verdict.passed for verdict in result.verdicts) + bool(result.faults)
        suite = ET.SubElement(suites, "testsuite", name=name, tests=str(len(result.verdicts) + 1))
        suite.attrib |= {"failures": str(failures), "time": taken}
        for verdict in result.verdicts:
            case = ET.SubElement(suite, "testcase", classname=name, name=visible(verdict.words), time="0")
            known = {"found": verdict.found, "requirement": verdict.id, "requirement text": verdict.requirement}
            _describe(case, known, "" if verdict.passed else f"found {verdict.found}")
        case = ET.SubElement(suite, "testcase", classname=name, name="run", time=taken)
        _describe(case, {"recording": str(result.recording or "")}, visible("; ".join(result.faults)))
    return _text(suites)


def _describe(case: ET.Element, known: dict[str, str], failure: str) -> None:
    """The properties of a test case that say something, and its failure if there is one."""
    properties = ET.SubElement(case, "properties")
    for name, value in known.items():
        if value:
            ET.SubElement(properties, "property", name=name, value=visible(value))
    if failure:
        ET.SubElement(case, "failure", message=failure)


def _text(suites: ET.Element) -> str:
    ET.indent(suites)
    return ET.tostring(suites, encoding="utf-8", xml_declaration=True).decode()


def judge_run(scenario: Scenario, summary: Summary | None, recording: Recording | Path | None) -> list[Judgement]:
    """A verdict on each band of a scenario. A run that left nothing behind fails; one that ended early passes none."""
    metrics = (summary and summary.metrics) or UNKNOWN
    bands = [(expected.band, parse_band(expected.band)) for expected in scenario.expected]
    look = Look(recording, scenario) if recording and any(not _of_run(band) for _, band in bands) else None
    found = [_judge(text, band, metrics) if _of_run(band) else look_up(text, band, look) for text, band in bands]
    named = [v._replace(id=e.id, requirement=e.text) for v, e in zip(found, scenario.expected, strict=True)]
    if summary is None or ending_of(summary.ending) == Ending.COMPLETE:
        return named
    return [verdict._replace(passed=False, found=f"{verdict.found}, until it ended early") for verdict in named]


def coverage(scenarios: list[Scenario]) -> list[tuple[str, str, str, str]]:
    """Requirement, its words, scenario and band of all that some scenarios expect; those of no requirement last."""
    rows = [(e.id, e.text, scenario.name, e.band) for scenario in scenarios for e in scenario.expected]
    return sorted(rows, key=lambda row: (not row[0], row[0]))


def _of_run(band: Band | WindowBand) -> TypeGuard[Band]:
    return isinstance(band, Band) and (band.begin, band.end) == WHOLE


class Look:
    """The true signals of a recorded run, its balances and its moments."""

    def __init__(self, recording: Recording | Path, scenario: Scenario) -> None:
        circuit, found = circuit_of(scenario), read(recording) if isinstance(recording, Path) else recording
        columns = judged(found)
        self.run = signals(found, scenario)
        self.frequency = sine_of(scenario)
        self.time = columns["stamp"] / NS
        followed = {"error": self.run.reference - self.run.position, "reference": self.run.reference}
        self.signals = columns | followed
        self._balance = lambda name: BALANCES[name](self.time, columns, circuit)  # not every drive has each
        self._own = signals_of(found, ("signals", CHANNELS_TOPIC))
        self.moments = moments(self.time, columns, circuit) | {START: 0.0, END: float(self.time[-1])}

    def series(self, band: WindowBand) -> tuple[NDArray, NDArray]:
        """Times [s] and values of what a band is about; empty for what the run does not have."""
        if band.signal in BALANCES:
            return self.time, self._balanced(band.signal)
        if not is_own(band):
            return self.time, self.signals[band.signal]
        signal = self._own.get(band.signal)
        return (np.array([]), np.array([])) if signal is None else (signal.stamp / NS, signal.value)

    def _balanced(self, name: str) -> NDArray:
        """A balance. Raises ScenarioError where the drive has no such one."""
        try:
            return self._balance(name)
        except ValueError as error:
            raise ScenarioError(f"expect: {error}") from None

    def unit(self, band: WindowBand) -> str:
        """Its unit, SI."""
        return self._own[band.signal].unit if band.signal in self._own else units_of(band)[0]

    def unlike(self, band: WindowBand) -> str:
        """What is wrong with a band about what only some runs have; empty for nothing. 0 is the same in every unit."""
        if band.signal not in self._own:
            return f"the law logged no such signal{nearest(band.signal, self._own)}"
        unit = self.unit(band)
        same = unit == band.unit or band.limit == 0.0 or math.isinf(band.limit)
        return "" if same else f"it is logged in {unit or 'no unit'}, the limit in {band.unit or 'none'}"

    def metrics(self, window: tuple[float, float]) -> Metrics:
        """The metrics of a part of the run; a constant stretch that it cuts has followed the motion before it."""
        inside = np.flatnonzero(within(self.time, window))
        if not inside.size:
            return UNKNOWN
        part = slice(inside[0], inside[-1] + 1)
        moved = bool(np.any(np.diff(self.run.reference[: part.start + 1]) != 0.0))
        with np.errstate(invalid="ignore"):
            return measure(Signals(*(column[part] for column in self.run)), frequency=self.frequency, moved=moved)


def look_up(text: str, band: Band | WindowBand, look: Look | None) -> Judgement:
    """The verdict on a part of a run."""
    if look is None:
        return Judgement(text, "-", False)
    window = bounds(band, look.moments)
    if not within(look.time, window).any():
        return Judgement(text, _empty(band, window), False)
    if isinstance(band, Band):
        return _judge(text, band, look.metrics(window))
    if is_own(band) and (wrong := look.unlike(band)):
        return Judgement(text, f"- ({wrong})", False)
    verdict = judge_window(band, *look.series(band), look.moments)
    found = signal_with_unit(look.unit(band), verdict.value)
    return Judgement(text, f"- ({band.signal} has no value there)" if found == "-" else found, verdict.passed)


def _empty(band: Band | WindowBand, window: tuple[float, float]) -> str:
    never = [moment.name for moment, at in zip((band.begin, band.end), window, strict=True) if at != at]
    return f"- (no {never[0]} happened)" if never else f"- (no sample from {window[0]:g} s to {window[1]:g} s)"


def _judge(text: str, band: Band, metrics: Metrics) -> Judgement:
    verdict = judge(metrics, [band])[0]
    found = value_with_unit(verdict.metric, verdict.value)
    if verdict.value != verdict.value:
        found = f"- ({UNDEFINED.get(verdict.metric, 'the run left no signals')})"
    if verdict.metric == "limit_cycle_amplitude" and verdict.value == verdict.value:
        found += f", {cycle_words(metrics)}"
    return Judgement(text, found, verdict.passed)
