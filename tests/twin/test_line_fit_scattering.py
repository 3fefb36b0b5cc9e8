"""The filters of a line: passive, exact where they must be, the same in every process."""

import hashlib
import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.exact_line import (
    CORNERS,
    HELD_FLOW,
    HELD_PRESSURE,
    RIG,
    Pipe,
    at_rest,
    drive,
)
from twin.lines.filters import Filters, scattering
from twin.lines.fit import SHORTEST, fit
from twin.lines.householder import solve, split
from twin.lines.spec import Creep
from twin.lines.theory import LOSSES, Line, modes, slow_minus, slow_plus

PIPES = st.builds(
    Pipe,
    st.floats(0.5, 40.0),
    st.floats(8e-3, 20e-3),
    st.floats(10e-6, 100e-6),
    st.floats(600.0, 1330.0),
    st.just(870.0),
)
STEPS = st.sampled_from([20e-6, 50e-6, 100e-6, 200e-6])


def line_of(pipe: Pipe, step: float, losses: str = "unsteady") -> Line:
    return Line(pipe.travel_time, pipe.viscous_time, losses, step)


def largest(f: Filters, m: float) -> float:
    """max |S+-| on a grid of 64 points per turn of the echo, eight times the one of the fit, and 2000 slow ones."""
    theta = np.concatenate([np.geomspace(1e-7, 0.1, 2000), np.linspace(1e-3, np.pi, int(64 * m) + 10000)])
    return float(np.abs(scattering(theta, f)).max())


@settings(max_examples=60)
@given(PIPES, STEPS, st.sampled_from(LOSSES))
def test_filters_are_passive(pipe: Pipe, step: float, losses: str):
    """|S+-| <= 1 + 1e-9 for any line that is long enough, and a fit is found for all of them."""
    line = line_of(pipe, step, losses)
    if line.steps >= SHORTEST:
        assert largest(fit(line), line.steps) <= 1.0 + 1e-9


@settings(max_examples=40)
@given(PIPES, STEPS, st.sampled_from(("lumped", "ends", "nodes")), st.sampled_from((1e-7, 1e-3)), st.integers(0, 99))
def test_ends_never_create_energy(pipe: Pipe, step: float, model: str, scale: float, seed: int):
    """From rest, the work at both ends, sum h p q, is never below zero, laminar and turbulent, whatever the ends do."""
    if pipe.travel_time < SHORTEST * step:
        return
    rng = np.random.default_rng(seed)
    bank, memory = at_rest(pipe.spec(model), step)
    kinds = rng.integers(0, 2, size=(2000, 2))
    values = rng.normal(size=(2000, 2)) * scale * np.where(kinds == HELD_FLOW, 1.0, pipe.impedance)
    out = np.zeros((2000, 4))
    drive(bank, memory, kinds, values, np.zeros(2), out)
    work = out[:, 0] * out[:, 2] + out[:, 1] * out[:, 3]
    assert np.cumsum(work).min() >= -1e-9 * np.abs(work).sum()


@pytest.mark.parametrize("losses", LOSSES)
@pytest.mark.parametrize("dissipation", [1e-2, 0.4])
@pytest.mark.parametrize("creep", [(), (Creep(0.4, 0.2e-3), Creep(0.25, 2e-3))])
def test_slow_series_is_that_of_the_exact_modes(losses: str, dissipation: float, creep: tuple[Creep, ...]):
    """Taylor coefficients in closed form against Cauchy's integral; 1e-9: its rounding on a circle of 0.1."""
    line = Line(1e-3, 1e-3 / dissipation, losses, 50e-6, creep)
    s = 0.1 * min(1.0, 5.0 * dissipation) / line.travel_time * np.exp(2j * np.pi * (np.arange(32) + 0.5) / 32)
    plus, minus = modes(s, line.travel_time, line.viscous_time, losses, creep)
    u = s * line.travel_time
    found = [np.mean(plus / u**k).real * np.abs(u[0]) ** k for k in range(4)]
    assert found == pytest.approx(slow_plus(line) * np.abs(u[0]) ** np.arange(4), abs=1e-9)
    assert np.mean(minus).real == pytest.approx(slow_minus(dissipation, losses), abs=1e-9)


@pytest.mark.parametrize("pipe", [*RIG, *CORNERS])
@pytest.mark.parametrize("step", [50e-6, 100e-6])
def test_rest_is_exact(pipe: Pipe, step: float):
    """S+(1) = 1, S-(1) the steady resistance; the mean delay of S+, its mass, M steps: to 1e-11."""
    line = line_of(pipe, step)
    f = fit(line)
    p, delay = f.poles, f.poles / (1.0 - f.poles)
    own = f.direct + f.own.sum() + f.echo.sum() + f.echo_taps.sum()
    across = f.taps.sum() + f.across.sum()
    assert own + across == pytest.approx(1.0, abs=1e-11)
    assert own - across == pytest.approx(slow_minus(line.dissipation, "unsteady"), abs=1e-11)
    mean = (f.own * delay).sum() + (f.echo * (f.echo_delay + delay)).sum() + (f.across * (f.delay + delay)).sum()
    mean += (f.echo_taps * (f.echo_first + np.arange(2))).sum() + (f.taps * (f.first + np.arange(len(f.taps)))).sum()
    assert mean == pytest.approx(line.steps, rel=1e-11)
    assert np.all((p > 0.0) & (p < 1.0))


def test_householder_solves_like_lapack():
    rng = np.random.default_rng(0)
    a, b = rng.normal(size=(50, 7)), rng.normal(size=50)
    assert solve(a, b) == pytest.approx(np.linalg.lstsq(a, b, rcond=None)[0], rel=1e-12)
    x0, free = split(a[:3], b[:3])
    assert a[:3] @ (x0 + free @ rng.normal(size=4)) == pytest.approx(b[:3], abs=1e-12)


def fingerprint() -> str:
    """Of the filters of all rig lines."""
    digest = hashlib.sha256()
    for pipe in RIG:
        for part in fit(line_of(pipe, 50e-6)):
            digest.update(np.asarray(part).tobytes())
    return digest.hexdigest()


@pytest.mark.parametrize("threads", ["1", "2"])
def test_same_bits_in_another_process(threads: str):
    """Also with another number of threads for linear algebra, as a process pinned to a core has."""
    code = "from tests.twin.test_line_fit_scattering import fingerprint; print(fingerprint())"
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": threads}
    other = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    assert other.stdout.strip() == fingerprint()


def test_zero_is_zero():
    """Silence stays exactly zero: no numbers so small that they cost time."""
    bank, memory = at_rest(RIG[0].spec(), 50e-6)
    out = np.zeros((100, 4))
    kinds = np.tile([HELD_FLOW, HELD_PRESSURE], (100, 1))
    drive(bank, memory, kinds, np.zeros((100, 2)), np.zeros(2), out)
    assert not out.any()
