"""A twin beside the rig of a scenario: what it finds out, and that it is a function of scans and commands alone."""

import math
from functools import cache

import numpy as np
import pytest

from bridge.errors import UsageError
from bridge.loop.follower import FollowerSide, followed
from bridge.recording.reader import Recording, recording
from bridge.replay.into_follower import through_follower
from bridge.runs.in_process import MEMORY, run_in_memory
from bridge.scenario import Scenario, load
from bridge.wire.codec import decode, encode
from bridge.wire.messages import ESTIMATE, INNOVATION, Outgoing
from twin.estimation.quantities import Standing, Use
from twin.estimation.settings import Settings

BASE = ["duration=1.2 s", "loop.delay=5 ms"]
OTHER = ["rig.load.mass=132 kg", "rig.valve.rated_flow=27 l/min", "rig.seal.limit=0.275", "rig.seal.alpha=4.2e-6"]
WITHOUT_P3 = Settings(without=("p3",))


@cache
def run(*changes: str) -> Recording:
    """A sine, run in process."""
    return run_in_memory(load("sine", [*BASE, *changes]))


@cache
def nominal() -> Scenario:
    """What the twin knows."""
    return load("sine", BASE)


def estimates(rec: Recording, side: FollowerSide) -> tuple[list[Outgoing], dict[str, np.ndarray]]:
    """What a follower says of a recording, and its estimates as columns."""
    out = [message for messages in through_follower(rec, side) for message in messages]
    found = [message.message for message in out if message.topic == ESTIMATE]
    return out, {
        name: np.array([getattr(m, name) for m in found]) for name in found[0].__dataclass_fields__ if name[0] != "_"
    }


def truth(rec: Recording, stamps: np.ndarray, name: str) -> np.ndarray:
    """The true values at the stamps."""
    columns = rec.columns("state")
    return columns[name][np.searchsorted(columns["stamp"], stamps)]


def test_a_chamber_without_a_sensor_is_found_by_a_twin_of_another_rig():
    """10 % in load, valve and friction: the upper chamber within 1 bar rms after half a second; the pressures of both
    rigs are five times as far apart."""
    rec = run(*OTHER)
    _, found = estimates(rec, FollowerSide(nominal(), WITHOUT_P3))
    late = found["stamp"] > 0.6e9
    away = (found["p_upper"] - truth(rec, found["stamp"], "p_upper"))[late]
    rms = math.sqrt((away**2).mean())
    assert rms < 1.0e5
    apart = truth(run(), found["stamp"], "p_upper") - truth(rec, found["stamp"], "p_upper")
    assert rms < math.sqrt((apart[late] ** 2).mean()) / 5.0
    assert found["unknown_valve_gain"][-1] == pytest.approx(0.9, abs=0.02)
    load_true = truth(rec, found["stamp"], "mass")[-1] * -9.81
    assert found["load"][-1] == pytest.approx(load_true, abs=120.0)
    assert (found["standing"][late] == Standing.FOLLOWING).all()


def test_the_same_scans_and_commands_make_the_same_bits_in_any_order():
    """Commands that come after the next scan, as on a network, and messages that come twice change nothing."""
    rec = run()
    one, _ = estimates(rec, FollowerSide(nominal(), Settings(members=24)))
    late = sorted(rec.entries, key=lambda e: e.log_time + (e.topic == "command") * 3_500_000)
    entries = [entry for entry in late for _ in range(1 + (entry.topic == "measurement"))]
    side, other = FollowerSide(nominal(), Settings(members=24)), []
    for entry in entries:
        if entry.topic == "command":
            other += side.take(decode(entry.data, "command"))
        elif entry.topic == "measurement":
            other += side.hear(decode(entry.data, "measurement"))
    other += side.finish()
    assert _bits(one) == _bits(other)


def _bits(messages: list[Outgoing]) -> list[bytes]:
    return [encode(m.message) for m in messages]


def test_missing_scans_spikes_and_a_dead_sensor_are_survived():
    """From 0.5 s on p2 reads 60 bar; each tenth scan is lost, one position in fifty is wild."""
    rec = run()
    side, last = FollowerSide(nominal(), Settings(members=24)), None
    for entry in rec.entries:
        if entry.topic == "command":
            side.take(decode(entry.data, "command"))
        if entry.topic != "measurement":
            continue
        m = decode(entry.data, "measurement")
        if m.tick % 10 == 3:
            continue
        m.position = 0.25 if m.tick % 50 == 7 else m.position
        m.p2 = 60e5 if m.stamp > 0.5e9 else m.p2
        for out in side.hear(m):
            last = out if out.topic == INNOVATION else last
    assert last is not None
    assert Use(int(last.message.p2_use)) in (Use.OFF, Use.STUCK)
    assert side.latest is not None
    true = truth(rec, np.array([round(side.latest.stamp * 1e9)]), "p_lower")[0]
    assert side.latest.values["p_lower"] == pytest.approx(true, abs=0.5e5)
    assert side.latest.standing == Standing.FOLLOWING


def test_an_hour_without_a_scan_is_not_integrated(monkeypatch: pytest.MonkeyPatch):
    """It ends an estimate: the next scan that has a position begins another."""
    rec, side = run(), FollowerSide(nominal(), Settings())
    through = [e for e in rec.entries if e.topic in ("command", "measurement") and e.log_time < 0.3e9]
    for entry in through:
        message = decode(entry.data, entry.topic)
        side.take(message) if entry.topic == "command" else side.hear(message)
    side.finish()
    scan = decode(through[-1].data, through[-1].topic)
    assert side.restarts == 0
    steps = []
    monkeypatch.setattr(side.filter, "advance", lambda reference, steps_: steps.append(steps_))
    hour = 3600 * 10**9
    for later, position in ((0, math.nan), (10**6, scan.position)):
        scan.stamp, scan.tick, scan.position = hour + later, 3_600_000 + later // 10**6, position
        side.hear(scan)
        side.finish()
        assert side.restarts == (0 if math.isnan(position) else 1)
    assert not steps


def test_it_says_that_it_does_not_know_when_nothing_is_read():
    rec = run()
    side, spread = FollowerSide(nominal(), Settings(members=24)), []
    for entry in rec.entries:
        if entry.topic == "command":
            side.take(decode(entry.data, "command"))
        if entry.topic == "measurement":
            m = decode(entry.data, "measurement")
            if m.stamp > 0.6e9:
                m.position = m.velocity = m.p1 = m.p2 = m.p3 = math.nan
            side.hear(m)
            spread.append(side.latest.deviations["position"] if side.latest else math.nan)
    assert side.latest is not None
    assert side.latest.standing == Standing.LOST
    assert spread[-1] > 5.0 * spread[590]


def test_it_joins_in_the_middle_and_after_a_restart_of_the_plant():
    rec = run()
    middle = [entry for entry in rec.entries if entry.log_time >= 0.4e9]
    side = FollowerSide(nominal(), Settings(members=24))
    _, found = estimates(recording(MEMORY, middle, {}), side)
    late = found["stamp"] > 0.8e9
    away = (found["p_upper"] - truth(rec, found["stamp"], "p_upper"))[late]
    assert math.sqrt((away**2).mean()) < 0.3e5
    again = run("seed=9")
    _, found = estimates(again, side)
    assert side.restarts == 1
    assert found["standing"][-1] == Standing.FOLLOWING


def test_what_is_to_happen_is_not_known_to_it():
    scenario = load("load-change")
    assert scenario.expect
    assert not followed(scenario).expect
    assert followed(load("sine")).loop.step == pytest.approx(100e-6)
    assert followed(load("sine", ["loop.delay=50 us"])).loop.step == pytest.approx(50e-6)  # it must divide the delay


def test_an_unknown_channel_is_refused():
    with pytest.raises(UsageError, match="p9"):
        FollowerSide(nominal(), Settings(without=("p9",)))
    with pytest.raises(UsageError, match="position"):
        FollowerSide(nominal(), Settings(without=("position",)))
