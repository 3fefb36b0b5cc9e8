"""What is fitted: one table for words and pictures, which knows every kind that the rig's values can choose."""

import math

import pytest

from bridge.recording.shown import line_ends
from bridge.scenario.fitted import SLOTS, chamber_names, chamber_words, fitted, of_drive, rod_words
from bridge.scenario.in_force import KIND_READS, PIPE_READS, in_force
from bridge.scenario.text_picture import text_picture
from twin.rig import RIG, rig_words, values

OTHER_CHOICES = ("oil", "minor_losses", "amplifier")  # kinds of what has no slot


def drive(**changed):
    """The rig's values with others in place of some; sections that the rig does not have are added."""
    found = values()
    for section, entries in changed.items():
        found[section] = found.get(section, {}) | entries
    return found


def words(rig):
    """Slot -> what is fitted."""
    return {row.slot: row.words for row in fitted(rig)}


def test_every_kind_that_can_be_chosen_has_its_words():
    chosen = {
        f"{section}.kind": rig_words(section, "kind")
        for section, entries in RIG.items()
        if section not in OTHER_CHOICES
        if "kind" in entries
    }
    known = {slot.place: tuple(slot.kinds) for slot in SLOTS.values()}
    for place, options in chosen.items():
        assert set(options) <= set(known[place]), place
    sections = {
        section
        for slot in SLOTS.values()
        for kind in chosen.get(slot.place, ())
        for section in slot.kinds[kind].sections
    }
    assert sections <= set(RIG)


def test_names_that_only_some_kinds_read_are_the_rigs():
    for section, reads in KIND_READS.items():
        if section in RIG and "kind" in RIG[section]:
            assert set(reads) <= set(RIG[section]), section
            known = {*rig_words(section, "kind"), "none"}
            assert {kind for kinds in reads.values() for kind in kinds} <= known
    assert {"length", "friction"} <= set(PIPE_READS)


def test_the_thesis_rig_in_words_and_characters():
    found = words(values())
    assert found["supply"] == "gear pump"
    assert found["relief valve"] == "two-stage relief valve"
    assert found["actuator"] == "cylinder, rod down"
    assert found["lines"] == "1 to 6: waves, end to end"
    assert not {"accumulator", "accessory at A", "cushions", "check valve"} & set(found)
    picture = text_picture(values())
    for part in ("gear pump --1-->", "--filter--2-->", "- A --3-->", "lower chamber (rod side: it lifts) -- p2"):
        assert part in picture
    assert max(map(len, picture.splitlines())) <= 120


@pytest.mark.parametrize(
    ("changed", "slot", "said", "drawn"),
    [
        ({"supply": {"kind": "variable"}}, "supply", "variable pump, pressure-compensated", "variable pump --1-->"),
        ({"supply": {"kind": "pressure"}}, "supply", "constant pressure, with", "pressure source --1-->"),
        ({"accumulator": {"kind": "bladder", "at": "tee"}}, "accumulator", "at the tee", "p1, accumulator"),
        ({"accumulator": {"kind": "bladder", "at": "p"}}, "accumulator", "at port P", "  accumulator"),
        ({"relief": {"kind": "direct"}}, "relief valve", "direct-operated", "direct relief > tank"),
        ({"relief": {"place": "pipe_7"}}, "relief valve", "line of its own, pipe_7", "  7  "),
        ({"check_valve": {"kind": "fitted"}}, "check valve", "behind the filter", "--filter--check--2-->"),
        ({"valve": {"kind": "servo"}}, "directional valve", "servo valve, four lands", "| servo |"),
        (
            {"accessory_a": {"kind": "counterbalance"}},
            "accessory at A",
            "counterbalance valve",
            "--3--counterbalance-->",
        ),
        ({"accessory_b": {"kind": "pilot-check"}}, "accessory at B", "pilot-operated", "- B --4--pilot-check-->"),
        ({"cushion": {"kind": "spear"}}, "cushions", "cushioning spears", "~ lower chamber"),
        ({"load": {"kind": "compliant"}}, "load", "two masses", "two masses on the rod"),
        (
            {"return_end": {"kind": "check"}},
            "return end",
            "back-pressure check valve",
            "tank <-- orifice, check <--6--",
        ),
        ({"pipe_3": {"model": "none"}}, "lines", "3: no pipe, a manifold", "- A --(3)-->"),
        ({"pipe_4": {"model": "volume"}}, "lines", "4: volume without inertia", "- B --[4]-->"),
    ],
)
def test_what_is_fitted_is_said_and_drawn(changed, slot, said, drawn):
    rig = drive(**changed)
    assert said in words(rig)[slot]
    assert drawn in text_picture(rig)
    assert drawn not in text_picture(values())


def test_a_drive_without_a_relief_valve_has_none_in_its_picture():
    assert "relief" not in text_picture(drive(relief={"kind": "none"}))


@pytest.mark.parametrize(
    ("rod_at", "degrees", "rod", "lower", "name"),
    [
        ("a", 90.0, "rod down", "rod side: it lifts", "lower chamber"),
        ("b", 90.0, "rod up", "cap side: it lifts", "lower chamber"),
        ("b", -90.0, "rod down", "cap side: it lowers", "chamber A"),
        ("b", 0.0, "rod horizontal", "cap side: it extends the rod", "chamber A"),
        ("a", 0.0, "rod horizontal", "rod side: it retracts the rod", "chamber A"),
        ("b", 30.0, "rod up, 30 deg to the horizontal", "cap side: it lifts", "lower chamber"),
        ("both", 0.0, "double rod, horizontal", "rod side: it moves forward", "chamber A"),
        ("both", 90.0, "double rod, upright", "rod side: it lifts", "lower chamber"),
    ],
)
def test_words_of_the_cylinder_follow_its_rod_and_its_angle(rod_at, degrees, rod, lower, name):
    """Port A drives in the positive direction, whose angle is given; a rod in A points against it."""
    rig = drive(cylinder={"rod_at": rod_at, "angle": math.radians(degrees)})
    assert rod_words(rig) == rod
    assert chamber_words(rig)["lower"] == lower
    assert chamber_names(rig)["lower"] == name
    assert f"{name} ({lower})" in text_picture(rig)


def test_labels_of_signals_are_in_the_words_of_the_drive():
    labels = "p2 lower chamber", "to the upper chamber", "piston", "pump", "p1 relief valve"
    assert [of_drive(label, values()) for label in labels] == list(labels)
    press = drive(cylinder={"rod_at": "b", "angle": -0.5 * math.pi}, relief={"kind": "none"})
    assert [of_drive(label, press) for label in labels] == ["p2 chamber A", "to chamber B", "piston", "pump", "p1 tee"]
    motor = drive(actuator={"kind": "motor"}, supply={"kind": "pressure"})
    assert [of_drive(label, motor) for label in labels[2:4]] == ["shaft", "supply"]
    assert line_ends(press)[2] == ("port A", "chamber A, p2")


def test_a_motor_has_neither_rod_nor_cushions():
    rig = drive(actuator={"kind": "motor"}, motor={"angle": 0.0}, cushion={"kind": "spear"})
    assert words(rig)["actuator"] == "rotary motor, shaft"
    assert "cushions" not in words(rig)
    assert "rod" not in text_picture(rig)
    assert "motor.angle" in in_force(rig)
    assert "cylinder.bore" not in in_force(rig)
    assert "cylinder.stroke" in in_force(rig)


def test_numbers_of_another_kind_are_not_in_force():
    plain = in_force(values())
    assert {"relief.pilot_mass", "chatter.volume", "load.added", "pipe_3.young"} <= plain
    assert "relief.seat_length" not in plain
    direct = in_force(drive(relief={"kind": "direct"}, load={"kind": "lever"}, pipe_3={"model": "none"}))
    assert not {"relief.pilot_mass", "chatter.volume", "load.added", "pipe_3.young"} & direct
    assert {"relief.kind", "relief.place", "load.mass", "pipe_3.model"} <= direct
