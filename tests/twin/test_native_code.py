"""Native code of kernels: the numbers of numba's own way in, from disk without numba, and made anew where damaged."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from bridge.scenario import load
from bridge.scenario.circuit import circuit_of, rest_of
from tests.twin.test_compiled_code import DAMAGE
from twin import kernel as kernels
from twin.circuit.block import _run_block, block_of, buffers, compiled
from twin.kernel import entry, kernel

TICKS, STEPS = 2000, 20


class Pair(NamedTuple):
    gain: float
    rows: np.ndarray
    doubled: bool


def _mixed(out, pair: Pair, shift: float, count: int) -> float:
    for i in range(count):
        out[i] = pair.gain * pair.rows[i, 1] + shift
        if pair.doubled:
            out[i] *= 2.0
    return out[0]


def pair(doubled: bool = True) -> Pair:
    return Pair(3.0, np.arange(8.0).reshape(4, 2), doubled)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Nothing kept, nothing loaded."""
    monkeypatch.setattr(kernels, "FOLDER", tmp_path)
    return tmp_path


def called(**changes: Any) -> list[float]:
    """What a new entry gives, and what its array then holds."""
    out = np.zeros(4)
    arguments = {"out": out, "pair": pair(), "shift": 0.5, "count": 4} | changes
    run = entry(kernel(_mixed), *arguments.values())
    return [run(*arguments.values()), *arguments["out"].tolist()]


@pytest.mark.parametrize("name", ["step", "square"])
def test_a_block_has_the_bits_of_numbas_own_entry(name: str):
    """Over seconds of motion, with references that keep every part of the valve busy."""
    scenario = load(name)
    plant = compiled(circuit_of(scenario))
    ours, theirs = (rest_of(scenario), *buffers()), (rest_of(scenario), *buffers())
    block = block_of(plant)
    for tick in range(TICKS):
        reference = 0.6 * np.sin(0.01 * tick)
        block(ours[0], reference, STEPS, *ours[1:])
        _run_block(*plant, theirs[0], reference, STEPS, *theirs[1:])
    for mine, other in zip(ours, theirs, strict=True):
        assert mine.tobytes() == other.tobytes()


def test_numbers_tuples_and_rows_arrive_in_their_places(folder: Path):
    expected = [2.0 * (3.0 * x + 0.5) for x in (1.0, 3.0, 5.0, 7.0)]
    assert called() == [expected[0], *expected]
    assert called(pair=pair(doubled=False)) == [e / 2.0 for e in (expected[0], *expected)]


def test_what_is_kept_is_taken_without_the_compiler(folder: Path, monkeypatch: pytest.MonkeyPatch):
    first = called()
    monkeypatch.setitem(sys.modules, "twin.compiler", None)
    assert called() == first
    with pytest.raises(ImportError):
        called(shift=1)  # an integer: other code


@pytest.mark.parametrize("how", DAMAGE)
def test_damaged_code_is_made_anew_with_the_same_numbers(folder: Path, how: str):
    first = called()
    (file,) = (folder / "native").iterdir()
    damaged = DAMAGE[how](file.read_bytes())
    file.write_bytes(damaged)
    assert called() == first
    assert file.read_bytes() != damaged


def test_arguments_of_another_kind_or_shape_in_memory_are_refused(folder: Path):
    out = np.zeros(4)
    run: Callable[..., Any] = entry(kernel(_mixed), out, pair(), 0.5, 4)
    for wrong in (np.zeros(4, np.float32), np.zeros((4, 1)), np.zeros(8)[::2]):
        with pytest.raises(TypeError):
            run(wrong, pair(), 0.5, 4)
