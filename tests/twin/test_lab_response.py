"""The laboratory of lines, frequency response: the exact line, and each scheme beside what it does in time."""

import math

import control
import numpy as np
import pytest

from bridge.figures.lines.response import responses
from twin.lines.lab.friction import friction
from twin.lines.lab.integrate import TIMES, march, until
from twin.lines.lab.network import characteristics
from twin.lines.lab.pipe import VELOCITY, Case, End, Pipe, reservoir
from twin.lines.lab.propagate import propagate, propagator
from twin.lines.lab.response import (
    characteristics_response,
    exact_response,
    frequency_response_data,
    impedance,
    lines_response,
    rig_response,
)
from twin.lines.lab.space import SPACES, grid
from twin.lines.lab.system import line_system

PIPE = Pipe(2.0, 0.011, 1137.0, 878.0, 200e-6)
CELLS = 12
STEP = PIPE.travel_time / CELLS
OMEGA = 2.0 * np.pi * np.array([3.0, 60.0, 142.0, 300.0, 700.0])  # 142 Hz: a quarter wave
STEADY = friction("steady")


def test_exact_line_in_its_limits():
    """Slow: the resistance 128 mu L/(pi d^4) and the capacity V/B; det T = 1 everywhere; frictionless quarter wave."""
    slow = exact_response(PIPE, "unsteady", np.array([1e-3]))
    resistance = 128.0 * PIPE.density * PIPE.viscosity * PIPE.length / (math.pi * PIPE.diameter**4)
    assert impedance(slow).real == pytest.approx(resistance, rel=1e-6)
    capacity = PIPE.area * PIPE.length / (PIPE.density * PIPE.speed**2)
    assert (1.0 / impedance(slow, "closed")).imag / 1e-3 == pytest.approx(capacity, rel=1e-6)
    assert np.linalg.det(exact_response(PIPE, "unsteady", OMEGA)) == pytest.approx(1.0, abs=1e-9)
    quarter = exact_response(PIPE, "none", np.array([np.pi * PIPE.speed / (2.0 * PIPE.length)]))[0]
    assert quarter[0, 0] == pytest.approx(0.0, abs=1e-12)
    assert quarter[0, 1] == pytest.approx(1j * PIPE.hammer / PIPE.area, rel=1e-12)


def test_exact_line_cut_in_two():
    """T of the whole is the product of the parts."""
    parts = [exact_response(PIPE._replace(length=length), "unsteady", OMEGA) for length in (0.7, 1.3)]
    assert parts[0] @ parts[1] == pytest.approx(exact_response(PIPE, "unsteady", OMEGA), rel=1e-10)


@pytest.mark.parametrize("scheme", ["moc", "ends", "cds5/esdirk4"])
def test_schemes_cut_in_two(scheme: str):
    """Characteristics to rounding; others within what they err by: 0.5 % and 2 % up to 300 Hz."""
    fit = friction("fit", viscous_time=PIPE.viscous_time, step=STEP)
    omega = OMEGA[:4]

    def response(share: float) -> np.ndarray:
        pipe, cells = PIPE._replace(length=share * PIPE.length), round(share * 2 * CELLS)
        if scheme == "moc":
            return characteristics_response(pipe, fit, cells, omega)
        if scheme == "ends":
            return rig_response(pipe, fit, 50e-6, omega)
        return lines_response(pipe, grid("cds5", cells, pipe.length), "esdirk4", STEADY, STEP / 2.0, omega)

    whole, parts = response(1.0), response(0.5) @ response(0.5)
    scale = np.abs(whole).max(axis=0)
    assert np.abs(parts / scale - whole / scale).max() < {"moc": 1e-9, "ends": 5e-3}.get(scheme, 0.02)


def heard(times: np.ndarray, values: np.ndarray, omega: float) -> complex:
    """Amplitude of a settled oscillation: least squares on cos and sin over the last part."""
    late = times > 0.7 * times[-1]
    waves = np.column_stack([np.cos(omega * times[late]), -np.sin(omega * times[late])])
    real, imaginary = np.linalg.lstsq(waves, values[late], rcond=None)[0]
    return complex(real, imaginary)


@pytest.mark.parametrize("time", TIMES)
def test_lines_in_time_do_what_their_response_says(time: str):
    """FEM driven at 200 Hz until its start is forgotten: 1e-4."""
    thick, omega = PIPE._replace(viscosity=5e-3), 2.0 * math.pi * 200.0
    case = Case(thick, End(VELOCITY, lambda t: math.cos(omega * t)), reservoir(0.0), 1.0, 0.0)
    system, start = line_system(case, grid("fem", 10, thick.length), STEADY)
    step, rows = 2.0 * thick.travel_time / 10, []
    for t, state in march(system, start, time, step):
        rows.append((t, state.y[0]))
        if t > 0.1:
            break
    times, values = np.array(rows).T
    right = impedance(lines_response(thick, grid("fem", 10, thick.length), time, STEADY, step, np.array([omega])))[0]
    assert heard(times, values, omega) / thick.area == pytest.approx(right, rel=1e-4)


@pytest.mark.parametrize("name", ["steady", "kagawa", "convolution"])
@pytest.mark.parametrize("courant", [1.0, 0.6])
def test_characteristics_in_time_do_what_their_response_says(name: str, courant: float):
    thick, omega, model = PIPE._replace(viscosity=5e-3), 2.0 * math.pi * 200.0, friction(name)
    case = Case(thick, End(VELOCITY, lambda t: math.sin(omega * t) if t < 1.0 else 0.0), reservoir(0.0), 0.0, 0.0)
    found = characteristics(case, model, 10, 0.1, courant)
    right = impedance(characteristics_response(thick, model, 10, np.array([omega]), courant))[0]
    assert 1j * heard(found.time, found.p_1, omega) / thick.area == pytest.approx(right, rel=1e-3)


@pytest.mark.parametrize("space", SPACES)
def test_lines_converge_to_the_exact_response(space: str):
    """Semi-discrete, steady friction, up to 300 Hz: twice the cells, a quarter of the error (3.4 at least)."""
    right = exact_response(PIPE, "steady", OMEGA[:4])
    off = []
    for cells in (10, 20):
        found = lines_response(PIPE, grid(space, cells, PIPE.length), "exact", STEADY, STEP, OMEGA[:4])
        off.append(np.abs(found - right).max(axis=0) / np.abs(right).max(axis=0))
    assert np.all(off[1] < off[0] / 3.4 + 1e-9)


def test_multistep_symbols_and_stages_agree_where_both_exist():
    """Backward Euler as (1 - 1/z)/h and as a propagator."""
    system, start = line_system(
        Case(PIPE, End(VELOCITY, math.cos), reservoir(0.0), 0.0, 0.0), grid("fem", 8, 2.0), friction("trikha")
    )
    for time in ("backward-euler", "esdirk3", "esdirk5"):
        by_steps = until(system, start, time, 0.1, 2.0)
        at_once = propagate(system, propagator(system, time, 0.1), start._replace(y=start.y + 0.0), 20)
        assert at_once.y == pytest.approx(by_steps.y, rel=1e-9, abs=1e-6)
        assert at_once.w == pytest.approx(by_steps.w, rel=1e-9, abs=1e-6)


def test_rig_line_has_the_exact_response():
    """Real-time line at 50 us up to 700 Hz: within 1 %, 5 % at the sharp quarter wave of the rig's own viscosity."""
    pipe = PIPE._replace(viscosity=40e-6)
    fit = friction("fit", viscous_time=pipe.viscous_time, step=50e-6)
    off = impedance(rig_response(pipe, fit, 50e-6, OMEGA)) / impedance(exact_response(pipe, "unsteady", OMEGA)) - 1.0
    assert np.abs(off).max() < 0.01


def test_picture_ranks_the_schemes():
    """Worst error up to 500 Hz: the rig's line under 1 %; interpolation and backward Euler lose resonances."""
    found = responses(np.array([50.0, 110.0, 220.0, 340.0, 450.0, 500.0]))
    error = {name: float(np.abs(z / found["exact"] - 1.0).max()) for name, z in found.items()}
    assert error["rig ends"] < 0.01
    assert error["rig ends"] < error["moc"] < error["cds3/bdf2"]
    assert min(error["moc at Courant 0.5"], error["fem/backward-euler"]) > 1.0


def test_control_takes_them():
    """Single impedance and the matrix, evaluated at a frequency."""
    exact = exact_response(PIPE, "unsteady", OMEGA)
    data = frequency_response_data(OMEGA, impedance(exact))
    assert isinstance(data, control.FrequencyResponseData)
    assert data.eval(OMEGA[1]) == pytest.approx(impedance(exact)[1], rel=1e-12)
    assert frequency_response_data(OMEGA, exact).eval(OMEGA[2]) == pytest.approx(exact[2], rel=1e-12)


@pytest.mark.parametrize("name", ["brunone", "quasi-steady"])
def test_only_linear_lines_have_a_response(name: str):
    with pytest.raises(ValueError, match=f"friction {name} is not linear"):
        characteristics_response(PIPE, friction(name), CELLS, OMEGA)
    with pytest.raises(ValueError, match=f"friction {name} is not linear"):
        lines_response(PIPE, grid("fem", 8, 2.0), "bdf2", friction(name), STEP, OMEGA)
