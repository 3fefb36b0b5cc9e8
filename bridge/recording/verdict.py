"""What makes a run good, for every mode and whoever asks: run, check, record, info, report.

Commands are taken at the expected rate and in time, none is refused (those excepted that the scenario's faults of the
link keep away or change), the plant never goes to its safe state, nothing is
lost, and in real time the clock is kept. A scenario says what else it expects in `allowed` and `real_time`.
"""

import math
from collections.abc import Iterator

from bridge.recording.summary import CommandSummary, Summary
from bridge.scenario import Scenario
from bridge.wire.events import ending_of
from bridge.wire.messages import Ending, EventKind, Reason

ENDED_EARLY = "the run ended early"


def verdict(summary: Summary, scenario: Scenario) -> list[str]:
    """What makes a run a failure, one sentence each, the main reason first; empty for a good one."""
    tests = (_ended_early, _refused, _safe, _degraded, _untimely, _lost, _overruns)
    return [fault for test in tests for fault in test(summary, scenario)]


def _ended_early(summary: Summary, scenario: Scenario) -> Iterator[str]:
    if ending_of(summary.ending) != Ending.COMPLETE:
        yield f"{ENDED_EARLY}: {summary.ending}"


def _refused(summary: Summary, scenario: Scenario) -> Iterator[str]:
    """Those that a safe state keeps out follow from it."""
    refused = dict(summary.commands.refused) if summary.commands else {}
    if summary.safe_states:
        refused = {reason: n for reason, n in refused.items() if reason not in (Reason.LATCHED, Reason.ALARM)}
    by_faults = summary.commands.faulted.get("refused", 0) if summary.commands else 0
    if (number := sum(refused.values()) - by_faults) > (most := scenario.allowed.refused):
        reasons = ", ".join(f"{count} {reason}" for reason, count in refused.items())
        first = summary.first.get(EventKind.REFUSED)
        example = f"; the first {first}" if first else ""
        yield f"the plant refused {_counted(number, 'command')} ({reasons}{example}): allowed.refused is {most}"


def _safe(summary: Summary, scenario: Scenario) -> Iterator[str]:
    if (number := summary.safe_states) > (most := scenario.allowed.safe_states):
        first = summary.first.get(EventKind.SAFE)
        when = f", first {first}" if first else ""
        yield f"the plant went to its safe state {_counted(number, 'time')}{when}; allowed.safe_states is {most}"


def _degraded(summary: Summary, scenario: Scenario) -> Iterator[str]:
    if (number := summary.degraded) > (most := scenario.allowed.degraded):
        first = summary.first.get(EventKind.DEGRADED)
        when = f", first {first}" if first else ""
        yield f"the plant was degraded {_counted(number, 'time')}{when}; allowed.degraded is {most}"


def _untimely(summary: Summary, scenario: Scenario) -> Iterator[str]:
    """A command that is late or missing makes the data differ from those of lockstep."""
    commands = summary.commands
    if commands is None:
        return
    missing = 0 if summary.safe_states else _missing(commands)  # the silence before a safe state is told there
    share, due = scenario.real_time.late_commands, commands.due or commands.sent
    if commands.late + missing > (most := math.ceil(share * due)):
        late = f"{commands.late} late (worst {commands.worst_lateness * 1e3:.2f} ms)" if commands.late else ""
        absent = f"{missing} missing" if missing else ""
        what = " and ".join(filter(None, (late, absent)))
        yield f"of {_counted(due, 'command')} {what}: real_time.late_commands allows {share:.3g} of them, {most}"


def _missing(commands: CommandSummary) -> int:
    """Commands that were due and never came."""
    if commands.due is None or commands.taken is None:
        return 0
    known = sum(commands.refused.values()) + commands.faulted.get("missing", 0)
    return max(0, commands.due - commands.taken - known)


def _lost(summary: Summary, scenario: Scenario) -> Iterator[str]:
    if any(summary.lost.values()):
        lost = ", ".join(f"{count} {topic}" for topic, count in summary.lost.items() if count)
        yield f"messages were lost on the way to the recorder: {lost}"


def _overruns(summary: Summary, scenario: Scenario) -> Iterator[str]:
    overruns, policy = summary.timing and summary.timing.overruns, scenario.real_time
    ticks = summary.simulated and summary.simulated / scenario.loop.daq_period
    if not overruns or not ticks:
        return
    late = overruns.number if overruns.ticks is None else overruns.ticks
    if late > policy.overruns * ticks or overruns.worst > policy.length:
        yield (
            f"{late} of {ticks:.0f} ticks ({late / ticks:.2%}) came a period or more late, the worst by "
            f"{overruns.worst * 1e3:.1f} ms: real_time allows {policy.overruns:.3g} of them (overruns), by at most "
            f"{policy.length * 1e3:g} ms (length)"
        )


def _counted(number: int, word: str) -> str:
    return f"{number} {word}{'s' * (number != 1)}"
