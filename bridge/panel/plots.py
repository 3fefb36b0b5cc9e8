"""Which curves the page can show: those of the view, with what a follower estimates beside what is true."""

from typing import Any, NamedTuple

from bridge.drawing.colours import DARK, LIGHT
from bridge.recording.shown import GROUPS
from bridge.scenario import Scenario
from bridge.scenario.channels import layout_of
from bridge.scenario.fitted import Values, is_motor, of_drive
from bridge.scenario.units import shown
from bridge.view.curves import CURVES, PICTURES, TRUE, Curve, chosen
from bridge.wire.messages import ESTIMATE
from twin.estimation.quantities import ESTIMATED, LOAD

NAMES = {shade: name for name, shade in DARK.items()}
HEIGHTS = ("position_mm", "pressure_bar", "valve")  # pictures that are open at first
FORCES = "forces_n"
DIGITS = 4  # of what is sent, in the unit that people read


class Plot(NamedTuple):
    """One picture of the page."""

    name: str
    title: str
    curves: list[Curve]

    def plain(self, values: Values) -> dict[str, Any]:
        """For the page."""
        return {
            "name": self.name,
            "title": _words(self.title, values),
            "open": self.name in HEIGHTS,
            "curves": [_plain(curve, values) for curve in self.curves],
        }


def plots_of(scenario: Scenario, logged: dict[str, str]) -> list[Plot]:
    """The pictures of a scenario's run; logged: signals of its law, with their units."""
    own = chosen(layout_of(scenario), logged)
    titles = PICTURES | own.titles | {FORCES: "estimated forces [N]"}
    curves = [*CURVES, *own.curves, *_estimated()]
    if is_motor(scenario.rig_values()):
        curves = [c._replace(scale=1.0) if c.picture == "position_mm" else c for c in curves]
    made = [Plot(name, title, [c for c in curves if c.picture == name]) for name, title in titles.items()]
    return [plot for plot in made if plot.curves]


def _estimated() -> list[Curve]:
    """What a follower makes of the true curves, and of what no curve shows."""
    found = []
    for group in ("position", "pressure", "places"):
        for curve in GROUPS[group].curves:
            picture, label = TRUE[group][0], f"{curve.label}, estimated"
            shade = DARK[curve.colour]
            found.append(Curve(picture, curve.name, label, ESTIMATE, curve.field, GROUPS[group].scale, shade, 1.0))
    for name, colour in ((LOAD, "blue"), ("friction", "orange")):
        found.append(Curve(FORCES, name, name, ESTIMATE, name, shown(ESTIMATED[name])[0], DARK[colour], 1.5))
    return found


def key_of(curve: Curve) -> str:
    """How the page calls the numbers of a curve."""
    return f"{curve.topic}.{curve.field}"


def _plain(curve: Curve, values: Values) -> dict[str, Any]:
    name = NAMES[curve.colour]
    return {
        "key": key_of(curve),
        "topic": curve.topic,
        "label": of_drive(curve.label, values),
        "light": LIGHT[name],
        "dark": "#{:02x}{:02x}{:02x}".format(*curve.colour),
        "held": curve.held,
        "dashed": curve.topic == ESTIMATE and curve.picture != FORCES,
    }


def _words(title: str, values: Values) -> str:
    title = of_drive(title, values)
    return title.replace("[mm]", "[rad]") if is_motor(values) and title.startswith("position") else title
