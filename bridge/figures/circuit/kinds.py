"""Symbols of what a drive may have beside the rig of the thesis: accumulator, accessories, motor, loads, return end."""

from bridge.drawing.canvas import Axes
from bridge.figures.circuit.symbols import INK, OIL, arrow, box, circle, dot, part_of, shape, spring, text, thin
from bridge.scenario.fitted import Values, kind_of, word

TURNING = "turning"  # the part of the picture that turns when it is live
ROD, METAL, GAS, GREEN = "#c9d1d9", "#8a97a5", "#e3f3ec", "#dcefe2"
SHORT = {
    "counterbalance": "counterbalance",
    "pilot-check": "pilot-operated check",
    "throttle": "throttle",
    "throttle-check": "throttle-check",
}


def beside(axes: Axes, rig: Values) -> None:
    """Accumulator, accessories, cushions, check valve and return end, where they are fitted."""
    if kind_of(rig, "accumulator") != "none":
        _accumulator(axes, rig)
    for slot, y in (("accessory at A", 6.45), ("accessory at B", 8.55)):
        if kind_of(rig, slot) != "none":
            _accessory(axes, y, SHORT[kind_of(rig, slot)])
    if kind_of(rig, "check valve") != "none":
        _check(axes, 7.75, 3.7, 1.0)
        text(axes, 7.72, 3.3, "check", size=8.5)
    end = kind_of(rig, "return end")
    if end != "open":
        text(
            axes,
            12.45,
            0.72,
            "orifice" if end == "orifice" else "orifice and\nback-pressure check",
            ha="left",
            size=8.5,
        )
        thin(axes, (11.65, 1.5), (11.8, 1.35), (11.65, 1.2))
        thin(axes, (12.15, 1.5), (12.0, 1.35), (12.15, 1.2))


def _accumulator(axes: Axes, rig: Values) -> None:
    """A bottle at the end of line 2 or at the tee: the oil where its line comes in, the gas behind it."""
    at_p = word(rig, "accumulator.at") == "p"
    x, sign = (8.3, -1.0) if at_p else (3.1, 1.0)
    thin(axes, (x, 3.7), (x, 3.7 + 0.25 * sign))
    box(axes, x - 0.22, 3.7 + 0.25 * sign, 0.44, 0.5 * sign, OIL)
    box(axes, x - 0.22, 3.7 + 0.75 * sign, 0.44, 0.4 * sign, GAS)
    dot(axes, x, 3.7)
    own = rig["accumulator"]
    words = f"accumulator\n{1e3 * own['volume']:.3g} l, {1e-5 * own['precharge']:.0f} bar"
    text(axes, 7.35 if at_p else x, 2.4 if at_p else 5.2, words, size=8.5, ha="right" if at_p else "center")


def _accessory(axes: Axes, y: float, words: str) -> None:
    """A block in the line, close to the cylinder."""
    box(axes, 11.15, y - 0.2, 0.4, 0.4, GREEN)
    _check(axes, 11.35, y, 0.6)
    text(axes, 10.55, y + 0.95, words, size=8.5)


def _check(axes: Axes, x: float, y: float, size: float) -> None:
    """A ball on its seat; oil flows to the right."""
    circle(axes, x, y, 0.14 * size)
    thin(axes, (x, y + 0.22 * size), (x - 0.18 * size, y), (x, y - 0.22 * size), width=1.1)


def motor(axes: Axes, rig: Values) -> None:
    """A rotary motor for both directions, with its inertia."""
    x, y = 13.3, 7.5
    thin(axes, (12.55, 6.45), (x, 6.45), (x, y - 0.6), width=3.0)
    thin(axes, (12.55, 8.55), (x, 8.55), (x, y + 0.6), width=3.0)
    with part_of(axes, TURNING):
        circle(axes, x, y, 0.6, OIL)
    for sign in (1.0, -1.0):
        shape(axes, ((x - 0.2, y + 0.3 * sign), (x + 0.2, y + 0.3 * sign), (x, y + 0.58 * sign)), INK)
    box(axes, x + 0.6, y - 0.08, 0.7, 0.16, ROD)
    box(axes, x + 1.3, y - 0.45, 0.3, 0.9, METAL)
    own = rig["motor"]
    words = f"motor\n{1e6 * own['displacement']:.3g} cm³ per turn\n{own['inertia']:g} kg m²"
    text(axes, x + 0.75, y + 1.15, words, ha="left", size=8.5)


def held(axes: Axes, rig: Values, low: float) -> None:
    """The load at the end of the rod, and what holds it."""
    kind, load = kind_of(rig, "load"), rig["load"]
    box(axes, 12.5, low, 1.6, 0.6, METAL)
    text(axes, 13.3, low + 0.3, f"{load['mass']:.0f} kg", colour="white", size=10.0)
    if kind == "compliant":
        spring(axes, 14.1, low + 0.3, 0.7)
        box(axes, 14.8, low, 1.4, 0.6, METAL)
        text(axes, 15.5, low + 0.3, f"{load['far_mass']:.0f} kg", colour="white", size=10.0)
    elif kind == "environment":
        spring(axes, 14.1, low + 0.3, 0.7)
        box(axes, 14.8, low - 0.05, 0.2, 0.7, "white", hatch="////")
        text(axes, 15.15, low + 0.3, "springs, dampers", ha="left", size=8.5)
    elif kind == "lever":
        text(axes, 14.3, low + 0.3, "on a lever", ha="left", size=8.5)
        arrow(axes, (14.0, low + 0.7), (14.9, low + 0.62))
