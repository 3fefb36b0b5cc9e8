"""Pressure over length and time of each pipe, as pictures with axes of their own in Rerun's 2-D view.

Time runs to the right, length upwards, WIDTH by HEIGHT units; the picture is the profile, a pixel a place and instant,
stretched. Of a recording it holds the whole run, and a line stands at the cursor's time; live there is one after the
other, each of the seconds up to then, now on the right.
"""

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge.drawing.colours import LEGEND, pressure_colours
from bridge.view.timeline import time_column
from controller.grid import NS

WIDTH, HEIGHT = 900.0, 200.0
MOST_COLUMNS = 1500
DROP = 16.0  # a label hangs below its point
INK, FAINT = (214, 220, 228), (168, 176, 188)


def entity(pipe: int) -> str:
    """Where the map of a pipe stands, counted from 0."""
    return f"along/pipe_{pipe + 1}"


def picture(pressure: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Pressures (instants, places) as an image (places, instants, 3), the first place below."""
    step = max(1, -(-len(pressure) // MOST_COLUMNS))
    return np.ascontiguousarray(pressure_colours(pressure[::step]).transpose(1, 0, 2)[::-1])


def draw(stream: Any, pipe: int, pressure: NDArray[np.float64]) -> None:
    """Put a pipe's picture into its frame, for all times."""
    import rerun as rr

    image = picture(pressure)
    size = WIDTH / image.shape[1], HEIGHT / image.shape[0]
    stream.log(f"{entity(pipe)}/picture", rr.Transform3D(mat3x3=np.diag([*size, 1.0])), static=True)
    stream.log(f"{entity(pipe)}/picture", rr.Image(image, magnification_filter="Linear", draw_order=-10.0), static=True)


def draw_at(stream: Any, pipe: int, pressure: NDArray[np.float64], stamp: int) -> None:
    """Put a pipe's picture into its frame from a time [ns] on: Rerun's server keeps for good what is for all times."""
    import rerun as rr

    image = picture(pressure)
    height, width, _ = image.shape
    form = rr.components.ImageFormat(width, height, color_model="RGB", channel_datatype="U8")
    columns = [
        *rr.Transform3D.columns(mat3x3=[np.diag([WIDTH / width, HEIGHT / height, 1.0])]),
        *rr.Image.columns(
            buffer=image.reshape(1, -1), format=[form], magnification_filter=["Linear"], draw_order=[-10.0]
        ),
    ]
    stream.send_columns(f"{entity(pipe)}/picture", [time_column(np.array([stamp]))], columns)


def frame(stream: Any, pipe: int, length: float, begin: float, end: float, what: str, ends: tuple[str, str]) -> None:
    """The axes of a pipe's picture: its length [m], times [s], what time means, the names of its ends."""
    import rerun as rr

    border = [[[0, 0], [WIDTH, 0], [WIDTH, HEIGHT], [0, HEIGHT], [0, 0]]]
    times, lengths = marks(begin, end, 8), marks(0.0, length, 4)
    across = [WIDTH * (t - begin) / (end - begin) for t in times]
    up = [HEIGHT * (1.0 - x / length) for x in lengths]
    ticks = [[[x, HEIGHT], [x, HEIGHT + 6]] for x in across] + [[[-6, y], [0, y]] for y in up]
    stream.log(f"{entity(pipe)}/axes", rr.LineStrips2D([*border, *ticks], radii=0.6, colors=[FAINT]), static=True)
    at = [[x, HEIGHT + 22] for x in across] + [[-38, y] for y in up]
    words = [f"{t:g} s" for t in times] + [f"{x:g} m" for x in lengths]
    names = [[WIDTH / 2, HEIGHT + 56], [WIDTH / 2, -20], [80, HEIGHT - 20], [80, 20]]
    _words(stream, f"{entity(pipe)}/marks", at, words, FAINT)
    title = f"pipe {pipe + 1}: pressure [bar] over length [m] and time [s]"
    _words(stream, f"{entity(pipe)}/words", names[:2], [what, title], INK)
    _words(stream, f"{entity(pipe)}/ends", names[2:], list(ends), INK)
    _legend(stream, pipe)


def _words(stream: Any, where: str, at: list, words: list[str], colour: Any) -> None:
    import rerun as rr

    raised = [[x, y - DROP] for x, y in at]
    stream.log(where, rr.Points2D(raised, radii=0.01, labels=words, colors=[colour], show_labels=True), static=True)


def _legend(stream: Any, pipe: int) -> None:
    import rerun as rr

    heights = np.linspace(0.0, HEIGHT, 101)
    pressure = np.linspace(LEGEND[-1], LEGEND[0], 100) * 1e5
    strips = [[[WIDTH + 30, a], [WIDTH + 30, b]] for a, b in pairwise(heights)]
    bar = rr.LineStrips2D(strips, radii=8.0, colors=pressure_colours(pressure))
    stream.log(f"{entity(pipe)}/legend/bar", bar, static=True)
    span = LEGEND[-1] - LEGEND[0]
    at = [[WIDTH + 66, HEIGHT * (LEGEND[-1] - mark) / span] for mark in LEGEND]
    _words(stream, f"{entity(pipe)}/legend/marks", at, [f"{mark:g} bar" for mark in LEGEND], FAINT)


def cursor(stream: Any, pipe: int, stamps: NDArray[np.int64]) -> None:
    """A line at the time of the cursor."""
    import rerun as rr

    x = WIDTH * (stamps - stamps[0]) / max(1, stamps[-1] - stamps[0])
    strips = np.stack([np.stack([x, np.full_like(x, -4.0)], 1), np.stack([x, np.full_like(x, HEIGHT + 4.0)], 1)], 1)
    stream.log(f"{entity(pipe)}/cursor", rr.LineStrips2D.from_fields(radii=1.2, colors=[(255, 255, 255)]), static=True)
    stream.send_columns(f"{entity(pipe)}/cursor", [time_column(stamps)], rr.LineStrips2D.columns(strips=strips))


def marks(low: float, high: float, about: int) -> list[float]:
    """Round numbers between two, about so many of them."""
    rough = (high - low) / about
    power = 10.0 ** np.floor(np.log10(rough))
    step = float(min((m * power for m in (1.0, 2.0, 2.5, 5.0, 10.0)), key=lambda s: abs(s - rough)))
    return [
        round(k * step, 9) for k in range(round(np.ceil(low / step - 1e-9)), round(np.floor(high / step + 1e-9)) + 1)
    ]


def seconds(stamps: NDArray[np.int64]) -> tuple[float, float]:
    """First and last of stamps [s], apart."""
    begin, end = float(stamps[0]) / NS, float(stamps[-1]) / NS
    return begin, max(end, begin + 1e-3)
