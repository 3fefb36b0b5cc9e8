"""The margins of a campaign as charts: runs with more and more of a disturbance, beside the edge of the linear loop."""

import math
from typing import Any

from bridge.drawing.colours import LIGHT
from bridge.drawing.html import svg, text
from bridge.report.charts import canvas
from bridge.runs.campaign.campaign import Found
from bridge.runs.campaign.margins import MARGINS, Margin
from bridge.runs.campaign.table import margin_words

HEIGHT = 1.7  # [inch], of a panel
GOOD, BAD = "#2c7a43", "#b3312c"  # as on the page
LINES = ("-", "--", ":")  # of the points of the linear loop
NOTE = (
    "Green: a run that keeps all bands; red: one that does not; a cross is a run that failed. Lines: from there on the "
    "linear loop, without friction and card, is unstable about the named point: a multiplier outside the unit circle "
    "(delay), no mean-square stability (loss), a positive Lyapunov exponent (jitter). Friction holds small swings that "
    "this theory lets grow, and a band may break long before the loop is unstable."
)


def margins(found: Found) -> str:
    """The section; empty without margins."""
    if not found.margins:
        return ""
    kinds = list(dict.fromkeys(margin.kind for margin in found.margins))
    parts = [_kind(found, [margin for margin in found.margins if margin.kind == kind]) for kind in kinds]
    return f"<section id='margins'><h2>Margins</h2><p class='soft'>{text(NOTE)}</p>{''.join(parts)}</section>\n"


def _kind(found: Found, rows: list[Margin]) -> str:
    kind = rows[0].kind
    figure, axes = canvas(len(rows), HEIGHT)
    for axis, margin in zip(axes, rows, strict=True):
        _panel(axis, margin, found)
    unit = rows[0].axis.unit
    axes[-1].set_xlabel(f"{MARGINS[kind].words} [{unit}]", fontsize=9)
    words = "".join(f"<p>{text(margin_words(margin))}.</p>" for margin in rows)
    drawn = svg(figure, f"margin-{kind}", f"margin against {kind}")
    return f"<h3>{text(kind.capitalize())}</h3>{words}<figure>{drawn}</figure>"


def _panel(axis: Any, margin: Margin, found: Found) -> None:
    numbers = margin.axis.numbers or ()
    shown = found.matrix.measures[0] if found.matrix.measures else None
    for passed, colour in ((True, GOOD), (False, BAD)):
        own = [run for run in margin.runs if run.passed == passed]
        values = [_value(run.result, found) for run in own]
        axis.plot([numbers[run.place] for run in own], values, "o", color=colour, markersize=4, alpha=0.8)
    failed = [numbers[run.place] for run in margin.runs if run.result["reason"]]
    axis.plot(failed, [0.04] * len(failed), "x", color=BAD, transform=axis.get_xaxis_transform())
    reach = max(numbers)
    for style, (point, edge) in zip(LINES, margin.theory.items(), strict=False):
        if edge <= 1.05 * reach:
            axis.axvline(edge, color=LIGHT["blue"], linestyle=style, linewidth=1.2, label=f"linear, {point}")
    axis.set_xlim(min(numbers) - 0.02 * reach, 1.05 * reach)
    axis.set_ylabel(shown.label.replace(" from ", "\nfrom ") if shown else "passed", fontsize=8)
    axis.set_title(margin.scenario, fontsize=9, loc="left")
    if any(edge <= 1.05 * reach for edge in margin.theory.values()):
        axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, frameon=False, ncols=6, borderpad=0.1)


def _value(result: Any, found: Found) -> float:
    """What stands upwards: the first metric, or whether the run passed."""
    if not found.matrix.measures:
        return float(not result["reason"] and all(band["passed"] for band in result["bands"]))
    value = result["values"][0]
    return math.nan if value is None else value * found.matrix.measures[0].factor
