"""Figures 2.28 to 2.30: the piston picks up a weight, stops, and runs into its upper stop, at four pump speeds.

Source: 2.6. It shows measurements beside calculations; the measurements exist only as pictures, so this is the twin
alone. How it is read stands in `course`.
"""

import numpy as np

from bridge.drawing.canvas import (
    Axes,
    Columns,
    Sheet,
    label,
    remark,
    stack,
)
from bridge.figures.transients.course import (
    CARD,
    FINE,
    LENGTH,
    SPEEDS,
    Excerpt,
    excerpt_columns,
    experiment,
    experiment_columns,
    impingement,
    load_change,
)

TAPS = {"p1": "#1f5fbf", "p2": "#1e8f4e", "p3": "#cc2f2f"}  # as in the thesis
RED = "#d62728"
NOTE = "The twin alone: the thesis's measurements exist only as pictures. True values, "


def draw_experiment() -> tuple[Columns, Sheet]:
    """Figure 2.28."""
    page, panels = stack("2.28  Load change and impingement at four pump speeds", [1.0] * len(SPEEDS) + [0.8])
    for speed, axes in zip(SPEEDS, panels, strict=False):
        course = experiment(speed)
        for tap, colour in TAPS.items():
            axes.plot(course.time, 1e-5 * getattr(course, tap), color=colour, linewidth=0.7, label=tap)
        axes.set_ylim(-5.0, 100.0)
        axes.set_ylabel("p [bar]")
        axes.set_title(f"{speed} rpm", loc="left", fontsize=9)
    course = experiment(max(SPEEDS))
    panels[-1].plot(course.time, 1e3 * course.position, color="black", linewidth=1.2)
    panels[-1].set_title(f"{max(SPEEDS)} rpm", loc="left", fontsize=9)
    panels[-1].set_ylim(80.0, 300.0)
    _name_events(panels[-1])
    label(panels[-1], "time [s]", "x [mm]")
    panels[-1].set_xlim(0.5, LENGTH)
    _name_taps(panels[0])
    page.align_ylabels(panels)
    remark(page, NOTE + f"every {1e3 * CARD:g} ms, as the thesis's card read.")
    return experiment_columns(), page


def _name_events(axes: Axes) -> None:
    """What happens, compared with the piston's way at full speed."""
    for time, place, words, side in (
        (0.97, 130.0, "up, 120 kg", "right"),
        (1.16, 138.0, "183 kg join at 138 mm", "left"),
        (1.27, 214.0, "hold: the load sinks by the leak", "left"),
        (2.6, 214.0, "up", "center"),
        (2.95, 250.0, "upper stop, the relief valve bypasses", "left"),
    ):
        axes.text(time, place, words, fontsize=8, color="0.25", ha=side, va="center")


def _name_taps(axes: Axes) -> None:
    from matplotlib.lines import Line2D

    words = {"p1": "p1 relief valve", "p2": "p2 lower chamber", "p3": "p3 upper chamber"}
    lines = [Line2D([], [], color=TAPS[tap], linewidth=1.8, label=name) for tap, name in words.items()]
    axes.legend(
        handles=lines,
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncols=3,
        frameon=False,
        fontsize=9,
        borderaxespad=0.0,
    )


def draw_load_change() -> tuple[Columns, Sheet]:
    """Figure 2.29."""
    return _draw(
        load_change(), "2.29  Load change: 120 kg, then 183 kg more from 138 mm on, pump at 1230 rpm", (90.0, 285.0)
    )


def draw_impingement() -> tuple[Columns, Sheet]:
    """Figure 2.30."""
    return _draw(impingement(), "2.30  Impingement: 303 kg run into the upper stop, pump at 1230 rpm", (120.0, 285.0))


def _draw(excerpt: Excerpt, title: str, reach: tuple[float, float]) -> tuple[Columns, Sheet]:
    from matplotlib.ticker import MultipleLocator

    course = excerpt.transient
    page, panels = stack(title, [1.0, 1.0, 0.8, 0.8])
    for axes, (tap, colour) in zip(panels, TAPS.items(), strict=False):
        values = 1e-5 * getattr(course, tap)
        axes.fill_between(
            course.time,
            0.0,
            1.0,
            where=list(course.relieved > 0.0),
            step="mid",
            transform=axes.get_xaxis_transform(),
            color=RED,
            alpha=0.22,
            linewidth=0.0,
        )
        axes.plot(course.time, values, color=colour, linewidth=1.0)
        axes.set_ylabel(f"{tap} [bar]")
        axes.set_ylim(-6.0, 20.0 * np.ceil(0.05 * values.max() + 0.2))
        axes.yaxis.set_major_locator(MultipleLocator(20.0))
    panels[3].plot(course.time, 1e3 * course.position, color="black", linewidth=1.4)
    panels[3].set_ylim(*reach)
    label(panels[3], "time [s]", "x [mm]")
    panels[3].set_xlim(excerpt.bounds[0], excerpt.bounds[-1])
    for axes in panels:
        for bound in excerpt.bounds[1:-1]:
            axes.axvline(bound, color="0.45", linewidth=0.8, linestyle=(0, (4, 3)))
    _name_periods(panels[0], excerpt)
    page.align_ylabels(panels)
    remark(page, NOTE + f"every {1e3 * FINE:g} ms.  Red: oil passes the relief valve.")
    return excerpt_columns(excerpt), page


def _name_periods(axes: Axes, excerpt: Excerpt) -> None:
    arrow = {"arrowstyle": "<->", "color": "0.3", "linewidth": 0.9, "shrinkA": 0.0, "shrinkB": 0.0}
    across = axes.get_xaxis_transform()
    for letter, begin, end in zip(excerpt.letters, excerpt.bounds, excerpt.bounds[1:], strict=False):
        axes.annotate("", (begin, 1.06), (end, 1.06), across, across, arrowprops=arrow, annotation_clip=False)
        words = " (".join(f"{part})" for part in letter.split(", "))
        axes.text(0.5 * (begin + end), 1.10, f"({words}", transform=across, ha="center", va="bottom", fontsize=9)
