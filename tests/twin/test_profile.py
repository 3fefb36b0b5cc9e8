"""What stands along the lines: ends as the circuit has them, straight lines in steady flow, cavities that add up."""

import time

import numpy as np
import pytest

from bridge.loop.exchange import exchange, sides
from bridge.scenario import load
from bridge.wire.codec import decode, encode
from bridge.wire.messages import described
from tests.support.plant import circuit, pipes
from twin.circuit.block import compiled, observed
from twin.circuit.equilibrium import equilibrium
from twin.circuit.profile import XI, along_lines
from twin.circuit.state import flatten, unflatten
from twin.topology import HOLLOWS, POINTS

CAVITIES = ("lower", "upper", "pump", "tee", "p", "a", "b", "t", "return")


def profile(state, c) -> tuple[np.ndarray, dict[str, float]]:
    """Pressures along the lines and cavities by name."""
    pressure, cavity = np.zeros((6, POINTS)), np.zeros(len(HOLLOWS))
    along_lines(flatten(state), *compiled(c), XI, pressure, cavity)
    return pressure, dict(zip(HOLLOWS, cavity.tolist(), strict=True))


def run(scenario: str, *changes: str) -> list:
    """The plant's messages of a run in process."""
    loaded = load(scenario, list(changes))
    return [m for tick in exchange(*sides(loaded), loaded.ticks) for m in tick]


@pytest.mark.parametrize("model", ["ends", "nodes", "lumped", "volume", "none"])
def test_at_rest_each_line_is_a_straight_line_between_what_its_ends_have(model: str):
    c = circuit(50e-6, **pipes(model=model))
    state = equilibrium(c, 0.1)
    pressure, cavity = profile(state, c)
    assert pressure[:, [0, -1]].ravel() == pytest.approx(state.ends.pressure[:12], abs=1.0)
    assert np.diff(pressure, n=2) == pytest.approx(0.0, abs=1.0)
    assert not any(cavity.values())


def test_at_every_viewer_tick_the_ends_are_those_of_the_true_state():
    """Waves included: a step of 60 mm, full opening. (Turbulent friction and
    minor losses sit before an end, outside the profile.)"""
    bare = [change for i in range(1, 7) for change in (f"rig.minor_losses.pipe_{i}=0", f"rig.pipe_{i}.friction=steady")]
    messages = run("step", "duration=1.5", *bare)
    states = {m.log_time: m.message for m in messages if m.topic == "state"}
    lines = [m.message for m in messages if m.topic == "lines"]
    assert len(lines) == 76
    assert [line.stamp for line in lines] == [k * 20_000_000 for k in range(76)]
    for line in lines:
        p, s = line.pressure.reshape(6, line.places), states[line.stamp]
        ends = [p[0, 0], p[0, -1], p[1, -1], p[2, 0], p[2, -1], p[3, 0], p[3, -1], p[4, 0], p[4, -1], p[5, 0], p[5, -1]]
        found = [s.p_pump, s.p1, s.p_p, s.p_a, s.p_lower, s.p_b, s.p_upper, s.p_t, s.p_return, s.p_return, 0.0]
        assert ends == pytest.approx(found, abs=1.0)


@pytest.mark.parametrize("model", ["ends", "nodes"])
def test_cavities_are_those_of_the_true_state(model: str):
    """Behind a slammed valve there are some; those inside a line are known to one model only."""
    changes = [f"rig.pipe_{i}.model={model}" for i in range(1, 7)]
    messages = run("valve-slam", *changes, "duration=1.5", "loop.viewer_period=0.001")
    states = {m.log_time: m.message for m in messages if m.topic == "state"}
    inner = 0.0
    for line in (m.message for m in messages if m.topic == "lines"):
        state = states[line.stamp]
        assert line.cavity[:9].tolist() == [getattr(state, f"cavity_{name}") for name in CAVITIES]
        assert line.cavity[9:].sum() == pytest.approx(state.cavity_lines, abs=1e-18)
        inner = max(inner, state.cavity_lines)
    assert (inner > 0.0) == (model == "nodes")


def test_looking_changes_nothing():
    c = circuit()
    state = equilibrium(c, 0.1)
    flat = flatten(state)
    before = flat.copy()
    along_lines(flat, *compiled(c), XI, np.zeros((6, POINTS)), np.zeros(len(HOLLOWS)))
    assert flat.tolist() == before.tolist()
    assert observed(unflatten(flat), c)["p1"] == state.ends.pressure[1]


def test_it_costs_microseconds():
    """A kernel call a viewer period: against 20 ms of which the plant has 1 ms blocks."""
    c = circuit()
    flat, view = flatten(equilibrium(c, 0.1)), compiled(c)
    pressure, cavity = np.zeros((6, POINTS)), np.zeros(len(HOLLOWS))
    along_lines(flat, *view, XI, pressure, cavity)
    best = min(_timed(lambda: along_lines(flat, *view, XI, pressure, cavity)) for _ in range(200))
    assert best < 100e-6


def _timed(call) -> float:
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def test_the_message_says_its_layout_and_comes_back():
    message = next(m for m in run("step", "duration=0.02") if m.topic == "lines")
    back = decode(encode(message.message), "lines")
    assert back.places == POINTS
    assert back.pressure.tolist() == message.message.pressure.tolist()
    text = described("hydrotwin_msgs/msg/LineProfile")
    assert all(name in text for name in (*HOLLOWS[:9], "[Pa]", "[m^3]", "places"))
