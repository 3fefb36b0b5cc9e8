"""A recorder's ring that opens when a signal goes past a limit."""

from pathlib import Path

import numpy as np
import pytest

from bridge.errors import UsageError
from bridge.processes.recorder.ring import Window
from bridge.processes.recorder.run_file import Arrival, Request, RunFile
from bridge.processes.recorder.triggers import split
from bridge.recording.reader import Recording, read
from bridge.runs.in_process import run_in_memory
from bridge.scenario import load
from bridge.wire.messages import TOPICS

MS = 1_000_000
AROUND = Window(before=15 * MS, after=30 * MS)


@pytest.fixture(scope="module")
def run() -> Recording:
    """A step and a push, with the force of the rod among the channels."""
    push = '{set="rig.load.force", at="0.6 s", to="-3 kN", lasts="50 ms"}'
    return run_in_memory(
        load("step", ["duration=1", "reference.at=0.2", f"timeline=[{push}]", "daq.channels=['force']"])
    )


def kept_by(run: Recording, path: Path, triggers: str) -> RunFile:
    """The recorder's file of a run whose messages come in the order of the bus."""
    request = Request(Request().keeping, AROUND, *split(triggers))
    file = RunFile(path, {**run.metadata["run"], "mode": "lockstep", "tick": 0}, request)
    order = [topic for topic in TOPICS if topic != "measurement"]
    for entry in sorted(run.entries, key=lambda e: (e.log_time, e.topic in order and order.index(e.topic) + 1)):
        file.take(Arrival(entry.topic, entry.data, (entry.log_time, entry.sequence)))
    file.close({})
    return file


@pytest.mark.parametrize(
    ("condition", "column", "limit"),
    [
        ("p_lower > 60 bar", ("state", "p_lower"), 60e5),
        ("p2 > 60 bar", ("measurement", "p2"), 60e5),
        ("measurement.position > 120 mm", ("measurement", "position"), 0.12),
        ("channels.force > 3 kN", ("channels", "force"), 3e3),
    ],
)
def test_what_is_kept_surrounds_each_crossing(
    run: Recording, tmp_path: Path, condition: str, column: tuple[str, str], limit: float
):
    """Against the same columns of the whole run: 15 ms before each crossing, 30 ms after it."""
    columns = run.columns(column[0])
    past = columns[column[1]] > limit
    crossings = columns["stamp"][1:][past[1:] & ~past[:-1]]
    assert len(crossings) >= 1
    stamps = run.columns("state")["stamp"]
    expected = {
        t for t in stamps.tolist() if any(-AROUND.before <= t - at <= AROUND.after for at in crossings.tolist())
    }
    file = kept_by(run, tmp_path / "a.mcap", condition)
    kept = [read(path) for path in file.paths]
    found = np.concatenate([one.columns("state")["stamp"] for one in kept]).tolist()
    assert set(found) == expected
    causes = [cause for one in kept for cause in one.metadata["recorder"]["triggered"]]
    assert causes == [f"{condition} at {at / 1e9:g} s" for at in crossings.tolist()]


def test_a_signal_that_is_past_its_limit_at_the_start_has_not_crossed_it(run: Recording, tmp_path: Path):
    assert kept_by(run, tmp_path / "a.mcap", "position > 50 mm").paths == []


def test_events_and_conditions_stand_in_one_list():
    assert split("late, p2 > 60 bar,safe,velocity < 0") == (("late", "safe"), ("p2 > 60 bar", "velocity < 0"))
    assert split("none") == ((), ())


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("saef", "did you mean 'safe'"),
        ("p9 > 1 bar", "no signal 'p9'"),
        ("p2 > 60", "60 has no unit"),
        ("p2 > high", "cannot read 'high'"),
    ],
)
def test_what_would_never_open_it_is_refused(text: str, words: str):
    with pytest.raises(UsageError, match=words):
        split(text)


def test_a_channel_that_the_card_does_not_read_is_refused_with_those_that_it_does(run: Recording, tmp_path: Path):
    with pytest.raises(UsageError, match=r"no signal 'channels.forse'; did you mean 'channels.force'"):
        kept_by(run, tmp_path / "a.mcap", "channels.forse > 1 kN")
