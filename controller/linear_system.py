"""A sampled linear system as a control law: z <- A z + B e, h = P (C z + D e), with e the error of the position.

P is the scenario's proportional gain [1/m], so the system has no unit: it takes the place of 1 in h = P e. Then the
dead band is jumped over and the command saturated, as for `pd`.
"""

from collections.abc import Sequence

from controller.law import Gains, Law, Sample, compensate, saturate
from controller.reference import Target
from controller.state_space import dot

Matrix = Sequence[Sequence[float]]
SAME = 1e-9  # [s], between a system's dt and the sampling period


def system_law(a: Matrix, b: Matrix, c: Matrix, d: Matrix, dt: float) -> Law:
    """The law of one input and one output. It refuses another sampling period than dt [s] by ValueError."""
    entry, row, direct = [line[0] for line in b], list(c[0]) if len(c) else [], float(d[0][0])

    def law(sample: Sample, target: Target, memory: list[float] | None, gains: Gains) -> tuple[float, list[float]]:
        if abs(gains.sample_period - dt) > SAME:
            raise ValueError(f"the system has dt {dt:g} s, loop.sample_period is {gains.sample_period:g} s")
        z, error = memory or [0.0] * len(entry), target.position - sample.position
        h = gains.proportional * (dot(row, z) + direct * error)
        then = [dot(line, z) + entry_i * error for line, entry_i in zip(a, entry, strict=True)]
        return saturate(compensate(h, gains.overlap), gains.limit), then

    law.system = (a, entry, row, direct)  # pyright: ignore[reportFunctionMemberAccess]
    return law
