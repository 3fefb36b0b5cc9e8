"""The drawn circuit shows what is fitted, in the words of the drive."""

import math
from typing import Any

import pytest

from bridge.figures.circuit.rig import draw_drive, rig_circuit
from twin.rig import values


def words(**changed: dict[str, Any]) -> set[str]:
    """All lines of words on the picture of a drive; of the circuit only lines and rest are read."""
    rig = values()
    for section, entries in changed.items():
        rig[section] = rig.get(section, {}) | entries
    (axes,) = draw_drive(rig, rig_circuit()).axes
    return {line for text in axes.texts for line in text.get_text().splitlines()}


@pytest.fixture(scope="module")
def plain() -> set[str]:
    return words()


def test_the_rig_of_the_thesis_has_its_parts_alone(plain: set[str]):
    found = plain
    assert {
        "gear pump",
        "relief valve, two stages",
        "filter",
        "lifts",
        "arrowheads: flow while the piston rises",
    } <= found
    assert not {"accumulator", "counterbalance", "motor", "check", "orifice"} & found


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"supply": {"kind": "variable"}}, "cut-off 200 bar"),
        ({"supply": {"kind": "pressure"}}, "constant"),
        ({"accumulator": {"kind": "bladder"}}, "accumulator"),
        ({"relief": {"kind": "direct"}}, "relief valve, direct"),
        ({"relief": {"place": "pipe_7"}}, "line 7: 1 m"),
        ({"check_valve": {"kind": "fitted"}}, "check"),
        ({"valve": {"kind": "servo"}}, "servo valve"),
        ({"accessory_a": {"kind": "counterbalance"}}, "counterbalance"),
        ({"accessory_b": {"kind": "pilot-check"}}, "pilot-operated check"),
        ({"actuator": {"kind": "motor"}}, "motor"),
        ({"cylinder": {"rod_at": "both"}}, "double rod"),
        ({"cylinder": {"rod_at": "b", "angle": -0.5 * math.pi}}, "rod down"),
        ({"load": {"kind": "lever"}}, "on a lever"),
        ({"return_end": {"kind": "orifice"}}, "orifice"),
        ({"pipe_3": values()["pipe_3"] | {"model": "none"}}, "3: manifold"),
    ],
)
def test_what_is_fitted_is_drawn(changed: dict[str, Any], said: str, plain: set[str]):
    assert said in words(**changed)
    assert said not in plain


def test_what_is_not_fitted_is_not_drawn():
    found = words(relief={"kind": "none"}, filter={"drop": 0.0})
    assert not [line for line in found if "relief" in line or line == "filter"]
