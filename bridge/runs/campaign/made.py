"""The scenario of a point of a campaign: a base, its fault's piece, changes."""

from collections.abc import Mapping
from typing import Any

from bridge.runs.campaign.places import replaced
from bridge.scenario import Scenario, changed
from bridge.scenario.files import with_piece
from bridge.studies.sweep.journal import Point

Plain = dict[str, Any]


def scenario_of(point: Point, bases: Mapping[str, Plain], pieces: Mapping[str, Plain]) -> Scenario:
    """The scenario of a point: a base by name, its fault's piece with other numbers at some places, a further piece.

    Raises ScenarioError with one line per mistake.
    """
    piece = replaced(pieces.get(point["fault"], {}), point.get("placed", {}))
    data = with_piece(with_piece(bases[point["scenario"]], piece), point.get("piece", {}))
    return changed(data, point["changes"], point["scenario"])
