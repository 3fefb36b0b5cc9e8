"""The figures of the source, drawn again from the twin, and its circuit: each a picture and the table behind it.

A figure bears the source's number. Its numbers are computed apart from its drawing; both are the same at every run.
"""

import csv
import difflib
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from bridge.figures import (
    friction,
    lines_characteristics,
    lines_friction,
    lines_orders,
    lines_response,
    oil,
    rig,
    transients,
)
from bridge.figures.canvas import Columns, Sheet


class Figure(NamedTuple):
    """One figure."""

    name: str  # its number in the source; also the name of its files
    title: str
    draw: Callable[[], tuple[Columns, Sheet]]


_ALL = (
    Figure("2.2", "Viscosity of the oil over its temperature", oil.draw_viscosity),
    Figure("2.4", "Seal friction over the speed of the piston", friction.draw_over_speed),
    Figure("2.5", "Seal friction over the pressure difference", friction.draw_over_pressure),
    Figure("2.6", "Friction factor over the dimensionless speed", friction.draw_factor),
    Figure("2.23", "Characteristics: whole steps and interpolated half steps", lines_characteristics.draw),
    Figure("2.25", "Schemes for waves, a smooth wave: error and work", lines_orders.draw_smooth),
    Figure("2.26", "Schemes for waves, steep fronts: error and work", lines_orders.draw_steep),
    Figure("2.27", "Friction models on a water hammer, beside the exact line", lines_friction.draw),
    Figure("2.28", "Load change and impingement at four pump speeds", transients.draw_experiment),
    Figure("2.29", "Load change: pressures, position, relief valve", transients.draw_load_change),
    Figure("2.30", "Impingement: pressures, position, relief valve", transients.draw_impingement),
    Figure("line-response", "Impedance of a line: exact, and of each scheme", lines_response.draw),
    Figure("circuit", "The circuit, from the rig's own numbers", rig.draw_circuit),
)
FIGURES: dict[str, Figure] = {figure.name: figure for figure in _ALL}


def draw_figure(name: str, directory: str | Path) -> tuple[Path, Path]:
    """Write NAME.png and NAME.csv into a directory, made if absent; returns both paths. ValueError: no such figure."""
    if name not in FIGURES:
        nearest = difflib.get_close_matches(name, FIGURES, n=4, cutoff=0.5) or list(FIGURES)
        raise ValueError(f"no figure {name!r}; nearest: {', '.join(nearest)}")
    columns, sheet = FIGURES[name].draw()
    directory = Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    picture, table = directory / f"{name}.png", directory / f"{name}.csv"
    sheet.savefig(picture)
    _write(table, columns)
    return picture, table


def _write(path: Path, columns: Columns) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(columns)
        rows.writerows([f"{value:.9g}" for value in row] for row in zip(*columns.values(), strict=True))
