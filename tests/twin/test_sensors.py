"""The data acquisition card."""

from types import SimpleNamespace

import numpy as np
import pytest

from twin.sensors import Card, acquire, card_of, convert, noise_block, put_out

DAQ = SimpleNamespace(
    bits=12.0,
    noise=0.5,
    skew=5e-6,
    quantise=True,
    clip=True,
    tachometer=True,
    position_range=0.3,
    velocity_range=1.0,
    pressure_range=250e5,
)
CARD = card_of(DAQ)
PERFECT = CARD._replace(noise=0.0, skew=0.0, quantise=False, clip=False)
STEP = 50e-6


def scan(card: Card, before, at, noise=(0.0,) * 5):
    out = np.zeros(5)
    acquire(np.array([before, at], float), np.array(noise, float), card, STEP, out)
    return out


def test_twelve_bits_over_the_range():
    """Readings are whole multiples of range / 4096 and off by half of that at most."""
    values = np.linspace(0.0, 0.2999, 7001)
    read = np.array([convert(v, 0.0, 0.3, 0.0, CARD) for v in values])
    codes = read / (0.3 / 4096)
    assert np.allclose(codes, np.round(codes), atol=1e-9)
    assert np.abs(read - values).max() <= 0.5 * 0.3 / 4096 * (1 + 1e-9)


def test_channels_are_read_one_after_the_other():
    """Channel j of n is read (n-1-j) * 5 us before the end of the scan, by a straight line inside the last step."""
    read = scan(PERFECT._replace(skew=5e-6), before=[0.0] * 5, at=[1.0] * 5)
    assert read == pytest.approx(1.0 - np.array([20, 15, 10, 5, 0]) * 1e-6 / STEP)


@pytest.mark.parametrize("step", [1e-6, 5e-6, 50e-6])
def test_a_scan_may_be_longer_than_a_step(step: float):
    """The last step's line goes on: a parabola u = a t^2 is read with an error of a d (d - h), d before its end."""
    a, ends = 3e7, 1e-3
    row = np.zeros(5)
    taps = np.array([[a * (ends - step) ** 2] * 5, [a * ends**2] * 5])
    acquire(taps, np.zeros(5), PERFECT._replace(skew=5e-6), step, row)
    late = np.array([20, 15, 10, 5, 0]) * 1e-6
    assert row - a * (ends - late) ** 2 == pytest.approx(-a * late * (late - step), rel=1e-6, abs=1e-12)
    assert np.abs(row - a * (ends - late) ** 2).max() <= a * max((20e-6) ** 2, step**2 / 4)


def test_twelve_bits_of_output_over_the_whole_input_of_the_valve():
    """Steps of 20 V/4096; off by half of one at most, rest exact, the last step missing at the top."""
    references = np.linspace(-1.0, 1.0, 5001)
    out = np.array([put_out(r, 12.0) for r in references.tolist()])
    codes = (out + 1.0) * 2048.0
    assert (codes == np.round(codes)).all()
    assert np.abs(out - references)[references <= 1.0 - 1.0 / 4096].max() <= 1.0 / 4096 * (1 + 1e-9)
    assert put_out(0.0, 12.0) == 0.0
    assert (put_out(-1.0, 12.0), put_out(1.0, 12.0)) == (-1.0, 1.0 - 2.0 / 4096)


def test_without_a_tachometer_there_is_one_channel_less():
    bare = card_of(SimpleNamespace(**vars(DAQ) | {"tachometer": False}))
    read = scan(PERFECT._replace(skew=5e-6, fitted=bare.fitted), before=[0.0] * 5, at=[1.0] * 5)
    assert np.isnan(read[1])
    assert read[[0, 2, 3, 4]] == pytest.approx(1.0 - np.array([15, 10, 5, 0]) * 1e-6 / STEP)


def test_pressures_below_zero_read_as_zero_and_ranges_end():
    read = scan(CARD._replace(noise=0.0), before=[0.4, 2.0, -1e5, -1e5, 300e5], at=[0.4, 2.0, -1e5, -1e5, 300e5])
    assert read[2] == read[3] == 0.0
    assert read[0] == pytest.approx(0.3 * 4095 / 4096)
    assert read[1] == pytest.approx(2.0 * 4095 / 4096 - 1.0)
    assert read[4] == pytest.approx(250e5 * 4095 / 4096)


def test_each_effect_can_be_switched_off():
    values = [0.1234567, -0.3, -0.9e5, 12.3e5, 260e5]
    assert scan(PERFECT, before=[0.0] * 5, at=values, noise=[3.0] * 5).tolist() == values


def test_noise_has_the_stated_size_and_belongs_to_seed_and_tick():
    block = noise_block(3, 5)
    assert np.array_equal(block, noise_block(3, 5))
    assert not np.array_equal(block, noise_block(3, 6))
    assert not np.array_equal(block, noise_block(4, 5))
    card = CARD._replace(quantise=False)
    rows = np.array([convert(0.15, 0.0, 0.3, x, card) for x in noise_block(1, 0).ravel()])
    assert rows.std() == pytest.approx(0.5 * 0.3 / 4096, rel=0.05)
    assert rows.mean() == pytest.approx(0.15, abs=3 * 0.5 * 0.3 / 4096 / np.sqrt(rows.size))
