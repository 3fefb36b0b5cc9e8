"""A scenario's rig as a mark on a dimensionless chart of stability, and in words where it differs from the chart."""

from collections.abc import Mapping
from typing import Any

from bridge.studies.stability.equivalent import Scaled

SYMBOLS = {"gain": "s", "derivative": "d", "period": "tau", "delay": "delay", "damping": "k", "gamma": "gamma"}
SHOWN = {"delay": "delay/tau"}  # where the field's name is not what a reader sees
NEAR = 0.02  # of a number: closer is the same
COLOUR = "#7b2cbf"
OUTWARDS = {(1, 0): ">", (-1, 0): "<", (0, 1): "^", (0, -1): "v"}
Range = tuple[float, float]


def place(marked: Scaled, across: str, up: str) -> tuple[float, float]:
    """Where the mark belongs on a chart over two of SYMBOLS."""
    return getattr(marked.numbers, SYMBOLS[across]), getattr(marked.numbers, SYMBOLS[up])


def mark_words(marked: Scaled, across: str, up: str, ranges: tuple[Range, Range], fixed: Mapping[str, float]) -> str:
    """Where the rig lies, whether that is out of the chart, and which fixed numbers of the chart are not its own."""
    words = []
    for axis, value, (low, high) in zip((across, up), place(marked, across, up), ranges, strict=True):
        beyond = "" if low <= value <= high else f", out of this chart ({low:.3g} to {high:.3g})"
        words.append(f"{_symbol(axis)} {value:.3g}{beyond}")
    for axis, value in fixed.items():
        if axis in SYMBOLS and axis not in (across, up):
            own = float(getattr(marked.numbers, SYMBOLS[axis]))
            if abs(own - value) > NEAR * max(abs(own), abs(value)):
                words.append(f"{_symbol(axis)} {own:.3g} where this chart has {value:.3g}")
    return f"Mark: the rig of {marked.scenario}, {'; '.join(words)}"


def draw_mark(axes: Any, marked: Scaled, across: str, up: str) -> Any:
    """The mark, at the border and pointing outwards where it lies beyond; the key."""
    spans = axes.get_xlim(), axes.get_ylim()
    at = place(marked, across, up)
    inside = [min(max(value, low), high) for value, (low, high) in zip(at, spans, strict=True)]
    sides = [int(value > high) - int(value < low) for value, (low, high) in zip(at, spans, strict=True)]
    marker = "D" if not any(sides) else OUTWARDS.get((sides[0], sides[1]), "X")
    style: dict[str, Any] = {"linestyle": "", "color": COLOUR, "markersize": 9, "markeredgecolor": "w"}
    words = f"{marked.scenario}{', beyond this border' if any(sides) else ''}"
    return axes.plot(*([value] for value in inside), marker, label=words, clip_on=False, zorder=5, **style)[0]


def _symbol(axis: str) -> str:
    return SHOWN.get(axis, SYMBOLS[axis])
