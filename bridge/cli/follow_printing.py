"""What `hydrotwin follow` prints of an estimate."""

import math

from bridge.cli.tables import print_table
from bridge.processes.follower import FollowerReport
from bridge.replay.followed import Followed
from bridge.replay.whatif import Verdict
from bridge.scenario.bands import METRICS, value_with_unit
from bridge.scenario.units import shown
from twin.estimation.filter import Estimate
from twin.estimation.health import Health
from twin.estimation.hypotheses import in_words
from twin.estimation.quantities import ESTIMATED, LOAD, UNKNOWNS, Use

SHOWN = ("position", "velocity", "spool", "p1", "p_p", "p_a", "p_lower", "p_upper", "p_b", "friction", LOAD)


def print_followed(done: Followed) -> None:
    """Of a recording."""
    print_estimate(done.latest)
    if done.health is not None:
        print_health(done.health.latest)
        print("\n".join(done.health.told))
    stood = ", ".join(f"{name} {time:.3g} s" for name, time in done.seconds.items() if time)
    print(f"{done.output}: {done.estimates} estimates; {stood}; begun anew {done.restarts} times")


def print_report(done: FollowerReport) -> None:
    """Of a rig that has run."""
    if done.latest is None:
        print("hydrotwin: no measurement came that says where the piston is: nothing was estimated")
        return
    print_estimate(done.latest)
    if done.health is not None:
        print_health(done.health)
    standing = done.latest.standing.name.lower()
    print(
        f"{done.estimates} estimates, {standing} at the end; begun anew {done.restarts} times; "
        f"{100.0 * done.processor_share:.0f} % of a core, at most {1e3 * done.longest_lag:.0f} ms behind"
    )


def print_estimate(last: Estimate) -> None:
    """Quantities, unknowns and channels."""
    rows = []
    for name in SHOWN:
        scale, unit = shown(ESTIMATED[name])
        rows.append((name, f"{scale * last.values[name]:.5g}", f"{scale * last.deviations[name]:.2g}", unit, ""))
    for name, value in last.unknowns.items():
        unknown = UNKNOWNS[name]
        deviation = f"{last.unknown_deviations[name]:.2g}"
        rows.append((name, f"{value:.4g}", deviation, unknown.unit or "times", unknown.words))
    print_table((f"at {last.stamp:g} s", "estimate", "+-", "", ""), rows)
    channels = [
        (name, Use(i.use).name.lower(), f"{i.verdict.nis:.2g}", f"{i.verdict.whiteness:.2g}")
        for name, i in last.innovations.items()
    ]
    print_table(("channel", "use", "mean square of innovations", "their correlation"), channels)


def print_health(health: Health) -> None:
    """How far each unknown has gone from its baseline, and what is made of it."""
    rows = [
        (name, "not known" if math.isnan(f.deviate) else f"{f.deviate:.1f}", in_words(name, f.size, f.deviation))
        for name, f in health.findings.items()
    ]
    if rows:
        print_table(("fault", "deviate", "if it were this one alone"), rows)


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
