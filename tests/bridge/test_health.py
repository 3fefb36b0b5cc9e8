"""A judge beside a twin: one fault found and rightly named, and a rig in order that is not called ill."""

import math
from pathlib import Path

import pytest

from bridge.cli.health_printing import limit_of, needed, print_health
from bridge.errors import UsageError
from bridge.loop.follower import FollowerSide
from bridge.loop.health import FEWEST, plain, watching
from bridge.replay.into_follower import through_follower
from bridge.runs.in_process import run_in_memory
from bridge.scenario import load
from bridge.wire.codec import decode, encode
from bridge.wire.health import PLACES
from bridge.wire.messages import HEALTH
from tests.support.command import hydrotwin_here
from twin.estimation.filter import fewest
from twin.estimation.health import Finding, Health, Rules
from twin.estimation.hypotheses import HYPOTHESES, Verdict, in_words
from twin.estimation.settings import Settings

MOTION = ["reference.frequency=1 Hz", "reference.amplitude=25 mm", "reference.at=0.5 s"]
RULES = Rules(alarms_per_hour=1.0, look=0.25, window=2, commissioning=24, resting=0)
LEAK = 'fault=[{target="cylinder", kind="leak", factor=10.0, at="7.8 s"}]'
HOLE = 0.6 * 0.25 * math.pi * 0.3e-3**2 * math.sqrt(2.0 / (870.0 * 30e5))  # [m^3/(s Pa)], of 0.3 mm at 30 bar
OTHER = ["rig.load.mass=132 kg", "rig.valve.rated_flow=27 l/min", "rig.seal.limit=0.275", "rig.seal.alpha=4.2e-6"]


def judged(*changes: str) -> tuple[FollowerSide, list]:
    """A run, and what is said of its health by twins that know of no changes."""
    rec = run_in_memory(load("sine", [*MOTION, *changes]))
    side = FollowerSide(load("sine", MOTION), watching(Settings()), rules=RULES)
    out = [message for messages in through_follower(rec, side) for message in messages]
    return side, [message.message for message in out if message.topic == HEALTH]


def test_a_leak_ten_times_as_large_is_found_and_named():
    """Within 4.2 s after a commissioning of six, its size within a factor of 1.2; silent before."""
    side, said = judged("duration=12 s", LEAK)
    before = [m.verdict for m in said if m.stamp <= 7.8e9]
    assert Verdict.HEALTHY in before
    assert max(before) == Verdict.HEALTHY
    last = said[-1]
    assert last.verdict == Verdict.FAULT
    assert PLACES[last.first] == "leak_across"
    assert last.suspects == 1 << last.first
    assert last.leak_across_size == pytest.approx(math.log(10.0), abs=math.log(1.2))
    assert 8.0 < last.since < 11.25
    assert side.health is not None
    turns = [
        m for k, m in enumerate(said) if k and (m.verdict, m.suspects) != (said[k - 1].verdict, said[k - 1].suspects)
    ]
    assert [words.partition(" s:")[0] for words in side.health.told[-len(turns) :]] == [
        f"t = {m.stamp / 1e9:g}" for m in turns
    ]
    assert "fault, beyond the limit" in side.health.told[-1]
    assert "leak across the piston" in side.health.told[-1]
    assert limit_of(side.health.latest, RULES) == side.health.limit
    assert plain(side.health.latest)["suspects"] == ["leak_across"]
    assert decode(encode(last), HEALTH).suspects == last.suspects


def test_a_leak_to_the_outside_is_told_from_all_else():
    """By twins alone: the estimate has no unknown for it."""
    burst = 'fault=[{target="pipe_3", kind="burst", diameter="0.3 mm", at="7.8 s"}]'
    _, said = judged("duration=12 s", "rig.cylinder.holes=fitted", burst)
    last = said[-1]
    assert last.verdict == Verdict.FAULT
    assert PLACES[last.first] == "leak_outside_lower"
    assert last.leak_outside_lower_size == pytest.approx(HOLE, rel=0.3)  # a law of a leak, beside that of a hole


def test_a_rig_that_is_another_than_the_twins_and_in_order_is_not_called_ill():
    """10 % in load, valve and friction, from the beginning: its baseline is what it was commissioned with."""
    _, said = judged("duration=8.5 s", *OTHER)
    assert [m.verdict for m in said].count(Verdict.HEALTHY) >= 4
    assert max(m.verdict for m in said) == Verdict.HEALTHY
    first = next(m.stamp for m in said if m.verdict == Verdict.HEALTHY) / 1e9
    assert sum(needed(RULES)) == pytest.approx(6.5)
    assert 0.3 <= first - sum(needed(RULES)) <= 0.4 + 2 * RULES.look  # it follows from 0.3 to 0.4 s on, within a look
    assert needed(Rules()) == (10.0, 30.0, 2.0)  # as docs/health.md has it


def test_a_commissioning_too_short_for_three_windows_is_refused():
    with pytest.raises(UsageError, match="three windows"):
        FollowerSide(load("sine"), watching(Settings()), rules=RULES._replace(commissioning=4))


def test_the_table_of_health_has_every_hypothesis_the_limit_and_units_that_people_read(
    capsys: pytest.CaptureFixture[str],
):
    """Offsets in bar, no -0.0, and leaks to the outside, of which there is no deviate."""
    findings = {name: Finding(-0.01, 0.1, 0.2) for name in HYPOTHESES if not name.startswith("leak_outside")}
    findings |= {"sensor_p2": Finding(6.04, -1.185e4, 300.0), "friction": Finding(math.nan, 0.0, 0.1)}
    print_health(Health(60.0, Verdict.HEALTHY, (), math.nan, math.nan, findings), Rules())
    lines = capsys.readouterr().out.splitlines()
    assert "deviate, limit 5.28" in lines[0]  # of 21 sides and one false alarm in 100 h: docs/health.md
    rows = {line.split()[0]: line for line in lines[1:]}
    assert rows.keys() == HYPOTHESES.keys()
    assert "6.0" in rows["sensor_p2"]
    assert "-0.119 bar (+- 0.003)" in rows["sensor_p2"]
    assert "not known" in rows["friction"]
    assert "-0.0" not in rows["load"]
    assert "by twins alone" in rows["leak_outside_lower"]
    hole = in_words("leak_outside_lower", 0.5 / 60e3 / 100e5, 0.1 / 60e3 / 100e5)
    assert hole.endswith("+0.5 l/min at 100 bar (+- 0.1)")


def test_velocity_and_pressures_of_a_judge_s_twins_do_not_wander_and_each_draw_has_its_direction():
    settings = watching(Settings(members=4))
    assert {name for name, noise in settings.noises().items() if noise > 0.0} == {"position"}
    count = len(FollowerSide(load("sine"), settings).filter.names)
    assert settings.members == FEWEST == fewest(settings, count)


def test_too_few_members_for_a_judge_are_refused(tmp_path: Path):
    """In one line, before anything is read."""
    done = hydrotwin_here("follow", "a.mcap", "--health", "--members", str(FEWEST - 1), cwd=tmp_path)
    assert done.returncode == 2
    assert f"--members {FEWEST - 1}: with --health at least {FEWEST}" in done.stderr
    assert done.stderr.count("\n") == 1
