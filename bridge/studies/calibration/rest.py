"""p2 while the piston rests with its weight between load change and restart, at the four pump speeds."""

from collections.abc import Mapping
from typing import Any

from bridge.studies.calibration.experiment import LIFT, SPEEDS, UP, circuit_for, run
from bridge.studies.calibration.facts import BAR, PLACE

AFTER = (0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1.1, 1.2)  # [s] after the command to stop
WINDOW = 0.02  # [s], about each of them, of which the mean is taken
Row = tuple[float, ...]


def pressures_at_rest(rig: Mapping[str, Mapping[str, Any]]) -> dict[int, tuple[Row, Row]]:
    """By pump speed [rpm]: p2 and p2 - p3 [bar] at the times AFTER."""
    place = rig.get("start", {}).get("position", PLACE)
    circuit = circuit_for({part: entries for part, entries in rig.items() if part != "start"})
    return {speed: _rows(run(circuit, speed, place), UP + LIFT[speed]) for speed in SPEEDS}


def _rows(course: Any, stop: float) -> tuple[Row, Row]:
    def mean(name: str, after: float) -> float:
        return float(course.between(name, stop + after - 0.5 * WINDOW, stop + after + 0.5 * WINDOW).mean()) / BAR

    lower = tuple(mean("p_lower", after) for after in AFTER)
    return lower, tuple(p - mean("p_upper", after) for p, after in zip(lower, AFTER, strict=True))
