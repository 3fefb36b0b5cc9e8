"""Layouts for Foxglove and PlotJuggler: the curves of the report and the view, by the names of a rig's topics.

They fit recordings and live data alike. Both tools plot what the messages hold, so values are in SI.
"""

import json
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

from bridge.drawing.colours import LIGHT
from bridge.errors import writing
from bridge.recording.shown import GROUPS, Curve
from twin.topology import CHANNELS, OBSERVED

PICTURES = ("position", "pressure", "valve", "flow")  # of the table of shown curves


class Plotted(NamedTuple):
    """A curve by its place in the messages."""

    topic: str
    field: str
    label: str
    colour: str


class Picture(NamedTuple):
    """Curves that share an axis."""

    title: str
    curves: tuple[Plotted, ...]


def pictures() -> list[Picture]:
    """What both layouts show: the true state, what the card reads, and the reference."""
    found = []
    for name in PICTURES:
        group = GROUPS[name]
        unit = OBSERVED.get(group.curves[0].field, "") or "of travel"
        curves = [*map(_true, group.curves), *(_more(name))]
        found.append(Picture(f"{group.title} [{unit}]", tuple(curves)))
    return found


def _true(curve: Curve) -> Plotted:
    return Plotted("state", curve.field, curve.label, LIGHT[curve.colour])


def _more(name: str) -> list[Plotted]:
    if name == "position":
        measured = Plotted("measurement", "position", "measured", LIGHT["pale blue"])
        return [measured, Plotted("reference", "position", "reference", LIGHT["grey"])]
    if name == "pressure":
        channels = [n for n, channel in CHANNELS.items() if channel.unit == "Pa"]
        return [Plotted("measurement", n, f"{n} measured", LIGHT["grey"]) for n in channels]
    return []


def write_layouts(rig: str, folder: Path) -> list[Path]:
    """Write both for a rig; the files."""
    name = rig.replace("/", "_")
    files = {
        folder / f"{name}-foxglove.json": json.dumps(foxglove_layout(rig), indent=2) + "\n",
        folder / f"{name}-plotjuggler.xml": plotjuggler_layout(rig),
    }
    for path, text in files.items():
        with writing(path):
            path.write_text(text, encoding="utf-8")
    return list(files)


def foxglove_layout(rig: str) -> dict[str, Any]:
    """Plots one below another, and beside them parameters, events and the plant's status."""
    plots = {f"Plot!{name}": _plot(rig, picture) for name, picture in zip(PICTURES, pictures(), strict=True)}
    beside = {
        "Parameters!rig": {"title": "Numbers that can change"},
        "RawMessages!event": _raw(rig, "event"),
        "RawMessages!status": _raw(rig, "status"),
    }
    return {
        "configById": plots | beside,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": {
            "direction": "row",
            "first": _column(list(plots)),
            "second": _column(list(beside)),
            "splitPercentage": 70,
        },
    }


def _plot(rig: str, picture: Picture) -> dict[str, Any]:
    return {
        "title": picture.title,
        "foxglovePanelTitle": picture.title,
        "paths": [
            {
                "value": f"{rig}/{curve.topic}.{curve.field}",
                "enabled": True,
                "timestampMethod": "receiveTime",
                "label": curve.label,
                "color": curve.colour,
            }
            for curve in picture.curves
        ],
        "showXAxisLabels": True,
        "showYAxisLabels": True,
        "showLegend": True,
        "legendDisplay": "floating",
        "isSynced": True,
        "xAxisVal": "timestamp",
        "followingViewWidth": 10,  # [s] of a live rig
    }


def _raw(rig: str, topic: str) -> dict[str, Any]:
    return {"topicPath": f"{rig}/{topic}", "foxglovePanelTitle": topic}


def _column(names: list[str]) -> Any:
    """Panels below one another, of equal height: a tree of pairs, as Foxglove has it."""
    first, *rest = names
    if not rest:
        return first
    return {"direction": "column", "first": first, "second": _column(rest), "splitPercentage": 100 / len(names)}


def plotjuggler_layout(rig: str) -> str:
    """The same plots below one another in one tab."""
    root = ElementTree.Element("root")
    widget = ElementTree.SubElement(root, "tabbed_widget", {"parent": "main_window", "name": "Main Window"})
    tab = ElementTree.SubElement(widget, "Tab", tab_name=rig, containers="1")
    shown = pictures()
    sizes = ";".join([f"{1 / len(shown):.4f}"] * len(shown))
    container = ElementTree.SubElement(tab, "Container")
    split = ElementTree.SubElement(container, "DockSplitter", orientation="-", count=str(len(shown)), sizes=sizes)
    for picture in shown:
        _dock(split, rig, picture)
    ElementTree.SubElement(widget, "currentTabIndex", index="0")
    ElementTree.SubElement(root, "use_relative_time_offset", enabled="1")
    ElementTree.indent(root)
    return f"<?xml version='1.0' encoding='UTF-8'?>\n{ElementTree.tostring(root, encoding='unicode')}\n"


def _dock(split: ElementTree.Element, rig: str, picture: Picture) -> None:
    area = ElementTree.SubElement(split, "DockArea", name=picture.title)
    plot = ElementTree.SubElement(area, "plot", mode="TimeSeries", style="Lines", flip_x="false", flip_y="false")
    ElementTree.SubElement(plot, "limitY")
    for curve in picture.curves:
        name = f"{rig}/{curve.topic}/{curve.field}"
        ElementTree.SubElement(plot, "curve", name=name, color=curve.colour)
