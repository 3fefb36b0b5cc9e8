"""The reduced drive under a sampled law: what it keeps of the circuit and of the laws, and what a step of it leaves."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from controller.law import Gains, pd
from controller.pid import PidGains, pid
from controller.reference import Target
from controller.stability.amplitude.drive import pace_of
from controller.stability.amplitude.edges import SCAN, Edge, lasting, smallest_swinging, spanned
from controller.stability.amplitude.linear_law import pd_law, with_integral
from controller.stability.amplitude.reduce import at_rest, reduced
from controller.stability.amplitude.run import Card, Course, run_asking, run_linear
from controller.stability.amplitude.swing import Swing, last_third
from twin.circuit.build import build
from twin.circuit.kinds import of_kind
from twin.circuit.linear import moving_point
from twin.load_at_rest import held_force
from twin.rig import values
from twin.seal import Seal
from twin.spool_valve import SpoolValve

EXACT = Card(0.0, 0.0, 0.0, 0.0)
CIRCUIT = build(values(), 50e-6)
DRIVE = reduced(CIRCUIT)
START = at_rest(DRIVE, CIRCUIT, 0.1, 0.0)
WHEN = Course(0.01, 0.0137, 0.1, 1.0)


def asking(law, own):
    memory = None

    def decide(sample, target):
        nonlocal memory
        spool, memory = law(sample, Target(target, 0.0), memory, own)
        return spool

    return decide


@pytest.mark.parametrize("zeta", [0.3, 1.0, 1.7])
def test_the_spool_moves_by_its_exact_matrix(zeta: float):
    valve = of_kind(DRIVE.valve, SpoolValve)._replace(damping=zeta)
    omega = valve.natural_frequency
    exact = expm(3e-4 * np.array([[0.0, 1.0], [-(omega**2), -2.0 * zeta * omega]]))
    assert np.array(pace_of(valve, 3e-4)[1:]).reshape(2, 2) == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize(
    ("source", "rest"), [("measured", 0.0), ("backward", 0.0), ("filtered", 0.0), ("filtered", 0.3)]
)
def test_a_linear_law_moves_the_drive_as_the_law_itself(source: str, rest: float):
    own = Gains(60.0, 0.4, source, 0.02, WHEN.period, 0.9, 0.1, rest)
    law = pd_law(60.0, 0.4, source, 0.02, WHEN.period, 0.9, 0.1, rest)
    _, found = run_linear(DRIVE, START, law, 0.05, WHEN, EXACT, 1)
    _, asked = run_asking(DRIVE, START, asking(pd, own), 0.05, WHEN, EXACT, 1)
    assert np.ptp(found) > 0.04
    assert found == pytest.approx(asked, abs=1e-9)


@pytest.mark.parametrize("anti_windup", ["back-calculation", "clamping", "none"])
def test_a_pid_keeps_its_integral_as_the_law_itself(anti_windup: str):
    own = PidGains(60.0, 90.0, 0.2, 0.0, "filtered", 0.02, WHEN.period, 0.5, 0.1, anti_windup, 0.05)
    back = WHEN.period / 0.05 if anti_windup == "back-calculation" else 0.0
    law = pd_law(60.0, 0.2, "filtered", 0.02, WHEN.period, 0.5, 0.1)
    law = with_integral(law, 90.0 * WHEN.period, back, anti_windup == "clamping")
    _, found = run_linear(DRIVE, START, law, 0.1, WHEN, EXACT, 1)
    _, asked = run_asking(DRIVE, START, asking(pid, own), 0.1, WHEN, EXACT, 1)
    assert found == pytest.approx(asked, abs=1e-9)


@pytest.mark.parametrize("spool", [0.3, -0.25])
def test_the_drive_moves_as_fast_as_the_circuit(spool: float):
    """Steady speed at a constant opening, without friction: within 3 % of the circuit's balance of flows."""
    free = DRIVE._replace(seal=DRIVE.seal._replace(limit=0.0))
    when = Course(0.01, 0.0, 0.0, 0.6)
    time, position = run_asking(free, at_rest(free, CIRCUIT, 0.135, 0.0), lambda *_: spool, 0.0, when, EXACT, 1)
    late = (time > 0.3) & (time < 0.5)
    speed = np.polyfit(time[late], position[late], 1)[0]
    assert speed == pytest.approx(moving_point(CIRCUIT, 0.135, spool).piston.velocity, rel=0.03)


def test_a_delay_of_whole_periods_shifts_the_motion_and_nothing_else():
    """And a delay of a part of one by that part, to the order of the step."""
    runs = [
        run_asking(DRIVE, START, lambda sample, _: 0.4 * (sample.stamp_ns >= 10**8), 0.0, when, EXACT, 1)
        for when in (Course(0.01, 0.0, 0.0, 0.4), Course(0.01, 0.02, 0.0, 0.4), Course(0.01, 0.005, 0.0, 0.4))
    ]
    at = np.linspace(0.12, 0.35, 50)
    first, second, third = (np.interp(at + late, *run) for run, late in zip(runs, (0.0, 0.02, 0.005), strict=True))
    assert second == pytest.approx(first, abs=2e-5)
    assert third == pytest.approx(first, abs=2e-5)


def test_friction_holds_what_it_can():
    """A push below the seal's limit does not move the piston by a bit; one above it does."""
    p_lower = held_force(DRIVE.load, 0.1) / DRIVE.cylinder.area_lower
    seal = of_kind(DRIVE.seal, Seal)
    most = seal.limit * p_lower * seal.width * seal.perimeter
    for share, moves in ((0.9, False), (1.1, True)):
        pushed = DRIVE._replace(
            load=DRIVE.load._replace(force=DRIVE.load.force + share * most),
            cylinder=DRIVE.cylinder._replace(leakage=0.0),
        )
        _, position = run_asking(pushed, START, lambda *_: 0.0, 0.0, Course(0.01, 0.0, 0.0, 0.2), EXACT, 1)
        assert bool(np.ptp(position) > 0.0) is moves


def test_a_swing_is_told_by_its_last_third():
    time = np.linspace(0.0, 30.0, 9001)
    grown = last_third(time, 1e-3 * np.minimum(time / 20.0, 1.0) * np.sin(2.0 * math.pi * 3.3 * time) + 1e-3 * time)
    assert grown.frequency == pytest.approx(3.3, rel=2e-3)
    decayed = last_third(time, 1e-2 * np.exp(-time) * np.sin(20.0 * time))
    assert not decayed.counts
    slip_and_back = np.where((time > 25.0) & (time < 28.0), 1e-3, 0.0)
    assert last_third(time, slip_and_back) == (pytest.approx(1e-3), 0.0)  # it has no frequency


def test_a_position_that_is_on_its_way_does_not_swing():
    """However far it still goes; with a swing of its own on top it does."""
    time = np.linspace(0.0, 30.0, 9001)
    way = 1e-2 * (1.0 - np.exp(-time / 30.0))
    assert not last_third(time, way).counts
    assert not last_third(time, -way).counts
    assert last_third(time, way + 5e-4 * np.sin(2.0 * math.pi * 3.0 * time)).counts


def test_the_edges_of_several_noises_give_an_interval():
    """Mean and standard deviation of the logarithm; one noise without an edge does not count, two do."""
    found = spanned(2e-3, [Edge(0.9 * g, g, 3.0 + g, 1e-3) for g in (1.0, 2.0, 4.0)])
    reach = 1.05 * 2.0**1.3
    assert (found.low, found.high) == pytest.approx((2.0 / reach, 2.0 * reach))
    assert found.frequency == 5.0
    never = Edge(9.0, math.inf, 0.0, 0.0)
    assert math.isfinite(spanned(2e-3, [Edge(1.0, 1.1, 3.0, 1e-3), never]).high)
    assert math.isinf(spanned(2e-3, [Edge(1.0, 1.1, 3.0, 1e-3), never, never]).high)
    assert math.isinf(spanned(2e-3, [never]).low)


def test_the_smallest_gain_that_swings_is_found_among_louder_ones_that_settle():
    """Swings between 1.0 and 1.2, and again from 3 on: a search by 5 % meets the first range, by 25 % maybe not."""

    def swings_at(gain: float) -> Swing:
        return Swing(1e-3 if 1.0 <= gain <= 1.2 or gain >= 3.0 else 0.0, 2.0)

    for first in (0.1, 0.5, 1.1):
        found = smallest_swinging(swings_at, first, SCAN)
        assert found.settles < 1.0 <= found.swings < 1.02 * found.settles


@pytest.mark.parametrize("first", [0.0, math.inf, math.nan])
def test_a_search_that_cannot_end_is_refused(first: float):
    with pytest.raises(ValueError, match="starts from a finite gain above 0"):
        smallest_swinging(lambda _: Swing(0.0, 0.0), first, SCAN)


def test_runs_last_long_enough():
    assert [lasting(*times) for times in ((0.01, 0.0), (0.5, 0.0), (0.01, 5.0))] == pytest.approx([20.0, 100.0, 50.0])
    with pytest.raises(ValueError, match="beyond the theory"):
        lasting(60.0, 0.0)


@pytest.mark.parametrize(
    ("part", "kind", "said"),
    [
        ("valve", "servo", r"no servo valve: take valve\.kind = 'proportional'"),
        ("load", "compliant", r"one mass: take load\.kind = 'environment'"),
        ("friction", "lugre", r"no bristles: take friction\.kind = 'stribeck'"),
    ],
)
def test_what_the_reduced_drive_leaves_out_is_refused(part: str, kind: str, said: str):
    with pytest.raises(ValueError, match=said):
        reduced(build(values({part: {"kind": kind}}), 50e-6))
