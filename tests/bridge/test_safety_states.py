"""The plant's safety as a state machine: its table, its alarms, what the valve does, the same by every way."""

import math
import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bridge.errors import ScenarioError
from bridge.loop.alarm_watch import AlarmWatch
from bridge.loop.exchange import answered, sides
from bridge.loop.plant import PlantSide
from bridge.loop.safety_states import SafetyStates
from bridge.recording.changes import spans
from bridge.recording.digest import digest
from bridge.recording.reader import recording
from bridge.recording.summarise import summarise
from bridge.recording.verdict import verdict
from bridge.recording.writer import entries_of
from bridge.replay.into_plant import through_plant
from bridge.runs.in_process import record_in_process, run_in_memory
from bridge.scenario import Scenario, load
from bridge.scenario.safety import planned
from bridge.wire.codec import ValveCommand
from bridge.wire.messages import EventKind, Reason, SafetyState
from tests.support.processes import ROOT, run_recorded

PAGE = (ROOT / "docs/safety.md").read_text(encoding="utf-8")
ROW = re.compile(r"^\| (running|degraded|safe)(?:, (\w+))? \| (.+?) \| (\w+) \| `(\w+)`", re.MULTILINE)
ROWS = [(start, *row[2:]) for row in ROW.findall(PAGE) for start in row[:2] if start]
MS, RUN, OWNER, OTHER = 1_000_000, 5, 21, 22
QUIET = ("daq.noise=0", "daq.quantise=false", "daq.quantise_output=false", "loop.delay=0")
FAST = 'when="velocity > 100 mm/s", lasts="3 ms", hysteresis="60 mm/s", clears_after="4 ms", id="fast"'


def scenario_of(*alarms: str, changes: tuple[str, ...] = ()) -> Scenario:
    """The step, and alarms."""
    own = [f"alarm=[{', '.join(f'{{{alarm}}}' for alarm in alarms)}]"] if alarms else []
    return load("step", [*QUIET, "reference.at=0.02", "duration=0.4", *own, *changes])


def start(scenario: Scenario) -> PlantSide:
    side = PlantSide(scenario, RUN)
    side.start()
    return side


def command(side: PlantSide, spool: float, source: int = OWNER) -> bool:
    """An answer to the scan of now that acts at once."""
    number = side.now // MS
    return side.take(ValveCommand(RUN, source, number, side.now, side.now, spool))


def ticks(side: PlantSide, number: int) -> list[Any]:
    """The messages of so many ticks."""
    return [message for _ in range(number) for message in side.tick()]


def of(messages: list[Any], topic: str) -> list[Any]:
    return [m.message for m in messages if m.topic == topic]


def kinds(messages: list[Any]) -> list[tuple[str, int]]:
    """What happened, and at which tick."""
    return [(event.kind, event.stamp // MS) for event in of(messages, "event")]


def in_state(state: str) -> SafetyStates:
    """A machine that is in a state, by an alarm of the number 9 where it takes one."""
    states = SafetyStates()
    if state == SafetyState.DEGRADED:
        states.come(9, SafetyState.DEGRADED)
    elif state != SafetyState.RUNNING:
        states.trip(latched=state == SafetyState.LATCHED)
    return states


@pytest.mark.parametrize(("start_in", "on", "to", "event"), ROWS)
def test_the_table_of_the_documents_is_what_the_machine_does(start_in: str, on: str, to: str, event: str):
    states = in_state(start_in)
    assert states.state == start_in
    if (found := re.search(r'then = "(\w+)"', on)) and "still there" not in on:
        assert states.come(1, SafetyState(found[1])) == event
    elif "the last alarm is gone" in on and start_in == SafetyState.DEGRADED:
        assert states.go(9) == event
    elif "after_timeout" in on and start_in == SafetyState.SAFE:
        states.latch()
    elif "after_timeout" in on:
        states.trip(latched='"latch"' in on)
    else:
        if "still there" in on:
            states.come(1, SafetyState(found[1]) if found else SafetyState.LATCHED)
        states.leave()
    assert states.state == to


def test_the_documents_tell_all_states():
    assert {row[0] for row in ROWS} | {row[2] for row in ROWS} == {state.value for state in SafetyState}
    assert len(ROWS) == 18


@given(st.lists(st.tuples(st.integers(0, 3), st.sampled_from(["come", "go", "silence", "leave"])), max_size=30))
def test_whatever_happens_commands_act_only_where_no_alarm_keeps_them_out(steps: list[tuple[int, str]]):
    """Each alarm leads where it says; only a reset or a command leaves safe, and an alarm left behind degrades."""
    leads = [SafetyState.DEGRADED, SafetyState.SAFE, SafetyState.LATCHED, SafetyState.SAFE]
    states, there, left_behind = SafetyStates(), set[int](), set[int]()
    for number, step in steps:
        before = states.state
        if step == "come" and number not in there:
            states.come(number, leads[number])
            there.add(number)
            assert states.safe or leads[number] == SafetyState.DEGRADED
        elif step == "go" and number in there:
            there.remove(number)
            left_behind.discard(number)
            states.go(number)
            assert states.safe == (before in (SafetyState.SAFE, SafetyState.LATCHED))
        elif step == "silence" and not states.safe:
            states.trip(latched=bool(number % 2))
        elif step == "leave" and states.safe:
            states.leave()
            left_behind |= there
        assert states.safe or states.state == (SafetyState.DEGRADED if there else SafetyState.RUNNING)
        keeping = {alarm for alarm in there - left_behind if leads[alarm] != SafetyState.DEGRADED}
        assert set(states.keeping) == (keeping if states.safe else set())
        assert states.shut == (states.state == SafetyState.LATCHED or bool(states.keeping))


def test_an_alarm_needs_its_time_and_its_hysteresis():
    """Past 10 for 3 scans; back below 8 for 2; a value that is missing keeps it there."""
    alarm = planned(scenario_of('when="p1 > 10 bar", lasts="3 ms", hysteresis="2 bar", clears_after="2 ms"'))[0]
    course = [11, 12, 9, 11, 12, 13, 14, 9, 8.1, 7, 8.1, math.nan, 7, 7, 7, 11]
    watch = AlarmWatch([alarm])
    turns = [(k, turn.there) for k, bar in enumerate(course) for turn in watch.look(k * MS, lambda _, b=bar: b * 1e5)]
    assert turns == [(6, True), (14, False)]


def test_an_alarm_stops_the_plant_at_its_scan_and_the_next_command_after_it_acts():
    """The signals at the scans say when; the spool reference is 0 from there; the controller keeps its plant."""
    side, seen = start(scenario_of(f'{FAST}, then="safe"')), []
    for _ in range(200):
        command(side, 0.8)
        seen += side.tick()
    states = of(seen, "state")
    past = [s.velocity > 0.1 for s in states]
    came = next(k for k in range(3, 200) if all(past[k - 3 : k + 1]))
    back = [s.velocity <= 0.04 for s in states]
    went = next(k for k in range(came + 4, 200) if all(back[k - 4 : k + 1]))
    told = [
        ("safe", came + 1),
        ("refused", came + 2),
        ("cleared", went + 1),
        ("missed", went + 2),
        ("resumed", went + 2),
    ]
    assert kinds(seen)[:5] == told
    applied = [s.reference for s in states]
    assert applied[: went + 2] == [0.8] * (came + 1) + [0.0] * (went - came) + [0.8]
    assert not command(side, 0.1, source=OTHER)


def test_what_an_alarm_keeps_out_is_told_once():
    """However many further alarms come meanwhile."""
    side = start(scenario_of('when="position > 101 mm", then="safe"', 'when="position > 101.5 mm", then="degraded"'))
    seen = []
    for _ in range(60):
        command(side, 0.8)
        seen += side.tick()
    assert [kind for kind, _ in kinds(seen)].count("refused") == 1
    assert side.inlet.refused[Reason.ALARM] > 20


def test_a_latched_plant_waits_for_reset_and_is_degraded_while_the_alarm_stays():
    side = start(scenario_of('when="position > 101 mm", then="latched"', changes=("safety.degraded_limit=0.3",)))
    while side.inlet.state == SafetyState.RUNNING:
        command(side, 0.8)
        side.tick()
    assert side.inlet.state == SafetyState.LATCHED
    assert not command(side, -0.8)
    assert list(side.inlet.refused) == ["latched"]
    side.reset()
    seen = side.tick()
    assert [kind for kind, _ in kinds(seen)] == ["refused", "reset", "degraded"]
    while side.inlet.state == SafetyState.DEGRADED:
        assert command(side, -0.8)
        seen = side.tick()
        assert of(seen, "state")[0].reference == -0.3
    assert [kind for kind, _ in kinds(seen)] == ["restored"]
    assert command(side, -0.8)
    assert of(side.tick(), "state")[0].reference == -0.8


@pytest.mark.parametrize(("policy", "ends"), [("latch", SafetyState.LATCHED), ("resume", SafetyState.SAFE)])
def test_a_controller_that_died_meanwhile_loses_the_plant(policy: str, ends: SafetyState):
    """20 ms after the next sample behind the alarm's end; then another one may take it, once reset if latched."""
    own = "loop.command_timeout='20 ms'", f"loop.after_timeout={policy}"
    slow = FAST.replace("4 ms", "50 ms")  # the piston swings on its oil
    side, seen = start(scenario_of(f'{slow}, then="safe"', changes=own)), []
    while side.inlet.state == SafetyState.RUNNING:
        command(side, 0.8)
        side.tick()
    while not kinds(seen):
        seen = side.tick()
    assert [kind for kind, _ in kinds(seen)] == ["cleared"]
    due = -(-(side.now // MS) // 10) * 10
    seen = ticks(side, 60)
    assert kinds(seen) == ([("latched", due + 21)] if policy == "latch" else [])
    assert side.inlet.state == ends
    assert command(side, 0.1, source=OTHER) == (policy == "resume")


def course_after_trip(*changes: str, lasts: int = 60) -> tuple[int, list[float], list[float]]:
    """Scan of the trip [ms], then the spool reference and the position of each scan."""
    side, seen = start(scenario_of(f'{FAST}, then="latched"', changes=changes)), []
    while not side.inlet.safe:
        command(side, 0.8)
        side.tick()
    at = side.now // MS
    seen = of(ticks(side, lasts), "state")
    return at, [s.reference for s in seen], [s.position for s in seen]


def test_the_valve_does_what_the_policy_says():
    """A ramp by its formula; a retreat until the piston is there, and no longer than it may."""
    assert set(course_after_trip()[1]) == {0.0}
    assert set(course_after_trip("safety.on_trip=centre")[1]) == {0.0}
    assert set(course_after_trip("safety.on_trip=hold")[1]) == {0.8}
    ramp = course_after_trip("safety.on_trip=ramp", "safety.ramp=0.04")[1]
    assert ramp == [0.8 * (1.0 - k / 40) for k in range(40)] + [0.0] * 20
    back = "safety.on_trip=retreat", "safety.retreat_spool=-0.5", "safety.retreat_position='95 mm'"
    _, spool, position = course_after_trip(*back, lasts=200)
    there = next(k for k, x in enumerate(position) if x <= 0.095)
    assert spool == [-0.5] * (there + 1) + [0.0] * (199 - there)
    assert course_after_trip(*back, "safety.retreat_within='7 ms'")[1] == [-0.5] * 7 + [0.0] * 53


def test_a_servo_valve_is_shut_off_or_told_its_centre():
    servo = "rig.valve.kind=servo", "rig.servo_valve.power_off=-0.2"
    assert set(course_after_trip(*servo)[1]) == {-0.2}
    assert set(course_after_trip(*servo, "safety.on_trip=centre")[1]) == {0.0}


@pytest.mark.parametrize("policy", ["ramp", "retreat", "hold"])
def test_silence_follows_the_policy_too(policy: str):
    own = f"safety.on_trip={policy}", "safety.retreat_spool=-0.5", "safety.retreat_position='10 mm'"
    side = start(scenario_of(changes=(*own, "loop.command_timeout='10 ms'")))
    assert command(side, 0.4)
    seen = of(ticks(side, 60), "state")
    expected = {"ramp": 0.4 * (1.0 - 39.0 / 200.0), "retreat": -0.5, "hold": 0.4}[policy]
    assert [seen[19].reference, seen[59].reference] == [0.4, pytest.approx(expected, rel=1e-12)]


EVENTFUL = (
    f'{FAST}, then="safe"',
    'when="measurement.p1 > 76 bar", then="degraded", hysteresis="1 bar"',
    'when="channels.force > 1.6 kN", then="latched", lasts="1 ms"',
)
OWN = ("daq.channels=['force']", "safety.on_trip=ramp", "safety.degraded_limit=0.5", "loop.delay=0.005")


def replayed(run: Any, scenario: Scenario) -> bool:
    """Does a run come out of the plant again, every bit of measurements and states?"""
    known = {(e.topic, e.log_time): e.data for e in run.entries}
    found = [entry for messages in through_plant(run, scenario) for entry in entries_of(messages)]
    mine = [entry for entry in found if entry.topic in ("measurement", "state")]
    return len(mine) == 2 * run.counts["state"] and all(known[e.topic, e.log_time] == e.data for e in mine)


def test_the_same_in_process_and_in_lockstep_and_out_again(tmp_path):
    """With a delay, in which a command of before an alarm may come after it."""
    own = [*OWN, "allowed.safe_states=99", "allowed.degraded=99"]
    scenario = scenario_of(*EVENTFUL[:2], changes=tuple(own))
    run = record_in_process(scenario, tmp_path / "a.mcap")
    assert {"safe", "resumed", "refused", "cleared"} <= {event.kind for event in run.messages("event")}
    alarms = f"alarm=[{', '.join(f'{{{alarm}}}' for alarm in EVENTFUL[:2])}]"
    changes = [*QUIET, "reference.at=0.02", "duration=0.4", alarms, *own]
    run_recorded(tmp_path / "b.mcap", "step", "--mode", "lockstep", *(f"--set={change}" for change in changes))
    assert digest(tmp_path / "b.mcap") == digest(tmp_path / "a.mcap")
    assert replayed(run, scenario)


@given(st.permutations(EVENTFUL), st.lists(st.integers(0, 39), max_size=6), st.sampled_from([0.0, 0.005, 0.0123]))
@settings(max_examples=12)
def test_alarms_and_resets_at_random_come_out_again(alarms: list[str], resets: list[int], delay: float):
    scenario = scenario_of(*alarms[:2], changes=(*OWN, f"loop.delay={round(delay / 50e-6) * 50e-6!r}"))
    plant, controller = sides(scenario)
    out, kept = plant.start(), []
    while plant.tick_number < scenario.ticks:
        kept += out + answered(plant, controller, out)
        if plant.tick_number // 10 in resets and plant.tick_number % 10 == 3:
            plant.reset()
        out = plant.tick()
    kept += out + answered(plant, controller, out) + plant.finish("complete after 400 ticks")
    head = {"run": {"run_id": str(plant.run_id), "scenario": scenario.model_dump(mode="json")}}
    run = recording(ROOT / "memory", entries_of(kept), head)
    assert replayed(run, scenario)


def test_a_run_with_alarms_is_judged_and_counted():
    scenario = scenario_of(*EVENTFUL[:2], changes=OWN)
    run = run_in_memory(scenario)
    summary = summarise(run, scenario, {})
    safe = sum(event.kind == EventKind.SAFE for event in run.messages("event"))
    assert summary.alarms["fast"] >= summary.safe_states == safe > 0
    (fault,) = verdict(summary._replace(degraded=0), scenario)
    assert "allowed.safe_states is 0" in fault
    assert "alarm fast: velocity > 100 mm/s for 0.003 s" in fault
    allowed = load("step", ["allowed.safe_states=99", "allowed.degraded=99"]).allowed
    assert not verdict(summary, scenario.model_copy(update={"allowed": allowed}))
    assert verdict(summary._replace(safe_states=0, commands=None, degraded=2), scenario)[0].startswith(
        "the plant was degraded 2"
    )
    shown = spans(run)
    assert np.sum([span.state == SafetyState.SAFE for span in shown]) == safe


def test_the_example_of_the_documents_degrades_and_stops_once(tmp_path):
    (text,) = re.findall(r"^```toml\n(.+?)^```", PAGE, re.MULTILINE | re.DOTALL)
    (tmp_path / "example.toml").write_text(text, encoding="utf-8")
    run = run_in_memory(load(str(tmp_path / "example.toml")))
    told = [event.kind for event in run.messages("event") if event.command]
    assert told.count(EventKind.SAFE) == told.count(EventKind.DEGRADED) == 1


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ('alarm=[{when="p9 > 1 bar"}]', "alarm 1: when 'p9 > 1 bar': no signal 'p9'"),
        ('alarm=[{when="p1 > 100"}]', "100 has no unit, and would be 0.001 bar: write '100 bar'"),
        ('alarm=[{when="p1 > inf"}]', "not a finite number"),
        ('alarm=[{when="safe"}]', "write 'signal > value unit'"),
        ('alarm=[{when="channels.force > 1 kN"}]', "no signal 'channels.force'"),
        ('alarm=[{when="p1 > 1 bar", then="running"}]', "write degraded, safe or latched"),
        ('alarm=[{when="p1 > 1 bar", hysteresis="-1 bar"}]', "must be 0 or more"),
        ('alarm=[{when="p1 > 1 bar", id="2"}, {when="p1 > 2 bar"}]', "the id '2' is taken"),
        ("safety.on_trip=retreat", "needs safety.retreat_spool"),
        ('safety.retreat_position="400 mm"', "outside the stroke"),
        ("safety.on_trip=stop", "is unknown"),
    ],
)
def test_what_cannot_be_watched_is_refused_with_the_way_out(changes: str, words: str):
    with pytest.raises(ScenarioError, match=re.escape(words)):
        load("step", [changes])
