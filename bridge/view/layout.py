"""How the view is laid out: the rig and the map of a pipe on the left, curves over a common time on the right."""

from collections.abc import Collection, Mapping
from typing import Any

from bridge.drawing.colours import UNKNOWN
from bridge.view.curves import PICTURES
from bridge.view.length_time import HEIGHT, WIDTH, entity
from bridge.view.rig.eyes import EYES, Eye, Eyes
from bridge.view.timeline import TIMELINE
from twin.topology import LINES

Spans = dict[str, tuple[float, float]]  # what the vertical axis of a picture holds
EVENTS, RUN = "events", "run"
FIRST = ("position_mm", "pressure_bar", "valve", "flow_l_min")  # always in sight
SHARES = (3.0, 4.0, 2.5, 3.0, 3.0)  # of the height; the last of what is behind tabs
CHOSEN_PIPE = 2  # in sight first: from the valve to the lower chamber
CYLINDER = (  # parts seen near
    *("cylinder", "piston", "oil", "weight", "rails", "frame", "cavities", "pipes", "taps"),
    *("accessories", "spring", "lever"),
)


def layout(
    shown: Collection[str],
    spans: Spans,
    follow: float = 0.0,
    bare: bool = False,
    own: Mapping[str, str] = {},
    eyes: Eyes = EYES,
) -> Any:
    """The blueprint for the pictures that have a curve; axes hold `spans` where given.

    own: further pictures and their titles, of what a law logs.

    follow: live, so many seconds [s] up to the latest data; bare: without the viewer's own panels, to be printed.
    eyes: from where the rig is seen.
    """
    import rerun.blueprint as rrb

    left = rrb.Vertical(_rig(eyes), _maps(), rrb.Tabs(_events(), _run()), row_shares=[5.5, 2.7, 1.8])
    first = [name for name in FIRST if name in shown]
    titles = {**own, **PICTURES}
    behind = [_picture(name, titles, spans, follow) for name in titles if name in shown and name not in FIRST]
    views = [_picture(name, titles, spans, follow) for name in first] + ([rrb.Tabs(*behind)] if behind else [])
    shares = [*(SHARES[FIRST.index(name)] for name in first), SHARES[-1]][: len(views)]
    right = rrb.Vertical(*views, row_shares=shares)
    panels = [rrb.TimePanel(timeline=TIMELINE, play_state="following" if follow else "paused", state="collapsed")]
    panels += [rrb.TopPanel(state="hidden")] if bare else []
    return rrb.Blueprint(rrb.Horizontal(left, right, column_shares=[5.6, 4.4]), *panels, collapse_panels=True)


def _rig(eyes: Eyes) -> Any:
    """The whole rig, and beside it the cylinder and the valves from near."""
    import rerun.blueprint as rrb

    near = [f"/rig/{part}/**" for part in CYLINDER]
    whole = _space(eyes["rig"], "rig: pipes to scale, coloured by pressure [bar]", ["/rig/**"])
    cylinder = _space(eyes["cylinder"], "cylinder and load", near)
    valves = _space(eyes["valves"], "valve", ["/rig/valves/**", "/rig/pipes", "/rig/cavities"])
    return rrb.Horizontal(whole, rrb.Vertical(cylinder, valves, row_shares=[2, 1]), column_shares=[2.2, 1])


def _space(eye: Eye, name: str, contents: list[str]) -> Any:
    import rerun.blueprint as rrb

    position, target = eye
    return rrb.Spatial3DView(
        origin="/rig",
        contents=contents,
        name=name,
        background=UNKNOWN,
        line_grid=False,
        eye_controls=rrb.EyeControls3D(position=position, look_target=target, eye_up=(0.0, 0.0, 1.0)),
    )


def _maps() -> Any:
    import rerun.blueprint as rrb

    bounds = rrb.VisualBounds2D(x_range=(-80.0, WIDTH + 110.0), y_range=(-42.0, HEIGHT + 66.0))
    views = [
        rrb.Spatial2DView(origin=entity(pipe), name=f"pipe {pipe + 1}", visual_bounds=bounds, background=UNKNOWN)
        for pipe in range(LINES)
    ]
    return rrb.Tabs(*views, active_tab=CHOSEN_PIPE)


def _events() -> Any:
    import rerun.blueprint as rrb

    return rrb.TextLogView(
        origin=EVENTS, name="events", columns=rrb.TextLogColumns(text_log_columns=["LogLevel", "Body"])
    )


def _run() -> Any:
    import rerun.blueprint as rrb

    return rrb.TextDocumentView(origin=RUN, name="run")


def _picture(name: str, titles: Mapping[str, str], spans: Spans, follow: float) -> Any:
    import rerun.blueprint as rrb

    return rrb.TimeSeriesView(
        origin=name,
        name=titles[name],
        axis_x=_lately(follow) if follow else rrb.TimeAxis(link="LinkToGlobal"),
        axis_y=rrb.ScalarAxis(range=spans[name]) if name in spans else None,
        plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.RightTop),
    )


def _lately(seconds: float) -> Any:
    """A time axis of so many seconds up to the cursor."""
    import rerun as rr
    import rerun.blueprint as rrb

    edge = rr.TimeRangeBoundary
    begin, end = edge.cursor_relative(seconds=-seconds), edge.cursor_relative(seconds=0.0)
    return rrb.TimeAxis(view_range=rr.TimeRange(start=begin, end=end))
