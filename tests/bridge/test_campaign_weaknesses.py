"""What a campaign found of our own controllers, docs/campaigns.md: each weakness is there, and one is mended."""

import pytest

import hydrotwin as ht
from tests.support.processes import ROOT

FOLDER = ROOT / "examples/campaigns"
REST = "controller.overlap_rest=1 %"


def travel(which: str, *changes: str) -> float:
    """Of the valve over a second of holding."""
    band = 'expect=["valve travel from 1.6 s to 2.6 s <= 1"]'
    run = ht.run(FOLDER / which, changes=["duration=2.6 s", "reference.at=0.1 s", band, *changes])
    return float(run.bands[0].found.split()[0])


@pytest.mark.parametrize(("which", "share"), [("pd.toml", 0.2), ("pid.toml", 0.5)])
def test_a_valve_that_jumps_never_rests_and_one_with_rest_does(which: str, share: float):
    """5 ways of the spool per second at rest, by noise alone; much less with a rest of 1 %, although the PID's integral
    still moves the piston in that second.
    """
    restless = travel(which)
    assert restless > 2.0
    assert travel(which, REST) < share * restless


def test_the_integral_winds_up_while_the_pump_stands_still():
    """By its usual tracking time the integral grows to the whole limit; with a shorter one, or clamped, it does not."""
    stop = 'timeline=[{set = "rig.pump.speed", at = "0.2 s", to = "0 rpm", lasts = "500 ms"}]'
    changes = ["duration=1.6 s", "reference.at=0.1 s", 'expect=["max error <= 1 m"]', stop]
    pd, pid = (ht.run(FOLDER / which, changes=changes).metrics for which in ("pd.toml", "pid.toml"))
    assert pid.overshoot > 0.15 > 0.02 > pd.overshoot
    for better in ("controller.tracking_time=0.3 s", "controller.anti_windup=clamping"):
        assert ht.run(FOLDER / "pid.toml", changes=[*changes, better]).metrics.overshoot < 0.5 * pid.overshoot


def test_one_wrong_reading_moves_the_piston():
    """10 ms of 50 mm too little: the valve opens wide for a sample."""
    glitch = 'timeline=[{set = "sensor.position.offset", at = "1 s", to = "-50 mm", lasts = "10 ms"}]'
    band = 'expect=["least error from 1 s to end >= -1 mm"]'
    changes = ["duration=1.3 s", "reference.at=0.1 s", band, glitch, REST]
    assert not ht.run(FOLDER / "pd.toml", changes=changes).bands[0].passed


def test_only_a_valve_that_jumps_can_rest():
    with pytest.raises(ht.ScenarioError, match="set compensate_overlap = true"):
        ht.load("step", ["controller.compensate_overlap=false", REST])
