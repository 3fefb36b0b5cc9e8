"""The balance of energy of a run with a fault of the plant in it: none comes from nowhere, none is lost unseen."""

from functools import cache

import numpy as np
import pytest

from bridge.runs.in_process import run_in_memory
from bridge.scenario import Scenario
from tests.bridge.test_plant_faults import RIG_KINDS
from tests.support.energy_book import Book, energy_of
from tests.support.faults import faulty, one

LUMPED = tuple(f"rig.pipe_{i}.model=lumped" for i in range(1, 7))
WAVES = tuple(f"rig.pipe_{i}.{what}" for i in range(1, 7) for what in ("model=ends", "friction=none"))
LACKING = 1e-5  # of all that came in, at 50 us: the scheme's error, order 2, and 1 where a land shuts or a cavity opens
OF_FIT = 1e-4  # the same with waves: lines of `ends` are fitted to 0.002 of a wave in the mean
SHORT = 0.15, 0.25, 0.3  # [s]: begin and end of a fault while the piston is on its way, and of the run
LONG = {("oil", "air"): (0.2, 0.5, 0.6)}  # where there is pressure that the oil's compliance makes energy of
NEEDED = {  # the entry without which the book of a fault would not close, and its sign
    ("oil", "air"): ("given", 1.0),
    ("load", "jump"): ("given", -1.0),
    ("load", "lost"): ("given", 1.0),
    ("load", "impact"): ("force", 1.0),
    ("pipe_3", "burst"): ("holes", 1.0),
    ("pipe_4", "burst"): ("holes", 1.0),
}


@cache
def book_of(target: str, kind: str, changes: tuple[str, ...], step: str = "50 us") -> Book:
    return energy_of(run_with(target, kind, (*changes, f"loop.step={step}")))


def run_with(target: str, kind: str, changes: tuple[str, ...]) -> Scenario:
    begin, end, duration = LONG.get((target, kind), SHORT)
    window = f'at="{begin} s", lasts="{end - begin:g} s"'
    return faulty(one(target, kind, RIG_KINDS[target, kind][0], window), changes=changes, duration=duration)


def lacking(book: Book, **signs: float) -> float:
    """The most that the book lacks at any instant, over all that has come in."""
    return float(np.abs(book.missing(**signs)).max()) / book.throughput


@pytest.mark.parametrize(("target", "kind"), RIG_KINDS, ids=lambda word: word)
def test_the_energy_of_a_fault_is_accounted_for(target: str, kind: str):
    """Within the error of the scheme, which halves at least with the step; three quarters leave room for the phase of
    an event within its step."""
    fine, coarse = (book_of(target, kind, LUMPED, step) for step in ("50 us", "100 us"))
    assert lacking(fine) < LACKING
    assert lacking(fine) < 0.75 * lacking(coarse)
    name, sign = NEEDED.get((target, kind), ("pump", 1.0))
    entries = {**fine.brought, **fine.lost, "given": fine.given}
    assert sign * entries[name][-1] > 100.0 * LACKING * fine.throughput


@pytest.mark.parametrize(("target", "kind"), RIG_KINDS, ids=lambda word: word)
def test_an_entry_of_the_other_sign_does_not_close_the_book(target: str, kind: str):
    book = book_of(target, kind, LUMPED)
    entries = {**book.brought, **book.lost, "given": book.given}
    counted = [name for name, entry in entries.items() if np.abs(entry).max() > LACKING * book.throughput]
    assert {"pump", "relief valve", "filter", "lands", "elbows", "lines", "density", "leak", "seal"} <= {*counted}
    for name in counted:
        assert lacking(book, **{name: -1.0}) > LACKING, name


@pytest.mark.parametrize(("target", "kind"), RIG_KINDS, ids=lambda word: word)
def test_only_what_changes_a_store_gives_energy_by_itself(target: str, kind: str):
    """A pump, a leak, a hole or a valve changes what flows from then on; at the instant itself nothing jumps."""
    given = book_of(target, kind, LUMPED).given
    assert (given[-1] != 0.0) == (NEEDED.get((target, kind), ("",))[0] == "given")


def test_a_mass_that_comes_brings_its_motion_and_its_height():
    """And takes them as it goes: (v^2/2 + g x) of 60 kg, at both instants."""
    begin, end, _ = SHORT
    book, half = book_of("load", "jump", LUMPED), round(0.5 * (begin + end) / 50e-6)
    state = run_in_memory(run_with("load", "jump", LUMPED)).columns("state")
    of = [
        60.0 * (0.5 * state["velocity"][k] ** 2 + 9.81 * state["position"][k])
        for k in (round(begin * 1e3), round(end * 1e3))
    ]
    assert book.given[half] == pytest.approx(of[0], rel=1e-12)
    assert book.given[-1] == pytest.approx(of[0] - of[1], rel=1e-9)


@pytest.mark.parametrize(
    ("target", "kind", "most"),
    [
        ("load", "impact", OF_FIT),
        ("pipe_3", "burst", OF_FIT),
        ("relief", "stuck-shut", OF_FIT),
        ("pump", "stop", 20 * OF_FIT),  # its fronts are jumps, of which a step's mean pressure times its mean flow errs
    ],
)
def test_the_waves_in_the_lines_are_in_the_book(target: str, kind: str, most: float):
    """A line without friction holds what has entered within its travel time."""
    assert lacking(book_of(target, kind, WAVES)) < most
