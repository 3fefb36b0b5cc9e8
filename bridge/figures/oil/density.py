"""The oil's density by 13 weighings on the twin, fitted by Wald's line.

Source: 2.2.3, (2.1), (2.2). A measuring cylinder is filled step by step; mass and volume err alike, so that least
squares would bend the line. The volumes follow from the relative errors that the thesis prints: 0.94 to 0.103 %.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from bridge.drawing.canvas import Array, Columns, Sheet, label, remark, sheet
from bridge.figures.oil.line_fit import Line, fit_line
from twin.rig import rig_number

WEIGHINGS = 13
DEVIATION = 0.5 / 2.228  # of a mass [g] and of a volume [ml], 2.2.3
LEAST, MOST = DEVIATION / 0.94e-2, DEVIATION / 0.103e-2  # volumes [ml]
PRINTED, PRINTED_DEVIATION = 876.56, 0.597  # [kg/m^3], (2.2)
SEED = 3
GRAM_PER_ML = 1e3  # [kg/m^3]


class Weighings(NamedTuple):
    """What was read, an entry per weighing."""

    volume: Array  # [m^3]
    mass: Array  # [kg]


def density() -> float:
    """The twin's own [kg/m^3]."""
    return rig_number("oil", "density")


def weigh(seed: int = SEED, deviation: float = DEVIATION) -> Weighings:
    """Even fillings of the twin's oil, read with a deviation [g] of the mass and [ml] of the volume."""
    true = np.linspace(LEAST, MOST, WEIGHINGS)
    off = deviation * np.random.default_rng(seed).standard_normal((2, WEIGHINGS))
    return Weighings(1e-6 * (true + off[0]), 1e-3 * (density() / GRAM_PER_ML * true + off[1]))


def fit(read: Weighings, deviation: float = DEVIATION) -> Line:
    """Mass over volume: the slope is the density [kg/m^3]."""
    return fit_line(read.volume, read.mass, 1e-6 * deviation, 1e-3 * deviation)


@cache
def measured() -> tuple[Weighings, Line]:
    """What the figure shows."""
    read = weigh()
    return read, fit(read)


def draw_density() -> tuple[Columns, Sheet]:
    """Mass over volume, and how far each weighing is from the line."""
    read, line = measured()
    fitted = line.slope * read.volume + line.intercept
    page, (left, right) = sheet("Density of the oil: 13 weighings on the twin", panels=2)
    name = f"Wald: {line.slope:.2f} ± {line.slope_deviation:.2f} kg/m³"
    left.plot(1e6 * read.volume, 1e3 * fitted, color="tab:red", linewidth=1.0, label=name)
    left.plot(1e6 * read.volume, 1e3 * read.mass, "o", color="tab:blue", markersize=5, label="weighed")
    left.legend(frameon=False)
    label(left, "volume [ml]", "mass [g]")
    right.errorbar(
        1e6 * read.volume, 1e3 * (read.mass - fitted), xerr=DEVIATION, yerr=DEVIATION, fmt="o", markersize=4, capsize=2
    )
    right.axhline(0.0, color="tab:red", linewidth=1.0)
    label(right, "volume [ml]", "mass over the line [g]")
    remark(
        page,
        f"The twin's oil has {density():g} kg/m³; the thesis: {PRINTED} ± {PRINTED_DEVIATION} kg/m³, "
        f"which errors of {DEVIATION:.4f} g and ml do not give: 13 even fillings have ± {line.slope_deviation:.2f}.",
    )
    columns = {"volume [m^3]": read.volume, "mass [kg]": read.mass, "fitted mass [kg]": fitted}
    numbers = {"density [kg/m^3]": line.slope, "deviation of the density [kg/m^3]": line.slope_deviation}
    return columns | {name: np.full(WEIGHINGS, value) for name, value in numbers.items()}, page
