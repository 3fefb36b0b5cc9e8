"""PID: its linear part against scipy's filters, its integral at the limit by closed forms, its memory forgotten."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import lfilter

from controller.law import Sample
from controller.laws import LAWS
from controller.pid import PidGains, PidMemory, pid, reach
from controller.reference import Target

T = 0.01
GAINS = PidGains(8.0, 20.0, 0.6, 0.0, "measured", 0.03, T, 1e9, 0.0, "none", 0.4)
RNG = np.random.default_rng(5)
Array = NDArray[np.float64]


def sample(x: float, v: float = 0.0) -> Sample:
    return Sample(0, x, v, 67e5, 30e5, 10e5)


def answers(x: Array, v: Array, wanted: Array, speed: Array, gains: PidGains) -> Array:
    """Commands along a run, the memory handed on as the loop does."""
    memory, found = None, []
    for row in zip(x.tolist(), v.tolist(), wanted.tolist(), speed.tolist(), strict=True):
        u, memory = pid(sample(row[0], row[1]), Target(row[2], row[3]), memory, gains)
        found.append(u)
    return np.array(found)


def derivative(x: Array, v: Array, gains: PidGains) -> Array:
    """The stated transfer functions; the first position has always been there."""
    a = math.exp(-T / gains.filter_time)
    if gains.source == "measured":
        return v
    lag = [1.0] if gains.source == "backward" else [1.0, -a]
    share = 1.0 if gains.source == "backward" else 1.0 - a
    return np.asarray(lfilter([share / T, -share / T], lag, x - x[0]))


@pytest.mark.parametrize("source", ["measured", "backward", "filtered"])
def test_within_its_limit_it_is_the_transfer_functions_it_states(source: str):
    x, v, wanted, speed = 0.1 * RNG.standard_normal((4, 300))
    gains = GAINS._replace(source=source, feed_forward=0.3)
    error = wanted - x
    integral = lfilter([0.0, gains.integral * T], [1.0, -1.0], error)  # K T/(z - 1)
    expected = gains.proportional * error + integral - gains.derivative * derivative(x, v, gains) + 0.3 * speed
    assert answers(x, v, wanted, speed, gains) == pytest.approx(expected, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("anti_windup", ["back-calculation", "clamping", "none"])
def test_anti_windup_does_nothing_within_the_limit(anti_windup: str):
    x, v, wanted, speed = 0.1 * RNG.standard_normal((4, 100))
    free = GAINS._replace(anti_windup=anti_windup)
    assert (answers(x, v, wanted, speed, free) == answers(x, v, wanted, speed, GAINS)).all()


def wound(anti_windup: str, samples: int, gains: PidGains = GAINS, error: float = 0.5) -> list[float]:
    """w = P e + I of a piston held off its target, before each sample."""
    memory, found = None, []
    for _ in range(samples):
        integral = memory.integral if memory else 0.0
        found.append(gains.proportional * error + integral)
        memory = pid(sample(0.0), Target(error, 0.0), memory, gains._replace(limit=1.0, anti_windup=anti_windup))[1]
    return found


def test_back_calculation_leads_the_integral_to_its_closed_form():
    """What w is beyond the limit goes to K e T_t, as (1 - T/T_t)^k."""
    rest = GAINS.integral * 0.5 * GAINS.tracking_time
    k = np.arange(400)
    expected = 1.0 + rest + (GAINS.proportional * 0.5 - 1.0 - rest) * (1.0 - T / GAINS.tracking_time) ** k
    assert wound("back-calculation", 400) == pytest.approx(expected, rel=1e-9)


def test_a_clamped_integral_stops_at_the_sample_that_reaches_the_limit():
    """P e = 0.4 leaves 0.6, of which every sample adds T K e = 0.01: sixty to the limit, one beyond, none after."""
    found = wound("clamping", 200, GAINS._replace(proportional=0.8))
    assert found == pytest.approx(0.4 + T * GAINS.integral * 0.5 * np.minimum(np.arange(200), 6.0 + 1.0), rel=1e-9)


def test_without_either_the_integral_winds_up_for_ever():
    assert wound("none", 400) == pytest.approx(4.0 + T * GAINS.integral * 0.5 * np.arange(400))


@pytest.mark.parametrize("overlap", [0.0, 0.2])
def test_the_integral_knows_the_limit_behind_the_overlap(overlap: float):
    """w = L takes the spool to its limit and no further."""
    gains = GAINS._replace(limit=0.6, overlap=overlap)
    edge = reach(gains) / gains.proportional
    at, inside = (pid(sample(0.0), Target(e, 0.0), None, gains)[0] for e in (edge, 0.9 * edge))
    assert at == pytest.approx(0.6)
    assert inside == pytest.approx(overlap + (1.0 - overlap) * 0.9 * reach(gains))
    assert reach(gains._replace(limit=0.1, overlap=0.2)) == 0.0


def travel(gains: PidGains, wanted: Callable[[float], Target], periods: int, push: float = 0.0) -> Array:
    """An integrator of 1 m/s at full valve, x' = u + push, under the law, exact between samples."""
    x, memory, found = 0.0, None, []
    for k in range(periods):
        u, memory = pid(sample(x), wanted(k * T), memory, gains)
        found.append(x)
        x += T * (u + push)
    return np.array(found)


SLOW = GAINS._replace(proportional=6.0, integral=12.0, derivative=0.0, limit=0.2, tracking_time=0.3)


def overshoot(anti_windup: str) -> float:
    step = travel(SLOW._replace(anti_windup=anti_windup), lambda t: Target(1.0, 0.0), 2000)
    assert anti_windup == "none" or step[-1] == pytest.approx(1.0, abs=1e-3)
    return float(step.max()) - 1.0


def test_anti_windup_takes_the_overshoot_of_a_step_that_saturates():
    """5 s at the limit: without it the integral has to be paid back by the same area beyond the target."""
    none, back, clamped = (overshoot(kind) for kind in ("none", "back-calculation", "clamping"))
    assert none > 0.5
    assert back < 0.05
    assert clamped < 0.1
    assert back != pytest.approx(clamped, rel=0.1)  # two ways, not one


def test_the_integral_takes_the_error_that_a_constant_push_leaves():
    """x' = u + c rests where u = -c: at c/P off the target without integral, on it with."""
    gains = GAINS._replace(derivative=0.0)
    without, with_it = (travel(gains._replace(integral=k), lambda t: Target(1.0, 0.0), 3000, 0.3) for k in (0.0, 5.0))
    assert without[-1] - 1.0 == pytest.approx(0.3 / gains.proportional, rel=1e-9)
    assert with_it[-1] == pytest.approx(1.0, abs=1e-9)


def test_feed_forward_takes_the_lag_behind_a_ramp():
    """An integrator lags v/P; told the reference's velocity, with its own gain of 1, by nothing: also when sampled."""
    gains = GAINS._replace(derivative=0.0, integral=0.0)
    lag, none = (
        0.25 * 2000 * T - travel(gains._replace(feed_forward=f), lambda t: Target(0.25 * t, 0.25), 2001)[-1]
        for f in (0.0, 1.0)
    )
    assert lag == pytest.approx(0.25 / gains.proportional, rel=1e-9)
    assert none == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("hook", ["on_safe_state", "on_resume"])
def test_a_forgotten_memory_leaves_nothing_of_before(hook: str):
    """At the target the first command is the centred valve; elsewhere that of a law that has just begun, without a
    difference over the gap in which the piston moved."""
    gains = GAINS._replace(source="backward")
    _, memory = pid(sample(0.1), Target(0.3, 0.0), None, gains)
    assert isinstance(memory, PidMemory)
    assert memory.integral > 0.0
    told = getattr(LAWS["pid"], hook)(memory)
    assert pid(sample(0.2), Target(0.2, 0.0), told, gains)[0] == 0.0
    assert pid(sample(0.2), Target(0.3, 0.0), told, gains) == pid(sample(0.2), Target(0.3, 0.0), None, gains)
    assert pid(sample(0.2), Target(0.2, 0.0), memory, gains)[0] < -1.0  # what it would have been


def test_a_broken_sample_does_not_spoil_the_integral():
    _, memory = pid(sample(0.1), Target(0.3, 0.0), None, GAINS)
    u, after = pid(sample(math.nan), Target(0.3, 0.0), memory, GAINS)
    assert math.isnan(u)
    assert after.integral == memory.integral
