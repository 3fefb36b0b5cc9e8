"""Figure 2.2: the oil's viscosity, measured on the twin with a falling ball and fitted in two ways.

Source: (2.3) to (2.7). The ball falls through oil that obeys the second-order law; thermometer and stop watch err.
First order: nu_0 exp(-lambda theta), by Wald's line through (T, ln nu), as both coordinates err. Second order:
nu_0 exp(-lambda_1 theta + lambda_2 theta^2), by least squares on ln nu. theta = T - 20 deg C.
"""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from bridge.drawing.canvas import (
    Array,
    Axes,
    Columns,
    Sheet,
    label,
    sheet,
)
from bridge.figures.oil.line_fit import Line, fit_line
from twin.oil import SECONDS_TO_VISCOSITY, exponential_viscosity, kinematic_viscosity

OIL_DENSITY = 876.56  # [kg/m^3], 2.2.3, as in the viscometer's constant
REFERENCE = 20.0  # T_0 [deg C], (2.7)
TEMPERATURES = np.arange(25.0, 75.1, 5.0)  # [deg C], the span of the thesis's figure
READINGS = 3  # per point, 2.2.3
THERMOMETER = 0.5  # [deg C], standard deviation, 2.2.3
STOP_WATCH = 0.1  # [s], resolution, assumed
SEED = 22


class Points(NamedTuple):
    """Means of the readings, an entry per point."""

    temperature: Array  # [deg C], by the thermometer
    time: Array  # [s], by the stop watch
    viscosity: Array  # [m^2/s]


class Laws(NamedTuple):
    """What the points tell."""

    first: Line  # ln nu over theta
    second: Array  # coefficients of theta^2, theta, 1 in ln nu


def fall_time(viscosity: float) -> float:
    """Time [s] that the ball needs in oil of a viscosity [m^2/s], (2.3)."""
    return viscosity * OIL_DENSITY / SECONDS_TO_VISCOSITY


def measure(
    law: Callable[[float], float] = kinematic_viscosity,
    thermometer: float = THERMOMETER,
    stop_watch: float = STOP_WATCH,
    seed: int = SEED,
) -> Points:
    """Each point the mean of its readings. thermometer: deviation [deg C]; stop_watch: resolution [s], 0 for none."""
    times = np.repeat([[fall_time(law(t))] for t in TEMPERATURES], READINGS, axis=1)
    # the watch starts anywhere between two of its ticks: without that, three equal falls would read alike
    random = np.random.default_rng(seed)
    shown = TEMPERATURES + thermometer * random.standard_normal(times.shape).mean(axis=1)
    if stop_watch > 0.0:
        times = stop_watch * np.floor(times / stop_watch + random.random(times.shape))
    time = times.mean(axis=1)
    return Points(shown, time, time * SECONDS_TO_VISCOSITY / OIL_DENSITY)


def fit(points: Points, thermometer: float = THERMOMETER, stop_watch: float = STOP_WATCH) -> Laws:
    """Both laws through the points; the deviations are those of single readings."""
    theta, log_viscosity = points.temperature - REFERENCE, np.log(points.viscosity)
    of_log = stop_watch / np.sqrt(6.0) / points.time.mean()  # a tick early or late, uniformly: triangular
    line = fit_line(theta, log_viscosity, thermometer / np.sqrt(READINGS), of_log / np.sqrt(READINGS))
    return Laws(line, np.polyfit(theta, log_viscosity, 2))


def first_order(temperature: Array, laws: Laws) -> Array:
    """Fitted nu [m^2/s] at temperatures [deg C], (2.5)."""
    return np.exp(laws.first.intercept + laws.first.slope * (temperature - REFERENCE))


def second_order(temperature: Array, laws: Laws) -> Array:
    """Fitted nu [m^2/s] at temperatures [deg C], (2.6)."""
    return np.exp(np.polyval(laws.second, temperature - REFERENCE))


def source_laws(temperature: Array) -> tuple[Array, Array]:
    """The thesis's own first-order and second-order nu [m^2/s] at temperatures [deg C]."""
    first = np.array([exponential_viscosity(t) for t in temperature])
    return first, np.array([kinematic_viscosity(t) for t in temperature])


@cache
def viscosity_fit() -> tuple[Points, Laws]:
    """The figure's measurement and what it gives."""
    points = measure()
    return points, fit(points)


def viscosity_columns() -> Columns:
    """The points, both laws at their temperatures, fitted and the thesis's, and the fitted constants."""
    points, laws = viscosity_fit()
    first, second = source_laws(points.temperature)
    table = {
        "temperature [degC]": points.temperature,
        "fall time [s]": points.time,
        "viscosity [m^2/s]": points.viscosity,
        "first order fitted [m^2/s]": first_order(points.temperature, laws),
        "first order source [m^2/s]": first,
        "second order fitted [m^2/s]": second_order(points.temperature, laws),
        "second order source [m^2/s]": second,
    }
    return table | {name: np.full(len(first), value) for name, value in constants(laws).items()}


def constants(laws: Laws) -> dict[str, float]:
    """The fitted constants of (2.5) and (2.6), by their table headings."""
    return {
        "first order nu_0 [m^2/s]": float(np.exp(laws.first.intercept)),
        "first order lambda [1/degC]": -laws.first.slope,
        "first order lambda deviation [1/degC]": laws.first.slope_deviation,
        "second order nu_0 [m^2/s]": float(np.exp(laws.second[2])),
        "second order lambda_1 [1/degC]": -float(laws.second[1]),
        "second order lambda_2 [1/degC^2]": float(laws.second[0]),
    }


def draw_viscosity() -> tuple[Columns, Sheet]:
    """Figure 2.2, in mm^2/s."""
    points, laws = viscosity_fit()
    page, (axes,) = sheet("2.2  Viscosity of the oil: falling ball on the twin, and two laws fitted")
    deviation = THERMOMETER / np.sqrt(READINGS)
    name = f"measured, mean of {READINGS} readings, σ(T) = {deviation:.2f} °C"
    axes.errorbar(
        points.temperature, 1e6 * points.viscosity, xerr=deviation, fmt="o", markersize=5, capsize=2, label=name
    )
    _draw_laws(axes, laws)
    label(axes, "temperature T [°C]", "kinematic viscosity ν [mm²/s]")
    axes.legend(title="θ = T − 20 °C", frameon=False)
    return viscosity_columns(), page


def _draw_laws(axes: Axes, laws: Laws) -> None:
    grid = np.linspace(TEMPERATURES[0] - 1.0, TEMPERATURES[-1] + 1.0, 200)
    first, second = source_laws(grid)
    found = list(constants(laws).values())
    wald = f"Wald: {1e6 * found[0]:.2f} exp(−{found[1]:.4f} θ),  λ ± {found[2]:.4f}"
    squares = f"least squares: {1e6 * found[3]:.2f} exp(−{found[4]:.4f} θ + {1e4 * found[5]:.2f}·10⁻⁴ θ²)"
    for law, style, colour, name in (
        (first_order(grid, laws), "--", "tab:red", wald),
        (first, ":", "tab:red", "source: 92.79 exp(−0.0401 θ)"),
        (second_order(grid, laws), "-", "tab:green", squares),
        (second, ":", "black", "source: 117.95 exp(−0.0608 θ + 3.45·10⁻⁴ θ²)"),
    ):
        axes.plot(grid, 1e6 * law, style, color=colour, linewidth=1.5, label=name)
