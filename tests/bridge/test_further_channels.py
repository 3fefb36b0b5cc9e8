"""Further channels of the card: what they read, and that every mode, reader and law has the same of them."""

import json
import shutil
import struct
from pathlib import Path

import numpy as np
import pytest

import hydrotwin as ht
from bridge.cli.verbs import app  # noqa: F401  loaded before a test takes the streams
from bridge.errors import RunError, ScenarioError, UsageError
from bridge.processes.recorder.run_file import Arrival, Request, RunFile
from bridge.recording.digest import digest
from bridge.recording.export import export
from bridge.recording.reader import Recording, read
from bridge.recording.writer import save
from bridge.replay.through import Through, replay_through
from bridge.report.own_signals import READ, draw_own, own_charts
from bridge.report.subject import load_run
from bridge.runs.check import judge_run
from bridge.runs.in_process import record_in_process, run_in_memory, run_unrecorded
from bridge.scenario import Scenario, load
from bridge.studies.stability.trial import stand, trial
from bridge.wire.messages import OF_SOME_RUNS
from tests.support.command import hydrotwin_here
from tests.support.processes import LOOSE, run_recorded
from twin.kept import sensors
from twin.topology import OBSERVED

BARE = tuple(f"daq.{effect}" for effect in ("noise=0", "quantise=false", "clip=false"))
CHOSEN = ("p_pump", "flow_3", "force", "acceleration", "spool")
SENSORS = sensors(load("step").rig_values())
LAW = """\
def law(sample, target, memory, gains):
    u = 20.0 * (target.position - sample.position) - 1e-10 * (sample.channels["p_pump"] - 70e5)
    return max(-1.0, min(1.0, u)), memory, {"force": (sample.channels["force"], "N"), "n": len(sample.channels)}
"""


def scenario(*changes: str, channels: tuple[str, ...] = CHOSEN) -> Scenario:
    own = ["duration=0.3", "reference.at=0.02", "expect=[]", f"daq.channels={json.dumps(channels)}"]
    return load("step", [*own, *changes])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the law is."""
    place = tmp_path_factory.mktemp("channels")
    (place / "law.py").write_text(LAW)
    text = f'extends = "step"\nduration = 0.3\nexpect = []\nreference.at = 0.02\ndaq.channels = {json.dumps(CHOSEN)}\n'
    (place / "law.toml").write_text(f'{text}[controller]\nkind = "python"\nlaw = "law.py:law"\n')
    return place


@pytest.fixture(scope="module")
def alone(folder: Path) -> Recording:
    """A run of that law in process."""
    record_in_process(load(str(folder / "law.toml")), folder / "alone.mcap")
    return read(folder / "alone.mcap")


def test_each_reads_its_quantity_at_the_stamp_of_the_measurement():
    run = run_in_memory(scenario(*BARE, channels=tuple(SENSORS)))
    read_, true, measured = (run.columns(topic) for topic in ("channels", "state", "measurement"))
    for name in ("sequence", "tick", "stamp"):
        assert read_[name].tolist() == measured[name].tolist()
    for name in SENSORS.keys() & OBSERVED.keys():
        assert read_[name].tolist() == true[name].tolist()
    assert len(SENSORS.keys() & OBSERVED.keys()) == len(SENSORS) - 2


def test_the_accelerometer_adds_up_to_the_speed():
    """Read at every step, its mean over each step times the step is what the speed has gained, impacts included."""
    run = run_in_memory(scenario(*BARE, "loop.daq_period=50 us", "loop.sample_period=10 ms"))
    gained = 50e-6 * np.cumsum(run.columns("channels")["acceleration"])
    assert gained == pytest.approx(run.columns("state")["velocity"], abs=1e-12)
    assert np.abs(run.columns("state")["velocity"]).max() > 0.01


def test_the_force_cell_shows_the_weight_at_rest_and_balances_the_oil_in_motion():
    """(2.10) from the other side: A_l p_l - A_u p_u and the seal's force are what the rod passes on."""
    asked = scenario(*BARE, "loop.daq_period=50 us", "loop.sample_period=10 ms", "rig.load.force=500 N")
    run, rig = run_in_memory(asked), asked.rig_values()
    force, true = run.columns("channels")["force"], run.columns("state")
    assert force[0] == pytest.approx(rig["load"]["mass"] * rig["load"]["gravity"] - 500.0)
    lower = np.pi / 4.0 * (rig["cylinder"]["bore"] ** 2 - rig["cylinder"]["rod"] ** 2)
    oil = lower * true["p_lower"] - np.pi / 4.0 * rig["cylinder"]["bore"] ** 2 * true["p_upper"]
    moving = (np.abs(true["velocity"]) > 1e-3) & (np.abs(np.gradient(true["velocity"])) < 1e-4)
    assert moving.sum() > 1000
    mean = 0.5 * (oil + np.roll(oil, 1))  # the scheme's two half kicks
    assert force[moving] == pytest.approx((mean + true["friction"])[moving], abs=2.0)


def test_resolution_noise_and_range_are_those_of_the_card():
    changes = ("daq.bits=8", "daq.pressure_range=70 bar", "daq.noise=2")
    run = run_in_memory(scenario(*changes, channels=("p_pump", "flow_pump")))
    read_, true = run.columns("channels"), run.columns("state")
    lsb = {"p_pump": 70e5 / 256, "flow_pump": 200e-3 / 60 / 256}
    for name in lsb:
        counts = read_[name] / lsb[name]
        assert counts == pytest.approx(np.round(counts), abs=1e-9)
    assert read_["p_pump"].max() <= 70e5 - lsb["p_pump"] < true["p_pump"].max()
    apart = (read_["flow_pump"] - true["flow_pump"]) / lsb["flow_pump"]
    assert np.std(apart) == pytest.approx(np.hypot(2.0, 1 / np.sqrt(12)), rel=0.1)  # 301 samples: 4 % each way


def test_the_noise_of_a_channel_is_its_own():
    """The measurement has the bytes that it has without them; a channel those that it has among others, or alone."""
    many, one, none = (run_in_memory(scenario(channels=names)) for names in (CHOSEN, ("force",), ()))
    for topic in ("measurement", "state", "command"):
        assert [e.data for e in many.of(topic)] == [e.data for e in none.of(topic)] == [e.data for e in one.of(topic)]
    assert many.columns("channels")["force"].tolist() == one.columns("channels")["force"].tolist()
    run = run_in_memory(scenario("daq.quantise=false", "duration=1.1", channels=("p_pump", "p_p")))
    noise = [run.columns("channels")[name] - run.columns("state")[name] for name in ("p_pump", "p_p")]
    assert len(noise[0]) == 1101  # over the end of a block of noise
    assert abs(np.corrcoef(noise)[0, 1]) < 0.15  # of 1101 samples, five times its own spread


def test_the_timeline_makes_a_transducer_drift_and_rattle(tmp_path: Path):
    """A replay into the plant does, too; the others keep their bytes."""
    entries = [
        {"set": "channel.force.offset", "at": 0.1, "to": "2 kN"},
        {"set": "channel.p_pump.noise", "at": 0.2, "to": 50},
    ]
    asked = scenario("daq.noise=0", "daq.quantise=false", f"timeline={json.dumps(entries)}")
    run, plain = record_in_process(asked, tmp_path / "a.mcap"), run_in_memory(scenario(*BARE[:2], "daq.clip=true"))
    read_, true = run.columns("channels"), plain.columns("channels")
    apart = {name: read_[name] - true[name] for name in CHOSEN}
    assert apart["force"] == pytest.approx(np.where(read_["stamp"] < 10**8, 0.0, 2e3), abs=1e-9)
    noise, lsb = apart["p_pump"], 250e5 / 4096
    assert set(noise[:200]) == {0.0}
    assert np.std(noise[200:] / lsb) == pytest.approx(50.0, rel=0.25)  # 101 samples: 7 % each way
    assert {*apart["flow_3"], *apart["acceleration"], *apart["spool"]} == {0.0}
    verdict = replay_through(run.path, Through("plant", tmp_path / "b.mcap", alone=True))
    assert {difference.greatest for difference in verdict.differences} == {0.0}


def test_a_run_without_them_has_none(tmp_path: Path):
    record_in_process(load("step", ["duration=0.02"]), tmp_path / "a.mcap")
    found = read(tmp_path / "a.mcap")
    assert not set(OF_SOME_RUNS) & {*found.channels, *found.counts}
    assert list(found.columns("channels")) == ["run_id", "sequence", "tick", "stamp"]


def test_the_schema_names_each_with_its_unit(alone: Recording, tmp_path: Path):
    """As rosbags and this project's own reader have it of the file alone; also of a copy."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    definition = alone.channels["channels"].definition
    assert "float64 p_pump        # [Pa] gauge, pump\n" in definition
    assert [(field.name, field.unit) for field in alone.layout()] == [(name, SENSORS[name].unit) for name in CHOSEN]
    with AnyReader([alone.path], default_typestore=get_typestore(Stores.EMPTY)) as reader:
        rows = [reader.deserialize(raw, c.msgtype) for c, _, raw in reader.messages() if c.topic == "rig/channels"]
    for name in CHOSEN:
        assert [getattr(row, name) for row in rows] == alone.columns("channels")[name].tolist()
    save(alone, tmp_path / "copy.mcap", "rig")
    assert read(tmp_path / "copy.mcap").channels["channels"].definition == definition


def test_reruns_loader_finds_every_channel(alone: Recording):
    pytest.importorskip("rerun")
    from rerun.chunk import McapReader

    chunks = [chunk for chunk in McapReader(alone.path).stream() if str(chunk.entity_path) == "/rig/channels"]
    schemas = " ".join(str(chunk.to_record_batch().schema) for chunk in chunks)
    assert [name for name in CHOSEN if name in schemas] == [*CHOSEN]


def test_a_law_is_given_them_in_every_mode_and_in_replays(alone: Recording, folder: Path):
    """The same bytes in process, in lockstep and in real time; all replays give a residual of zero."""
    logged, read_ = alone.columns("signals"), alone.columns("channels")
    rows = np.searchsorted(read_["stamp"], logged["stamp"])
    assert logged["force"].tolist() == read_["force"][rows].tolist()
    assert set(logged["n"]) == {float(len(CHOSEN))}
    file = str(folder / "law.toml")
    lockstep = run_recorded(folder / "lock.mcap", file, "--mode", "lockstep")
    assert digest(lockstep.path) == digest(alone.path)
    slowly = ("--mode", "realtime", "--speed", "0.3", *LOOSE, "--set", "loop.daq_period=5 ms")
    clocked = run_recorded(folder / "real.mcap", file, *slowly)
    again = record_in_process(load(file, ["loop.daq_period=5 ms"]), folder / "again.mcap")
    commands = clocked.metadata["summary"]["commands"]
    late = commands["late"] or commands["taken"] < commands["due"]
    assert late or digest(clocked.path)["channels"] == digest(again.path)["channels"]
    for recorded in (lockstep, clocked):
        for into, here in (("controller", True), ("plant", True), ("controller", recorded is clocked)):
            _leaves_no_residual(recorded, into, Through(into, folder / f"{into}.mcap", alone=here))


def _leaves_no_residual(recorded: Recording, into: str, request: Through) -> None:
    verdict = replay_through(recorded.path, request)
    assert verdict.passed
    assert {difference.greatest for difference in verdict.differences} == {0.0}
    own = "signals.force" if into == "controller" else "channels.force"
    assert own in {difference.signal for difference in verdict.differences}


def test_a_replay_names_the_channels_that_it_lacks(alone: Recording, tmp_path: Path):
    changes = ['daq.channels=["p_pump", "p_t", "force"]']
    with pytest.raises(
        UsageError, match=r"its further channels are p_pump, flow_3, .* the scenario's p_pump, p_t, force"
    ):
        replay_through(alone.path, Through("controller", tmp_path / "b.mcap", changes, alone=True))


def test_a_law_in_memory_has_them():
    """Of whatever kind the scenario's own controller is."""
    seen = []

    def law(sample, target, memory, gains):
        seen.append(sample.channels["p_pump"])
        return 0.1, memory

    run = ht.run(scenario(), law)
    assert seen == run.columns("channels")["p_pump"][::10].tolist()
    with pytest.raises(
        RunError, match=r"p_t is not a channel of this scenario: put it into daq.channels \(chosen: p_p"
    ):
        ht.run(scenario(), lambda sample, *_: (sample.channels["p_t"], None))


def test_trials_of_theory_give_them_to_a_law(alone: Recording, folder: Path):
    """They move the piston bit for bit as the run does."""
    asked = load(str(folder / "law.toml"))
    trace, state = trial(asked, stand(asked)), alone.columns("state")
    rows = np.searchsorted(state["stamp"], np.round(trace.time * 1e9).astype(int))
    assert trace.position.tolist() == state["position"][rows].tolist()


C_LAW = """\
#include "hydrotwin_law.h"
const int32_t hydrotwin_law_version = HYDROTWIN_LAW_VERSION;
const char *const hydrotwin_law_channels[] = {"force", "p_pump", 0};
const hydrotwin_signal hydrotwin_law_signals[] = {{"force", "N"}, {"pump", "Pa"}, {0, 0}};
int hydrotwin_law(const hydrotwin_sample *sample, const hydrotwin_target *target, const hydrotwin_facts *facts,
                  const double *parameters, double *memory, double *spool, double *signals) {
  signals[0] = sample->channels[0];
  signals[1] = sample->channels[1];
  *spool = 20.0 * (target->position - sample->position);
  return 0;
}
"""


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler `cc` on this machine")
def test_a_law_in_c_gets_those_that_it_declares(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    Path("law.c").write_text(C_LAW)
    ours = "controller.kind=c", "controller.source=law.c"
    run = run_in_memory(scenario(*ours))
    logged, read_ = run.columns("signals"), run.columns("channels")
    assert logged["force"].tolist() == read_["force"][::10].tolist()
    assert logged["pump"].tolist() == read_["p_pump"][::10].tolist()
    with pytest.raises(
        ScenarioError, match=r"law\.c reads the channel 'p_pump', which daq\.channels does not name"
    ) as no:
        run_in_memory(scenario(*ours, channels=("force",)))
    assert "\n" not in str(no.value)


def test_a_foreign_program_reads_the_message_by_what_is_printed(alone: Recording, folder: Path):
    printed = hydrotwin_here("messages", "--scenario", "law.toml", "--json", cwd=folder)
    told = json.loads(printed.stdout)
    assert told["channels"] == list(CHOSEN)
    assert {entry["name"] for entry in told["known"]} == set(SENSORS)
    assert told["definition"] == alone.channels["channels"].definition
    rows = [struct.unpack(told["struct"], entry.data) for entry in alone.of("channels")]
    columns = alone.columns("channels")
    assert [row[4:] for row in rows] == list(zip(*(columns[name].tolist() for name in CHOSEN), strict=True))
    words = hydrotwin_here("messages", "--scenario", "step", cwd=folder).stdout
    assert "None is chosen" in words
    assert "flow_relief   l/min  -100" in words


@pytest.mark.parametrize(
    ("channels", "words"),
    [
        (["p_pumpe"], "'p_pumpe' is not a channel of this drive; did you mean 'p_pump'?"),
        (["force", "force"], "'force' is named twice"),
        (["accumulator.gas"], "'accumulator_gas' is not a channel of this drive"),
    ],
)
def test_what_is_no_channel_is_refused_in_one_line(channels: list[str], words: str):
    with pytest.raises(ScenarioError, match=r"daq\.channels: ") as refused:
        load("step", [f"daq.channels={json.dumps(channels)}"])
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


def test_the_recorder_takes_none_of_another_layout(alone: Recording, tmp_path: Path):
    file = RunFile(tmp_path / "a.mcap", {**alone.metadata["run"], "mode": "lockstep", "tick": 0}, Request())
    first = next(alone.of("channels"))
    for payload in (first.data, first.data[:-8], first.data + bytes(8), first.data[:-3], b"", first.data[:36]):
        file.take(Arrival("channels", payload, (0, 0)))
    assert file.rejected == 5


def test_bands_may_be_about_them():
    """Also where a run is not recorded; one about a channel that is not chosen is refused before it runs."""
    bands = ["greatest channels.p_pump <= 60 bar", "least channels.force from 0.1 s to end >= 1 kN"]
    asked = scenario(f"expect={json.dumps(bands)}")
    found, summary = run_unrecorded(asked)
    verdicts = judge_run(asked, summary, found)
    read_ = run_in_memory(asked).columns("channels")
    assert [verdict.passed for verdict in verdicts] == [False, bool(read_["force"][100:].min() >= 1e3)]
    assert verdicts[0].found == f"{read_['p_pump'].max() * 1e-5:.4g} bar"
    with pytest.raises(ScenarioError, match=r"'channels.p_t' is not read; put 'p_t' into daq.channels"):
        scenario('expect=["greatest channels.p_t <= 3 bar"]')


def test_export_and_compare_have_them(alone: Recording, tmp_path: Path):
    (gauge,) = export(alone, ["channels"], "csv", tmp_path / "gauge")
    (absolute,) = export(alone, ["channels"], "csv", tmp_path / "absolute", absolute=True)
    heads = [path.read_text().partition("\n")[0].split(",")[-5:] for path in (gauge, absolute)]
    assert heads[0] == ["p_pump [Pa]", "flow_3 [m^3/s]", "force [N]", "acceleration [m/s^2]", "spool"]
    assert heads[1] == ["p_pump [Pa abs]", *heads[0][1:]]
    values = [np.loadtxt(path, delimiter=",", skiprows=1)[:, -5:] for path in (gauge, absolute)]
    assert values[1] - values[0] == pytest.approx(np.array([[1e5, 0.0, 0.0, 0.0, 0.0]] * len(values[0])))
    other = record_in_process(scenario("seed=2"), tmp_path / "other.mcap")
    asked = ("compare", str(alone.path), str(other.path), "--json", "--topics", "channels")
    found = json.loads(hydrotwin_here(*asked, cwd=tmp_path).stdout)["signals"]
    assert {entry["signal"] for entry in found} == {f"channels.{name}" for name in CHOSEN}
    assert ht.read(alone.path).signal("force").unit == "N"


def test_report_and_view_draw_them_by_unit(alone: Recording, tmp_path: Path):
    charts = [chart for chart in own_charts([load_run(alone.path)]) if chart.kind is READ]
    assert [chart.title for chart in charts] == [
        *("Further channels [bar]", "Further channels [l/min]", "Further channels [N]", "Further channels [m/s^2]"),
        "Further channels",
    ]
    (axis,) = draw_own(charts[0], [load_run(alone.path)], ["a"]).axes
    assert axis.get_lines()[0].get_ydata() == pytest.approx(1e-5 * alone.columns("channels")["p_pump"])
    rerun = pytest.importorskip("rerun")
    from bridge.view.content import write
    from bridge.view.live_drawing import Drawing
    from tests.bridge.test_view import column

    stream = rerun.RecordingStream("hydrotwin")
    stream.save(tmp_path / "live.rrd")
    drawing = Drawing(stream, alone.metadata["run"], bare=False)
    for begin in range(0, len(alone.entries), 500):
        drawing.add(alone.entries[begin : begin + 500])
    stream.disconnect()
    for path in (write(alone, tmp_path / "a.rrd"), tmp_path / "live.rrd"):
        _, values = column(path, "/channels_N/force", "Scalars:scalars")
        assert sorted(values) == pytest.approx(sorted(alone.columns("channels")["force"]))
