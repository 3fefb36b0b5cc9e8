"""Queries for numbers that may change, and targets of a live reference: what is taken, and what is refused."""

import pytest

from bridge.errors import UsageError
from bridge.loop.live_reference import Aim, LiveReference
from bridge.processes.parameters import asked_for, described, target_of
from bridge.scenario import load
from bridge.scenario.references import Live
from bridge.scenario.tunable import tunables
from controller.grid import NS


@pytest.mark.parametrize(
    ("payload", "said"),
    [
        (b"", "not JSON"),
        (b"[1]", 'send {"set"'),
        (b'{"set": {}}', 'send {"set"'),
        (b'{"set": {"controller.gian": 1}}', "did you mean 'controller.gain'"),
        (b'{"set": {"controller.gain": "1 bar"}}', "unit 'bar' does not fit"),
        (b'{"set": {"controller.gain": NaN}}', "not a finite gain"),
        (b'{"set": {"rig.load.force": NaN}}', "not a number"),
        (b'{"set": {"controller.gain": [1]}}', "give a number"),
        (b'{"set": {"reference": 0.1}, "over": "-1 s"}', "over = '-1 s': from 0"),
        (b"[" * 3000, "not JSON"),
        (b" " * 70_000, "a query of 70000 bytes; at most 64000"),
    ],
)
def test_a_query_that_is_none_is_refused_in_one_line(payload: bytes, said: str):
    with pytest.raises(UsageError) as refused:
        asked_for(payload, load("step"))
    assert said in str(refused.value)


def test_a_query_for_an_unknown_number_is_refused():
    values = {name: (entry, entry.value) for name, entry in tunables(load("step")).items()}
    assert [p["name"] for p in described(values, b'["reference"]')["parameters"]] == ["reference"]
    assert len(described(values, b"")["parameters"]) == len(values)
    with pytest.raises(UsageError, match="'p9' is not a number that can change"):
        described(values, b'["p9"]')
    with pytest.raises(ValueError, match="not a finite number"):
        target_of(b"1e999 m")


def test_a_live_reference_goes_at_its_rate_within_its_limits_and_stays_when_nobody_speaks():
    """From 100 mm to 300 mm wanted, 200 mm allowed: half a second at 0.2 m/s; silence after 0.1 s."""
    live = LiveReference(Live(kind="live", value=0.1, rate=0.2, low=0.05, high=0.2, timeout=0.1))
    assert live.aim(None, 0, 0.1) is None
    assert live.aim(0.3, NS, 0.1) == Aim(0.2, NS // 2)
    assert live.aim(0.25, NS + NS // 20, 0.11) is None
    assert live.aim(None, NS + NS // 10, 0.12) is None
    assert live.aim(None, NS + NS // 5, 0.14) == Aim(0.14, 0)
    assert live.aim(None, 2 * NS, 0.14) is None
    assert live.aim(0.04, 3 * NS, 0.14) == Aim(0.05, 450_000_000)
