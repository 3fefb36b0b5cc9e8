"""The deviation that is stated: of a filter that takes errors too large or too small, and of what nothing tells."""

import math

import numpy as np
import pytest

from twin.estimation.consistency import WINDOW, Watch, stated

Q, R = 0.04, 1.0  # variances of a random walk's step and of its reading


def riccati(q: float, r: float) -> tuple[float, float]:
    """Variance before and after a reading of the steady filter of a random walk."""
    before = 0.5 * (q + math.sqrt(q * q + 4.0 * q * r))
    return before, before * r / (before + r)


def followed(factor: float, count: int = 20_000) -> tuple[np.ndarray, np.ndarray, float]:
    """Errors, stated deviations and raw deviation of a filter that takes both variances too large by a factor."""
    rng = np.random.default_rng(5)
    before, after = riccati(factor * Q, factor * R)
    gain, watch, x, mean = before / (before + factor * R), Watch(1.0, (-math.inf, math.inf)), 0.0, 0.0
    errors, deviations = [], []
    for _ in range(count):
        x += math.sqrt(Q) * rng.standard_normal()
        away = x + math.sqrt(R) * rng.standard_normal() - mean
        watch.note(np.array([away / math.sqrt(before + factor * R)]))
        mean += gain * away
        errors.append(mean - x)
        if len(errors) > WINDOW:
            spread = np.array([math.sqrt(after)])
            deviations.append(stated(spread, np.array([math.inf]), watch.verdict().square)[0])
    return np.array(errors[WINDOW:]), np.array(deviations), math.sqrt(after)


@pytest.mark.parametrize("factor", [0.5, 1.0, 4.0])
def test_it_is_right_where_the_variances_are_wrong_by_a_factor(factor: float):
    """The gain is the same, the true error that of the right filter; 5 %: the scatter of the window and of the run."""
    errors, deviations, raw = followed(factor, 4000)
    right = math.sqrt(riccati(Q, R)[1])
    assert deviations.mean() == pytest.approx(right, rel=0.08)
    assert raw == pytest.approx(right * math.sqrt(factor))
    assert np.mean(np.abs(errors) < deviations) == pytest.approx(0.683, abs=0.06)


def test_what_no_reading_tells_stays_as_uncertain_as_it_was():
    prior = np.array([3.0, 3.0, 0.0])
    found = stated(np.array([3.0, 0.3, 0.0]), prior, 0.25)
    assert found[0] == 3.0
    assert found[1] == pytest.approx(0.15, rel=0.02)
    assert found[2] == 0.0


def test_a_model_that_is_wrong_widens_all():
    assert stated(np.array([3.0, 0.3]), np.array([3.0, 3.0]), 4.0) == pytest.approx([6.0, 0.6])


def test_readings_that_are_alike_count_as_fewer():
    """Of a first-order process the variance of a mean of n is `square` / n, not `nis` / n."""
    rng, alike, watch = np.random.default_rng(2), 0.6, Watch(1.0, (-math.inf, math.inf))
    noise = math.sqrt(1.0 - alike * alike) * rng.standard_normal((400, WINDOW))
    found = np.zeros_like(noise)
    for k in range(1, WINDOW):
        found[:, k] = alike * found[:, k - 1] + noise[:, k]
    squares = []
    for row in found:
        watch.note(row)
        squares.append(watch.verdict().square)
    assert np.mean(squares) == pytest.approx(WINDOW * found.mean(axis=1).var(), rel=0.2)
    assert np.mean(squares) > 3.0


def test_a_channel_at_the_end_of_its_range_says_nothing_of_the_model():
    """Readings and expectations are clipped at one value: every innovation is 0, no correlation is known."""
    watch = Watch(1.0, (0.0, 10.0))
    watch.note(np.zeros(200))
    found = watch.verdict()
    assert found.nis == 0.0
    assert math.isnan(found.whiteness)
    assert math.isnan(found.square)
