"""What somebody should know of how a log was taken, without it being a mistake: one sentence each."""

from collections.abc import Iterator

import numpy as np

from bridge.recording.logs.carried import Carried, Log
from bridge.recording.logs.map import Map, Signal, si_of
from bridge.scenario.units import shown

MOST_LEFT_OUT = 0.5  # share of the rows between the instants of the grid that goes without a word; assumed
BEYOND = 0.01  # of a sensor's range: what noise may add at its end; assumed


def remarks_on(log: Log, mapped: Map) -> list[str]:
    """Of the grid, and of the ranges of sensors."""
    return [*_of_grid(log), *(words for name in mapped.signal for words in _of_range(name, log, mapped.signal[name]))]


def _of_grid(log: Log) -> Iterator[str]:
    """Where most rows lie between two instants of the grid, and are not taken."""
    rows, instants, period = len(log.clock.seconds), len(log.grid), float(log.grid[1])
    if instants < (1.0 - MOST_LEFT_OUT) * rows:
        yield (
            f"the grid of {period:g} s has {instants} instants, and the log {rows} rows, {log.interval:.3g} s apart: "
            f"about {rows - instants} rows are left out; if that is not meant, give the map another period"
        )


def _of_range(name: str, log: Log, entry: Signal) -> Iterator[str]:
    """Where the data go beyond what the map states of a sensor."""
    carried: Carried = log.signals[name]
    if entry.range is None:
        return
    bottom, top = (si_of(end, carried.unit, name) for end in entry.range)
    low, high, slack = float(np.nanmin(carried.values)), float(np.nanmax(carried.values)), BEYOND * (top - bottom)
    if low < bottom - slack or high > top + slack:
        factor, unit = shown(carried.unit)
        ends = [f"{factor * end:.4g}" for end in (low, high, bottom, top)]
        yield (
            f"{name} goes from {ends[0]} to {ends[1]} {unit}, beyond the range that the map states, {ends[2]} to "
            f"{ends[3]} {unit}: correct the range, or sign, scale and offset"
        )
