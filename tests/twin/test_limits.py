"""What each part of a circuit asks of the step: closed forms, and both sides of each limit."""

import math
import re

import numpy as np
import pytest

from tests.support.plant import (
    FRICTIONLESS,
    TIGHT,
    circuit,
    run,
)
from twin.circuit.equilibrium import equilibrium
from twin.circuit.limits import (
    Limit,
    limits,
    natural_frequency,
    oil_spring,
    stiffest_oil_spring,
    too_coarse,
)
from twin.circuit.step import Piston

A_LOWER, A_UPPER = math.pi / 4.0 * (50e-3**2 - 32e-3**2), math.pi / 4.0 * 50e-3**2
LOWER, UPPER, STROKE = 11.6e-6, 19.6e-6, 0.27
B_OIL = 1.0 / (1.0 / (878.0 * 1137.0**2) - 11e-3 / (2e-3 * 2.1e11))  # (2.8), from the wave speed in steel


def limit(what: str, **parts: dict) -> Limit:
    return next(found for found in limits(circuit(50e-6, **parts)) if found.what.startswith(what))


def spring(position: float) -> float:
    return B_OIL * (A_LOWER**2 / (LOWER + A_LOWER * position) + A_UPPER**2 / (UPPER + A_UPPER * (STROKE - position)))


@pytest.mark.parametrize("position", [0.0, 0.135, 0.27])
def test_oil_spring_and_frequency(position: float):
    """k = sum B A^2/V; with the line's oil to the shut valve A^2/(V/B + C), omega_h = sqrt(k/m)."""
    c = circuit()
    assert oil_spring(c, position) == pytest.approx(spring(position), rel=1e-9)
    v_l, v_u = LOWER + A_LOWER * position, UPPER + A_UPPER * (STROKE - position)
    k = A_LOWER**2 / (v_l / B_OIL + c.lines.capacity[2]) + A_UPPER**2 / (v_u / B_OIL + c.lines.capacity[3])
    assert natural_frequency(c, position) == pytest.approx(math.sqrt(k / 120.0), rel=1e-9)


def test_pipes_ask_for_an_eighth_of_their_travel_time():
    """l/a, a of steel as measured; of hose by 1/B = 1/B_oil + d/(delta E)."""
    hose = math.sqrt(1.0 / (1.0 / B_OIL + 11e-3 / (5e-3 * 1.09e9)) / 878.0)
    lengths, speeds = (1.0, 2.5, 2.0, 2.0, 2.0, 1.5), (1137.0, 1137.0, hose, hose, 1137.0, hose)
    found = [entry for entry in limits(circuit()) if entry.part.startswith("pipe")]
    assert [entry.part for entry in found] == [f"pipe_{i}" for i in range(1, 7)]
    for entry, length, speed in zip(found, lengths, speeds, strict=True):
        assert entry.time == pytest.approx(length / speed, rel=1e-6)
        assert entry.step == pytest.approx(length / speed / 8.0, rel=1e-6)


def test_load_pump_and_valves():
    """Half of 1/omega for what swings, a tenth of a tooth, half of the switching time."""
    load = limit("on the oil shut in")
    assert load.time == pytest.approx(math.sqrt(120.0 / max(spring(0.0), spring(STROKE))), rel=1e-9)
    assert load.step == pytest.approx(0.5 * load.time)
    buffer = limit("weight on its buffer", load={"added": 183.0})
    reduced = 120.0 * 183.0 / 303.0
    assert buffer.time == pytest.approx(math.sqrt(reduced / 183.0) * 3e-3 / math.pi, rel=1e-9)
    tooth = limit("period of a tooth")
    assert (tooth.time, tooth.step) == pytest.approx((60.0 / 1230.0 / 9.0, 6.0 / 1230.0 / 9.0))
    assert limit("spool").step == pytest.approx(0.5 / (2.0 * math.pi * 30.0))
    assert limit("switching time", valve={"kind": "switching"}).step == pytest.approx(15e-3)


def test_what_is_not_there_asks_for_nothing():
    plain = {entry.what for entry in limits(circuit(pump={"ripple": "none"}))}
    assert plain == {"wave travel time", "on the oil shut in, stiffest place", "spool"}
    assert "spool" not in {entry.what for entry in limits(circuit(valve={"kind": "switching"}))}


@pytest.mark.parametrize(
    ("what", "parts"),
    [
        ("wave", {"pipe_1": {"length": 0.5}}),
        ("on the oil", {"load": {"mass": 20.0}, "seal": FRICTIONLESS}),
        ("weight", {"load": {"added": 183.0, "contact_time": 0.4e-3}}),
        ("period", {"pump": {"teeth": 90.0}}),
        ("spool", {"valve": {"natural_frequency": 9e3}}),
        ("switching", {"valve": {"kind": "switching"}, "switching_valve": {"switching_time": 1e-4}}),
    ],
)
def test_too_coarse_on_both_sides_of_each_limit(what: str, parts: dict):
    """A hundredth below the limit nothing is said of it, a hundredth above it is."""
    at = limit(what, **parts).step
    for share, said in ((0.99, False), (1.0, False), (1.01, True)):
        coarse = [entry.what for entry in too_coarse(circuit(share * at, **parts))]
        assert any(entry.startswith(what) for entry in coarse) is said


def test_the_rig_is_within_all_limits_at_its_step_and_not_at_four_times_of_it():
    assert not too_coarse(circuit(50e-6))
    assert {entry.part for entry in too_coarse(circuit(200e-6))} >= {"pipe_1"}


def test_a_load_at_its_least_mass_stays_bounded_and_a_lighter_one_is_refused():
    """m >= k h^2: the leapfrog's omega h = 2 is four times that mass away, so a push at the stiffest place dies."""
    least = stiffest_oil_spring(circuit()) * 50e-6**2
    with pytest.raises(ValueError, match=rf"swings too fast on the oil.*at least {least:.3g} kg.*smaller loop\.step"):
        circuit(seal=FRICTIONLESS, load={"mass": 0.99 * least})
    c = circuit(seal=FRICTIONLESS, cylinder=TIGHT, pump={"ripple": "none"}, load={"mass": 1.01 * least})
    end = run(equilibrium(c, 1e-3).with_core(piston=Piston(1e-3, 1e-3)), 0.0, c, 0.5)
    assert abs(end.piston.velocity) < 1e-3
    assert np.isfinite(end.ends.pressure).all()


def test_a_seal_that_falls_faster_than_inertia_holds_is_refused():
    with pytest.raises(ValueError, match=r"load\.mass 1\.0 kg is too light for the seal's friction.*seal\.limit = 0"):
        circuit(load={"mass": 1.0})
    assert circuit(load={"mass": 1.0}, seal=FRICTIONLESS)


def test_a_contact_shorter_than_the_step_bears_is_refused_on_both_sides():
    """k h^2 <= m m'/(m + m'), k = m' (pi/t)^2: t >= pi h sqrt(1 + m'/m)."""
    least = math.pi * 50e-6 * math.sqrt(1.0 + 183.0 / 120.0)
    with pytest.raises(ValueError, match=rf"load\.contact_time .* at least {re.escape(f'{least:.3g}')} s"):
        circuit(load={"added": 183.0, "contact_time": 0.99 * least})
    assert circuit(load={"added": 183.0, "contact_time": 1.01 * least})


@pytest.mark.parametrize(("model", "steps"), [("ends", 3.5), ("nodes", 3.0), ("lumped", 1.0)])
def test_a_pipe_too_short_is_refused_by_its_name(model: str, steps: float):
    """On both sides of what each model needs, with the way out."""
    length = steps * 50e-6 * 1137.0
    with pytest.raises(ValueError, match=r"^pipe_2, 0\.\d+ m: .*; take a smaller loop\.step, a longer pipe"):
        circuit(pipe_2={"length": 0.99 * length, "model": model})
    assert circuit(pipe_2={"length": 1.01 * length, "model": model})
