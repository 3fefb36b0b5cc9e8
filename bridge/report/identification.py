"""The page of a fit: one HTML file, readable offline: numbers, what is not known, signals measured and simulated."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bridge.drawing.colours import LIGHT
from bridge.drawing.html import svg, table, text
from bridge.drawing.thin import thinned
from bridge.errors import writing
from bridge.report.charts import canvas
from bridge.report.page import CSS
from bridge.scenario.units import shown

if TYPE_CHECKING:
    from bridge.studies.identification.fit import Fitted
    from bridge.studies.identification.identify import Judged
    from bridge.studies.identification.whiteness import Whiteness

MOST_CORRELATION = 12  # numbers in a table of correlations
STRONG, SOME = 0.9, 0.5


def write_page(found: "Judged", path: Path) -> Path:
    """Write the page."""
    with writing(path):
        path.write_text(page(found), encoding="utf-8")
    return path


def page(found: "Judged") -> str:
    """The whole page."""
    title = text(f"Fit of {found.scenario.title or found.scenario.name}")
    body = [_head(found, title), _numbers(found), _untold(found), _correlation(found)]
    body.append(_left("left", "What the fit leaves of each signal", found.found, found.known.whiteness, found.before))
    if found.held is not None:
        body.append(_left("judged", "Judged on recordings that were not fitted", found.held, found.judged, []))
    body += _pictures(found.found, "fitted")
    body += [] if found.held is None else _pictures(found.held, "judged")
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<style>{CSS}</style></head>\n<body>\n{''.join(body)}\n</body></html>\n"
    )


def _section(name: str, title: str, *parts: str) -> str:
    return f"<section id='{name}'><h2>{text(title)}</h2>{''.join(parts)}</section>\n"


def _head(found: "Judged", title: str) -> str:
    told = sum(e.identified for e in found.known.estimates)
    files = ", ".join(record.name for record in found.found.task.records)
    length = found.found.length
    follows = "over whole recordings" if np.isinf(length) else f"over stretches of {length:g} s"
    badge = ("bad", "the twin is not all of the rig") if found.known.robust else ("good", "what is left is noise")
    starts = "" if found.starts is None else f" {found.starts.words}."
    return (
        f"<header><h1>{title}</h1><p class='lead'>{told} of {len(found.known.estimates)} numbers identified from "
        f"{text(files)}, which the twin follows {follows}.{text(starts)} "
        f"<span class='badge {badge[0]}'>{badge[1]}</span></p></header>\n"
    )


def _numbers(found: "Judged") -> str:
    rows = []
    for e in found.known.estimates:
        one = e.parameter
        ends = " .. ".join(one.words(end) for end in e.interval)
        share = f"{100.0 * e.spread:.2g} %" if one.scale == 0.0 else one.words(e.error)
        told = "identified" if e.identified else f"<span class='failed'>{e.verdict}</span>"
        limit = ", at its limit" if e.at_limit else ""
        cells = [one.name, one.words(one.start), one.words(e.value), ends, share]
        rows.append([*map(text, cells), told + limit])
    note = (
        "What is left is not noise: errors are those of numbers that differ from stretch to stretch."
        if found.known.robust
        else "Errors are those of white noise."
    )
    heads = ("number", "at first", "fitted", "95 % interval", "standard error", "")
    return _section("numbers", "Numbers", table(heads, rows, "numbers"), f"<p class='soft'>{note}</p>")


def _untold(found: "Judged") -> str:
    if not found.known.untold:
        return ""
    words = "".join(f"<p>{text(one.words)}.</p>" for one in found.known.untold)
    return _section("untold", "What the data cannot tell", words)


def _correlation(found: "Judged") -> str:
    estimates = found.known.estimates
    if not 1 < len(estimates) <= MOST_CORRELATION:
        return ""
    names = [e.parameter.name for e in estimates]
    rows = [
        [text(name), *(_coloured(float(r), i == j) for j, r in enumerate(row))]
        for i, (name, row) in enumerate(zip(names, found.known.correlation, strict=True))
    ]
    heads = ["", *(text(name.rpartition(".")[2]) for name in names)]
    return _section("correlation", "Correlation of the errors", table(heads, rows, "numbers"))


def _coloured(r: float, own: bool) -> str:
    if own or abs(r) < SOME:
        return f"{r:.2f}"
    return f"<span class='{'failed' if abs(r) >= STRONG else ''}'><b>{r:.2f}</b></span>"


def _left(name: str, title: str, found: "Fitted", rows: Sequence["Whiteness"], before: Sequence["Whiteness"]) -> str:
    cells = []
    for number, one in enumerate(rows):
        factor, unit = shown(one.unit)
        first = f"{before[number].deviations:.2f}" if before else ""
        colour = "soft" if not one.compared else "passed" if one.passed else "failed"
        mark = f"<span class='{colour}'>{one.verdict}</span>"
        share = f"{one.share:.2%}" if np.isfinite(one.share) else "-"
        cells.append([
            text(one.record), text(one.signal), f"{one.rms * factor:.3g} {unit}", share,
            f"{one.deviations:.2f}", first, f"{one.correlation:.3f}", f"{one.probability:.2g}", mark,
        ])  # fmt: skip
    heads = (
        *("recording", "signal", "rms left", "of the motion", "times the noise"),
        *("times the noise at first" if before else "", "greatest correlation", "Ljung-Box p", ""),
    )
    told = "".join(f"<p class='soft'>{text(r.name)}: {text(note)}.</p>" for r in found.task.records for note in r.told)
    return _section(name, title, table(heads, cells, "numbers"), told)


def _pictures(found: "Fitted", which: str) -> list[str]:
    return [
        _section(
            f"{which}{number}",
            f"{record.name}, {'fitted' if which == 'fitted' else 'not fitted'}",
            f"<figure>{svg(_drawn(found, number), f'{which}{number}', record.name)}<figcaption>Measured and simulated, "
            "and below each what is left, in deviations of the noise: the mean, and pale how far it goes, with gaps "
            "where nothing is compared; dotted where the simulation starts anew.</figcaption></figure>",
        )
        for number, record in enumerate(found.task.records)
    ]


def _drawn(found: "Fitted", number: int) -> Any:
    record = found.task.records[number]
    pairs = [(s, at) for s, at in zip(found.task.shots, found.shots, strict=True) if s.record == number]
    figure, axes = canvas(2 * len(record.signals), 1.35)
    for j, signal in enumerate(record.signals):
        upper, lower = axes[2 * j], axes[2 * j + 1]
        factor, unit = shown(signal.unit)
        time, value = record.period * np.arange(record.samples), factor * signal.value
        _curve(upper, time, value, LIGHT["grey"], "measured")
        for label, shot, at in _labelled(pairs):
            span = record.period * np.arange(shot.begin + 1, shot.end + 1)
            _curve(upper, span, factor * at.reading[j], LIGHT["blue"], label)
            left = at.residual.reshape(len(record.signals), -1)[j]
            compared = signal.counted[shot.begin + 1 : shot.end + 1]
            _curve(lower, span, np.where(compared, left, np.nan), LIGHT["red"], "")
            if shot.begin != pairs[0][0].begin:
                lower.axvline(record.period * shot.begin, color="#999", linewidth=0.6, linestyle=":")
        upper.set_ylabel(f"{signal.name} [{unit}]", fontsize=9)
        lower.set_ylabel("left", fontsize=9)
        for axis in (upper, lower):
            axis.set_xlim(0.0, record.duration)
    axes[0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, frameon=False, ncols=2, borderpad=0.1)
    axes[-1].set_xlabel("time [s]", fontsize=9)
    return figure


def _labelled(pairs: Sequence[Any]) -> Iterator[tuple[str, Any, Any]]:
    for place, (shot, at) in enumerate(pairs):
        yield "simulated" if place == 0 else "", shot, at


def _curve(axis: Any, time: Any, value: Any, colour: str, label: str) -> None:
    course = thinned(time, value)
    axis.fill_between(course.time, course.least, course.greatest, color=colour, alpha=0.25, linewidth=0.3)
    axis.plot(course.time, course.mean, color=colour, linewidth=0.9, label=label or None)
