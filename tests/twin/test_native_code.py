"""Native code of kernels: the numbers of numba's own way in, from disk without numba, and made anew where damaged."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from bridge.scenario import load
from tests.twin.test_compiled_code import DAMAGE
from twin import kernel as kernels
from twin.kernel import entry, kernel
from twin.sensors import acquire, card_of, noise_block
from twin.topology import CHANNELS


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


def test_an_entry_has_the_bits_of_numbas_own():
    """The card, the smallest kernel of the loop with all kinds of arguments; golden recordings have the rest."""
    taps, rows = np.random.default_rng(1).random((2, len(CHANNELS))), noise_block(1, 0)
    card = card_of(load("step").daq)
    ours, theirs = np.zeros(len(CHANNELS)), np.zeros(len(CHANNELS))
    run = entry(acquire, taps, rows[0], card, 50e-6, ours)
    for row in rows[:100]:
        taps *= 1.01
        run(taps, row, card, 50e-6, ours)
        acquire(taps, row, card, 50e-6, theirs)
        assert ours.tobytes() == theirs.tobytes() != bytes(ours.nbytes)


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
    (file,) = (path for path in (folder / "native").iterdir() if ".module." not in path.name)
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
