"""Metrics against closed forms: first and second order steps, known oscillations, bands that NaN never keeps."""

import math

import numpy as np
import pytest

from controller.bands import Band, Metrics, judge
from controller.metrics import Array, Signals, measure
from controller.stretches import constant_stretches

DT = 1e-3
TIME = np.arange(12_000) / 1000.0
AT = 2.0  # [s], of the step
ONSET = 2000  # sample of the step


def run(position: Array, reference: Array) -> Metrics:
    """Metrics of a motion alone."""
    nothing = np.zeros_like(position)
    return measure(Signals(np.arange(position.size) * DT, position, reference, *[nothing] * 4))


def step(start: float, end: float) -> Array:
    return np.where(np.arange(TIME.size) < ONSET, start, end)


def response(t: Array, omega: float, zeta: float) -> Array:
    """Unit step response of omega^2 / (s^2 + 2 zeta omega s + omega^2), zeta < 1."""
    damped = math.sqrt(1.0 - zeta**2)
    t = np.maximum(t, 0.0)
    return 1.0 - np.exp(-zeta * omega * t) * np.sin(omega * damped * t + math.acos(zeta)) / damped


def held(error: Array, reference: float = 0.15) -> Metrics:
    """Metrics of a run that should rest and has this error."""
    return run(reference - error, np.full(error.size, reference))


@pytest.mark.parametrize("zeta", [0.2, 0.4, 0.6])
@pytest.mark.parametrize(("start", "end"), [(0.05, 0.20), (0.20, 0.05)])
def test_second_order_step_up_and_down(zeta: float, start: float, end: float):
    """Overshoot exp(-pi zeta / sqrt(1 - zeta^2)); the times from dense evaluation."""
    omega = 12.0
    y = response(TIME - AT, omega, zeta)
    metrics = run(start + (end - start) * y, step(start, end))
    dense = np.linspace(0.0, 9.0, 2_000_001)
    exact = response(dense, omega, zeta)
    rise = dense[np.argmax(exact > 0.9)] - dense[np.argmax(exact > 0.1)]
    settled = dense[np.abs(exact - 1.0) > 0.02][-1]
    assert metrics.overshoot == pytest.approx(
        math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta**2)), abs=(omega * DT) ** 2
    )  # the peak lies within half a sample
    assert metrics.rise_time == pytest.approx(rise, abs=1e-2 * DT)
    assert metrics.settling_time == pytest.approx(settled, abs=2e-2 * DT)


@pytest.mark.parametrize(("start", "end"), [(0.05, 0.20), (0.20, 0.05)])
def test_first_order_step_up_and_down(start: float, end: float):
    """Rise tau ln 9, settling tau ln 50, no overshoot; squared error integrates to tau/2."""
    tau = 0.3
    decay = np.where(np.arange(TIME.size) < ONSET, 0.0, np.exp(-(TIME - AT) / tau))
    metrics = run(step(start, end) - (end - start) * decay, step(start, end))
    assert metrics.rise_time == pytest.approx(tau * math.log(9.0), rel=1e-4)
    assert metrics.settling_time == pytest.approx(tau * math.log(50.0), rel=1e-4)
    assert metrics.overshoot == pytest.approx(0.0, abs=1e-12)
    assert metrics.max_error == pytest.approx(0.15)
    assert metrics.rms_error == pytest.approx(0.15 * math.sqrt(tau / 2.0 / 12.0), rel=5e-3)  # sum for integral: DT/tau
    assert metrics.steady_error == pytest.approx(0.0, abs=1e-12)


def test_the_worst_of_several_steps_counts():
    """A slow step without overshoot and a quick one with: rise from the first, overshoot from the second."""
    reference = np.concatenate([np.full(1000, 0.1), np.full(5000, 0.2), np.full(6000, 0.1)])
    position = reference.copy()
    position[1000:6000] -= 0.1 * np.exp(-DT * np.arange(5000) / 0.5)
    position[6000:] = 0.2 - 0.1 * response(DT * np.arange(6000), 20.0, 0.4)
    metrics = run(position, reference)
    assert metrics.rise_time == pytest.approx(0.5 * math.log(9.0), rel=1e-4)
    assert metrics.settling_time == pytest.approx(0.5 * math.log(50.0), rel=1e-4)
    assert metrics.overshoot == pytest.approx(math.exp(-math.pi * 0.4 / math.sqrt(0.84)), abs=(20.0 * DT) ** 2)


def test_what_never_rises_or_settles_is_nan():
    stuck = run(np.full(TIME.size, 0.05), step(0.05, 0.20))
    assert math.isnan(stuck.rise_time)
    assert math.isnan(stuck.settling_time)
    assert stuck.overshoot == 0.0
    assert stuck.steady_error == pytest.approx(0.15)
    short = run(step(0.05, 0.196), step(0.05, 0.20))  # stops 2.7 % short: risen, never settled
    assert short.rise_time == pytest.approx(0.0, abs=1e-12)
    assert math.isnan(short.settling_time)


@pytest.mark.parametrize("moving", [0.1 * np.sin(TIME), np.clip(0.05 * TIME, 0.1, 0.3), np.full(TIME.size, 0.15)])
def test_without_a_step_there_is_nothing_to_rise(moving: Array):
    """A sine, a ramp between two holds, and a hold."""
    metrics = run(moving, moving)
    assert all(map(math.isnan, (metrics.rise_time, metrics.overshoot, metrics.settling_time)))


def test_without_a_constant_stretch_there_is_no_steady_error_and_no_limit_cycle():
    metrics = run(np.zeros(TIME.size), 0.1 * np.sin(TIME))
    assert math.isnan(metrics.steady_error)
    assert math.isnan(metrics.limit_cycle_amplitude)


def test_what_comes_before_the_first_motion_is_not_judged():
    """One second that swings, then a sine: neither a limit cycle nor a steady error."""
    swing = 1e-3 * np.sin(2 * np.pi * 5.0 * TIME)
    follows = run(0.1 + swing + 0.02 * np.sin(TIME - AT) * (TIME > AT), 0.1 + 0.02 * np.sin(TIME - AT) * (TIME > AT))
    assert math.isnan(follows.steady_error)
    assert math.isnan(follows.limit_cycle_amplitude)
    assert run(0.1 + swing, np.full(TIME.size, 0.1)).limit_cycle_frequency == pytest.approx(5.0, rel=2e-3)  # the whole


def test_the_worst_of_all_constant_stretches_counts_and_is_named():
    """It swings in the second of three holds, and more in the standing before the first step, which is not judged."""
    reference = np.repeat([0.10, 0.12, 0.14, 0.16], 3000)
    at = np.repeat([5e-3, 0.0, 2e-3, 0.0], 3000)
    found = run(reference + at * np.sin(2 * np.pi * 6.0 * TIME), reference)
    assert found.limit_cycle_amplitude == pytest.approx(2e-3, rel=0.02)
    assert (found.limit_cycle_begin, found.limit_cycle_end) == pytest.approx((6.0, 8.999))
    calm = run(reference, reference)
    assert (calm.limit_cycle_amplitude, calm.limit_cycle_begin) == (0.0, 9.0)


def test_a_stretch_shorter_than_a_second_is_not_judged():
    reference = np.repeat([0.10, 0.12] * 6, 1000)
    assert math.isnan(run(reference, reference).limit_cycle_amplitude)


@pytest.mark.parametrize(("before", "after", "steps"), [(10, 10, 1), (10, 9, 0), (3, 10, 1), (1, 10, 1)])
def test_a_step_needs_a_hold_after_it_and_may_come_early_in_the_run(before: int, after: int, steps: int):
    assert sum(s.steps for s in constant_stretches(np.repeat([0.1, 0.2], [before, after]))) == steps


def test_the_end_of_a_motion_is_no_step():
    stretches = constant_stretches(np.concatenate([np.full(20, 0.1), np.linspace(0.11, 0.19, 9), np.full(20, 0.2)]))
    assert [(s.start, s.stop, s.steps) for s in stretches] == [(0, 20, False), (29, 49, False)]


def test_steady_error_is_the_mean_of_the_last_tenth_of_the_last_hold():
    error = np.zeros(TIME.size)
    error[-1000:] = 2e-3
    error[-500:] = 4e-3  # the last hold is 10 000 samples long
    assert run(step(0.1, 0.2) - error, step(0.1, 0.2)).steady_error == pytest.approx(3e-3)


@pytest.mark.parametrize("frequency", [1.3, 4.0, 17.7])
@pytest.mark.parametrize("amplitude", [0.5e-3, 8e-3])
@pytest.mark.parametrize("drift", [0.0, 2e-4])
def test_a_sine_of_known_size_is_found_on_an_offset_that_drifts(frequency: float, amplitude: float, drift: float):
    metrics = held(amplitude * np.sin(2 * np.pi * frequency * TIME + 0.4) + 1e-3 + drift * TIME)
    assert metrics.limit_cycle_amplitude == pytest.approx(amplitude, rel=0.02)  # the trend of five periods at least
    assert metrics.limit_cycle_frequency == pytest.approx(frequency, rel=2e-3)


def test_lopsided_hunting_is_a_limit_cycle():
    """Stick-slip: the piston creeps for 0.9 of the period and jumps back."""
    metrics = held(1e-3 * ((TIME / 0.5) % 1.0 < 0.1))
    assert metrics.limit_cycle_amplitude == pytest.approx(0.5e-3, rel=0.05)
    assert metrics.limit_cycle_frequency == pytest.approx(2.0, rel=2e-3)


def test_a_limit_cycle_is_found_through_quantisation_and_noise():
    """12 bit over 300 mm, 0.5 LSB rms: the hysteresis keeps chatter at the crossings out of the count."""
    noise = np.random.default_rng(1).normal(0.0, 0.5, TIME.size)
    lsb = 0.3 / 4096
    metrics = held(lsb * np.round(2e-3 * np.sin(2 * np.pi * 1.5 * TIME) / lsb + noise))
    assert metrics.limit_cycle_frequency == pytest.approx(1.5, rel=0.01)
    assert metrics.limit_cycle_amplitude == pytest.approx(2e-3, rel=0.1)


@pytest.mark.parametrize("decay", [0.5, 0.2, 0.12, 0.06])
def test_ringing_that_dies_away_is_no_limit_cycle(decay: float):
    """However slowly: by a fifth, a third, and two thirds from third to third of 12 s."""
    metrics = held(20e-3 * np.exp(-decay * TIME) * np.sin(2 * np.pi * 3.0 * TIME))
    assert (metrics.limit_cycle_amplitude, metrics.limit_cycle_frequency) == (0.0, 0.0)


def test_ringing_that_grows_and_a_cycle_approached_from_above_are_limit_cycles():
    swing = np.sin(2 * np.pi * 3.0 * TIME)
    assert held(1e-4 * np.exp(0.3 * TIME) * swing).limit_cycle_frequency == pytest.approx(3.0, rel=0.01)
    approached = held((2e-3 + 20e-3 * np.exp(-0.8 * TIME)) * swing)
    assert approached.limit_cycle_amplitude == pytest.approx(2e-3, rel=0.4)


@pytest.mark.parametrize(
    "error",
    [
        np.full(TIME.size, 3e-3),  # held by friction
        3e-3 + 5e-4 * TIME,  # sinking by leakage
        0.14e-3 * np.sin(2 * np.pi * 2.0 * TIME),  # 0.28 mm from peak to peak: below the floor
        1e-3 * (TIME > 9.0),  # one slip
        2e-3 * np.sin(2 * np.pi * 0.2 * TIME),  # less than a period in the last third
        0.5e-3 * np.floor(TIME / 1.5),  # slips on, ever in one direction
        4e-3 * np.exp(-TIME / 4.0),  # creeps
    ],
)
def test_what_is_no_limit_cycle(error: Array):
    metrics = held(error)
    assert (metrics.limit_cycle_amplitude, metrics.limit_cycle_frequency) == (0.0, 0.0)


@pytest.mark.parametrize(
    "times", [[20, 23, 26, 82, 95, 96, 101, 118], [81, 92, 95, 111], [50, 110]], ids=["burst", "late", "rare"]
)
def test_irregular_jumps_to_and_fro_are_a_limit_cycle(times: list[int]):
    assert held(1e-3 * np.isin(np.floor(10.0 * TIME), times)).limit_cycle_amplitude == pytest.approx(0.5e-3, rel=0.3)


def test_threshold_is_peak_to_peak():
    for amplitude, found in ((0.145e-3, False), (0.155e-3, True)):  # 0.3 mm lies between their doubles
        assert (held(amplitude * np.sin(2 * np.pi * 2.0 * TIME)).limit_cycle_amplitude > 0.0) is found


def test_pressures_and_valve_travel():
    """A spool that goes 0, 1, -1, 0 travels 1 + 2 + 1."""
    still = np.zeros(4)
    p1, p_lower, p_upper = np.array([67e5, 80e5, 60e5, 70e5]), np.array([30e5, 5e5, 90e5, 40e5]), still - 1e5
    metrics = measure(Signals(np.arange(4.0), still, still, p1, p_lower, p_upper, np.array([0.0, 1.0, -1.0, 0.0])))
    assert (metrics.peak_p1, metrics.peak_p_lower, metrics.peak_p_upper) == (80e5, 90e5, -1e5)
    assert (metrics.min_p_lower, metrics.min_p_upper) == (5e5, -1e5)
    assert metrics.valve_travel == 4.0


@pytest.mark.parametrize("size", [0, 3])
def test_signals_must_be_equally_long_and_not_empty(size: int):
    with pytest.raises(ValueError, match="equally long and not empty"):
        measure(Signals(np.zeros(size), *[np.zeros(0 if size == 0 else 4)] * 6))


def test_bands_are_judged_each_by_its_relation_and_nan_never_passes():
    metrics = run(np.full(TIME.size, 0.1), np.full(TIME.size, 0.1))._replace(peak_p1=70e5)
    bands = [
        Band("peak_p1", "<=", 70e5),
        Band("peak_p1", ">=", 70e5),
        Band("peak_p1", "<=", 69e5),
        Band("peak_p1", ">=", 71e5),
        Band("rise_time", "<=", 1.0),
        Band("rise_time", ">=", 0.0),
    ]
    verdicts = judge(metrics, bands)
    assert [v.passed for v in verdicts] == [True, True, False, False, False, False]
    assert verdicts[2] == ("peak_p1", 70e5, "<=", 69e5, False)


@pytest.mark.parametrize(
    ("band", "message"),
    [
        (Band("speed", "<=", 1.0), "no metric 'speed'; there are rise_time, overshoot"),
        (Band("overshoot", "<", 1.0), "relation '<' of overshoot is none of <=, >="),
    ],
)
def test_a_band_must_name_a_metric_and_a_relation(band: Band, message: str):
    with pytest.raises(ValueError, match=message):
        judge(run(np.zeros(20), np.zeros(20)), [band])
