"""The rig in 3-D follows what is fitted: where the cylinder lies, how the motor turns, what hangs on it."""

import math
from typing import Any

import numpy as np
import pytest

from bridge.recording.frames import Frames
from bridge.view.rig.axis import PISTON, plates
from bridge.view.rig.extras import lever_strips, oil_share, spring_strips
from bridge.view.rig.eyes import EYES, eyes_of
from bridge.view.rig.motion import move
from bridge.view.rig.scene import stand
from bridge.view.rig.stage import Stage, stage
from twin.rig import values
from twin.topology import HOLLOWS, LINES, OBSERVED, POINTS

BLADDER = {"kind": "bladder", "at": "p", "precharge": 1e5, "exponent": 1.4}
POSITIONS = np.array([0.0, 0.1, 0.27])


def scene(**changed: dict[str, Any]) -> Stage:
    """The stage of the rig with others of its values; sections that it does not have are added."""
    found = values()
    for section, entries in changed.items():
        found[section] = found.get(section, {}) | entries
    return stage(found)


class Drawn:
    """A stream that keeps what it is sent."""

    def __init__(self) -> None:
        self.names: set[str] = set()
        self.columns: dict[str, Any] = {}
        self.words: list[str] = []

    def log(self, entity: str, archetype: Any, static: bool = False) -> None:
        self.names.add(entity)
        if entity == "rig/labels":
            self.words = archetype.labels.as_arrow_array().to_pylist()

    def send_columns(self, entity: str, time: Any, columns: Any) -> None:
        self.names.add(entity)
        self.columns[entity] = {column.descriptor.component: column.as_arrow_array().to_pylist() for column in columns}


def drawn(where: Stage) -> Drawn:
    """All that is drawn of a run of three instants."""
    pytest.importorskip("rerun")
    count = len(POSITIONS)
    state = {name: np.full(count, 50e5 if unit == "Pa" else 0.0) for name, unit in OBSERVED.items()}
    state |= {"position": POSITIONS}
    shown = Frames(np.arange(count) * 10**7, state, np.zeros((count, LINES, POINTS)), np.zeros((count, len(HOLLOWS))))
    found = Drawn()
    stand(found, where)
    move(found, where, shown)
    return found


@pytest.mark.parametrize("rod_at", ["a", "b", "both"])
@pytest.mark.parametrize("degrees", [90.0, 30.0, 0.0, -90.0])
def test_the_axis_has_its_angle_and_all_bodies_are_above_the_floor(rod_at: str, degrees: float):
    where = scene(cylinder={"rod_at": rod_at, "angle": math.radians(degrees)})
    axis = where.axis
    assert np.linalg.norm(axis.along) == pytest.approx(1.0)
    assert axis.along @ axis.normal == pytest.approx(0.0, abs=1e-12)
    assert math.degrees(math.asin(axis.along[2])) == pytest.approx(degrees, abs=1e-6)
    places = [0.0, where.stroke + PISTON, axis.outer_face, axis.outer_face + where.stroke]
    assert axis.at(places)[:, 2].min() > 0.1
    assert axis.at(places)[:, 0].max() < 0.6  # left of the valve
    assert axis.side == (-1 if rod_at == "a" else 1)
    assert len(axis.rods) == (2 if rod_at == "both" else 1)


@pytest.mark.parametrize("mass", [20.0, 120.0, 5000.0])
def test_plates_have_their_mass_and_heavy_ones_are_as_wide_as_high(mass: float):
    side, height = plates(mass)
    assert 7850.0 * side**2 * height == pytest.approx(mass)
    assert height <= side * (1.0 + 1e-9)


def test_the_rig_of_the_thesis_is_seen_from_where_it_was():
    assert eyes_of(scene()) == EYES


def test_a_motor_is_seen_from_as_near_however_far_its_arc_goes():
    """The stroke of a motor is the range of its arc: 40 m are some turns of the drum, not a long cylinder."""
    where = scene(actuator={"kind": "motor"}, cylinder={"stroke": 40.0})
    for position, target in eyes_of(where).values():
        assert np.linalg.norm(np.subtract(position, target)) < 3.0


def test_oil_in_the_bottle_follows_the_polytrope():
    """Gas of 90 bar takes 1/2 of its volume at (91 bar abs) 2^1.4; below the precharge the bottle has no oil."""
    where = scene(accumulator={"kind": "bladder", "at": "tee", "precharge": 90e5, "exponent": 1.4})
    pressures = np.array([50e5, 90e5, 91e5 * 2.0**1.4 - 1e5])
    assert oil_share(where, pressures) == pytest.approx([0.0, 0.0, 0.5], abs=1e-12)


def test_a_spring_reaches_from_the_load_to_a_wall_that_stands_still():
    for rod_at in ("a", "b"):
        where = scene(cylinder={"rod_at": rod_at}, load={"kind": "environment", "stiffness": 1e6})
        strips = spring_strips(where, POSITIONS)
        ends = np.array([strip[0] for strip in strips])
        assert ends == pytest.approx(where.axis.at(where.axis.outer_face + POSITIONS))
        assert np.array([strip[-1] for strip in strips]) == pytest.approx(np.array([strips[0][-1]] * 3))


def test_the_arm_of_a_lever_turns_about_its_pivot_over_the_end_of_the_rod():
    where = scene(cylinder={"rod_at": "b"}, load={"kind": "lever"})
    strips = lever_strips(where, POSITIONS)
    assert np.array([strip[0] for strip in strips]) == pytest.approx(np.array([strips[0][0]] * 3))
    rod = where.axis.at(PISTON + where.axis.rod_length + POSITIONS)
    for strip, end in zip(strips, rod, strict=True):
        arm, to_rod = strip[1] - strip[0], end - strip[0]
        assert np.cross(arm, to_rod) == pytest.approx(np.zeros(3), abs=1e-12)


def test_the_piston_moves_along_its_axis():
    found = drawn(scene(cylinder={"rod_at": "b", "angle": 0.0}))
    moved = np.array(found.columns["rig/piston"]["Transform3D:translation"]).reshape(-1, 3)
    assert moved == pytest.approx(np.outer(POSITIONS, [-1.0, 0.0, 0.0]), abs=1e-6)


def test_a_motor_is_a_drum_that_turns_by_the_arc_over_its_radius():
    found = drawn(scene(actuator={"kind": "motor"}, motor={"radius": 0.1, "angle": 0.0}))
    turned = np.array(found.columns["rig/piston"]["Transform3D:quaternion"]).reshape(-1, 4)
    assert 2.0 * np.arctan2(turned[:, 1], turned[:, 3]) == pytest.approx(POSITIONS / 0.1, abs=1e-6)
    assert {"rig/piston/drum", "rig/piston/mark"} <= found.names
    assert not [name for name in found.names if name.startswith(("rig/cylinder", "rig/piston/metal"))]


def test_the_rig_of_the_thesis_has_nothing_beside_its_own():
    found = drawn(scene())
    further = ("rig/accumulator", "rig/accessories", "rig/spring", "rig/lever", "rig/piston/second")
    assert not [name for name in found.names if name.startswith(further)]
    assert {"rig/valves/relief_spool", "rig/piston/load", "rig/cylinder/barrel"} <= found.names
    assert {"pump", "valve, travel enlarged", "relief valve, lifts x100", "1: steel, 1.35 m"} <= set(found.words)


@pytest.mark.parametrize(
    ("changed", "entity", "word"),
    [
        ({"accumulator": BLADDER}, "rig/accumulator/oil", "accumulator"),
        ({"accessory_a": {"kind": "counterbalance"}}, "rig/accessories/lower", "A: counterbalance"),
        ({"accessory_b": {"kind": "throttle"}}, "rig/accessories/upper", "B: throttle"),
        ({"load": {"kind": "compliant", "far_mass": 50.0, "stiffness": 0.0}}, "rig/piston/second", "two masses"),
        ({"load": {"kind": "environment", "stiffness": 1e5}}, "rig/spring", "load in springs"),
        ({"load": {"kind": "lever", "stiffness": 0.0}}, "rig/lever", "lever"),
        ({"supply": {"kind": "pressure"}}, "rig/pump", "pressure source"),
        ({"valve": {"kind": "servo"}}, "rig/valves/spool", "servo valve"),
        ({"pipe_3": {"model": "none"}}, "rig/pipes", "3: manifold"),
    ],
)
def test_what_is_fitted_is_drawn_and_named(changed: dict[str, Any], entity: str, word: str):
    found = drawn(scene(**changed))
    assert entity in found.names
    assert [words for words in found.words if words.startswith(word)]


def test_a_drive_without_a_relief_valve_has_no_body_of_one():
    found = drawn(scene(relief={"kind": "none"}))
    assert not [name for name in found.names if "relief" in name or "pilot" in name or "spill" in name]
