"""A recording that was imported from a log of others: measured on a rig, without a true state."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from bridge.scenario.units import shown

if TYPE_CHECKING:
    from bridge.recording.reader import Recording

MEASURED = "measured"  # in place of what paced a run
FACTS = "imported"  # record of facts about the log
SHOWN_HOLES = 3
ROOT_12 = math.sqrt(12.0)  # of an even distribution over a quantum


def is_measured(recording: "Recording") -> bool:
    """Was it measured, and not simulated?"""
    return recording.metadata.get("run", {}).get("mode") == MEASURED


def facts(recording: "Recording") -> Mapping[str, Any]:
    """What it says of the log; empty of other recordings."""
    return recording.metadata.get(FACTS, {})


def measured_in_words(recording: "Recording") -> list[str]:
    """What a reader of a measured recording should know, one sentence each; nothing of others."""
    if not is_measured(recording):
        return []
    told = facts(recording)
    missing = [f"{name} {holes_in_words(entry)}" for name, entry in told["signals"].items() if entry.get("missing")]
    holes = [f"missing on the grid: {'; '.join(missing)}"] if missing else []
    lacks = told["signals"].get("command", {}).get("missing")
    held = ["a replay into the twin holds the last command where some are missing"] if lacks else []
    return [f"measured on a rig: no true state; imported from {told['source']} by {told['map']}", *holes, *held]


def rows_in_words(rows: Mapping[str, int]) -> str:
    """How many rows a log had, and what was wrong with some."""
    wrong = [f"{number} {what}" for what, number in rows.items() if number and what != "read"]
    return ", ".join([f"{rows.get('read', 0)} read", *wrong])


def noise_in_words(signal: Mapping[str, Any]) -> str:
    """Noise of a signal with its rounding, in the unit that people read."""
    if "noise" not in signal:
        return "-"
    factor, unit = shown(signal["unit"])
    total = math.hypot(signal["noise"], signal["quantum"] / ROOT_12) * factor
    return f"{total:.3g} {unit}".rstrip() + ("" if signal["stated"] else ", estimated")


def holes_in_words(signal: Mapping[str, Any]) -> str:
    """What is missing of a signal on the grid."""
    if not signal.get("missing"):
        return "nothing"
    holes = [f"{begin:g} to {end:g} s" for begin, end in signal.get("holes", [])]
    more = ", ..." if len(holes) > SHOWN_HOLES else ""
    return f"{signal['missing']} instants: {', '.join(holes[:SHOWN_HOLES])}{more}"
