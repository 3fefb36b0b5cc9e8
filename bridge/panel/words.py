"""What the panel says of events, estimates and health."""

from typing import Any

from bridge.scenario.units import shown
from bridge.view.content import GRAVE
from bridge.wire.estimates import DEVIATION, OF_UNKNOWN
from bridge.wire.events import turn_of
from bridge.wire.health import DEVIATE, PLACES, SIZE
from bridge.wire.messages import EventKind
from controller.grid import NS
from twin.estimation.hypotheses import HYPOTHESES, Verdict, in_words
from twin.estimation.quantities import ESTIMATED, UNKNOWNS, Standing

SHOWN = ("position", "velocity", "p1", "p_lower", "p_upper", "friction", "load")
WHY = {Verdict.NOT_KNOWN: "not known", Verdict.ONE_OF: "a fault, of which several are likely"}


def event_words(event: Any) -> dict[str, Any]:
    """An event for the page."""
    turn = turn_of(event)
    return {
        "t": event.stamp / NS,
        "kind": str(event.kind),
        "text": event.text,
        "grave": event.kind in GRAVE or event.kind == EventKind.FAULT,
        "fault": {"name": turn.name, "begins": turn.begins, "words": turn.words} if turn else None,
    }


def estimate_words(row: Any) -> dict[str, Any]:
    """The latest estimate: how the follower stands, quantities and unknowns with their deviations."""
    rows = []
    for name in SHOWN:
        scale, unit = shown(ESTIMATED[name])
        rows.append([name, scale * float(row[name]), scale * float(row[name + DEVIATION]), unit])
    for name, unknown in UNKNOWNS.items():
        value, deviation = (float(row[OF_UNKNOWN + name + end]) for end in ("", DEVIATION))
        if value == value:
            rows.append([unknown.words, value, deviation, unknown.unit or "times"])
    return {"standing": Standing(int(row["standing"])).name.lower(), "rows": rows}


def health_words(row: Any) -> dict[str, Any]:
    """The latest verdict on the rig: in words, and how far each suspicion has gone."""
    verdict, first = Verdict(int(row["verdict"])), int(row["first"])
    words = WHY.get(verdict, verdict.name.lower())
    if verdict == Verdict.FAULT and first >= 0:
        words = _if_alone(row, PLACES[first])
    findings = [
        {"name": HYPOTHESES[name].words, "deviate": float(row[name + DEVIATE])}
        for name in PLACES
        if row[name + DEVIATE] == row[name + DEVIATE]
    ]
    bad = verdict in (Verdict.FAULT, Verdict.ONE_OF)
    since = float(row["since"])
    return {
        "verdict": words,
        "bad": bad,
        "confidence": float(row["confidence"]) if bad else None,
        "since": since if bad and since == since else None,
        "limit": float(row["limit"]),
        "findings": sorted(findings, key=lambda found: -abs(found["deviate"]))[:5],
    }


def _if_alone(row: Any, name: str) -> str:
    return in_words(name, float(row[name + SIZE]), float(row[name + SIZE + DEVIATION]))


def units_logged(message: Any) -> dict[str, str]:
    """The names of what a law logs, with their units."""
    return dict(zip(message.names, message.units, strict=True))
