"""The drive's own picture as SVG that a page can move and colour, and the numbers it needs for that."""

import re
from typing import Any, NamedTuple

from bridge.drawing.colours import STOPS
from bridge.drawing.html import svg
from bridge.figures.circuit.rig import (
    BARREL,
    DARK_HOSE,
    LOW,
    PISTON,
    RODS_ROOM,
    THICK,
    TOP,
    draw_drive,
)
from bridge.figures.circuit.symbols import BOX, INK, OIL, PALE, STEEL
from bridge.scenario import Scenario
from bridge.scenario.circuit import circuit_of, supply_of
from bridge.scenario.fitted import is_motor, rod_at
from twin.topology import PIPES, PLACES, TANK

NAME = "drive"  # its ids begin so
OF_SCALE = 67e5  # [Pa], supply for which the colours of `drawing.colours` are made
SHEET = {  # colours that follow the page's
    "#ffffff": "sheet",
    INK: "ink",
    OIL: "oil",
    PALE: "pale",
    STEEL: "steel",
    DARK_HOSE: "hose",
}
GREY = "#595959"  # 0.35, of remarks


class Picture(NamedTuple):
    """One drive."""

    svg: str
    motion: dict[str, Any]  # what a page needs to move and colour it


def picture_of(scenario: Scenario) -> Picture:
    """The picture of a scenario's drive. Raises ScenarioError where its numbers make no circuit."""
    rig = scenario.rig_values()
    drawn = svg(draw_drive(rig, circuit_of(scenario)), NAME, "The circuit of the drive")
    view = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', drawn)
    assert view is not None
    width, height = float(view[1]), float(view[2])
    high = TOP - LOW + (0.0 if is_motor(rig) or rod_at(rig) == "a" else RODS_ROOM)
    unit = height / high  # of the drawing in the picture
    reach = BARREL[1] - BARREL[0] - THICK
    above = 0.0 if is_motor(rig) or rod_at(rig) == "a" else unit * (BARREL[1] - THICK - PISTON)
    drawn = drawn.replace(view[0], f'viewBox="0 {-above:.1f} {width:g} {height + above:.1f}"', 1)
    motion = {
        "name": NAME,
        "travel": unit * reach,  # of the piston, in the picture's own unit
        "drawn_at": (PISTON - BARREL[0]) / reach,  # share of the stroke at which the piston is drawn
        "foot": unit * (PISTON - BARREL[0]),
        "box": unit * BOX,
        "stroke": rig["cylinder"]["stroke"],
        "turns": is_motor(rig),
        "stops": _stops(scenario),
        "ends": _ends(),
    }
    return Picture(_themed(drawn), motion)


def _stops(scenario: Scenario) -> list[list[float]]:
    """Pressures [Pa] and their colours: a drive of higher pressure has its red further up, vapour stays violet."""
    wider = max(1.0, supply_of(scenario).tee / OF_SCALE)
    return [[1e5 * at * (wider if at > 0.0 else 1.0), *colour] for at, *colour in STOPS]


def _ends() -> list[list[str | None]]:
    """Of each line the fields of the state that are the pressures at its ends; None: the tank."""
    return [[None if place == TANK else PLACES[place].pressure for place in pipe] for pipe in PIPES.values()]


def _themed(drawn: str) -> str:
    """Colours of paper and ink as those of the page, which may be dark."""
    for colour, variable in (SHEET | {GREY: "remark"}).items():
        drawn = re.sub(rf"(fill|stroke): {colour}\b", rf"\1: var(--{variable})", drawn)
    bare = re.sub(r'(<text[^>]*style=")(?![^"]*fill)', r"\1fill: var(--ink); ", drawn)
    return bare.replace('<g id="drive-patch_1">', '<g id="drive-patch_1" class="paper">')
