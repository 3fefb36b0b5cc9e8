"""A run in a few words, as Markdown: what was run, how it went, on which rig."""

from typing import Any

from bridge.bands import METRICS, value_with_unit
from bridge.recording.reader import Recording

LINE_ENDS = (
    ("pump", "tee, p1"),
    ("tee, p1", "valve, P"),
    ("valve, A", "lower chamber, p2"),
    ("valve, B", "upper chamber, p3"),
    ("valve, T", "return tee"),
    ("return tee", "tank"),
)
MODES = {"inprocess": "in one process", "lockstep": "in lockstep", "realtime": "in real time"}


def sentence(recording: Recording) -> str:
    """The run in one sentence."""
    run, summary = recording.metadata.get("run", {}), recording.metadata.get("summary", {})
    scenario = run.get("scenario", {})
    what = scenario.get("title") or scenario.get("name", "A run")
    how = MODES.get(run.get("mode", ""), "")
    ending = summary.get("ending", "cut off: what follows is as far as it was recorded")
    simulated = summary.get("simulated")
    span = "" if simulated is None else f"{simulated:g} s simulated"
    return f"{what}: {' '.join(filter(None, (span, how)))}, {ending}."


def run_in_words(recording: Recording) -> str:
    """The run as Markdown."""
    summary = recording.metadata.get("summary", {})
    rows = [(METRICS[name].words, value_with_unit(name, value)) for name, value in summary.get("metrics", {}).items()]
    table = ["| | |", "|---|---|", *(f"| {words} | {value} |" for words, value in rows)] if rows else []
    return "\n".join([sentence(recording), "", *_conditions(recording.metadata.get("run", {})), "", *table])


def _conditions(run: dict[str, Any]) -> list[str]:
    scenario = run.get("scenario", {})
    loop, controller = scenario.get("loop", {}), scenario.get("controller", {})
    if not loop:
        return []
    return [
        f"Sample period {loop['sample_period'] * 1e3:g} ms, delay {loop['delay'] * 1e3:g} ms, "
        f"measurements every {loop['daq_period'] * 1e3:g} ms, step {loop['step'] * 1e6:g} us; law {controller['law']}."
    ]
