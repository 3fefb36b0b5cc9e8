"""The runs of a sweep as a table: CSV with units and the numbers that all runs share, JSON, rows for people."""

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from bridge.errors import visible, writing
from bridge.machine.host import versions
from bridge.runs.sweep.sweep import KEPT_NAME, Found, Row
from bridge.scenario import Scenario
from bridge.scenario.places import si_unit_at, value_at

SECTIONS = ("start", "loop", "controller", "reference", "daq")  # whose numbers a table states
ALONE = ("duration", "seed")
LONGEST = 60  # letters of a value worth stating


def write_csv(found: Found, path: Path) -> Path:
    """One line per run, in the order of the combinations."""
    with writing(path), path.open("w", newline="", encoding="utf-8") as file:
        file.writelines(f"# {visible(line)}\n" for line in about(found))
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(headers(found))
        rows.writerows(_cells(found, row, index) for index, row in enumerate(found.rows))
    return path


def about(found: Found) -> Iterator[str]:
    """Which sweep it is, and the values that all runs share."""
    scenario, moved = found.wanted.scenario, {axis.name for axis in found.wanted.axes}
    yield f"hydrotwin {versions().get('hydrotwin', '')}: sweep of {scenario.name}, {len(found.rows)} runs"
    for name, value in fixed(scenario):
        if name not in moved:
            yield f"{name} = {_stated(scenario, name, value)}"


def fixed(scenario: Scenario) -> Iterator[tuple[str, Any]]:
    """Values of a scenario by their names: of its sections, and those of the rig that are not the usual ones."""
    data, usual = scenario.model_dump(mode="json"), type(scenario.rig)().model_dump(mode="json")
    yield from ((name, data[name]) for name in ALONE)
    for section in SECTIONS:
        yield from ((f"{section}.{key}", value) for key, value in data[section].items())
    for part, values in data["rig"].items():
        yield from ((f"rig.{part}.{key}", value) for key, value in values.items() if value != usual[part][key])


def _stated(scenario: Scenario, name: str, value: Any) -> str:
    text = str(value_at(scenario, name) if value is None else value)
    text = text if len(text) <= LONGEST else f"{text[:LONGEST]}..."
    return f"{text} {si_unit_at(scenario, name)}".rstrip() if isinstance(value, int | float) else text


def headers(found: Found) -> list[str]:
    """Names with their units."""
    wanted = found.wanted
    judged = ["bands kept", "bands not kept"] if wanted.judge else []
    kept = ["recording"] if wanted.keep else []
    return [*(axis.label for axis in wanted.axes), *(m.label for m in wanted.measures), *judged, *kept, "reason"]


def _cells(found: Found, row: Row, index: int) -> list[str]:
    wanted = found.wanted
    values = [
        "" if value is None else f"{value * asked.factor:.9g}"
        for asked, value in zip(wanted.measures, row.values, strict=True)
    ]
    judged = [judgement(row), "; ".join(row.failed)] if wanted.judge else []
    kept = [f"recordings/{KEPT_NAME.format(index + 1)}"] if wanted.keep else []
    return [*axis_cells(found, row), *values, *judged, *kept, row.reason]


def axis_cells(found: Found, row: Row) -> list[str]:
    """Where on its axes a run stands."""
    return [
        axis.texts[place] if axis.numbers is None else f"{axis.numbers[place]:.9g}"
        for axis, place in zip(found.wanted.axes, row.places, strict=True)
    ]


def judgement(row: Row) -> str:
    """Did a run keep the scenario's bands?"""
    return "" if row.reason else "no" if row.failed else "yes"


def plain(found: Found) -> dict[str, Any]:
    """For JSON: values in SI, the settings as a scenario takes them."""
    wanted = found.wanted
    names = [asked.words for asked in wanted.measures]
    best = {name: found.best(column) for column, name in enumerate(names)}
    return {
        "scenario": wanted.scenario.name,
        "axes": [{"name": axis.name, "unit": axis.unit, "values": list(axis.texts)} for axis in wanted.axes],
        "metrics": [{"name": asked.words, "unit": asked.unit} for asked in wanted.measures],
        "rows": [_plain_row(found, row) for row in found.rows],
        "best": best,
    }


def _plain_row(found: Found, row: Row) -> dict[str, Any]:
    wanted = found.wanted
    settings = {axis.name: axis.texts[place] for axis, place in zip(wanted.axes, row.places, strict=True)}
    values = {asked.words: value for asked, value in zip(wanted.measures, row.values, strict=True)}
    judged = {"passed": not row.failed and not row.reason, "failed": row.failed} if wanted.judge else {}
    return {"set": settings, "values": values, **judged, "reason": row.reason}
