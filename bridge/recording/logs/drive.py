"""The scenario that an imported recording carries: the drive of the map, measured, with nothing planned and no law."""

import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bridge.errors import UsageError, nearest
from bridge.recording.logs.carried import Log
from bridge.recording.logs.map import COMMAND, REFERENCE, Map
from bridge.scenario import Scenario, check
from bridge.scenario.channels import known
from bridge.scenario.files import plain, with_piece
from twin.topology import CHANNELS

SI = {COMMAND: "", REFERENCE: "m", **{name: channel.unit for name, channel in CHANNELS.items()}}
EARLY = 0.1  # [s]: a start that is missing is read as late as this; assumed
NOISE_AT_STOP = 0.01  # of the stroke: a rod at a stop may be read as far beyond it; assumed
UNUSABLE = re.compile(r"[^\w.-]+")


def base_of(mapped: Map, folder: Path) -> dict[str, Any]:
    """The plain data of the scenario that a map names: beside it, else a built-in one. Raises ScenarioError."""
    beside = folder / mapped.rig
    return plain(str(beside) if beside.is_file() else mapped.rig)


def units_of(mapped: Map, base: dict[str, Any], who: str) -> dict[str, str]:
    """The SI unit of each signal of a map. Raises UsageError for names that the drive does not have."""
    further = {name: sensor.unit for name, sensor in known(check(base, mapped.rig)).items()}
    valid = further | SI
    for name in mapped.signal:
        if name not in valid:
            raise UsageError(
                f"{who}: signal.{name} is not a signal of this drive{nearest(name, valid)}; "
                f"under a name of your own keep it with [extra.{name}]"
            )
    return {name: valid[name] for name in mapped.signal}


def scenario_of(mapped: Map, base: dict[str, Any], log: Log, period: float, name: str) -> Scenario:
    """The drive, its card with the channels that were measured, and the start as measured. Raises ScenarioError."""
    kept = {key: base[key] for key in ("rig", "rig_name", "seed") if key in base}
    own = {
        "name": UNUSABLE.sub("_", name).strip("._") or "log",
        "title": mapped.title or f"Measured: {name}",
        "duration": float(log.grid[-1]),
        "daq": _card(mapped, base.get("daq", {})),
        "start": _start(log, base.get("start", {})),
        "loop": _loop(base.get("loop", {}), period, float(log.grid[-1])),
        "controller": {"kind": "open-loop"},
        "reference": {"kind": "constant", "value": 0.0},
    }
    drive = check(with_piece(kept | own | {"start": {"position": 0.0}}, mapped.scenario), name)
    own["start"] = _within_stroke(own["start"], drive.rig.cylinder.stroke)
    return check(with_piece(kept | own, mapped.scenario), name)


def period_of(mapped: Map, base: dict[str, Any]) -> float:
    """The period of the grid [s]."""
    return mapped.period or check(base, mapped.rig).loop.daq_period


def _card(mapped: Map, daq: Mapping[str, Any]) -> dict[str, Any]:
    further = [name for name in mapped.signal if name not in SI]
    return {**daq, "channels": further, "tachometer": "velocity" in mapped.signal}


def _start(log: Log, start: Mapping[str, Any]) -> dict[str, Any]:
    """Position and upper pressure as first measured, where they were; else as the drive's scenario has them."""
    first = {"position": _first(log, "position"), "p_upper": _first(log, "p3")}
    found = {name: value for name, value in first.items() if math.isfinite(value)}
    return {**start, **found, **({"p_upper": max(0.0, found["p_upper"])} if "p_upper" in found else {})}


def _first(log: Log, name: str) -> float:
    """The first value [SI] that is known soon after the beginning; NaN."""
    if name not in log.signals:
        return math.nan
    early = log.signals[name].values[log.grid <= EARLY]
    known = early[np.isfinite(early)]
    return float(known[0]) if len(known) else math.nan


def _within_stroke(start: dict[str, Any], stroke: float) -> dict[str, Any]:
    """A position that is beyond a stop by noise alone counts as that stop; one that is farther out is refused later."""
    noise, position = NOISE_AT_STOP * stroke, start.get("position")
    if isinstance(position, float) and -noise <= position <= stroke + noise:
        return start | {"position": min(max(position, 0.0), stroke)}
    return start


def _loop(loop: Mapping[str, Any], period: float, duration: float) -> dict[str, Any]:
    """One command a row; a replay holds the last one where some are missing, however long."""
    step = {"step": loop["step"]} if "step" in loop else {}
    return {**step, "daq_period": period, "sample_period": period, "command_timeout": duration + period}
