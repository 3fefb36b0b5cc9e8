"""Functions chosen by type when their caller is compiled, from tuples, from records and from Python."""

from typing import Any, NamedTuple

import numpy as np
import pytest

from twin.circuit.block import record
from twin.kernel import by_type, entry, kernel


class Rigid(NamedTuple):
    """Nothing that yields."""


class Spring(NamedTuple):
    stiffness: float


class Twin(NamedTuple):
    stiffness: float


class Rod(NamedTuple):
    length: float
    end: Rigid | Spring


@by_type
def shortening(end: Any, force: float) -> float:
    """How far an end yields to a force."""
    raise TypeError(f"{end} is not an end")


@shortening.register
def _(end: Rigid, force: float) -> float:
    return 0.0


@shortening.register
def _(end: Spring, force: float) -> float:
    return force / end.stiffness


@kernel
def loaded(rod, force: float) -> float:
    return rod.length - shortening(rod.end, force)


@kernel
def of_record(rods, force: float) -> float:
    return loaded(rods[0], force)


RODS = [(Rod(3.0, Rigid()), 3.0), (Rod(3.0, Spring(4.0)), 2.5)]


@pytest.mark.parametrize(("rod", "length"), RODS)
def test_the_variant_is_that_of_the_type_wherever_the_call_comes_from(rod: Rod, length: float):
    assert rod.length - shortening(rod.end, 2.0) == length
    assert loaded(rod, 2.0) == length
    assert of_record(record(rod), 2.0) == length
    assert entry(of_record, record(rod), 1.0)(record(rod), 2.0) == length


def test_variants_that_a_record_could_not_tell_apart_are_refused():
    with pytest.raises(TypeError, match="Twin has the fields of another variant"):

        @shortening.register
        def _(end: Twin, force: float) -> float:
            return 0.0


def test_a_type_without_a_variant_is_named():
    with pytest.raises(TypeError, match="shortening is not defined for"):
        shortening(np.float64(1.0), 2.0)
