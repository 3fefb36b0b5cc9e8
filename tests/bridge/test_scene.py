"""The rig in 3-D: pipes as long as they are, the piston where it is, colours that say the pressure, cavities to see."""

from pathlib import Path

import numpy as np
import pytest

from bridge.drawing.colours import STOPS, UNKNOWN, pressure_colours
from bridge.recording.frames import frames, profiles
from bridge.recording.reader import Recording, recording
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.view.content import scene_of, write
from bridge.view.length_time import marks, picture
from bridge.view.rig.axis import BARREL_AT
from bridge.view.rig.routes import length_of, route, segments
from bridge.view.rig.stage import CAVITY_SCALE, ball_radius

SCENARIO = ("load-change", ["duration=1.3"])


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    """The piston meets a weight, with cavities behind the valve."""
    return record_in_process(load(*SCENARIO), tmp_path_factory.mktemp("scene") / "a.mcap")


@pytest.fixture(scope="module")
def view(ran: Recording) -> Path:
    pytest.importorskip("rerun")
    return write(ran, ran.path.with_suffix(".rrd"))


def rows(file: Path, entity: str, component: str) -> list:
    """The rows of a component, read by Rerun's own reader."""
    from rerun.chunk import RrdReader

    batches = [c.to_record_batch() for c in RrdReader(file).stream() if c.entity_path == entity]
    return [row for batch in batches if component in batch.schema.names for row in batch.column(component).to_pylist()]


@pytest.mark.parametrize("length", [1.0, 2.5, 7.0])
@pytest.mark.parametrize("end", [(0.5, 0.0, 0.0), (0.4, 0.0, 0.3), (0.4, 0.1, -0.3)])
def test_a_way_is_as_long_as_its_pipe(length: float, end: tuple[float, float, float]):
    way = route(np.zeros(3), np.array(end), length, np.array([0.0, 0.0, 1.0]))
    assert length_of(way) == pytest.approx(length, rel=2e-3)
    assert way[0].tolist() == [0.0, 0.0, 0.0]
    assert way[-1] == pytest.approx(end)
    pieces = segments(way, 10)
    assert [length_of(piece) for piece in pieces] == pytest.approx([length_of(way) / 10] * 10)


def test_a_pipe_too_short_for_its_place_is_a_straight_line():
    assert len(route(np.zeros(3), np.array([1.0, 0.0, 0.0]), 0.2, np.array([0.0, 0.0, 1.0]))) == 2


def test_all_pipes_of_the_rig_are_to_scale():
    for scenario in ("step", "load-change"):
        for pipe in scene_of(load(scenario)).pipes:
            assert sum(map(length_of, pipe.pieces)) == pytest.approx(pipe.length, rel=2e-3)


def test_load_and_weight_are_as_heavy_as_they_look():
    scene = scene_of(load("load-change"))
    assert 7850.0 * 0.36**2 * np.array([scene.load_height, scene.added_height]) == pytest.approx([120.0, 183.0])


def test_colours_go_with_the_pressure_and_vapour_is_told_from_the_tank():
    for bar, *rgb in STOPS:
        assert pressure_colours(np.array([bar * 1e5])).tolist() == [rgb]
    assert pressure_colours(np.array([-5e5, 500e5])).tolist() == [list(STOPS[0][1:]), list(STOPS[-1][1:])]
    assert pressure_colours(np.array([np.nan])).tolist() == [list(UNKNOWN)]


def test_piston_and_weight_stand_where_they_are(view: Path, ran: Recording):
    shown = frames(ran)
    x = shown.state["position"]
    height = [row[0][2] for row in rows(view, "/rig/piston", "Transform3D:translation")]
    assert height == pytest.approx(x.tolist(), abs=1e-6)
    lifted = [row[0][2] for row in rows(view, "/rig/weight", "Transform3D:translation")]
    assert lifted == pytest.approx(np.maximum(x - 0.138, 0.0).tolist(), abs=1e-6)
    assert max(lifted) > 0.0


def test_every_segment_of_every_pipe_has_the_colour_of_its_pressure(view: Path, ran: Recording):
    shown = frames(ran)
    colours = rows(view, "/rig/pipes", "LineStrips3D:colors")
    assert len(colours) == len(shown.stamps) == 66
    middle = 0.5 * (shown.pressure[..., 1:] + shown.pressure[..., :-1])
    for row, pressure in zip(colours, middle, strict=True):
        found = np.array(row, dtype=np.uint32).reshape(-1, 1) >> np.array([24, 16, 8]) & 0xFF
        assert found.tolist() == pressure_colours(pressure.ravel()).tolist()


def test_cavities_are_balls_of_their_volume(view: Path, ran: Recording):
    shown = frames(ran)
    assert shown.cavity.max() > 1e-7
    sizes = np.array(rows(view, "/rig/cavities", "Ellipsoids3D:half_sizes"))
    assert sizes.shape == (*shown.cavity.shape, 3)
    assert 4.0 / 3.0 * np.pi * (sizes[..., 0] / CAVITY_SCALE) ** 3 == pytest.approx(shown.cavity, rel=1e-5, abs=1e-15)
    assert ball_radius(np.array([0.0]))[0] == 0.0


def test_oil_fills_the_barrel_up_to_the_piston(view: Path, ran: Recording):
    heights = np.array([row[0] for row in rows(view, "/rig/oil/lower", "Cylinders3D:lengths")])
    assert heights == pytest.approx(frames(ran).state["position"], abs=1e-6)
    centres = np.array([row[0][2] for row in rows(view, "/rig/oil/lower", "Cylinders3D:centers")])
    assert centres - 0.5 * heights == pytest.approx(BARREL_AT, abs=1e-6)


def test_taps_are_read_in_bar(view: Path, ran: Recording):
    words = [row[0] for row in rows(view, "/rig/taps/p2", "Points3D:labels")]
    assert words == [f"p2  {p / 1e5:.1f} bar" for p in frames(ran).state["p_lower"]]


def test_a_map_is_the_profile_with_its_first_end_below(ran: Recording):
    pressure = profiles(ran)[1][:, 2]
    image = picture(pressure)
    assert image.shape == (11, 66, 3)
    assert image[-1].tolist() == pressure_colours(pressure[:, 0]).tolist()
    assert picture(np.zeros((4000, 11))).shape[1] <= 1500


def test_axes_of_a_map_have_units_and_round_marks(view: Path):
    assert marks(0.0, 10.0, 8) == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0]
    assert marks(-10.0, 0.0, 4) == [-10.0, -7.5, -5.0, -2.5, 0.0]
    words = rows(view, "/along/pipe_3/words", "Points2D:labels")[0]
    assert words == ["simulated time [s]", "pipe 3: pressure [bar] over length [m] and time [s]"]
    assert "0.5 m" in rows(view, "/along/pipe_3/marks", "Points2D:labels")[0]


def test_a_recording_without_profiles_gets_straight_lines(ran: Recording):
    old = recording(ran.path, [entry for entry in ran.entries if entry.topic != "lines"], ran.metadata)
    stamps, pressure, cavity = profiles(old)
    state = old.columns("state")
    assert stamps.tolist() == state["stamp"][::20].tolist()
    assert pressure[:, 2, [0, -1]].T.tolist() == [state["p_a"][::20].tolist(), state["p_lower"][::20].tolist()]
    assert pressure[:, 2, 5] == pytest.approx(pressure[:, 2, [0, -1]].mean(axis=1))
    assert cavity[:, 1].tolist() == state["cavity_upper"][::20].tolist()
