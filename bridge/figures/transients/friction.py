"""Unsteady against quasi-steady friction in the rig: the same run of the whole circuit with either in every line.

2.7, successful c. The run is `valve-slam`: at full speed up the valve shuts in 1 ms; the lower line and its chamber
swing against the load at some 29 Hz, which the seal's friction damps as well, and in waves of their own above. The
number is the rate at which the swing of the lower chamber decays, of each of the two: the slope of the logarithm of its
rms in successive windows of a cycle of the load.
"""

import itertools
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.drawing.canvas import Array, Axes, Columns, Sheet, label, remark, stack
from bridge.loop.exchange import exchange, sides
from bridge.scenario import Scenario, load
from twin.topology import LINES

KINDS = {"quasi-steady": "tab:red", "unsteady": "black"}
READ, END = 1e-4, 1.05  # [s]
SHUT, FROM, TO = 0.6, 0.65, 0.97  # [s]: `valve-slam` shuts, and where the decay is read
WINDOW = 0.035  # [s], a cycle of the load
SPLIT = 60.0  # [Hz], between the load's swing and the waves
HEARD = 0.03  # of the first window's rms, below which a window is not used
SIGNALS = {"p_a": "line 3 at the shut valve", "p_lower": "lower chamber"}


class Decay(NamedTuple):
    """How a swing dies, window by window."""

    middle: Array  # of the windows [s]
    level: Array  # rms [Pa]

    @property
    def heard(self) -> NDArray[np.bool_]:
        """The windows that are used."""
        return self.level > HEARD * self.level[0]

    @property
    def line(self) -> Array:
        """Slope [1/s] and intercept of ln level over time."""
        return np.polyfit(self.middle[self.heard], np.log(self.level[self.heard]), 1)

    @property
    def rate(self) -> float:
        """Of decay [1/s]."""
        return -float(self.line[0])


def scenario(kind: str) -> Scenario:
    """The run with a friction in all lines."""
    lines = [f"rig.pipe_{line}.friction={kind}" for line in range(1, LINES + 1)]
    return load("valve-slam", [*lines, f"duration={END}", f"loop.daq_period={READ}", "expect=[]"])


@cache
def run(kind: str) -> dict[str, Array]:
    """True pressures [Pa] over `stamp` [s]."""
    plant, controller = sides(scenario(kind))
    ticks = exchange(plant, controller, scenario(kind).ticks)
    states = [out.message for messages in ticks for out in messages if out.topic == "state"]
    names = "stamp", *SIGNALS
    seen: dict[str, Array] = {name: np.array([getattr(state, name) for state in states]) for name in names}
    seen["stamp"] = 1e-9 * seen["stamp"]
    return seen


def parts(time: Array, pressure: Array) -> dict[str, Array]:
    """The swing below and above SPLIT [Pa], from SHUT on, without shift in time."""
    from scipy.signal import butter, sosfiltfilt

    after = time >= SHUT
    swing = pressure[after] - pressure[after].mean()
    waves = sosfiltfilt(butter(4, SPLIT, "highpass", fs=1.0 / READ, output="sos"), swing)
    return {"load": swing - waves, "waves": waves}


def decay(time: Array, swing: Array) -> Decay:
    """The rms about the mean in windows between FROM and TO."""
    edges = np.arange(FROM, TO + 1e-9, WINDOW)
    inside = [swing[(time >= a) & (time < b)] for a, b in itertools.pairwise(edges)]
    return Decay(0.5 * (edges[1:] + edges[:-1]), np.array([part.std() for part in inside]))


def decays(kind: str) -> dict[str, Decay]:
    """Of the load's swing and of the waves, with a friction."""
    seen = run(kind)
    time = seen["stamp"][seen["stamp"] >= SHUT]
    return {name: decay(time, swing) for name, swing in parts(seen["stamp"], seen["p_lower"]).items()}


def draw() -> tuple[Columns, Sheet]:
    """Pressures over each other, and the rms of both swings with the rates of decay."""
    page, (upper, middle, lower) = stack("Unsteady and quasi-steady friction in the rig", (1.2, 1.2, 1.2))
    columns: Columns = {"time [s]": run("unsteady")["stamp"]}
    for kind, colour in KINDS.items():
        seen = run(kind)
        for axes, (name, words) in zip((upper, middle), SIGNALS.items(), strict=True):
            axes.plot(seen["stamp"], 1e-5 * seen[name], color=colour, linewidth=0.8, label=kind)
            label(axes, "", f"{words} [bar]")
            columns[f"{name} {kind} [Pa]"] = seen[name]
        _draw_decays(lower, kind, colour)
    upper.legend(frameon=False, fontsize=8, loc="upper right", ncols=2)
    upper.set_xlim(SHUT - 0.02, END)
    lower.set(yscale="log", ylim=(0.02, 20.0))
    lower.legend(frameon=False, fontsize=8, loc="lower left", ncols=2)
    label(lower, "t [s]", "rms, lower chamber [bar]")
    remark(page, f"The valve shuts in 1 ms at {SHUT} s, at full speed up. Load: below {SPLIT:.0f} Hz; waves: above.")
    return columns, page


def _draw_decays(axes: Axes, kind: str, colour: str) -> None:
    for (name, found), mark in zip(decays(kind).items(), ("o", "x"), strict=True):
        used = found.heard
        words = f"{kind}, {name}: {found.rate:.1f} 1/s"
        axes.plot(found.middle[used], 1e-5 * found.level[used], mark, color=colour, markersize=5, label=words)
        axes.plot(found.middle[used], 1e-5 * np.exp(np.polyval(found.line, found.middle[used])), "--", color=colour,
                  linewidth=0.8)  # fmt: skip
