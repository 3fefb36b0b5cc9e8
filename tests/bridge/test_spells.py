"""Spells of faults are found in their time and in the order of the scenario, however many there are."""

import numpy as np

from bridge.loop.fault_clock import Spell
from bridge.loop.spells import Spells
from bridge.scenario.faults import planned
from tests.support.faults import faulty, one

MANY = 5000


def test_those_that_are_there_are_those_whose_time_it_is_in_the_order_of_the_scenario():
    """Random spells of two faults, asked for at rising instants, against a look at all."""
    first, second = planned(faulty(one("sensor.p2", "off"), one("sensor.p3", "off")))
    source = np.random.default_rng(1)
    begins, lengths = source.integers(0, 10_000, MANY), source.integers(1, 30, MANY)
    spells = [
        Spell((first, second)[k % 2], int(b), int(b + n), k)
        for k, (b, n) in enumerate(zip(begins, lengths, strict=True))
    ]
    found: Spells[int] = Spells()
    for spell in spells:
        found.add(spell, spell.number)
    looked_at = 0
    for now in range(0, 10_050, 7):
        there = [spell for spell, _ in found.there(now)]
        looked_at += len(found.near(now))
        assert {spell.number for spell in there} == {s.number for s in spells if s.begin <= now < s.end}
        assert [spell.fault.number for spell in there] == sorted(spell.fault.number for spell in there)
        later = [instant for s in spells for instant in (s.begin, s.end) if instant > now]
        assert found.next(now) == min(later, default=None)
    assert looked_at < 0.01 * MANY * (10_050 // 7)


def test_an_early_one_is_near_before_it_begins_and_an_ended_one_stays_as_long_as_it_is_asked_for():
    (fault,) = planned(faulty(one("sensor.p2", "delay")))
    found: Spells[str] = Spells(back=10)
    found.add(Spell(fault, 100, 200, 0), "delay", early=True)
    assert [does for _, does in found.near(0)] == ["delay"]
    assert list(found.there(99)) == []
    assert [does for _, does in found.there(205)] == []
    assert [does for _, does in found.there(199)] == ["delay"]
    assert found.near(210) == []
