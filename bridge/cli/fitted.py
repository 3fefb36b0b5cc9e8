"""What a fit has found: as a scenario file, as plain data, and as rows of tables."""

import json
import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bridge.errors import UsageError, writing

if TYPE_CHECKING:
    from bridge.studies.identification.alone import Ranked
    from bridge.studies.identification.identify import Judged
    from bridge.studies.identification.whiteness import Whiteness

MADE_BY = "# Fitted by hydrotwin identify"


def refuse_foreign(path: Path) -> None:
    """Raises UsageError for a file that is there and was not made by a fit."""
    if path.suffix != ".toml":
        raise UsageError(f"-o {path}: a scenario is a TOML file; name one that ends in .toml")
    if path.is_file() and not path.read_text(encoding="utf-8", errors="replace").startswith(MADE_BY):
        raise UsageError(f"-o {path}: is there and was not written by hydrotwin identify; name another file")


def write_fitted(found: "Judged", extends: str, changes: list[str], path: Path) -> Path:
    """A scenario that extends the rig to start with, each number with its standard error beside it."""
    from bridge.scenario import names
    from bridge.scenario.files import parsed_change

    base = extends if extends in names() else os.path.relpath(extends, path.parent)
    values = {name: json.dumps(value, default=str) for name, value in map(parsed_change, changes)}
    words = {}
    for one in found.known.estimates:
        values[one.parameter.name] = one.parameter.text(one.value)
        words[one.parameter.name] = f"{one.parameter.unit} +- {one.error:.2g}".lstrip()
    if extends in names():
        values = _otherwise(found, extends) | values
    lines = [f"{MADE_BY} to {', '.join(Path(file).name for file in found.wanted.files)}"]
    lines += [f"extends = {json.dumps(base)}"]
    lines += [f"{name} = {value}" + (f"  # {words[name]}" if name in words else "") for name, value in values.items()]
    with writing(path):
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def _otherwise(found: "Judged", extends: str) -> dict[str, str]:
    """Numbers and words of a recorded rig that are not those of the built-in scenario of its name."""
    from bridge.scenario import load

    own, built_in = found.scenario.rig.model_dump(mode="json"), load(extends).rig.model_dump(mode="json")
    return {
        f"rig.{part}.{key}": json.dumps(value)
        for part, entries in own.items()
        for key, value in entries.items()
        if value != built_in[part][key]
    }


def plain(found: "Judged") -> dict[str, Any]:
    """All of it for programs; SI."""
    known = found.known
    return {
        "numbers": [
            {
                "name": e.parameter.name, "unit": e.parameter.unit, "start": e.parameter.start, "value": e.value,
                "error": e.error, "interval": list(e.interval), "identified": e.identified, "at_limit": e.at_limit,
            }
            for e in known.estimates
        ],
        "correlation": [[_finite(r) for r in row] for row in known.correlation.tolist()],
        "untold": [
            {"numbers": dict(one.shares), "spread": _finite(one.spread), "told": one.told, "error": _finite(one.error)}
            for one in known.untold
        ],
        "white": not known.robust,
        "segment": _finite(found.found.length),
        "converged": found.found.converged,
        "simulations": found.runs,
        "seconds": found.seconds,
        "alone": None if found.ranked is None else _alone(found.ranked),
        "starts": None if found.starts is None else found.starts.rms,
        "residuals": [_plain(one) for one in known.whiteness],
        "judged": [_plain(one) for one in found.judged],
    }  # fmt: skip


def _alone(ranked: "Ranked") -> dict[str, Any]:
    rows = [{"name": one.parameter.name, "value": one.value, "left": one.left} for one in ranked.tried]
    return {"before": ranked.before, "best": ranked.best and ranked.best.parameter.name, "numbers": rows}


def _plain(one: "Whiteness") -> dict[str, Any]:
    return {**one._asdict(), "share": _finite(one.share), "passed": one.passed}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def number_rows(found: "Judged") -> Iterator[tuple[str, ...]]:
    """One row for each number."""
    for e in found.known.estimates:
        one = e.parameter
        share = f"{100.0 * e.spread:.2g} %" if one.scale == 0.0 else one.words(e.error)
        ends = " .. ".join(one.words(end) for end in e.interval)
        yield one.name, one.words(one.start), one.words(e.value), ends, share, e.verdict


def ranked_rows(ranked: "Ranked") -> Iterator[tuple[str, ...]]:
    """One row for each number that was fitted by itself, the best first."""
    for name, one, value, left in ((a.parameter.name, a.parameter, a.value, a.left) for a in ranked.tried):
        yield name, one.words(one.start), one.words(value), f"{left:.2f}"


def residual_rows(found: "Judged", held: bool = False) -> Iterator[tuple[str, ...]]:
    """One row for each signal of each record; held: of those that were not fitted."""
    from bridge.scenario.units import shown

    rows, before = (found.judged, []) if held else (found.known.whiteness, found.before)
    for number, one in enumerate(rows):
        factor, unit = shown(one.unit)
        told = one.verdict if one.passed else f"correlation {one.correlation:.2f}"
        yield (
            one.record, one.signal, f"{one.rms * factor:.3g} {unit}", share_words(one), f"{one.deviations:.2f}",
            *([f"{before[number].deviations:.2f}"] if before else []), told,
        )  # fmt: skip


def share_words(one: "Whiteness") -> str:
    """The rms residual as a share of the motion."""
    return f"{one.share:.2%}" if math.isfinite(one.share) else "-"


def followed(found: "Judged") -> str:
    """Over which stretches the twin has followed the data, and at what cost."""
    length = found.found.length
    words = "over whole recordings" if length == math.inf else f"over stretches of {length:g} s"
    return f"The twin follows the data {words}; {found.runs} simulations, {found.seconds:.0f} s of CPU."
