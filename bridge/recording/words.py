"""A run in a few words, as Markdown: what was run, how it went, on which rig."""

from typing import Any

from bridge.recording.imported import facts, is_measured
from bridge.recording.reader import Recording
from bridge.recording.summary import summary_of
from bridge.scenario.bands import metric_words
from bridge.wire.messages import Mode

MODES = {Mode.INPROCESS: "in one process", Mode.LOCKSTEP: "in lockstep", Mode.REALTIME: "in real time"}


def sentence(recording: Recording) -> str:
    """The run in one sentence."""
    run, summary = recording.metadata.get("run", {}), summary_of(recording)
    if is_measured(recording):
        simulated = summary and summary.simulated
        return f"{'A log' if simulated is None else f'{simulated:g} s'} measured on a rig, {_origin(recording)}."
    what = _replayed(run.get("replayed")) or _control(run)
    how = MODES.get(run.get("mode", ""), "")
    simulated = summary and summary.simulated
    span = "A run" if simulated is None else f"{simulated:g} s"
    ending = summary.ending if summary else "not ended, shown as far as it goes"
    return f"{' '.join(filter(None, (span, how, what)))}: {ending}."


def _replayed(told: Any) -> str:
    return f"of {told.get('file')} into the {told.get('into')}" if isinstance(told, dict) else ""


def _origin(recording: Recording) -> str:
    told = facts(recording)
    return f"imported from {told.get('source', 'a log')} by {told.get('map', 'a map')}"


def _control(run: dict[str, Any]) -> str:
    scenario = run.get("scenario", {})
    loop, controller = scenario.get("loop"), scenario.get("controller", {})
    if not loop:
        return ""
    delay = f"{loop['delay'] * 1e3:g} ms later" if loop["delay"] else "without delay"
    named = next((controller[key] for key in ("law", "source", "library", "kind") if controller.get(key)), None)
    law = run.get("law", {}).get("name", named)  # a law handed over by a program is not in the scenario
    return f"under the law {law}, sampled every {loop['sample_period'] * 1e3:g} ms and acting {delay}"


def run_in_words(recording: Recording) -> str:
    """The run as Markdown."""
    summary = summary_of(recording)
    rows = metric_words(summary.metrics) if summary else []
    table = ["| | |", "|---|---|", *(f"| {words} | {value} |" for words, value in rows)] if rows else []
    scenario = recording.metadata.get("run", {}).get("scenario", {})
    title = scenario.get("title") or scenario.get("name", "A run")
    return "\n".join(
        [f"**{title}**", "", sentence(recording), "", *_conditions(recording.metadata.get("run", {})), "", *table]
    )


def _conditions(run: dict[str, Any]) -> list[str]:
    scenario = run.get("scenario", {})
    loop = scenario.get("loop", {})
    if not loop:
        return []
    return [
        f"Measurements every {loop['daq_period'] * 1e3:g} ms, internal step {loop['step'] * 1e6:g} us, "
        f"profiles of the pipes every {loop['viewer_period'] * 1e3:g} ms."
    ]
