"""Plants that did not see each other when they started: the one of the lowest process id stays."""

import os

import pytest

from bridge.errors import RunError
from bridge.machine.priority import Priority
from bridge.processes.plant import PlantOptions, run_plant
from bridge.scenario import load
from bridge.wire.bus import Bus
from bridge.wire.link import Link, free_endpoint
from bridge.wire.messages import Mode


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
