"""A scenario on top of another: what it says itself stands, the rest is the other's."""

import pytest

from bridge.scenario import ScenarioError, load
from controller.reference import evaluate

BASE = """duration = 3.0
[reference]
kind = "step"
start = 0.1
end = 0.2
[rig.load]
mass = "200 kg"
added = "50 kg"
"""


def write(folder, **texts: str) -> None:
    for name, text in texts.items():
        (folder / f"{name}.toml").write_text(text)


def test_a_scenario_extends_another_section_by_section(tmp_path):
    """What it says itself stands, the rest is of the file beside it; lists are replaced; its name is its own."""
    own = 'extends = "base.toml"\nexpect = ["overshoot <= 5 %"]\n[reference]\nend = 0.15\n[rig.load]\nmass = "300 kg"\n'
    write(tmp_path, base='expect = ["rise time <= 1 s"]\n' + BASE, own=own)
    scenario = load(str(tmp_path / "own.toml"))
    assert scenario.name == "own"
    assert scenario.duration == 3.0
    assert scenario.expect == ["overshoot <= 5 %"]
    assert scenario.reference.model_dump(exclude={"kind", "at"}) == {"start": 0.1, "end": 0.15}
    assert (scenario.rig.load.mass, scenario.rig.load.added) == (300.0, 50.0)


def test_extensions_chain_and_changes_come_last(tmp_path):
    write(
        tmp_path,
        base=BASE,
        middle='extends = "base.toml"\nduration = 4.0\n[rig.pump]\nspeed = "502 rpm"\n',
        own='extends = "middle.toml"\n[rig.pump]\nripple = "none"\n',
    )
    scenario = load(str(tmp_path / "own.toml"), ["rig.load.added=0"])
    assert scenario.duration == 4.0
    assert scenario.rig.pump.speed == pytest.approx(502.0 / 60.0)
    assert scenario.rig.pump.ripple == "none"
    assert (scenario.rig.load.mass, scenario.rig.load.added) == (200.0, 0.0)


def test_a_scenario_may_extend_several_each_on_top_of_those_before(tmp_path):
    """A rig of one file under the run of another; a reference of another kind brings all of its numbers."""
    write(
        tmp_path,
        rig='[reference]\nkind = "step"\nstart = 0.1\nend = 0.2\n[rig.load]\nmass = "200 kg"\n[rig.pump]\nspeed = 10\n',
        motion='[reference]\nkind = "constant"\nvalue = 0.1\n[rig.load]\nmass = "300 kg"\n',
        own='extends = ["rig.toml", "motion.toml"]\nduration = 1.0\n',
    )
    scenario = load(str(tmp_path / "own.toml"))
    assert scenario.reference.model_dump() == {"kind": "constant", "value": 0.1}
    assert (scenario.rig.load.mass, scenario.rig.pump.speed, scenario.duration) == (300.0, 10.0, 1.0)


def test_a_file_can_extend_a_built_in_scenario_and_a_built_in_one_another(tmp_path):
    write(tmp_path, own='extends = "impingement"\n[rig.load]\nmass = "165 kg"\n')
    own, base = load(str(tmp_path / "own.toml")), load("impingement")
    assert own.rig.load.mass == 165.0
    assert own.model_dump(exclude={"name", "rig"}) == base.model_dump(exclude={"name", "rig"})
    slow = load("impingement-502")
    assert slow.rig.pump.speed == pytest.approx(502.0 / 60.0)
    assert (slow.reference, slow.rig.load) == (base.reference, base.rig.load)
    assert slow.name == "impingement-502"


@pytest.mark.parametrize(
    ("texts", "said"),
    [
        ({"own": 'extends = "own.toml"\n'}, "extends itself"),
        ({"own": 'extends = "other.toml"\n', "other": 'extends = "own.toml"\n'}, "extends itself"),
        ({"own": 'extends = "stepp"\n'}, "stepp: no such scenario or file; did you mean 'step'"),
        ({"own": 'extends = "other.toml"\n', "other": "duration = \n"}, "other.toml: cannot be read"),
    ],
)
def test_an_extension_of_itself_or_of_nothing_is_refused(tmp_path, texts, said):
    write(tmp_path, **texts)
    with pytest.raises(ScenarioError) as error:
        load(str(tmp_path / "own.toml"))
    assert said in str(error.value)


def test_a_table_of_an_extended_scenario_is_read_from_beside_that_one(tmp_path):
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "way.csv").write_text("time_s,position_m\n0,0.1\n1,0.2\n")
    write(tmp_path / "deep", base='[reference]\nkind = "table"\ncsv = "way.csv"\n')
    write(tmp_path, own='extends = "deep/base.toml"\nduration = 2.0\n')
    scenario = load(str(tmp_path / "own.toml"))
    assert evaluate(scenario.reference.reference(), 0.5).position == pytest.approx(0.15)
