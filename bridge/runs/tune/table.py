"""A search as tables: every run as CSV, start and result for people and as JSON, what failed least."""

import csv
from pathlib import Path
from typing import Any

from bridge.errors import writing
from bridge.runs.tune.goal import Limit, with_unit
from bridge.runs.tune.tune import Found, Trial
from bridge.studies.sweep.journal import Result


def write_csv(found: Found, path: Path) -> Path:
    """One line per run, in the order in which they were asked for; first the scenario as it stands."""
    goal, varied = found.wanted.goal, found.wanted.varied
    heads = [*(one.label for one in varied), *(asked.label for asked in goal.measures), "bands kept", "reason"]
    with writing(path), path.open("w", newline="", encoding="utf-8") as file:
        file.write(f"# hydrotwin tune of {found.wanted.scenario.name}, seed {found.wanted.seed}\n")
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(heads)
        rows.writerows(_cells(found, trial) for trial in found.trials)
    return path


def _cells(found: Found, trial: Trial) -> list[str]:
    goal = found.wanted.goal
    values = trial.values or tuple(one.own for one in found.wanted.varied)
    pairs = zip(goal.measures, trial.result["values"], strict=True)
    shown = ["" if value is None else f"{value * asked.factor:.9g}" for asked, value in pairs]
    kept = "yes" if goal.feasible(trial.result) else "no"
    return [*("" if v is None else f"{v:.9g}" for v in values), *shown, kept, trial.result["reason"]]


def rows(found: Found, result: Result) -> list[tuple[str, str, str]]:
    """What was varied and what came of it: the scenario as it stands, and the result."""
    goal, start, best = found.wanted.goal, found.start.result, found.best
    lines = [
        (one.name, "-" if one.own is None else one.text(one.own), one.text(value))
        for one, value in zip(found.wanted.varied, best.values, strict=True)
    ]
    before, after = (with_unit(goal.objective, one["values"][0]) for one in (start, result))
    lines.append((goal.objective.words, before, after))
    for number, limit in enumerate(goal.limits, 1):
        before, after = (_kept(limit, one["values"][number]) for one in (start, result))
        lines.append((limit.text, before, after))
    if reason := start["reason"]:
        lines.append(("failed", reason, result["reason"]))
    return lines


def _kept(limit: Limit, value: float | None) -> str:
    return f"{with_unit(limit.measure, value)}{'' if limit.kept(value) else ', not kept'}"


def failures(found: Found) -> list[tuple[str, str, str]]:
    """Each band, in how many runs it was kept, and the value that came nearest to it; what fails least first."""
    ran = [trial.result for trial in found.trials[1:] if not trial.result["reason"]]
    lines = []
    for number, limit in enumerate(found.wanted.goal.limits, 1):
        values = [result["values"][number] for result in ran]
        near = min(values, key=limit.violation, default=None)
        kept = sum(map(limit.kept, values))
        least = min(map(limit.violation, values), default=0.0)
        lines.append((least, -kept, (limit.text, f"{kept} of {len(ran)}", with_unit(limit.measure, near))))
    return [line for *_, line in sorted(lines, key=lambda entry: entry[:2])]


def plain(found: Found, result: Result) -> dict[str, Any]:
    """For JSON: values in SI, settings as a scenario takes them."""
    wanted = found.wanted
    pairs = zip(wanted.varied, found.best.values, strict=True)
    return {
        "scenario": wanted.scenario.name,
        "feasible": found.feasible,
        "converged": found.converged,
        "runs": len(found.trials),
        "seed": wanted.seed,
        "set": {one.name: one.text(value) for one, value in pairs},
        "start": _plain(found, found.start.result),
        "best": _plain(found, result),
        "bands": [dict(zip(("band", "kept", "nearest"), line, strict=True)) for line in failures(found)],
    }


def _plain(found: Found, result: Result) -> dict[str, Any]:
    names = [asked.words for asked in found.wanted.goal.measures]
    return {"values": dict(zip(names, result["values"], strict=True)), "reason": result["reason"]}
