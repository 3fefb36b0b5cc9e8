"""Which stability chart is of which damping and derivative gain: figures 5.8 to 5.19."""

from typing import NamedTuple

VALUES = (0.0, 0.1, 0.5, 1.0, 10.0, 1000.0)


class Damped(NamedTuple):
    """What one chart is of."""

    k: float
    d: float


CHARTS = {f"5.{8 + i}": Damped(k, 0.0) for i, k in enumerate(VALUES)} | {
    f"5.{14 + i}": Damped(0.0, d) for i, d in enumerate(VALUES)
}
