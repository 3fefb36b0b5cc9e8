"""The controller `state-space` of a scenario: its matrices, checked against one another, and the signals it reads."""

import math
from typing import Literal

from bridge.scenario.fields import Part

Matrix = list[list[float]]
Signal = Literal["error", "position", "velocity", "p1", "p2", "p3", "reference", "reference velocity"]
FROM = "file beside the scenario with A, B, C, D, dt and perhaps inputs: .json, .npz or .mat (up to -v7)"
SAME = 1e-9  # [s], between dt and the sampling period
READS = "signals in the order of B's columns; error = x_ref - x and position in m, velocity in m/s, p1 to p3 in Pa"


class Origin(Part):
    """The file that matrices were read from."""

    file: str
    sha256: str


def refuse_matrices(a: Matrix, b: Matrix, c: Matrix, d: Matrix, inputs: int) -> None:
    """Raises ValueError for matrices that do not fit one another, or are not finite."""
    states = len(a)
    expected = {"A": (a, states, states), "B": (b, states, inputs), "C": (c, 1, states), "D": (d, 1, inputs)}
    for name, (matrix, rows, columns) in expected.items():
        if [len(row) for row in matrix] != [columns] * rows:
            raise ValueError(
                f"{name} is {_shape(matrix)}, expected {rows} x {columns}: {_reason(name, states, inputs)}"
            )
        if not all(math.isfinite(number) for row in matrix for number in row):
            raise ValueError(f"{name} holds a number that is not finite; give finite numbers")


def _reason(name: str, states: int, inputs: int) -> str:
    of = {"A": "A is square", "B": f"A has {states} rows, there are {inputs} inputs"}
    return of.get(name, f"one output, {states} states, {inputs} inputs")


def _shape(matrix: Matrix) -> str:
    widths = {len(row) for row in matrix}
    return "ragged" if len(widths) > 1 else f"{len(matrix)} x {widths.pop() if widths else 0}"
