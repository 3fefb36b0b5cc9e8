"""Looking ahead from an estimate: what comes is among the futures, a change is told apart, nothing else changes."""

from pathlib import Path

import numpy as np
import pytest

from bridge.errors import ScenarioError, UsageError
from bridge.loop.ahead import Past, Question, look_ahead
from bridge.recording.reader import Recording
from bridge.recording.writer import save
from bridge.replay.whatif import band_of, from_file, what_if
from bridge.runs.in_process import run_in_memory
from bridge.scenario import load
from twin.estimation.settings import Settings

NOW, HORIZON = 700_000_000, 300_000_000  # [ns]
SETTINGS = Settings(members=24)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Recording]:
    """A run, and its file."""
    rec = run_in_memory(load("sine", ["duration=1.1", "loop.delay=5 ms"]))
    return save(rec, tmp_path_factory.mktemp("whatif") / "a.mcap", "rig"), rec


def test_what_comes_is_among_the_futures(recorded: tuple[Path, Recording]):
    """The position that the run went on to is within their spread and a quarter of a millimetre."""
    path, rec = recorded
    heard = from_file(path, NOW, SETTINGS)
    before = heard.side.filter.members.states.copy() if heard.side.filter.members else None
    futures = look_ahead(heard.side, heard.scenario, heard.past, Question({}, HORIZON))
    state = rec.columns("state")
    true = state["position"][np.searchsorted(state["stamp"], np.round(futures[0].time * 1e9))]
    positions = np.array([signals.position for signals in futures])
    slack = 0.25e-3
    assert (true >= positions.min(axis=0) - slack).all()
    assert (true <= positions.max(axis=0) + slack).all()
    assert heard.side.filter.members is not None
    assert (heard.side.filter.members.states == before).all()


def test_the_spread_of_the_futures_is_what_is_stated(recorded: tuple[Path, Recording]):
    """At its first instant: the deviation of the position as the estimate states it."""
    heard = from_file(recorded[0], NOW, SETTINGS)
    assert heard.side.latest is not None
    futures = look_ahead(heard.side, heard.scenario, heard.past, Question({}, 2_000_000))
    spread = np.std([signals.position[0] for signals in futures], ddof=1)
    assert spread == pytest.approx(heard.side.latest.deviations["position"], rel=0.1)


def test_a_dangerous_gain_is_told_from_a_good_one(recorded: tuple[Path, Recording]):
    """Forty times the gain makes the valve go from end to end at each sample."""
    band = ["valve travel <= 4"]
    verdicts = [
        what_if(from_file(recorded[0], NOW, SETTINGS), changes, HORIZON, band, 0.05)
        for changes in ({}, {"controller.gain": "40 V/%"})
    ]
    assert [verdict.passed for verdict in verdicts] == [True, False]
    assert verdicts[1].metrics["valve_travel"]["median"] > 2.0 * verdicts[0].metrics["valve_travel"]["high"]


def test_only_the_controller_can_be_tried(recorded: tuple[Path, Recording]):
    heard = from_file(recorded[0], 300_000_000, SETTINGS)
    with pytest.raises(ScenarioError, match="only numbers of the controller"):
        what_if(heard, {"rig.load.force": "100 N"}, HORIZON, [], 0.05)
    with pytest.raises(UsageError, match="whole horizon"):
        what_if(heard, {}, HORIZON, ["mean p1 from 1 s to 2 s <= 3 bar"], 0.05)


def test_a_band_that_no_future_can_be_judged_by_is_refused(recorded: tuple[Path, Recording]):
    """A sine has no stretch in which a limit cycle could be seen: it is not taken for one that is broken."""
    heard = from_file(recorded[0], 300_000_000, SETTINGS)
    with pytest.raises(UsageError, match="not applicable"):
        what_if(heard, {}, HORIZON, ["limit cycle amplitude <= 0.5 mm"], 0.05)


def test_a_step_that_never_settles_breaks_its_band(tmp_path: Path):
    """50 ms after a step of 60 mm no future can have settled: that is an answer, and not a question without one."""
    rec = run_in_memory(load("step", ["duration=1.1", "loop.delay=5 ms"]))
    heard = from_file(save(rec, tmp_path / "a.mcap", "rig"), 950_000_000, SETTINGS)
    verdict = what_if(heard, {}, 100_000_000, ["settling time <= 1 s"], 0.05)
    assert [kept.kept for kept in verdict.bands] == [0]


def test_the_futures_have_the_gain_that_the_run_has_come_to(tmp_path: Path):
    """Five times the gain since the piston went past a place, which the scenario alone does not say."""
    stiffer = '{set="controller.gain", when="position > 125 mm", to="1.85 V/%"}'
    rec = run_in_memory(load("step", ["duration=1.5", "loop.delay=5 ms", f"timeline=[{stiffer}]"]))
    heard = from_file(save(rec, tmp_path / "a.mcap", "rig"), 1_100_000_000, SETTINGS)
    assert [change.text.partition(" ")[0] for change in heard.past.changes] == ["timeline"]
    state = rec.columns("state")
    apart = []
    for past in (heard.past, Past(heard.past.measurements, [])):
        futures = look_ahead(heard.side, heard.scenario, past, Question({}, HORIZON))
        true = state["position"][np.searchsorted(state["stamp"], np.round(futures[0].time * 1e9))]
        middle = np.median([signals.position for signals in futures], axis=0)
        apart.append(float(np.sqrt(((middle - true) ** 2).mean())))
    assert apart[0] < 0.2e-3
    assert apart[0] < apart[1] / 5.0


def test_of_a_plant_whose_valve_obeys_nobody_nothing_is_said(tmp_path: Path):
    alarm = '{when="position > 125 mm", then="latched"}'
    rec = run_in_memory(load("step", ["duration=1.5", f"alarm=[{alarm}]"]))
    heard = from_file(save(rec, tmp_path / "a.mcap", "rig"), 1_300_000_000, SETTINGS)
    with pytest.raises(UsageError, match="is latched, so no command acts"):
        what_if(heard, {}, HORIZON, [], 0.05)


def test_what_cannot_be_asked_is_refused_in_one_line(recorded: tuple[Path, Recording]):
    path, _ = recorded
    with pytest.raises(UsageError, match=r"--at 9 s: .* ends at 1.1 s"):
        from_file(path, 9_000_000_000, SETTINGS)
    heard = from_file(path, 300_000_000, SETTINGS)
    with pytest.raises(UsageError, match="--horizon 0 s: at least one scan"):
        what_if(heard, {}, 0, [], 0.05)
    for band, words in (("peek p1 <= 90 bar", "did you mean"), ("peak p1 <= 90 mm", "mm"), ("peak p1 90 bar", "write")):
        with pytest.raises(UsageError, match=words):
            band_of(band)


def test_a_metric_may_be_called_as_tables_print_it():
    for shown, name in (("largest error <= 3 mm", "max_error"), ("least p_lower >= 0 bar", "min_p_lower")):
        assert band_of(shown).metric == name
