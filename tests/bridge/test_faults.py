"""Faults of sensors, valve and plant: each is there in its window, and is what its name says."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hydrotwin as ht
from bridge.errors import ScenarioError
from bridge.loop.exchange import exchange, sides
from bridge.loop.fault_chance import Luck
from bridge.processes.injection import injected_by
from bridge.recording.changes import changes as changes_in
from bridge.recording.manifest import manifest
from bridge.recording.reader import Recording, recording
from bridge.recording.writer import RecordingWriter, entries_of
from bridge.replay.through import Through, replay_through
from bridge.runs.in_process import record_in_process, run_in_memory
from bridge.scenario import Scenario, load
from bridge.scenario.fault_kinds import PLANT, SENSOR, VALVE
from bridge.scenario.faults import planned, targets
from bridge.scenario.tunable import tunables
from controller.grid import NS
from tests.support.processes import ROOT
from twin.sensors import put_out

BAR = 1e5
BEGIN, END = 0.2, 0.5
WINDOW = f'at="{BEGIN} s", lasts="{END - BEGIN} s"'
PERFECT = ("daq.noise=0", "daq.quantise=false", "daq.skew=0", "daq.clip=false", "rig.amplifier.kind=none")


def scenario(*faults: str, seed: int = 1, changes: tuple[str, ...] = (), duration: float = 0.7) -> Scenario:
    """The step at 0.1 s."""
    own = ("reference.at=0.1", f"seed={seed}", f"duration={duration}", "expect=[]", f"fault=[{', '.join(faults)}]")
    return load("step", [*own, *changes])


def one(target: str, kind: str, sizes: str = "", when: str = WINDOW) -> str:
    """A fault as a scenario has it."""
    return f'{{target="{target}", kind="{kind}", {when}{", " if sizes else ""}{sizes}}}'


def sampled(made: Scenario) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, the true pressure of the lower chamber, and what the card says of it."""
    run = run_in_memory(made)
    state, read = run.columns("state"), run.columns("measurement")
    return state["stamp"] / NS, state["p_lower"], read["p2"]


Lie = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]  # of times, true values, and times since the beginning
STUCK = round(BEGIN / 1e-3)
SENSOR_KINDS: dict[str, tuple[str, Lie]] = {
    "off": ("", lambda t, true, since: np.zeros_like(true)),
    "stuck": ("", lambda t, true, since: np.full_like(true, true[STUCK])),
    "bias": ('size="3 bar"', lambda t, true, since: true + 3 * BAR),
    "drift": ('rate="20 bar/s"', lambda t, true, since: true + 20 * BAR * since),
    "gain": ("factor=1.2", lambda t, true, since: 1.2 * true),
    "noise": ('size="1 bar"', lambda t, true, since: true + BAR * _normal(t, "sensor.p2 noise scan")),
    "spikes": (
        'size="30 bar", share=0.1',
        lambda t, true, since: true + 30 * BAR * (_uniform(t, "sensor.p2 spikes scan") < 0.1),
    ),
    "quantisation": ('size="2 bar"', lambda t, true, since: 2 * BAR * np.floor(true / (2 * BAR) + 0.5)),
    "saturation": ('low="12 bar", high="14 bar"', lambda t, true, since: np.clip(true, 12 * BAR, 14 * BAR)),
    "delay": ('time="20 ms"', lambda t, true, since: np.concatenate([true[:20], true[:-20]])),
}


def _normal(t: np.ndarray, name: str) -> np.ndarray:
    return np.array([Luck(1, name).normal(round(time * 1000)) for time in t])


def _uniform(t: np.ndarray, name: str) -> np.ndarray:
    return np.array([Luck(1, name).uniform(round(time * 1000)) for time in t])


@pytest.mark.parametrize("kind", SENSOR_KINDS)
def test_a_sensor_lies_as_its_kind_says_in_its_window_alone(kind: str):
    """With a perfect card: what is read is a stated function of what is true; the loop does not read this channel."""
    sizes, lie = SENSOR_KINDS[kind]
    t, true, read = sampled(scenario(one("sensor.p2", kind, sizes), changes=PERFECT))
    inside = (t > BEGIN - 1e-6) & (t < END - 1e-6)
    assert read[~inside] == pytest.approx(true[~inside], abs=1e-3)
    assert read[inside] == pytest.approx(lie(t, true, t - BEGIN)[inside], abs=1e-3)
    assert np.abs(read[inside] - true[inside]).max() > 0.1 * BAR


def test_a_wrong_channel_reads_the_other_s_volts():
    run = run_in_memory(scenario(one("sensor.p2", "wrong-channel", 'instead="p3"'), changes=PERFECT))
    read, t = run.columns("measurement"), run.columns("state")["stamp"] / NS
    inside = (t > BEGIN - 1e-6) & (t < END - 1e-6)
    assert (read["p2"][inside] == read["p3"][inside]).all()
    other = run_in_memory(scenario(one("sensor.p2", "wrong-channel", 'instead="position"'), changes=PERFECT))
    read = other.columns("measurement")
    assert read["p2"][inside] == pytest.approx(read["position"][inside] / 0.3 * 250 * BAR, rel=1e-9)


def test_an_intermittent_sensor_reads_nothing_for_its_share_of_the_time():
    """Spells and times between them are exponential: the share within 4 deviations, over a minute of a still rig."""
    fault = one("sensor.p2", "intermittent", 'share=0.3, length="20 ms"', "at=0.0")
    made = load("hold-load", [f"fault=[{fault}]", "duration=4", *PERFECT, "expect=[]"])
    read = run_in_memory(made).columns("measurement")["p2"]
    share = (read == 0.0).mean()
    spells = 4.0 * 0.3 / 20e-3
    assert share == pytest.approx(0.3, abs=4.0 * 0.3 / math.sqrt(spells))


def test_every_kind_of_sensor_fault_has_its_test():
    assert {*SENSOR_KINDS, "wrong-channel", "intermittent"} == {*SENSOR}


def test_a_further_channel_lies_too():
    fault = one("channel.p_pump", "bias", 'size="5 bar"')
    runs = [run_in_memory(scenario(*own, changes=('daq.channels=["p_pump"]', "daq.noise=0"))) for own in ((), (fault,))]
    read = [np.array([message.values[0] for message in run.messages("channels")]) for run in runs]
    apart = (read[1] - read[0]) / BAR
    t = np.arange(len(apart)) * 1e-3
    inside = (t > BEGIN - 1e-6) & (t < END - 1e-6)
    assert apart[inside] == pytest.approx(5.0, abs=0.07)
    assert not apart[~inside].any()


VALVE_KINDS: dict[str, tuple[str, Callable[[float], float]]] = {
    "dead-band": ("width=0.2", lambda r: math.copysign(max(0.0, abs(r) - 0.2), r)),
    "bias": ("size=0.05", lambda r: min(1.0, r + 0.05)),
    "saturated": ("limit=0.3", lambda r: min(0.3, max(-0.3, r))),
    "power-loss": ("", lambda r: 0.0),
    "reversed": ("", lambda r: -r),
}
OF_SPOOL = ("stuck", "slow", "contaminated")


@pytest.mark.parametrize("kind", VALVE_KINDS)
def test_a_faulty_valve_makes_of_a_command_what_its_kind_says(kind: str):
    """Tick by tick against the command in force; outside the window the spool is after the command itself."""
    sizes, faulty = VALVE_KINDS[kind]
    run = run_in_memory(scenario(one("valve", kind, sizes)))
    seen = run.columns("state")["reference"]
    commands = {command.apply_at // 1_000_000: command.spool for command in run.messages("command")}
    given, changed = 0.0, 0
    for tick in range(1, len(seen)):
        given = commands.get(tick - 1, given)
        out = put_out(given, 12.0)
        inside = round(1e3 * BEGIN) < tick <= round(1e3 * END)
        assert seen[tick] == (faulty(out) if inside else out), tick
        changed += inside and seen[tick] != out
    assert changed > 100


def test_hysteresis_is_play_between_command_and_spool():
    """The spool's reference moves once the command has crossed the play, and stays half of it behind."""
    made = scenario(one("valve", "hysteresis", "width=0.1", "at=0.0"), changes=("daq.quantise_output=false",))
    run = run_in_memory(made)
    seen = run.columns("state")["reference"]
    commands = {command.apply_at // 1_000_000: command.spool for command in run.messages("command")}
    given = last = 0.0
    for tick in range(1, len(seen)):
        given = commands.get(tick - 1, given)
        last = min(max(last, given - 0.05), given + 0.05)
        assert seen[tick] == last


def test_a_stuck_spool_stays_a_slow_one_lags_and_a_dirty_one_sticks_in_spells():
    """Slow: a fifth of the rate of 50 travels a second. The spells are those that the seed draws."""
    spool = {kind: run_in_memory(scenario(one("valve", kind))).columns("state")["spool"] for kind in OF_SPOOL}
    healthy = run_in_memory(scenario()).columns("state")["spool"]
    t = np.arange(len(healthy)) * 1e-3
    inside = (t > BEGIN + 1e-6) & (t < END + 1e-6)
    for moves in spool.values():
        assert (moves[t < BEGIN + 1e-6] == healthy[t < BEGIN + 1e-6]).all()
    assert np.ptp(spool["stuck"][inside]) < 1e-9
    most = np.abs(np.diff(spool["slow"][inside])).max()
    assert 0.005 < most <= 0.2 * 50.0 * 1e-3 + 1e-12
    for begin, end in Luck(1, "valve contaminated").spells(0, 0.2, 20e-3, END - BEGIN):
        still = spool["contaminated"][(t > BEGIN + begin) & (t < BEGIN + end)]
        assert len(still) == 0 or np.ptp(still) < 1e-9
    assert np.ptp(spool["contaminated"][inside]) > 0.1


def test_every_kind_of_valve_fault_has_its_test():
    assert {*VALVE_KINDS, *OF_SPOOL, "hysteresis"} == {*VALVE}


RIG_KINDS: dict[tuple[str, str], tuple[str, str, Callable[[float], float]]] = {  # sizes, a number, what becomes of it
    ("pump", "speed-drop"): ("factor=0.6", "rig.pump.speed", lambda v: 0.6 * v),
    ("pump", "stop"): ("over=0", "rig.pump.speed", lambda v: 0.0),
    ("pump", "wear"): ("factor=2", "rig.pump.efficiency", lambda v: 1.0 - 2.0 * (1.0 - v)),
    ("oil", "temperature"): ('to="55 degC"', "rig.oil.temperature", lambda v: 55.0),
    ("oil", "air"): ("factor=0.4", "rig.cylinder.stiffness", lambda v: 0.4),
    ("cylinder", "leak"): ("factor=50", "rig.cylinder.leakage_resistance", lambda v: v / 50.0),
    ("cylinder", "seal-wear"): ("friction=0.5", "rig.seal.diameter", lambda v: 0.5 * v),
    ("pipe_3", "burst"): ('diameter="1 mm"', "rig.cylinder.hole_lower", lambda v: 1e-3),
    ("pipe_4", "burst"): ('diameter="1 mm"', "rig.cylinder.hole_upper", lambda v: 1e-3),
    ("filter", "blocked"): ("factor=20", "rig.filter.drop", lambda v: 20.0 * v),
    ("relief", "stuck-open"): ("", "rig.relief.pilot_stiffness", lambda v: 0.01 * v),
    ("relief", "stuck-shut"): ("", "rig.relief.setting", lambda v: 10.0 * v),
    ("relief", "setting"): ('to="40 bar"', "rig.relief.setting", lambda v: 40 * BAR),
    ("load", "jump"): ('mass="60 kg", force="-300 N"', "rig.load.mass", lambda v: v + 60.0),
    ("load", "lost"): ("factor=0.5", "rig.load.mass", lambda v: 0.5 * v),
    ("load", "impact"): ('impulse="60 N s"', "rig.load.force", lambda v: v + 60.0 / (END - BEGIN)),
}


def test_every_kind_of_fault_of_the_plant_has_its_test():
    kinds = {(target, kind) for target, of_target in PLANT.items() for kind in of_target if target != "valve"}
    assert {*RIG_KINDS} == kinds


def driven(made: Scenario) -> tuple[Recording, list[dict[str, float]]]:
    """A run, and what the rig's numbers are at each tick."""
    plant, controller = sides(made)
    entries, numbers = [], []
    for messages in exchange(plant, controller, made.ticks):
        entries += entries_of(messages)
        numbers.append({name: value for name, (_, value) in plant.values().items() if name.startswith("rig.")})
    return recording(Path("memory"), entries, {"run": manifest(made, plant.run_id)}), numbers


@pytest.mark.parametrize(("target", "kind"), RIG_KINDS, ids=lambda word: word)
def test_a_fault_of_the_plant_changes_its_number_and_the_state_and_keeps_the_oil(target: str, kind: str):
    """Before it all is as without it, to the bit; after it the number is what it was; the books hold to 1e-12."""
    sizes, name, becomes = RIG_KINDS[target, kind]
    lumped = tuple(f"rig.pipe_{i}.model=lumped" for i in range(1, 7))
    made = scenario(one(target, kind, sizes), changes=lumped, duration=0.6)
    run, numbers = driven(made)
    own = tunables(made)[name].value
    found = np.array([values[name] for values in numbers])
    t = np.arange(len(found)) * 1e-3
    inside = (t > BEGIN - 1e-6) & (t < END - 1e-6)
    assert found[inside] == pytest.approx(becomes(own), rel=1e-12)
    assert (found[~inside] == own).all()
    state = run.columns("state")
    quiet = run_in_memory(scenario(changes=(*lumped, f"rig.cylinder.holes={_holes(target)}"), duration=0.6)).columns(
        "state"
    )
    same = [name for name in ("position", "p_lower", "p_upper", "p_tee", "spool") if name in state]
    before = t < BEGIN + 1e-6
    assert all((state[name][before] == quiet[name][before]).all() for name in same)
    assert any((state[name][~before] != quiet[name][~before]).any() for name in same)
    crossed = state["oil_pumped"] - state["oil_relieved"] - state["oil_returned"]
    stored = state["oil_stored"]
    assert np.abs(stored - stored[0] - (crossed - crossed[0])).max() < 1e-12 * stored[0]


def _holes(target: str) -> str:
    return "fitted" if target in ("pipe_3", "pipe_4") else "none"


def test_a_burst_lets_out_what_torricelli_says():
    """Of the books: what left besides the return line, against c A sqrt(2 p/rho) of the chamber's pressure."""
    fault = one("pipe_3", "burst", 'diameter="1 mm"')
    still = ("reference.at=9", "controller.gain=0 V/%", "rig.cylinder.hole_transition=0")
    lumped = (f"rig.pipe_{i}.model=lumped" for i in range(1, 7))
    made = load("step", [f"fault=[{fault}]", *still, *lumped, "duration=0.5", "expect=[]"])
    state = run_in_memory(made).columns("state")
    within = (state["stamp"] > BEGIN * NS) & (state["stamp"] < END * NS)
    t = state["stamp"][within] / NS
    flow = 0.61 * 0.25 * math.pi * 1e-6 * np.sqrt(2.0 * np.maximum(state["p_lower"][within], 0.0) / 878.0)
    left = np.ptp(state["oil_returned"][within]) - np.trapezoid(state["flow_6"][within], t)
    assert left == pytest.approx(np.trapezoid(flow, t), rel=0.02)
    assert state["position"][within][0] - state["position"][within][-1] > 1e-3  # and the load sinks


def test_an_impact_gives_its_impulse():
    """m v = the impulse, on a load that slides freely."""
    free = ("rig.friction.kind=none", "reference.at=9", "controller.gain=0 V/%", "rig.cylinder.stiffness=1e-3")
    blow = '{target="load", kind="impact", impulse="12 N s", at="0.1 s", lasts="1 ms"}'
    state = run_in_memory(load("step", [f"fault=[{blow}]", *free, "duration=0.12", "expect=[]"])).columns("state")
    quiet = run_in_memory(load("step", [*free, "duration=0.12", "expect=[]"])).columns("state")
    gained = state["velocity"][101] - quiet["velocity"][101]
    assert gained == pytest.approx(12.0 / 120.0, rel=0.02)


def test_faults_come_again_by_chance_and_on_conditions(tmp_path: Path):
    """Each beginning by itself with its probability, the same for one seed; on a signal, and on an event."""
    many = '{target="sensor.p3", kind="off", at="10 ms", every="10 ms", times=60, lasts="2 ms", probability=0.5}'
    later = '{target="sensor.p2", kind="off", when="position > 110 mm", after="20 ms", lasts="50 ms", name="late"}'
    texts = []
    for seed in (1, 1, 2):
        run = record_in_process(scenario(many, later, seed=seed), tmp_path / f"{len(texts)}.mcap")
        told = [(event.text, event.apply_at) for event in run.messages("event") if event.kind == "fault"]
        texts.append(told)
        begun = sum("p3 off' begins" in text for text, _ in told)
        assert abs(begun - 30) < 4.0 * math.sqrt(15.0)
        state = run.columns("state")
        passed = int(state["stamp"][np.argmax(state["position"] > 0.11)])
        assert [at for text, at in told if text.startswith("'late' begins")] == [passed + 20_000_000]
    assert texts[0] == texts[1] != texts[2]
    assert any("'late' begins" in change.text for change in changes_in(run))


def test_a_fault_that_is_injected_acts_at_once_and_comes_out_of_a_replay(tmp_path: Path):
    made = scenario()
    plant, controller = sides(made)
    asked = injected_by(b'{"target": "sensor.p2", "kind": "stuck", "lasts": "0.1 s"}', made)
    entries: list[Any] = []
    answer: dict[str, Any] = {}
    for tick, messages in enumerate(exchange(plant, controller, made.ticks)):
        entries += messages
        if tick == 300:
            answer = asked(plant)
    assert answer["injected"] == "sensor.p2 stuck"
    path = tmp_path / "run.mcap"
    writer = RecordingWriter(path, made.rig_name)
    writer.metadata("run", manifest(made, plant.run_id))
    writer.instant(entries)
    writer.close()
    verdict = replay_through(path, Through("plant", tmp_path / "again.mcap", alone=True))
    assert verdict.events_differ is None
    assert {difference.greatest for difference in verdict.differences} == {0.0}
    told = [message.message.text for message in entries if message.topic == "event"]
    assert any(text.startswith("injected {") for text in told)
    assert sum("'sensor.p2 stuck' begins" in text for text in told) == 1


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ('{target="sensor.p9", kind="off", at=0}', "no target 'sensor.p9'; did you mean 'sensor.p"),
        ('{target="valve", kind="stuk", at=0}', "valve has no fault 'stuk'; did you mean 'stuck'?"),
        ('{target="valve", kind="stuck"}', 'give either at = "2 s" or when'),
        ('{target="valve", kind="stuck", at=0, size=1}', "valve stuck takes no size"),
        ('{target="sensor.p2", kind="bias", at=0}', "sensor.p2 bias needs size, a number in Pa: added"),
        ('{target="sensor.p2", kind="bias", at=0, size="3 mm"}', "unit 'mm' does not fit here"),
        ('{target="link.command", kind="loss", at=0, share=2}', "share = 2: must be from 0 to 1"),
        ('{target="link.command", kind="delay", at=0, law="gauss"}', "no law of delays 'gauss'"),
        ('{target="link.command", kind="freeze", at=0}', 'say how long, lasts = "0.2 s"'),
        ('{target="load", kind="jump", mass="-200 kg", at=0}', "rig.load.mass = -80: must be at least"),
        ('{target="sensor.p2", kind="wrong-channel", at=0, instead="p2"}', "instead = 'p2': one of position"),
        ('{target="process.controller", kind="crash", at=0}', "in one process there is none; use --mode realtime"),
        ('{target="valve", kind="stuck", at="0.12345 ms"}', "not a whole number (at least 0) of the internal step"),
    ],
)
def test_a_fault_that_cannot_be_is_refused_in_one_line(fault: str, said: str):
    with pytest.raises(ScenarioError) as raised:
        sides(scenario(fault))
    assert said in str(raised.value)
    assert "\n" not in str(raised.value)


def test_the_page_s_bad_day_passes_its_check(tmp_path: Path):
    page = (ROOT / "docs/faults.md").read_text(encoding="utf-8")
    (tmp_path / "bad-day.toml").write_text(page.partition("```toml\n")[2].partition("```")[0], encoding="utf-8")
    run = ht.run(tmp_path / "bad-day.toml")
    assert run.passed, (run.faults, run.bands)


def test_every_target_and_kind_is_in_the_page():
    """docs/faults.md names each."""
    page = (ROOT / "docs/faults.md").read_text(encoding="utf-8")
    for target, kinds in targets(load("step")):
        assert f"`{target.partition('.')[0]}" in page
        for kind in kinds:
            assert f"`{kind}`" in page, kind
    assert planned(load("step")) == []
