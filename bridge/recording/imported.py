"""A recording that was imported from a log of others: measured on a rig, without a true state."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bridge.recording.reader import Recording

MEASURED = "measured"  # in place of what paced a run
FACTS = "imported"  # record of facts about the log
SHOWN_HOLES = 3


def is_measured(recording: "Recording") -> bool:
    """Was it measured, and not simulated?"""
    return recording.metadata.get("run", {}).get("mode") == MEASURED


def facts(recording: "Recording") -> Mapping[str, Any]:
    """What it says of the log; empty of other recordings."""
    return recording.metadata.get(FACTS, {})


def rows_in_words(rows: Mapping[str, int]) -> str:
    """How many rows a log had, and what was wrong with some."""
    wrong = [f"{number} {what}" for what, number in rows.items() if number and what != "read"]
    return ", ".join([f"{rows.get('read', 0)} read", *wrong])


def holes_in_words(signal: Mapping[str, Any]) -> str:
    """What is missing of a signal on the grid."""
    if not signal.get("missing"):
        return "nothing"
    holes = [f"{begin:g} to {end:g} s" for begin, end in signal.get("holes", [])]
    more = ", ..." if len(holes) > SHOWN_HOLES else ""
    return f"{signal['missing']} instants: {', '.join(holes[:SHOWN_HOLES])}{more}"
