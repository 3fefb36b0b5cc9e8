"""A plant's start: of two that did not see each other one stays; the clock starts with the first answer."""

import os
import time
from typing import Any

import pytest

from bridge.errors import RunError
from bridge.machine.priority import Priority
from bridge.processes.plant import PlantOptions, run_plant
from bridge.scenario import load
from bridge.wire.bus import Bus
from bridge.wire.codec import ValveCommand, decode
from bridge.wire.link import Link, free_endpoint
from bridge.wire.messages import Mode, Outgoing


@pytest.fixture
def unseen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Bus, "others", lambda *_: [])
    monkeypatch.setattr(os, "getpid", lambda: 1000)


@pytest.mark.usefixtures("unseen")
@pytest.mark.parametrize(("pid", "stays"), [(999, False), (1001, True)])
def test_of_two_plants_that_start_at_one_instant_one_stays(pid: int, stays: bool):
    endpoint = free_endpoint()
    with Bus(Link(endpoint, None, None, 10.0), "rig", "witness", blocking=False) as other:
        other._declared.append(other.session.liveliness().declare_token(f"rig/alive/plant/{pid}"))
        link, scenario = Link(None, endpoint, None, 10.0), load("step", ["duration=0.3"])
        options = PlantOptions(Mode.REALTIME, 1.0, Priority.ORDINARY, 1, (), 10.0, quiet=True)
        if stays:
            assert run_plant(scenario, link, options).status.tick == 300
        else:
            with pytest.raises(RunError, match=rf"has a plant already \(process {pid}\)"):
                run_plant(scenario, link, options)


class SlowAtFirst:
    """A controller whose first answer takes longer, as code does that compiles when it is first called."""

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self.sent = 0
        bus.subscribe("measurement", self._answer)
        bus.announce()

    def _answer(self, sample: Any) -> None:
        measured = decode(sample.payload.to_bytes(), "measurement")
        if measured.tick % 10:
            return
        time.sleep(0.0 if self.sent else 0.6)
        stamp, number = measured.stamp, measured.tick // 10
        command = ValveCommand(
            run_id=1, source=1, sequence=number, sample_stamp=stamp, apply_at=stamp + 5_000_000, spool=0.1
        )
        self._bus.publish(Outgoing("command", stamp, number, command))
        self.sent += 1


@pytest.mark.timed
def test_the_clock_starts_once_the_controller_has_answered(monkeypatch: pytest.MonkeyPatch):
    """Its first answer takes longer than the plant has patience with a controller that was there: 0.3 s."""
    monkeypatch.setattr("bridge.processes.plant.LINGER", 0.0)
    endpoint = free_endpoint()
    scenario = load("step", ["duration=0.35", "loop.command_timeout=0.3"])
    with Bus(Link(endpoint, None, None, 10.0), "rig", "controller", blocking=False) as other:
        law = SlowAtFirst(other)
        options = PlantOptions(Mode.REALTIME, 1.0, Priority.ORDINARY, 1, ("controller",), 10.0, quiet=True)
        status = run_plant(scenario, Link(None, endpoint, None, 10.0), options).status
    assert (status.tick, status.safe_states) == (350, 0)
    assert law.sent > 1
