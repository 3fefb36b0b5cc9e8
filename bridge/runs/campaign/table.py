"""What a campaign found, as tables: CSV of all runs and of the margins, JUnit XML, JSON, rows for people."""

import csv
import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from bridge.errors import visible, writing
from bridge.machine.host import versions
from bridge.runs.campaign.campaign import Found, Judged
from bridge.runs.campaign.margins import MARGINS, Margin
from bridge.runs.campaign.matrix import Run
from bridge.runs.campaign.statistics import QUANTILES, Quantile, Share, quantile, wilson
from bridge.runs.check import CheckResult, Judgement, junit_xml
from bridge.runs.tune.goal import limit_of
from bridge.scenario.measures import Measure


class BandColumn(NamedTuple):
    """A band that some scenario of the campaign states."""

    band: str
    id: str
    text: str  # of the requirement
    measure: Measure


class CellStatistics(NamedTuple):
    """The runs of one scenario, fault and set of parameters."""

    scenario: str
    fault: str
    parameters: tuple[str, ...]
    share: Share
    quantiles: list[list[Quantile] | None]  # one list per measure; None: no run has a value


def bands_of(found: Found) -> list[BandColumn]:
    """All bands, in the order in which runs meet them."""
    columns: dict[tuple[str, str], BandColumn] = {}
    for one in found.runs:
        for band in one.result["bands"]:
            key = band["band"], band["id"]
            if key not in columns:
                columns[key] = BandColumn(*key, band["text"], limit_of(band["band"]).measure)
    return list(columns.values())


def settings_of(found: Found, run: Run) -> list[tuple[str, str]]:
    """The numbers of a run: parameters, then what was drawn; those of other faults left out."""
    matrix = found.matrix
    names = [*(axis.name for axis in matrix.parameters), *(draw.place for draw in matrix.file.draws)]
    return [(name, text) for name, text in zip(names, (*run.parameters, *run.drawn), strict=True) if text]


def name_of(found: Found, run: Run) -> str:
    """A run in words."""
    settings = [f"{name}={text}" for name, text in settings_of(found, run)]
    return " / ".join([run.scenario, run.fault, *settings, f"seed {run.seed}"])


def write_csv(found: Found, path: Path) -> Path:
    """One line per run, in the order of the matrix."""
    bands = bands_of(found)
    settings = [axis.name for axis in found.matrix.parameters] + [draw.place for draw in found.matrix.file.draws]
    heads = ["run", "scenario", "fault", *settings, "seed", "passed", "not kept"]
    heads += [f"{band.id}: {band.measure.label}" if band.id else band.measure.label for band in bands]
    heads += [asked.label for asked in found.matrix.measures]
    about = f"hydrotwin {versions().get('hydrotwin', '')}: campaign {found.matrix.file.name}, {len(found.runs)} runs"
    return _write(path, about, heads, (_cells(found, bands, one) for one in found.runs))


def _cells(found: Found, bands: Sequence[BandColumn], one: Judged) -> list[str]:
    values = {(band["band"], band["id"]): band["value"] for band in one.result["bands"]}
    own = [_number(values.get((band.band, band.id)), band.measure) for band in bands]
    asked = zip(one.result["values"], found.matrix.measures, strict=True)
    run, passed = one.run, "yes" if one.passed else "no"
    settings = [*run.parameters, *run.drawn, str(run.seed), passed, "; ".join(one.broken)]
    return [str(run.number), run.scenario, run.fault, *settings, *own, *(_number(*pair) for pair in asked)]


def _number(value: float | None, measure: Measure) -> str:
    return "" if value is None else f"{value * measure.factor:.9g}"


def write_margins(found: Found, path: Path) -> Path:
    """One line per run of a margin."""
    heads = [
        "scenario",
        "disturbance",
        "value",
        "seed",
        "passed",
        "not kept",
        *(m.label for m in found.matrix.measures),
    ]
    about = f"hydrotwin {versions().get('hydrotwin', '')}: margins of campaign {found.matrix.file.name}"
    return _write(path, about, heads, (row for margin in found.margins for row in _margin_rows(found, margin)))


def _margin_rows(found: Found, margin: Margin) -> Iterator[list[str]]:
    for run in margin.runs:
        broken = [run.result["reason"]] if run.result["reason"] else []
        broken += [band["band"] for band in run.result["bands"] if not band["passed"]]
        values = [_number(v, m) for v, m in zip(run.result["values"], found.matrix.measures, strict=True)]
        about = [margin.scenario, margin.kind, margin.axis.texts[run.place], str(run.seed)]
        yield [*about, "yes" if run.passed else "no", "; ".join(broken), *values]


def _write(path: Path, about: str, heads: Sequence[str], rows: Iterable[Sequence[str]]) -> Path:
    with writing(path), path.open("w", newline="", encoding="utf-8") as file:
        file.write(f"# {visible(about)}\n")
        lines = csv.writer(file, lineterminator="\n")
        lines.writerow(heads)
        lines.writerows(rows)
    return path


def junit(found: Found) -> str:
    """One test suite per run, one test case per band; without times, so that it is the same after an interruption."""
    return junit_xml([_check(found, one) for one in found.runs], "hydrotwin campaign")


def _check(found: Found, one: Judged) -> CheckResult:
    verdicts = [Judgement(b["band"], b["found"], b["passed"], b["id"], b["text"]) for b in one.result["bands"]]
    faults = [one.result["reason"]] if one.result["reason"] else []
    return CheckResult(name_of(found, one.run), verdicts, faults, [], None, interrupted=False, seconds=0.0)


def cells_of(found: Found) -> list[CellStatistics]:
    """What the runs of each cell say of all that could be."""
    groups: dict[tuple[str, str, tuple[str, ...]], list[Judged]] = {}
    for one in found.runs:
        groups.setdefault(one.run.cell, []).append(one)
    return [
        CellStatistics(*cell, wilson(sum(one.passed for one in group), len(group)), list(_quantiles(found, group)))
        for cell, group in groups.items()
    ]


def _quantiles(found: Found, group: Sequence[Judged]) -> Iterator[list[Quantile] | None]:
    for column in range(len(found.matrix.measures)):
        values = [v for one in group if (v := one.result["values"][column]) is not None]
        yield [quantile(values, share) for share in QUANTILES] if values else None


def quantile_words(found: Quantile, measure: Measure) -> str:
    """For people: the value, and its interval in brackets."""
    ends = ("-" if end is None else f"{end * measure.factor:.4g}" for end in (found.low, found.high))
    return f"{found.value * measure.factor:.4g} ({' to '.join(ends)})"


def margin_words(margin: Margin) -> str:
    """How much of a disturbance a scenario tolerates."""
    texts, kept, theory = margin.axis.texts, margin.kept, theory_words(margin)
    words = f"{margin.scenario}, {MARGINS[margin.kind].words}: "
    if kept == len(texts):
        return f"{words}keeps all bands up to {texts[-1]}{theory}"
    beyond = f"breaks {margin.broken!r} at {texts[kept]}{theory}"
    return words + (f"keeps all bands up to {texts[kept - 1]}, {beyond}" if kept else beyond)


def theory_words(margin: Margin) -> str:
    """What the linear theory says of it: the least edge of all points."""
    if not margin.theory:
        return "; no linear theory"
    point, least = min(margin.theory.items(), key=lambda item: item[1])
    if least == math.inf:
        return "; the linear loop is never unstable"
    return f"; the linear loop is unstable from {least:.3g} {margin.axis.unit} on (about the point {point!r})"


def plain(found: Found) -> dict[str, Any]:
    """For JSON: values in SI."""
    names = [asked.words for asked in found.matrix.measures]
    return {
        "campaign": found.matrix.file.name,
        "runs": len(found.runs),
        "passed": found.passed,
        "accepted": found.accepted,
        "cells": [
            {
                "scenario": cell.scenario,
                "fault": cell.fault,
                "parameters": list(cell.parameters),
                "share": cell.share._asdict(),
                "quantiles": {
                    name: quantiles and [one._asdict() for one in quantiles]
                    for name, quantiles in zip(names, cell.quantiles, strict=True)
                },
            }
            for cell in cells_of(found)
        ],
        "failures": [
            {
                "run": f.worst.run.number,
                "name": name_of(found, f.worst.run),
                "broken": f.worst.broken,
                "runs": len(f.runs),
            }
            for f in found.failures
        ],
        "margins": [margin_words(margin) for margin in found.margins],
        "shrunk": [{"number": s.wish.words, "scenario": s.scenario, "found": s.words} for s in found.shrunk],
    }
