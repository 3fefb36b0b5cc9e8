"""Curves of what a twin beside the rig makes of it: estimates in their bands, unknowns, how far faults have gone."""

from collections.abc import Collection, Iterator
from typing import Any

from numpy.typing import NDArray

from bridge.drawing.colours import DARK
from bridge.recording.reader import Recording
from bridge.scenario.units import shown
from bridge.view.curve import Curve
from bridge.wire.estimates import DEVIATION, OF_UNKNOWN
from bridge.wire.health import DEVIATE, PLACES
from bridge.wire.messages import ESTIMATE, HEALTH
from twin.estimation.hypotheses import HYPOTHESES
from twin.estimation.quantities import ESTIMATED, LEAKS_OUTSIDE, UNKNOWNS

Columns = dict[str, NDArray[Any]]
WIDTH = 2.0  # deviations to either side of an estimate
BELOW, ABOVE = "_below", "_above"  # behind the name of an estimate: the ends of its band
PRESSURES = {"p_p": "violet", "p_lower": "blue", "p_upper": "orange"}
FORCES = {"friction": "red", "load": "green"}
FACTORS = [name for name, unknown in UNKNOWNS.items() if not unknown.unit]
TITLES = {  # of the pictures, by topic
    ESTIMATE: {
        "estimated_pressures": f"estimated pressures [bar], +- {WIDTH:g} deviations",
        "estimated_forces": f"estimated forces [N], +- {WIDTH:g} deviations",
        "unknowns": "unknowns of the rig, factors",
    },
    HEALTH: {"health": "health: normal deviates of faults, limit of an alarm"},
}


def titles(topics: Collection[str]) -> dict[str, str]:
    """Of the pictures that there are with these topics."""
    return {name: words for topic, named in TITLES.items() if topic in topics for name, words in named.items()}


def curves(topics: Collection[str]) -> list[Curve]:
    """Of the topics of a follower among these."""
    estimated = [*_estimated("estimated_pressures", PRESSURES), *_estimated("estimated_forces", FORCES), *_unknowns()]
    return [*(estimated if ESTIMATE in topics else ()), *(_health() if HEALTH in topics else ())]


def with_bands(topic: str, columns: Columns) -> Columns:
    """The columns of a topic, and what its curves need besides."""
    if topic == HEALTH:
        return columns | {f"limit{BELOW}": -columns["limit"]}
    if topic != ESTIMATE:
        return columns
    found = dict(columns)
    for name in (*PRESSURES, *FORCES):
        half = WIDTH * columns[name + DEVIATION]
        found |= {name + BELOW: columns[name] - half, name + ABOVE: columns[name] + half}
    return found


def columns_of(recording: Recording, topic: str) -> Columns:
    """The columns of a topic of a recording, and what its curves need besides."""
    return with_bands(topic, recording.columns(topic))


def _estimated(picture: str, names: dict[str, str]) -> Iterator[Curve]:
    scale, _ = shown(ESTIMATED[next(iter(names))])
    for name, colour in names.items():
        yield Curve(picture, name, name, ESTIMATE, name, scale, DARK[colour], 1.5)
        for end in (BELOW, ABOVE):
            yield Curve(
                picture, name + end, f"{name}{end.replace('_', ' ')}", ESTIMATE, name + end, scale, DARK[colour], 0.5
            )


def _unknowns() -> Iterator[Curve]:
    for name, colour in zip(FACTORS, DARK.values(), strict=False):
        yield Curve("unknowns", name, name, ESTIMATE, OF_UNKNOWN + name, 1.0, colour, 1.5)


def _health() -> Iterator[Curve]:
    colours = [*DARK.values()]
    for place, name in enumerate(name for name in PLACES if HYPOTHESES[name].unknown not in LEAKS_OUTSIDE):
        yield Curve("health", name, name, HEALTH, name + DEVIATE, 1.0, colours[place % len(colours)], 1.5)
    for name, label in (("limit", "limit"), (f"limit{BELOW}", "limit below")):
        yield Curve("health", name, label, HEALTH, name, 1.0, DARK["grey"], 0.5)
