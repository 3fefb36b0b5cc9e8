"""A suggested excitation: what is asked for, the scenario file, and rows of a table."""

import json
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bridge.cli.fitted import MADE_BY
from bridge.errors import UsageError, writing

if TYPE_CHECKING:
    from bridge.studies.identification.suggestion import Asked, Suggestion


def asked_of(
    rig: str, changes: list[str], numbers: tuple[list[str], list[str]], limits: tuple[str, str | None, str]
) -> "Asked":
    """What options ask for. Raises UsageError."""
    from bridge.scenario import load
    from bridge.scenario.units import option
    from bridge.studies.identification.parameters import parameters_of, priors_of
    from bridge.studies.identification.suggestion import Asked

    scenario = load(rig, changes)
    if not scenario.controller.follows:
        raise UsageError(f"{rig}: its controller follows no reference, which an excitation is; give it one with --set")
    duration, motion, pressure = limits
    fit, priors = numbers
    parameters_of(fit, scenario, priors_of(priors))
    low, high = (0.0, scenario.rig.cylinder.stroke) if motion is None else _motion(motion, scenario.rig.cylinder.stroke)
    if not low < scenario.start.position < high:
        raise UsageError(
            f"--motion {motion}: the rod starts at {scenario.start.position:g} m, outside; set start.position"
        )
    return Asked(
        scenario.model_dump(mode="json"), tuple(fit), tuple(priors), option("duration", duration, "s", least=2.0),
        low, high, option("pressure", pressure, "Pa", above=0.0),
    )  # fmt: skip


def _motion(text: str, stroke: float) -> tuple[float, float]:
    from bridge.scenario.units import quantity, split

    low, sign, high = (part.strip() for part in text.partition(":"))
    try:
        unit = split(high)[1]
        ends = [quantity(end if split(end)[1] else f"{end} {unit}", "m") for end in (low, high)]
    except ValueError as error:
        raise UsageError(f"--motion {text}: {error}") from None
    if not sign or not 0.0 <= ends[0] < ends[1] <= stroke:
        raise UsageError(f"--motion {text}: write LOW:HIGH, such as 50:220mm, within the stroke of {stroke:g} m")
    return ends[0], ends[1]


def write_suggestion(found: "Suggestion", rig: str, changes: Sequence[str], duration: float, path: Path) -> Path:
    """A scenario that extends the rig."""
    from bridge.scenario import names
    from bridge.scenario.files import parsed_change

    base = rig if rig in names() else os.path.relpath(rig, path.parent)
    lines = [f"{MADE_BY} --suggest: {found.words}", f"extends = {json.dumps(base)}"]
    lines += [f"{name} = {json.dumps(value, default=str)}" for name, value in map(parsed_change, changes)]
    lines += [f'duration = "{duration:g} s"', "expect = []", "", "[reference]", 'kind = "table"']
    with writing(path):
        path.write_text("\n".join([*lines, f'csv = """\n{found.table}\n"""']) + "\n", encoding="utf-8")
    return path


def suggestion_rows(found: "Suggestion") -> Iterator[tuple[str, ...]]:
    """One row for each number."""
    for one, spread, middle in zip(found.parameters, found.spread, found.before, strict=True):
        shares = [f"{100.0 * s:.2g} %" if one.scale == 0.0 else one.words(one.scale * s) for s in (spread, middle)]
        yield one.name, one.words(one.start), *shares


def plain_suggestion(found: "Suggestion") -> dict[str, Any]:
    """All of it for programs; SI."""
    numbers = [
        {"name": one.name, "unit": one.unit, "value": one.start, "error": one.deviation(one.start, spread)}
        for one, spread in zip(found.parameters, found.spread, strict=True)
    ]
    low, high, most = found.reached
    reached = {"low": low, "high": high, "pressure": most}
    return {"excitation": found.words, "numbers": numbers, "kept": found.kept, "tried": found.tried, "reached": reached}
