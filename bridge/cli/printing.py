"""Tables for people: the summary of a run, the verdicts of checks."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.text import Text

from bridge.cli.outputs import print_json
from bridge.cli.tables import plain_text, print_table
from bridge.scenario.units import shown

if TYPE_CHECKING:
    from bridge.recording.compare import Difference
    from bridge.recording.info import EventInfo, RecordingInfo
    from bridge.recording.summary import Summary
    from bridge.runs.check import CheckResult
    from bridge.runs.run import Outcome


LEFT_TO_ADVISE = {  # what takes longer than a summary should
    "python": "hydrotwin advise runs a law of your own and says after which motions it settles",
    "relay": "hydrotwin advise predicts the cycle of a relay after each motion",
}


def print_summary(outcome: "Outcome") -> None:
    """The summary of a run."""
    summary = outcome.summary
    console = Console()
    for fault in outcome.faults:  # the reason first: it is what people look for
        console.print(plain_text(f"FAILED: {fault}", "red"), soft_wrap=True)
    if summary is not None:
        words = plain_text(f" {outcome.options.mode}: {summary.ending}")
        console.print(plain_text(summary.scenario, "bold") + words, soft_wrap=True)
        print_table(("control", ""), _metric_rows(summary))
        if rows := _timing_rows(summary):
            print_table(("timing", "p50", "p99", "p99.9", "max"), rows)
        priority = [f"priority   {outcome.priority}"] if outcome.priority else []
        for line in [*priority, *_stability(outcome), *_counts(summary)]:
            console.print(plain_text(line), soft_wrap=True)
    for note in outcome.notes:
        console.print(plain_text(note, "yellow"), soft_wrap=True)
    if outcome.recording:
        console.print(plain_text(f"recording  {outcome.recording}"), soft_wrap=True)
    if outcome.picture:
        console.print(plain_text(f"picture    {outcome.picture}"), soft_wrap=True)


def _metric_rows(summary: "Summary") -> list[tuple[str, str]]:
    from bridge.scenario.bands import metric_words

    return metric_words(summary.metrics)


def _timing_rows(summary: "Summary") -> list[list[str]]:
    shown = summary.timing.shown() if summary.timing else []
    return [[words, *(f"{value * 1e6:.1f} us" for value in spread)] for words, spread in shown]


def _stability(outcome: "Outcome") -> list[str]:
    """Where the run stands among the stable gains."""
    if outcome.stability is None:
        words = LEFT_TO_ADVISE.get(outcome.scenario.controller.kind) if outcome.compared else None
        return [f"{'gain':11}{words}"] if words else []
    from bridge.studies.stability.operating import sentences

    return [f"{word:11}{line}" for word, line in zip(("gain", ""), sentences(outcome.stability), strict=True)]


def _counts(summary: "Summary") -> Iterable[str]:
    if overruns := summary.timing and summary.timing.overruns:
        burst = f"most ticks caught up {overruns.burst}"
        if overruns.skipped:
            burst = f"{overruns.skipped} periods skipped"
        yield f"overruns   {overruns.number}, longest {overruns.worst * 1e3:.2f} ms, {burst}"
    if commands := summary.commands:
        taken = "" if commands.taken is None else f", {commands.taken} taken"
        refused = ", ".join(f"{count} {reason}" for reason, count in commands.refused.items()) or "none"
        worst = f" (worst {commands.worst_lateness * 1e3:.2f} ms)" if commands.late else ""
        yield f"commands   {commands.sent} recorded{taken}, {commands.late} late{worst}; refused: {refused}"
        told = {name: count for name, count in commands.faulted.items() if name not in ("missing", "refused")}
        if told:
            yield f"faults     {', '.join(f'{name} {count}' for name, count in told.items())}"
    lost = ", ".join(f"{count} {topic}" for topic, count in summary.lost.items()) or "none"
    yield f"lost       {lost}; safe states: {summary.safe_states}"
    if summary.turned:
        yield f"away       {', '.join(f'{what} {count}' for what, count in summary.turned.items())}"
    if summary.alarms:
        yield f"alarms     {', '.join(f'{name} {count}' for name, count in summary.alarms.items())}"


def print_checks(results: "list[CheckResult]") -> None:
    """The verdicts of `hydrotwin check`."""
    rows = []
    for result in results:
        rows += [(result.name, fault, "", Text("FAILED", "red")) for fault in result.faults]
        for verdict in result.verdicts:
            mark = Text("passed", "green") if verdict.passed else Text("FAILED", "red")
            rows.append((result.name, verdict.words, verdict.found, mark))
        rows += [(result.name, note, "", Text("note", "yellow")) for note in result.notes]
    print_table(("scenario", "expected", "found", ""), rows)


def print_differences(found: "list[Difference]", as_json: bool, further: dict[str, Any] | None = None) -> None:
    """The table of a comparison."""
    from bridge.cli.tables import print_table

    if as_json:
        plain = [{k: None if v != v else v for k, v in difference._asdict().items()} for difference in found]
        print_json({"signals": plain, "passed": all(d.passed for d in found), **(further or {})})
        return
    print_table(
        ("signal", "greatest", "at", "rms", "first beyond", "allowed", "instants", "alone", ""), map(_row, found)
    )


def _row(d: "Difference") -> tuple[str | Text, ...]:
    """In the units that people read; --json has SI."""
    factor, unit = shown(d.unit)

    def time(value: float | None) -> str:
        return "-" if value is None else f"{value:.6g} s"

    mark = Text("same" if d.greatest == 0.0 else "within", "green") if d.passed else Text("DIFFERS", "red")
    return (
        d.signal,
        f"{d.greatest * factor:.4g} {unit}",
        time(d.at),
        f"{d.rms * factor:.3g} {unit}",
        time(d.first),
        f"{d.tolerance * factor:.6g} {unit}",
        str(d.instants),
        str(d.alone),
        mark,
    )


EVENTS = 20  # events that are shown; --json gives all


def print_info(found: "RecordingInfo") -> None:
    """Facts, channels, events, metrics."""
    from bridge.recording.info import plain

    console = Console(soft_wrap=True, highlight=False)
    size = "" if found.size is None else f", {found.size / 1e6:.2f} MB"
    console.print(plain_text(found.file, "bold") + plain_text(size))
    for problem in found.problems:
        console.print(plain_text(problem, "red"))
    for note in found.notes:
        console.print(plain_text(note, "yellow"))
    print_table(("", ""), [(name, plain(value)) for name, value in _facts(found)])
    print_table(("channel", "type", "messages", "from", "to", "rate", "gaps", "longest", "lost"), _channels(found))
    if "imported" in found.metadata:
        print_imported_signals(found.metadata["imported"])
    _print_events(console, found.events)
    if found.summary and found.summary.metrics:
        print_table(("metric", ""), _metric_rows(found.summary))


def _facts(found: "RecordingInfo") -> list[tuple[str, Any]]:
    names = ("ending", "scenario", "title", "rig", "mode", "speed", "recorded", "run_id")
    names += ("law", "parameters", "lost", "host", "versions")
    others = {name: values for name, values in found.metadata.items() if name != "imported"}
    own = [(f"{name}.{key}", value) for name, values in others.items() for key, value in values.items()]
    own = [*told_of_log(found.metadata["imported"]), *own] if "imported" in found.metadata else own
    known = found.plain()
    return [(name, known[name]) for name in names if known.get(name) not in (None, "", {})] + own


def told_of_log(told: dict[str, Any]) -> list[tuple[str, str]]:
    """What an imported recording says of its log; its signals have a table of their own."""
    from bridge.recording.imported import rows_in_words

    time = told["time"]
    words = f"first {time.get('first')}, usually every {time.get('interval', 0.0) * 1e3:.6g} ms"
    jitter = f", at most {time.get('jitter', 0.0) * 1e3:.3g} ms off" if time.get("jitter", 0.0) > 1e-9 else ""
    named = [("log", told["source"]), ("sha256", told["sha256"]), ("form", str(told.get("form")))]
    counted = [("rows", rows_in_words(told["rows"])), ("time", words + jitter)]
    return [*named, ("map", str(told.get("map"))), *counted, *(("note", str(note)) for note in told["notes"])]


def print_imported_signals(told: dict[str, Any]) -> None:
    """Where each signal of an imported recording comes from, and what is missing of it."""
    from bridge.recording.imported import holes_in_words, noise_in_words

    rows = [
        (name, entry["column"], entry["taken in"] or "-", entry["method"], noise_in_words(entry), holes_in_words(entry))
        for name, entry in told["signals"].items()
    ]
    print_table(("signal", "column", "taken in", "method", "noise (rms)", "missing"), rows)


def _channels(found: "RecordingInfo") -> list[tuple[str, ...]]:
    return [
        (
            c.topic,
            c.type.rpartition("/")[2],
            str(c.messages),
            f"{c.first:.3f} s",
            f"{c.last:.3f} s",
            "-" if c.rate is None else f"{c.rate:.6g} /s",
            str(c.gaps),
            "-" if c.longest is None else f"{c.longest * 1e3:.6g} ms",
            str(c.lost),
        )
        for c in found.channels
    ]


def _print_events(console: Console, events: "list[EventInfo]") -> None:
    for event in events[:EVENTS]:
        console.print(plain_text(f"{event.time:10.3f} s  {event.kind:8}  {event.text}"))
    if len(events) > EVENTS:
        console.print(f"… and {len(events) - EVENTS} events more: --json gives all")
