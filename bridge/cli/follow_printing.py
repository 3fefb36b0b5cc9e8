"""What `hydrotwin follow` prints of an estimate."""

import math

from bridge.cli.health_printing import needed, print_health
from bridge.cli.tables import print_table
from bridge.processes.follower import FollowerReport
from bridge.recording.innovations import Missed
from bridge.replay.followed import LEFT_OUT, Followed
from bridge.replay.whatif import Verdict
from bridge.scenario.bands import METRICS, value_with_unit
from bridge.scenario.units import shown
from twin.estimation.filter import Estimate, Innovation
from twin.estimation.health import Rules
from twin.estimation.quantities import ESTIMATED, LOAD, UNKNOWNS, Use
from twin.topology import CHANNELS

RIGHT = 1.5  # mean square of independent innovations, at most 1 as long as the model is right; room for chance, assumed
SHOWN = ("position", "velocity", "spool", "p1", "p_p", "p_a", "p_lower", "p_upper", "p_b", "friction", LOAD)


def print_followed(done: Followed, rules: Rules | None) -> None:
    """Of a recording."""
    print_estimate(done.latest)
    print_channels(done.latest, {name: _missed(name, one) for name, one in done.missed.items()}, done.without)
    if done.health is not None and rules is not None:
        print_health(done.health.latest, rules)
        for words in done.health.told:
            print(words)
        if not done.judged:
            print(f"health not judged: {needed(rules).words}, it was followed for {done.seconds['following']:.3g} s")
    stood = ", ".join(f"{name} {time:.3g} s" for name, time in done.seconds.items() if time)
    before = ", in place of an earlier one" if done.replaced else ""
    print(f"{done.output}{before}: {done.estimates} estimates; {stood}; begun anew {done.restarts} times")


def print_report(done: FollowerReport, rules: Rules | None, without: tuple[str, ...]) -> None:
    """Of a rig that has run."""
    if done.latest is None:
        print("hydrotwin: no measurement came that says where the piston is: nothing was estimated")
        return
    print_estimate(done.latest)
    print_channels(done.latest, {name: _newest(name, one) for name, one in done.latest.innovations.items()}, without)
    if done.health is not None and rules is not None:
        print_health(done.health, rules)
        if not done.health.findings:
            verdict = done.health.verdict.name.lower().replace("_", " ")
            print(f"health {verdict}: {needed(rules).words}, the last estimate is of t = {done.latest.stamp:.3g} s")
    standing = done.latest.standing.name.lower()
    print(
        f"{done.estimates} estimates, {standing} at the end; begun anew {done.restarts} times; "
        f"{100.0 * done.processor_share:.0f} % of a core, at most {1e3 * done.longest_lag:.0f} ms behind"
    )


def print_estimate(last: Estimate) -> None:
    """Quantities and unknowns."""
    rows = []
    for name in SHOWN:
        scale, unit = shown(ESTIMATED[name])
        rows.append((name, f"{scale * last.values[name]:.5g}", f"{scale * last.deviations[name]:.2g}", unit, ""))
    for name, value in last.unknowns.items():
        unknown = UNKNOWNS[name]
        scale, unit = shown(unknown.unit) if unknown.unit else (1.0, "times")
        deviation = f"{scale * last.unknown_deviations[name]:.2g}"
        words = name if unknown.unit else f"{name} factor"  # friction and load are quantities, too
        rows.append((words, f"{scale * value:.4g}", deviation, unit, unknown.words))
    print_table((f"at {last.stamp:g} s", "estimate", "+-", "", ""), rows)


def print_channels(last: Estimate, missed: dict[str, str], without: tuple[str, ...]) -> None:
    """What is made of each channel, and whether its innovations are what a right model makes."""
    rows = []
    for name, found in last.innovations.items():
        use = LEFT_OUT if name in without else Use(found.use).name.lower()
        verdict = found.verdict
        rows.append((name, use, missed[name], *map(_number, (verdict.nis, verdict.whiteness, verdict.square))))
    head = ("channel", "use", "reading less prediction", "mean square", "correlation", "mean square, independent")
    print_table(head, rows)
    if wrong := [name for name, found in last.innovations.items() if found.verdict.square > RIGHT]:
        print(f"{', '.join(wrong)}: independent ones above {RIGHT:g}, more than a right model leaves")


def _missed(name: str, found: Missed) -> str:
    if not found.scans:
        return "never read"
    scale, unit = shown(CHANNELS[name].unit)
    return f"rms {scale * found.rms:.3g} {unit}, {found.deviations:.2g} deviations"


def _newest(name: str, found: Innovation) -> str:
    if math.isnan(found.away):
        return "not read"
    scale, unit = shown(CHANNELS[name].unit)
    return f"last {scale * found.away:+.3g} {unit}, {found.away / found.deviation:+.2g} deviations"


def _number(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.2g}"


def print_verdict(verdict: Verdict) -> None:
    """What would happen."""
    rows = [
        (METRICS[name].words, *(value_with_unit(name, spread[word]) for word in ("low", "median", "high")))
        for name, spread in verdict.metrics.items()
    ]
    print_table((verdict.tried or "nothing changed", "5 %", "median", "95 %"), rows)
    for kept in verdict.bands:
        print(f"{kept.band}: kept in {kept.kept} of {kept.futures} futures")
    speed = verdict.horizon / verdict.took if verdict.took > 0.0 else 0.0
    words = "" if not verdict.bands else "; as expected" if verdict.passed else "; NOT as expected"
    print(f"from t = {verdict.time:g} s, {verdict.horizon:g} s ahead, {speed:.1f} times real time{words}")
