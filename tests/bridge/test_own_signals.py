"""Signals that a law logs and lines that it prints: the same in every mode, and in all that reads a recording."""

import csv
import io
import json
import logging
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import hydrotwin as ht
from bridge.cli.verbs import app  # noqa: F401  loaded before a test takes the streams
from bridge.errors import UsageError
from bridge.loop.hearing import ENOUGH, LONGEST, MOST, Hearing
from bridge.processes.recorder.ring import Window
from bridge.processes.recorder.run_file import Arrival, Request, RunFile
from bridge.recording.digest import digest
from bridge.recording.export import export
from bridge.recording.info import describe
from bridge.recording.reader import Recording, read
from bridge.recording.recover import recover
from bridge.recording.told import events_of
from bridge.replay.through import Through, replay_through
from bridge.report.own_signals import draw_own, own_charts
from bridge.report.page import page
from bridge.report.subject import load_run
from bridge.runs.check import judge_run
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.wire.messages import OF_SOME_RUNS, TOPICS
from tests.support.command import hydrotwin_here
from tests.support.processes import UNDRAWN, hydrotwin, run_recorded

PI = """\
import logging
import sys

import hydrotwin as ht

log = logging.getLogger("mine")
log.setLevel(logging.INFO)
log.handlers = [logging.StreamHandler()]
log.handlers[0].setFormatter(logging.Formatter("%(levelname)s %(message)s"))
log.propagate = False
print("loaded")


def law(sample, target, memory, gains):
    error, integral = target.position - sample.position, memory or 0.0
    if sample.stamp_ns == 20_000_000:
        print("at", sample.stamp_ns // 1_000_000, "ms")
        print("unended", end="")
        print("on error", file=sys.stderr)
        log.info("noted")
        log.warning("warned")
    spool = ht.saturate(10.0 * error + integral, gains.limit)
    return spool, integral + gains.sample_period * error, {
        "integral": (2000.0 * integral, "mm"), "error": (error, "m"), "held": abs(spool) < 1, "gain": (3, "V/%")
    }


def on_safe_state(memory):
    print("safe state")
    return memory
"""
SAID = ["at 20 ms", "on error", "INFO noted", "WARNING warned", "unended"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the law is."""
    place = tmp_path_factory.mktemp("signals")
    (place / "pi.py").write_text(PI)
    (place / "pi.toml").write_text(
        'extends = "step"\nduration = 0.4\n[controller]\nkind = "python"\nlaw = "pi.py:law"\n'
    )
    return place


@pytest.fixture(scope="module")
def inprocess(folder: Path) -> Recording:
    done = hydrotwin_here("run", "pi.toml", "--mode", "inprocess", "--record", "in.mcap", *UNDRAWN, cwd=folder)
    assert done.returncode == 0, done
    assert json.loads(done.stdout)["faults"] == []
    assert done.stderr.splitlines() == ["loaded", *(f"hydrotwin: t = 0.02 s: law: {line}" for line in SAID)]
    return read(folder / "in.mcap")


def test_what_a_law_logs_is_columns_and_signals_with_units(inprocess: Recording, folder: Path):
    run = ht.read(inprocess.path)
    columns, error = run.columns("signals"), run.signal("error")
    assert list(columns) == ["run_id", "source", "sequence", "stamp", "integral", "error", "held", "gain"]
    assert columns["stamp"].tolist() == [10_000_000 * i for i in range(41)]
    assert (error.unit, run.signal("signals.integral").unit, run.signal("gain").unit) == ("m", "m", "V/%")
    reference, measured = run.columns("reference"), run.columns("measurement")
    at_samples = np.isin(measured["stamp"], columns["stamp"])
    assert error.value == pytest.approx(reference["position"] - measured["position"][at_samples], abs=1e-15)
    assert columns["integral"][1:] == pytest.approx(2.0 * 0.01 * np.cumsum(error.value)[:-1], abs=1e-15)
    run.signal("held").stays(above=1.0)


@pytest.mark.parametrize(
    ("band", "found", "passed"),
    [
        ("greatest signals.error <= 1 mm", "0.02441 mm", True),
        ("least signals.error from 0.1 s to end >= 0 um", "-0.04883 mm", False),
        ("mean signals.held >= 1", "1", True),
        ("least signals.gain >= 2 V/%", "3 V/%", True),
        ("least signals.gain >= 2 V", "- (it is logged in V/%, the limit in V)", False),
        ("rms signals.eror <= 1 m", "- (the law logged no such signal; did you mean 'signals.error'?", False),
    ],
)
def test_bands_may_be_about_them(inprocess: Recording, band: str, found: str, passed: bool):
    scenario = inprocess.scenario().model_copy(update={"expect": [band]})
    (verdict,) = judge_run(scenario, ht.Run(inprocess, scenario).summary, inprocess)
    assert verdict.found.startswith(found)
    assert verdict.passed is passed


def test_they_are_exported_with_their_units(inprocess: Recording, tmp_path: Path):
    (path,) = export(inprocess, ["signals"], "csv", tmp_path)
    rows = list(csv.reader(io.StringIO(path.read_text())))
    assert rows[0][-4:] == ["integral [m]", "error [m]", "held", "gain [V/%]"]
    assert len(rows) == 42


def test_the_report_has_a_picture_for_each_unit_and_compares_them(
    inprocess: Recording, folder: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("bridge.report.page.CHARTS", ())  # what others draw, and `test_report.py` tests
    monkeypatch.setattr("bridge.report.page._maps", lambda *_: [])
    monkeypatch.setattr("bridge.report.page._stability", lambda *_: "")
    other = ("run", "pi.toml", "--mode", "inprocess", "--record", "other.mcap", "--seed", "7", *UNDRAWN)
    assert hydrotwin_here(*other, cwd=folder).returncode == 0
    runs = [load_run(inprocess.path), load_run(folder / "other.mcap")]
    text = page(runs)
    assert [f"<h2>Signals of the law{unit}</h2>" in text for unit in (" [mm]", "", " [V/%]")] == [True] * 3
    assert all(f"<td>{line}</td>" in text for line in SAID)
    assert "<td>signals.error</td>" in text
    chart = own_charts(runs)[0]
    (alone,), both = draw_own(chart, runs[:1], ["a"]).axes, draw_own(chart, runs, ["a", "b"]).axes
    assert [line.get_label() for line in alone.get_lines()] == ["integral", "error"]
    assert [[line.get_label() for line in axis.get_lines()] for axis in both] == [["a", "b"]] * 2
    assert alone.get_lines()[1].get_ydata() == pytest.approx(1e3 * inprocess.columns("signals")["error"])


@pytest.mark.parametrize("size", [None, 300])
def test_the_view_has_their_curves_held_from_sample_to_sample(inprocess: Recording, tmp_path: Path, size: int | None):
    """Of a file, and of a run that comes in batches."""
    rerun = pytest.importorskip("rerun")
    from bridge.view.content import write
    from bridge.view.live_drawing import Drawing
    from tests.bridge.test_view import column

    path = tmp_path / "a.rrd"
    if size is None:
        write(inprocess, path)
    else:
        stream = rerun.RecordingStream("hydrotwin")
        stream.save(path)
        drawing, entries = Drawing(stream, inprocess.metadata["run"], bare=False), inprocess.entries
        for begin in range(0, len(entries), size):
            drawing.add(entries[begin : begin + size])
        stream.disconnect()
    stamps, values = column(path, "/own_signals_m/error", "Scalars:scalars")
    logged = inprocess.columns("signals")
    assert sorted(stamps) == logged["stamp"].tolist()
    assert sorted(values) == pytest.approx(sorted(1e3 * logged["error"]))
    assert column(path, "/own_signals_V/gain", "Scalars:scalars")[1] == [3.0] * 41
    lines = column(path, "/events", "TextLog:text")[1]
    assert [line.partition("said: ")[2] for line in lines if "said: " in line] == SAID


def test_lockstep_records_and_says_the_same(inprocess: Recording, folder: Path):
    """Standard output stays JSON alone; both replays of the recording have a residual of zero."""
    done = hydrotwin("run", "pi.toml", "--mode", "lockstep", "--record", "lock.mcap", *UNDRAWN, cwd=folder)
    assert done.returncode == 0, done
    assert json.loads(done.stdout)["lost"] == {}
    assert [line.partition("law: ")[2] for line in done.stderr.splitlines() if "law: " in line] == SAID
    assert digest(folder / "lock.mcap") == digest(inprocess.path)
    for how in ([], ["--alone"]):
        replayed = hydrotwin_here("replay", "lock.mcap", "--into", "controller", *how, "--json", cwd=folder)
        assert replayed.returncode == 0, replayed
        found = {entry["signal"]: entry["greatest"] for entry in json.loads(replayed.stdout)["signals"]}
        assert {"command.spool", "signals.integral", "signals.held"} <= found.keys()
        assert set(found.values()) == {0.0}


def test_a_run_whose_law_logs_nothing_knows_no_such_channel(tmp_path: Path):
    recorded = record_in_process(load("step", ["duration=0.02"]), tmp_path / "a.mcap")
    assert not set(OF_SOME_RUNS) & set(read(recorded.path).channels)


def test_a_file_that_was_cut_off_keeps_them(inprocess: Recording, tmp_path: Path):
    (tmp_path / "cut.mcap").write_bytes(inprocess.path.read_bytes()[:-5000])
    recover([tmp_path / "cut.mcap"], tmp_path / "whole.mcap")
    kept = read(tmp_path / "whole.mcap").columns("signals")
    assert len(kept["error"]) > 10
    assert kept["error"].tolist() == inprocess.columns("signals")["error"][: len(kept["error"])].tolist()


def test_a_line_of_the_law_triggers_a_ring_and_what_else_is_logged_is_counted(inprocess: Recording, tmp_path: Path):
    """What comes in the order of the bus, the controller's answers after the measurements; one signal gets lost."""
    window = Request(window=Window(before=15_000_000, after=30_000_000), triggers=("said",))
    file = RunFile(tmp_path / "ring.mcap", {**inprocess.metadata["run"], "mode": "lockstep", "tick": 0}, window)
    order = [topic for topic in TOPICS if topic != "measurement"]
    entries = sorted(inprocess.entries, key=lambda e: (e.log_time, e.topic in order and order.index(e.topic) + 1))
    for entry in entries:
        if (entry.topic, entry.sequence) != ("signals", 20):
            file.take(Arrival(entry.topic, entry.data, (entry.log_time, entry.sequence)))
    file.close({})
    kept = read(tmp_path / "ring.mcap")
    assert kept.columns("signals")["stamp"].tolist() == [10_000_000 * i for i in range(1, 6)]
    assert [event.text for event in kept.messages("said")] == SAID
    assert file.losses() == {"signals": 1}


def test_what_a_law_says_is_told_with_the_events(inprocess: Recording):
    told = [(event.time, event.text) for event in describe(inprocess).events if event.kind == "said"]
    assert told == [(0.02, text) for text in SAID]


def test_a_law_is_heard_when_it_is_told_of_the_safe_state(folder: Path, tmp_path: Path):
    """A delay longer than the time-out: no command acts for so long."""
    changes = ["loop.command_timeout=0.05", "controller.limit=0.5"]
    (tmp_path / "late.py").write_text(PI.replace("spool = ", "spool = float('nan') if sample.stamp_ns else "))
    scenario = load(
        "step", ["duration=0.3", "controller.kind=python", f"controller.law={tmp_path}/late.py:law", *changes]
    )
    recorded = record_in_process(scenario, tmp_path / "a.mcap")
    safe = next(event.stamp for event in recorded.messages("event") if event.kind == "safe")
    assert [(e.stamp, e.text) for e in recorded.messages("said")][-1] == (safe, "safe state")


def test_a_law_that_never_stops_talking_is_cut_short():
    def law(sample, target, memory, gains):
        print("x" * 1000, "\x1b[31m\tred\n\nlast")
        return 0.0, memory, {}

    stdout, sys.stdout = sys.stdout, io.StringIO()
    try:
        run = ht.run("step", law, changes={"duration": 1})
        assert sys.stdout.getvalue().count("last") == 101
    finally:
        sys.stdout = stdout
    texts = [event.text for event in events_of(run.recording) if event.kind == "said"]
    assert len(texts) == MOST + 1
    assert texts[-1] == ENOUGH
    assert len(texts[0]) == LONGEST
    assert texts[1] == "last"


def test_other_threads_keep_their_voice(capsys: pytest.CaptureFixture[str]):
    """What they print while a law answers is not the law's; afterwards the streams are what they were."""
    hearing, before, handler = Hearing(), (sys.stdout, sys.stderr), logging.StreamHandler(sys.stderr)
    logging.root.addHandler(handler)

    def answer() -> int:
        other = threading.Thread(target=lambda: print("of another thread"))
        other.start()
        other.join()
        logging.getLogger("law").warning("of the law")
        return 3

    assert hearing.call(7, answer) == 3
    logging.root.removeHandler(handler)
    assert capsys.readouterr().out == "of another thread\n"
    assert hearing.lines() == [(7, "of the law")]
    assert (sys.stdout, sys.stderr) == before
    assert handler.stream is before[1]


def test_a_law_in_memory_is_not_to_be_had_for_a_replay(tmp_path: Path):
    def law(sample, target, memory, gains):
        return 0.0, memory

    saved = ht.run("step", law, changes={"duration": 0.05}).save(tmp_path / "a.mcap")
    into = Through("controller", tmp_path / "b.mcap", alone=True)
    with pytest.raises(UsageError, match="was a function in the memory of a program") as refused:
        replay_through(saved, into)
    assert "\n" not in str(refused.value)
    (tmp_path / "same.py").write_text("def law(sample, target, memory, gains):\n    return 0.0, memory\n")
    named = into._replace(changes=["controller.kind=python", f"controller.law={tmp_path}/same.py:law"])
    assert replay_through(saved, named).passed


@pytest.mark.parametrize("mode", ["inprocess", "lockstep"])
def test_what_a_law_says_before_it_fails_is_not_lost(tmp_path: Path, mode: str):
    text = "import logging\nlogging.basicConfig(level=20)\n\ndef law(s, t, m, g):\n    SAY\n"
    text += "    return 1 / (s.stamp_ns - 10**7), m\n"
    say = {"inprocess": "print('before')", "lockstep": "logging.info('before')"}[mode]
    (tmp_path / "fails.py").write_text(text.replace("SAY", say))
    law = ["--set", "controller.kind=python", "--set", "controller.law=./fails.py:law", "--duration", "0.1"]
    run = hydrotwin_here if mode == "inprocess" else hydrotwin
    done = run("run", "step", "--mode", mode, *law, "--record", "a.mcap", *UNDRAWN, cwd=tmp_path)
    assert done.returncode == 1
    assert "fails.py, line 6: ZeroDivisionError" in json.loads(done.stdout)["faults"][0]
    said = {"inprocess": "before", "lockstep": "INFO:root:before"}[mode]
    told = [line.partition("hydrotwin: ")[2] for line in done.stderr.splitlines() if "law: " in line]
    assert told == [f"t = 0 s: law: {said}", f"t = 0.01 s: law: {said}"]
    assert [event.stamp for event in read(tmp_path / "a.mcap").messages("said")] == [0, 10_000_000]


TRUTH = """\
def law(sample, target, memory, gains):
    assert sample.true.stamp == sample.stamp_ns
    return 0.2, memory, {"p_upper": (sample.true.p_upper, "Pa"), "friction": (sample.true.friction, "N")}
"""


def test_a_law_that_asks_for_it_sees_the_true_state_of_its_sample_in_every_mode(tmp_path: Path):
    """What it logs is the state that is recorded for its instant; a replay gives it again."""
    (tmp_path / "truth.py").write_text(TRUTH)
    file = tmp_path / "truth.toml"
    own = 'kind = "python"\nlaw = "truth.py:law"\ntrue_state = true\n'
    file.write_text(f'extends = "step"\nduration = 0.4\nexpect = []\n[controller]\n{own}')
    alone = record_in_process(load(str(file)), tmp_path / "alone.mcap")
    signals, state = alone.columns("signals"), alone.columns("state")
    rows = np.searchsorted(state["stamp"], signals["stamp"])
    assert len(rows) == 41
    for name in ("p_upper", "friction"):
        assert signals[name].tolist() == state[name][rows].tolist()
    wired = run_recorded(tmp_path / "wired.mcap", str(file), "--mode", "lockstep")
    assert digest(wired.path) == digest(alone.path)
    verdict = replay_through(alone.path, Through("controller", tmp_path / "again.mcap", alone=True))
    assert {difference.greatest for difference in verdict.differences} == {0.0}
