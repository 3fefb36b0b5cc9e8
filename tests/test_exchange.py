"""Exchange through a resistance: the implicit equation, no overshoot, no energy from nowhere."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from twin.exchange import exchange
from twin.node import Node, cavity, implicitness, pressure
from twin.orifice import quadratic_flow

VAPOUR, MODULUS = -1e5, 1.17e9
LOG = st.floats(0.0, 1.0)
FILL = st.floats(-0.02, 0.02)  # stored oil over what fills the volume at 0 bar, as a share: cavities to 230 bar


@st.composite
def node(draw) -> Node:
    volume = 10.0 ** (-6.0 + 3.0 * draw(LOG))
    return Node(volume * (1.0 + draw(FILL)), volume, volume / MODULUS)


@st.composite
def resistances(draw) -> tuple[float, float]:
    """From a wide open land, far stiffer than any node, to a leak."""
    return 10.0 ** (9.0 + 8.0 * draw(LOG)), 10.0 ** (5.0 + 8.0 * draw(LOG))


STEP = LOG.map(lambda share: 10.0 ** (-6.0 + 3.0 * share))


def after(n: Node, oil: float) -> Node:
    return n._replace(stored=n.stored + oil)


def drop(source: Node, sink: Node) -> float:
    return pressure(source, VAPOUR) - pressure(sink, VAPOUR)


@given(node(), node(), resistances(), STEP, st.floats(-3e7, 3e7))
def test_mean_flow_solves_the_theta_rule(source: Node, sink: Node, ab, step: float, before: float):
    """Q = (1 - theta) Q(drop before) + theta Q(drop after), whatever is a cavity, before, after or in between."""
    a, b = ab
    mean = exchange(before, source, sink, a, b, VAPOUR, step)
    first = quadratic_flow(before, a, b)
    conductance = 1.0 / (a * abs(first) + b)
    theta = implicitness(step * conductance * (1.0 / source.capacity + 1.0 / sink.capacity))
    last = (mean - (1.0 - theta) * first) / theta
    end = drop(after(source, -step * mean), after(sink, step * mean))
    size = max(abs(before), abs(end), 1e5)
    noise = 1e-15 * (source.volume / source.capacity + sink.volume / sink.capacity)
    rounding = 1e-14 * abs(first) * (2.0 * a * (abs(first) + abs(last)) + b)
    assert a * last * abs(last) + b * last == pytest.approx(end, abs=1e-9 * size + 10 * noise + 10 * rounding)


@given(node(), node(), resistances(), STEP)
def test_oil_never_overshoots_the_balance(source: Node, sink: Node, ab, step: float):
    """However stiff, the drop after a step has the sign it had before, or is rounding."""
    mean = exchange(drop(source, sink), source, sink, ab[0], ab[1], VAPOUR, step)
    end = drop(after(source, -step * mean), after(sink, step * mean))
    assert end * drop(source, sink) >= 0.0 or abs(end) < 1e-13 * MODULUS
    assert mean * drop(source, sink) >= 0.0


def compression(n: Node) -> float:
    """Energy of the oil [J]: the integral of p dS, C p^2/2 without a cavity."""
    p = pressure(n, VAPOUR)
    return 0.5 * n.capacity * p**2 - VAPOUR * cavity(n, VAPOUR)


@given(node(), node(), resistances(), STEP)
def test_a_resistance_never_creates_energy(source: Node, sink: Node, ab, step: float):
    oil = step * exchange(drop(source, sink), source, sink, ab[0], ab[1], VAPOUR, step)
    before = compression(source) + compression(sink)
    assert compression(after(source, -oil)) + compression(after(sink, oil)) <= before * (1.0 + 1e-12) + 1e-12


def test_a_stiff_pair_ends_at_the_common_pressure():
    """The theta rule leaves no more than 1/stiffness of the drop."""
    source, sink = Node(1.01e-4, 1e-4, 1e-4 / MODULUS), Node(2e-4, 2e-4, 2e-4 / MODULUS)
    oil = 1e-3 * exchange(drop(source, sink), source, sink, 0.0, 1e5, VAPOUR, 1e-3)
    common = 1e-6 / (3e-4 / MODULUS)
    assert pressure(after(source, -oil), VAPOUR) == pytest.approx(common, rel=1e-3)
    assert pressure(after(sink, oil), VAPOUR) == pytest.approx(common, rel=1e-3)


def test_two_cavities_exchange_nothing():
    empty = Node(0.99e-4, 1e-4, 1e-4 / MODULUS)
    assert exchange(0.0, empty, empty, 1e12, 1e5, VAPOUR, 1e-3) == 0.0
