"""Recorded inputs through the real controller and the twin: nothing differs, until something was changed."""

import json
import math
import signal
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from bridge.cli.verbs import app
from bridge.errors import UsageError
from bridge.loop.exchange import sides
from bridge.loop.plant import PlantSide
from bridge.recording.entries import Entry
from bridge.recording.reader import Recording, read, recording
from bridge.replay.into_plant import through_plant
from bridge.replay.through import Through, replay_through
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.wire.codec import ValveCommand, encode
from bridge.wire.messages import Outgoing, Reason
from tests.bridge.test_golden import TOLERANCES
from tests.support.command import hydrotwin_here
from tests.support.processes import (
    LOOSE,
    UNDRAWN,
    child,
    children,
    grown,
    hydrotwin,
    run_recorded,
    started,
    wait_for,
    with_signal,
)
from tests.tools.renew import GOLDEN, HERE

RUNNING = 30_000  # bytes of a recording in which the loop has been seen to run
STIFFER = ["controller.gain=1.05 V/%"]
RESET = 1000  # tick of a sample whose command is heard three ticks later, just after a reset


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("into")


@pytest.fixture(scope="module")
def lockstep(folder) -> Recording:
    """With a law that remembers: the velocity is the filtered difference of positions."""
    law = ("--set", "controller.velocity=filtered", "--set", "controller.derivative=0.02 V s/%")
    return run_recorded(folder / "lockstep.mcap", "step", "--mode", "lockstep", "--duration", "2.5", *law)


@pytest.fixture(scope="module")
def late(folder) -> Recording:
    """Real time; the controller stands still three times, at last so long that the plant goes to its safe state.

    On a busy machine the burst after that may not all reach the file: then once more.
    """
    options = ("--set", "loop.command_timeout=0.05", "--set", "loop.after_timeout=resume")
    trials = (stalled(folder / f"late-{turn}.mcap", *options) for turn in range(4))
    whole = next((trial for trial in trials if not trial.metadata["summary"]["lost"]), None)
    assert whole is not None, "messages lost in four runs: this machine is too busy to tell"
    return whole


def stalled(path: Path, *options: str) -> Recording:
    """A run whose controller is stopped now and then."""
    with started("run", *UNDRAWN, "square", "--duration", "4", *options, *LOOSE, "--record", str(path)) as run:
        controller = child(run.pid, "controller")
        wait_for(lambda: grown(path, RUNNING), 30)
        for pause in (0.03, 0.045, 0.1):
            with_signal(controller, signal.SIGSTOP)
            time.sleep(pause)
            with_signal(controller, signal.SIGCONT)
            time.sleep(0.2)
        run.communicate(timeout=60)
    return read(path)


@pytest.mark.parametrize("into", ["plant", "controller"])
def test_a_lockstep_recording_comes_out_again(lockstep, folder, into):
    verdict = replay_through(lockstep.path, Through(into, folder / f"{into}.mcap"))
    assert verdict.passed
    assert verdict.events_differ is None
    assert {difference.greatest for difference in verdict.differences} == {0.0}
    assert sum(difference.alone for difference in verdict.differences) == 0


@pytest.mark.parametrize("into", ["plant", "controller"])
def test_a_real_time_recording_with_late_commands_comes_out_again(late, folder, into):
    """By `applied_at`: what came late acts when it acted."""
    kinds = [event.kind for event in late.messages("event")]
    assert not late.metadata["summary"]["lost"]
    assert kinds.count("late") >= 5
    assert {"safe", "resumed"} <= set(kinds)
    verdict = replay_through(late.path, Through(into, folder / f"late-{into}.mcap"))
    assert verdict.events_differ is None
    assert {difference.greatest for difference in verdict.differences} == {0.0}
    assert verdict.passed


@pytest.mark.timed
def test_a_latched_plant_and_its_reset_come_out_again(folder):
    """More refused commands than are told one by one; then somebody resets."""
    path = folder / "latched.mcap"
    options = ("--set", "loop.command_timeout=0.1", "--set", "loop.sample_period=0.005")
    with started("run", *UNDRAWN, "square", "--duration", "4", *options, *LOOSE, "--record", str(path)) as run:
        controller, plant = child(run.pid, "controller"), child(run.pid, "plant")
        wait_for(lambda: grown(path, RUNNING), 30)
        with_signal(controller, signal.SIGSTOP)
        time.sleep(0.4)
        with_signal(controller, signal.SIGCONT)
        time.sleep(0.8)
        endpoint = children(run.pid)[plant].partition("--listen ")[2].split()[0]
        assert hydrotwin("reset", "--connect", endpoint).returncode == 0
        run.communicate(timeout=60)
    assert read(path).metadata["summary"]["commands"]["refused"]["latched"] > 100
    verdict = replay_through(path, Through("plant", folder / "latched-out.mcap"))
    assert verdict.events_differ is None
    assert {difference.greatest for difference in verdict.differences} == {0.0}


def test_a_command_on_its_way_at_the_reset_comes_out_again():
    """Computed while the plant was latched, heard just after the reset: the replay hands it in after the reset, too."""
    on_its_way: list[Outgoing] = []

    def hear(plant: PlantSide, tick: int, spoken: list[Outgoing]) -> list[Outgoing]:
        if 100 <= tick < 300:
            return []
        if tick == RESET:
            on_its_way.extend(spoken)
            return []
        if tick == RESET + 3:
            plant.reset()
            return [*on_its_way, *spoken]
        return spoken

    latch = ("loop.command_timeout=0.1", "loop.sample_period=5 ms", "loop.delay=5 ms")
    refused = by_hand(hear, "duration=1.2", *latch)
    assert sum(refused.values()) > 100


@pytest.mark.parametrize("lost", [range(100, 140), range(400, 1000)], ids=["on the way", "after the end"])
def test_what_was_recorded_and_never_heard_is_left_out(lost: range):
    """Lost on the way to the plant alone, or so late that the plant had ended."""
    by_hand(lambda _, tick, spoken: [] if tick in lost else spoken, "duration=0.5", "loop.command_timeout=1")


Hear = Callable[[PlantSide, int, list[Outgoing]], list[Outgoing]]


def by_hand(hear: Hear, *changes: str) -> dict[Reason, int]:
    """A loop whose plant hears what is left to it; the replay of all that was spoken has its states, to the bit.

    The refusals of the plant.
    """
    scenario = load("square", list(changes))
    plant, controller = sides(scenario)
    out = plant.start()
    for tick in range(scenario.ticks):
        spoken = controller.answer(plant.measurement)
        for message in hear(plant, tick, spoken):
            if message.topic == "command":
                plant.take(message.message)
        out += [*spoken, *plant.tick()]
    entries = [Entry(m.topic, m.log_time, m.sequence, encode(m.message)) for m in [*out, *plant.finish("complete")]]
    recorded = recording(Path("none.mcap"), entries, {"run": {"run_id": str(plant.run_id)}})
    again = [m for tick in through_plant(recorded, scenario) for m in tick]
    assert [encode(m.message) for m in again if m.topic == "state"] == [e.data for e in entries if e.topic == "state"]
    for kind in ("changed", "refused"):
        told = [[m.message for m in run if m.topic == "event" and m.message.kind == kind] for run in (out, again)]
        assert told[0] == told[1]
    return plant.inlet.refused


def test_what_waits_for_a_refusal_comes_again_with_it():
    """A command of nobody we know, one that is no number, one out of range and what is no command at all."""
    others = {50: {"source": 7}, 150: {"spool": math.nan}, 250: {"spool": 2.0}}

    def hear(plant: PlantSide, tick: int, spoken: list[Outgoing]) -> list[Outgoing]:
        if tick == 350:
            plant.receive(b"nonsense")
        if tick not in others:
            return spoken
        first = spoken[0].message
        return [*spoken, spoken[0]._replace(message=ValveCommand(**vars(first) | {"sequence": 900} | others[tick]))]

    push = '{set="rig.load.force", to="500 N", lasts="30 ms", when="refused", times=4}'
    refused = by_hand(hear, "duration=0.5", f"timeline=[{push}]", "allowed.refused=4")
    assert sum(refused.values()) == 4
    assert set(refused) == {Reason.SECOND_CONTROLLER, Reason.NOT_FINITE, Reason.OUT_OF_RANGE, Reason.UNDECODABLE}


def test_what_a_bad_link_lets_come_twice_is_refused_again(tmp_path: Path):
    """And what waits for it happens at the same instants."""
    twice = '{target="link.command", kind="duplicate", share=0.3, time="30 ms", at="0.2 s"}'
    push = '{set="rig.load.force", to="500 N", lasts="5 ms", when="refused", times=20}'
    changes = ["duration=1.0", f"fault=[{twice}]", f"timeline=[{push}]", "allowed.refused=100", "expect=[]"]
    run = record_in_process(load("step", changes), tmp_path / "run.mcap")
    assert sum(event.kind == "refused" for event in run.messages("event")) > 5
    verdict = replay_through(run.path, Through("plant", tmp_path / "again.mcap", alone=True))
    assert verdict.events_differ is None
    assert {difference.greatest for difference in verdict.differences} == {0.0}


def test_a_changed_gain_is_found_and_located(lockstep, folder):
    """The residual is there in the recording, too: the change of the command, from the first sample on that has any."""
    output = folder / "stiffer.mcap"
    command = ("replay", str(lockstep.path), "--into", "controller", "--set", *STIFFER, "-o", str(output), "--json")
    done = hydrotwin_here(*command, cwd=folder)
    assert done.returncode == 1, done.stderr
    found = {entry["signal"]: entry for entry in json.loads(done.stdout)["signals"]}
    assert not found["command.spool"]["passed"]
    assert found["command.apply_at"]["passed"]
    spool = lockstep.columns("command")["spool"]
    residual = read(output).columns("residual")
    assert np.abs(residual["spool"]).max() == found["command.spool"]["greatest"] > 0.0
    assert residual["stamp"][np.flatnonzero(residual["spool"])[0]] == round(found["command.spool"]["first"] * 1e9)
    assert len(residual["spool"]) == len(spool)


def test_a_changed_plant_is_found_and_judged_by_tolerances(lockstep, folder):
    output = folder / "heavier.mcap"
    command = ("replay", str(lockstep.path), "--into", "plant", "--set", "rig.load.mass=126 kg", "-o", str(output))
    done = hydrotwin_here(*command, "--json", cwd=folder)
    assert done.returncode == 1
    found = {entry["signal"]: entry for entry in json.loads(done.stdout)["signals"]}
    assert 0.0 <= found["measurement.p2"]["first"] < 2.5
    assert found["state.position"]["greatest"] < 5e-3
    residual = read(output).columns("residual")
    assert np.abs(residual["p2"]).max() == found["measurement.p2"]["greatest"]
    allowed = {"measurement.*": "1e9", "state.*": "1e9"}
    assert replay_through(lockstep.path, Through("plant", output, ["rig.load.mass=126 kg"], allowed, True)).passed


def test_compare_says_where_two_runs_part(lockstep, folder):
    other = record_in_process(load("step", ["duration=2.5", "reference.at=1.2 s"]), folder / "other.mcap")
    same = hydrotwin_here("compare", str(lockstep.path), str(lockstep.path), cwd=folder)
    assert same.returncode == 0
    assert "DIFFERS" not in same.stdout
    done = hydrotwin_here("compare", str(lockstep.path), str(other.path), "--json", cwd=folder)
    assert done.returncode == 1
    found = {entry["signal"]: entry for entry in json.loads(done.stdout)["signals"]}
    assert found["reference.position"]["first"] == pytest.approx(1.0, abs=0.011)
    assert found["reference.position"]["greatest"] == pytest.approx(0.06)
    allowed = ("--tolerance", "*=1e12", "--tolerance", "measurement.position=1 um", "--topics", "measurement")
    done = hydrotwin_here("compare", str(lockstep.path), str(other.path), *allowed, "--json", cwd=folder)
    assert [e["signal"] for e in json.loads(done.stdout)["signals"] if not e["passed"]] == ["measurement.position"]


@pytest.mark.parametrize("into", ["plant", "controller"])
@pytest.mark.parametrize("name", sorted(GOLDEN))
def test_golden_recordings_come_out_of_the_parts_by_themselves(name, into, tmp_path):
    """Within the tolerances of a new run: another processor rounds differently."""
    allowed = {f"*.{signal}": str(tolerance) for signal, tolerance in TOLERANCES.items()}
    output = tmp_path / "out.mcap"
    verdict = replay_through(HERE / f"{name}.mcap", Through(into, output, (), _fitting(into, allowed), alone=True))
    judged = [d for d in verdict.differences if d.signal.partition(".")[2] in TOLERANCES]
    assert judged
    assert all(difference.passed for difference in judged), judged


def _fitting(into: str, allowed: dict[str, str]) -> dict[str, str]:
    names = ("spool", "position") if into == "controller" else TOLERANCES
    return {k: v for k, v in allowed.items() if k.partition(".")[2] in names}


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("replay", "FILE", "--into", "plant", "-o", "FILE"), "would be overwritten"),
        (("replay", "FILE", "--into", "plant", "-o", "x.mcap", "--tolerance", "nothing=1"), "no such signal"),
        (("replay", "FILE", "--into", "plant", "-o", "x.mcap", "--set", "rig.load.mas=1"), "did you mean"),
        (("compare", "FILE", "none.mcap"), "No such file"),
        (("replay", "FILE", "--topics", "nonsense"), "no topic fits"),
        (("replay", "FILE", "--start", "99 s"), "nothing in it between those times"),
        (("replay", "FILE", "--speed", "0"), "greater than 0"),
        (("replay", "FILE", "--remap", "a=b"), "write OLD:=NEW"),
        (("export", "FILE"), "name one of"),
        (("record", "--topics", "stat"), "did you mean 'state'"),
        (("record", "--meta", "nothing"), "KEY=VALUE"),
    ],
)
def test_mistakes_are_told_in_one_line(lockstep, words, told, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = [str(lockstep.path) if word == "FILE" else word for word in words]
    error = CliRunner().invoke(app, words).exception
    assert isinstance(error, UsageError)
    assert told in str(error)
    assert "\n" not in str(error)


def test_a_recording_without_commands_is_no_input(tmp_path):
    path = tmp_path / "a.mcap"
    record_in_process(load("step", ["duration=0.1", "controller.kind=open-loop"]), path)
    cut = tmp_path / "b.mcap"
    cut.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(UsageError):
        replay_through(cut, Through("plant", tmp_path / "c.mcap", alone=True))
