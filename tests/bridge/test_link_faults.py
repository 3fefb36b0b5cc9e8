"""A bad link: what becomes of messages, that both halves of the loop agree on it, and that chance is the seed's."""

import math
from pathlib import Path

import numpy as np
import pytest

from bridge.loop.fault_chance import Luck
from bridge.loop.fault_clock import Spell
from bridge.loop.link_faults import Way
from bridge.recording.digest import digest
from bridge.recording.reader import Recording
from bridge.replay.through import Through, replay_through
from bridge.runs.in_process import record_in_process
from bridge.scenario import Scenario, load
from bridge.scenario.faults import planned
from controller.grid import NS
from tests.support.processes import run_recorded

MS, DAQ = NS // 1000, NS // 1000
WINDOW = 'at="0.2 s", lasts="0.3 s"'
MESSAGES = 20_000
MIXED = (
    '{target="link.command", kind="delay", time="8 ms", at="0.15 s", lasts="0.2 s"}',
    '{target="link.measurement", kind="loss", share=0.3, at="0.4 s", lasts="0.2 s"}',
    '{target="link.measurement", kind="reorder", at="0.7 s", lasts="0.2 s"}',
    '{target="link.command", kind="duplicate", share=0.5, at="0.7 s", lasts="0.1 s"}',
    '{target="link.command", kind="freeze", at="1 s", lasts="40 ms"}',
    '{target="link.measurement", kind="delay", law="exponential", time="0 s", spread="6 ms", when="position > 112 mm"}',
)


def scenario(*faults: str, seed: int = 1, changes: tuple[str, ...] = ()) -> Scenario:
    """The step at 0.1 s without a delay of its own."""
    own = ("reference.at=0.1", "loop.delay=0", f"seed={seed}", "duration=1.2", f"fault=[{', '.join(faults)}]")
    return load("step", [*own, *changes])


def sent(kind: str, seed: int = 1, count: int = MESSAGES, **sizes: object) -> list[tuple[tuple[int, ...], int]]:
    """Arrivals after their sending [ns], and shifts, of messages that are sent every millisecond."""
    words = ", ".join(f'{name}="{value}"' for name, value in sizes.items())
    made = scenario(f'{{target="link.command", kind="{kind}", at=0.0, {words}}}')
    (fault,) = planned(made)
    way = Way(seed, "command", DAQ)
    way.start(Spell(fault, 0, count * MS, 0))
    fates = [way.send(number, number * MS) for number in range(count)]
    return [(tuple(a - number * MS for a in fate.arrivals), fate.shift) for number, fate in enumerate(fates)]


def test_losses_come_with_their_share():
    """Within 4 standard deviations of a binomial."""
    lost = sum(not arrivals for arrivals, _ in sent("loss", share=0.1))
    assert abs(lost - 0.1 * MESSAGES) < 4.0 * math.sqrt(0.1 * 0.9 * MESSAGES)


def test_bursts_of_losses_have_their_share_and_their_length():
    """Gilbert's chain: the mean burst is 1/r messages, geometric; the share p/(p + r)."""
    lost = np.array([not arrivals for arrivals, _ in sent("burst-loss", share=0.2, length=8)])
    ends = np.flatnonzero(lost[:-1] & ~lost[1:])
    bursts = len(ends)
    assert lost.sum() / bursts == pytest.approx(8.0, abs=4.0 * math.sqrt(8.0 * 7.0 / bursts))
    assert lost.mean() == pytest.approx(0.2, abs=4.0 * math.sqrt(0.2 * 0.8 * 15.0 / MESSAGES))


@pytest.mark.parametrize(
    ("law", "mean", "deviation"),
    [("uniform", 20.0, 4.0 / math.sqrt(3.0)), ("normal", 20.0, 4.0), ("exponential", 24.0, 4.0)],
)
def test_delays_follow_their_law(law: str, mean: float, deviation: float):
    """Sent so far apart that none waits for the one before it."""
    words = f'{{target="link.command", kind="delay", law="{law}", time="20 ms", spread="4 ms", at=0.0}}'
    (fault,) = planned(scenario(words))
    way = Way(1, "command", DAQ)
    way.start(Spell(fault, 0, 10**15, 0))
    taken = np.array([way.send(n, n * NS).arrivals[0] - n * NS for n in range(4000)]) / MS
    assert taken.mean() == pytest.approx(mean, abs=4.0 * deviation / math.sqrt(4000))
    assert taken.std() == pytest.approx(deviation, rel=0.1)


def test_constant_growing_and_bursting_delays():
    assert {arrivals for arrivals, _ in sent("delay", count=100, time="5 ms")} == {(5 * MS,)}
    growing = [a[0] for a, _ in sent("delay", count=100, law="growing", time="5 ms", growth=0.1)]
    assert growing == [5 * MS + round(0.1 * n * MS) for n in range(100)]
    bursts = [a[0] > 0 for a, _ in sent("delay", law="bursts", time="0.5 ms", share=0.25, length=5)]
    assert np.mean(bursts) == pytest.approx(0.25, abs=0.03)


def test_no_delayed_message_overtakes_another_and_a_reordered_one_does():
    sizes = {"law": "exponential", "time": "0 s", "spread": "5 ms"}
    arrivals = [n * MS + a[0] for n, (a, _) in enumerate(sent("delay", 1, MESSAGES, **sizes))]
    assert arrivals == sorted(arrivals)
    held = [n * MS + a[0] for n, (a, _) in enumerate(sent("reorder", share=0.1, time="5 ms"))]
    assert held != sorted(held)


def test_frozen_messages_come_at_the_end_doubled_ones_twice_and_a_wrong_clock_is_ahead():
    frozen = sent("freeze", count=100, lasts="100 ms")
    assert {n * MS + a[0] for n, (a, _) in enumerate(frozen)} == {100 * MS}
    doubled = sent("duplicate", share=1.0, time="3 ms", count=10)
    assert {a for a, _ in doubled} == {(0, 3 * MS)}
    clock = sent("clock", offset="2 ms", drift=1e-3, count=100)
    assert [shift for _, shift in clock] == [2 * MS + round(1e-3 * n * MS) for n in range(100)]


def test_chance_is_the_seed_s_the_name_s_and_the_number_s():
    luck = [Luck(seed, name).uniform(7) for seed, name in ((1, "a"), (1, "a"), (2, "a"), (1, "b"))]
    assert luck[0] == luck[1]
    assert len(set(luck)) == 3
    assert sent("loss", share=0.3, count=500) == sent("loss", share=0.3, count=500)
    assert sent("loss", share=0.3, count=500) != sent("loss", seed=2, share=0.3, count=500)


def applied(recording: Recording) -> np.ndarray:
    """The spool reference that acted, tick by tick."""
    return recording.columns("state")["reference"]


@pytest.mark.parametrize("direction", ["command", "measurement"])
@pytest.mark.parametrize(
    "fault",
    [
        'kind="delay", time="8 ms"',
        'kind="loss", share=0.5',
        'kind="burst-loss", share=0.5',
        'kind="duplicate", share=1.0, time="12 ms"',
        'kind="reorder", share=0.5',
        'kind="freeze"',
        'kind="clock", offset="4 ms"',
    ],
)
def test_a_fault_of_the_link_is_there_in_its_window_alone(fault: str, direction: str, tmp_path: Path):
    """Until it begins the run is as without it; in the window messages are counted or shifted; after it none is."""
    quiet = record_in_process(scenario(), tmp_path / "quiet.mcap")
    faulty = record_in_process(scenario(f'{{target="link.{direction}", {fault}, {WINDOW}}}'), tmp_path / "faulty.mcap")
    before = round(0.2 * NS / DAQ)
    assert (applied(quiet)[:before] == applied(faulty)[:before]).all()
    counts = faulty.metadata["summary"]["commands"]["faulted"]
    assert any(name.startswith(f"{direction}s") and count > 1 for name, count in counts.items()), counts
    events = [(event.text.split()[2], event.apply_at) for event in faulty.messages("event") if event.kind == "fault"]
    assert events == [("begins:", round(0.2 * NS)), ("ends:", round(0.5 * NS))]
    stamps = np.array([message.stamp for message in faulty.messages("measurement")])
    times = np.array([entry.log_time for entry in faulty.of("measurement")])
    odd = times[np.flatnonzero(stamps != times)]
    assert ((odd >= 0.2 * NS) & (odd <= 0.53 * NS)).all()
    late = np.array([m.apply_at for m in faulty.messages("command") if m.sample_stamp > 0.55 * NS])
    samples = np.array([m.sample_stamp for m in faulty.messages("command") if m.sample_stamp > 0.55 * NS])
    assert (late == samples).all()
    assert len(samples) == 65


def test_a_delayed_command_acts_when_it_is_there(tmp_path: Path):
    """8 ms on a sample every 10 ms: what was to act at a tick acts seven ticks later, in the block in which it came."""
    fault = f'{{target="link.command", kind="delay", time="8 ms", {WINDOW}}}'
    run = record_in_process(scenario(fault, changes=("daq.quantise_output=false",)), tmp_path / "a.mcap")
    reference = applied(run)
    for command in run.messages("command"):
        tick = command.sample_stamp // DAQ
        if 210 <= tick < 480:
            assert reference[tick + 8] == command.spool
            assert reference[tick + 7] != command.spool or reference[tick + 7] == reference[tick + 8]
            assert (reference[tick + 8 : tick + 17] == command.spool).all()


def test_delays_of_both_ways_add_up(tmp_path: Path):
    """0.6 ms each way is more than the period of 1 ms in which a command may come, 0.4 ms each way is not."""
    way = 'kind="delay", time="{time}", at=0.0'
    for time, same in (("0.4 ms", True), ("0.6 ms", False)):
        both = (f'{{target="link.{d}", {way.format(time=time)}}}' for d in ("command", "measurement"))
        faulty = record_in_process(scenario(*both), tmp_path / f"{same}.mcap")
        quiet = record_in_process(scenario(), tmp_path / f"quiet{same}.mcap")
        assert (applied(quiet) == applied(faulty)).all() == same


def test_all_at_once_gives_the_same_bytes_by_processes_and_comes_out_of_replays(tmp_path: Path):
    """In process, in lockstep by three processes, into plant and controller with residual 0; another seed differs."""
    alone = record_in_process(scenario(*MIXED), tmp_path / "alone.mcap")
    changes = [f"--set={change}" for change in ("reference.at=0.1", "loop.delay=0", "duration=1.2")]
    fault = f"--set=fault=[{', '.join(MIXED)}]"
    by_processes = run_recorded(tmp_path / "lockstep.mcap", "step", "--mode", "lockstep", *changes, fault)
    assert digest(by_processes.path) == digest(alone.path)
    for into in ("plant", "controller"):
        verdict = replay_through(alone.path, Through(into, tmp_path / f"{into}.mcap", alone=True))
        assert verdict.events_differ is None
        assert {difference.greatest for difference in verdict.differences} == {0.0}
    other = record_in_process(scenario(*MIXED, seed=2), tmp_path / "other.mcap")
    of = [[m.stamp for m in recording.messages("measurement")] for recording in (alone, other)]
    assert of[0] != of[1]


def test_a_plant_resumes_once_and_by_a_young_answer_when_a_slow_link_is_good_again(tmp_path: Path):
    """Half a second late until 1 s: safe at 0.41 s; what comes from 0.8 s on is half a second old, and wakes nobody.

    The same in process and in lockstep, and out of a replay.
    """
    slow = '{target="link.command", kind="delay", time="0.5 s", at="0.3 s", lasts="0.7 s"}'
    changes = ("loop.after_timeout=resume", "allowed.safe_states=1", "expect=[]")
    alone = record_in_process(scenario(slow, changes=changes), tmp_path / "alone.mcap")
    told = [(e.kind, e.stamp / NS) for e in alone.messages("event") if e.kind in ("safe", "resumed")]
    assert [kind for kind, _ in told] == ["safe", "resumed"]
    assert told[1][1] == pytest.approx(1.0, abs=2e-3)
    own = [f"--set={change}" for change in ("reference.at=0.1", "loop.delay=0", "duration=1.2", *changes)]
    by_processes = run_recorded(tmp_path / "lockstep.mcap", "step", "--mode", "lockstep", *own, f"--set=fault=[{slow}]")
    assert digest(by_processes.path) == digest(alone.path)
    verdict = replay_through(alone.path, Through("plant", tmp_path / "again.mcap", alone=True))
    assert verdict.events_differ is None
    assert {difference.greatest for difference in verdict.differences} == {0.0}


def test_what_the_link_keeps_away_is_not_held_against_the_run(tmp_path: Path):
    """But for the safe state that a loss leads to, and for what a controller does itself."""
    from bridge.recording.summarise import known_or_made
    from bridge.recording.verdict import verdict

    half = scenario(f'{{target="link.command", kind="loss", share=0.5, {WINDOW}}}')
    assert verdict(known_or_made(record_in_process(half, tmp_path / "a.mcap"), half), half) == []
    all_of_them = scenario(f'{{target="link.command", kind="loss", share=1.0, {WINDOW}}}')
    found = verdict(known_or_made(record_in_process(all_of_them, tmp_path / "b.mcap"), all_of_them), all_of_them)
    assert "went to its safe state 1 time" in found[0]
