"""The scenario that an imported recording carries: the drive of the map, measured, with nothing planned and no law."""

import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bridge.errors import UsageError, nearest
from bridge.recording.logs.carried import Log
from bridge.recording.logs.map import COMMAND, REFERENCE, Map
from bridge.scenario import Scenario, check
from bridge.scenario.channels import known
from bridge.scenario.files import plain, with_piece
from twin.topology import CHANNELS

SI = {COMMAND: "", REFERENCE: "m", **{name: channel.unit for name, channel in CHANNELS.items()}}
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
    return check(with_piece(kept | own, mapped.scenario), name)


def period_of(mapped: Map, base: dict[str, Any]) -> float:
    """The period of the grid [s]."""
    return mapped.period or check(base, mapped.rig).loop.daq_period


def _card(mapped: Map, daq: Mapping[str, Any]) -> dict[str, Any]:
    further = [name for name in mapped.signal if name not in SI]
    return {**daq, "channels": further, "tachometer": "velocity" in mapped.signal}


def _start(log: Log, start: Mapping[str, Any]) -> dict[str, Any]:
    """Position and upper pressure as first measured, where they were."""
    first = {"position": _first(log, "position"), "p_upper": max(0.0, _first(log, "p3"))}
    return {**start, **{name: value for name, value in first.items() if math.isfinite(value)}}


def _first(log: Log, name: str) -> float:
    return float(log.signals[name].values[0]) if name in log.signals else math.nan


def _loop(loop: Mapping[str, Any], period: float, duration: float) -> dict[str, Any]:
    """One command a row; a replay holds the last one where some are missing, however long."""
    step = {"step": loop["step"]} if "step" in loop else {}
    return {**step, "daq_period": period, "sample_period": period, "command_timeout": duration + period}
