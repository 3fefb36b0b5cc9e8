"""Faults of the valve: each is there in its window alone, and is what its name says."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from bridge.loop.fault_chance import Luck
from bridge.runs.in_process import run_in_memory
from bridge.scenario.fault_kinds import VALVE
from tests.support.faults import BEGIN, END, faulty, one
from twin.sensors import put_out

VALVE_KINDS: dict[str, tuple[str, Callable[[float], float]]] = {
    "dead-band": ("width=0.2", lambda r: math.copysign(max(0.0, abs(r) - 0.2), r)),
    "bias": ("size=0.05", lambda r: min(1.0, r + 0.05)),
    "saturated": ("limit=0.3", lambda r: min(0.3, max(-0.3, r))),
    "power-loss": ("", lambda r: 0.0),
    "reversed": ("", lambda r: -r),
}
OF_SPOOL = ("stuck", "slow", "contaminated")


@pytest.mark.parametrize("kind", VALVE_KINDS)
def test_a_faulty_valve_makes_of_a_command_what_its_kind_says(kind: str):
    """Tick by tick against the command in force; outside the window the spool is after the command itself."""
    sizes, makes = VALVE_KINDS[kind]
    run = run_in_memory(faulty(one("valve", kind, sizes)))
    seen = run.columns("state")["reference"]
    commands = {command.apply_at // 1_000_000: command.spool for command in run.messages("command")}
    given, changed = 0.0, 0
    for tick in range(1, len(seen)):
        given = commands.get(tick - 1, given)
        out = put_out(given, 12.0)
        inside = round(1e3 * BEGIN) < tick <= round(1e3 * END)
        assert seen[tick] == (makes(out) if inside else out), tick
        changed += inside and seen[tick] != out
    assert changed > 100


def test_hysteresis_is_play_between_command_and_spool():
    """The spool's reference moves once the command has crossed the play, and stays half of it behind."""
    made = faulty(one("valve", "hysteresis", "width=0.1", "at=0.0"), changes=("daq.quantise_output=false",))
    run = run_in_memory(made)
    seen = run.columns("state")["reference"]
    commands = {command.apply_at // 1_000_000: command.spool for command in run.messages("command")}
    given = last = 0.0
    for tick in range(1, len(seen)):
        given = commands.get(tick - 1, given)
        last = min(max(last, given - 0.05), given + 0.05)
        assert seen[tick] == last


def test_a_stuck_spool_stays_a_slow_one_lags_and_a_dirty_one_sticks_in_spells():
    """Slow: a fifth of the rate of 50 travels a second. The spells are those that the seed draws."""
    spool = {kind: run_in_memory(faulty(one("valve", kind))).columns("state")["spool"] for kind in OF_SPOOL}
    healthy = run_in_memory(faulty()).columns("state")["spool"]
    t = np.arange(len(healthy)) * 1e-3
    inside = (t > BEGIN + 1e-6) & (t < END + 1e-6)
    for moves in spool.values():
        assert (moves[t < BEGIN + 1e-6] == healthy[t < BEGIN + 1e-6]).all()
    assert np.ptp(spool["stuck"][inside]) < 1e-9
    most = np.abs(np.diff(spool["slow"][inside])).max()
    assert 0.005 < most <= 0.2 * 50.0 * 1e-3 + 1e-12
    for begin, end in Luck(1, "valve contaminated").spells(0, 0.2, 20e-3, END - BEGIN):
        still = spool["contaminated"][(t > BEGIN + begin) & (t < BEGIN + end)]
        assert len(still) == 0 or np.ptp(still) < 1e-9
    assert np.ptp(spool["contaminated"][inside]) > 0.1


def test_every_kind_of_valve_fault_has_its_test():
    assert {*VALVE_KINDS, *OF_SPOOL, "hysteresis"} == {*VALVE}
