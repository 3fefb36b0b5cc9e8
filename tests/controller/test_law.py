"""Control laws against formulas worked by hand, and the symmetries that every law must have."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.law import (
    Gains,
    Memory,
    OpenLoopGains,
    RelayGains,
    Sample,
    compensate,
    open_loop,
    pd,
    per_metre,
    relay,
    saturate,
    velocity,
    volts_per_percent,
)
from controller.laws import LAWS
from controller.pid import PidGains, pid
from controller.reference import Target
from controller.state_space import StateSpaceGains, state_space

T = 0.01
GAINS = Gains(10.0, 0.5, "measured", filter_time=0.04, sample_period=T, limit=1.0, overlap=0.0)
PID = PidGains(10.0, 3.0, 0.5, 0.2, "measured", 0.04, T, 1.0, 0.0, "back-calculation", 0.5)
RELAY = RelayGains(0.05, "measured", filter_time=0.04, sample_period=T, limit=1.0)  # switches where GAINS would
LEAD = StateSpaceGains(((0.8,),), ((0.2, 0.0),), (8.0,), (25.0, -0.1), ("error", "velocity"), 0.01, 1.0, 0.0)
NUMBERS: dict[str, Any] = {
    "pd": GAINS,
    "pid": PID,
    "relay": RELAY,
    "open-loop": OpenLoopGains(1.0),
    "state-space": LEAD,
}
UNIT = st.floats(-1.0, 1.0)
OVERLAP = st.floats(0.0, 0.9)


def sample(position: float, velocity: float = math.nan, stamp_ns: int = 0) -> Sample:
    return Sample(stamp_ns, position, velocity, 67e5, 30e5, 10e5)


@pytest.mark.parametrize(
    ("x", "v", "u"),
    [
        (0.10, 0.0, 0.5),  # 10 / m * 50 mm below the target: up
        (0.20, 0.0, -0.5),
        (0.15, 0.2, -0.1),  # on the target and rising: 0.5 s/m * 0.2 m/s against it
        (0.10, 0.2, 0.4),
        (0.00, 0.0, 1.0),  # 1.5 saturates
        (0.15, 3.0, -1.0),
    ],
)
def test_pd_is_proportional_to_the_error_less_the_piston_velocity(x: float, v: float, u: float):
    assert pd(sample(x, v), Target(0.15, 0.0), None, GAINS) == (pytest.approx(u), Memory(x, v))


def test_derivative_does_not_see_the_velocity_of_the_target():
    moving, resting = (pd(sample(0.1, 0.05), Target(0.15, v), None, GAINS) for v in (0.3, 0.0))
    assert moving == resting


def test_pd_jumps_the_overlap_before_it_saturates():
    """h = 0.5: 0.1 + 0.9 * 0.5 = 0.55, then the limit."""
    gains = GAINS._replace(overlap=0.1)
    assert pd(sample(0.1, 0.0), Target(0.15, 0.0), None, gains)[0] == pytest.approx(0.55)
    assert pd(sample(0.1, 0.0), Target(0.15, 0.0), None, gains._replace(limit=0.52))[0] == 0.52
    assert pd(sample(0.2, 0.0), Target(0.15, 0.0), None, gains._replace(limit=0.52))[0] == -0.52


@pytest.mark.parametrize(
    ("x", "v", "u"), [(0.1, 0.0, 0.7), (0.2, 0.0, -0.7), (0.15, 0.0, 0.0), (0.15, 1e-9, -0.7), (0.149, 0.1, -0.7)]
)
def test_relay_gives_the_full_limit_in_the_direction_of_h(x: float, v: float, u: float):
    gains = RELAY._replace(limit=0.7)
    assert relay(sample(x, v), Target(0.15, 0.0), None, gains) == (u, Memory(x, v))


@pytest.mark.parametrize(("asked", "given"), [(0.3, 0.3), (-0.3, -0.3), (0.9, 0.8), (-0.9, -0.8), (0.0, 0.0)])
def test_open_loop_passes_the_target_on_as_spool_reference(asked: float, given: float):
    assert open_loop(sample(0.2), Target(asked, 0.0), None, OpenLoopGains(limit=0.8))[0] == given


def test_measured_velocity_needs_a_tachometer():
    assert velocity(sample(0.1, -0.3), None, GAINS) == -0.3
    with pytest.raises(ValueError, match=r"sample at 5 ns has no tachometer signal.*'backward' or 'filtered'"):
        velocity(sample(0.1, stamp_ns=5), None, GAINS)


def test_unknown_velocity_source_is_refused():
    with pytest.raises(ValueError, match="'guessed' is none of 'measured', 'backward', 'filtered'"):
        velocity(sample(0.1, 0.0), None, GAINS._replace(source="guessed"))


def estimates(positions: list[float], gains: Gains) -> list[float]:
    """Velocity estimates along a run, the memory handed on as the loop does."""
    memory, values = None, []
    for x in positions:
        _, memory = pd(sample(x), Target(0.15, 0.0), memory, gains)
        values.append(memory.velocity)
    return values


def test_backward_difference_is_exact_on_a_ramp_from_the_second_sample_on():
    ramp = [0.1 + 0.2 * T * k for k in range(20)]
    assert estimates(ramp, GAINS._replace(source="backward")) == pytest.approx([0.0] + [0.2] * 19)


def test_filtered_difference_answers_a_ramp_like_a_first_order_lag():
    """v (1 - a^k) with a = exp(-T/filter_time), exactly the lag sampled."""
    ramp = [0.1 + 0.2 * T * k for k in range(20)]
    lag = [0.2 * (1.0 - math.exp(-k * T / 0.04)) for k in range(20)]
    assert estimates(ramp, GAINS._replace(source="filtered")) == pytest.approx(lag)


def test_filter_without_lag_is_the_backward_difference():
    positions = [0.1, 0.12, 0.11, 0.2]
    filtered = estimates(positions, GAINS._replace(source="filtered", filter_time=0.0))
    assert filtered == estimates(positions, GAINS._replace(source="backward"))


@given(u=UNIT, overlap=OVERLAP)
def test_compensation_is_odd(u: float, overlap: float):
    assert compensate(-u, overlap) == -compensate(u, overlap)


@given(u=UNIT, v=UNIT, overlap=OVERLAP)
def test_compensation_is_monotone(u: float, v: float, overlap: float):
    low, high = sorted((u, v))
    assert compensate(low, overlap) <= compensate(high, overlap)


@given(u=UNIT, overlap=OVERLAP)
def test_compensation_undoes_the_dead_band_of_the_lands(u: float, overlap: float):
    """Lands open by (|y| - overlap) / (1 - overlap) of their way at a spool position y beyond the overlap."""
    y = compensate(u, overlap)
    opening = math.copysign(max(abs(y) - overlap, 0.0) / (1.0 - overlap), y)
    assert opening == pytest.approx(u, abs=1e-14)
    assert compensate(0.0, overlap) == 0.0
    assert compensate(u, 0.0) == u


@given(u=st.floats(allow_nan=False), limit=st.floats(0.0, 1.0))
def test_saturation_keeps_what_is_inside_and_clips_the_rest(u: float, limit: float):
    assert saturate(u, limit) == (u if abs(u) <= limit else math.copysign(limit, u))


@given(
    law=st.sampled_from(sorted(LAWS)),
    x=st.floats(0.0, 0.27),
    v=UNIT,
    target=st.floats(-1.0, 1.0),
    limit=st.floats(0.0, 1.0),
    overlap=OVERLAP,
)
def test_every_law_stays_within_its_limit(law: str, x: float, v: float, target: float, limit: float, overlap: float):
    numbers = NUMBERS[law]._replace(limit=limit)
    gains = numbers._replace(overlap=overlap) if "overlap" in numbers._fields else numbers
    assert abs(LAWS[law].answer(sample(x, v), Target(target, 0.0), None, gains)[0]) <= limit


@pytest.mark.parametrize("law", ["pd", "pid", "relay", "state-space"])
def test_a_broken_transducer_gives_nan_and_not_a_full_command(law: str):
    assert math.isnan(LAWS[law].answer(sample(math.nan, 0.0), Target(0.15, 0.0), None, NUMBERS[law])[0])


def test_names_of_the_laws():
    found = {kind: law.answer for kind, law in LAWS.items()}
    assert found == {"pd": pd, "pid": pid, "relay": relay, "open-loop": open_loop, "state-space": state_space}


def test_volts_per_percent_of_the_rig():
    """1 V per % of 270 mm is 1/10 of the valve's signal per 2.7 mm: 37.04 / m."""
    assert per_metre(1.0, stroke=0.27, full_scale=10.0) == pytest.approx(0.1 / 2.7e-3)
    assert volts_per_percent(0.1 / 2.7e-3, stroke=0.27, full_scale=10.0) == pytest.approx(1.0)


@given(s=st.floats(1e-3, 1e3), stroke=st.floats(0.01, 10.0), full_scale=st.floats(1.0, 100.0))
def test_gain_units_go_there_and_back(s: float, stroke: float, full_scale: float):
    assert volts_per_percent(per_metre(s, stroke, full_scale), stroke, full_scale) == pytest.approx(s)


RESTING = GAINS._replace(overlap=0.1, rest=0.02)


def test_a_resting_valve_opens_beyond_its_rest_and_shuts_at_a_quarter_of_it():
    """h = 10 e: shut up to 2 mm, open down to 0.5 mm, and then shut up to 2 mm again; open it jumps as ever."""
    memory, found = None, []
    for error in (1.9e-3, 2.1e-3, 1.0e-3, 0.6e-3, 0.4e-3, 1.9e-3, -2.1e-3):
        u, memory = pd(sample(0.1, 0.0), Target(0.1 + error, 0.0), memory, RESTING)
        found.append(u)
        if u != 0.0:
            assert u == pytest.approx(compensate(10.0 * error, 0.1))
    assert [u != 0.0 for u in found] == [False, True, True, True, False, False, True]


def test_a_reading_that_is_not_a_number_is_no_rest():
    assert math.isnan(pd(sample(math.nan, 0.0), Target(0.1, 0.0), None, RESTING)[0])


def test_without_rest_every_command_jumps():
    for error in (1e-9, -1e-9, 0.0, 1e-3):
        h = GAINS.proportional * (0.1 + error - 0.1)
        jumping = GAINS._replace(overlap=0.1)
        assert pd(sample(0.1, 0.0), Target(0.1 + error, 0.0), None, jumping)[0] == compensate(h, 0.1)
